"""`graphdyn show`: one robot, its graph and its equations."""

from __future__ import annotations

from crosscheck.cli.console import warnings_shown
from crosscheck.cli.delivery import deliver
from crosscheck.cli.options import (
    EXAMPLES,
    HtmlOption,
    JsonOption,
    LockOption,
    RobotArgument,
    locked_joints,
)

EPILOG = f"""{EXAMPLES}  graphdyn show kr500
  graphdyn show z1 --lock jointGripper=0 --html z1.html
  graphdyn show my_arm.urdf --json my_arm.json
"""


def run(
    robot: RobotArgument,
    lock: LockOption = None,
    json_file: JsonOption = None,
    html_file: HtmlOption = None,
) -> None:
    """Show a robot: bodies, joints, graph and equations.

    Masses and moments with their physical consistency, joints with placement and limits, named frames, the matrices
    of the graph, and where the matrix of Eq. (111) has its entries.
    """
    locked = locked_joints(lock)
    import urdf
    from crosscheck.report.commands.show import show_report
    from crosscheck.report.describing import describe

    with warnings_shown():
        model = urdf.load(robot, lock=locked or None)
    deliver(show_report(describe(model, robot, locked), model), html_file, json_file)
