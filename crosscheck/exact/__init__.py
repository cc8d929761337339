"""Exact values: every number of the dynamics of a tree in ball arithmetic, with digits that are proven.

From the numbers up: balls (python-flint), robot and couplings (the constants of a file or a model), source (at any
precision), ground (at rest or moving), recorded (the recursions on balls), equations (Eq. (111) in balls, the
specification), sensitivity (how far values move with their inputs), values and proofs (what a user calls),
placements (as matrices, and how far they move).
"""

from crosscheck.exact.balls import check_installed
from crosscheck.exact.placements import exact_placements, half_ulp_of_placements
from crosscheck.exact.proofs import Proof, Result, prove
from crosscheck.exact.robot import Truth
from crosscheck.exact.sensitivity import HALF_ULP, half_ulp_effects
from crosscheck.exact.source import ExactSource
from crosscheck.exact.values import MAX_DIGITS, PLACEMENT, ExactArray, exact_values

__all__ = [
    "HALF_ULP",
    "MAX_DIGITS",
    "PLACEMENT",
    "ExactArray",
    "ExactSource",
    "Proof",
    "Result",
    "Truth",
    "check_installed",
    "exact_placements",
    "exact_values",
    "half_ulp_effects",
    "half_ulp_of_placements",
    "prove",
]
