"""The cross-check of robots with loops: Pinocchio's constrained dynamics, which can fail."""

import functools
from contextlib import suppress
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from long_check import few
from robots.mechanisms import bricard, four_bar, palletizer
from shared_data import DATA, existing

import crosscheck
import urdf
from crosscheck.commands.program.exits import BAD_INPUT
from crosscheck.comparing import compare as comparing
from crosscheck.comparing import looped
from crosscheck.quantities import COMPARED, LOOPED
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import Chord, InconsistentState, SingularMassMatrix, forward_dynamics

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


PLANTED = 1e-8
"""Relative error planted in what Pinocchio answers."""

FIRST = {
    "epr/5bar_linkage/robot.urdf": True,
    "epr/robot_delta/robot.urdf": False,
    "urdfplus/planar_leg_linkage.urdf": True,
}
"""Published robots of the short check, and whether links lose their mass: chords of all kinds of size; links of 7 mg;
closed to 1e-13."""

OTHERS = {
    "epr/cassie_like/robot.urdf",
    "strandbeest/Strandbeest.urdf",
    *(f"urdfplus/{name}.urdf" for name in ("four_bar", "loop_size5", "six_bar")),
}
PUBLISHED = few([*product(sorted(FIRST.keys() | OTHERS), (False, True))], *FIRST.items())


def with_links_without_mass(model):
    """As many links as possible in regular steps lose their mass, where all motions still have inertia."""
    nothing = {"mass": 0.0, "center_of_mass": np.zeros(3), "inertia": np.zeros((3, 3))}
    for step in range(3, model.n_bodies + 1):
        bodies = [replace(body, **nothing) if k % step == 0 else body for k, body in enumerate(model.bodies)]
        lighter = replace(model, bodies=tuple(bodies))
        q, v = lighter.random_state(np.random.default_rng(0))
        with suppress(SingularMassMatrix):
            forward_dynamics(lighter, q, v, 0 * q)
            return lighter
    return pytest.fail("no link can lose its mass")


@pytest.mark.filterwarnings("ignore::urdf.URDFWarning")
@pytest.mark.parametrize(("file", "massless"), PUBLISHED)
def test_errors_of_pinocchio_are_seen(monkeypatch, file, massless):
    """In accelerations and in wrenches, also where the tree's own mass matrix is singular."""
    model = urdf.load(existing(DATA / "loops" / file)).uncoupled
    model = with_links_without_mass(model) if massless else model
    case = looped.looped_case(model, 6, seed=0)
    ours, pinocchio, original = ScaledStates.at(case), PinocchioModel.from_model(model.opened), looped.closed_dynamics

    def off(*planted):
        answers = functools.cache(lambda *state: original(pinocchio, model.chords, *map(np.array, state)))

        def closed(_, __, *state):
            found = answers(*(tuple(map(tuple, x)) if np.ndim(x) == 2 else tuple(x) for x in state))
            return tuple(value * (1 + error) for value, error in zip(found, planted, strict=True))

        monkeypatch.setattr(looped, "closed_dynamics", closed)
        errors = looped.looped_errors(case, ours, pinocchio)
        return {name for name, error in errors.items() if not error.max() <= LOOPED[name].tolerance.bound}

    assert off(0.0, 0.0) == set()
    assert off(PLANTED, 0.0) >= {"closed_backward_error"}
    assert off(0.0, PLANTED) == {"closed_joint_wrenches"}


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


def test_what_closes_only_stretched_is_refused_before_anything_is_compared(monkeypatch):
    monkeypatch.setattr(comparing, "_compare_chunk", lambda *_, **__: pytest.fail("compared"))
    with pytest.raises(InconsistentState, match="its loops close only stretched or folded: motions of a, b, c"):
        crosscheck.compare(four_bar(1.0, 1.0, 1.0, 3.0), samples=SAMPLES)


def test_loops_are_not_identified_from_recordings_nor_exported(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    urdf.save(four_bar().with_gravity((0, 0, -9.81)), "linkage.urdf")
    done = program("identify", "--robot", "linkage.urdf")
    assert done.code == BAD_INPUT
    assert "which recorded positions leave open by their noise; from Python" in " ".join(done.err.split())
    done = program("export", "linkage.urdf", "--to", "linkage.json")
    assert "warning: robot 'four-bar' has loops, closed by 'closing', which are not written" in done.err
