"""Faults that one function alone can have: a further mass in the ground, vectors in columns, rows of other joints."""

import numpy as np
import pytest

import urdf
from crosscheck.judging.searching.own_faults import OWN_FAULTS
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS

BOUND = 1e-9


@pytest.fixture(scope="module")
def states():
    return JudgedStates.draw(urdf.load("ur5"), 10, 2, needs_tau=False)


def found(name, states, change):
    ours = FUNCTIONS[name].of_graphdyn(states, next(FUNCTIONS[name].readings({})))
    fault = OWN_FAULTS[name](change(ours), ours, states, BOUND)
    return None if fault is None else fault.said.message


@pytest.mark.parametrize("name", ["center_of_mass", "center_of_mass_jacobian", "center_of_mass_velocity"])
def test_a_mass_in_the_ground_is_counted(states, name):
    mass, center = sum(body.mass for body in states.model.bodies), np.array([0.1, 0.0, -0.2])
    own = center if name == "center_of_mass" else 0.0
    said = found(name, states, lambda ours: (mass * ours + 4.0 * own) / (mass + 4.0))
    at = " at (0.1, 0, -0.2) m" if name == "center_of_mass" else ""
    assert said == f"a further mass of 4 kg{at}, fixed in the ground, is counted, such as that of the base link"
    assert found(name, states, lambda ours: (mass * ours - 2.0 * own) / (mass - 2.0)) is None  # a body is missing
    assert found(name, states, lambda ours: ours + 0.1 * ours**2) is None


def test_parts_of_the_mass_matrix(states):
    gravity = states.answer("gravity_torque")
    changes = {
        "only the diagonal of the matrix is filled in": lambda x: x * np.eye(6),
        "only the lower triangle of the matrix is filled in": np.tril,
        "only the upper triangle of the matrix is filled in": np.triu,
    }
    for message, change in changes.items():
        assert found("mass_matrix", states, change) == message
    assert found("mass_matrix", states, lambda x: x + gravity[:, :, None]).startswith("the gravity torque is added to")
    other = found("mass_matrix", states, lambda x: x + 0.3 * gravity[:, :, None])
    assert other.startswith("one vector, such as a bias or a constant load, is added to every column")
    assert found("mass_matrix", states, lambda x: 1.1 * x) is None


@pytest.mark.parametrize("name", ["mass_matrix", "mass_matrix_inverse"])
def test_rows_of_other_joints(states, name):
    order = [1, 0, 2, 3, 4, 4]
    said = found(name, states, lambda x: x[:, order][:, :, order])
    assert said.startswith("rows and columns are in the order of other joints: 'shoulder_pan_joint' has that of")
    assert "'wrist_3_joint' has that of 'wrist_2_joint'" in said
