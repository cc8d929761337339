"""The report of a study: page, terminal and record say the same, and every point leads to its run."""

import json
from dataclasses import replace
from itertools import product

import numpy as np
import pyarrow
import pytest
import scipy.stats
from identified.study_tables import METHODS, NOISES, TRUTH, study_tables
from jsonschema import Draft202012Validator
from lxml import html
from pyarrow.parquet import write_table
from shared_data import REPOSITORY
from shown import pages
from shown.approved import approve_result
from shown.browser import CHROMIUM, document

from crosscheck.commands.study import errors_report, scenarios_report
from crosscheck.commands.study.comparison_report import headline, verdict_text
from crosscheck.commands.study.ranking_report import Trade, bar_columns, efficient, trades
from crosscheck.commands.study.report import study_report
from crosscheck.commands.study.scenarios_report import ShownRuns
from crosscheck.report.records.record import plain
from crosscheck.report.report import Picture
from crosscheck.report.text import as_text
from crosscheck.study.settings.design import StudyDesign
from crosscheck.study.statistics.grid import grid_of
from crosscheck.study.statistics.outcomes import ERRORS, outcomes, read_outcomes
from crosscheck.study.statistics.summary import summarized

SCHEMA = REPOSITORY / "docs/schemas/study-1.schema.json"
RUNS = 8


def repeat(scenario, run):
    return ["graphdyn", "study", "--only", f"{scenario}:{run}"]


@pytest.fixture(scope="module")
def folder(study_folder):
    return study_folder


@pytest.fixture(scope="module")
def summary(folder):
    return summarized(read_outcomes(folder))


@pytest.fixture(scope="module")
def report(studied):
    return studied


@pytest.fixture(scope="module")
def written(study_page):
    return study_page


@pytest.fixture(scope="module")
def shown(written):
    return html.fromstring(written)


def test_whole(summary):
    approve_result("study", summary)


def test_record(report, summary):
    """It follows the schema, and has the numbers of the statistics."""
    record = plain(report.record(["study"]))
    Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8"))).validate(record)
    found = summary
    ranking, comparison = (of["torques", "torque_error"] for of in (found.rankings, found.comparisons))
    said, compared = (
        next(one for one in record[name] if one["error"] == "torque_error") for name in ("rankings", "comparisons")
    )
    assert [one["method"] for one in said["methods"]] == list(ranking.methods)
    assert [(one["method"], one["verdict"]) for one in compared["pairs"]] == [
        (pair.method, pair.verdict) for pair in comparison.pairs
    ]
    assert compared["same"] == [["wls", "wls-pinocchio"]]
    assert record["headline"] == headline(found).reason
    for scenario, told in zip(record["scenarios"], found.scenarios, strict=True):
        by_name = {one["method"]: one for one in scenario["results"]}
        assert ("graph" in by_name) == (scenario["axes"]["motion"] == "Fourier"), (
            "takes part where wrenches are measured"
        )
        for one in told.methods:
            if one.runs:
                assert by_name[one.method.name]["bias"] == pytest.approx(one.parameters.bias.value.tolist())


def test_terminal(report, summary):
    """Who is best, with what right; the median torque errors; why methods failed."""
    text = as_text(report, 200)
    assert headline(summary).reason in " ".join(text.split())
    assert "no convergence after 50 iterations" in text
    middle = np.median([row["torque_error"] for row in study_tables(RUNS)[0][:: len(METHODS)][:RUNS]])
    assert f"{100 * middle:.2g} (" in text


def test_numbers_of_the_tables(written, folder):
    """From the rows of the files: medians, shares, mean errors and standard deviations of the runs, and ranks."""
    rows, found = study_tables(RUNS)[0], read_outcomes(folder)
    scenarios = [found.scenarios[k].name for k in grid_of(found.scenarios).order()]
    tables = (pages.all_tables(written, words) for words in ("medians and shares", "mean of found", "over the runs"))
    for scenario, results, bias, spread in zip(scenarios, *tables, strict=True):
        for name, _, parameter, torque, *_, real, failed, iterations, _ in results:
            own = [row for row in rows if (row["scenario"], row["method"]) == (scenario, name)]
            for told, key in ((parameter, "parameter_error"), (torque, "torque_error")):
                errors = np.sort([np.inf if row[key] is None else 100 * row[key] for row in own])
                assert told == interval(np.median(errors), errors[0], errors[-1])
            answered = [row for row in own if row["status"] == "found"]
            for told, count, trials in (
                (real, sum(row["consistent"] for row in answered), len(answered)),
                (failed, len(own) - len(answered), len(own)),
            ):
                wilson = scipy.stats.binomtest(count, trials).proportion_ci(0.95, "wilson")
                assert told == interval(100 * count / trials, 100 * wilson.low, 100 * wilson.high)
            counts = [row["iterations"] for row in answered if row["iterations"] is not None]
            assert iterations == (f"{np.median(counts):.3g}" if counts else "–")
        base = {
            name: [row["base"] for row in rows if (row["scenario"], row["method"]) == (scenario, name) and row["base"]]
            for name, *_ in results
        }
        several = [np.array(values) - TRUTH for values in base.values() if len(values) > 1]
        for table, expected in (
            (bias, [values.mean(axis=0) for values in several]),
            (spread, [values.std(axis=0, ddof=1) for values in several]),
        ):
            told = np.array([[float(cell) for cell in cells] for _, _, _, *cells in table])
            np.testing.assert_allclose(told, np.transpose(expected), rtol=0.06, atol=1e-12)


