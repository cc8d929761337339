"""Statistics of a study against closed forms, scipy, and published tables."""

from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest
import scipy.stats
from identified.study_tables import METHODS, NAMES, NOISES, TRUTH, study_tables

from crosscheck.study.settings.design import StudyDesign
from crosscheck.study.statistics.grid import grid_of
from crosscheck.study.statistics.intervals import Intervals, deviations, means, median, order_of_median, share
from crosscheck.study.statistics.outcomes import outcomes, read_outcomes
from crosscheck.study.statistics.ranking import critical_distance, friedman, ranked, record_ranks
from crosscheck.study.statistics.summary import summarized
from graphdyn import InvalidInput

# Demšar 2006, Table 6: ranks of C4.5 and three variants on 14 data sets
DEMSAR = np.array(
    [
        [4, 3, 2, 1], [1, 2, 3, 4], [4, 1, 2, 3], [4, 1, 3, 2], [4, 2, 3, 1], [1, 2.5, 4, 2.5], [3, 2, 4, 1],
        [2.5, 2.5, 4, 1], [4, 3, 2, 1], [2.5, 2.5, 2.5, 2.5], [4, 2.5, 1, 2.5], [3, 2, 4, 1], [4, 1, 2, 3],
        [3, 1, 4, 2],
    ]
)  # fmt: skip

RUNS = 6


@pytest.fixture(scope="module")
def study():
    return summarized(outcomes(*study_tables(RUNS)))


@pytest.mark.parametrize(("count", "trials"), [(0, 5), (1, 5), (5, 5), (3, 25), (81, 263)])
def test_share(count, trials):
    wilson = scipy.stats.binomtest(count, trials).proportion_ci(0.95, "wilson")
    found = share(count, trials)
    assert (found.value, found.low, found.high) == pytest.approx((count / trials, wilson.low, wilson.high), abs=1e-12)


def test_share_published():
    """Newcombe, Statistics in Medicine 17, 1998, Table I, method 3."""
    for count, trials, low, high in [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611)]:
        found = share(count, trials)
        assert (round(found.low, 4), round(found.high, 4)) == (low, high)


@pytest.mark.parametrize("count", [6, 9, 25, 60])
def test_median(count):
    values = np.random.default_rng(count).lognormal(size=count)
    known = scipy.stats.quantile_test(values, p=0.5).confidence_interval(0.95)
    found = median(values)
    assert (found.value, found.low, found.high) == (np.median(values), known.low, known.high)


@pytest.mark.parametrize(("count", "known"), [(3, (1, 0.75)), (6, (1, 0.96875)), (10, (2, 0.978515625))])
def test_probability_of_an_interval_of_the_median(count, known):
    """One minus twice the binomial tail below the k-th of so many: Conover, section 3.2."""
    assert order_of_median(count) == pytest.approx(known)


def test_median_with_failures():
    """Few values: all of them; failures are the largest, and half of them leave no finite median."""
    assert vars(median(np.array([3.0, 1.0, 2.0]))) == {"value": 2.0, "low": 1.0, "high": 3.0}
    found = median(np.array([1.0, 2.0, np.inf, np.inf, np.inf]))
    assert (found.value, found.low, found.high) == (np.inf, 1.0, np.inf)
    assert median(np.array([1.0, 2.0, np.inf, np.inf])).value == np.inf


def test_median_of_one_has_no_interval():
    found = median(np.array([2.0]))
    assert found.value == 2.0
    assert np.isnan([found.low, found.high]).all()


def test_means_and_deviations():
    values = np.random.default_rng(1).normal([1.0, -2.0], [0.3, 5.0], size=(7, 2))
    for k, column in enumerate(values.T):
        known = scipy.stats.ttest_1samp(column, 0).confidence_interval(0.95)
        found = means(values)[k]
        assert [found.low, found.high] == pytest.approx([known.low, known.high])
        spread = deviations(values)[k]
        for end, tail in ((spread.low, scipy.stats.chi2.sf), (spread.high, scipy.stats.chi2.cdf)):
            assert tail(6 * column.var(ddof=1) / end**2, 6) == pytest.approx(0.025)


