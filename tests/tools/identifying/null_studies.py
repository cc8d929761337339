"""What the statistics of a study decide where the truth is known: python tests/tools null_studies [STUDIES].

Tables of errors are drawn, without any identification: 20 methods in 2 scenarios, whose errors are lognormal and
correlated within each run. Two run means of the logarithms differ by a standard deviation of 0.13.
"""

import sys
from itertools import product

import numpy as np
from scipy.stats import wilcoxon

from crosscheck.study.settings.design import StudyDesign
from crosscheck.study.statistics.comparison import compared, pair_count
from crosscheck.study.statistics.signed_ranks import needed_runs

METHODS, SCENARIOS = 20, 2
OF_RUNS, OF_RECORDS = 0.5, 0.2
"""Standard deviations of the logarithms that all methods share: of a run, of one of its records."""

DIFFERENCE = 0.13
"""Of the means of two methods over the scenarios of a run."""

TRUE_RATIO = 1.10
DISTRIBUTIONS = {
    "normal": lambda rng, size: rng.standard_normal(size),
    "t of 3": lambda rng, size: rng.standard_t(3, size) / 3**0.5,
}
"""Of what a method has of its own, with the standard deviation 1."""


def errors(rng, runs, methods=METHODS, ratio=1.0, kind="normal"):
    """(R, S, M), of which the first method is the reference, and the second better by the ratio."""
    shared = OF_RUNS * rng.standard_normal((runs, 1, 1)) + OF_RECORDS * rng.standard_normal((runs, SCENARIOS, 1))
    own = DISTRIBUTIONS[kind](rng, (runs, SCENARIOS, methods)) * DIFFERENCE * np.sqrt(SCENARIOS / 2)
    logs = shared + own
    logs[..., 1] -= np.log(ratio)
    return np.exp(logs)


def decided(rng, studies, runs, design, methods=METHODS, ratio=1.0, kind="normal"):
    """Parts of the studies in which any method is called better or worse, and in which the second is called better;
    the median of the ratio that a study says it can show, and the part of the intervals that hold the true ratio."""
    names = [f"m{k}" for k in range(methods)]
    found = [compared(errors(rng, runs, methods, ratio, kind), names, design) for _ in range(studies)]
    any_called = [any(pair.verdict in ("better", "worse") for pair in one.pairs) for one in found]
    second = [one.with_reference["m1"] for one in found]
    covered = [pair.ratio.low * ratio <= 1 <= pair.ratio.high * ratio for pair in second]
    shown = [pair.detectable for pair in second]
    return np.mean(any_called), np.mean([p.verdict == "better" for p in second]), np.median(shown), np.mean(covered)


def main() -> None:
    studies = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    rng = np.random.default_rng(0)
    print(f"{studies} null studies of {METHODS} methods that are alike; any is called better or worse:")
    for pairs, kind, runs in (*product(["reference"], DISTRIBUTIONS, [12, 25]), ("all", "normal", 25)):
        design = StudyDesign(pairs=pairs)
        part, *_ = decided(rng, studies, runs, design, kind=kind)
        print(f"  {pair_count(METHODS, design):3} pairs, {runs} runs, {kind:8} {part:6.1%}", flush=True)
    print(f"One is better by {TRUE_RATIO:g}, the others are alike; found, said to be shown, interval holds it:")
    for methods in (2, METHODS):
        needed = needed_runs(np.log(TRUE_RATIO) / DIFFERENCE, methods - 1)
        for runs in sorted({12, 25, needed}):
            _, found, shown, covered = decided(rng, studies, runs, StudyDesign(), methods, TRUE_RATIO)
            print(f"  {methods:2} methods, {runs:3} runs {found:6.1%} {shown:6.3f} {covered:6.1%}", flush=True)
    print("The ratio that a study can show: said (median), found where it is the true one, and by SciPy's test:")
    for methods, runs in ((2, 12), (METHODS, 12), (METHODS, 25), (METHODS, 50)):
        *_, shown, _ = decided(rng, studies // 4, runs, StudyDesign(), methods)
        _, found, *_ = decided(rng, studies, runs, StudyDesign(), methods, shown)
        other = simulated_ratio(runs, methods - 1)
        print(f"  {methods:2} methods, {runs:3} runs: said {shown:.3f}, found {found:6.1%}; {other:.3f}", flush=True)


def simulated_ratio(runs, pairs):
    """The ratio for which 90 % of normal differences have a probability of at most 0.05 / pairs, by bisection."""
    drawn = DIFFERENCE * np.random.default_rng(1).standard_normal((runs, 5000))
    low, high = 0.0, 1.5
    for _ in range(12):
        middle = (low + high) / 2
        found = np.mean(wilcoxon(drawn + middle, axis=0).pvalue <= 0.05 / pairs)
        low, high = (low, middle) if found >= 0.9 else (middle, high)
    return np.exp(high)
