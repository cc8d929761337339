"""Every number of the record and the page of a study, from the rows of its tables, with SciPy."""

import re

import numpy as np
import pytest
from identified.study_tables import METHODS, NOISES, TRUTH, study_tables
from scipy import stats
from shown.approved import approve_record, approve_report
from shown.blocks import blocks, cells, tables

from crosscheck.report.plain_text import time_text
from crosscheck.report.records.record import plain
from crosscheck.report.report import Picture

RUNS = 8
ERROR_NAMES = ("parameter_error", "torque_error", "trajectory_error")
TORQUE_METHODS = [name for name in METHODS if METHODS[name][0] == "torques"]
DEMSAR = 2.850
"""Demšar's table 5a: critical value of Nemenyi's test of six methods at 0.05."""

TWO_DIGITS, THREE_DIGITS = 0.051, 0.0051
"""Relative, of numbers with as many digits."""


class Rows:
    """The rows of the tables of the study, as they were made, computed from with SciPy."""

    def __init__(self):
        results, scenarios, times = study_tables(RUNS)
        self.scenarios = {row["scenario"]: row for row in scenarios}
        self.of = {(row["scenario"], row["method"]): [] for row in results}
        for row, time in zip(results, times, strict=True):
            self.of[row["scenario"], row["method"]].append(row | {"seconds": time["processor_seconds"]})

    def column(self, scenario, method, name):
        """Values of the runs, NaN where there is none."""
        return np.array([np.nan if row[name] is None else row[name] for row in self.of[scenario, method]], float)

    def errors(self, scenario, method, name):
        found = self.column(scenario, method, name)
        return np.where(np.isnan(found), np.inf, found)

    def everywhere(self, method, name):
        own = [scenario for scenario, of in self.of if of == method]
        return np.concatenate([self.column(scenario, method, name) for scenario in own])

    def base(self, scenario, method):
        """Found minus true of the answers, and their stated deviations."""
        rows = [row for row in self.of[scenario, method] if row["base"] is not None]
        return np.array([row["base"] for row in rows]) - TRUTH, np.array([row["sigma"] for row in rows])

    def ranks(self, error, scenario):
        """Of the methods that measure torques (R, k)."""
        errors = np.column_stack([self.errors(scenario, method, error) for method in TORQUE_METHODS])
        return stats.rankdata(np.where(np.isinf(errors), 1e9, np.round(errors, 12)), axis=1)

    def table(self, error):
        """Errors of the methods that measure torques (R, S, k)."""
        parts = [[self.errors(one, method, error) for method in TORQUE_METHODS] for one in self.scenarios]
        return np.moveaxis(np.array(parts), -1, 0)

    def mean_rank(self, error):
        with np.errstate(invalid="ignore"):
            of_runs = np.exp(np.log(self.table(error)).mean(axis=1))
        ranks = stats.rankdata(np.where(np.isinf(of_runs), 1e9, np.round(of_runs, 12)), axis=1)
        return dict(zip(TORQUE_METHODS, ranks.mean(axis=0), strict=True)), ranks


def wilson(count, trials):
    if trials == 0:
        return [None] * 3
    found = stats.binomtest(int(count), int(trials)).proportion_ci(0.95, method="wilson")
    return [count / trials, found.low, found.high]


def middle(values):
    """Median, and the smallest and largest of eight."""
    return [np.median(values), values.min(), values.max()]


def ends(interval):
    """Of the record, without what is not finite."""
    return [np.inf if interval[name] is None else interval[name] for name in ("value", "low", "high")]


def read(text):
    """The numbers of "2.1 (1.4–3.2)", "–" and "∞"."""
    return [np.inf if x == "∞" else float(x) for x in re.findall(r"∞|-?[\d.]+(?:e[+-]?\d+)?", text)]


@pytest.fixture(scope="module")
def rows():
    return Rows()


@pytest.fixture(scope="module")
def report(studied):
    return studied


@pytest.fixture(scope="module")
def record(report):
    return plain(report.record(["study"]))


