"""A folder that a command writes as a whole, and only where nothing else is lost."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

import typer


def refuse_folder(option: str, folder: Path, table: str) -> None:
    """Refuse a folder that holds anything but what the command has written there before.

    table: the file in it that lists what was written, under "files"

    Raises typer.BadParameter.
    """
    if not folder.resolve().parent.is_dir():
        raise typer.BadParameter(f"{option} {folder}: folder {folder.resolve().parent} does not exist")
    if not folder.exists():
        return
    if not folder.is_dir():
        raise typer.BadParameter(f"{option} {folder}: is no folder")
    others = {path.name for path in folder.iterdir()} - _written_before(folder / table)
    if others:
        raise typer.BadParameter(
            f"{option} {folder}: holds other files, such as {min(others)}, which would be lost; name another folder"
        )


def _written_before(table: Path) -> set[str]:
    try:
        return {table.name, *json.loads(table.read_bytes())["files"]}
    except (OSError, ValueError, LookupError, TypeError):
        return set()


def write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write all files or none: into a new folder beside, which then takes the place of the old one. Raises OSError."""
    target = folder.resolve()
    new = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
    try:
        new.chmod(0o777 & ~_umask())
        for name, content in files.items():
            (new / name).write_bytes(content)
        if target.exists():
            old = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
            os.replace(target, old)
            os.replace(new, target)
            shutil.rmtree(old)
        else:
            os.replace(new, target)
    finally:
        shutil.rmtree(new, ignore_errors=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