def test_ranks():
    """Equal up to rounding share their ranks; so do failures, which come last."""
    errors = np.array([[0.2, 0.1, 0.1 * (1 + 1e-9), np.inf, np.inf, 0.3], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]])
    assert record_ranks(errors).tolist() == [[3, 1.5, 1.5, 5.5, 5.5, 4], [1, 2, 3, 4, 5, 6]]
    assert np.array_equal(record_ranks(1e-9 * errors), record_ranks(errors)), "whatever the errors are measured in"


def test_published_ranks():
    """Demšar's critical distances 1.25 and 1.12, and q of 2 … 10 methods (Table 5 a)."""
    assert DEMSAR.mean(axis=0).round(3).tolist() == [3.143, 2.0, 2.893, 1.964]
    assert round(critical_distance(4, 14), 2) == 1.25
    assert round(critical_distance(4, 14, 0.90), 2) == 1.12
    q = [1.960, 2.343, 2.569, 2.728, 2.850, 2.949, 3.031, 3.102, 3.164]
    for k, known in enumerate(q, start=2):
        assert critical_distance(k, 1) / np.sqrt(k * (k + 1) / 6) == pytest.approx(known, abs=1.1e-3)


def test_friedman_of_many_records():
    ranks = record_ranks(np.random.default_rng(4).normal([0, 0.2, 0.4, 0.4], 1.0, size=(40, 4)).round(1))
    known = scipy.stats.friedmanchisquare(*ranks.T).pvalue
    assert friedman(ranks) == pytest.approx(known, rel=1e-12)


def exact_probability(ranks):
    """Share of all permutations of the ranks within records whose rank sums differ as much."""
    count, methods = ranks.shape

    def squares(rows):
        return sum((sum(column) - count * (methods + 1) / 2) ** 2 for column in zip(*rows, strict=True))

    every = [list(permutations(row)) for row in ranks.tolist()]
    reached = [squares(rows) >= squares(ranks.tolist()) - 1e-9 for rows in product(*every)]
    return np.mean(reached)


@pytest.mark.parametrize(
    "ranks",
    [
        [[1, 2]] * 5,  # the test of signs: 2 / 32
        [[1, 2, 3]] * 3,  # Friedman 1937, Table V: 0.028
        [[1, 2, 3], [1, 2.5, 2.5], [1, 3, 2], [2, 1, 3]],
    ],
)
def test_friedman_of_few_records(ranks):
    ranks = np.array(ranks, float)
    assert friedman(ranks) == pytest.approx(exact_probability(ranks), abs=0.02)


def test_friedman_is_never_certain():
    """Of m permutations none is as extreme: (0 + 1) / (m + 1), Phipson and Smyth 2010."""
    assert friedman(np.array([[1.0, 2, 3, 4, 5, 6]] * 8)) == pytest.approx(1 / 2001)


def test_friedman_needs_two():
    assert friedman(np.array([[1.0, 2.0]])) is None
    assert friedman(np.array([[1.0], [1.0]])) is None
    assert friedman(np.full((5, 3), 2.0)) == 1.0


def test_ranking(study):
    """Of the run means; methods are apart beyond the critical distance alone; failures are last; classes are apart."""
    assert {measures for measures, _ in study.rankings} == {"torques"}, "one method with wrenches has nothing beside it"
    found = study.rankings["torques", "parameter_error"]
    assert found.runs == RUNS
    assert found.distance == pytest.approx(2.850 * np.sqrt(6 * 7 / (6 * RUNS)), abs=2e-3)
    assert dict(zip(found.methods, found.failures, strict=True)) == {
        "didim": 1, "iv": 0, "cloe": 4, "wls": 0, "wls-pinocchio": 0, "ols": 0,
    }  # fmt: skip
    assert found.apart(0, 5)
    assert not any(found.apart(k, k + 1) for k in range(5))
    assert [replace(found, probability=p).differ for p in (0.049, 0.051)] == [True, False]
    assert np.all(found.rank.low <= found.rank.value)


