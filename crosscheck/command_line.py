"""The program `graphdyn`. Exit codes: 0 agreed or done, 1 disagreement found, 2 bad input."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

import urdf
from crosscheck.compare import compare
from crosscheck.errata import ERRATA, measure
from crosscheck.report import JSON_FORMAT, as_json, detail, finite, footnotes, heading, overview, versions, write_json
from crosscheck.result import Comparison
from graphdyn import GraphDynError

AGREED, DISAGREED, BAD_INPUT = 0, 1, 2

DEFAULT_ROBOTS: tuple[tuple[str, Mapping[str, float]], ...] = (
    ("kr500", {}),
    ("ur3", {}),
    ("ur5", {}),
    ("ur10", {}),
    ("kinova", {}),
    ("z1", {"jointGripper": 0.0}),
)
"""What `graphdyn crosscheck` runs without arguments: six-joint arms, grippers locked."""

WIDTH = 120
"""Characters of a line where the output is not a terminal (a log, a file, a pipe)."""

app = typer.Typer(
    no_args_is_help=True,
    add_completion=True,
    rich_markup_mode=None,
    help="Constrained dynamics of robot arms as one linear system, proved number by number against Pinocchio.",
)
err = Console(stderr=True, markup=False, highlight=False)
out = Console(markup=False, highlight=False, width=None if sys.stdout.isatty() else WIDTH)

JsonOption = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write all numbers to FILE.")]
SeedOption = Annotated[int, typer.Option(min=0, help="Seed of the random states.")]


def main() -> None:
    """Entry point: errors that are the user's to mend are one line and exit code 2."""
    try:
        app()
    except (GraphDynError, OSError) as error:
        _complain(str(error))
        sys.exit(BAD_INPUT)


@app.callback(invoke_without_command=True)
def _options(
    show_version: Annotated[bool, typer.Option("--version", help="Print versions and leave.")] = False,
) -> None:
    if show_version:
        for name, number in versions().items():
            typer.echo(f"{name} {number}")
        raise typer.Exit(AGREED)


@app.command("crosscheck")
def crosscheck_command(
    robots: Annotated[
        list[str] | None,
        typer.Argument(metavar="[ROBOT]...", help="Names (`graphdyn robots`) or URDF files; six arms if none."),
    ] = None,
    samples: Annotated[int, typer.Option(min=1, help="Random states per robot.")] = 1000,
    seed: SeedOption = 0,
    lock: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT[=VALUE]", help="Freeze a joint at VALUE [rad or m], 0 if left out. Repeatable."),
    ] = None,
    json_file: JsonOption = None,
) -> None:
    """Compare graphdyn with Pinocchio on every quantity: torques, wrenches, multipliers, accelerations, regressors.

    Example: graphdyn crosscheck ur5 my_arm.urdf --json result.json
    """
    locked = dict(_parse_lock(text) for text in lock or ())
    if locked and len(robots or ()) != 1:
        raise typer.BadParameter("--lock needs exactly one robot, whose joints it names")
    jobs = [(robot, locked) for robot in robots] if robots else list(DEFAULT_ROBOTS)
    if json_file is not None:
        _check_writable(json_file)
    comparisons, failures = [], []
    for robot, frozen in jobs:
        try:
            with _progress(robot) as progress, _warnings_shown():
                comparisons.append(compare(robot, samples, seed, lock=frozen or None, progress=progress))
        except (GraphDynError, OSError) as error:
            _complain(str(error))
            failures.append({"robot": robot, "message": str(error)})
    _print(comparisons)
    if json_file is not None:
        record = {
            "format": JSON_FORMAT,
            "versions": versions(),
            "command": ["graphdyn", *sys.argv[1:]],
            "agrees": all(comparison.agrees for comparison in comparisons) and not failures,
            "robots": [as_json(comparison) for comparison in comparisons],
            "failures": failures,
        }
        write_json(json_file, record)
    if failures:
        raise typer.Exit(BAD_INPUT)
    raise typer.Exit(AGREED if all(comparison.agrees for comparison in comparisons) else DISAGREED)


@app.command("robots")
def robots_command(json_file: JsonOption = None) -> None:
    """List the robots known by name, with origin and licence.

    Example: graphdyn robots
    """
    if json_file is not None:
        _check_writable(json_file)
    table = Table("name", "origin", "licence")
    entries = urdf.robots()
    for entry in entries:
        table.add_row(entry.name, entry.origin, entry.licence)
    out.print(table)
    if json_file is not None:
        rows = [{"name": e.name, "path": str(e.path), "origin": e.origin, "licence": e.licence} for e in entries]
        write_json(json_file, {"format": "graphdyn robots 1", "robots": rows})


@app.command("errata")
def errata_command(
    samples: Annotated[int, typer.Option(min=10, help="Random states per robot.")] = 1000,
    seed: SeedOption = 0,
    json_file: JsonOption = None,
) -> None:
    """Measure what each printed error of the paper does when it is put back into the correct model.

    Example: graphdyn errata --samples 200
    """
    if json_file is not None:
        _check_writable(json_file)
    effects = measure(samples, seed)
    table = Table("erratum", "robot", "measured", "median", "90 %", "largest", "corrected form, largest")
    for effect in effects:
        numbers = (f"{value:.2g}" for value in (effect.median, effect.upper, effect.largest, effect.corrected))
        table.add_row(effect.erratum, effect.robot, effect.measure, *numbers)
    out.print(table)
    for name, sentence in ERRATA.items():
        out.print(f"{name}: {sentence}", soft_wrap=True)
    if json_file is not None:
        rows = [finite(asdict(effect)) for effect in effects]
        write_json(json_file, {"format": "graphdyn errata 1", "versions": versions(), "effects": rows})


def _print(comparisons: Sequence[Comparison]) -> None:
    if len(comparisons) == 1:
        out.print(detail(comparisons[0], out.width))
        return
    for table in overview(comparisons, out.width):
        out.print(table)
    for comparison in comparisons:
        out.print(heading(comparison))
        for line in footnotes(comparison):
            out.print(f"  {line}")


def _parse_lock(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name, float(value) if value else 0.0
    except ValueError:
        raise typer.BadParameter(f"--lock {text}: '{value}' is not a number") from None


def _check_writable(path: Path) -> None:
    """Fail before the work, not after it."""
    if path.is_dir():
        raise typer.BadParameter(f"--json {path}: is a folder")
    if not path.resolve().parent.is_dir():
        raise typer.BadParameter(f"--json {path}: folder {path.resolve().parent} does not exist")
    if not os.access(path if path.exists() else path.resolve().parent, os.W_OK):
        raise typer.BadParameter(f"--json {path}: no permission to write there")


def _complain(message: str) -> None:
    err.print(f"error: {message}", style="red", soft_wrap=True)


@contextmanager
def _warnings_shown() -> Iterator[None]:
    """Warnings as one line each, without the source line that raised them."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    for warning in caught:
        err.print(f"warning: {warning.message}", style="yellow", soft_wrap=True)


@contextmanager
def _progress(robot: str) -> Iterator:
    """A bar on the terminal, silent elsewhere; yields the callback of compare."""
    columns = (
        TextColumn("{task.fields[robot]}", markup=False),
        BarColumn(),
        TextColumn("{task.description}", markup=False),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=err, transient=True, disable=not err.is_terminal) as bar:
        task = bar.add_task("loading", total=None, robot=robot)
        done: list[int] = []

        def advance(case: str, states: int) -> None:
            done.append(states)
            bar.update(task, description=f"{case}: {sum(done)} states")

        yield advance
