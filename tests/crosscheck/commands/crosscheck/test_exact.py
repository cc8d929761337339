"""`graphdyn crosscheck --exact`: who errs by how much, on the terminal, in the file and on the page."""

import json
import re
import sys

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from robots.mechanisms import four_bar
from shared_data import REPOSITORY
from shown.pages import opened, rows
from typer.testing import CliRunner
from urdf_text import joint, link, robot_text

import urdf
from crosscheck.commands import app
from crosscheck.commands.crosscheck.exact.report import eps_text
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.comparing.accuracy import measuring
from crosscheck.comparing.accuracy.measured_states import measured_quantities
from crosscheck.distributing import LocalProcesses
from crosscheck.reference.pinocchio_model import PinocchioAnswers

pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")

SCHEMA = Draft202012Validator(json.loads((REPOSITORY / "docs/schemas/accuracy-1.schema.json").read_text("utf-8")))
MEASURED = ("inverse_dynamics", "forward_dynamics", "kinetic_energy")


@pytest.fixture
def few(monkeypatch):
    """Three quantities are measured."""
    known = measured_quantities()
    chosen = {name: known[name] for name in MEASURED} | {"kkt_rank": None}
    monkeypatch.setattr(measuring, "measured_quantities", lambda: chosen)


@pytest.fixture
def arm(tmp_path):
    folder = tmp_path / "robots"
    folder.mkdir()
    path = folder / "one.urdf"
    elements = link("base"), link("upper", xyz="0.3 0 0.1"), joint("shoulder", "base", "upper", "continuous")
    path.write_text(robot_text("one", *elements), encoding="utf-8")
    return path


def run(*arguments):
    return CliRunner().invoke(app, ["crosscheck", *map(str, arguments)])


@pytest.fixture
def wrong_pinocchio(monkeypatch):
    tau = PinocchioAnswers.tau.fget
    monkeypatch.setattr(PinocchioAnswers, "tau", property(lambda there: (1 + 1e-9) * tau(there)))


def test_terminal_file_and_page_have_the_same_numbers(few, arm, tmp_path):
    page, file = tmp_path / "page.html", tmp_path / "errors.json"
    done = run("--exact", 4, arm, "--html", page, "--json", file)
    assert done.exit_code == AGREED, done.output
    record = json.loads(file.read_text(encoding="utf-8"))
    SCHEMA.validate(record)
    (robot,) = record["robots"]
    assert record["agrees"]
    assert (robot["truth"], robot["samples"]) == ("model", 4)
    assert robot["not_measured"] == {"kkt_rank": "no exact form"}
    assert set(robot["quantities"]) == set(MEASURED)
    text = done.output.replace("\n", " ")
    table = rows(page.read_text(encoding="utf-8"), "Errors in eps = 2.2e-16 of the scale of the quantity")
    for name, quantity in robot["quantities"].items():
        for code in ("recursive", "Pinocchio"):
            found = quantity["codes"][code]
            three = [eps_text(found[key]) for key in ("median", "quantile_99", "largest")]
            assert re.search(rf"{name} .*{' +'.join(map(re.escape, three))}", text)
        last = list(quantity["codes"].values())[-1]
        assert eps_text(last["largest"]) in table[name]
    assert "exact are the doubles of the model in memory" in " ".join(done.output.split())
    drawn = opened(page.read_text(encoding="utf-8"))
    assert "eps of the scale" in drawn
    assert all(f">{name}</text>" in drawn for name in MEASURED)


def test_an_error_above_a_bound_is_a_disagreement_of_the_code(few, arm, wrong_pinocchio, tmp_path):
    file = tmp_path / "errors.json"
    done = run(arm, "--exact", "--json", file)
    assert done.exit_code == DISAGREED
    record = json.loads(file.read_text(encoding="utf-8"))
    assert record["robots"][0]["samples"] == 20
    assert record["robots"][0]["quantities"]["inverse_dynamics"]["beyond"] == ["Pinocchio"]
    assert re.search(r"inverse_dynamics .*✗", done.output)


def test_folders(few, arm, tmp_path, monkeypatch):
    (arm.parent / "broken.urdf").write_text("<robot", encoding="utf-8")
    (arm.parent / "two.urdf").write_text(arm.read_text(encoding="utf-8"), encoding="utf-8")
    file = tmp_path / "errors.json"
    monkeypatch.setattr(LocalProcesses, "each", lambda _, function, tasks: enumerate(map(function, tasks)))
    done = run(arm.parent, "--exact", 2, "--json", file)
    assert done.exit_code == BAD_INPUT
    record = json.loads(file.read_text(encoding="utf-8"))
    assert [robot["robot"] for robot in record["robots"]] == [str(arm), str(arm.parent / "two.urdf")]
    assert [failure["robot"] for failure in record["failures"]] == [str(arm.parent / "broken.urdf")]
    assert "Who is closer to the truth" in done.output


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--exact", "0"], "'0' is not a number of states; give a whole number from 1 on"),
        (["--exact=2.5"], "'2.5' is not a number of states"),
        (["--truth", "file"], "--truth is for --exact"),
        (["--exact", "--samples", "3"], "--samples is not for --exact [N], which says how many random states"),
    ],
)
def test_refused_options(arm, arguments, said):
    done = run(arm, *arguments)
    assert done.exit_code == BAD_INPUT
    assert said in " ".join(done.output.split())


def test_without_python_flint(arm, monkeypatch):
    monkeypatch.setitem(sys.modules, "flint", None)
    done = run(arm, arm, "--exact")
    assert done.exit_code == BAD_INPUT
    assert done.output.count("exact values: the package python-flint is not installed") == 1
    assert done.output.count("\n") == 1


def test_loops_are_refused_by_name(tmp_path):
    path = tmp_path / "linkage.urdf"
    urdf.save(four_bar().with_gravity((0, 0, -9.81)), path)
    done = run(path, "--exact")
    assert done.exit_code == BAD_INPUT
    assert "has loops, closed by" in done.output
    assert "have no exact values" in done.output


@pytest.mark.parametrize(("x", "text"), [(0.0, "0"), (450.36, "450"), (12345.6, "1.2e+04"), (3e-5, "3.0e-05")])
def test_texts_of_errors(x, text):
    assert eps_text(x) == text


def test_texts_of_errors_that_are_not_finite():
    assert [eps_text(x) for x in (np.inf, np.nan)] == ["∞", "–"]