def test_ranks_are_those_of_run_means():
    """Runs are independent, records of a run are not: of two scenarios each run has one rank for each method."""
    errors = np.random.default_rng(7).lognormal(size=(9, 2, 3))
    errors[0, 1] = np.inf
    errors[1, 0, 2] = np.inf
    found = ranked(["a", "b", "c"], errors)
    means = np.exp(np.log(errors).mean(axis=1))
    means[0] = errors[0, 0]
    ranks = scipy.stats.rankdata(means, axis=1)
    order = [("a", "b", "c").index(name) for name in found.methods]
    assert found.rank.value == pytest.approx(ranks.mean(axis=0)[order])
    known = scipy.stats.ttest_1samp(ranks[:, order[0]], 0).confidence_interval(0.95)
    assert (found.rank.low[0], found.rank.high[0]) == pytest.approx((known.low, known.high))
    assert (found.runs, sorted(found.failures)) == (9, [0, 0, 1])
    assert found.probability == pytest.approx(friedman(ranks), abs=0.05)  # of 2000 other permutations
    assert ranked(["a", "b"], np.full((3, 1, 2), np.inf)) is None


def test_comparisons_of_a_study(study):
    """Over the scenarios in which all of a class take part, and of each scenario; errors in a known ratio."""
    found = study.comparisons["torques", "parameter_error"]
    assert (found.reference, found.same) == ("wls", (("wls", "wls-pinocchio"),))
    assert (found.runs, found.scenarios) == (RUNS, 2 * len(NOISES))
    cloe = found.with_reference["cloe"]
    assert (cloe.failed, cloe.other_failed, cloe.ratio.high) == (4, 0, np.inf)
    first = study.scenarios[0].comparisons["torques", "parameter_error"].with_reference
    assert first["didim"].ratio.value / first["iv"].ratio.value == pytest.approx(6 / 7), "as planted, in each record"
    both = summarized(study.outcomes, StudyDesign(reference="iv", pairs="all")).comparisons["torques", "torque_error"]
    assert (both.reference, len(both.pairs)) == ("iv", 10)


def test_sources_of_the_scatter():
    """Of two parameters that noise and motion move by known amounts; a bias that only redrawn CAD models hide."""
    rng, runs, repeats = np.random.default_rng(8), 400, 3
    size = {"noise": np.array([1.0, 2.0]), "cad": np.array([3.0, 0.5])}

    def drawn(source, *shape):
        return size[source] * rng.standard_normal((*shape, 2))

    noise, cad = drawn("noise", runs), drawn("cad", runs)
    results, scenarios, times = study_tables(1, motions=("Fourier",))
    row = next(row for row in results if row["method"] == "wls")
    truth = {"base_names": ["M_1", "M_2"], "base_units": ["kg", "kg"], "truth": [0.0, 0.0]}
    rows = []
    for run in range(runs):
        values = {(None, 0): noise[run] + cad[run]}
        for k in range(1, repeats + 1):
            values["noise", k] = drawn("noise") + cad[run]
            values["cad", k] = noise[run] + drawn("cad")
        rows += [
            {**row, "run": run, "redrawn": source, "repeat": k, "base": base.tolist(), "sigma": [0.5, 1.0]}
            for (source, k), base in values.items()
        ]
    found = summarized(outcomes(rows, [scenarios[0] | truth], times)).scenarios[0].methods[0].parameters
    total = size["noise"] ** 2 + size["cad"] ** 2
    for source, expected in size.items():
        assert found.shares[source] == pytest.approx(expected**2 / total, abs=0.15)
    assert found.held_bias == pytest.approx(size["cad"], rel=0.2)
    assert found.z == pytest.approx(np.sqrt(total) / [0.5, 1.0], rel=0.15)


