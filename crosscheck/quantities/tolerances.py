"""Bounds of the comparison, each with its reason. All errors are relative to a scale that cannot vanish.

The scale of a sample is the largest of the reference values and of the terms that were summed to get them.
"""

from dataclasses import dataclass

import numpy as np

EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Tolerance:
    """A bound on a relative error, and its reason.

    bound: largest relative error that counts as agreement
    why: reason why it is what it is
    """

    bound: float
    why: str


AGREEMENT = Tolerance(
    1e-13, "two recursions of at most some hundred roundings each; measured below 4e-15 on all robots tried"
)
ACCELERATION = Tolerance(
    10 * EPS,
    "backward stable solutions differ by eps (cond(M) ‖a‖ + ‖M⁻¹‖ (‖τ‖ + largest joint wrench)); the factor 10 covers "
    "the dimension; measured below 2e-16",
)
FORWARD_WRENCH = Tolerance(
    1e-13,
    "wrenches at the computed accelerations inherit part of their error; measured below 1e-15 on real arms, 8e-15 "
    "where masses differ by 1e11",
)
BACKWARD = Tolerance(
    1e-13,
    "backward stable solutions need torques that are a few eps from the given ones, whatever cond(M); measured below "
    "1e-15 on arms and on chains of 100 joints, 8e-15 under loads that accelerate a last link to 1e5 rad/s²; single "
    "precision gives 9e-9 and more",
)
CLOSED = Tolerance(
    300 * EPS,
    "solutions on the closed motions differ by eps (cond(J) (‖a‖ + ‖v‖²) + ‖∣J⁺∣ ∣J∣‖ ‖∣R∣ ∣f∣‖), R = Z (Zᵀ M Z)⁻¹ Zᵀ; "
    "measured below 170 eps on ten published mechanisms, and where up to a third of their links lost its mass",
)
CLOSED_BACKWARD = Tolerance(
    1e-11,
    "along closed motions rounding of a shows as torques below 1e-12 of those that are summed; measured on eight "
    "published mechanisms at 48 states, and where up to a third of their links lost its mass; an error of 1e-8 in a "
    "shows as 2e-10 and more",
)
CLOSED_WRENCH = Tolerance(
    4e-13,
    "multipliers inherit the rounding of a; measured below 1e-13, and below 4e-13 where a third of the links lost its "
    "mass",
)
RESIDUAL = Tolerance(1e-13, "backward stable solution of a balanced system, refined once; measured below 3e-16")
RANK = Tolerance(0.0, "a rank is an integer: full or not")
IDENTIFICATION = Tolerance(
    10 * EPS,
    "two least-squares solutions differ by eps cond(W) ‖x‖ (columns of unit length); factor 10 for the size; "
    "measured below 1e-15",
)
FUNCTION_UNDER_TEST = Tolerance(
    1e-9,
    "other codes sum in other orders and invert matrices; a hundredth of single precision, a million times double; "
    "the faults looked for change results by 1e-6 and more",
)
FUNCTION_UNDER_TEST_SINGLE = Tolerance(
    1e-5,
    "graphdyn's recursions, every operation in single precision, err by up to 2.3e-6, derivatives of accelerations by "
    "the parameters by 7e-6; measured on 55 robots, all but a five-bar linkage cut open, whose errors reach 4e-5",
)