def test_methods_in_scenarios(rows, record):
    rows, names = rows, []
    for scenario in record["scenarios"]:
        assert scenario["runs"] == RUNS
        assert scenario["truth"] == TRUTH.tolist()
        for found in scenario["results"]:
            own = scenario["name"], found["method"]
            names.append(own)
            answered = np.isfinite(rows.errors(*own, "torque_error"))
            failed = RUNS - answered.sum()
            assert found["found"] == answered.sum()
            assert ends(found["failed"]) == pytest.approx(wilson(failed, RUNS), abs=1e-12)
            assert found["reasons"] == ({"no convergence after 50 iterations": failed} if failed else {})
            for error in ERROR_NAMES:
                assert ends(found[error]) == pytest.approx(middle(rows.errors(*own, error)))
            real = rows.column(*own, "consistent")[answered]
            assert list(found["consistent"].values()) == pytest.approx(wilson(real.sum(), len(real)))
            assert ends(found["seconds"]) == pytest.approx(middle(rows.column(*own, "seconds")))
            iterations = rows.column(*own, "iterations")[answered]
            known = np.isfinite(iterations).any()
            assert found["iterations"] == (np.median(iterations) if known else None)
            assert found["most_iterations"] == (iterations.max() if known else None)
            assert found["simulations"] == found["iterations"]
            if len(real) < 2:
                continue
            off, sigma = rows.base(*own)
            low, high = stats.t.interval(0.95, len(off) - 1, off.mean(axis=0), stats.sem(off))
            for name, values in {"bias": off.mean(axis=0), "bias_low": low, "bias_high": high}.items():
                assert found[name] == pytest.approx(values.tolist(), abs=1e-12)
            spread, free = off.std(axis=0, ddof=1), len(off) - 1
            assert found["spread"] == pytest.approx(spread.tolist())
            for name, p in {"spread_low": 0.975, "spread_high": 0.025}.items():
                assert found[name] == pytest.approx((spread * np.sqrt(free / stats.chi2.ppf(p, free))).tolist())
            assert found["z"] == pytest.approx(np.sqrt(np.mean((off / sigma) ** 2, axis=0)).tolist())
            assert (found["held_bias"], found["shares"]) == ([None] * len(TRUTH), {})
    assert names == [*rows.of]


def test_rankings(rows, record, report):
    distance = DEMSAR * np.sqrt(6 * 7 / (6 * RUNS))
    (ranked,) = tables(report, "ranks-torques")
    shown = cells(ranked)
    assert [column.title for column in ranked.columns[1:-1]] == [f"rank by {e.replace('_', ' ')}" for e in ERROR_NAMES]
    for place, (error, found) in enumerate(zip(ERROR_NAMES, record["rankings"], strict=True)):
        mean, ranks = rows.mean_rank(error)
        assert (found["error"], found["measures"], found["runs"]) == (error, "torques", RUNS)
        assert found["critical_distance"] == pytest.approx(distance, rel=1e-3)
        assert [one["rank"]["value"] for one in found["methods"]] == pytest.approx(sorted(mean.values()))
        for one in found["methods"]:
            name = one["method"]
            of_runs = ranks[:, TORQUE_METHODS.index(name)]
            known = (
                stats.t.interval(0.95, RUNS - 1, of_runs.mean(), stats.sem(of_runs))
                if np.ptp(of_runs)
                else 2 * [mean[name]]
            )
            assert ends(one["rank"]) == pytest.approx([mean[name], *known])
            failures = np.isinf(rows.table(error)[:, :, TORQUE_METHODS.index(name)]).any(axis=1).sum()
            assert one["failures"] == failures
            assert read(shown[name][place]) == pytest.approx(ends(one["rank"]), abs=0.0051)
            assert shown[name][-1] == (str(failures) if failures else "–")


