"""Functions of motion, momentum, energy and reactions as people write them: right without a slip, wrong with each."""

import dataclasses

import numpy as np
import pytest
from planting import mixed_tree

import urdf
from crosscheck.judging.faults.recursion import DynamicsCode, numbers_of
from crosscheck.judging.functions.table import formulation_of
from crosscheck.judging.slips.operations import Operations
from crosscheck.judging.slips.search import all_slips, torques_with
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS
from graphdyn import Frame, Placement

ROUNDED = 1e-11
"""Relative error of slopes from seven values, and of sums in another order."""

SHOWN = 1e-9
"""Relative difference from which on a slip shows."""


@pytest.fixture(scope="module")
def model():
    """A tree with a turned base, sliding and turning joints, and a frame off its link's origin."""
    tree = mixed_tree()
    turned = Placement(UR5.joints[1].placement.rotation, np.array([0.1, -0.2, 0.3]))
    tool = Frame("tool", tree.n_bodies, Placement(turned.rotation, np.array([0.2, 0.1, -0.1])))
    return dataclasses.replace(tree.with_base(turned), frames=(tool,))


def state_of(known, states):
    third = states.tau if "tau" in known.arguments else states.a
    return states.q, states.v, third


UR5 = urdf.load("ur5")
FORMULATED = [name for name in FUNCTIONS if formulation_of(name, UR5, "tool0", {
    "reference": "local", "order": "linear first", "about": "", "acceleration": "classical"})]  # fmt: skip
MANY_READINGS = {"joint_wrenches": 5, "frame_acceleration": 3}
"""Of every so many ways to read the answers one is taken."""


@pytest.mark.parametrize("name", FORMULATED)
def test_without_a_slip_they_are_right(model, name):
    known, states = FUNCTIONS[name], JudgedStates.draw(model, 3, 5, needs_tau=True, frame="tool")
    code = DynamicsCode.of(model)
    columns = tuple(np.moveaxis(x, -1, 0)[:, None] for x in state_of(known, states))
    size = len(states.q)
    for chosen in list(known.readings({}))[:: MANY_READINGS.get(name, 1)]:
        ours = known.of_graphdyn(states, chosen).reshape(size, -1)
        formulation = formulation_of(name, model, "tool", chosen)
        found = formulation(code, numbers_of([code]), columns, Operations([], size))
        found = np.broadcast_to(found, (len(found), 1, size))[:, 0].T
        assert np.abs(found - ours).max() <= ROUNDED * np.abs(ours).max(), chosen


SLIPPED = ("frame_placement", "frame_jacobian", "frame_jacobian_derivative", "frame_velocity", "frame_acceleration",
           "center_of_mass", "center_of_mass_jacobian", "momentum", "kinetic_energy", "potential_energy",
           "joint_wrenches", "multipliers", "forward_dynamics")  # fmt: skip


@pytest.mark.parametrize("name", SLIPPED)
def test_each_slip_is_alone_and_has_its_own_words(model, name):
    """Many show nothing in one function, such as velocities in a placement."""
    known, states = FUNCTIONS[name], JudgedStates.draw(model, 2, 6, needs_tau=True, frame="tool")
    formulation = formulation_of(name, model, "tool", next(known.readings({})))
    code, state = DynamicsCode.of(model), state_of(known, states)
    slips = all_slips(formulation, code)
    words = [slip.message(model.joint_names, model.body_names) for slip in slips]
    assert len(set(words)) == len(words)
    together = torques_with(formulation, slips, code, state)
    (right,) = _right(formulation, code, state)
    size = np.abs(right).max()
    for k in range(0, len(slips), 17):
        (alone,) = torques_with(formulation, [slips[k]], code, state)
        finite = np.isfinite(alone)
        bound = ROUNDED * max(size, np.abs(alone[finite]).max(initial=0.0))
        assert np.abs(together[k][finite] - alone[finite]).max(initial=0.0) <= bound
    assert (np.abs(together - right).max(axis=(1, 2)) > SHOWN * size).mean() > 0.25


def _right(formulation, code, state):
    columns = tuple(np.moveaxis(x, -1, 0)[:, None] for x in state)
    found = formulation(code, numbers_of([code]), columns, Operations([], len(state[0])))
    return np.moveaxis(np.broadcast_to(found, (len(found), 1, len(state[0]))), 0, -1)


def test_operations_that_are_done_once_name_no_joint(model):
    known = FUNCTIONS["frame_velocity"]
    formulation = formulation_of("frame_velocity", model, "tool", next(known.readings({})))
    words = [
        slip.message(model.joint_names, model.body_names) for slip in all_slips(formulation, DynamicsCode.of(model))
    ]
    assert "the linear part is that of 'world', the angular part that of 'local_world_aligned or world'" in words
    assert "the offset of the frame from its link's origin is left out" in words
