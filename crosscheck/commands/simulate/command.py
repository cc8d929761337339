"""`graphdyn simulate`: a robot in motion, written as a recording."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from crosscheck.commands.program.console import progress, warnings_shown
from crosscheck.commands.program.delivery import deliver, simulated
from crosscheck.commands.program.functions import user_function
from crosscheck.commands.program.options import EXAMPLES, PageOptions, RobotArgument, command_line
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import ReadingOptions
from crosscheck.commands.program.recording_options import numbers
from graphdyn.errors import counted

if TYPE_CHECKING:
    from graphdyn import RobotModel, Simulation

EPILOG = f"""{EXAMPLES}  graphdyn simulate ur5 --duration 3 --html fall.html
  graphdyn simulate arm.urdf --torque hold --velocity 0.5,0,0,0,0,0 --out run.parquet
  graphdyn simulate arm.urdf --torque control.py:torque --friction --rate 500 --out run.mcap
"""

HOLDING = 12.0
"""Natural frequency of the joints that --torque hold holds [rad/s], critically damped: two hertz."""

MILLISECONDS = 1000

STEP = 1e-3


@dataclass(frozen=True, kw_only=True)
class IntegrationOptions:
    """How the motion is integrated, and what limits it."""

    PANEL: ClassVar[str] = "Integration, friction and limits"

    rate: Annotated[float, typer.Option(metavar="HZ", help="Rows per second of the result.")] = 1000.0
    method: Annotated[
        str, typer.Option(metavar="dop853|rk8|rk4|euler", help="Integrator; dop853 adapts its step, the others do not.")
    ] = "dop853"
    step: Annotated[
        float | None, typer.Option(metavar="S", show_default=str(STEP), help="Step of the other integrators [s].")
    ] = None
    friction: Annotated[bool, typer.Option("--friction", help="Include the file's damping and friction.")] = False
    limits: Annotated[bool, typer.Option("--limits", help="Stop at a position limit of the file.")] = False
    efforts: Annotated[bool, typer.Option("--efforts", help="Limit torques to the efforts of the file.")] = False


@dataclass(frozen=True, kw_only=True)
class SimulateOptions(IntegrationOptions, ReadingOptions, PageOptions):
    """What `graphdyn simulate` is asked for."""

    robot: RobotArgument
    torque: Annotated[
        str,
        typer.Option(
            metavar="zero|hold|FILE.py:NAME",
            help="Actuator torque: zero; computed torque that holds the initial position; or a function (t, q, v) → τ, "
            "arrays of shape (n,).",
        ),
    ] = "zero"
    duration: Annotated[float, typer.Option(metavar="S", help="Simulated time [s].")] = 5.0
    position: Annotated[
        str | None,
        typer.Option(
            metavar="Q,Q,…",
            show_default="0, or a regular pose of a robot with loops",
            help="Initial position [rad or m]. Loops are closed near it.",
        ),
    ] = None
    velocity: Annotated[
        str | None, typer.Option(metavar="V,V,…", show_default="0", help="Initial velocity [rad/s or m/s].")
    ] = None
    out: Annotated[
        OutputFile | None,
        typer.Option(
            metavar="FILE", parser=OutputFile, help="Write the motion to FILE: .parquet, .csv, .npz, or .mcap for ROS."
        ),
    ] = None


def run(options: SimulateOptions) -> None:
    """Let a robot move, and record it.

    Torques of the actuators give the motion, with all reactions of the joints. The balance of energy and the closure of
    the joints are checked and told. What --out writes is a recording that `graphdyn identify` reads; Parquet, .npz and
    MCAP carry the URDF and all settings.
    """
    robot, torque, out, reading = options.robot, options.torque, options.out, options.reading
    function = None if torque in ("zero", "hold") else user_function("--torque", torque)
    step = STEP if options.step is None and options.method != "dop853" else options.step
    if out is not None:
        _check_suffix(out)
    if not (options.rate > 0 and options.duration > 0):
        raise typer.BadParameter("--rate and --duration must be above zero")
    import urdf
    from crosscheck.commands.simulate.record import SimulatedRun
    from crosscheck.commands.simulate.report import simulate_report
    from graphdyn import ComputedTorqueControl

    with warnings_shown():
        model = urdf.load(robot, reading=reading)
    q, v = _start(model, options.position, options.velocity)
    how = {
        "torque": ComputedTorqueControl(HOLDING**2, 2 * HOLDING, q) if torque == "hold" else function,
        "method": options.method,
        "step": step,
        "friction": "model" if options.friction else None,
        "limits": "stop" if options.limits else None,
        "torque_limits": "model" if options.efforts else None,
        "at": _times(options.duration, options.rate),
    }
    motion = _simulated(model, q, v, options.duration, how, robot)
    if out is not None:
        settings = {"robot": robot, "locked": reading.locked, "chain": reading.chain}
        _write(motion, out, {**settings, "torque": torque, "position": q, "velocity": v})
    shown = SimulatedRun(motion, robot, reading, torque, options.method, step, out.name if out else None)
    deliver(simulate_report(shown), options, lambda: [simulated(robot, motion, reading)])


def _simulated(
    model: RobotModel, q: list[float], v: list[float], duration: float, how: dict[str, Any], robot: str
) -> Simulation:
    from graphdyn import simulate

    reached = 0
    with progress(Path(robot).name, round(duration * MILLISECONDS)) as advance:

        def tell(time: float) -> None:
            nonlocal reached
            now = max(round(time * MILLISECONDS), reached)
            advance(f"{time:.3g} s", now - reached)
            reached = now

        return simulate(model, q, v, duration, progress=tell, **how)


def _times(duration: float, rate: float) -> list[float]:
    """Rows at the rate, and the end."""
    count = int(duration * rate * (1 + 1e-9))
    times = [k / rate for k in range(count + 1)]
    return times if times[-1] >= duration * (1 - 1e-9) else [*times, duration]


def _start(model: RobotModel, position: str | None, velocity: str | None) -> tuple[list[float], list[float]]:
    """q and v; of a robot with loops the closed state near these, or in a regular pose. Raises typer.BadParameter."""
    q, v = (_numbers(option, text, model) for option, text in (("--position", position), ("--velocity", velocity)))
    if not model.chords:
        return q, v
    from graphdyn import assemble

    closed, rate = assemble(model, model.regular_pose if position is None else q, v)
    return closed.tolist(), rate.tolist()


def _numbers(option: str, text: str | None, model: RobotModel) -> list[float]:
    """One number per joint that no others drive. Raises typer.BadParameter."""
    if text is None:
        return [0.0] * model.nv
    found = numbers(option, text)
    if len(found) != model.nv:
        names = ", ".join(model.independent_joints)
        raise typer.BadParameter(
            f"{option} has {counted(len(found), 'number')} for {counted(model.nv, 'joint')}: {names}"
        )
    return found


def _check_suffix(out: OutputFile) -> None:
    from crosscheck.recordings.formats.format import written_suffixes

    if out.is_standard_output or out.path.suffix.lower() not in written_suffixes():
        raise typer.BadParameter(f"--out {out.name}: name a file that ends with {', '.join(written_suffixes())}")


def _write(motion: Simulation, out: OutputFile, settings: dict[str, Any]) -> None:
    """The motion as a recording, with the robot as URDF, and what it was simulated with."""
    from crosscheck.recordings.formats.format import motion_document
    from crosscheck.report.records.record import versions
    from urdf.writing import urdf_document

    told = {**settings, "gravity": motion.model.gravity.tolist(), "command": command_line(), "versions": versions()}
    metadata = {"urdf": urdf_document(motion.model).decode(), "simulation": json.dumps(told, ensure_ascii=False)}
    out.write(motion_document(motion if motion.model.chords else motion.recording(), out.path, metadata))
