"""`graphdyn show`: one robot, its graph and its equations."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from crosscheck.commands.program.console import warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.options import (
    EXAMPLES,
    HtmlOption,
    JsonOption,
    LockOption,
    RobotArgument,
    locked_joints,
)
from crosscheck.commands.program.three_d import ThreeDOption, refuse_without_page, standing
from crosscheck.commands.show.states import StateOption, given_state

Reference = Literal["world", "local", "local_world_aligned"]

EPILOG = f"""{EXAMPLES}  graphdyn show kr500
  graphdyn show z1 --lock jointGripper=0 --html z1.html
  graphdyn show my_arm.urdf --json my_arm.json
  graphdyn show ur5 --state 0,-1.2,1.5,0,0.3,0
  graphdyn show ur5 --state random:7 --frame tool0 --reference local
"""

FrameOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="Whose Jacobian, with --state; the last frame of the last body.")
]
ReferenceOption = Annotated[
    Reference | None,
    typer.Option(help="Point and axes of the Jacobian, as in Pinocchio; local_world_aligned if left out."),
]


def run(
    robot: RobotArgument,
    lock: LockOption = None,
    state: StateOption = None,
    frame: FrameOption = None,
    reference: ReferenceOption = None,
    json_file: JsonOption = None,
    html_file: HtmlOption = None,
    three_d: ThreeDOption = False,
) -> None:
    """Show a robot: bodies, joints, graph and equations.

    Masses and moments with their physical consistency, joints with placement and limits, named frames, the matrices
    of the graph, and where the matrix of Eq. (111) has its entries.

    With --state also what the robot is like there: energies, center of mass, momentum, torque against gravity, mass
    matrix, where its links are, and the Jacobian of a frame.
    """
    if state is None and (frame is not None or reference is not None):
        raise typer.BadParameter("--frame and --reference say whose Jacobian is shown; it takes a --state")
    refuse_without_page(three_d, html_file)
    import urdf
    from crosscheck.commands.show.describing import describe
    from crosscheck.commands.show.describing_state import describe_state
    from crosscheck.commands.show.report import show_report
    from crosscheck.reference.subject import tip
    from crosscheck.report.report import with_stage

    reading = urdf.Reading(lock=locked_joints(lock) or None)
    with warnings_shown():
        model = urdf.load(robot, reading=reading)
    there, q = None, None
    if state is not None:
        q, v = given_state(state, model)
        there = describe_state(model, q, v, frame or tip(model), reference or "local_world_aligned")
    report = show_report(describe(model, robot, reading.locked, there), model)
    if three_d:
        report = with_stage(report, [standing(robot, model, reading, q)])
    deliver(report, html_file, json_file)
