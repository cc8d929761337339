"""Packages that are extras: what needs them says so in one line, with what to type, and the rest works without."""

import re
import sys
import tomllib
from pathlib import Path

import pytest

from crosscheck.commands.program.exits import BAD_INPUT
from crosscheck.recordings import BadRecordingFile, load_recording
from graphdyn.errors import install_line, not_installed

ROOT = Path(__file__).parents[2]

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]

SOURCES = [path for package in ("graphdyn", "urdf", "crosscheck") for path in (ROOT / package).rglob("*.py")]


def test_the_line_to_type():
    assert not_installed("mujoco", "mujoco") == (
        "the package mujoco is not installed; run: python -m pip install 'graphdyn[mujoco]'"
    )


def test_every_extra_that_is_named_exists():
    named = set()
    for path in SOURCES:
        text = path.read_text("utf-8")
        named |= set(re.findall(r"""(?:install_line\(|not_installed\([^,()]*, )["'](\w+)["']""", text))
        named |= set(re.findall(r"graphdyn\[(\w+)\]", text))
    assert named >= {"recordings", "mujoco", "identify", "xacro"}
    assert named <= set(PROJECT["optional-dependencies"])


def test_licenses_of_what_is_carried_are_in_the_metadata():
    carried = {path.name.partition(".")[0] for path in (ROOT / "crosscheck/vendor").glob("*.min.js")}
    licenses = {path.stem for pattern in PROJECT["license-files"] for path in ROOT.glob(pattern)}
    assert licenses == {"LICENSE", *carried}
    assert "MIT" in PROJECT["license"]


class TestWithoutArrow:
    LINE = re.escape(install_line("recordings"))

    @pytest.fixture(autouse=True)
    def no_arrow(self, monkeypatch):
        for name in [name for name in sys.modules if name.partition(".")[0] == "pyarrow"]:
            monkeypatch.setitem(sys.modules, name, None)
        monkeypatch.setitem(sys.modules, "pyarrow", None)

    @pytest.mark.parametrize("suffix", ["csv", "parquet"])
    def test_reading(self, suffix, tmp_path):
        log = tmp_path / f"log.{suffix}"
        log.write_bytes(b"time,q1\n0,1\n")
        with pytest.raises(BadRecordingFile, match=rf"log.{suffix}: .*pyarrow is not installed; run: {self.LINE}"):
            load_recording(log)

    def test_writing(self, program, tmp_path):
        arguments = ("questions", "ur5", "--for", "mass_matrix", "--out")
        done = program(*arguments, tmp_path / "asked.parquet")
        assert done.code == BAD_INPUT
        assert re.fullmatch(rf"error: .*pyarrow is not installed; run: {self.LINE}\n", done.err)
        assert program(*arguments, tmp_path / "asked.csv").code == 0

    def test_a_study_does_not_begin(self, program, tmp_path):
        done = program("study", "--config", "small", "--out", tmp_path / "small")
        assert done.code == BAD_INPUT
        assert re.fullmatch(rf"error: .*pyarrow is not installed; run: {self.LINE}\n", done.err)
        assert not (tmp_path / "small").exists()
