"""Inspections that fail, for processes of their own."""

import os

from urdf import Inspection, inspect


def fatal(robot: str) -> Inspection:
    """Takes its process with it where the path says so."""
    if "fatal" in robot:
        os._exit(1)
    return inspect(robot)


def broken(robot: str) -> Inspection:
    """An error of the program."""
    if "broken" in robot:
        raise ZeroDivisionError("no reason")
    return inspect(robot)
