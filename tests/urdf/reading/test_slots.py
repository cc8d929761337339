"""Tensors whose entries stand in each other's place: corrected where exactly one exchange explains them."""

from itertools import combinations, product

import numpy as np
import pytest
from lxml import etree
from shared_data import ARMS

import urdf
from urdf.document.opening import open_document
from urdf.document.source import reduced
from urdf.reading.slots import MOMENTS, corrections, is_possible, unique_correction

NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
PRODUCTS = ("ixy", "ixz", "iyz")
GIVEN = 'ixx="0.11" ixy="0.01" ixz="0.02" iyy="0.13" iyz="0.03" izz="0.17"'
"""Of the upper arm in the sample file."""


def element(**entries):
    return etree.Element("inertia", {name: str(entries[name]) for name in NAMES})


def eigenvalues(entries):
    xx, xy, xz, yy, yz, zz = (float(entries[name]) for name in NAMES)
    return np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


@pytest.mark.parametrize(("one", "other"), [*product(MOMENTS, PRODUCTS)])
def test_an_exchange_is_undone(one, other):
    right = dict(zip(NAMES, (0.11, 0.012, -0.004, 0.13, 0.009, 0.15), strict=True))
    wrong = {**right, one: right[other], other: right[one]}
    low, middle, high = eigenvalues(wrong)
    assert low < 0 or high > low + middle
    found = unique_correction(element(**wrong))
    assert {**{name: str(value) for name, value in wrong.items()}, **found.entries} == {
        name: str(value) for name, value in right.items()
    }
    assert found.what == f"{min(one, other)} and {max(one, other)} exchanged"


@pytest.mark.parametrize("name", MOMENTS)
def test_a_sign_is_removed(name):
    right = dict(zip(NAMES, (0.11, 0.012, -0.004, 0.13, 0.009, 0.15), strict=True))
    found = unique_correction(element(**{**right, name: f" -{right[name]}"}))
    assert (found.entries, found.what) == ({name: str(right[name])}, f"{name} without its sign")


@pytest.mark.parametrize(
    "entries",
    [
        (0.1, 0, 0, 0.1, 0, 0.1),  # possible
        (0.1, 0, 0, 0.1, 0, 0.2039),  # up to few digits
        (0.001, 0, 0, 0.001, 0, 0.01),  # triangle inequality, which no exchange mends
        (1e-3,) * 6,  # placeholders
        (0.0391, 0.0, 0.025, 0.0395, 0.0007, 0.0123),  # a large product would be left
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    ],
)
def test_everything_else_stays(entries):
    assert unique_correction(element(**dict(zip(NAMES, entries, strict=True)))) is None


def test_several_ways_are_candidates(arm, tmp_path):
    path = arm(GIVEN, 'ixx="0.04" ixy="0.01" ixz="0.18" iyy="0.19" iyz="0.01" izz="0.04"')
    text = path.read_text(encoding="utf-8")
    found = corrections(reduced(open_document(path)).robot.find("link[2]/inertial/inertia"))
    assert [each.what for each in found] == ["ixx and ixz exchanged", "ixz and izz exchanged"]
    done = urdf.repair(path, tmp_path / "out.urdf", ["indefinite-inertia"])
    ways = "; or ".join(each.what for each in found)
    assert done == urdf.RepairedFile(
        None, (), (f"line 7: <inertia> of link 'upper': no body has this tensor; it is possible with {ways}",)
    )
    assert path.read_text(encoding="utf-8") == text


def test_in_a_file(arm, tmp_path):
    path = arm(GIVEN, 'ixx="0.01" ixy="0.110" ixz="0.02" iyy="0.13" iyz="0.03" izz="0.17"')
    (finding,) = (one for one in urdf.inspect(path).findings if one.code == "indefinite-inertia")
    assert finding.message.split(". ")[0].endswith("no real body has one; with ixx and ixy exchanged it is possible")
    done = urdf.repair(path, tmp_path / "out.urdf", ["indefinite-inertia"])
    said = "line 7: <inertia> of link 'upper': ixx and ixy exchanged, because no body has this tensor"
    assert done.changes == (said,)
    assert 'ixx="0.110" ixy="0.01" ixz' in done.path.read_text(encoding="utf-8")
    assert urdf.inspect(done.path).usable


@pytest.mark.parametrize("path", sorted(ARMS.glob("*.urdf"))[::6], ids=lambda path: path.stem)
def test_planted_in_files_of_makers(path):
    """Every exchange of two entries of every link: right or left as it is, never anything else."""
    undone = clear = 0
    for inertia in reduced(open_document(path)).robot.iter("inertia"):
        given = dict(inertia.attrib)
        if not eigenvalues(given).any() or unique_correction(inertia) is not None or corrections(inertia):
            continue
        for one, other in combinations(NAMES, 2):
            inertia.attrib.update({one: given[other], other: given[one]})
            found = unique_correction(inertia)
            clear += not is_possible({name: float(inertia.get(name)) for name in NAMES}, -0.02)
            if found is not None:
                undone += 1
                corrected = {**inertia.attrib, **found.entries}
                assert {name: float(corrected[name]) for name in NAMES} == {n: float(given[n]) for n in NAMES}
            inertia.attrib.update(given)
    assert undone >= 0.5 * clear
