"""Methods compared two by two: against SciPy, counting, and tables in which it is known who is better."""

from itertools import product

import numpy as np
import pytest
import scipy.stats

from crosscheck.study.settings.design import StudyDesign
from crosscheck.study.statistics.comparison import compared, pair_count, run_differences, same_methods
from crosscheck.study.statistics.signed_ranks import (
    detectable_shift,
    fewest_runs,
    holm,
    needed_runs,
    probabilities,
    tendency,
)

INF = np.inf


def table(*factors, runs=12, scenarios=2, scatter=0.02, seed=0):
    """Errors (R, S, M) of methods that are so many times as large, each with scatter of its own."""
    rng = np.random.default_rng(seed)
    shared = rng.lognormal(size=(runs, scenarios, 1))
    return shared * np.array(factors) * np.exp(scatter * rng.standard_normal((runs, scenarios, len(factors))))


def names(errors):
    return [f"m{k}" for k in range(errors.shape[-1])]


def test_probabilities():
    values = np.random.default_rng(1).normal(0.3, 1.0, (15, 4))
    values[0, 1:] = 0.0, np.nan, 0.5
    values[:, 3] = 0.0
    known = [scipy.stats.wilcoxon(column[np.abs(column) > 0]).pvalue for column in values[:, :3].T]
    assert probabilities(values).tolist() == [*known, 1.0]


@pytest.mark.parametrize("values", [[INF, INF, 0.1, 0.2, -0.3, 0.5], [INF, -INF, INF, 0.1, 0.2, 0.3, 0.4]])
def test_failures_rank_last_in_the_cautious_order(values):
    """The probability is the largest of all orders that the infinite differences could have, by counting."""
    values = np.array(values)
    infinite = np.flatnonzero(np.isinf(values))
    found = []
    for order in set(product(range(2, 2 + len(infinite)), repeat=len(infinite))):
        if len(set(order)) == len(order):
            numbers = values.copy()
            numbers[infinite] = np.sign(values[infinite]) * order
            found.append(scipy.stats.wilcoxon(numbers).pvalue)
    assert probabilities(values[:, None]) == max(found)
    assert tendency(values) > 0


def test_holm_rejects_what_his_procedure_does():
    values = np.random.default_rng(2).uniform(0, 0.1, 8)
    adjusted = holm(values)
    for level in (0.01, 0.05, 0.2):
        rejected = set()
        for step, k in enumerate(np.argsort(values)):
            if values[k] > level / (8 - step):
                break
            rejected.add(k)
        assert set(np.flatnonzero(adjusted <= level)) == rejected


def test_fewest_runs():
    for pairs in (1, 4, 19, 190):
        runs = fewest_runs(pairs)
        smallest = [scipy.stats.wilcoxon(np.arange(1.0, count + 1)).pvalue for count in (runs - 1, runs)]
        assert smallest[1] <= 0.05 / pairs < smallest[0]


@pytest.mark.parametrize(("runs", "pairs"), [(6, 1), (12, 1), (12, 19), (60, 19), (120, 19)])
def test_what_can_be_shown_is_found_nine_times_of_ten(runs, pairs):
    """By SciPy's test of 4000 studies: within 2 % of the normal sum of ranks, and 4 standard deviations."""
    values = np.random.default_rng(3).standard_normal((runs, 4000)) + detectable_shift(runs, pairs)
    found = np.mean(scipy.stats.wilcoxon(values, axis=0).pvalue <= 0.05 / pairs)
    assert found == pytest.approx(0.9, abs=0.02 + 4 * np.sqrt(0.09 / 4000))


def test_too_few_runs_show_nothing():
    assert detectable_shift(9, 19) == INF
    for shift in (0.8, 0.3, 0.1):
        runs = needed_runs(shift, 19)
        assert detectable_shift(runs, 19) <= shift < detectable_shift(runs - 1, 19)


def test_a_run_has_one_difference():
    """The mean over its scenarios; without those in which both have failed; infinite where one has failed alone."""
    one = np.array([[2.0, 8.0], [2.0, INF], [INF, 1.0], [1.0, INF], [INF, 1.0], [INF, INF]])
    other = np.array([[1.0, 1.0], [1.0, INF], [1.0, 1.0], [1.0, 1.0], [1.0, INF], [INF, INF]])
    assert np.exp(run_differences(one, other)) == pytest.approx([4, 2, INF, INF, np.nan, np.nan], nan_ok=True)


def test_verdicts():
    """Against the reference that is named; ratios with Student's interval of the run means."""
    errors = table(1.0, 0.5, 2.0, 1.0)
    found = compared(errors, names(errors), StudyDesign(reference="m0"))
    assert [(pair.method, pair.other, pair.verdict) for pair in found.pairs] == [
        ("m1", "m0", "better"), ("m2", "m0", "worse"), ("m3", "m0", "equivalent"),
    ]  # fmt: skip
    assert [pair.method for pair in found.of("worse")] == ["m2"]
    assert (found.reference, found.runs, found.scenarios, found.fewest) == ("m0", 12, 2, 7)
    logs = np.log(errors[..., 1] / errors[..., 0]).mean(axis=1)
    known = scipy.stats.ttest_1samp(logs, 0).confidence_interval(1 - 0.05 / 3)
    ratio = found.pairs[0].ratio
    assert [ratio.value, ratio.low, ratio.high] == pytest.approx(np.exp([logs.mean(), known.low, known.high]))
    assert found.pairs[0].probability == pytest.approx(3 * scipy.stats.wilcoxon(logs).pvalue)
    assert (found.ratio("m0").high, found.ratio("m1")) == (1.0, ratio)


