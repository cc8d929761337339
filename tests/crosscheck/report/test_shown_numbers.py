"""Numbers as a reader sees them, in tables and pictures, beside numbers written here: units, signs, factors."""

import dataclasses
import re
from types import SimpleNamespace

import numpy as np
import pytest
from identified import identified_arm
from matplotlib.collections import PathCollection
from planting import compared

from crosscheck.bench.contender import SpeedRatio
from crosscheck.bench.machine.timing import Ratio
from crosscheck.commands.bench import report as ratio_bars
from crosscheck.commands.crosscheck.report import crosscheck_report
from crosscheck.commands.excite import report as excite_report
from crosscheck.commands.identify.record import record as identify_record
from crosscheck.commands.identify.reports import methods_report as method_errors
from crosscheck.commands.identify.reports import model_report as parameter_bars
from crosscheck.commands.identify.reports.report import identify_report
from crosscheck.commands.judge.function_report import function_section
from crosscheck.commands.study import errors_report, ranking_report, scenarios_report
from crosscheck.commands.study.errors_report import ErrorLine
from crosscheck.commands.study.ranking_report import Trade
from crosscheck.identifying.results.parameters import BaseRow, base_rows
from crosscheck.judging.judge import judge
from crosscheck.report.error_tables import error_text, span_text
from crosscheck.report.pictures import plot, spread
from crosscheck.report.pictures.svg import CURVES
from crosscheck.report.plain_text import ratio_span_text, ratio_text, threads_text, time_text, vector_text
from crosscheck.report.plain_text import span_text as span_of_times
from crosscheck.report.records.record import plain
from crosscheck.report.report import Panel, Plot, Series, Table
from crosscheck.report.text import as_text
from crosscheck.study.statistics.intervals import Intervals
from graphdyn import inverse_dynamics

RMS = (1.25, 3.5, 0.75)
RELATIVE = (0.02, 0.05, 0.11)
"""Of the joints: 6 % in the mean."""

ALIKE = 0.1
"""Difference of a torque that was low-passed, or predicted by a model that fits, from the recorded one, relative."""


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(61.5, "61.5 s"), (1.0, "1 s"), (0.9996, "1 s"), (0.9994, "999 ms"), (1e-3, "1 ms"), (2.5e-6, "2.5 µs"),
     (1e-6, "1 µs"),
     (17.24e-9, "17.2 ns"), (1e-9, "1 ns"), (2e-10, "0.2 ns")],
)  # fmt: skip
def test_times(seconds, text):
    assert time_text(seconds) == text


@pytest.mark.parametrize(
    ("spread", "text"),
    [((0.5, 2.0), "0.5 … 2 s"), ((0.25, 1.0), "0.25 … 1 s"), ((2e-4, 3.25e-3), "0.2 … 3.25 ms"),
     ((1e-7, 2e-6), "0.1 … 2 µs"), ((1e-10, 4e-9), "0.1 … 4 ns"), ((1e-10, 3e-10), "0.1 … 0.3 ns")],
)  # fmt: skip
def test_spans_are_in_the_unit_of_the_larger_time(spread, text):
    assert span_of_times(spread) == text


@pytest.mark.parametrize(
    ("ratio", "text"), [(0.5, "0.5×"), (47.26, "47.3×"), (999.4, "999×"), (999.6, "1000×"), (1000.4, "1000×")]
)
def test_ratios(ratio, text):
    assert ratio_text(ratio) == text
    assert ratio_span_text((2.5, ratio)) == f"2.5 … {text}"
    assert ratio_text(1234.5) == "1234×"


def test_threads():
    assert [threads_text(count) for count in (1, 2, 8)] == ["1 thread", "2 threads", "8 threads"]


@pytest.fixture(scope="module")
def found():
    """An identification in which the errors of every method are RMS and RELATIVE, on all rows and moving ones."""
    original = identified_arm.identified(("wls",))
    results = []
    for result in original.comparison.results:
        sizes = dataclasses.replace(
            result.held_out.everything, rms=np.array(RMS), relative=np.array(RELATIVE), count=np.full(3, 1000.0)
        )
        errors = dataclasses.replace(result.held_out, everything=sizes, moving=sizes)
        results.append(
            dataclasses.replace(
                result,
                held_out=errors,
                training=errors,
                seconds=0.25,
                base_values=np.full_like(result.base_values, -2.0),
                standard_deviations=np.full_like(result.base_values, 0.05),
                block_deviations=np.full_like(result.base_values, 0.07),
            )
        )
    return dataclasses.replace(
        original,
        comparison=dataclasses.replace(original.comparison, results=tuple(results)),
        truth=None,
        others=(),
    )


