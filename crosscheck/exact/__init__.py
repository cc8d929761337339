"""Exact values: every number of the dynamics of a tree in ball arithmetic, with digits that are proven.

From the numbers up: balls (python-flint), robot and couplings (the constants of a file or a model), source (at any
precision), ground (at rest or moving), recorded (the recursions on balls), equations (Eq. (111) in balls, the
specification), sensitivity (how far values move with their inputs), values and proofs (what a user calls).
"""

from crosscheck.exact.balls import check_installed
from crosscheck.exact.proofs import Proof, Result, prove
from crosscheck.exact.robot import Truth
from crosscheck.exact.sensitivity import HALF_ULP, half_ulp_effects
from crosscheck.exact.source import ExactSource
from crosscheck.exact.values import MAX_DIGITS, ExactArray, exact_values

__all__ = [
    "HALF_ULP",
    "MAX_DIGITS",
    "ExactArray",
    "ExactSource",
    "Proof",
    "Result",
    "Truth",
    "check_installed",
    "exact_values",
    "half_ulp_effects",
    "prove",
]
