"""`graphdyn show`: one robot, its graph and its equations, and what it is like at a given state."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from crosscheck.commands.program.console import warnings_shown
from crosscheck.commands.program.delivery import deliver, figure_at_rest
from crosscheck.commands.program.options import EXAMPLES, PageOptions, RobotArgument
from crosscheck.commands.program.reading_options import ReadingOptions
from graphdyn.errors import counted

if TYPE_CHECKING:
    from graphdyn import RobotModel
    from graphdyn.layout import Array

Reference = Literal["world", "local", "local_world_aligned"]

EPILOG = f"""{EXAMPLES}  graphdyn show kr500
  graphdyn show z1 --lock jointGripper=0 --html z1.html
  graphdyn show my_arm.urdf --json my_arm.json
  graphdyn show ur5 --state 0,-1.2,1.5,0,0.3,0
  graphdyn show ur5 --state random:7 --frame tool0 --reference local
  graphdyn show my_arm.urdf --dh standard
  graphdyn show my_arm.urdf --proofs
"""


@dataclass(frozen=True, kw_only=True)
class ShowOptions(ReadingOptions, PageOptions):
    """What `graphdyn show` is asked for."""

    robot: RobotArgument
    state: Annotated[
        str | None,
        typer.Option(
            metavar="Q[,V]|FILE|random[:SEED]",
            help="A state: n joint positions, or n positions and n velocities, with commas ('Q;V' with a semicolon) "
            "[rad or m, …/s]; a JSON file with q and v; or a random one. The default of v is 0.",
        ),
    ] = None
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

    dh: Annotated[
        Literal["standard", "modified"] | None,
        typer.Option(
            "--dh",
            help="The table of Denavit-Hartenberg parameters of a serial robot, with base and tool (docs/dh.md); "
            "`graphdyn export --to dh` writes it.",
        ),
    ] = None
    proofs: Annotated[
        bool,
        typer.Option(
            "--proofs",
            help="What can be proven of inertias, mass matrix and equations, at the --state or a random one; needs the "
            "extra exact.",
        ),
    ] = False


def run(options: ShowOptions) -> None:
    """Show a robot: bodies, joints, graph and equations.

    Masses and moments with their physical consistency, joints with placement and limits, named frames, the matrices
    of the graph, and where the matrix of Eq. (111) has its entries.

    With --state also what the robot is like there: energies, center of mass, momentum, torque against gravity, mass
    matrix, where its links are, and the Jacobian of a frame. With --proofs what is proven of it, without tolerances:
    which inertias a real body can have, and whether the mass matrix is positive definite and the equations regular.
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
    table = None if options.dh is None else urdf.dh_table(model, options.dh)
    report = show_report(describe(model, robot, reading, there, options.proofs, table))
    deliver(report, options, lambda: [figure_at_rest(robot, model, reading, q)])


def given_state(text: str, model: RobotModel) -> tuple[Array, Array]:
    """q, v (n,). Raises typer.BadParameter, also for wrong lengths, NaN and infinity."""
    from graphdyn import InvalidInput
    from graphdyn.arguments import one_state

    q, v = _random(text, model) if text.partition(":")[0] == "random" else _written(text, model.nv)
    try:
        state = one_state(model, q=q, v=v)
    except InvalidInput as error:
        raise typer.BadParameter(f"--state {text}: {error}") from None
    return state["q"], state["v"]


def _random(text: str, model: RobotModel) -> tuple[Any, Any]:
    import numpy as np

    seed = text.partition(":")[2] or "0"
    if not seed.isdecimal():
        raise typer.BadParameter(f"--state {text}: '{seed}' is not a seed, a whole number from 0 on")
    return model.random_state(np.random.default_rng(int(seed)))


def _written(text: str, n: int) -> tuple[Any, Any]:
    file = Path(text)
    if text.lower().endswith(".json") or file.is_file():
        return _from_file(file, n)
    first, semicolon, second = text.partition(";")
    q = _numbers(text, first)
    if semicolon:
        return q, _numbers(text, second)
    if len(q) not in (n, 2 * n):
        raise typer.BadParameter(
            f"--state has {counted(len(q), 'number')}; the robot needs {n} for q, or {2 * n} for q and v"
        )
    return q[:n], q[n:] or [0.0] * n


def _numbers(text: str, part: str) -> list[float]:
    from crosscheck.judging.exchange.printed_numbers import printed_number

    found = [printed_number(number.strip()) for number in part.split(",")]
    if None in found:
        wanted = "give numbers with commas, a JSON file with q and v, or random"
        raise typer.BadParameter(f"--state {text}: '{part}' is not a row of numbers; {wanted}")
    return [number for number in found if number is not None]


def _from_file(file: Path, n: int) -> tuple[Any, Any]:
    """Fields q and v of the one object in a JSON file. Raises OSError too."""
    from crosscheck.judging.exchange.printed_numbers import UnreadableAnswer, read_json

    try:
        record = read_json(file.read_bytes())
    except UnreadableAnswer as error:
        raise typer.BadParameter(f"--state {file}: {error}") from None
    if not isinstance(record, dict) or "q" not in record:
        raise typer.BadParameter(f"""--state {file}: has no field q; write {{"q": […], "v": […]}}""")
    return record["q"], record.get("v", [0.0] * n)
