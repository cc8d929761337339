"""Options that several commands share, and checks of their values.

Options for where the work is done: processes here, or the workers of a Dask scheduler.
"""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from crosscheck.commands.program.output_files import OutputFile
from crosscheck.distributing import DaskWorkers, LocalProcesses
from graphdyn.compiler import cores

EXAMPLES = "\b\nExamples:\n"
"""Heading of the examples in the help of a command; \\b keeps the line breaks."""

FACES = 12000
"""Triangles of a robot in three dimensions, about: round parts look round, and pages stay small."""


def robot_names(incomplete: str) -> list[str]:
    """Names of the catalog that begin like this, for completion by the shell, which completes files if none does."""
    from urdf import robots

    return [entry.name for entry in robots() if entry.name.startswith(incomplete)]


RobotArgument = Annotated[
    str,
    typer.Argument(metavar="ROBOT", help="Name (`graphdyn robots`), URDF or .xacro file.", autocompletion=robot_names),
]
RobotsArgument = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="ROBOT",
        help="Names (`graphdyn robots`), URDF files or folders of them; six arms if none.",
        autocompletion=robot_names,
    ),
]
LockOption = Annotated[
    list[str] | None,
    typer.Option(metavar="JOINT[=VALUE]", help="Lock a joint at VALUE [rad or m], 0 if left out. Repeatable."),
]
ChainOption = Annotated[
    tuple[str, str] | None,
    typer.Option(metavar="BASE TIP", help="Cut out the arm from link BASE to link TIP; other joints are locked at 0."),
]
SamplesOption = Annotated[int, typer.Option(min=1, metavar="N", help="Random states per robot.")]
SeedOption = Annotated[int, typer.Option(min=0, metavar="N", help="Seed of the random states.")]
JsonOption = Annotated[
    OutputFile | None,
    typer.Option("--json", metavar="FILE", parser=OutputFile, help="Write all numbers to FILE, - for standard output."),
]
HtmlOption = Annotated[
    OutputFile | None,
    typer.Option("--html", metavar="FILE", parser=OutputFile, help="Write a self-contained page to FILE."),
]


def locked_joints(texts: list[str] | None) -> dict[str, float]:
    """--lock JOINT[=VALUE] as {joint: value}."""
    return dict(_parse_lock(text) for text in texts or ())


def _parse_lock(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name, float(value) if value else 0.0
    except ValueError:
        raise typer.BadParameter(f"--lock {text}: '{value}' is not a number") from None


def command_line() -> list[str]:
    """The command line with which the program was called."""
    return ["graphdyn", *sys.argv[1:]]


SchedulerOption = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Use the workers of a Dask scheduler, such as tcp://10.0.0.1:8786, in place of processes here (extra "
        "`distributed`). They find the files under the same paths.",
    ),
]


def workers_of(jobs: int | None, scheduler: str | None) -> DaskWorkers | LocalProcesses:
    """What --jobs and --scheduler choose; as many processes as processors without both. Raises typer.BadParameter."""
    if jobs and scheduler:
        raise typer.BadParameter("--jobs and --scheduler exclude each other; the scheduler has workers of its own")
    return DaskWorkers(scheduler) if scheduler else LocalProcesses(jobs or cores())
