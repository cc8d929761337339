"""The report of an identification: what stands in its tables, and the torques that its plots hold."""

import dataclasses

import numpy as np
import pytest
from identified import identified_arm

from crosscheck.commands.identify.report import identify_report
from crosscheck.identifying import Folds
from crosscheck.report.report import Plot, Table
from crosscheck.report.text import as_text

WHY = "the recording has torques about the joint axes alone"


@pytest.fixture(scope="module")
def found():
    """The last method failed."""
    all_answered = identified_arm.compared()
    *others, graph = all_answered.comparison.results
    unanswered = ("estimate", "base_values", "training", "held_out", "plausibility")
    failed = dataclasses.replace(graph, failure=WHY, **dict.fromkeys(unanswered))
    comparison = dataclasses.replace(all_answered.comparison, results=(*others, failed))
    return dataclasses.replace(all_answered, comparison=comparison)


@pytest.fixture(scope="module")
def report(found):
    return identify_report(found, found.shown())


def section(report, key):
    return next(part for part in report.sections if part.key == key)


def tables(report, key):
    return [block for block in section(report, key).blocks if isinstance(block, Table)]


class TestMethods:
    def test_one_row_per_method(self, found, report):
        (methods, held_out, fitted) = tables(report, "methods")
        names = [*(result.name for result in found.comparison.results), "CAD links: WLS"]
        assert [row.cells[0] for row in methods.rows] == names
        assert next(row.cells[0] for row in methods.ordered) == "graph method"  # failures first
        answered = [candidate.result for candidate in found.candidates if candidate.result.failure is None]
        for table, part in ((held_out, "held_out"), (fitted, "training")):
            assert len(table.rows) == len(answered)
            for row, result in zip(table.rows, answered, strict=True):
                np.testing.assert_array_equal([rms for rms, _ in row.cells[1:]], getattr(result, part).everything.rms)

    def test_verdicts(self, found, report):
        said = {row.cells[0]: getattr(row.cells[1], "words", "") for row in tables(report, "methods")[0].rows}
        assert said["graph method"] == "failed"
        assert said["OLS"] == "not physically consistent"
        assert [name for name, words in said.items() if words == "recommended"] == [found.recommendation.name]

    def test_no_answer(self, found):
        graph = found.comparison.of("graph method")
        comparison = dataclasses.replace(found.comparison, results=(graph,))
        nothing = dataclasses.replace(found, comparison=comparison, others=())
        report = identify_report(nothing, None)
        assert (report.verdict.words, report.verdict.reason) == ("no usable model", "No method has a result.")
        assert [part.key for part in report.sections] == ["recording", "data_quality", "methods", "excitation", "end"]
        assert f"graph method: failed: {WHY}" in as_text(report)


class TestParameters:
    def test_truth(self, found, report):
        virtual = dataclasses.replace(found, truth=identified_arm.virtual().truth)
        headings = [
            column.heading for column in tables(identify_report(virtual, found.shown()), "parameters")[0].columns
        ]
        assert headings[1:5] == ["CAD", "truth", "identified", "error"]
        assert "truth" not in [column.heading for column in tables(report, "parameters")[0].columns]

    @pytest.mark.parametrize("width", [80, 120])
    def test_fits_the_terminal(self, report, width):
        """No number is cut, and names of base parameters have room to be read."""
        text = as_text(report, width)
        assert max(map(len, text.splitlines())) <= width
        for row in tables(report, "parameters")[0].rows:
            assert f" {row.cells[1]:.4g} " in text
        assert "determined in combinations only" in text


class TestTorques:
    def test_measured_and_predicted(self, found, report):
        plots = section(report, "torques").blocks
        joints = found.torque_model.model.joint_names
        assert [plot.title for plot in plots] == [f"{j}, {side}" for j in joints for side in ("fitted", "held out")]
        for j in range(len(joints)):
            for plot, curves in zip(
                plots[2 * j : 2 * j + 2],
                (found.fit.curves(found.shown().name), found.trials[0].curves(found.shown().name)),
                strict=True,
            ):
                assert isinstance(plot, Plot)
                (measured, predicted), (residual,) = (panel.series for panel in plot.panels)
                assert measured.style != predicted.style
                assert measured.color != predicted.color
                there = ~np.isnan(measured.y)
                np.testing.assert_array_equal(plot.x[there], np.concatenate([curve.t for curve in curves]))
                for series, name in ((measured, "measured"), (predicted, "predicted")):
                    whole = np.concatenate([getattr(curve, name)[:, j] for curve in curves])
                    np.testing.assert_array_equal(series.y[there], whole)
                np.testing.assert_array_equal(residual.y, predicted.y - measured.y)

    def test_pieces_of_time(self):
        """Folds follow one another; between them the curves are interrupted."""
        folds = identified_arm.identified(("wls",), held_out=Folds(3))
        plot = section(identify_report(folds, folds.shown()), "torques").blocks[1]
        assert np.isnan(plot.panels[0].series[0].y).sum() == 2
        assert np.all(np.diff(plot.x) >= 0)
        assert plot.x_title == "t [s]"

    def test_recordings_that_begin_anew(self):
        arm = identified_arm.virtual()
        both = identified_arm.crosscheck.identify(
            arm.subject.model, [arm.fitted, arm.held_out], methods=["wls"], terms=arm.torque_model.terms,
            preparation=identified_arm.CUTOFF, poses=identified_arm.POSES,
        )  # fmt: skip
        plot = section(identify_report(both, both.shown()), "torques").blocks[0]
        assert plot.x_title == "t [s], recordings one after another"
        assert np.all(np.diff(plot.x) >= 0)
        first, second = both.fit.times
        assert plot.x[-1] - plot.x[0] == pytest.approx(first[-1] - first[0] + second[-1] - second[0])
