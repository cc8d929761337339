"""The program `graphdyn`: one file per command, imported without Pinocchio, which the commands import when they run."""

from crosscheck.cli.application import app, main

__all__ = ["app", "main"]