def cells(text, first):
    """Cells of the first row of a table on the terminal that begins with these words."""
    row = next(line for line in text.splitlines() if re.match(rf"│ {first} +│", line))
    return [cell.strip() for cell in row.split("│")[1:-1]]


class TestIdentifyText:
    def test_held_out_error_in_percent(self, found):
        text = as_text(identify_report(found, found.shown()), 200)
        assert "held-out error [%]" in text
        assert cells(text, "WLS")[2] == "6.00"
        assert cells(text, "WLS")[-1] == "0.25"

    def test_errors_of_joints(self, found):
        text = as_text(identify_report(found, found.shown()), 200)
        held_out = text[text.index("Errors, held out") :]
        assert cells(held_out, "WLS")[1:] == ["1.25 / 2.0", "3.5 / 5.0", "0.75 / 11.0"]
        assert "RMS of all rows [N m or N] / % of moving rows" in held_out

    def test_errors_of_every_trial(self, found):
        """Two recordings, of errors 1 and 3 times as large: as trials one by one, kept aside each in its own table."""
        (trial, *_), predicted = found.trials, []
        for name, factor in (("one.csv", 1.0), ("two.csv", 3.0)):
            sizes = found.shown().held_out.everything
            sizes = dataclasses.replace(sizes, rms=factor * sizes.rms, relative=factor * sizes.relative)
            statistics = dataclasses.replace(found.shown().held_out, everything=sizes, moving=sizes)
            predicted.append(dataclasses.replace(trial, name=name, statistics={"WLS": statistics}))
        more = dataclasses.replace(found, aside=tuple(predicted), trials=tuple(predicted))
        text = as_text(identify_report(more, more.shown()), 200)
        first, second = (text[text.index(f"Errors, kept aside: {name}.csv") :] for name in ("one", "two"))
        assert cells(first, "WLS")[1:] == ["1.25 / 2.0", "3.5 / 5.0", "0.75 / 11.0"]
        assert cells(second, "WLS")[1:] == ["3.75 / 6.0", "10.5 / 15.0", "2.25 / 33.0"]
        together = text[text.index("Errors, held out, one by one") :]
        assert re.search(r"WLS +6\.0 +18\.0", together)
        (row,) = plain(identify_record(more, more.shown(), []))["comparison"]
        for which in ("trials", "aside"):
            assert [(one["name"], one["mean_error"]) for one in row[which]] == [
                ("one.csv", pytest.approx(0.06)), ("two.csv", pytest.approx(0.18))
            ]  # fmt: skip

    def test_standard_deviations(self, found):
        (row, *_) = base_rows(found, found.shown())
        assert (row.value, row.deviation, row.block_deviation) == (-2.0, 0.05, 0.07)
        text = as_text(identify_report(found, found.shown()), 200)
        shown = cells(text[text.index("Base parameters") :], re.escape(row.name))
        assert shown[2:4] == ["-2", "0.05"]


class TestTorques:
    def test_what_is_plotted_was_recorded(self):
        """Not minus that, nor in other units: the plots show the torques of the recording, low-passed."""
        arm, found = identified_arm.virtual(), identified_arm.identified(("wls",))
        (torques,) = (one for one in identify_report(found, found.shown()).sections if one.key == "torques")
        plots = [block for block in torques.blocks if isinstance(block, Plot)]
        for j in range(3):
            for block, recording in zip(plots[2 * j : 2 * j + 2], (arm.fitted, arm.held_out), strict=True):
                measured, predicted = block.panels[0].series
                recorded = np.interp(block.x, recording.t, recording.tau[:, j])
                for series in (measured, predicted):
                    there = np.isfinite(series.y)
                    difference = series.y[there] - recorded[there]
                    assert np.linalg.norm(difference) < ALIKE * np.linalg.norm(recorded[there])
                assert block.panels[0].unit == ("N" if found.torque_model.model.joints[j].is_prismatic else "N m")


