"""The cross-check of robots with loops: Pinocchio's constrained dynamics, which can fail."""

from dataclasses import replace

import pytest
from robots.mechanisms import bricard, four_bar, palletizer
from shared_data import DATA, existing

import crosscheck
import urdf
from crosscheck.commands.program.exits import BAD_INPUT
from crosscheck.comparing import looped
from crosscheck.quantities import COMPARED, LOOPED
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import Chord

SAMPLES = 2


def missed(model):
    """Quantities of the loops that miss their bounds, and all of them."""
    case = looped.looped_case(model.uncoupled, SAMPLES, seed=0)
    found = looped.looped_errors(case, ScaledStates.at(case), PinocchioModel.from_model(model.opened.uncoupled))
    return {name for name, error in found.items() if not error.max() <= LOOPED[name].tolerance.bound}, set(found)


def test_a_palletizing_arm_agrees():
    model, _ = palletizer(existing(DATA / "loops").parent)
    assert missed(model) == (set(), set(LOOPED))


def test_loops_and_the_tree_are_compared():
    comparison = crosscheck.compare(four_bar(), samples=SAMPLES)
    assert comparison.agrees
    assert set(comparison.quantities) - set(COMPARED) == set(LOOPED)
    assert comparison.model.chords == ()
    assert any(note.endswith("are those of the robot, all others of its tree") for note in comparison.notes)


@pytest.mark.parametrize(
    ("value", "seen"), [(0, {"closed_forward_dynamics", "closed_inverse_dynamics"}), (1, {"closed_joint_wrenches"})]
)
def test_an_error_of_pinocchio_is_seen(monkeypatch, value, seen):
    original = looped.closed_dynamics

    def planted(*arguments):
        values = list(original(*arguments))
        values[value] = values[value] * (1 + 1e-9)
        return tuple(values)

    monkeypatch.setattr(looped, "closed_dynamics", planted)
    results = crosscheck.compare(four_bar(), samples=SAMPLES).quantities
    assert {name for name in LOOPED if not results[name].agrees} == seen


def test_redundant_rows_in_space():
    assert missed(bricard()) == (set(), set(LOOPED) - {"closed_inverse_dynamics"})  # no motors are known


def test_loops_that_pinocchio_has_not():
    model = four_bar()
    (hinge,) = model.chords
    ends = (hinge.body_i, hinge.placement_i, hinge.body_j, hinge.placement_j)
    slide = replace(model, chords=(Chord("slide", "slide", *ends),))
    told = crosscheck.compare(slide, samples=SAMPLES)
    assert (
        told.not_compared["closed_forward_dynamics"] == "Pinocchio has no constraint for a slide that keeps its digits"
    )


def test_loops_are_not_identified_from_recordings_nor_exported(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    urdf.save(four_bar().with_gravity((0, 0, -9.81)), "linkage.urdf")
    done = program("identify", "--robot", "linkage.urdf")
    assert done.code == BAD_INPUT
    assert "which recorded positions leave open by their noise; from Python" in " ".join(done.err.split())
    done = program("export", "linkage.urdf", "--to", "linkage.json")
    assert "warning: robot 'four-bar' has loops, closed by 'closing', which are not written" in done.err
