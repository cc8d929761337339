"""Data quality of a recording before the identification.

Each possible fault, such as a reversed torque, exchanged columns or a delay, is corrected on trial. If the equations of
motion then fit much better, with plausible parameters, the recording has the fault. The criterion is Σ_j log ‖e_j‖ over
the joints, the logarithm of the likelihood per sample for unknown noise of each joint. Only the
kinematics of the model count, not its inertial parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.display import short_repr
from graphdyn.identification.algebra.least_squares import one_thread
from graphdyn.identification.data_quality.causes.additions import Addition
from graphdyn.identification.data_quality.causes.changes import Change, RecordedColumns
from graphdyn.identification.data_quality.channels.channels import Channels, channels
from graphdyn.identification.data_quality.channels.measured_torque import Gains, gains, modeled_torques
from graphdyn.identification.data_quality.delays.torque_delays import Lag
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit, contradictions, halves_apart
from graphdyn.identification.data_quality.fits.thinning import Piece
from graphdyn.identification.data_quality.search.deciding import MIN_CHANGE_GAIN, DataFault
from graphdyn.identification.data_quality.search.examined import Examined
from graphdyn.identification.data_quality.search.halves import FaultsByHalves, faults_by_halves
from graphdyn.identification.data_quality.search.searching import search
from graphdyn.identification.data_quality.trials.trials import variation
from graphdyn.identification.data_quality.visible import VisibleSizes, visible_sizes
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import PARAMETER_NAMES

FIRST_MOMENTS = sum(not name.startswith("I") for name in PARAMETER_NAMES)
"""Number of a body's parameters before the tensor: mass and m c come first among the ten."""


KINDS_OF_THE_WHOLE = ("friction subtracted", "filtered torque")
"""Additions that concern all rows alike, unlike those of what changed in between."""


@dataclass(frozen=True)
class Excitation:
    """Excitation of one group of base parameters.

    name: of the group
    determined: number that the recording determines; structural: number that some motion could determine
    weakest: smallest singular value of the group's part of the regressor that no other group can imitate, joints
        weighted by their torque and columns at unit length: 1 is best, 0 is not excited; NaN for an empty group
    """

    name: str
    determined: int
    structural: int
    weakest: float


def excitation(problem: Problem) -> tuple[Excitation, ...]:
    """Excitation of masses and centers of mass, of inertia tensors, and of every further term of the torque model."""
    base, structural, unit = problem.base, problem.structure.base, problem.equations.unit_regressor
    found = []
    for name, columns in groups(problem.torque_model):
        own = np.isin(base.independent, columns)
        weakest = float("nan")
        if own.any():
            q = np.linalg.qr(unit[:, ~own])[0]
            left = unit[:, own] - q @ (q.T @ unit[:, own])
            weakest = float(np.linalg.svd(left, compute_uv=False)[-1])
        found.append(Excitation(name, int(own.sum()), int(np.isin(structural.independent, columns).sum()), weakest))
    return tuple(found)


def groups(torque_model: TorqueModel) -> Iterator[tuple[str, NDArray[np.intp]]]:
    """Names of groups, and their columns of the torque model."""
    for term, part in torque_model.parts:
        columns = np.arange(part.start, part.stop)
        if isinstance(term, RigidBodies):
            first = (columns - part.start) % BODY_PARAMETERS < FIRST_MOMENTS
            yield "masses and centers of mass", columns[first]
            yield "inertia tensors", columns[~first]
        elif columns.size:
            yield _words(type(term).__name__), columns


def _words(name: str) -> str:
    """A class name as words: "RotorInertia" → "rotor inertia"."""
    return "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in name).strip()


@dataclass(frozen=True, eq=False)
@short_repr
class RecordingQuality:
    """Data quality of a recording with n joints, those that no others drive.

    gravity: of the model, in world axes                    (3,) [m/s²]
    faults: in the order of their correction; none are searched if a channel holds no signal of its own
    hints: what would gain a little
    half_faults: of the first half alone, and of the second, if the halves contradict each other
    modeled: joints whose torque is the output of a model, while others were measured; they are not searched
    doubtful: what else the whole of such a recording shows, or one half
    unseen: changes after which the recording would fit equally well, so that it cannot reveal them
    visible: the smallest faults that it would reveal; None if no faults were searched
    errors: ‖e_j‖ / ‖τ_j‖ of the fit within bounds, as recorded                      (n,)
    free_errors: the same without bounds                                             (n,)
    sign_costs: rise of Σ log ‖e_j‖ with the torque of each joint reversed           (n,)
    halves: of each half of the rows, errors of the common and of its separate fit   (2, 2, n)
    contradictions: halves and joints that contradict the other half, before and after the correction of faults (2, n)
    lag_left: delays after this correction
    variation: ‖τ_j - mean‖ / ‖τ_j‖: error of a constant                            (n,)
    gains, lag, channels: as recorded
    """

    joint_names: tuple[str, ...]
    gravity: Array
    faults: tuple[DataFault, ...]
    hints: tuple[DataFault, ...]
    modeled: tuple[int, ...]
    half_faults: tuple[tuple[DataFault, ...], tuple[DataFault, ...]]
    doubtful: tuple[DataFault, ...]
    unseen: tuple[Change, ...]
    visible: VisibleSizes | None
    errors: Array
    free_errors: Array
    sign_costs: Array
    halves: Array
    contradictions: NDArray[np.bool_]
    variation: Array
    gains: Gains
    lag: Lag
    lag_left: Lag
    channels: Channels


