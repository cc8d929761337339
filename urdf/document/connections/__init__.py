"""Connections that close loops, as files and callers state them."""
