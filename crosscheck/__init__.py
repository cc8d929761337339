"""graphdyn against Pinocchio, number by number. Needs `pin`; the only package that does."""

from crosscheck.compare import Comparison, Disagreement, QuantityResult, assert_agrees, compare

__all__ = ["Comparison", "Disagreement", "QuantityResult", "assert_agrees", "compare"]
