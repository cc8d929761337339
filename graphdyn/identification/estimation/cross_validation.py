"""Choice of a strength by cross-validation over folds of time blocks, so that neighboring samples stay together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.compressed import CompressedEquations, merged
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array

Trained = Callable[[float], Array]
"""Function from a strength to the parameters of the torque model (p,); it may raise EstimationFailed."""


@dataclass(frozen=True, eq=False)
class CrossValidation:
    """Errors of the folds for every strength.

    strengths: in increasing order                          (s,)
    errors: Σ_g ‖W_g x - τ_g‖² / σ_g² of each fold, x fitted to the others, infinite if that failed
                                                            (folds, s)
    failures: the reasons, in sentences
    """

    strengths: tuple[float, ...]
    errors: Array
    failures: tuple[str, ...]

    @property
    def best(self) -> float:
        """The strength with the smallest sum of errors, the larger of equal ones."""
        total = self.errors.sum(axis=0)
        return self.strengths[int(np.flatnonzero(total == total.min())[-1])]

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remarks on the choice."""
        said = []
        if len(self.strengths) > 1 and self.best == self.strengths[-1]:
            said.append(f"the strongest prior tried ({self.best:g}) predicts best; the data add little")
        if self.failures:
            said.append(
                f"cross-validation left out {len(self.failures)} of {self.errors.size} fits that failed; the first: "
                f"{self.failures[0]}"
            )
        return tuple(said)


def cross_validation(
    problem: Problem,
    noise: Array,
    strengths: Sequence[float],
    train: Callable[[CompressedEquations], Trained],
    *,
    folds: Sequence[CompressedEquations] | None = None,
) -> CrossValidation:
    """Errors of all strengths on each fold, for fits to the other folds.

    train: prepares the fit to all folds but one; noise: σ_g of every joint (n,)
    folds: those of the problem if left out
    Raises EstimationFailed with less than two time blocks, and if every strength fails.
    """
    folds = problem.folds if folds is None else folds
    if len(folds) < 2:
        raise EstimationFailed(
            f"cross-validation needs two time blocks, there is {len(folds)}; give a strength, a longer recording or "
            "more blocks (n_blocks)"
        )
    errors, failures = np.full((len(folds), len(strengths)), np.inf), list[str]()
    for k, held_out in enumerate(folds):
        trained = train(merged([*folds[:k], *folds[k + 1 :]]))
        for s, strength in reversed(list(enumerate(strengths))):  # a strong prior is a good start for a weaker one
            try:
                x = problem.base.values(trained(strength))
            except EstimationFailed as failure:
                failures.append(f"strength {strength:g}, without fold {k + 1}: {failure}")
                continue
            errors[k, s] = np.sum(held_out.residual_squares(x) / noise**2)
    if not np.any(np.isfinite(errors.sum(axis=0))):
        raise EstimationFailed(f"cross-validation: every strength fails in some fold; {failures[0]}")
    return CrossValidation(tuple(strengths), errors, tuple(failures))
