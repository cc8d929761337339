"""What the residuals of an identified model still hold: ripple over the position, memory, drift, temperature.

For each cause the residual of every joint is fitted by columns that such a cause would have, to all but each fold, and
predicted in the fold. The share is the part of the squared residual that this removes; chance removes nothing, or
makes it larger. The columns go through the same low-pass as the torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.identifying.choosing.folds import choosing_folds
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

RANK_TOLERANCE = 1e-6
"""Smallest singular value of the columns, relative, that counts: what a short motion hardly shows is not fitted."""


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
    folds = choosing_folds(recording, preparation)
    if isinstance(folds, str):
        return ()
    causes = _causes(robot, recording)
    every = every_row(len(residuals), EXAMINED_ROWS)
    terms = {f"{name} {k}": term for name, (parts, _) in causes.items() for k, term in enumerate(parts)}
    with one_thread():
        problem = preparation.problem(TorqueModel(robot, (Offset(),)), recording)
        columns = TermColumns.of(problem, terms, every)
        thinned = [(train[::every], test[::every]) for train, test in folds]
        found = []
        for name, (parts, remedy) in causes.items():
            own = np.concatenate([columns.additions[f"{name} {k}"] for k in range(len(parts))], axis=-1)
            joints = range(columns.n_joints)
            shares = [_share(own[:, j], residuals[::every, j], columns.kept[:, j], thinned) for j in joints]
            values, deviations = np.array(shares).T
            found.append(ResidualCause(name, values, deviations, remedy))
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
    return tuple(term_with(f"{name}*{over}", reference=reference) for name in ("offset", "viscous", "coulomb"))


def _share(
    columns: Array, residual: Array, kept: NDArray[np.bool_], folds: Sequence[tuple[NDArray[np.bool_], ...]]
) -> tuple[float, float]:
    """Part of the squared residual of one joint that its columns predict, and its standard deviation."""
    own = columns[:, np.any(columns != 0, axis=0)]
    left, whole = np.zeros(len(folds)), np.zeros(len(folds))
    for k, (train, test) in enumerate(folds):
        fitted, ahead = train & kept, test & kept
        length = np.linalg.norm(own[fitted], axis=0)
        unit = own / np.where(length > 0, length, np.inf)
        x = np.linalg.lstsq(unit[fitted], residual[fitted], rcond=RANK_TOLERANCE)[0]
        left[k] = np.sum((residual[ahead] - unit[ahead] @ x) ** 2)
        whole[k] = np.sum(residual[ahead] ** 2)
    if not whole.sum() > 0:
        return 0.0, 0.0
    without = 1 - (left.sum() - left) / np.maximum(whole.sum() - whole, np.finfo(float).tiny)
    variance = (len(folds) - 1) / len(folds) * np.sum((without - without.mean()) ** 2)
    return float(1 - left.sum() / whole.sum()), float(np.sqrt(variance))