def test_texts_of_numbers():
    assert (error_text(2.5e-9), error_text(np.inf)) == ("2.5e-09", "∞")
    assert (span_text((1.5, 1.5)), span_text((2.0, np.inf))) == ("1.5", "2 … ∞")
    assert vector_text([0.25, -1234.56, 1e-15]) == "0.25 -1235 0"


def test_errors_as_part_of_their_bounds(tree):
    """The curves of a cross-check: one is the bound, above it is a disagreement."""
    comparison = compared(tree)
    (section,) = (one for one in crosscheck_report([comparison]).sections if one.verdict)
    (curves,) = (block for block in section.blocks if isinstance(block, Plot))
    (panel,) = curves.panels
    assert (panel.title, panel.level) == ("error as part of its bound", 1.0)
    for series in panel.series:
        result = comparison.quantities[series.name]
        assert np.nanmax(series.y) == pytest.approx(result.max_relative_error / result.quantity.tolerance.bound)


def test_errors_of_a_judged_function(tree):
    judgment = judge(tree, inverse_dynamics=lambda q, v, a: inverse_dynamics(tree, q, v, a).tau, samples=1)
    (function,) = judgment.functions.values()
    function = dataclasses.replace(
        function,
        errors={"graphdyn": np.array([3e-12, 1e-12, 4e-3, 2e-12])},
        worst=dataclasses.replace(function.worst, expected=(1.0, -2.0, 3.0), answer=(1.0, 2.0, 2.5)),
    )
    tables = [block for block in function_section(judgment, function).blocks if isinstance(block, Table)]
    against, worst = tables[0], tables[-1]
    assert [column.title for column in against.columns[2:]] == ["median", "largest", "bound"]
    assert against.rows[0].cells[2:] == (2e-12, 4e-3, 1e-9)
    shown = [[column.text(value) for column, value in zip(worst.columns, row.cells, strict=True)] for row in worst.rows]
    assert [list(map(float, cells[1:])) for cells in shown] == [[1.0, 1.0, 0.0], [-2.0, 2.0, 4.0], [3.0, 2.5, -0.5]]


@pytest.fixture
def drawn(monkeypatch):
    """drawn(module, "function", …): the axes on which a function of crosscheck.report.pictures draws."""

    def axes_of(module, function, *arguments):
        from matplotlib.figure import Figure

        kept = []

        def picture(_key, _label, size, draw, _hovers=None):
            kept.append(Figure(figsize=size).add_axes((0, 0, 1, 1)))
            draw(kept[0])
            return ""

        monkeypatch.setattr(module, "picture", picture)
        getattr(module, function)("key", *arguments)
        return kept[0]

    return axes_of


OTHER_SIGMA = {"best_random": [0.8, 0.6], "median_random": [1.0, 0.9], "recorded": [1.2, 1.0]}


def curve(axes, label):
    (line,) = (line for line in axes.lines if line.get_label() == label)
    return line.get_xdata(), line.get_ydata()


def upright_or_level(axes):
    """Ends of every line that was drawn as one of several: error bars."""
    from matplotlib.collections import LineCollection

    return [segment for part in axes.collections if isinstance(part, LineCollection) for segment in part.get_segments()]


