"""Results in notebooks: HTML that a parser accepts, with a picture, in colors of the page around it, and short text."""

import sys
import tomllib
from dataclasses import replace
from html.parser import HTMLParser
from importlib import import_module

import numpy as np
import pytest
from shared_data import REPOSITORY

import crosscheck
import graphdyn
import urdf
from crosscheck.identifying import Preparation, virtual_robot
from crosscheck.notebook import html
from crosscheck.notebook.results import REPORTS
from crosscheck.recordings import recognize
from crosscheck.report.fragment import MAX_FRAGMENT_ROWS, fragment
from crosscheck.report.report import Column, Facts, Group, Prose, Report, Row, Section, Table, Verdict
from graphdyn.display import GROUP, MAX_CHARACTERS

VOID = {"meta", "br", "hr", "input"}
"""Elements without an end."""
HOSTILE = "<script>alert(1)</script>"


class Elements(HTMLParser):
    """The elements of a piece of HTML; it refuses ends without a beginning."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.names, self.ids, self.text = [], [], [], ""
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.names.append(tag)
        self.ids += [value for name, value in attributes if name == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.names.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


@pytest.fixture(scope="module")
def results(pendulum_text, tmp_path_factory):
    """One of most classes, of a robot with one joint."""
    model = urdf.load(pendulum_text)
    motion = graphdyn.simulate(model, [0.3], [0.0], duration=0.2)
    recording = virtual_robot(model, (), seconds=10)
    log = tmp_path_factory.mktemp("log") / "log.csv"
    t = np.linspace(0, 2, 200)
    rows = np.column_stack([t, np.sin(t), np.cos(t)])
    np.savetxt(log, rows, delimiter=",", header="time,swing_position_rad,swing_torque_Nm", comments="")
    return {
        "model": model,
        "simulation": motion,
        "virtual recording": motion.recording(),
        "recording": recording.fitted,
        "log": recognize(log, model),
        "inspection": urdf.inspect(pendulum_text),
        "comparison": crosscheck.compare(model, samples=1),
        "judgment": crosscheck.judge(
            model, inverse_dynamics=lambda q, v, a: 1.5 * graphdyn.joint_torques(model, q, v, a), samples=5
        ),
        "identification": crosscheck.identify(
            model, recording.fitted, terms="standard", methods=["ols"], preparation=Preparation(cutoff=10.0), poses=5
        ),
    }


def test_every_result_is_short_as_text(results):
    for name, result in results.items():
        assert 10 < len(str(result)) <= MAX_CHARACTERS, name
        assert 10 < len(repr(result)) <= MAX_CHARACTERS, name
    assert str(results["comparison"]).startswith("pendulum agrees with Pinocchio: ")
    assert "inverse_dynamics on pendulum: DISAGREES with graphdyn" in str(results["judgment"])
    assert str(results["model"]).startswith("robot pendulum: 1 joint, 1.5 kg")
    assert "OLS: " in str(results["identification"])
    assert "channels: t, q, tau" in str(results["recording"])


def test_every_result_is_a_piece_of_html_with_a_picture(results):
    ids = []
    for name, result in results.items():
        said = html(result)
        found = Elements(said)
        assert found.names.count("svg") >= (name != "inspection"), name
        assert not {"script", "html", "body", "h1", "h2", "h3", "iframe", "button"} & set(found.names), name
        assert len(said) < 150_000, name
        ids += found.ids
    assert len(ids) == len(set(ids))  # cells of one notebook share a page


def test_eight_classes_and_more_have_one(results):
    assert len({type(result) for result in results.values()}) >= 9
    assert {type(result) for result in results.values()} <= set(REPORTS)
    for kind in REPORTS:
        assert hasattr(kind, "_repr_html_")


def test_the_package_announces_what_draws():
    said = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]["entry-points"][GROUP]
    (place,) = said.values()
    module, name = place.split(":")
    assert getattr(import_module(module), name) is html


def test_what_cannot_be_drawn_has_none(results):
    assert html(3) is None
    with pytest.MonkeyPatch.context() as patch:

        def refuse(model):
            raise graphdyn.InconsistentState("the loop cannot be closed")

        patch.setitem(REPORTS, graphdyn.RobotModel, refuse)
        assert html(results["model"]) is None


def test_names_of_others_are_text(results):
    found = Elements(html(replace(results["model"], name=HOSTILE)))
    assert "script" not in found.names
    assert HOSTILE in found.text


class TestTables:
    def test_results_are_tables(self, results):
        pytest.importorskip("pandas", reason="the extra graphdyn[pandas] is not installed")
        quantities = results["comparison"].to_pandas()
        assert quantities.index.name == "quantity"
        assert quantities.loc["inverse_dynamics", "agrees"]
        assert (quantities["error"] <= quantities["bound"]).all()
        judged = results["judgment"].to_pandas()
        assert list(judged["reference"][:2]) == ["graphdyn", "pinocchio"]
        assert not judged["agrees"].any()
        motion = results["simulation"].to_pandas()
        assert list(motion.columns) == ["q swing", "v swing", "a swing", "tau swing"]
        np.testing.assert_array_equal(motion["q swing"], results["simulation"].q[:, 0])
        np.testing.assert_array_equal(motion.index, results["simulation"].time)
        assert list(results["virtual recording"].to_pandas().columns) == list(motion.columns)
        assert list(results["recording"].to_pandas().columns[:2]) == ["block", "q swing"]
        assert results["model"].to_pandas().loc["swing", "mass"] == 1.5
        assert set(results["inspection"].to_pandas().columns) >= {"severity", "code", "line", "remedy"}
        assert "OLS" in results["identification"].to_pandas().index

    def test_without_pandas_the_error_says_how_to_install_it(self, results, monkeypatch):
        monkeypatch.setitem(sys.modules, "pandas", None)
        for name in ("model", "simulation", "recording", "inspection", "comparison", "judgment", "identification"):
            with pytest.raises(ImportError, match=r"pandas is not installed; run: .* 'graphdyn\[pandas\]'"):
                results[name].to_pandas()


class TestFragment:
    def test_colors_come_from_the_text_around_it(self):
        style = (REPOSITORY / "crosscheck/report/page/fragment.css").read_text("utf-8")
        used = {line.split(":")[0] for line in style.replace("{", "\n").splitlines() if line.startswith("  --")}
        assert {"  --ink", "  --paper"} <= used
        assert "prefers-color-scheme" not in style  # notebooks have themes of their own
        assert all(line.startswith((".graphdyn", "  ")) for line in style.splitlines() if line)

    def test_first_section_in_few_rows_failures_first_and_nothing_folded(self):
        rows = tuple(Row((f"row {k}", Verdict("agrees", "agrees")), "agrees") for k in range(30))
        failing = Row(("bad row", Verdict("disagrees", "DISAGREES")), "disagrees", link="elsewhere")
        table = Table((Column("name", "name"), Column("verdict", "verdict")), (*rows, failing))
        blocks = (table, Group((Facts((("a", "b"),)),)), Prose("left out", folded=True, title="Folded"))
        report = Report(
            "Title", Verdict("disagrees", "DISAGREES", "Because."), (Section("a", "A", blocks),), None, ("w",)
        )
        said = fragment(report)
        found = Elements(said)
        assert found.names.count("tr") == 1 + MAX_FRAGMENT_ROWS
        assert "a" not in found.names  # the rest of the page is not there
        for shown in ("Title", "DISAGREES", "Because.", "bad row", f"{MAX_FRAGMENT_ROWS} of 31 rows", "warning"):
            assert shown in found.text
        assert "left out" not in found.text
