"""`graphdyn excite`: the motion from which a robot's parameters can be identified best, within its limits."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from crosscheck.commands.excite import options
from crosscheck.commands.excite.search import best_of
from crosscheck.commands.identify.options import (
    CutoffOption,
    DropOption,
    MappingOption,
    TermOption,
    cutoff_of,
    recordings,
)
from crosscheck.commands.program.console import progress, say, warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES, HtmlOption, JsonOption, LockOption, locked_joints
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.three_d import ThreeDOption, planned_figures, refuse_without_page

if TYPE_CHECKING:
    from crosscheck.exciting.excited import Excited, PlannedMotion
    from crosscheck.exciting.motion_formats.krl import AxisSettings
    from crosscheck.exciting.self_collision import SelfCollision
    from crosscheck.recordings import Recording
    from graphdyn import RobotModel
    from graphdyn.excitation import ExcitationProblem

EPILOG = f"""{EXAMPLES}  graphdyn excite --robot ur5 --out motion.csv --html plan.html
  graphdyn excite --robot arm.urdf --plane 0,0,1,0.05 --jerk 50 --out motion.yaml --out-rate 100
  graphdyn excite --robot arm.urdf --motion motion.csv --against log.csv --noise 0.5
"""


def run(
    robot: options.RobotOption,
    duration: options.DurationOption = 10.0,
    harmonics: options.HarmonicsOption = 5,
    spline: options.SplineOption = None,
    motions: options.MotionsOption = 1,
    criterion: options.CriterionOption = "log-det",
    terms: options.TermsOption = "viscous,coulomb,offset",
    term: TermOption = None,
    noise: options.NoiseOption = None,
    rate: options.RateOption = 500.0,
    velocity: options.VelocityOption = None,
    velocity_share: options.VelocityShareOption = 0.95,
    acceleration: options.AccelerationOption = "10",
    jerk: options.JerkOption = None,
    torque: options.TorqueOption = None,
    torque_share: options.TorqueShareOption = 0.8,
    lower: options.LowerOption = None,
    upper: options.UpperOption = None,
    plane: options.PlaneOption = None,
    collisions: options.CollisionsOption = True,
    clearance: options.ClearanceOption = 0.0,
    srdf: options.SrdfOption = None,
    seeds: options.SeedsOption = 5,
    seed: options.SeedOption = 0,
    jobs: options.JobsOption = None,
    random: options.RandomOption = 100,
    motion: options.MotionOption = None,
    against: options.AgainstOption = None,
    after: options.AfterOption = None,
    mapping: MappingOption = None,
    drop: DropOption = None,
    cutoff: CutoffOption = "residual",
    out: options.OutOption = None,
    out_rate: options.OutRateOption = 125.0,
    axis_signs: options.SignsOption = "1",
    axis_zeros: options.ZerosOption = "0",
    lock: LockOption = None,
    json_file: JsonOption = None,
    html_file: HtmlOption = None,
    three_d: ThreeDOption = False,
) -> None:
    """Find a motion that shows a robot's parameters.

    All joints move at once, start and stop smoothly, and keep the limits of position, velocity, acceleration, jerk and
    torque at all times, checked at 1 kHz; torques are those of the file's inertials. Links do not hit each other where
    their meshes are found, which is checked on the meshes. Before the experiment the plan states the standard deviation
    that every base parameter will have for the given noise of the torques, beside those of random motions and of your
    own recordings. Ctrl-C keeps the best motion found so far.

    By default the volume of the ellipsoid of errors is minimized. A small condition number is no aim in itself: it is
    small where all parameters are equally badly determined, and depends on how columns are scaled.

    Exit code 0: the motion keeps all limits; 1: none was found, or that of --motion violates one or collides; 2: bad
    input.
    """
    settings = options.axis_settings(axis_signs, axis_zeros)
    if out is not None:
        options.check_out(out)
    if not (out_rate > 0 and rate > 0):
        raise typer.BadParameter("--rate and --out-rate must be above zero")
    if not collisions and (clearance or srdf):
        raise typer.BadParameter("--no-collisions looks at no links: leave out --clearance and --srdf")
    if clearance == math.inf:
        raise typer.BadParameter("--clearance must be finite")
    refuse_without_page(three_d, html_file)
    import urdf
    from crosscheck.commands.excite.report import excite_report
    from crosscheck.exciting.excited import Excited, planned, random_plans, recorded_information
    from crosscheck.exciting.motion_formats.motion_file import read_motion
    from crosscheck.report.report import with_stage
    from graphdyn.compiler import cores
    from graphdyn.excitation import ExcitationProblem, FourierBasis, SplineBasis, excitation_plan
    from graphdyn.identification import TorqueModel
    from graphdyn.identification.terms import RigidBodies

    reading = urdf.Reading(lock=locked_joints(lock) or None)
    with warnings_shown():
        model = urdf.load(robot, reading=reading)
        torque_model = TorqueModel(model, (RigidBodies(), *options.terms_of(terms, term)))
        limits = options.limits_of(
            model, plane, velocity=velocity, acceleration=acceleration, jerk=jerk, torque=torque, lower=lower,
            upper=upper, velocity_share=velocity_share, torque_share=torque_share,
        )  # fmt: skip
        sizes, words = options.noise_of(noise, model)
        basis = FourierBasis(duration, harmonics) if spline is None else SplineBasis(duration, spline)
        problem = ExcitationProblem(
            torque_model, limits, basis, sizes, rate, options.criterion_of(criterion, torque_model)
        )
        known = options.collisions_of(robot, model, reading, clearance, srdf) if collisions else None
        columns = (mapping, model.independent_joints, drop or [], cutoff)
        earlier = _recordings("--after", after, *columns)
        compared = _recordings("--against", against, *columns)
    if earlier:
        problem = replace(problem, known=recorded_information(problem, earlier)[0])
    failures: list[str] = []
    if motion is None:
        made, failures = _searched(problem, known, motions, range(seed, seed + seeds), jobs or cores())
    else:
        made = [planned(problem, read_motion(motion, model, settings), known)]
    total = problem
    for one in made:
        total = replace(total, known=total.total_information(one.course))
    assert total.known is not None
    recorded = None
    if compared:
        information, rows = recorded_information(problem, compared)
        samples = sum(rate * one.course.duration for one in made)
        recorded = excitation_plan(torque_model, information * (samples / rows))
    best, median = random_plans(problem, len(made), random, known) if random else (None, None)
    found = Excited(
        robot, reading, problem, words, criterion, tuple(made), excitation_plan(torque_model, total.known), random,
        best, median, recorded, tuple(failures), known,
    )  # fmt: skip
    written = _write(found, model, out, out_rate, settings) if out is not None else ()
    report = excite_report(found, written)
    if three_d:
        report = with_stage(report, planned_figures(found))
    deliver(report, html_file, json_file)
    raise typer.Exit(DISAGREED if found.violated or found.hits else AGREED)


def _searched(
    problem: ExcitationProblem, collisions: SelfCollision | None, motions: int, seeds: range, processes: int
) -> tuple[list[PlannedMotion], list[str]]:
    """As many motions as asked for, each chosen for what the others do not show. Raises typer.Exit if there is none."""
    from crosscheck.exciting.excited import planned

    made: list[PlannedMotion] = []
    failures, known = list[str](), problem.known
    with progress("seeds", motions * len(seeds)) as advance:
        for _ in range(motions):
            trial = replace(problem, known=known)
            found = best_of(trial, collisions, seeds, processes, advance)
            failures += found.failures
            if found.best is None:
                break
            made.append(planned(problem, found.best.trajectory, collisions, found.best.seed))
            known = trial.total_information(found.best.trajectory)
            if found.interrupted:
                break
    for failure in failures:
        say(failure, "yellow")
    if not made:
        say("no motion keeps all limits", "red")
        raise typer.Exit(DISAGREED)
    return made, failures


def _recordings(
    option: str,
    logs: list[Path] | None,
    mapping: Path | None,
    joints: tuple[str, ...],
    drop: list[str],
    cutoff: str,
) -> list[Recording]:
    """Recordings with velocities and accelerations."""
    from crosscheck.recordings import differentiated

    if not logs:
        return []
    with progress("read", len(logs)) as advance:
        found = recordings(option, logs, mapping, joints, None, drop, advance)
    return [differentiated(recording, cutoff_of(cutoff)) for recording in found]


def _write(found: Excited, model: RobotModel, out: OutputFile, rate: float, settings: AxisSettings) -> tuple[str, ...]:
    """One file for each motion; their names."""
    from crosscheck.exciting.motion_formats.motion_file import document, slides
    from crosscheck.exciting.motion_formats.timed_motion import TimedMotion

    names = []
    for number, one in enumerate(found.motions, start=1):
        name = out.path if len(found.motions) == 1 else out.path.with_stem(f"{out.path.stem}-{number}")
        timed = TimedMotion.of(one.course, model.independent_joints, slides(model), rate)
        OutputFile(str(name)).write(document(timed, name, settings))
        names.append(str(name))
    return tuple(names)
