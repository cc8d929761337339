"""What Pinocchio's reader writes about a file goes into the notes, not to the terminal."""

import contextlib
import os

import pytest
from inspected.sample import CLEAN, changed

import crosscheck
from crosscheck.reference.pinocchio_model.native import kept_standard_error

MASS = changed('value="2.5"', 'value="2.5 "')
REFUSED = changed('lower="-1"', 'lower="-1 "')
LATIN = '<?xml version="1.0" encoding="ISO-8859-1"?>' + changed('"tool"', '"töol"', '"tool"', '"töol"')


@pytest.fixture
def notes(tmp_path, capfd):
    def of(text):
        path = tmp_path / "arm.urdf"
        path.write_bytes(text.encode("iso-8859-1"))
        comparison = crosscheck.compare(path, samples=2)
        assert capfd.readouterr() == ("", "")
        return comparison

    return of


def test_a_number_that_it_reads_otherwise(notes):
    comparison = notes(MASS)
    assert not comparison.agrees
    assert comparison.notes == (
        "Pinocchio's reader wrote: Error: Inertial: mass [2.5 ] is not a float",
        "Pinocchio's reader wrote: Error: Could not parse inertial element for Link [upper]",
    )


def test_a_file_that_it_refuses(notes):
    comparison = notes(REFUSED)
    assert comparison.agrees
    assert comparison.routes == ("model",)
    assert comparison.notes[0].startswith("route 'urdf' not taken: Pinocchio cannot read")
    assert (
        "Pinocchio's reader wrote: Error: joint [shoulder]: lower value (-1 ) is not a valid float" in comparison.notes
    )


def test_a_name_that_it_reads_otherwise(notes):
    comparison = notes(LATIN)
    assert comparison.agrees
    assert comparison.notes == ("route 'urdf' not taken: Pinocchio has no link 'töol'",)


def test_nothing_is_said_of_what_makes_no_difference(notes):
    comparison = notes(CLEAN.replace('<link name="tool"/>', '<link name="tool"><visual/></link>'))
    assert comparison.agrees
    assert comparison.notes == ()


def test_standard_error_comes_back(capfd):
    with contextlib.suppress(ZeroDivisionError), kept_standard_error() as written:
        os.write(2, "kept ä\nand this".encode())
        _ = 1 / 0
    os.write(2, b"shown")
    assert written == ["kept ä", "and this"]
    assert capfd.readouterr().err == "shown"
