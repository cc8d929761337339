"""`graphdyn crosscheck`: graphdyn against Pinocchio."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import typer

from crosscheck.commands.crosscheck.options import CrosscheckOptions
from crosscheck.commands.program.console import complain, err, progress, warnings_shown
from crosscheck.commands.program.delivery import figure_at_rest
from crosscheck.commands.program.finding_options import deliver_findings
from crosscheck.commands.program.options import (
    EXAMPLES,
    is_folder,
)
from crosscheck.commands.program.reading_options import refuse_for_several
from crosscheck.commands.program.settings import refuse
from crosscheck.report.findings.failures import failure
from graphdyn import GraphDynError

if TYPE_CHECKING:
    from crosscheck.viewing.figures import Figure

DEFAULT_ROBOTS: tuple[tuple[str, Mapping[str, float]], ...] = (
    ("kr500", {}),
    ("ur3", {}),
    ("ur5", {}),
    ("ur10", {}),
    ("kinova", {}),
    ("z1", {"jointGripper": 0.0}),
)
"""The robots of `graphdyn crosscheck` without arguments, with locked joints: six-joint arms, grippers locked."""

EPILOG = f"""{EXAMPLES}  graphdyn crosscheck ur5 --samples 100
  graphdyn crosscheck z1 --lock jointGripper=0 --json result.json
  graphdyn crosscheck talos_left_arm --chain torso_2_link gripper_left_base_link
  graphdyn crosscheck kr500 my_arm.urdf --html result.html
  graphdyn crosscheck my_robots/ --samples 200 --json sweep.json --resume
  graphdyn crosscheck ur5 --exact 100 --html errors.html
  graphdyn crosscheck my_robots/ --junit robots.xml --sarif robots.sarif
"""


def run(context: typer.Context, options: CrosscheckOptions) -> None:
    """Compare graphdyn with Pinocchio on robots of your choice.

    Every quantity is compared at random and special states: placements, torques, wrenches, multipliers, accelerations,
    regressors, identified parameters. Without a robot, six arms are compared.
    A folder stands for every *.urdf below it: one row per file; a file that cannot be compared does not stop the rest.
    With --exact, graphdyn, Pinocchio and, where installed, MuJoCo are compared with exact values instead: who errs, and
    by how much.
    """
    robots, reading, json_file = options.robots or [], options.reading, options.json_file
    folder = any(map(is_folder, robots))
    if folder or len(robots) != 1:
        refuse_for_several(reading)
    if (options.jobs or options.scheduler or options.resume) and not folder:
        raise typer.BadParameter("--jobs, --scheduler and --resume are for folders")
    if options.resume and (json_file is None or not json_file.is_regular):
        raise typer.BadParameter("--resume needs --json FILE, whose results it takes over")
    if options.exact is not None:
        refuse(options, ("samples", "resume"), "is not for --exact [N], which says how many random states are measured")
        options.refuse("is not for --exact, which measures errors and finds no fault")
    else:
        refuse(options, ("truth",), "is for --exact")
    if folder and options.three_d:
        raise typer.BadParameter("--3d is not for folders; name the robots")
    if folder and reading.stated:
        raise typer.BadParameter(f"--{reading.stated[0]} is not for folders; name the robots")
    from urdf import Reading

    choice = [(robot, reading) for robot in robots]
    choice = choice or [(robot, Reading(lock=locked)) for robot, locked in DEFAULT_ROBOTS]
    if options.exact is not None:
        from crosscheck.commands.crosscheck.exact.command import measure

        raise typer.Exit(measure(context, options, choice))
    if folder:
        from crosscheck.commands.crosscheck.folder import compare_folder

        raise typer.Exit(compare_folder(context, options))
    from crosscheck.commands.crosscheck.checks import crosscheck_checks
    from crosscheck.commands.crosscheck.record import robot_record
    from crosscheck.commands.crosscheck.report import crosscheck_report
    from crosscheck.comparing.compare import compare, count_states
    from crosscheck.report.records.record import plain

    accepted = options.accepted("crosscheck")
    comparisons, failures = [], []
    for number, (robot, how) in enumerate(choice, start=1):
        title = robot if len(choice) == 1 else f"{robot} ({number} of {len(choice)})"
        try:
            total = count_states(robot, options.samples, options.seed, how) if err.is_terminal else None
            with progress(title, total) as advance, warnings_shown():
                comparisons.append(compare(robot, options.samples, options.seed, reading=how, progress=advance))
        except (GraphDynError, OSError) as error:
            complain(error, context)
            failures.append(failure(robot, error))
    checks = crosscheck_checks([plain(robot_record(comparison)) for comparison in comparisons], failures)
    report = crosscheck_report(comparisons, failures)

    def figures() -> list[Figure]:
        return [figure_at_rest(one.robot, one.model, one.reading) for one in comparisons]

    raise typer.Exit(deliver_findings("crosscheck", checks, report, options, accepted, figures))
