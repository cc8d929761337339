"""What the residuals of an identified model still hold: ripple over the position, memory, drift, temperature.

For each cause the residual of every joint is fitted by columns that such a cause would have, to all but each fold, and
predicted in the fold. The share is the part of the squared residual that this removes, beyond what offset, viscous and
Coulomb friction of this joint remove in the same way; chance removes nothing, or makes it larger. The columns go
through the same low-pass as the torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.identifying.choosing.folds import beginning, choosing_folds
from crosscheck.identifying.methods.torque_terms import term_with
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from graphdyn import RobotModel
from graphdyn.identification import TorqueModel, one_thread
from graphdyn.identification.choosing import TermColumns, every_row
from graphdyn.identification.terms import MaxwellSlip, Offset, Term, UserColumns
from graphdyn.layout import Array

HARMONICS = 4
"""Number of harmonics over one turn of the joint."""

MOTOR_HARMONICS = 2
"""Number of harmonics over one turn of the motor, where the gear ratio is known: eccentricity, and cogging."""

DEFLECTIONS = (0.003, 0.01, 0.03)
"""Deflections of the elements with memory [rad or m]."""

EXAMINED_ROWS = 2000
"""Largest number of rows that are examined."""

RIDGE = 0.02
"""Ridge relative to the squared length of the columns: combinations that a short motion hardly shows stay near zero,
and do not extrapolate into the fold."""

COMMON_TERMS = ("offset", "viscous", "coulomb")
"""Terms that every residual may hold, and that drift."""


@dataclass(frozen=True, eq=False)
class ResidualCause:
    """A cause that may explain a part of the residual.

    name: of the cause
    shares: part of the squared residual of every joint that it predicts, negative where it predicts worse than nothing
        (n,)
    deviations: standard deviations of the shares, from the folds (n,)
    remedy: term or option that would model it
    """

    name: str
    shares: Array
    deviations: Array
    remedy: str

    @property
    def shown(self) -> NDArray[np.bool_]:
        """Joints where the share exceeds its deviation (n,)."""
        return np.asarray(self.shares > self.deviations)


def residual_causes(
    robot: RobotModel, recording: Recording, preparation: Preparation, residuals: Array
) -> tuple[ResidualCause, ...]:
    """The causes, with the share of the residual that each explains; none for a recording that is too short for folds.

    recording: differentiated rows of the fit; residuals: predicted minus measured torque of their equations (N, n)
    """
    recording = beginning(recording)
    folds = choosing_folds(recording, preparation)
    if isinstance(folds, str):
        return ()
    causes, residuals = _causes(robot, recording), residuals[: len(folds[0][0])]
    every = every_row(len(residuals), EXAMINED_ROWS)
    terms = {f"{name} {k}": term for name, (parts, _) in causes.items() for k, term in enumerate(parts)}
    terms |= {name: term_with(name) for name in COMMON_TERMS}
    with one_thread():
        problem = preparation.problem(TorqueModel(robot, (Offset(),)), recording)
        columns = TermColumns.of(problem, terms, every)
        thinned = [(train[::every], test[::every]) for train, test in folds]
        left = residuals[::every]
        common = np.concatenate([columns.additions[name] for name in COMMON_TERMS], axis=-1)
        before = _left(common, left, columns.kept, thinned)
        found = []
        for name, (parts, remedy) in causes.items():
            own = [columns.additions[f"{name} {k}"] for k in range(len(parts))]
            after = _left(np.concatenate([common, *own], axis=-1), left, columns.kept, thinned)
            found.append(ResidualCause(name, *_shares(before, after), remedy))
    return tuple(found)


def _causes(robot: RobotModel, recording: Recording) -> dict[str, tuple[tuple[Term, ...], str]]:
    """The terms of each cause, and its remedy."""
    n, mapping = robot.nv, recording.provenance.columns
    gears = None if mapping is None or mapping.transmission is None else np.abs(np.diag(mapping.transmission.matrix))
    multiples = [np.full(n, float(k)) for k in range(1, HARMONICS + 1)]
    if gears is not None:
        multiples += [k * gears for k in range(1, MOTOR_HARMONICS + 1)]
    middle = float(np.mean(recording.t))
    found: dict[str, tuple[tuple[Term, ...], str]] = {
        "position ripple": ((_ripple(multiples),), "--term with a law of q of your own"),
        "memory": ((MaxwellSlip(DEFLECTIONS),), "the term slip"),
        "drift": (_drifting("time", middle), "offset*time, viscous*time, coulomb*time"),
    }
    if recording.temperature is not None:
        warm = float(np.mean(recording.temperature))
        remedy = "offset*temperature, viscous*temperature, coulomb*temperature"
        found["temperature"] = (_drifting("temperature", warm), remedy)
    return found


def _ripple(multiples: Sequence[Array]) -> Term:
    """Torques in proportion to sin m q and cos m q. multiples: m of every joint, for each harmonic (n,)  [1/rad]"""
    joints = np.arange(len(multiples[0]))
    names = [f"{wave} {k}, {j}" for k in range(len(multiples)) for wave in ("sine", "cosine") for j in joints]

    def law(q: Array, v: Array, a: Array) -> Array:
        waves = [wave(multiple * q) for multiple in multiples for wave in (np.sin, np.cos)]
        rows = np.zeros((*q.shape, len(waves), len(joints)))
        for k, wave in enumerate(waves):
            rows[:, joints, k, joints] = wave
        return rows.reshape(*q.shape, -1)

    return UserColumns(law, names, ["N m"] * len(names))


def _drifting(over: str, reference: float) -> tuple[Term, ...]:
    return tuple(term_with(f"{name}*{over}", reference=reference) for name in COMMON_TERMS)


def _left(
    columns: Array, residuals: Array, kept: NDArray[np.bool_], folds: Sequence[tuple[NDArray[np.bool_], ...]]
) -> Array:
    """Squares that are left of the residual of each joint (K, n) where columns (N, n, k) of its own predict it."""
    left = np.zeros((len(folds), residuals.shape[1]))
    for j in range(residuals.shape[1]):
        own = columns[:, j, np.any(columns[:, j] != 0, axis=0)]
        unit = own / np.linalg.norm(own[kept[:, j]], axis=0).clip(np.finfo(float).tiny)
        for k, (train, test) in enumerate(folds):
            fitted, ahead = train & kept[:, j], test & kept[:, j]
            here = unit[fitted]
            x = np.linalg.solve(here.T @ here + RIDGE * np.eye(here.shape[1]), here.T @ residuals[fitted, j])
            left[k, j] = np.sum((residuals[ahead, j] - unit[ahead] @ x) ** 2)
    return left


def _shares(before: Array, after: Array) -> tuple[Array, Array]:
    """Part of the squares (K, n) that is removed for each joint, and its standard deviation, by jackknife (n,)."""
    folds = len(before)
    smallest = np.finfo(float).tiny
    without = 1 - (after.sum(axis=0) - after) / np.maximum(before.sum(axis=0) - before, smallest)
    variance = (folds - 1) / folds * np.sum((without - without.mean(axis=0)) ** 2, axis=0)
    return 1 - after.sum(axis=0) / np.maximum(before.sum(axis=0), smallest), np.sqrt(variance)
