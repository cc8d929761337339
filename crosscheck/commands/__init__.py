"""The program `graphdyn`: one file per command, imported without Pinocchio, which the commands import when they run."""

from crosscheck.commands.application import app, main

__all__ = ["app", "main"]