def test_ranks_in_numbers(written):
    """Of the mean torque errors of every run, failures last, on average."""
    rows = [row for row in study_tables(RUNS)[0] if row["measures"] == "torques"]
    methods = [name for name in METHODS if METHODS[name][0] == "torques"]
    errors = {(row["scenario"], row["run"], row["method"]): row["torque_error"] or np.inf for row in rows}
    scenarios = list(dict.fromkeys(row["scenario"] for row in rows))
    table = [[[errors[one, run, name] for name in methods] for one in scenarios] for run in range(RUNS)]
    of_runs = np.exp(np.log(table).mean(axis=1))
    means = scipy.stats.rankdata(np.where(np.isinf(of_runs), np.inf, np.round(of_runs, 9)), axis=1).mean(axis=0)
    shown = html.fromstring(written).xpath("//tr[td[contains(., '(')]]")
    cells = [[" ".join(cell.text_content().split()) for cell in row] for row in shown]
    for name, mean in zip(methods, means, strict=True):
        assert any(row[0] == name and any(cell.startswith(f"{mean:.2f} (") for cell in row) for row in cells), name


def test_pictures_of_errors_have_the_numbers_of_the_rows(summary):
    """Every run in percent, the median and the ends of its interval over all runs, and the anchor of each run."""
    rows, found = study_tables(RUNS)[0], summary
    grid, page = grid_of(found.outcomes.scenarios), ShownRuns(RUNS - 1)
    lines = 0
    for measures, error in product(("torques", "wrenches"), ERRORS):
        columns = found.methods(measures)
        names = [found.outcomes.methods[k].name for k in columns]
        for view in grid.views():
            for k, (name, numbers) in enumerate(view.lines):
                line = errors_report._line(found, view, k, columns, error, page)
                places = []
                for place, number in enumerate(numbers):
                    if number is None:
                        continue
                    scenario = found.outcomes.scenarios[number].name
                    of_scenario = [row for row in rows if row["scenario"] == scenario]
                    if not set(names) <= {row["method"] for row in of_scenario}:
                        continue
                    table = np.array(
                        [
                            [
                                np.inf if row[error] is None else 100 * row[error]
                                for row in of_scenario
                                if row["method"] == m
                            ]
                            for m in names
                        ]
                    )
                    at = len(places)
                    places.append(place)
                    np.testing.assert_allclose(line.errors[at], table[:, : RUNS - 1].T)
                    np.testing.assert_allclose(line.middle[at], np.median(table, axis=1))
                    np.testing.assert_allclose(line.low[at], table.min(axis=1))
                    np.testing.assert_allclose(line.high[at], table.max(axis=1))
                    assert line.links[at] == [f"#run-{number + 1}-{run}" for run in range(RUNS - 1)]
                assert (line.name, line.places, line.joined) == (name, places, view.numeric)
                lines += len(places)
    assert lines == 18