class TestPictures:
    def test_parameter_bars(self, drawn):
        """Value 3 ± 0.25, CAD 2, truth 2.5 of a parameter that makes 2 N m at 1: a bar of 2 σ to either side."""
        nothing = {field.name: np.nan for field in dataclasses.fields(BaseRow)}
        numbers = {"value": 3.0, "cad": 2.0, "truth": 2.5, "deviation": 9.0, "block_deviation": 0.25}
        row = BaseRow(**{**nothing, "name": "m", "symbol": "M_1", "unit": "kg", **numbers})
        axes = drawn(parameter_bars, "parameter_bars", [row], np.array([2.0]))
        assert curve(axes, "CAD")[0].tolist() == [4.0]
        assert curve(axes, "truth")[0].tolist() == [5.0]
        (bars,) = axes.containers
        assert bars.get_label() == "identified ± 2 σ"
        assert bars.lines[0].get_xdata().tolist() == [6.0]
        ((left, right),) = bars.lines[2][0].get_segments()
        assert (left[0], right[0]) == (5.0, 7.0)
        assert "[N m]" in axes.get_xlabel()

    def test_sigma_bars(self, drawn):
        """σ 0.5 of 2 is 25 %, of 0.1 beside a spread of 1 is 50 %; σ of others as parts of the same."""
        others = {name: SimpleNamespace(sigma=np.array(sigma)) for name, sigma in OTHER_SIGMA.items()}
        own = {"sigma": np.array([0.5, 0.5]), "relative": np.array([0.25, 0.5]), "names": ("a", "b")}
        plan = SimpleNamespace(**own, prior=np.array([-2.0, 0.1]), spread=np.array([1.0, 1.0]))
        axes = drawn(excite_report, "sigma_bars", SimpleNamespace(plan=plan, random=7, **others))
        left = axes.get_xlim()[0]
        assert [left + bar.get_width() for bar in axes.patches[:2]] == pytest.approx([25, 50])
        assert curve(axes, "best of 7 random")[0] == pytest.approx([40, 60])
        assert curve(axes, "median random")[0] == pytest.approx([50, 90])
        assert curve(axes, "recorded")[0] == pytest.approx([60, 100])

    def test_method_errors(self, drawn):
        axes = drawn(method_errors, "method_errors", ["WLS"], ["a", "b"], np.array([[0.02, 0.06]]))
        assert [curve(axes, name)[0].tolist() for name in ("a", "b", "mean")] == [[2.0], [6.0], [4.0]]
        assert "[%]" in axes.get_xlabel()

    def test_study_ranks(self, drawn):
        """A dot at the mean rank, a bar over its interval, of each method in its row; the leader in blue."""
        rank = Intervals(np.array([1.2, 2.5, 2.75]), np.array([1.0, 2.25, 2.5]), np.array([1.5, 2.75, 3.0]))
        told = {"alike": ((1, 2),), "leaders": ("a",), "differ": True, "distance": 0.75}
        told["apart"] = lambda first, other: first == 0 < other
        ranking = SimpleNamespace(methods=("a", "b", "c"), rank=rank, **told)
        axes = drawn(ranking_report, "study_ranks", ranking, "torque error")
        bars = [segment for segment in upright_or_level(axes) if np.ptp(segment[:, 0]) not in (0, 3)]
        assert [segment.tolist() for segment in bars] == [
            [[1.0, 0.5], [1.5, 0.5]], [[2.25, 1.5], [2.75, 1.5]], [[2.5, 2.5], [3.0, 2.5]]
        ]  # fmt: skip
        (dots,) = [part for part in axes.collections if isinstance(part, PathCollection)]
        assert dots.get_offsets().tolist() == [[1.2, 0.5], [2.5, 1.5], [2.75, 2.5]]
        blue, black, other = dots.get_facecolors().tolist()
        assert blue != black == other
        group, distance = axes.lines
        assert distance.get_xdata().tolist() == [1, 1.75]
        assert list(group.get_ydata()) == pytest.approx([1 - 1.2 / 3, 1 - 2.8 / 3])  # most of rows 2 and 3 of 3

    def test_study_pareto(self, drawn):
        """At time and ratio, the interval upright; hollow where it failed on some records; blue if efficient."""
        trades = [Trade("a", 0.5, 1.0, 0.9, 1.1, True), Trade("b", 2.0, 3.0, 2.5, 4.0, False)]
        axes = drawn(ranking_report, "study_pareto", trades, "torque error", "a")
        points = [line for line in axes.lines if line.get_marker() == "o"]
        places = [(*line.get_xdata(), *line.get_ydata(), line.get_markerfacecolor() == "none") for line in points]
        assert places == [(0.5, 1.0, False), (2.0, 3.0, True)]
        uprights = [segment.tolist() for segment in upright_or_level(axes)]
        assert uprights == [[[0.5, 0.9], [0.5, 1.1]], [[2.0, 2.5], [2.0, 4.0]]]
        (low, high), (lowest, highest) = axes.get_xlim(), axes.get_ylim()
        assert low < 0.5 < 2 < high
        assert lowest < 0.9 < 4 < highest
        trades = [Trade(name, x, y, y, y, True) for name, x, y in
                  (("fast", 0.1, 5.0), ("slow", 2.0, 1.0), ("worse", 3.0, 1.5), ("middle", 1.0, 2.0))]  # fmt: skip
        axes = drawn(ranking_report, "study_pareto", trades, "torque error", "slow")
        colors = {line.get_xdata()[0]: line.get_color() for line in axes.lines if line.get_marker() == "o"}
        edges = {line.get_xdata()[0]: line.get_markeredgecolor() for line in axes.lines if line.get_marker() == "o"}
        blue = {x for x in colors if edges[x] == CURVES[0]}
        assert blue == {0.1, 1.0, 2.0}
        (front,) = (line for line in axes.lines if line.get_marker() != "o")
        assert list(zip(*front.get_data(), strict=True)) == [(0.1, 5.0), (1.0, 2.0), (2.0, 1.0)]

    def test_study_parameters(self, drawn):
        """As parts of the usual spread: 0.5 and -3 of biases, ± 1 and ± 2 of spreads; the one without zero in red."""
        bias = Intervals(np.array([0.1, -6.0]), np.array([-0.1, -7.0]), np.array([0.3, -5.0]))
        spread_of = Intervals(np.array([0.2, 4.0]), *2 * [np.zeros(2)])
        found = SimpleNamespace(bias=bias, spread=spread_of, biased=1)
        method = SimpleNamespace(method=SimpleNamespace(name="wls"), parameters=found)
        (panel,) = drawn(scenarios_report, "study_parameters", [method], np.array([0.2, 2.0]), "parts").child_axes
        bars, inside, dot, outside, red = (line.get_xydata() for line in panel.lines[1:])
        kept = [line[~np.isnan(line[:, 1])].tolist() for line in (bars, inside, outside)]
        assert kept[0] == [[1, -1], [1, 1], [2, -2], [2, 2]]
        np.testing.assert_allclose(kept[1], [[1, -0.5], [1, 1.5]])
        np.testing.assert_allclose(kept[2], [[2, -3.5], [2, -2.5]])
        assert (dot.tolist(), red.tolist()) == ([[1, 0.5]], [[2, -3]])
        assert panel.lines[3].get_color() != panel.lines[5].get_color()

    def test_study_errors(self, drawn):
        """Two methods at two places: medians joined, intervals upright, a dot per run, a cross for a failure."""
        line = ErrorLine(
            "", [0, 1], [np.array([[1.0, 10.0], [2.0, 20.0]]), np.array([[3.0, np.inf], [4.0, 40.0]])],
            np.array([[1.5, 15.0], [3.5, np.inf]]), np.array([[1.0, 10.0], [3.0, 40.0]]),
            np.array([[2.0, 20.0], [4.0, np.inf]]), [["", ""], ["", ""]], True,
        )  # fmt: skip
        panels = drawn(errors_report, "study_errors", "label", ["a", "b"], ["x", "y"], "noise", [line], {}).child_axes
        for k, panel in enumerate(panels):
            best, own = panel.lines
            assert best.get_xydata().tolist() == [[0, 1.5], [1, 3.5]]
            known = [[0, 1.5], [1, 3.5]] if k == 0 else [[0, 15.0]]
            assert [point for point in own.get_xydata().tolist() if np.isfinite(point[1])] == known
            dots = np.concatenate(
                [part.get_offsets() for part in panel.collections if isinstance(part, PathCollection)]
            )
            heights = [1, 2, 3, 4] if k == 0 else [10, 20, 40, 60 * 1.3]  # the cross above 1.5 times the largest
            assert sorted(dots[:, 1].tolist()) == pytest.approx(heights)
            assert [segment[0].tolist() for segment in upright_or_level(panel)] == [
                [0, line.low[0, k]], [1, line.low[1, k]]
            ]  # fmt: skip

    def test_singular_values(self, drawn):
        axes = drawn(method_errors, "singular_values", np.array([2.0, 0.5]))
        assert [line.tolist() for line in axes.lines[0].get_data()] == [[1, 2], [2.0, 0.5]]

    def test_ratio_bars(self, drawn):
        """Three times as long, quartiles 2.5 and 4: the bar is as long as the number beside it says."""
        comparison = SpeedRatio("ours", "theirs", 1, "processor", Ratio(median=3.0, fastest=2.0, quartiles=(2.5, 4.0)))
        (inner,) = drawn(ratio_bars, "ratio_bars", [comparison]).child_axes
        assert [bar.get_width() for bar in inner.patches] == [3.0]
        assert inner.lines[0].get_xdata().tolist() == [2.5, 4.0]
        assert list(inner.lines[1].get_xdata()) == [1, 1]
        assert [text.get_text() for text in inner.texts] == ["3×"]
        assert inner.texts[0].xy == (4.0, 0)

    def test_spread(self, drawn):
        """Errors of 10⁻¹² and 10⁻⁸ with a bound of 10⁻¹⁰: one bin on either side of the bound."""
        row = spread.SpreadRow("torque", np.array([1e-12, 1e-12, 1e-8]), 1e-10)
        axes = drawn(spread, "spread", [row])
        _, bound, largest = axes.lines
        assert list(bound.get_xdata()) == [-10.0, -10.0]
        assert list(largest.get_xdata()) == [-8.0]
        extents = [bar.get_path().get_extents() for bar in axes.patches]
        assert [round(extent.x0, 6) for extent in extents] == [-12.0, -8.0]
        assert extents[1].height == pytest.approx(extents[0].height / 2)
        assert axes.patches[0].get_facecolor() != axes.patches[1].get_facecolor()
        assert [text.get_text() for text in axes.texts] == ["✗ torque"]
        axes = drawn(spread, "spread", [spread.SpreadRow("beside", np.array([9e-11, 1.1e-10]), 1e-10)])
        within, beyond = axes.patches  # bins on both sides of the bound
        assert [bar.get_path().get_extents().x0 for bar in (within, beyond)] == [-10.25, -10.0]
        assert within.get_facecolor() != beyond.get_facecolor()

    def test_spread_of_errors_without_a_logarithm(self, drawn):
        """Zero at its tick left of all decades, infinity right of them; a bound of zero just right of the zeros."""
        rows = [
            spread.SpreadRow("zero", np.array([0.0, 0.0, 1e-12]), 0.0),
            spread.SpreadRow("infinite", np.array([1e-12, np.inf, np.nan, 1e-9]), 1e-9),
            spread.SpreadRow("nothing", np.zeros(3), 0.0),
        ]
        axes = drawn(spread, "spread", rows)
        ticks = dict(zip([text.get_text() for text in axes.get_xticklabels()], axes.get_xticks(), strict=True))
        zero = ticks["0"]
        _, bounds, largest = axes.lines
        assert largest.get_xdata().tolist() == [-12.0, largest.get_xdata()[1], zero]
        decades = [place for text, place in ticks.items() if text != "0"]
        assert max(decades) < largest.get_xdata()[1] < axes.get_xlim()[1]
        assert axes.get_xlim()[0] < zero < min(decades)
        assert "∞" in [text.get_text() for text in axes.texts]
        places = bounds.get_xdata()[[0, 3, 6]]
        bars = [part.get_path().get_extents() for part in axes.patches]
        within = [bar for bar in bars if bar.x0 < zero < bar.x1]
        assert [(bar.x0 + bar.x1) / 2 for bar in within] == pytest.approx([zero, zero])
        assert places[1] == -9.0
        for place, bar in zip(places[[0, 2]], within, strict=True):
            assert bar.x1 < place < min(decades)

    @pytest.mark.parametrize("style", ["line", "dashed", "marks"])
    def test_plots(self, drawn, style):
        """Curves at their values, with their signs; bars between their ends; bound and instant where they are."""
        y, low, high = np.array([-1.0, 2.0]), np.array([-1.5, 1.0]), np.array([-0.5, 4.0])
        panel = Panel("torque", (Series("measured", y, style, low=low, high=high),), "N m", level=3.0)
        whole = Plot(np.array([0.0, 0.5]), "t [s]", (panel,), "label", upright=0.25)
        (axes,) = drawn(plot, "plot_picture", whole).child_axes
        assert [part.tolist() for part in curve(axes, "measured")] == [[0.0, 0.5], [-1.0, 2.0]]
        bars = [segment.tolist() for segment in upright_or_level(axes)]
        assert bars == [[[0.0, -1.5], [0.0, -0.5]], [[0.5, 1.0], [0.5, 4.0]]]
        assert list(axes.lines[0].get_ydata()) == [3.0, 3.0]
        assert list(axes.lines[1].get_xdata()) == [0.25, 0.25]
        assert axes.get_title(loc="left") == "torque [N m]"
        assert axes.get_xlabel() == "t [s]"
