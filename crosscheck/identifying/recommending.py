"""Which of several results can be trusted for simulation and control, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from crosscheck.identifying.identified_model import Candidate
from crosscheck.identifying.result_errors import mean_error
from crosscheck.identifying.spread import difference
from graphdyn.identification import MethodResult

NOTHING = 1.0
"""Relative error of a model that predicts zero torque."""

TIE = 1e-6
"""Relative difference of errors that counts as rounding; of methods so close, the first is taken."""


@dataclass(frozen=True)
class Recommendation:
    """Which result to use.

    name: of the method, None where no result can be used
    reason: one sentence
    best: of the method that would be recommended if there were no doubts; name where there are none
    doubts: why it is not, in sentences
    """

    name: str | None
    reason: str
    best: str | None = None
    doubts: tuple[str, ...] = ()


def real(result: MethodResult) -> bool:
    """Whether every link is physically consistent, and the mass matrix positive definite in every tested pose."""
    plausible = result.plausibility
    return (
        plausible is not None
        and plausible.consistent
        and plausible.positive_definite == len(plausible.mass_matrix_eigenvalues)
    )


def recommendation(candidates: Sequence[Candidate]) -> Recommendation:
    """The physically consistent result with the smallest mean held-out error, or a simpler one that is as good.

    Of results that differ by less than one standard deviation of their difference, the simplest is taken: the rule of
    one standard error of Breiman, Friedman, Olshen and Stone, Classification and Regression Trees, 1984, section 3.4.3.
    """
    answered = [candidate for candidate in candidates if candidate.result.failure is None]
    if not answered:
        return Recommendation(None, "no method has a result")
    consistent = [candidate for candidate in answered if real(candidate.result)]
    if not consistent:
        failed = [candidate for candidate in candidates if candidate.result.failure is not None]
        remedy = (
            f"{', '.join(candidate.name for candidate in failed)} failed: {failed[0].result.failure}"
            if failed
            else "add the methods consistent, entropic or log-cholesky"
        )
        return Recommendation(
            None,
            "no result is physically consistent: each has a link that cannot be a real body, or a mass matrix that is "
            f"not positive definite in some pose; {remedy}",
        )
    smallest = min(mean_error(candidate.result) for candidate in consistent)
    best = next(c for c in consistent if not mean_error(c.result) > smallest * (1 + TIE))
    error = mean_error(best.result)
    if not error < NOTHING:
        return Recommendation(
            None,
            f"the best consistent result, {best.name}, predicts with a mean error of {100 * error:.0f} %, no better "
            "than a torque of zero; the torque model or the recording is wrong, or the robot stands still in all "
            "held-out rows",
        )
    simplest = min((c for c in consistent if c is best or _as_good(c, best)), key=simplicity)
    words = "physically consistent in every link and pose, and its held-out error, averaged over the joints, is "
    if simplest is not best:
        apart = difference(simplest, best)
        return Recommendation(
            simplest.name,
            f"{words}{100 * mean_error(simplest.result):.1f} %; {best.name} has {100 * error:.1f} % and "
            f"{_more(best, simplest)}, and the difference is less than its standard deviation over the pieces of the "
            f"held-out rows, {100 * apart.deviation:.1f} %",
            best=simplest.name,
        )
    others = f"the smallest of {len(consistent)} such results" if len(consistent) > 1 else "the only such result"
    return Recommendation(best.name, f"{words}{100 * error:.1f} %, {others}", best=best.name)


def simplicity(candidate: Candidate) -> tuple[int, float, float]:
    """Small for a simple result: few base parameters and settings, then a strong prior, then a small error."""
    return (numbers_of(candidate), -prior_strength(candidate), mean_error(candidate.result))


def numbers_of(candidate: Candidate) -> int:
    """Base parameters and settings that were found."""
    return candidate.model.problem.base.rank + sum(len(setting.values) for setting in candidate.model.settings)


def prior_strength(candidate: Candidate) -> float:
    """Of the prior of the links; zero for methods without one."""
    assert candidate.result.estimate is not None
    return float(candidate.result.estimate.settings.get("strength", 0.0))


def _as_good(candidate: Candidate, best: Candidate) -> bool:
    """Whether a result is simpler, and predicts worse by less than the difference is certain to."""
    if not simplicity(candidate)[:2] < simplicity(best)[:2]:
        return False
    apart = difference(candidate, best)
    return apart.value <= apart.deviation


def _more(one: Candidate, other: Candidate) -> str:
    """What the first result has more of."""
    ranks = [numbers_of(candidate) for candidate in (one, other)]
    return "more parameters" if ranks[0] > ranks[1] else "the weaker prior"


def doubted(found: Recommendation, doubts: tuple[str, ...]) -> Recommendation:
    """The recommendation, withdrawn if there are doubts."""
    if not doubts:
        return found
    count = "one reason speaks" if len(doubts) == 1 else f"{len(doubts)} reasons speak"
    reason = found.reason if found.best is None else f"{found.best} is the best result, but {count} against it"
    return Recommendation(None, f"{reason}: {'; '.join(doubts)}", found.best, doubts)
