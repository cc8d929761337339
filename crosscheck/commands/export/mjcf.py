"""A robot as MJCF: a new file, or new numbers in an existing one."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import typer
from rich.text import Text

from crosscheck.commands.program.console import out, warn
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.report.plain_text import printable
from graphdyn import RobotModel
from graphdyn.errors import counted

_MJCF = "mjcf"


class MJCFFormat:
    """The word mjcf in place of a file: --out names that."""


def target(name: str) -> OutputFile:
    """The file of this name, or the format, which is no file that could be in the way."""
    return cast(OutputFile, MJCFFormat()) if name == _MJCF else OutputFile(name)


def refuse_options(is_mjcf: bool, destination: OutputFile | None, patch: Path | None) -> None:
    """Raises typer.BadParameter for options that need each other."""
    if is_mjcf and destination is None:
        raise typer.BadParameter("--to mjcf: name the file with --out FILE.xml")
    if not is_mjcf and (destination is not None or patch is not None):
        raise typer.BadParameter("--out and --patch are for --to mjcf; name other files with --to FILE")
    if destination is not None and (destination.is_standard_output or destination.path.suffix.lower() != ".xml"):
        raise typer.BadParameter(f"--out {destination.name}: end the name in .xml")


def export_mjcf(model: RobotModel, robot: str, destination: Path, patch: Path | None) -> None:
    """Write the file, and say what is in it."""
    import urdf

    if patch is None:
        urdf.save_mjcf(model, destination)
        out.print(Text(printable(f"{robot} as MJCF in {destination}")), soft_wrap=True)
        return
    done = urdf.patch_mjcf(model, patch, destination)
    bodies, joints = counted(len(done.bodies), "body", "bodies"), counted(len(done.joints), "joint")
    line = f"{destination}: {patch} with new inertials of {bodies}, new damping, friction or armature of {joints}"
    out.print(Text(printable(line)), soft_wrap=True)
    for note in done.notes:
        warn(note)