def assess_recording(
    torque_model: TorqueModel,
    pieces: Sequence[Piece],
    *,
    torques: Sequence[Array] | None = None,
    columns: RecordedColumns | None = None,
    min_speed: ArrayLike = 0.0,
) -> RecordingQuality:
    """Search a recording for faults.

    torque_model: robot, drives and known torques; its inertial parameters are read for the gains alone
    pieces: uninterrupted, q, v, a and tau low-passed alike
    torques: as recorded, before any filter, piece by piece (N_k, n); those of the pieces if left out
    columns: conversion of the recorded columns to joint coordinates; the identity if left out
    min_speed: as in Problem

    Raises TooShort for a recording too short to look for delays; InvalidInput for a moving base, and if a term
    of the torque is not finite.
    """
    model = torque_model.model
    columns = columns or RecordedColumns.of_joints(model.nv)
    with one_thread():
        now = Examined.of(torque_model, pieces, min_speed)
        fit, tau = now.fit, now.samples.tau
        errors = fit.errors(tau)
        found_gains = gains(torque_model, now.samples, fit)
        raw = channels(pieces, torques or [piece.samples.tau for piece in pieces])
        faults: tuple[DataFault, ...] = ()
        hints: tuple[DataFault, ...] = ()
        unseen: tuple[Change, ...] = ()
        visible = None
        left, halves = now, halves_apart(tau, fit)
        by_halves = FaultsByHalves((), ((), ()), ())
        apart = np.zeros_like(contradictions(halves))
        modeled = modeled_torques(found_gains, errors, raw.torque_noise)
        if modeled:
            now = Examined.of(torque_model, pieces, min_speed, modeled)
            left, halves = now, halves_apart(tau, now.fit)
            apart = np.zeros_like(contradictions(halves))
        if not (raw.constant_torques or raw.duplicated_torques or raw.duplicated_positions):
            faults, hints, unseen, curves, left = search(now, columns, found_gains)
            visible = visible_sizes(left.part, left.thinned, curves, MIN_CHANGE_GAIN)
            apart = contradictions(halves) & contradictions(halves_apart(left.samples.tau, left.fit))
            if any(fault.change.kind in KINDS_OF_THE_WHOLE for fault in faults):
                apart = np.zeros_like(apart)  # the fit of each half lacks the same as that of both
        if apart.any():

            def searched(part: Sequence[Piece]) -> tuple[DataFault, ...]:
                there = Examined.of(torque_model, part, min_speed, modeled)
                found = search(there, columns, gains(torque_model, there.samples, there.fit)).faults
                return tuple(fault for fault in found if isinstance(fault.change, Change))

            of_time = tuple(fault for fault in faults if isinstance(fault.change, Addition))
            of_columns = tuple(fault for fault in faults if isinstance(fault.change, Change))
            searched_halves = faults_by_halves(pieces, of_columns, np.flatnonzero(apart.any(axis=0)), searched)
            if of_time and not any(searched_halves.of_one):
                apart = np.zeros_like(apart)  # what changed is known
            else:
                by_halves, faults = searched_halves, searched_halves.of_both
                left = now.after([fault.change for fault in faults if isinstance(fault.change, Change)], columns)
                apart = contradictions(halves) & contradictions(halves_apart(left.samples.tau, left.fit))
        return RecordingQuality(
            joint_names=model.independent_joints,
            gravity=np.asarray(model.gravity, dtype=float),
            faults=faults,
            hints=hints,
            modeled=modeled,
            half_faults=by_halves.of_one,
            doubtful=by_halves.doubtful,
            unseen=unseen,
            visible=visible,
            errors=errors,
            free_errors=fit.errors(tau, bounded=False),
            sign_costs=_sign_costs(fit, tau),
            halves=halves,
            contradictions=apart,
            variation=variation(tau),
            gains=found_gains,
            lag=now.delays,
            lag_left=left.delays,
            channels=raw,
        )


def _sign_costs(fit: BoundedFit, tau: Array) -> Array:
    """Rise of Σ log ‖e_j‖ with the torque of each joint reversed (n,)."""
    right = np.sum(np.log(fit.errors(tau)))
    signs = 1 - 2 * np.eye(tau.shape[1])
    return np.array([np.sum(np.log(fit.errors(tau * sign))) - right for sign in signs])
