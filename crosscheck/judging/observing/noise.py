"""How precise a function is, from differences of high order along short lines.

A smooth function has vanishing differences of high order; what is left is the noise, multiplied by the root of a
binomial coefficient. Hamming, "Introduction to Applied Numerical Analysis", 1971, chapter 6; Moré and Wild, "Estimating
computational noise", SIAM Journal on Scientific Computing 33(3), 2011.
"""

from __future__ import annotations

from math import comb

import numpy as np

from crosscheck.judging.observing.function_under_test import FunctionFailure, FunctionUnderTest
from crosscheck.judging.states import JudgedStates
from graphdyn import inverse_dynamics

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
