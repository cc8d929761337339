"""crosscheck.identify: recordings and a robot in, methods side by side and a recommendation out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from numpy.typing import ArrayLike

from crosscheck.identifying.baselines import baselines
from crosscheck.identifying.health import health
from crosscheck.identifying.holding_out import Division, HeldOut, LastPart, OtherRecordings
from crosscheck.identifying.methods import STANDARD_METHODS, method_named
from crosscheck.identifying.pinocchio_method import WithPinocchio
from crosscheck.identifying.pooling import pooled
from crosscheck.identifying.preparation import Preparation
from crosscheck.identifying.result import HeldOutPrediction, Identified
from crosscheck.identifying.torque_terms import STANDARD_TERMS, friction_terms
from crosscheck.identifying.wrench_method import FromWrenches
from crosscheck.recordings import Recording
from crosscheck.referee.pinocchio_model import PinocchioModel, PinocchioRefuses
from crosscheck.referee.subject import Lock, Robot, Subject, subject
from graphdyn import InvalidInput
from graphdyn.identification import Estimator, MethodComparison, TorqueModel, compare_methods
from graphdyn.identification.plausibility import POSES
from graphdyn.identification.terms import KnownTerm, RigidBodies, Term
from urdf._cutting import Chain

TRIAL_POSES = 1
"""Poses in which the mass matrix of a trial is tested: one, because a trial only predicts."""


def identify(
    robot: Robot,
    recordings: Recording | Sequence[Recording],
    *,
    terms: Sequence[Term] | None = None,
    known: Sequence[KnownTerm] = (),
    methods: Sequence[str | Estimator] = STANDARD_METHODS,
    preparation: Preparation | None = None,
    held_out: HeldOut | None = None,
    lock: Lock = None,
    chain: Chain = None,
    gravity: ArrayLike | None = None,
    poses: int = POSES,
    progress: Callable[[str], None] | None = None,
) -> Identified:
    """Identify a robot from recordings with several methods, and say which result to trust.

    robot: name, path of a URDF, or RobotModel; its inertial parameters are the prior
    recordings: with torques; several are fitted together
    terms: unknown parts of the torque; if left out, rigid bodies, viscous and Coulomb friction, and offset
    known: known parts, which are subtracted
    methods: names (METHODS) or estimators
    preparation: filter, decimation, smallest speed
    held_out: rows to predict; if left out, the last quarter of every recording
    lock, chain, gravity: as in urdf.load, for names and paths only
    poses: random poses in which the mass matrix is tested
    progress: called with the name of the next step: three, and one for every method of the fit and of every trial

    Raises InvalidInput for recordings of other joints or without torque, for a division that leaves nothing to fit or
    to predict, for unknown or repeated methods; urdf's errors.
    """
    compared = subject(robot, lock, gravity, chain)
    recordings = [recordings] if isinstance(recordings, Recording) else list(recordings)
    preparation = preparation or Preparation()
    say = progress or (lambda what: None)
    terms = (RigidBodies(), *friction_terms(STANDARD_TERMS)) if terms is None else terms
    torque_model = TorqueModel(compared.model, terms, known)
    estimators = [method_named(method) if isinstance(method, str) else method for method in methods]

    say("health")
    recordings = [_of_robot(recording, compared.model.independent_joints) for recording in recordings]
    found_health = health(torque_model, recordings, preparation)
    say("filter")
    prepared = [preparation.differentiated(recording) for recording in recordings]
    held_out = held_out or LastPart()
    if isinstance(held_out, OtherRecordings):
        others = [_of_robot(recording, compared.model.independent_joints) for recording in held_out.recordings]
        held_out = OtherRecordings(tuple(preparation.differentiated(recording) for recording in others))
    division = held_out.divide(prepared)
    say("read")
    fit = preparation.problem(torque_model, division.fit)
    estimators = _with_referee(estimators, compared, chain is not None)
    own = _fitted_to(estimators, division.fit)
    if len(division.trials) == 1 and division.trials[0].train is division.fit:
        test = preparation.problem(torque_model, division.trials[0].test)
        comparison = compare_methods(fit, own, test, poses=poses, progress=say)
        trials: tuple[HeldOutPrediction, ...] = (
            HeldOutPrediction.of(test, preparation.times(division.trials[0].test), comparison),
        )
    else:
        comparison = compare_methods(fit, own, poses=poses, progress=say)
        trials, comparison = _trials(preparation, torque_model, division, estimators, comparison, say)
    return Identified(
        subject=compared,
        torque_model=torque_model,
        recordings=tuple(recordings),
        division=division,
        preparation=preparation,
        fit=HeldOutPrediction.of(fit, preparation.times(division.fit), comparison),
        trials=trials,
        comparison=comparison,
        baselines=baselines(torque_model, preparation, division),
        health=found_health,
    )


def _trials(
    preparation: Preparation,
    torque_model: TorqueModel,
    division: Division,
    estimators: Sequence[Estimator],
    comparison: MethodComparison,
    say: Callable[[str], None],
) -> tuple[tuple[HeldOutPrediction, ...], MethodComparison]:
    """The predictions of every trial, and the comparison with the held-out errors of all trials together."""
    trials, found = [], []
    for split in division.trials:
        train, test = (preparation.problem(torque_model, recording) for recording in split)
        found.append(compare_methods(train, _fitted_to(estimators, split.train), test, poses=TRIAL_POSES, progress=say))
        trials.append(HeldOutPrediction.of(test, preparation.times(split.test), found[-1]))
    results = []
    for result in comparison.results:
        parts = [trial.of(result.name) for trial in found]
        failures = [part.failure for part in parts if part.failure is not None]
        if result.failure is None and failures:
            result = replace(result, failure=f"in {len(failures)} of {len(parts)} folds: {failures[0]}", estimate=None)
        elif result.failure is None:
            result = replace(result, held_out=pooled([part.held_out for part in parts if part.held_out is not None]))
        results.append(result)
    return tuple(trials), replace(comparison, results=tuple(results))


def _fitted_to(estimators: Sequence[Estimator], recording: Recording) -> list[Estimator]:
    """The estimators; those that need wrenches are given the recording."""
    return [
        replace(estimator, recording=recording)
        if isinstance(estimator, FromWrenches) and not estimator.recording
        else estimator
        for estimator in estimators
    ]


def _with_referee(estimators: Sequence[Estimator], robot: Subject, cut: bool) -> list[Estimator]:
    """The estimators; those on Pinocchio's regressor use its own reading of the file, where it can read it."""
    wanting = [estimator for estimator in estimators if isinstance(estimator, WithPinocchio) and not estimator.referee]
    if not wanting or robot.file is None:
        return list(estimators)
    try:
        referee = PinocchioModel.from_urdf(Path(robot.file), robot.model, robot.locked, cut=cut)
    except PinocchioRefuses:  # Pinocchio's model is then built from ours, as `graphdyn crosscheck` reports
        return list(estimators)
    return [replace(estimator, referee=referee) if estimator in wanting else estimator for estimator in estimators]


def _of_robot(recording: Recording, joint_names: tuple[str, ...]) -> Recording:
    if recording.joint_names != joint_names:
        raise InvalidInput(
            f"{', '.join(recording.provenance.files)} has the joints {', '.join(recording.joint_names)}, the robot has "
            f"{', '.join(joint_names)}; load it with joints=model.independent_joints"
        )
    return recording
