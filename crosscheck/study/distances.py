"""The distances of Leboutet et al., "Inertial parameter identification in robotics: a survey", Applied Sciences 11(9),
2021, as their program BIRDy computes them, and its rule for divergence:

    d_β = 2 / b Σ_k |x_k - x*_k| / (|x_k| + |x*_k|)        over the base parameters
    d_τ = mean of ‖τ_t - W_t x‖ / ‖τ_t‖                     over the rows of the recording that are fitted
    d_q = mean of ‖q_t - q_t(x)‖ / ‖q_t‖                    q(x) of the simulated loop of the recording

An answer has diverged where ‖x - x*‖ > 50 ‖start - x*‖. BIRDy takes d_τ and d_q of the mean of all answers; here they
are of each, and their means over the runs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.study.simulated.runs import RecordedProblem
from graphdyn import EstimationFailed
from graphdyn.identification import BaseParameters
from graphdyn.identification.closed_loop import SimulatedLoop
from graphdyn.layout import Array

DIVERGED_FACTOR = 50.0
"""An answer that is so many times as far from the truth as the start has diverged."""


@dataclass(frozen=True)
class Distances:
    """d_q is None where the loop does not hold the robot, diverged where the scenario has no start of its own."""

    d_beta: float
    d_tau: float
    d_q: float | None
    diverged: bool | None


def distances(record: RecordedProblem, base: BaseParameters, x: Array) -> Distances:
    """base: that any motion could determine; x: parameters of an answer (p,)."""
    found, truth = base.values(x), base.values(record.truth)
    size = np.abs(found) + np.abs(truth)
    d_beta = 2 * float(np.mean(np.abs(found - truth) / np.where(size > 0, size, 1.0)))
    diverged = None
    if record.start is not None:
        away = DIVERGED_FACTOR * np.linalg.norm(base.values(record.start) - truth)
        diverged = bool(np.linalg.norm(found - truth) > away)
    return Distances(d_beta, _of_torque(record, x), _of_positions(record, x), diverged)


def _of_torque(record: RecordedProblem, x: Array) -> float:
    problem, parts = record.problem, list[Array]()
    values = problem.base.values(x)
    for rows in problem.rows():
        used = rows.kept.any(axis=1)
        torque = np.where(rows.kept, rows.right, 0.0)[used]
        error = np.where(rows.kept, rows.right - problem.reduced(rows) @ values, 0.0)[used]
        parts.append(np.linalg.norm(error, axis=1) / np.linalg.norm(torque, axis=1))
    return float(np.mean(np.concatenate(parts)))


def _of_positions(record: RecordedProblem, x: Array) -> float | None:
    loop = SimulatedLoop(record.problem, record.loop)
    try:
        simulated = np.concatenate([samples.q for samples in loop.samples(x)])
    except EstimationFailed:
        return None
    measured = record.recording.channel("q")
    return float(np.mean(np.linalg.norm(measured - simulated, axis=1) / np.linalg.norm(measured, axis=1)))