def test_comparisons(rows, record, report):
    """Of each method with wls; wls-pinocchio is told to be one with it."""
    others = [name for name in TORQUE_METHODS if not name.startswith("wls")]
    reference = TORQUE_METHODS.index("wls")
    found = {one.title: cells(one) for one in tables(report, "comparisons-torques")}
    for error, compared in zip(ERROR_NAMES, record["comparisons"], strict=True):
        assert (compared["reference"], compared["same"]) == ("wls", [["wls", "wls-pinocchio"]])
        logs = np.log(rows.table(error))
        with np.errstate(invalid="ignore"):
            differences = {
                name: (logs[..., TORQUE_METHODS.index(name)] - logs[..., reference]).mean(axis=1) for name in others
            }
        ranked = {name: np.where(np.isinf(of), 99.0 + np.arange(RUNS), of) for name, of in differences.items()}
        plain = {name: stats.wilcoxon(of).pvalue for name, of in ranked.items()}
        order = sorted(others, key=plain.get)
        factors = [plain[name] * (len(others) - k) for k, name in enumerate(order)]
        adjusted = dict(zip(order, np.minimum(1, np.maximum.accumulate(factors)), strict=True))
        assert [pair["method"] for pair in compared["pairs"]] == others
        for pair in compared["pairs"]:
            name = pair["method"]
            of = differences[name][np.isfinite(differences[name])]
            low, high = stats.t.interval(1 - 0.05 / 4, len(of) - 1, of.mean(), stats.sem(of))
            failed = RUNS - len(of)
            wanted = [np.exp(of.mean()), np.exp(low), np.inf if failed else np.exp(high)]
            assert ends(pair["ratio"]) == pytest.approx(wanted)
            assert pair["probability"] == pytest.approx(adjusted[name])
            assert (pair["runs"], pair["failed"], pair["other_failed"]) == (len(of), failed, 0)
            said = found[f"By {error.replace('_', ' ')}"][name]
            assert read(said[0]) == pytest.approx(wanted, rel=THREE_DIGITS)
            assert said[1].startswith(pair["verdict"])
            assert float(said[2]) == pytest.approx(pair["probability"], rel=TWO_DIGITS)
            assert said[3:] == [f"{failed}, 0" if failed else "–", str(len(of))]


def test_pictures(rows, record, report):
    """Ranks, trades, lines of errors, bias and spread: what is drawn, in the order of the blocks."""
    ranks = [one.draw.keywords["ranking"] for one in blocks(report, "ranks-torques") if isinstance(one, Picture)]
    for ranking, error in zip(ranks, ERROR_NAMES, strict=True):
        mean, _ = rows.mean_rank(error)
        assert ranking.rank.value.tolist() == pytest.approx([mean[name] for name in ranking.methods])
    drawn = [one.draw.keywords for one in blocks(report, "time-torques") if isinstance(one, Picture)]
    for keywords, error, compared in zip(drawn, ERROR_NAMES, record["comparisons"], strict=True):
        said = {one["method"]: one["ratio"] for one in compared["pairs"]}
        alone = {"value": 1.0, "low": 1.0, "high": 1.0}
        for trade in keywords["trades"]:
            assert trade.seconds == pytest.approx(np.median(rows.everywhere(trade.name, "seconds")))
            assert [trade.ratio, trade.low, trade.high] == pytest.approx(ends(said.get(trade.name, alone)))
            assert trade.whole == (not np.isnan(rows.everywhere(trade.name, error)).any())
    (lines, *_) = [one.draw.keywords for one in blocks(report, "errors-torques") if isinstance(one, Picture)]
    assert lines["places"] == tuple(f"{noise:g}" for noise in NOISES)
    for line, motion in zip(lines["lines"], ("Fourier", "paper"), strict=True):
        for place, noise in zip(line.places, NOISES, strict=True):
            for k, method in enumerate(lines["methods"]):
                own = f"position_noise={noise:g},motion={motion}", method
                errors = 100 * rows.errors(*own, "parameter_error")
                assert line.errors[place][:, k] == pytest.approx(errors)
                three = [part[place, k] for part in (line.middle, line.low, line.high)]
                assert three == pytest.approx(middle(errors))
    for number, (scenario, found) in enumerate(zip(rows.scenarios, record["scenarios"], strict=True)):
        answered = [one for one in found["results"] if one["found"] > 1]
        usual = np.median([one["spread"] for one in answered], axis=0)
        for one in blocks(report, f"scenario-{number + 1}"):
            if isinstance(one, Picture):
                assert one.draw.keywords["scale"] == pytest.approx(usual)
                for method in one.draw.keywords["methods"]:
                    off, _ = rows.base(scenario, method.method.name)
                    zero = stats.ttest_1samp(off, 0).pvalue < 0.05
                    assert method.parameters.biased == zero.sum()


def test_answers(rows, report):
    (answers,) = tables(report, "answers-torques")
    for name, said in cells(answers).items():
        failed, real, iterations, simulations, most, time, upper = said
        every = rows.everywhere(name, "iterations")
        missing = np.isnan(rows.everywhere(name, "torque_error"))
        consistent = rows.everywhere(name, "consistent")[~missing]
        assert read(failed) == pytest.approx(100 * np.array(wilson(missing.sum(), len(missing))), rel=TWO_DIGITS)
        shares = 100 * np.array(wilson(consistent.sum(), len(consistent)))
        assert read(real) == pytest.approx(shares, rel=TWO_DIGITS)
        if np.isfinite(every).any():
            assert read(iterations) == read(simulations) == [pytest.approx(np.nanmedian(every), rel=THREE_DIGITS)]
            assert read(most) == [np.nanmax(every)]
        else:
            assert iterations == simulations == most == "–"
        seconds = np.sort(rows.everywhere(name, "seconds"))
        assert time == time_text(np.median(seconds))
        assert upper == time_text(seconds[-10])  # of 32 values the 10th from either end: 97.9 %


