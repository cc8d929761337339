"""Faults that one function alone can have: a further mass in the ground, vectors in columns, rows of other joints."""

import numpy as np
import pytest

import urdf
from crosscheck.judging.searching.answer_faults import layout_fault
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
    known, ours = FUNCTIONS["mass_matrix"], FUNCTIONS["mass_matrix"].of_graphdyn(states, {})
    for message, change in changes.items():
        assert layout_fault(known, change(ours), states, {}, BOUND).said.message == message
    assert layout_fault(known, 1.1 * ours, states, {}, BOUND) is None
    assert found("mass_matrix", states, lambda x: x + gravity[:, :, None]).startswith(
        "that of gravity is added to every column"
    )
    other = found("mass_matrix", states, lambda x: x + 0.3 * gravity[:, :, None])
    assert other.startswith("one vector, such as a bias or a constant load, is added to every column")
    assert found("mass_matrix", states, lambda x: 1.1 * x) is None


@pytest.mark.parametrize("name", ["mass_matrix", "mass_matrix_inverse"])
def test_rows_of_other_joints(states, name):
    order = [1, 0, 2, 3, 4, 4]
    said = found(name, states, lambda x: x[:, order][:, :, order])
    assert said.startswith("rows and columns are in the order of other joints: 'shoulder_pan_joint' has that of")
    assert "'wrist_3_joint' has that of 'wrist_2_joint'" in said


def test_friction_and_springs_in_derivatives(states):
    damping = np.array([0.1, 0.2, 0.3, 0.0, 0.5, 0.6])
    rates = np.linalg.inv(states.mass) @ np.diag(damping)
    shown = "(0.1, 0.2, 0.3, 0, 0.5, 0.6)"
    friction, springs = "viscous friction", "the stiffness of springs"
    for name, what, change in (
        ("dtau_dv", friction, lambda x: x + np.diag(damping)),
        ("dtau_dq", springs, lambda x: x + np.diag(damping)),
        ("da_dv", friction, lambda x: x - rates),
        ("da_dq", springs, lambda x: x - rates),
    ):
        said = found(name, states, change)
        assert said.startswith(f"{what} {shown} ")
        assert said.endswith("per joint is included")
        assert found(name, states, lambda x: 1.1 * x) is None


@pytest.mark.parametrize("name", ["momentum_regressor", "kinetic_energy_regressor", "body_regressor"])
def test_columns_of_all_regressors(states, name):
    order = [0, 1, 2, 3, 4, 6, 5, 7, 8, 9]

    def reordered(x):
        return x.reshape(*x.shape[:-1], -1, 10)[..., order].reshape(x.shape)

    said = found(name, states, reordered)
    assert said.startswith("the ten columns of each body are in the order m, mc_x, mc_y, mc_z, ")
    halved = found(name, states, lambda x: x * np.tile([0.5, *[1] * 9], x.shape[-1] // 10))
    assert halved == "columns are scaled: m × 0.5"
    assert found(name, states, lambda x: -x) is None  # a fault of all answers
