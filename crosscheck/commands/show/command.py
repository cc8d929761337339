"""`graphdyn show`: one robot, its graph and its equations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import typer

from crosscheck.commands.program.console import warnings_shown
from crosscheck.commands.program.delivery import deliver, figure_at_rest
from crosscheck.commands.program.options import EXAMPLES, PageOptions, RobotArgument
from crosscheck.commands.program.reading_options import ReadingOptions
from crosscheck.commands.show.states import StateOption, given_state

Reference = Literal["world", "local", "local_world_aligned"]

EPILOG = f"""{EXAMPLES}  graphdyn show kr500
  graphdyn show z1 --lock jointGripper=0 --html z1.html
  graphdyn show my_arm.urdf --json my_arm.json
  graphdyn show ur5 --state 0,-1.2,1.5,0,0.3,0
  graphdyn show ur5 --state random:7 --frame tool0 --reference local
"""


@dataclass(frozen=True, kw_only=True)
class ShowOptions(ReadingOptions, PageOptions):
    """What `graphdyn show` is asked for."""

    robot: RobotArgument
    state: StateOption = None
    frame: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            show_default="last frame of the last body",
            help="Frame of the Jacobian (with --state).",
        ),
    ] = None
    reference: Annotated[
        Reference | None,
        typer.Option(
            show_default="local_world_aligned",
            help="Point and axes of the Jacobian (with --state), named as in Pinocchio.",
        ),
    ] = None


def run(options: ShowOptions) -> None:
    """Show a robot: bodies, joints, graph and equations.

    Masses and moments with their physical consistency, joints with placement and limits, named frames, the matrices
    of the graph, and where the matrix of Eq. (111) has its entries.

    With --state also what the robot is like there: energies, center of mass, momentum, torque against gravity, mass
    matrix, where its links are, and the Jacobian of a frame.
    """
    robot, frame, reading = options.robot, options.frame, options.reading
    if options.state is None and (frame is not None or options.reference is not None):
        raise typer.BadParameter("--frame and --reference say whose Jacobian is shown; it takes a --state")
    import urdf
    from crosscheck.commands.show.description import describe
    from crosscheck.commands.show.report import show_report
    from crosscheck.commands.show.state import describe_state
    from crosscheck.reference.subject import tip

    with warnings_shown():
        model = urdf.load(robot, reading=reading)
    there, q = None, None
    if options.state is not None:
        q, v = given_state(options.state, model)
        there = describe_state(model, q, v, frame or tip(model), options.reference or "local_world_aligned")
    report = show_report(describe(model, robot, reading.locked, there))
    deliver(report, options, lambda: [figure_at_rest(robot, model, reading, q)])