@pytest.mark.parametrize("measures", ["torques", "wrenches"])
def test_tables_of_errors(rows, report, measures):
    """Medians over the runs in percent, with their intervals; wrenches are measured in some scenarios."""
    order = [f"position_noise={noise:g},motion={motion}" for motion in ("Fourier", "paper") for noise in NOISES]
    found = tables(report, f"errors-{measures}")
    for table, error in zip(found, ERROR_NAMES, strict=True):
        assert set(cells(table)) == {name for name in METHODS if METHODS[name][0] == measures}
        for name, said in cells(table).items():
            for scenario, text in zip(order, said, strict=True):
                if (scenario, name) not in rows.of:
                    assert text == "–"
                    continue
                wanted = 100 * np.array(middle(rows.errors(scenario, name, error)))
                assert read(text) == pytest.approx(wanted, rel=TWO_DIGITS), (error, name, scenario)


def test_tables_of_scenarios(rows, report):
    for number, scenario in enumerate(rows.scenarios):
        results, *parameters = tables(report, f"scenario-{number + 1}")
        for name, said in cells(results).items():
            own = scenario, name
            for error, text in zip(ERROR_NAMES, said[1:4], strict=True):
                assert read(text) == pytest.approx(100 * np.array(middle(rows.errors(*own, error))), rel=TWO_DIGITS)
            off, sigma = rows.base(*own)
            if len(off) > 1:
                biased = (stats.ttest_1samp(off, 0).pvalue < 0.05).sum()
                assert said[4] == f"{biased} of {len(TRUTH)}"
                honest = np.median(np.sqrt(np.mean((off / sigma) ** 2, axis=0)))
                assert float(said[5]) == pytest.approx(honest, abs=0.0051)
            real, answered = rows.column(*own, "consistent"), np.isfinite(rows.errors(*own, "torque_error"))
            for text, count, trials in (
                (said[6], np.nansum(real[answered]), answered.sum()), (said[7], (~answered).sum(), RUNS),
            ):  # fmt: skip
                wanted = wilson(count, trials)
                assert read(text) == pytest.approx([100 * x for x in wanted if x is not None], rel=TWO_DIGITS, abs=1e-9)
            assert said[-1] == time_text(np.median(rows.column(*own, "seconds")))
        for table, what in zip(parameters, ("bias", "spread"), strict=False):
            methods = [column.title for column in table.columns[3:]]
            for k, row in enumerate(table.rows):
                assert row.cells[2] == TRUTH[k]
                for method, cell in zip(methods, row.cells[3:], strict=True):
                    off, _ = rows.base(scenario, method)
                    value = off[:, k].mean() if what == "bias" else off[:, k].std(ddof=1)
                    assert cell.value == pytest.approx(value)
                    assert read(cell.more)[0] == pytest.approx(value, rel=THREE_DIGITS)


def test_tables_of_runs(rows, report):
    for number, scenario in enumerate(rows.scenarios):
        runs = [one for one in blocks(report, f"scenario-{number + 1}") if getattr(one, "key", "").startswith("run-")]
        assert len(runs) == RUNS
        ranks = dict(zip(TORQUE_METHODS, rows.ranks("torque_error", scenario).T, strict=True)) | {
            "graph": np.ones(RUNS)
        }
        for run, group in enumerate(runs):
            for name, said in cells(group.blocks[0]).items():
                row = rows.of[scenario, name][run]
                errors = [None if row[error] is None else 100 * row[error] for error in ERROR_NAMES]
                for text, error in zip(said[1:4], errors, strict=True):
                    assert text == "–" if error is None else float(text) == pytest.approx(error, rel=THREE_DIGITS)
                assert float(said[4]) == ranks[name][run]
                assert said[5] == {None: "–", True: "yes", False: "no"}[row["consistent"]]
                assert said[6] == ("–" if row["iterations"] is None else str(row["iterations"]))
                assert said[7:] == [time_text(row["seconds"]), row["reason"] or ""]


def test_whole(report, record, study_page):
    approve_record("study", record, without=("versions",))
    approve_report("study", report, told=study_page)
