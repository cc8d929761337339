"""`graphdyn excite`: the motion from which a robot's parameters can be identified best, within its limits.

It is searched for from several seeds in parallel; the best is kept, also after an interruption.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import typer

from crosscheck.commands.excite.options import FEWEST_HARMONICS, HARMONICS_STEP, MOST_HARMONICS, ExciteOptions
from crosscheck.commands.program.console import progress, say, warnings_shown
from crosscheck.commands.program.delivery import deliver, planned_figures
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import reading_arguments
from crosscheck.commands.program.recording_options import show_findings
from crosscheck.distributing import LocalProcesses, Lost

if TYPE_CHECKING:
    from crosscheck.exciting.encoder_noise import EncoderNoise
    from crosscheck.exciting.excited import Excited, PlannedMotion
    from crosscheck.exciting.motion_formats.krl import AxisSettings
    from crosscheck.exciting.self_collision import SelfCollision
    from crosscheck.recordings import Recording
    from graphdyn import RobotModel
    from graphdyn.excitation import ExcitationProblem, OptimizedMotion, Trajectory
    from graphdyn.layout import Array

EPILOG = f"""{EXAMPLES}  graphdyn excite --robot ur5 --out motion.csv --html plan.html
  graphdyn excite --robot arm.urdf --plane 0,0,1,0.05 --jerk 50 --out motion.yaml --out-rate 100
  graphdyn excite --robot arm.urdf --motion motion.csv --against log.csv --noise 0.5
