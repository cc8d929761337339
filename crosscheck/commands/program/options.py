"""Options that several commands share.

Folders among the arguments of a command, and the files below them.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import typer

from crosscheck.commands.program.output_files import OutputFile
from crosscheck.distributing import DaskWorkers, LocalProcesses
from graphdyn.compiler import cores

EXAMPLES = "\b\nExamples:\n"
"""Heading of the examples in the help of a command; \\b keeps the line breaks."""

FACES = 12000
"""Triangles of a robot in three dimensions, about: round parts look round, and pages stay small."""

OPTIONAL_NUMBER = "[N]"
"""The metavar of an option whose number may be left out; its parser is given an empty text then."""


def robot_names(incomplete: str) -> list[str]:
    """Names of the catalog that begin like this, for completion by the shell, which completes files if none does."""
    from urdf import robots

    return [entry.name for entry in robots() if entry.name.startswith(incomplete)]


def command_line() -> list[str]:
    """The command line with which the program was called."""
    return ["graphdyn", *sys.argv[1:]]


RobotArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT", help="Name (`graphdyn robots`), URDF, .xacro or MJCF file.", autocompletion=robot_names
    ),
]
RobotOption = Annotated[
    str,
    typer.Option(
        "--robot",
        metavar="ROBOT",
        help="Name (`graphdyn robots`), URDF, .xacro or MJCF file.",
        autocompletion=robot_names,
    ),
]
SamplesOption = Annotated[int, typer.Option(min=1, metavar="N", help="Random states per robot.")]
SeedOption = Annotated[int, typer.Option(min=0, metavar="N", help="Seed of the random states.")]


@dataclass(frozen=True, kw_only=True)
class JsonOptions:
    """--json"""

    PANEL: ClassVar[str] = "Output files"

    json_file: Annotated[
        OutputFile | None,
        typer.Option(
            "--json", metavar="FILE", parser=OutputFile, help="Write all numbers to FILE; - for standard output."
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class ReportOptions(JsonOptions):
    """--json and --html"""

    PANEL: ClassVar[str] = "Output files"

    html_file: Annotated[
        OutputFile | None,
        typer.Option("--html", metavar="FILE", parser=OutputFile, help="Write a self-contained page to FILE."),
    ] = None


@dataclass(frozen=True, kw_only=True)
class PageOptions(ReportOptions):
    """--json, --html and --3d"""

    PANEL: ClassVar[str] = "Output files"

    three_d: Annotated[
        bool, typer.Option("--3d", help="With --html: show the robot in three dimensions; several robots side by side.")
    ] = False

    def __post_init__(self) -> None:
        """Raises typer.BadParameter for --3d without --html."""
        if self.three_d and self.html_file is None:
            raise typer.BadParameter("--3d is for the page of --html FILE; name it, or look with `graphdyn view`")


@dataclass(frozen=True, kw_only=True)
class WorkerOptions:
    """Workers: processes here, or the workers of a Dask scheduler."""

    PANEL: ClassVar[str] = "Workers"

    jobs: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", show_default="one per processor", help="Number of parallel processes."),
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Use the workers of a Dask scheduler, such as tcp://10.0.0.1:8786, instead of processes here (extra "
            "`distributed`). They must find the files under the same paths.",
        ),
    ] = None

    @property
    def workers(self) -> DaskWorkers | LocalProcesses:
        """Raises typer.BadParameter for both."""
        if self.jobs and self.scheduler:
            raise typer.BadParameter("--jobs and --scheduler exclude each other; the scheduler has workers of its own")
        return DaskWorkers(self.scheduler) if self.scheduler else LocalProcesses(self.jobs or cores())


@dataclass(frozen=True, kw_only=True)
class CodeOptions:
    """--allow-code"""

    PANEL: ClassVar[str] = "Python code"

    allow_code: Annotated[
        bool,
        typer.Option(
            "--allow-code", help="Run the code that the TOML file names as FILE.py:NAME. It can do whatever you can."
        ),
    ] = False


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
