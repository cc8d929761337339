"""crosscheck.identify: from recordings and a robot to a comparison of methods and a recommendation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, Unpack

from crosscheck.identifying.choosing.chosen import with_chosen_drives
from crosscheck.identifying.data_quality.data_quality import data_quality
from crosscheck.identifying.data_quality.free_gravity import mounted
from crosscheck.identifying.fitting import identified_model
from crosscheck.identifying.long_recordings import STANDARD_METHODS_OF_SUMS, LongRecordings, Progress
from crosscheck.identifying.methods.candidate_models import CandidateModel, with_links_of_cad
from crosscheck.identifying.methods.link_limits import link_limits
from crosscheck.identifying.methods.loop_methods import as_prepared
from crosscheck.identifying.methods.methods import STANDARD_METHODS, without_wrenches
from crosscheck.identifying.methods.torque_terms import STANDARD_TERM_NAMES, friction_terms
from crosscheck.identifying.preparing.holding_out import Folds, HeldOut, LastPart, OtherRecordings
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.identifying.preparing.trials import constant_errors
from crosscheck.identifying.results.result import Identified, identified
from crosscheck.recordings import PartitionedRecording, Recording
from crosscheck.reference.subject import IDENTIFY_CLOSED, Robot, refuse_chords, subject
from graphdyn import InvalidInput
from graphdyn.identification import CHECKED_POSES, ClosedLoop, Estimator, PhysicalLimits
from graphdyn.identification.terms import KnownTerm, RigidBodies, Term
from urdf import Reading, ReadingKeywords


def identify(
    robot: Robot,
    recordings: Recording | Sequence[Recording] | PartitionedRecording,
    *,
    terms: Sequence[Term] | Literal["standard"] | None = None,
    known: Sequence[KnownTerm] = (),
    methods: Sequence[str | Estimator] | None = None,
    preparation: Preparation | None = None,
    held_out: HeldOut | PartitionedRecording | None = None,
    loop: ClosedLoop | None = None,
    poses: int = CHECKED_POSES,
    models: Sequence[CandidateModel] = (),
    limits: PhysicalLimits | None = None,
    free_gravity: bool = False,
    progress: Progress | None = None,
    **reading: Unpack[ReadingKeywords],
) -> Identified:
    """Identify a robot from recordings with several methods, and recommend a result.

    robot: name, path of a URDF, or RobotModel; its inertial parameters are the prior
    recordings: with torques; several are fitted together. A PartitionedRecording may have any length: it is read
        several times, part by part, by methods that need no more than sums (METHODS_OF_SUMS)
    terms: unknown parts of the torque; if left out, rigid bodies, and terms of the drives that predict best
        (crosscheck.identifying.choosing); "standard" for rigid bodies, viscous and Coulomb friction, and offset
    known: known parts, which are subtracted
    methods: names (METHODS) or estimators; if left out, STANDARD_METHODS, or those of them that need no more than sums;
        `graph` only for recordings with wrenches
    preparation: filter, decimation, smallest speed
    held_out: rows to predict; if left out, the last quarter of every recording. For a PartitionedRecording, another
        one
    loop: controller and reference of the recordings, over their time; some methods simulate it
    poses: random poses in which the mass matrix is tested
    models: torque models to compare, each with terms, known terms and methods of its own, in place of `terms`, `known`
        and `methods`; the result is that of the first one, and contains the others
    limits: of the links, for methods that keep any and were given no others; by default masses within a factor of CAD,
        and matter within the meshes or the reach of a link
    free_gravity: find the direction of gravity, and so the mounting of the robot, from the recordings first; not of a
        PartitionedRecording
    progress: called with the name of the next step and 1: three times, once if terms are chosen, and once for every
        method of the fit and of every fold; for a PartitionedRecording with the name of a step and a number of rows

    The result of a PartitionedRecording is that of the whole data. Its `recordings`, `division`, curves and data
    quality are those of the beginnings of the logs.

    Raises InvalidInput for recordings of other joints or without torque, for a division that leaves nothing to fit or
    to predict, for unknown or repeated methods, for what needs the recording in memory; NoWorkers; urdf's errors.

    >>> import crosscheck
    >>> from crosscheck.identifying import Preparation, virtual_robot
    >>> arm = virtual_robot("kr500", terms=(), seconds=10)  # or crosscheck.load_recording("log.csv")
    >>> found = crosscheck.identify(
    ...     "kr500", arm.fitted, terms="standard", methods=["wls"], preparation=Preparation(cutoff=10.0), poses=10
    ... )
    >>> found.comparison.rank, found.recommendation.name
    (54, 'CAD links: WLS')
    """
    compared = subject(robot, Reading.of(identify, reading))
    refuse_chords(compared.model, IDENTIFY_CLOSED)
    if free_gravity and isinstance(recordings, PartitionedRecording):
        raise InvalidInput("gravity is found from recordings in memory only; give it, or load one of them first")
    if models and (terms is not None or known):
        raise InvalidInput("terms or known are given beside models; give them as parts of the models")
    methods = methods or _standard_methods(recordings)
    asked = models or [_model(terms, known, methods)]
    with_links_of_cad(asked)  # refuses what cannot be compared before anything is read
    limits = link_limits(compared, limits)
    if isinstance(recordings, PartitionedRecording):
        long = LongRecordings.of(compared, asked, recordings, held_out, preparation, loop, limits)
        return long.identified(poses, progress)
    if isinstance(held_out, PartitionedRecording):
        raise InvalidInput("a PartitionedRecording can be predicted from another one only; load it as a Recording")
    recordings = [recordings] if isinstance(recordings, Recording) else list(recordings)
    preparation = preparation or Preparation()
    gravity = None
    if free_gravity:
        compared, gravity = mounted(compared, asked[0], recordings, preparation)
    first = asked[0].of(compared.model)
    loop = as_prepared(loop, preparation, recordings[0])

    def say(what: str) -> None:
        if progress:
            progress(what, 1)

    say("data_quality")
    recordings = [_of_robot(recording, compared.model.independent_joints) for recording in recordings]
    held_out = held_out or LastPart()
    others = [_of_robot(recording, compared.model.independent_joints) for recording in _other_recordings(held_out)]
    examined = [recordings, *([recording] for recording in others)]
    qualities = [data_quality(first, part, preparation) for part in examined]
    say("filter")
    prepared = [preparation.differentiated(recording) for recording in recordings]
    ahead = tuple(preparation.differentiated(recording) for recording in others)
    division = _prepared(held_out, ahead).divide(prepared)
    if any(model.choose_drives for model in asked):
        say("terms of the drives")
    # a simulated loop goes on from state to state, without what friction with memory remembers
    memory = loop is None
    chosen, ladders = with_chosen_drives(asked, compared.model, division.fit, preparation, memory=memory)
    if ladders:  # what the terms that were chosen explain is no fault of the recording
        first = chosen[0].of(compared.model)
        for k, (part, quality) in enumerate(zip(examined, qualities, strict=True)):
            if quality is not None and quality.faults:
                qualities[k] = data_quality(first, part, preparation)
    say("read")
    return identified(
        [
            identified_model(
                compared,
                candidate,
                division,
                preparation,
                loop=loop,
                poses=poses,
                limits=limits,
                progress=say,
                ladder=ladders.get(candidate.name),
            )
            for candidate in with_links_of_cad(chosen)
        ],
        recordings=tuple(recordings),
        division=division,
        preparation=preparation,
        constant=constant_errors(compared.model, preparation, division),
        gravity=gravity,
        data_quality=qualities[0],
        validation_data_quality=tuple(qualities[1:]),
    )


def _model(
    terms: Sequence[Term] | Literal["standard"] | None,
    known: Sequence[KnownTerm],
    methods: Sequence[str | Estimator],
) -> CandidateModel:
    if terms is None:
        return CandidateModel("", (RigidBodies(),), known, methods, choose_drives=True)
    standard = (RigidBodies(), *friction_terms(STANDARD_TERM_NAMES))
    return CandidateModel("", standard if isinstance(terms, str) else terms, known, methods)


def _standard_methods(recordings: Recording | Sequence[Recording] | PartitionedRecording) -> Sequence[str]:
    """The default methods; those that need wrenches only where the recordings have them."""
    if isinstance(recordings, PartitionedRecording):
        return STANDARD_METHODS_OF_SUMS
    every = [recordings] if isinstance(recordings, Recording) else recordings
    wrenches = any(recording.joint_wrenches is not None for recording in every)
    return STANDARD_METHODS if wrenches else without_wrenches(STANDARD_METHODS)


def number_of_steps(models: Sequence[CandidateModel], held_out: HeldOut | None) -> int:
    """Number of calls of `progress` by identify, of recordings in memory."""
    folds = held_out.folds if isinstance(held_out, Folds) else 0
    steps = 3 + any(model.choose_drives for model in models)
    return steps + (1 + folds) * sum(len(model.methods) for model in with_links_of_cad(models))


def _other_recordings(held_out: HeldOut) -> tuple[Recording, ...]:
    """Recordings that are only predicted, as they were read."""
    if isinstance(held_out, Folds) and held_out.aside is not None:
        return _other_recordings(held_out.aside)
    return held_out.recordings if isinstance(held_out, OtherRecordings) else ()


def _prepared(held_out: HeldOut, others: tuple[Recording, ...]) -> HeldOut:
    """The same way to hold out rows, with these recordings in place of those that were read."""
    if isinstance(held_out, Folds) and held_out.aside is not None:
        return replace(held_out, aside=_prepared(held_out.aside, others))
    return OtherRecordings(others) if isinstance(held_out, OtherRecordings) else held_out


def _of_robot(recording: Recording, joint_names: tuple[str, ...]) -> Recording:
    if recording.joint_names != joint_names:
        raise InvalidInput(
            f"{', '.join(recording.provenance.files)} has the joints {', '.join(recording.joint_names)}, the robot has "
            f"{', '.join(joint_names)}; load it with joints=model.independent_joints"
        )
    return recording
