"""A function that deviates: what was seen of it, the evidence in words, and how precise it is.

The noise comes from differences of high order along short lines. A smooth function has vanishing differences of high
order; what is left is the noise, multiplied by the root of a binomial coefficient. Hamming, "Introduction to Applied
Numerical Analysis", 1971, chapter 6; Moré and Wild, "Estimating computational noise", SIAM Journal on Scientific
Computing 33(3), 2011.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import comb

import numpy as np

from crosscheck.judging.observing.function_under_test import FunctionFailure, FunctionUnderTest
from crosscheck.judging.observing.observation import Observation
from crosscheck.judging.states import EXPERIMENT_PARTS, EquationTerms, JudgedStates, TrialStates
from graphdyn import RobotModel, inverse_dynamics
from urdf.reading import Misreadings

DIFFERENCE_ORDER = 8
POINT_SPACING = 1e-5
"""Distance between neighboring points, relative to the arguments: 80 units in the last place of single precision; terms
that turn a thousand times as fast as the joints still vanish."""

N_LINES = 5

MAX_DOUBLE_NOISE = 1e-14
"""Relative noise below which a function computes in double precision."""

SINGLE_NOISE_RANGE = (1e-8, 2e-6)
"""Relative noise of functions that compute in single precision."""


def noise(function: FunctionUnderTest, states: JudgedStates) -> float:
    """Relative noise of the answers: the median over lines of the largest standard deviation of an entry.

    Zero where the function refuses a point of the lines.
    """
    rng = np.random.default_rng(0)
    rows = np.arange(N_LINES) % len(states.q)
    start = [x[rows] for x in function.known.arguments_at(states)]
    ways = [POINT_SPACING * (0.5 + rng.random(x.shape)) * np.maximum(np.abs(x), 1e-2 * np.abs(x).max()) for x in start]
    points = [
        np.concatenate([x[:, None] + k * way[:, None] for k in range(DIFFERENCE_ORDER + 1)], axis=1).reshape(
            -1, *x.shape[1:]
        )
        for x, way in zip(start, ways, strict=True)
    ]
    try:
        answers = function(*points)
    except FunctionFailure:
        return 0.0
    if function.name == "forward_dynamics":  # the torques that the accelerations need: without cond(M)
        answers = inverse_dynamics(states.model, points[0], points[1], answers).tau
    answers = answers.reshape(N_LINES, DIFFERENCE_ORDER + 1, -1)
    left = np.diff(answers, DIFFERENCE_ORDER, axis=1)[:, 0] / np.sqrt(comb(2 * DIFFERENCE_ORDER, DIFFERENCE_ORDER))
    size = np.abs(answers).max(axis=(1, 2))
    relative = np.abs(left).max(axis=1) / np.where(size > 0, size, 1.0)
    return float(np.median(relative))


def precision_said(relative: float) -> str:
    """What noise of this size means."""
    if relative <= MAX_DOUBLE_NOISE:
        return "double precision"
    if SINGLE_NOISE_RANGE[0] <= relative <= SINGLE_NOISE_RANGE[1]:
        return f"the answers have a noise of {relative:.1e}, as in single precision"
    return f"the answers scatter by {relative:.1e} from one state to the next"


MAX_NOISE_FACTOR = 10.0
"""A fault explains a deviation if it leaves at most this many times the noise of the function, at every state."""


@dataclass(frozen=True, eq=False)
class Deviation:
    """A function that deviates, and what was seen of it.

    observed: the experiments
    judged: the answers at all judged states, None where no torques follow from them
    readings: gives the misreadings of the robot's file, None where it has none
    noise: relative, of the function; tolerance: relative error that counts as agreement
    """

    function: str
    model: RobotModel
    trial: TrialStates
    observed: EquationTerms
    judged: Observation | None
    readings: Callable[[], Misreadings | None]
    noise: float
    tolerance: float

    @property
    def bound(self) -> float:
        return max(self.tolerance, MAX_NOISE_FACTOR * self.noise)


def evidence_of(deviation: Deviation, before: Mapping[str, float], observed: EquationTerms, own: EquationTerms) -> str:
    said = [
        f"{EXPERIMENT_PARTS[part]}: {'agrees' if error <= deviation.bound else f'relative error {error:.1e}'}"
        for part, error in before.items()
    ]
    if "velocity" in before and before["velocity"] > deviation.bound:
        assert observed.doubled is not None
        assert own.doubled is not None
        assert observed.velocity is not None
        assert own.velocity is not None
        once = np.abs(observed.velocity - own.velocity).max()
        twice = np.abs(observed.doubled - own.doubled).max()
        said.append(f"at twice the velocity the error is {twice / once:.3g} times as large")
    if deviation.noise > deviation.tolerance / MAX_NOISE_FACTOR:
        said.append(precision_said(deviation.noise))
    return "; ".join(said)
