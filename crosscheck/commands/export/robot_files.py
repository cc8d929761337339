"""A robot as MJCF or as a table of Denavit-Hartenberg parameters: a new file, or new numbers in an existing one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, cast

import typer
from rich.text import Text

from crosscheck.commands.program.console import out, warn
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.report.plain_text import printable
from graphdyn import RobotModel
from graphdyn.errors import counted

ENDINGS = {"mjcf": ".xml", "dh": ".toml"}
"""Endings of the files of each format."""


@dataclass(frozen=True)
class RobotFormat:
    """A format that stands for the file, which --out names. word: one of ENDINGS"""

    word: str


def target(name: str) -> OutputFile:
    """The file of this name, or the format, which is no file that could be in the way."""
    return cast(OutputFile, RobotFormat(name)) if name in ENDINGS else OutputFile(name)


def refuse_options(to: object, destination: OutputFile | None, patch: Path | None, dh: str | None) -> None:
    """Raises typer.BadParameter for options that need each other."""
    word = to.word if isinstance(to, RobotFormat) else None
    if word is None:
        if destination is not None or patch is not None:
            raise typer.BadParameter("--out and --patch are for --to mjcf and --to dh; name other files with --to FILE")
    else:
        ending = ENDINGS[word]
        if destination is None:
            raise typer.BadParameter(f"--to {word}: name the file with --out FILE{ending}")
        if destination.is_standard_output or destination.path.suffix.lower() != ending:
            raise typer.BadParameter(f"--out {destination.name}: end the name in {ending}")
    if patch is not None and word != "mjcf":
        raise typer.BadParameter("--patch is for --to mjcf")
    if dh is not None and word != "dh":
        raise typer.BadParameter("--dh is for --to dh")


def export_dh(model: RobotModel, robot: str, destination: Path, convention: Literal["standard", "modified"]) -> None:
    """Write the table, and say so."""
    import urdf

    urdf.save_dh(model, destination, convention)
    said = f"{robot} as {convention} Denavit-Hartenberg parameters in {destination}"
    out.print(Text(printable(said)), soft_wrap=True)


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
