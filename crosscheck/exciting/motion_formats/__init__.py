"""Planned motions as files that robots and programs take, written and read back: one file for each format."""