def test_what_is_undecided_says_what_it_takes():
    errors = table(1.0, 1.0, scatter=0.2)
    (pair,) = compared(errors, names(errors), StudyDesign(reference="m0")).pairs
    spread = np.log(errors[..., 1] / errors[..., 0]).mean(axis=1).std(ddof=1)
    assert pair.verdict == "undecided"
    assert pair.detectable == pytest.approx(np.exp(spread * detectable_shift(12, 1)))
    assert pair.more_runs == needed_runs(np.log(1.05) / spread, 1) - 12


def test_few_runs_decide_nothing():
    errors = table(1.0, 0.1, 0.1, runs=6)
    found = compared(errors, names(errors), StudyDesign())
    assert (found.fewest, {pair.verdict for pair in found.pairs}) == (7, {"undecided"})
    assert {pair.detectable for pair in found.pairs} == {INF}


def test_others_change_the_number_of_pairs_alone():
    errors = table(1.0, 0.5, 0.9, 1.1)
    several, two = (compared(part, names(part), StudyDesign(reference="m0")) for part in (errors, errors[..., :2]))
    both = several.pairs[0], two.pairs[0]
    assert [pair.ratio.value for pair in both] == [both[0].ratio.value] * 2
    assert both[0].probability == pytest.approx(3 * both[1].probability)


def test_all_pairs():
    errors = table(1.0, 0.5, 0.9, 1.1)
    found = compared(errors, names(errors), StudyDesign(reference="m2", pairs="all"))
    assert len({frozenset((pair.method, pair.other)) for pair in found.pairs}) == len(found.pairs) == 6
    assert pair_count(4, StudyDesign(pairs="all")) == 6
    assert set(found.with_reference) == {"m0", "m1", "m3"}


def test_failures_count_as_the_largest_difference():
    """A method that is better where it answers, and fails more often, is not called better, nor equivalent."""
    errors = table(1.0, 0.8, 1.0, scatter=0.01)
    errors[:7, 0, 1] = INF
    errors[0, 0, 2] = INF
    often, once = compared(errors, names(errors), StudyDesign(reference="m0")).pairs
    assert (often.failed, often.other_failed, often.runs, often.ratio.high) == (7, 0, 5, INF)
    assert often.ratio.value == pytest.approx(0.8, rel=0.02)
    assert often.verdict == "undecided"
    assert (once.failed, once.verdict != "equivalent") == (1, True)
    errors[:, 0, 1] = INF
    never, _ = compared(errors, names(errors), StudyDesign(reference="m0")).pairs
    assert (never.verdict, never.failed, never.runs) == ("worse", 12, 0)
    assert np.isnan(never.ratio.value)


def test_each_fails_alone_in_the_same_run():
    """The run says nothing of the ratio, counts as a failure of both, and leaves both ends of the interval open."""
    errors = table(1.0, 1.0, scatter=0.001)
    errors[3, 0, 0], errors[3, 1, 1] = INF, INF
    (pair,) = compared(errors, names(errors), StudyDesign(reference="m0")).pairs
    assert (pair.failed, pair.other_failed, pair.runs, pair.verdict) == (1, 1, 11, "undecided")
    assert (pair.ratio.low, pair.ratio.high) == (0.0, INF)


def test_methods_that_are_one():
    """They are told, and compared once; the reference stands for its group wherever it is."""
    errors = table(1.0, 0.5, 0.5)
    errors = np.concatenate([errors, errors[..., :1] * (1 + 5e-4), errors[..., 1:2]], axis=-1)
    assert same_methods(errors).tolist() == [0, 1, 2, 0, 1]
    found = compared(errors, names(errors), StudyDesign(reference="m3"))
    assert found.same == (("m3", "m0"), ("m1", "m4"))
    assert [pair.method for pair in found.pairs] == ["m1", "m2"]
    assert (found.ratio("m0").value, found.ratio("m4")) == (1.0, found.ratio("m1"))
    errors[0, 0, 4] = INF
    assert same_methods(errors).tolist() == [0, 1, 2, 0, 4], "a failure tells them apart"
    errors[..., 1:3] = INF
    assert same_methods(errors).tolist() == [0, 1, 2, 0, 4], "nothing is known of methods that always fail"


def test_null_studies_call_nothing_better():
    """Of 20 methods that are alike, correlated within runs: at most 7 % of 200 studies, and 4 standard deviations."""
    rng, called = np.random.default_rng(5), 0
    for _ in range(200):
        shared = rng.normal(size=(12, 1, 1)) + 0.2 * rng.normal(size=(12, 2, 1))
        errors = np.exp(shared + 0.13 * rng.normal(size=(12, 2, 20)))
        called += any(
            pair.verdict in ("better", "worse") for pair in compared(errors, names(errors), StudyDesign()).pairs
        )
    assert called / 200 <= 0.07 + 4 * np.sqrt(0.07 * 0.93 / 200)
