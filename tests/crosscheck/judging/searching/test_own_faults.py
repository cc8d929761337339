"""Faults that one function alone can have: a further mass in the ground, vectors in columns, rows of other joints."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import urdf
from crosscheck.judging.searching.answer_faults import layout_fault
from crosscheck.judging.searching.own_faults import OWN_FAULTS
from crosscheck.judging.searching.parts import part_fault
from crosscheck.judging.states import JudgedStates
from crosscheck.judging.verdicts.per_parameter import read_with_parameters
from crosscheck.quantities import FUNCTIONS
from graphdyn import mass_matrix

BOUND = 1e-9

DIFFERENCED = 1e-6
"""Of slopes by central differences."""


@dataclass(frozen=True)
class Named:
    """A function under test, and what is known of it."""

    name: str
    known: object


@dataclass(frozen=True)
class Answered:
    """What is read of a verdict."""

    function: Named
    states: JudgedStates
    answer: np.ndarray
    declared: object = None


@pytest.fixture(scope="module")
def states():
    return JudgedStates.draw(urdf.load("ur5"), 10, 2, needs_tau=True)


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


@pytest.mark.parametrize("name", ["dwrenches_da", "dmultipliers_da"])
def test_gravity_in_every_column(states, name):
    of = {"dwrenches_da": "joint_wrenches", "dmultipliers_da": "multipliers"}[name]
    still = FUNCTIONS[of].of_graphdyn(states.but(v=0 * states.v, a=0 * states.a), {})
    said = found(name, states, lambda x: x + still[..., None])
    assert said.startswith("that of gravity is added to every column: it is not subtracted from the answers")
    assert found(name, states, lambda x: 1.1 * x) is None


def test_velocities_of_other_joints(states):
    tau = states.answer("inverse_dynamics").tau
    said = found("power", states, lambda _: tau * states.v[:, [1, 0, 2, 3, 4, 5]])
    assert said.startswith("torques are multiplied by the velocity of another joint: 'shoulder_pan_joint' by that of ")
    assert found("power", states, lambda x: 1.1 * x) is None


def test_units_of_a_position(states):
    states = replace(states, frame="tool0")
    meters = np.array([1.0, 1.0, 1.0, 1000.0])
    assert found("frame_placement", states, lambda x: x * meters[::-1]) is None
    said = found("frame_placement", states, lambda x: x * np.vstack([np.tile(meters, (3, 1)), np.ones(4)]))
    assert said == "the position is multiplied by 1000, as of millimeters"
    said = found("frame_placement", states, lambda x: x * meters)
    assert said.startswith("the whole last column, the 1 below the position too, is multiplied by 1000")


def test_entries_inverted_one_by_one(states):
    each = "every entry of the mass matrix is inverted by itself"
    assert found("mass_matrix_inverse", states, lambda _: 1 / (states.mass + 0.5)) == f"{each}, 0.5 added to it"
    assert found("mass_matrix_inverse", states, lambda x: 1.1 * x) is None


@pytest.mark.parametrize(
    ("term", "factors"),
    [("the first term", (0, 1, 1)), ("the last term", (1, 1, -1)), ("the second term", (1, 0.5, 1))],
)
def test_terms_of_christoffel_symbols(states, term, factors):
    """∂M/∂q by differences."""
    step, units = 1e-6, np.eye(6)
    D = np.stack(
        [
            (mass_matrix(states.model, states.q + step * e) - mass_matrix(states.model, states.q - step * e)) / 2 / step
            for e in units
        ],
        axis=-1,
    )
    parts = (np.einsum(how, D, states.v) for how in ("nijk,nk->nij", "nikj,nk->nij", "njki,nk->nij"))
    first, second, last = parts
    made = factors[0] * first + factors[1] * second - factors[2] * last
    fault = OWN_FAULTS["dtau_dv"](made, first + second - last, states, DIFFERENCED)
    assert f"{term} of the Christoffel symbols," in fault.said.message
    assert ";" not in fault.said.message


@pytest.mark.parametrize(
    ("name", "factors", "message"),
    [
        ("frame_acceleration", (1, 1, 2), "the part of the velocities, at a = 0, is multiplied by 2"),
        ("dtau_dq", (0, 1, 1), "the part at rest, of gravity, is left out"),
        ("joint_wrenches", (1, -1, 1), "the part of the accelerations, at v = 0, has the opposite sign"),
        ("da_dq", (1, 0, 1), "the part of the accelerations, at v = 0, is left out"),
        ("dtau_dq", (1, 1.3, 1), None),
    ],
)
def test_factors_on_parts(states, name, factors, message):
    states = replace(states, frame="tool0")
    solved = name == "da_dq"
    known, inner = FUNCTIONS[name], FUNCTIONS["dtau_dq" if solved else name]
    at = states.but(a=states.answer("forward_dynamics").a) if solved else states
    chosen, zero = next(known.readings({})), 0 * states.q
    rest = inner.of_graphdyn(at.but(v=zero, a=zero), chosen)
    accelerated, moving = (inner.of_graphdyn(at.but(**x), chosen) - rest for x in ({"v": zero}, {"a": zero}))
    made = factors[0] * rest + factors[1] * accelerated + factors[2] * moving
    fault = part_fault(known, -np.linalg.solve(states.mass, made) if solved else made, states, {}, BOUND)
    assert (fault and fault.said.message) == message


def test_what_accelerations_are_solved_from(states):
    known, at = FUNCTIONS["da_dq"], states.but(a=states.answer("forward_dynamics").a)
    slopes, by_torque = (FUNCTIONS["dtau_dq"].of_graphdyn(x, {}) for x in (at, states.but(a=states.tau)))
    said = part_fault(known, -slopes, states, {}, BOUND).said.message
    assert said == "M⁻¹ is left out: the answers are -dtau_dq at the accelerations that belong to the torques"
    said = part_fault(known, -np.linalg.solve(states.mass, by_torque), states, {}, BOUND).said.message
    assert said == "the torques are taken in place of the accelerations in dtau_dq"


def test_a_regressor_is_read_as_a_function_of_another_robot(states):
    """Any parameters serve; those of the robot itself do not decide."""
    known = FUNCTIONS["momentum_regressor"]
    answer = known.of_graphdyn(states, {})
    found = read_with_parameters(Answered(Named("momentum_regressor", known), states, answer))
    assert np.abs(found.states.model.inertial_parameters - states.model.inertial_parameters).max() > 0.1
    momenta = np.einsum("nij,nj->ni", mass_matrix(found.states.model, states.q), states.v)
    assert np.abs(found.answer - momenta).max() < 1e-12 * np.abs(momenta).max()


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