"""


def run(options: ExciteOptions) -> None:
    """Find a motion that shows a robot's parameters.

    All joints move at once, start and stop smoothly, and keep the limits of position, velocity, acceleration, jerk and
    torque at all times, checked at 1 kHz; torques are those of the file's inertials. Links do not hit each other where
    their meshes are found, which is checked on the meshes. Before the experiment the plan states the standard deviation
    that every base parameter will have for the given noise of the torques, beside those of random motions and of your
    own recordings. With --position-noise it also states scatter and bias after low-pass and differences, on virtual
    recordings. Ctrl-C keeps the best motion found so far.

    By default the volume of the ellipsoid of errors is minimized. A small condition number is no aim in itself: it is
    small where all parameters are equally badly determined, and depends on how columns are scaled.

    Exit code 0: the motion keeps all limits; 1: none was found, or that of --motion violates one or collides; 2: bad
    input.
    """
    settings, reading = options.axis_settings, options.reading
    import urdf
    from crosscheck.commands.excite.report import excite_report
    from crosscheck.exciting.encoder_noise import encoder_plan
    from crosscheck.exciting.excited import Excited, planned, random_plans, recorded_information
    from crosscheck.exciting.motion_formats.motion_file import read_motion
    from graphdyn.excitation import excitation_plan

    with warnings_shown():
        model = urdf.load(options.robot, reading=reading)
        with progress("robot"):
            problem, words = options.problem(model)
            known = options.self_collision(model)
        earlier = _recordings(options, "--after", options.after, model)
        compared = _recordings(options, "--against", options.against, model)
    if earlier:
        problem = replace(problem, known=recorded_information(problem, earlier)[0])
    noise = options.encoder
    if noise is not None:
        noise = replace(noise, others=tuple(earlier))
    failures: list[str] = []
    if options.motion is None:
        problem, made, failures = _searched(problem, known, noise, options)
    else:
        with warnings_shown():
            examined = read_motion(options.motion, model, settings)
        with progress("collisions"):
            made = [planned(problem, examined, known)]
    drawn = options.random
    with progress("information"):
        total = problem
        for one in made:
            total = replace(total, known=total.total_information(one.course))
        assert total.known is not None
        recorded = None
        if compared:
            information, rows = recorded_information(problem, compared)
            samples = sum(options.rate * one.course.duration for one in made)
            recorded = excitation_plan(problem.torque_model, information * (samples / rows))
        best, median = random_plans(problem, len(made), drawn, known) if drawn else (None, None)
    plan, encoder = excitation_plan(problem.torque_model, total.known), None
    if noise is not None:
        with progress("encoder"):
            encoder = noise, encoder_plan(problem, [one.course for one in made], plan, noise)
    found = Excited(
        options.robot, reading, problem, words, options.criterion, tuple(made),
        plan, drawn, best, median, recorded, tuple(failures), known, encoder,
    )  # fmt: skip
    written = _write(found, model, options.out, options.out_rate, settings) if options.out is not None else ()
    deliver(excite_report(found, written), options, lambda: planned_figures(found))
    raise typer.Exit(DISAGREED if found.violated or found.hits else AGREED)


def _searched(
    problem: ExcitationProblem, collisions: SelfCollision | None, noise: EncoderNoise | None, options: ExciteOptions
) -> tuple[ExcitationProblem, list[PlannedMotion], list[str]]:
    """Search as many motions as asked for, each chosen for what the others do not show; the problem has the number of
    harmonics that was chosen with the first one. Raises typer.Exit if there is none."""
    from crosscheck.exciting.encoder_noise import without_noise
    from crosscheck.exciting.excited import planned
    from graphdyn.compiler import cores

    made: list[PlannedMotion] = []
    failures, known = list[str](), problem.known
    seeds = range(options.seed, options.seed + options.seeds)
    with progress("seeds", options.motions * len(seeds)) as advance:
        for _ in range(options.motions):
            tried = [] if made else _more_harmonics(problem, options)
            problem, found = _best_of_bases(
                [problem, *tried], known, collisions, noise, seeds, advance, options.jobs or cores()
            )
            failures += found.failures
            if found.best is None:
                break
            made.append(planned(problem, found.best.trajectory, collisions, found.best.seed))
            if noise is not None:
                noise = replace(noise, others=(*noise.others, without_noise(problem, found.best.trajectory)))
            known = replace(problem, known=known).total_information(found.best.trajectory)
            if found.interrupted:
                break
    for failure in failures:
        say(failure, "yellow")
    if not made:
        say("no motion keeps all limits", "red")
        raise typer.Exit(DISAGREED)
    return problem, made, failures


def _more_harmonics(problem: ExcitationProblem, options: ExciteOptions) -> list[ExcitationProblem]:
    """The problem with more harmonics, where none are asked for."""
    from graphdyn.excitation import FourierBasis

    if options.harmonics is not None or options.spline is not None:
        return []
    numbers = range(FEWEST_HARMONICS + HARMONICS_STEP, MOST_HARMONICS + 1, HARMONICS_STEP)
    return [replace(problem, basis=FourierBasis(options.duration, number)) for number in numbers]


MIN_GAIN_BY_HARMONICS = 0.02
"""Relative reduction of the mean error that more harmonics must bring."""


def _best_of_bases(
    problems: Sequence[ExcitationProblem],
    known: Array | None,
    collisions: SelfCollision | None,
    noise: EncoderNoise | None,
    seeds: range,
    advance: Callable[[str, int], None],
    jobs: int,
) -> tuple[ExcitationProblem, SearchSummary]:
    """The first problem whose successor hardly gains anything, and what was found for it.

    The first one is searched from all seeds, each other one from the best motion of the one before.
    """
    problem, *others = problems
    best = best_of(replace(problem, known=known), collisions, seeds, jobs, advance, noise)
    for other in others:
        if best.best is None or best.interrupted:
            break
        start = best.best.trajectory.of(other.basis)
        seed = range(best.best.seed, best.best.seed + 1)
        advance("more harmonics", 0)
        try:
            found = best_of(replace(other, known=known), collisions, seed, 1, lambda what, steps: None, noise, start)
        except KeyboardInterrupt:
            say(f"interrupted: the best motion so far, of seed {best.best.seed}, is kept", "yellow")
            return problem, best._replace(interrupted=True)
        if found.best is None or found.error >= best.error - MIN_GAIN_BY_HARMONICS:
            break
        problem, best = other, found._replace(failures=best.failures)
    return problem, best


def _recordings(options: ExciteOptions, option: str, logs: list[Path] | None, model: RobotModel) -> list[Recording]:
    """Recordings with velocities and accelerations."""
    from crosscheck.recordings import differentiated

    if not logs:
        return []
    with progress("read", len(logs)) as advance:
        named = ("--robot", options.robot, *reading_arguments(options))
        found = options.recordings(option, logs, model.independent_joints, advance, named, torques=False)
    show_findings(finding for recording in found for finding in recording.findings)
    return [differentiated(recording, options.low_pass) for recording in found]


def _write(found: Excited, model: RobotModel, out: OutputFile, rate: float, settings: AxisSettings) -> tuple[str, ...]:
    """One file for each motion; their names."""
    from crosscheck.exciting.motion_formats.motion_file import document, slides, written_rate
    from crosscheck.exciting.motion_formats.timed_motion import TimedMotion
    from crosscheck.exciting.motion_formats.urscript import strange_period

    names = []
    for number, one in enumerate(found.motions, start=1):
        name = out.path if len(found.motions) == 1 else out.path.with_stem(f"{out.path.stem}-{number}")
        of_rows = written_rate(one.course, name, rate)
        timed = TimedMotion.of(one.course, model.independent_joints, slides(model), of_rows)
        OutputFile(str(name)).write(document(timed, name, settings))
        if name.suffix.lower() == ".script" and (strange := strange_period(timed.period)):
            say(f"{name}: {strange}", "yellow")
        names.append(str(name))
    return tuple(names)


class SearchTask(NamedTuple):
    """start: random motions of the seed if left out"""

    problem: ExcitationProblem
    seed: int
    collisions: SelfCollision | None
    start: Trajectory | None = None


class SearchSummary(NamedTuple):
    """best: of the seeds that found a motion; failures: why the others did not; interrupted: before all were done

    error: of the best, a natural logarithm: the criterion, or with noise of positions the mean error
    """

    best: OptimizedMotion | None
    failures: list[str]
    interrupted: bool
    error: float


def search(task: SearchTask) -> OptimizedMotion | str:
    """The motion from one seed, or why there is none."""
    from crosscheck.exciting.self_collision import collision_free
    from graphdyn.excitation import NoFeasibleMotion, optimized

    try:
        if task.collisions is None:
            return optimized(task.problem, task.seed, start=task.start)
        return collision_free(task.problem, task.collisions, task.seed, task.start)
    except NoFeasibleMotion as error:
        return str(error)


def one_by_one(tasks: list[SearchTask]) -> Generator[tuple[int, OptimizedMotion | str]]:
    """Search in this process: starting another takes longer than a search."""
    for k, task in enumerate(tasks):
        yield k, search(task)


def best_of(
    problem: ExcitationProblem,
    collisions: SelfCollision | None,
    seeds: range,
    processes_used: int,
    advance: Callable[[str, int], None],
    encoder: EncoderNoise | None = None,
    start: Trajectory | None = None,
) -> SearchSummary:
    """The best motion from these seeds, by the criterion, or by its errors with noise of positions.

    start: of every search, random motions of the seed if left out

    Raises KeyboardInterrupt where it comes before the first motion is found.
    """
    tasks = [SearchTask(problem, seed, collisions, start) for seed in seeds]
    best: OptimizedMotion | None = None
    least = math.inf
    failures = list[str]()
    answers = LocalProcesses(processes_used).each(search, tasks) if processes_used > 1 else one_by_one(tasks)
    try:
        for k, outcome in answers:
            if isinstance(outcome, Lost):
                failures.append(f"the search from seed {tasks[k].seed} was lost: {outcome.reason}")
            elif isinstance(outcome, str):
                failures.append(outcome)
            else:
                error = _error(problem, outcome, encoder)
                best, least = (outcome, error) if error < least else (best, least)
            advance(f"seed {tasks[k].seed}", 1)
    except KeyboardInterrupt:
        if best is None:
            raise
        say(f"interrupted: the best motion so far, of seed {best.seed}, is kept", "yellow")
        return SearchSummary(best, failures, True, least)
    finally:
        answers.close()  # ends its processes
    return SearchSummary(best, failures, False, least)


def _error(problem: ExcitationProblem, found: OptimizedMotion, encoder: EncoderNoise | None) -> float:
    """Natural logarithm of the error by which motions are chosen."""
    if encoder is None:
        return found.value
    from crosscheck.exciting.encoder_noise import TRIAL_DRAWS, encoder_plan
    from graphdyn.excitation import excitation_plan

    plan = excitation_plan(problem.torque_model, problem.total_information(found.trajectory))
    return encoder_plan(problem, [found.trajectory], plan, encoder, TRIAL_DRAWS).mean_error(plan.spread)
