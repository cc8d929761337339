"""graphdyn against Pinocchio, number by number. Needs `pin`; the only package that does."""

from crosscheck.compare import Disagreement, assert_agrees, compare
from crosscheck.result import Comparison, QuantityResult

__all__ = ["Comparison", "Disagreement", "QuantityResult", "assert_agrees", "compare"]
