"""`graphdyn inspect`: what is odd or wrong about URDF files."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import typer

from crosscheck.commands.program.console import complain, err, progress
from crosscheck.commands.program.finding_options import FindingOptions, deliver_findings
from crosscheck.commands.program.options import EXAMPLES, ReportOptions, files_below, robot_names
from crosscheck.commands.program.reading_options import ReadingOptions, refuse_for_several
from crosscheck.report.findings.failures import failure
from graphdyn import GraphDynError

EPILOG = f"""{EXAMPLES}  graphdyn inspect kr500
  graphdyn inspect my_arm.urdf --html findings.html
  graphdyn inspect ur5 --meshes detail
  graphdyn inspect my_robots/ --json findings.json
  graphdyn inspect my_robots/ --fail-on warning --baseline before.sarif --sarif now.sarif
"""


@dataclass(frozen=True, kw_only=True)
class InspectOptions(ReadingOptions, FindingOptions, ReportOptions):
    """What `graphdyn inspect` is asked for."""

    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE|NAME|FOLDER...",
            help="URDF, .xacro or MJCF files, names (`graphdyn robots`), or folders, searched for *.urdf.",
            autocompletion=robot_names,
        ),
    ]
    meshes: Annotated[
        Literal["summary", "detail", "off"],
        typer.Option(help="Compare inertials with meshes: summary of those that do not fit, every tensor, or not."),
    ] = "summary"
    fail_on: Annotated[
        Literal["error", "warning"],
        typer.Option(
            help="What makes the command fail: error: a file is not good for dynamics; warning: every warning too."
        ),
    ] = "error"


def run(context: typer.Context, options: InspectOptions) -> None:
    """Find what is odd or wrong in URDF files.

    Every fault and oddity with its line, what other readers make of it, and what to do; and whether the file is good
    for dynamics. Several files are inspected in parallel, and compared: masses in the ratio of two
    materials, inertials copied from one robot to another. Exit code 0: all are good for dynamics; 1: some file is
    refused or good for kinematics only; 2: a file or folder cannot be found or read.
    """
    from crosscheck.commands.inspect.checks import inspect_checks
    from crosscheck.commands.inspect.many_files import inspect_files
    from crosscheck.commands.inspect.report import inspect_report
    from urdf import inspect
    from urdf.inspection import compared

    accepted = options.accepted("inspect")
    robots, failures = [], []
    for given in options.files:
        try:
            robots += _found(given)
        except GraphDynError as error:
            complain(error, context)
            failures.append(failure(given, error))
    if len(robots) > 1:
        refuse_for_several(options.reading)
    examine = partial(inspect, meshes=options.meshes, reading=options.reading)
    with progress("inspect", len(robots) if err.is_terminal else None) as advance:
        reports = inspect_files(robots, advance, examine)
    reports = compared(reports)
    checks = inspect_checks(reports, failures, options.fail_on)
    report = inspect_report(reports, failures)
    raise typer.Exit(deliver_findings("inspect", checks, report, options, accepted))


def _found(given: str) -> list[str]:
    """The files that an argument stands for. Raises RobotNotFound where there is none."""
    from urdf.document import locate

    if Path(given).is_dir():
        return files_below(given)
    locate(given)
    return [given]
