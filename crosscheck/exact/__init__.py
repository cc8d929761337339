"""Exact values: every number of the dynamics of a tree in ball arithmetic, with digits that are proven.

balls (python-flint), robot (the constants of a file or a model), recorded (the recursions on balls), equations (Eq.
(111) in balls, the specification), values (what a user calls).
"""

from crosscheck.exact.robot import Truth
from crosscheck.exact.values import ExactArray, exact_values

__all__ = ["ExactArray", "Truth", "exact_values"]
