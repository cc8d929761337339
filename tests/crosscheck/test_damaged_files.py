"""Damaged files of every format that is read: refused in a line that names the file, or read as a second reader does.

A long run: `python tests/tools damaged_files 10000 --seed 1`. Robot files: tests/urdf/reading/test_mutants.py.
"""

import os
from dataclasses import replace

import numpy as np
import pytest
from long_check import few
from mutants.formats import FORMATS
from mutants.mutant import mutant
from mutants.outcomes import Result, Trial
from mutants.processes import unexpected
from mutants.readings import Reading

from crosscheck.recordings import BadRecordingFile

SLOW = (
    *("recording mat 7.3", "recording mcap", "recording db3", "recording bag", "bag folder", "exact csv"),
    *("stream parquet", "parts parquet", "answers spoken", "answers spoken json", "sweep", "urdf updated", "xacro"),
)
"""Formats of which a file takes some hundredths of a second."""

QUICK = [name for name in FORMATS if name not in ("urdf", *SLOW)]


MANY = [*((name, 25) for name in QUICK), *((name, 5) for name in SLOW)]


@pytest.mark.parametrize(("name", "many"), few([*MANY, *((name, 100) for name, _ in MANY)], *MANY))
def test_damaged_files(tmp_path, name, many):
    path = tmp_path / f"damaged{FORMATS[name].suffix}"
    results = []
    for number in range(many):
        made = mutant(name, 0, number)
        path.write_bytes(made.content)
        results.append(Result(name, number, made.kinds, FORMATS[name].trial(path)))
    assert unexpected(results) == []
    assert "refused" in {result.trial.outcome for result in results}


@pytest.mark.parametrize("name", [*QUICK, *SLOW])
def test_sound_files_are_read(tmp_path, name):
    path = tmp_path / f"sound{FORMATS[name].suffix}"
    for sound in FORMATS[name].sound:
        path.write_bytes(sound())
        assert FORMATS[name].trial(path) == Trial("agrees")


class TestTheTrialCanFail:
    """A fault planted in a reader shows."""

    @pytest.mark.parametrize("name", [name for name in QUICK if name not in ("study store", "vectors")])
    def test_another_content(self, tmp_path, name):
        """Of a reader that answers what the sound file says, at some mutant that says something else."""
        of = FORMATS[name]
        path, reading = tmp_path / f"x{of.suffix}", of.trial.__self__
        path.write_bytes(of.sound[0]())
        known = reading.known(path)
        for number in range(200):
            path.write_bytes(mutant(name, 0, number).content)
            wrong = Reading(lambda _: known, reading.fault).trial(path)
            if of.trial(path).outcome == "agrees" and wrong.outcome == "unexpected":
                return
        pytest.fail("no mutant tells them apart")

    def test_a_study_that_loses_runs_or_digits(self, tmp_path):
        of = FORMATS["study store"]
        path, reading = tmp_path / "x.sqlite", of.trial.__self__
        path.write_bytes(of.sound[0]())
        inputs, outcomes, _ = reading.known(path)
        (first, outcome), *others = outcomes.items()
        for changed in (dict(others), {**outcomes, first: replace(outcome, total=0.125)}):
            assert (
                Reading(lambda _, held=changed: (inputs, held, []), reading.fault).trial(path).outcome == "unexpected"
            )

    @pytest.fixture
    def told(self, tmp_path):
        """told(read): what the trial says of a reader."""
        path = tmp_path / "x.csv"
        path.write_bytes(b"")

        def told(read):
            found = Reading(read, lambda path, found: None).trial(path)
            assert found.outcome == "unexpected"
            return found.detail

        return told

    def test_foreign_error(self, told):
        assert told(lambda path: {}["row"]).startswith("KeyError: 'row'")

    def test_warning_of_numpy(self, told):
        assert told(lambda path: np.ones(1) / np.zeros(1)).startswith("RuntimeWarning: divide by zero")

    def test_output(self, told):
        assert told(lambda path: os.write(2, b"from C\n")) == "the reader writes ['from C']"

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("row 3: no number", "does not name the file: row 3: no number"),
            ("x.csv: bad\nworse", "is no message for a user"),
            ("x.csv: <object object at 0x7f>", "is no message for a user"),
        ],
    )
    def test_message(self, told, text, said):
        def read(path):
            raise BadRecordingFile(text)

        assert said in told(read)
