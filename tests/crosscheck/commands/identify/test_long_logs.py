"""`graphdyn identify` of long LOGs: which are read part by part although nobody asks for it, and what is said of it."""

import json
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from identified import identified_arm
from long_check import few
from pyarrow import csv, parquet

from crosscheck.commands.identify.long_logs import are_long
from crosscheck.commands.identify.options import IdentifyOptions
from crosscheck.commands.program.exits import BAD_INPUT

IN_PARTS = "note: the LOGs are long, and read part by part, by methods that need no more than sums"
IN_MEMORY = "note: the LOGs are long, and read into memory all the same: "

QUICK = ("--poses", "5", "--methods", "wls", "--terms", "viscous,coulomb", "--width", "0.05", "--cutoff", "10")


@pytest.fixture(scope="module")
def columns():
    return identified_arm.columns()


@pytest.fixture
def folder(tmp_path, monkeypatch, small_arm, columns):
    """A log as text and as Parquet, and one with a repeated stamp; a thousand rows are long."""
    monkeypatch.setattr("crosscheck.commands.identify.long_logs.LONG_ROWS", 1000)
    csv.write_csv(pa.table(columns), tmp_path / "log.csv")
    parquet.write_table(pa.table(columns), tmp_path / "log.parquet")
    repeated = {name: np.concatenate([values[:1200], values[1199:]]) for name, values in columns.items()}
    csv.write_csv(pa.table(repeated), tmp_path / "repeated.csv")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("unexamined")
@pytest.mark.parametrize("name", few(["log.csv", "log.parquet"], "log.csv"))
def test_read_part_by_part(program, folder, small_arm, name):
    done = program("identify", name, "--robot", str(small_arm), *QUICK, "--json", "found.json")
    assert IN_PARTS in " ".join(done.err.split())
    assert done.code != BAD_INPUT, done.err
    record = json.loads((folder / "found.json").read_text(encoding="utf-8"))
    assert record["recording"]["files"] == [name]
    assert record["recording"]["held_out"] == "the last 25 % of every log"
    assert record["exogeneity"].startswith("not tested: the test needs single rows")
    (wls,) = record["methods"]
    memory = program("identify", name, "--robot", str(small_arm), *QUICK, "--drop", "all", "--json", "memory.json")
    assert IN_PARTS not in memory.err
    other = json.loads((folder / "memory.json").read_text(encoding="utf-8"))["methods"][0]
    np.testing.assert_allclose(wls["mean_error"], other["mean_error"], rtol=0.05)  # the borders are others


@pytest.mark.parametrize("options", [{"folds": 4}, {"methods": "huber"}, {"decimate": 2}], ids=str)
def test_options_that_need_every_sample(folder, small_arm, options):
    quick = IdentifyOptions(logs=[folder / "log.csv"], robot=str(small_arm), methods="wls", cutoff="10")
    assert are_long(quick)
    assert not are_long(replace(quick, **options))


def test_rows_that_must_be_dropped(program, folder, small_arm):
    done = program("identify", "repeated.csv", "--robot", str(small_arm), *QUICK)
    said = " ".join(done.err.split())
    assert f"{IN_MEMORY}repeated.csv, row 1199: the time does not increase after it" in said
    assert done.code == BAD_INPUT  # by load_recording, which names the rows
    done = program("identify", "log.csv", "--robot", str(small_arm), *QUICK, "--cutoff", "0.5")
    assert f"{IN_MEMORY}log.csv: " in " ".join(done.err.split())
    assert "too few for the borders of the filter" in done.err


@pytest.mark.usefixtures("unexamined")
def test_what_is_short_or_no_table(program, folder, small_arm, monkeypatch):
    monkeypatch.setattr("crosscheck.commands.identify.long_logs.LONG_ROWS", 10_000)
    assert IN_PARTS not in program("identify", "log.csv", "--robot", str(small_arm), *QUICK).err
    monkeypatch.setattr("crosscheck.commands.identify.long_logs.LONG_ROWS", 0)
    (folder / "damaged.parquet").write_bytes(b"PAR1")
    done = program("identify", "damaged.parquet", "--robot", str(small_arm), *QUICK)
    assert done.code == BAD_INPUT
    assert "damaged.parquet: not a readable Parquet file" in done.err