def test_scenarios_with_the_usual_motion_come_first():
    """Written noise by noise; shown motion by motion, with rising noise."""
    grid = grid_of(outcomes(*study_tables(1)).scenarios)
    shown = [(one.axes["motion"], one.axes["position_noise"]) for one in map(grid.scenarios.__getitem__, grid.order())]
    assert shown == [("Fourier", 1e-3), ("Fourier", 1e-2), ("paper", 1e-3), ("paper", 1e-2)]


def test_a_method_that_is_apart_is_in_no_group(study):
    found = study.rankings["torques", "parameter_error"]
    ranks = np.array([1.0, 3.0, 3.5, 4.4, 4.6, 6.0])
    alone = replace(found, rank=Intervals(ranks, ranks, ranks), distance=1.2, probability=0.01)
    assert alone.alike == [(1, 2), (2, 4)]
    assert replace(alone, probability=0.5).alike == [(0, 5)]


def test_one_run_has_no_interval():
    found = summarized(outcomes(*study_tables(1, motions=("Fourier",))))
    ranking = found.rankings["torques", "torque_error"]
    assert np.isnan(ranking.rank.low).all()
    assert not ranking.differ
    pair = found.comparisons["torques", "torque_error"].with_reference["ols"]
    assert np.isnan([pair.ratio.low, pair.ratio.high]).all()
    assert (pair.detectable, pair.more_runs, pair.verdict) == (None, None, "undecided")


def test_summary(study):
    """Bias and spread are those that were planted, of the answers alone; shares count failures."""
    scenario = study.scenarios[-2]
    names = [method.method.name for method in scenario.methods]
    ols, cloe = (scenario.methods[names.index(name)] for name in ("ols", "cloe"))
    spread = ols.parameters
    planted = NOISES[-1] * METHODS["ols"][1] * TRUTH
    stated = NOISES[-1] * np.abs(TRUTH)
    assert np.all(np.abs(spread.bias.value - planted) < 4 * stated / np.sqrt(RUNS))
    assert spread.z == pytest.approx(np.hypot(spread.bias.value, spread.spread.value * np.sqrt(1 - 1 / RUNS)) / stated)
    assert spread.biased == len(NAMES)
    assert (cloe.runs, cloe.found, cloe.reasons) == (6, 2, {"no convergence after 50 iterations": 4})
    assert cloe.failed.value == pytest.approx(4 / 6)
    assert cloe.seconds.value == pytest.approx(9 * 1.65), "the median of all runs, failures included"
    assert cloe.consistent.value == 1.0
    assert cloe.errors["torque_error"].value == np.inf
    assert ols.consistent.value == pytest.approx(4 / 6)
    assert (cloe.iterations, ols.iterations[0]) == ((4.5, 5.0), pytest.approx(np.nan, nan_ok=True))


def test_every_number_of_a_summary_is_that_of_its_rows():
    """Of tables in which some values of every column are missing."""
    results, scenarios, times = study_tables(9)
    rng = np.random.default_rng(0)
    for row in results:
        if row["status"] == "found":
            missing = [name for name in ("sigma", "iterations", "simulations", "consistent") if rng.random() < 0.3]
            row.update(dict.fromkeys(missing), simulations=row["simulations"] and int(rng.integers(1, 99)))
    for row in times:
        row["processor_seconds"] = None if rng.random() < 0.2 else float(rng.uniform(1, 2))
    for scenario, row in zip(summarized(outcomes(results, scenarios, times)).scenarios, scenarios, strict=True):
        for method in scenario.methods:
            own, took = (
                [each for each in table if (each["scenario"], each["method"]) == (row["scenario"], method.method.name)]
                for table in (results, times)
            )
            answered = [each for each in own if each["status"] == "found"]
            assert (method.runs, method.found) == (len(own), len(answered))
            assert sum(method.reasons.values()) == len(own) - len(answered)
            known = numbers_of(answered, "consistent")
            assert method.consistent.value == pytest.approx(np.mean(known) if known else np.nan, nan_ok=True)
            for name in ("iterations", "simulations"):
                some = numbers_of(answered, name)
                expected = (np.median(some), max(some)) if some else (np.nan, np.nan)
                assert getattr(method, name) == pytest.approx(expected, nan_ok=True)
            for name, error in method.errors.items():
                every = [np.inf if each[name] is None else each[name] for each in own]
                assert error.value == pytest.approx(np.median(every) if own else np.nan, nan_ok=True)
            if own:
                assert method.failed.value == pytest.approx(1 - len(answered) / len(own))
                assert method.seconds.value == pytest.approx(np.median(numbers_of(took, "processor_seconds")))
                base = np.array([each["base"] for each in answered])
                stated = [each for each in answered if each["sigma"] is not None]
                z = [(np.array(each["base"]) - row["truth"]) / each["sigma"] for each in stated]
                assert method.parameters.bias.value == pytest.approx(base.mean(axis=0) - row["truth"])
                assert method.parameters.spread.value == pytest.approx(base.std(axis=0, ddof=1))
                assert method.parameters.z == pytest.approx(np.sqrt(np.mean(np.square(z), axis=0)))