def test_tables_of_runs_have_the_numbers_of_the_rows(summary):
    """Each method of each run: errors in percent, rank by torque error within its class, time, reason; σ as stated."""
    rows, _, times = study_tables(RUNS)
    found = summary
    seconds = {(row["scenario"], row["run"], row["method"]): row["processor_seconds"] for row in times}
    for number, of_scenario in enumerate(found.scenarios):
        scenario = of_scenario.outcomes
        shown = scenarios_report._runs(number, scenario, found, ShownRuns(3), repeat)
        assert shown.blocks[-1].text == f"results.parquet has {RUNS - 3} more."
        for run, group in enumerate(shown.blocks[:-1]):
            of_run = {row["method"]: row for row in rows if (row["scenario"], row["run"]) == (scenario.name, run)}
            table, command = group.blocks
            failed = sum(row["status"] == "failed" for row in of_run.values())
            assert (group.title, group.key) == (
                f"run {run}{f': {failed} failed' if failed else ''}",
                f"run-{number + 1}-{run}",
            )
            assert f"{scenario.name}:{run}" in command.text
            ranks = {}
            for measures in ("torques", "wrenches"):
                names = [name for name, row in of_run.items() if row["measures"] == measures]
                errors = [of_run[name]["torque_error"] or np.inf for name in names]
                ranks |= dict(zip(names, scipy.stats.rankdata(np.round(errors, 9)), strict=True)) if names else {}
            assert {row.cells[0] for row in table.rows} == set(of_run)
            for row in table.rows:
                name, measures, *errors, rank, real, iterations, time, reason = row.cells
                own = of_run[name]
                assert errors == pytest.approx([own[e] and 100 * own[e] for e in ERRORS])
                assert (measures, rank) == (own["measures"], ranks[name])
                assert real == {True: "yes", False: "no", None: None}[own["consistent"]]
                assert (iterations == own["iterations"]) or (own["iterations"] is None and np.isnan(iterations))
                assert time == seconds[scenario.name, run, name]
                assert (reason, row.state) == (
                    own["reason"] or "",
                    "plain" if own["status"] == "found" else "disagrees",
                )
        results = scenarios_report._results(scenario, [one for one in of_scenario.methods if one.runs])
        for row in results.rows:
            own = [r for r in rows if (r["scenario"], r["method"]) == (scenario.name, row.cells[0]) and r["base"]]
            if len(own) > 1:
                z = [(np.array(r["base"]) - TRUTH) / r["sigma"] for r in own]
                assert row.cells[6] == pytest.approx(np.median(np.sqrt(np.mean(np.square(z), axis=0))))


def test_pictures_of_parameters_are_parts_of_the_usual_spread(summary):
    """The median over the methods of the standard deviations over the runs."""
    rows, found = study_tables(RUNS)[0], summary
    for scenario in found.scenarios:
        of = {
            one.method.name: np.std(
                [
                    row["base"]
                    for row in rows
                    if (row["scenario"], row["method"]) == (scenario.outcomes.name, one.method.name) and row["base"]
                ],
                axis=0,
                ddof=1,
            )
            for one in scenario.methods
            if one.found > 1
        }
        drawn = [
            block.draw.keywords
            for block in scenarios_report._parameters(scenario.outcomes, scenario.methods)
            if isinstance(block, Picture)
        ]
        assert sorted(one.method.name for picture in drawn for one in picture["methods"]) == sorted(of)
        for picture in drawn:
            np.testing.assert_allclose(picture["scale"], np.median(list(of.values()), axis=0))
            assert len({one.method.measures for one in picture["methods"]}) == 1


def test_trades_have_the_times_and_failures_of_the_rows(summary):
    """Median of all processor times; hollow where a record has no answer; the reference has the ratio one."""
    rows, _, times = study_tables(RUNS)
    pictures = [block.draw.keywords for block in trades(summary, "torques") if isinstance(block, Picture)]
    assert len(pictures) == len(ERRORS)
    for picture in pictures:
        found = {trade.name: trade for trade in picture["trades"]}
        assert found[picture["best"]].ratio == 1
        assert set(found) == {name for name in METHODS if METHODS[name][0] == "torques"}
        for name, trade in found.items():
            assert trade.seconds == np.median([row["processor_seconds"] for row in times if row["method"] == name])
            assert trade.whole == all(row["status"] == "found" for row in rows if row["method"] == name)


def interval(value, low, high):
    """In percent, as a table has it."""
    texts = ["∞" if np.isinf(x) else f"{x:.0f}" if x > 99 else f"{x:.2g}" for x in (value, low, high)]
    return f"{texts[0]} ({texts[1]}–{texts[2]})"


def test_one_run(tmp_path):
    """No intervals, and that is said."""
    for name, rows in zip(("results", "scenarios", "times"), study_tables(1, motions=("Fourier",)), strict=True):
        write_table(pyarrow.Table.from_pylist(rows), tmp_path / f"{name}.parquet")
    report = study_report(read_outcomes(tmp_path), [], repeat)
    text = as_text(report, 200)
    assert "one run of a scenario says nothing of its scatter: there are no intervals" in text
    assert "1 run of each" in text
    record = plain(report.record(["study"]))
    Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8"))).validate(record)
    assert record["scenarios"][0]["results"][0]["torque_error"]["low"] is None


