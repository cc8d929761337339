"""The program as a whole: its commands in the order of its help, and the options that come before a command."""

from __future__ import annotations

import functools
from typing import Annotated, Any

import typer

from crosscheck.commands.bench import command as bench
from crosscheck.commands.cache import command as cache
from crosscheck.commands.crosscheck import command as crosscheck
from crosscheck.commands.diff import command as diff
from crosscheck.commands.errata import command as errata
from crosscheck.commands.excite import command as excite
from crosscheck.commands.export import command as export
from crosscheck.commands.identify import command as identify
from crosscheck.commands.inspect import command as inspect
from crosscheck.commands.judge import command as judge
from crosscheck.commands.paper import command as paper
from crosscheck.commands.payload import command as payload
from crosscheck.commands.program import own_process
from crosscheck.commands.program.console import accept_all_characters
from crosscheck.commands.program.exits import (
    AGREED,
    BAD_INPUT,
    Command,
    CommandGroup,
    ended_by_signals,
    refuse_closed_output,
)
from crosscheck.commands.program.settings import as_command
from crosscheck.commands.questions import command as questions
from crosscheck.commands.recording import command as recording
from crosscheck.commands.repair import command as repair
from crosscheck.commands.robots import command as robots
from crosscheck.commands.show import command as show
from crosscheck.commands.simulate import command as simulate
from crosscheck.commands.study import command as study
from crosscheck.commands.vectors import command as vectors
from crosscheck.commands.view import command as view

CODE, ROBOTS, RECORDINGS, PROGRAM = "Dynamics code", "Robot files", "Recordings", "The paper and the program"
"""Headings of the help."""

COMMANDS = (
    (inspect, "inspect", ROBOTS),
    (crosscheck, "crosscheck", ROBOTS),
    (diff, "diff", ROBOTS),
    (repair, "repair", ROBOTS),
    (show, "show", ROBOTS),
    (view, "view", ROBOTS),
    (simulate, "simulate", ROBOTS),
    (robots, "robots", ROBOTS),
    (judge, "judge", CODE),
    (questions, "questions", CODE),
    (vectors, "vectors", CODE),
    (export, "export", CODE),
    (recording, "recording", RECORDINGS),
    (identify, "identify", RECORDINGS),
    (excite, "excite", RECORDINGS),
    (payload, "payload", RECORDINGS),
    (study, "study", RECORDINGS),
    (bench, "bench", PROGRAM),
    (paper, "paper", PROGRAM),
    (errata, "errata", PROGRAM),
    (cache, "cache", PROGRAM),
)
"""Module, name and heading of each command: under each heading, what most people need comes first."""

FIRST_STEPS = """
You have a robot file.
  graphdyn inspect arm.urdf                      what is wrong in it, and in which line
  graphdyn crosscheck arm.urdf                   whether Pinocchio computes the same with it
You wrote a dynamics code.
  graphdyn judge arm.urdf --inverse-dynamics my_code.py:rnea
                                                 whether it is right, and what is wrong with it
You have a recording.
  graphdyn recording log.csv --robot arm.urdf    which column is what
  graphdyn identify log.csv --robot arm.urdf     inertial parameters and friction
"""
"""What to do first, for each kind of user."""

SHORT_HELP = f"""graphdyn computes the dynamics of robot arms and checks every number against Pinocchio.
{FIRST_STEPS}
No file at hand: `graphdyn robots` lists names that stand for a file, such as ur5.
`graphdyn --help` lists all commands; `graphdyn COMMAND --help` ends with examples."""
"""What the program says when nothing is asked."""

app = typer.Typer(
    cls=CommandGroup,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["--help", "-h"]},
    help="Constrained dynamics of robot arms as one linear system, checked number by number against Pinocchio.",
    epilog="`graphdyn` alone prints what to do first. `graphdyn COMMAND --help` explains a command and ends with "
    "examples. Exit codes: 0 agreed or done, 1 disagreement found, 2 bad input, 3 error of the program itself, "
    "4 further questions written, 130 interrupted, 143 terminated.",
)
CLASSES = {"identify": identify.IdentifyCommand}
"""Commands whose arguments are read in a way of their own."""

for module, name, heading in COMMANDS:
    made = app.command(name, cls=CLASSES.get(name, Command), epilog=module.EPILOG, rich_help_panel=heading)
    made(as_command(module.run))


@app.callback(invoke_without_command=True)
def options(
    context: typer.Context,
    show_version: Annotated[bool, typer.Option("--version", help="Print versions and exit.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show errors with their traceback.")] = False,
) -> None:
    if show_version:
        from crosscheck.report.records.record import versions

        for name, number in versions().items():
            typer.echo(f"{name} {number}")
        raise typer.Exit(AGREED)
    if context.invoked_subcommand is None:
        typer.echo(SHORT_HELP)
        raise typer.Exit(BAD_INPUT)


@functools.cache
def _commands() -> Any:
    """The commands with their options, made of the functions once, however often the program runs in one process."""
    return typer.main.get_command(app)


def run() -> None:
    """The command that was typed. Errors are handled in crosscheck.commands.program.exits."""
    _commands()(prog_name="graphdyn")


own_process.program = run


def main() -> None:
    """Entry point of the script."""
    refuse_closed_output()
    accept_all_characters()
    with ended_by_signals():
        run()