def numbers_of(rows, name):
    """Those that are not missing."""
    return [float(row[name]) for row in rows if row[name] is not None]


def test_read(tmp_path, study):
    import pyarrow
    from pyarrow.parquet import write_table

    for name, rows in zip(("results", "scenarios", "times"), study_tables(RUNS), strict=True):
        write_table(pyarrow.Table.from_pylist(rows), tmp_path / f"{name}.parquet")
    read = read_outcomes(tmp_path)
    assert read.methods == study.outcomes.methods
    for one, other in zip(read.scenarios, study.outcomes.scenarios, strict=True):
        assert (one.name, one.axes, one.reasons) == (other.name, other.axes, other.reasons)
        assert np.array_equal(one.base, other.base, equal_nan=True)


def test_numbers_that_are_missing_in_a_list_are_not_zero():
    results, scenarios, times = study_tables(2, motions=("Fourier",))
    for name in ("base", "sigma"):
        results[0][name] = [*results[0][name][:2], None, *results[0][name][3:]]
    (first, *_) = outcomes(results, scenarios, times).scenarios
    for found, name in ((first.base[0, 0], "base"), (first.sigma[0, 0], "sigma")):
        assert np.flatnonzero(np.isnan(found)).tolist() == [2]
        assert np.delete(found, 2).tolist() == [x for x in results[0][name] if x is not None]


def test_an_error_that_is_no_number_is_a_failure():
    results, scenarios, times = study_tables(2, motions=("Fourier",))
    results[0]["torque_error"] = np.nan
    (first, *_) = outcomes(results, scenarios, times).scenarios
    assert np.isinf(first.errors["torque_error"][0]).tolist() == [True] + [False] * (len(METHODS) - 1)


def test_tables_that_do_not_fit():
    results, scenarios, times = study_tables(2, motions=("Fourier",))
    name = scenarios[0]["scenario"]
    with pytest.raises(InvalidInput, match=f"no row of 'graph' for run 0 of scenario '{name}'"):
        outcomes([row for k, row in enumerate(results) if k != len(METHODS) - 1], scenarios, times)
    with pytest.raises(InvalidInput, match=f"has scenario '{name}', scenarios.parquet has not"):
        outcomes(results, scenarios[1:], times)
    with pytest.raises(InvalidInput, match="has no rows"):
        outcomes([], scenarios, times)
    results[0]["base"] = [1.0]
    with pytest.raises(InvalidInput, match=r"'base' of 'ols', run 0 of .* has 1 value, .* names 6 base parameters"):
        outcomes(results, scenarios, times)


def test_scenarios_without_a_run():
    """A study of real recordings alone has no scenarios; scenarios without rows are no study yet."""
    _, scenarios, _ = study_tables(1)
    assert outcomes([], [], []).scenarios == ()
    with pytest.raises(InvalidInput, match=r"results\.parquet has no rows: the study has no run to report"):
        outcomes([], scenarios, [])