def test_every_point_leads_to_its_run(shown):
    """Each run of each scenario has a folded table with all methods and the command that repeats it."""
    runs = shown.xpath("//div[starts-with(@id, 'run-')]")
    assert len(runs) == RUNS * 2 * len(NOISES)
    ids = shown.xpath("//@id")
    assert len(ids) == len(set(ids))
    targets = {link.get("href") for link in shown.iter("a") if link.get("href", "").startswith("#run-")}
    assert targets == {f"#{run.get('id')}" for run in runs}
    assert all(link.get("target") is None for link in shown.iter("a"))
    said = {link.get("href"): link.findtext("title") for link in shown.xpath("//*[name()='svg']//*[name()='a']")}
    assert said["#run-1-2"] == "run 2, position noise 0.001 rad: all methods"
    scenario = study_tables(RUNS)[1][0]["scenario"]
    first = shown.get_element_by_id("run-1-0").text_content()
    assert f"graphdyn study --only {scenario}:0" in first
    assert all(name in first for name in METHODS)


def test_failures_say_why(shown):
    """A failed run is marked, with the reason, and the table of failures leads to it."""
    (table,) = shown.xpath("//section[@id='failures']//table")
    rows = [[cell.text_content().strip() for cell in row] for row in table.xpath(".//tbody/tr")]
    assert ["run 0", "position noise 0.01 rad", "didim 1, cloe 4", "no convergence after 50 iterations"] in rows
    link = table.xpath(".//a/@href")[0]
    marked = shown.get_element_by_id(link[1:]).xpath(".//tr[contains(@class, 'disagrees')]")
    assert "no convergence after 50 iterations" in marked[0].text_content()


def test_classes_are_apart(shown):
    """No ranking or picture has methods that measure different things."""
    for svg in shown.xpath("//section[@id!='study']//*[name()='svg']"):
        words = [text.text_content() for text in svg.xpath(".//*[name()='text']")]
        assert not any(word.startswith("graph") for word in words) or not any(word.startswith("iv") for word in words)


def test_largest_studies_keep_a_page(folder, monkeypatch):
    """The first runs of every scenario have their tables; links and dots of others are left out."""
    monkeypatch.setattr("crosscheck.commands.study.scenarios_report.MAX_RUNS", 8)
    report = study_report(read_outcomes(folder), [], repeat)
    groups = [group for section in report.sections for group in section.blocks if getattr(group, "title", "") == "Runs"]
    assert len(groups) == 2 * len(NOISES)
    for group in groups:
        *runs, left = group.blocks
        assert [run.title[:5] for run in runs] == ["run 0", "run 1"]
        assert left.text == f"results.parquet has {RUNS - 2} more."
    failures = next(section for section in report.sections if section.key == "failures").blocks[0]
    assert {row.link for row in failures.rows} <= {run.key for group in groups for run in group.blocks[:-1]} | {None}


def scenarios_at(*axes):
    """Scenarios of a study of one method that never fails."""
    named = {"base_names": ["M_1"], "base_units": ["kg"], "truth": [1.0]}
    rows = [{"scenario": str(k), **one, **named} for k, one in enumerate(axes)]
    result = study_tables(1)[0][0]
    results = [result | {"scenario": row["scenario"], "base": [1.0], "sigma": [0.1]} for row in rows]
    return outcomes(results, rows, []).scenarios


def test_grid():
    """One view along the noise, one along each axis that shows further scenarios; what changes together is one axis."""
    usual = {"position_noise": 1e-3, "torque_noise": 0.1, "motion": "random", "duration": 5.0, "start": "wls"}
    grid = grid_of(
        scenarios_at(
            usual,
            usual | {"position_noise": 1.75e-4},
            usual | {"motion": "paper", "duration": 2.0},
            usual | {"motion": "steps"},
            usual | {"position_noise": 1e-2, "torque_noise": 0.2},
        )
    )
    noise, motion = grid.views()
    assert (noise.title, noise.places) == (
        "position noise [rad], and torque noise with it",
        ("1.75e-4", "0.001", "0.01"),
    )
    assert noise.lines == (("usual", (1, 0, 4)),)
    assert (motion.title, motion.places) == ("motion, and duration with it", ("random", "paper", "steps"))
    assert motion.lines == (("usual", (0, 2, 3)),)
    assert grid.words(grid.scenarios[2]) == "position noise 0.001 rad, motion paper, duration 2 s"
    assert grid.usual == "motion random, duration 5 s"
    assert grid.order() == [1, 0, 4, 2, 3]


