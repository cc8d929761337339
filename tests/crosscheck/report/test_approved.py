"""Reports that are held against approved texts: what is seen as a difference."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from shown import approved
from shown.approved import APPROVE_VARIABLE, approve, approve_record, approve_result, page_text

TEXT = """Joints, 3 of them
│ no. │ speed │
│ 1   │ 1.234 │
│ 2   │ -5e-3 │
error 2.2e-16
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.delenv(APPROVE_VARIABLE, raising=False)
    monkeypatch.setattr(approved, "FOLDER", tmp_path)
    (tmp_path / "a.txt").write_text("Joints, 3 of them\n| no. | speed |\n| 1 | 1.234 |\n| 2 | -5e-3 |\nerror 2.2e-16\n")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("speed", "torque"), ("1.234", "1.244"), ("-5e-3", "5e-3"), ("│ 2   │ -5e-3 │\n", ""), ("error", "x\nerror"),
        ("│ 1   │ 1.234 │", "│ 1.234 │ 1   │"), ("1.234", "–"), ("2.2e-16", "2.2e-6"),
    ],
)  # fmt: skip
def test_seen(old, new):
    with pytest.raises(AssertionError, match=r"a.txt is not what is shown; if that is meant, set GRAPHDYN_APPROVE=1"):
        approve("a", TEXT.replace(old, new))


@pytest.mark.parametrize(("old", "new"), [("1.234", "1.235"), ("   │", "│"), ("2.2e-16", "-7.1e-16")])
def test_not_seen(old, new):
    approve("a", TEXT.replace(old, new))


def test_left_out():
    approve("a", TEXT.replace("Joints", "time 1.5 s\nJoints"), rounding="time")
    approve("a", TEXT.replace("1.234", "7"), numbers=False)
    with pytest.raises(AssertionError):
        approve("a", TEXT.replace("1.234", "7 m"), numbers=False)


def test_approved(folder, monkeypatch):
    changed = TEXT.replace("speed", "torque")
    with monkeypatch.context() as asked:
        asked.setenv(APPROVE_VARIABLE, "1")
        approve("a", changed)
    approve("a", changed)


def test_pages():
    table = "<table><tr><td title='more'>1</td><td><p>2\n3</p></td></tr></table>"
    page = f"<body><h1>A</h1><style>x</style>{table}b<p>c</p></body>"
    lines = (" ".join(line.split()) for line in page_text(page).splitlines())
    assert [line for line in lines if line] == ["A", "more 1 | 2 3 |", "b", "c"]


def test_records(folder, monkeypatch):
    record = {"a": [1.23456, 2], "b": [{"c": None, "seconds": 1.0}, {"c": "x"}], "d": []}
    with monkeypatch.context() as asked:
        asked.setenv(APPROVE_VARIABLE, "1")
        approve_record("r", record, without=("seconds",))
    assert (approved.FOLDER / "r_record.txt").read_text() == ".a: 1.235 2\n.b.0.c: None\n.b.1.c: x\n.d:\n"
    approve_record("r", record | {"seconds": 5}, without=("seconds",))
    for change in ({"a": [1.3, 2]}, {"b": [{"c": "x"}]}, {"e": 1}):
        with pytest.raises(AssertionError):
            approve_record("r", record | change, without=("seconds",))


@dataclass
class Found:
    name: str
    values: np.ndarray
    parts: tuple


def test_results(folder, monkeypatch):
    values = np.random.default_rng(0).normal(size=(10, 3))
    found = Found("a", values, ({"x": 1.5, "seconds": 2.0}, None))
    with monkeypatch.context() as asked:
        asked.setenv(APPROVE_VARIABLE, "1")
        approve_result("f", found, without=("seconds",))
    approve_result("f", replace(found, values=values * (1 + 1e-6)), without=("seconds",))
    for change in (
        {"name": "b"}, {"values": -values}, {"values": values[:-1]}, {"values": values[:, ::-1]}, {"parts": ()},
        {"values": np.where(values == values[0, 0], np.nan, values)}, {"values": 1.01 * values},
        {"parts": ({"x": 2.0}, None)},
    ):  # fmt: skip
        with pytest.raises(AssertionError):
            approve_result("f", replace(found, **change), without=("seconds",))
