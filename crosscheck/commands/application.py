"""The program as a whole: its commands in the order of its help, and the options that come before a command."""

from __future__ import annotations

import functools
from typing import Annotated, Any

import typer

from crosscheck.commands.bench import command as bench
from crosscheck.commands.cache import command as cache
from crosscheck.commands.crosscheck import command as crosscheck
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
from crosscheck.commands.program.exits import AGREED, Command, CommandGroup, ended_by_signals, refuse_closed_output
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

COMMANDS = (
    (crosscheck.run, "crosscheck", crosscheck.EPILOG),
    (judge.run, "judge", judge.EPILOG),
    (questions.run, "questions", questions.EPILOG),
    (show.run, "show", show.EPILOG),
    (view.run, "view", view.EPILOG),
    (export.run, "export", export.EPILOG),
    (vectors.run, "vectors", vectors.EPILOG),
    (inspect.run, "inspect", inspect.EPILOG),
    (repair.run, "repair", repair.EPILOG),
    (recording.run, "recording", recording.EPILOG),
    (identify.run, "identify", identify.EPILOG),
    (payload.run, "payload", payload.EPILOG),
    (simulate.run, "simulate", simulate.EPILOG),
    (excite.run, "excite", excite.EPILOG),
    (study.run, "study", study.EPILOG),
    (paper.run, "paper", paper.EPILOG),
    (bench.run, "bench", bench.EPILOG),
    (robots.run, "robots", robots.EPILOG),
    (errata.run, "errata", errata.EPILOG),
    (cache.run, "cache", cache.EPILOG),
)
"""Function, name and examples of each command."""

FIRST_STEPS = """\b
First commands:
  of a robot file     graphdyn inspect arm.urdf
  of dynamics code    graphdyn judge arm.urdf --inverse-dynamics my_code.py:rnea
  of a recording      graphdyn recording log.csv --robot arm.urdf
"""
"""The first command for each kind of user; \\b keeps the line breaks."""

app = typer.Typer(
    cls=CommandGroup,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["--help", "-h"]},
    help=f"""Constrained dynamics of robot arms as one linear system, checked number by number against Pinocchio.

{FIRST_STEPS}""",
    epilog="`graphdyn COMMAND --help` explains a command and ends with examples. Exit codes: 0 agreed or done, "
    "1 disagreement found, 2 bad input, 3 error of the program itself, 4 further questions written, 130 interrupted, "
    "143 terminated.",
)
CLASSES = {"identify": identify.IdentifyCommand}
"""Commands whose arguments are read in a way of their own."""

for function, name, epilog in COMMANDS:
    app.command(name, cls=CLASSES.get(name, Command), epilog=epilog)(as_command(function))


@app.callback(invoke_without_command=True)
def options(
    show_version: Annotated[bool, typer.Option("--version", help="Print versions and exit.")] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show errors with their traceback.")] = False,
) -> None:
    if show_version:
        from crosscheck.report.records.record import versions

        for name, number in versions().items():
            typer.echo(f"{name} {number}")
        raise typer.Exit(AGREED)


@functools.cache
def _commands() -> Any:
    """The commands with their options, made of the functions once, however often the program runs in one process."""
    return typer.main.get_command(app)


def run() -> None:
    """The command that was typed. Errors are handled in crosscheck.commands.program.exits."""
    _commands()()


own_process.program = run


def main() -> None:
    """Entry point of the script."""
    refuse_closed_output()
    accept_all_characters()
    with ended_by_signals():
        run()
