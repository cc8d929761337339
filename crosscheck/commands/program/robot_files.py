"""Folders among the arguments of a command, and the files below them."""

from __future__ import annotations

from pathlib import Path


def is_folder(robot: str) -> bool:
    """Whether an argument is a folder, and not the name of a robot of the catalog."""
    from urdf import robots

    return Path(robot).is_dir() and robot not in {entry.name for entry in robots()}


def files_below(folder: str) -> list[str]:
    """Every *.urdf below a folder, in alphabetical order. Raises RobotNotFound where there is none."""
    from urdf import RobotNotFound

    files = sorted(str(path) for path in Path(folder).rglob("*.urdf") if path.is_file())
    if not files:
        raise RobotNotFound(f"no *.urdf in the folder '{folder}'", "give a folder with URDF files")
    return files