def test_lines_of_a_grid():
    """All combinations of two axes are one view with a line for each value of the second."""
    rows = [{"position_noise": noise, "motion": motion} for motion in ("a", "b") for noise in (1.0, 2.0)]
    (view,) = grid_of(scenarios_at(*rows)).views()
    assert view.lines == (("usual", (0, 1)), ("motion b", (2, 3)))


def test_one_scenario():
    grid = grid_of(scenarios_at({"motion": "random"}))
    assert grid.views() == []
    assert grid.words(grid.scenarios[0]) == "the only scenario"


def test_headlines(summary):
    """Who is best and by how much; what is not drawn anew; that nothing is decided."""
    pair = summary.comparisons["torques", "torque_error"].of("better")[0]
    said, numbers = headline(summary), [f"{x:.3g}" for x in (pair.ratio.value, pair.ratio.low, pair.ratio.high)]
    assert said.reason.startswith(
        f"{pair.method} is better than wls: its torque error is {numbers[0]} ({numbers[1]}–{numbers[2]}) times as "
        f"large, 95% sure over 4 comparisons in {RUNS} runs."
    )
    assert said.reason.endswith("The motion of the paper is the same in all runs.")
    held = headline(replace(summary, design=StudyDesign(vary=("noise", "start"))))
    assert held.sentence.endswith("All runs share one motion and CAD model: this holds for it alone.")
    comparison = summary.comparisons["torques", "torque_error"]
    several = replace(comparison, pairs=tuple(replace(one, verdict="better") for one in comparison.pairs))
    many = headline(replace(summary, comparisons={("torques", "torque_error"): several}))
    first, *_, last = sorted(comparison.pairs, key=lambda one: one.ratio.value)
    assert many.reason.startswith(
        f"{first.method} is best of the 4 methods that are better than wls: its torque error is"
    )
    assert f"and {last.method} with {last.ratio.value:.3g} (" in many.reason
    few = summarized(outcomes(*study_tables(7)))
    assert headline(few).sentence == (
        "Nothing is decided: 4 comparisons need 8 runs or more, and there are 7. "
        "The motion of the paper is the same in all runs."
    )
    alike = summarized(outcomes(*study_tables(RUNS)), StudyDesign(reference="didim"))
    assert headline(alike).reason.startswith(
        "No method is shown to be better than didim by torque error, 95% sure over"
    )


def test_what_is_said_of_a_pair(summary):
    comparison = summary.comparisons["torques", "torque_error"]
    pair = replace(comparison.with_reference["iv"], verdict="undecided", detectable=1.1342, more_runs=417)
    for change, said in (
        ({}, "undecided: this study can show a ratio of 1.13; about 420 more runs for 1.05"),
        ({"more_runs": None}, "undecided: this study can show a ratio of 1.13"),
        ({"detectable": None}, "undecided"),
        ({"failed": 1, "other_failed": 2}, "undecided: it alone failed in 1 run and wls alone failed in 2 runs"),
        ({"verdict": "equivalent"}, "equivalent within 5 %"),
        ({"verdict": "worse"}, "worse"),
    ):
        assert verdict_text(replace(pair, **change), comparison, 0.05) == said
    assert verdict_text(pair, replace(comparison, runs=7), 0.05) == "undecided: below 8 runs nothing is"


def test_efficient():
    """Neither slower nor less accurate than another."""
    trades = [Trade(name, *both, 0, 0, True) for name, both in
              {"a": (1, 5), "b": (2, 2), "c": (3, 2), "d": (2, 3), "e": (9, 1)}.items()]  # fmt: skip
    assert [trade.name for trade in efficient(trades)] == ["a", "b", "e"]


def test_bars_of_groups():
    """Groups that overlap stand beside each other, those that share one method too."""
    assert bar_columns([(0, 2), (1, 3), (3, 5), (4, 6)]) == [0, 1, 0, 1]
    assert bar_columns([(0, 2), (2, 4), (3, 5), (5, 6)]) == [0, 1, 0, 1]


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_in_a_browser(written, tmp_path):
    """A link to a run opens it."""
    path = tmp_path / "study.html"
    path.write_text(written, encoding="utf-8")
    tree = html.fromstring(document(f"{path.as_uri()}#run-2-1", tmp_path / "profile"))
    assert tree.get_element_by_id("run-2-1").find("details").get("open") is not None
    assert tree.get_element_by_id("run-2-2").find("details").get("open") is None
