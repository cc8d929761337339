"""Every derivative against finite differences: φ_q, ζ, the null space, D, Ḋ, velocities, accelerations, Cardano form.

States off the constraint manifold are included: there, terms that vanish on it must be right too.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from random_trees import NAMED, SEEDS, random_state, random_wrenches, robots
from scipy.spatial.transform import Rotation
from witnesses import (
    acceleration_scale,
    axial,
    derivative,
    displaced,
    exponential,
    off_manifold,
    origins,
    relative_error,
    second_derivative,
)

import graphdyn
from graphdyn import MaximalState
from graphdyn.equations.kinematics import bias_acceleration, link_origins, null_space
from graphdyn.equations.system.constraints import constraints
from graphdyn.layout import constraint_row_names
from graphdyn.model.spatial import (
    cardano_angles,
    cardano_matrix,
    cardano_rate_matrix,
    cardano_rate_matrix_derivative,
    cos_beta,
    cross,
    rotation_about,
    skew,
)

EPS = np.finfo(float).eps

FIRST = 1e-11
"""Sixth-order first differences with steps of 1e-3, relative to the largest entry: measured 1.3e-12."""

SECOND = 2e-10
"""Sixth-order second differences with steps of 5e-3, relative to the largest term: measured 1.1e-11."""

SECOND_CARDANO = 1e-9
"""The same with steps of 2e-3, because θ̇ is larger than ω and rounding grows as 1/h²: measured 6.6e-11."""

LEVER_ROUNDING = 4 * EPS
"""Relative to the lever: measured 0.4; with positions in the world 6."""

IDENTITY = 1e-13
"""The same sum in another order, relative to the largest term: measured 2e-15."""

CARDANO = 30 * EPS
"""Times cond(D)² of the worst body and the conditioning of the twist form: measured 2.6."""


def states(model, where, seed):
    """A state on the constraint manifold, or one with the bodies torn out of their joints."""
    q, v, _ = random_state(model, seed)
    state = graphdyn.maximal_state(model, q, v)
    return state if where == "on the manifold" else off_manifold(state, seed)


everywhere = pytest.mark.parametrize("where", ["on the manifold", "off the manifold"])


@everywhere
def test_constraint_jacobian_is_the_derivative_of_the_residual(robot, where):
    state, n = states(robot, where, 30), robot.n_bodies
    phi_q, _ = constraints(state)

    def column(direction):
        shift, turn = direction[:, :3], direction[:, 3:]
        return derivative(lambda h: displaced(state, h * shift, h * turn).constraint_residual()).ravel()

    numerical = np.stack([column(e.reshape(n, 6)) for e in np.eye(6 * n)], axis=-1)
    assert relative_error(phi_q, numerical) < FIRST


def bodies_along(state, acceleration):
    """t → state of free bodies that start with the velocities of `state` and these accelerations (n, 6)."""
    start = state.velocity

    def at(t):
        d = start * t + acceleration * t**2 / 2  # R exp(θ̃) with θ = ω t + ω̇ t²/2: ω̇(0) is θ̈(0), since θ̇ × θ̇ = 0
        return displaced(state, d[:, :3], d[:, 3:])

    return at


@everywhere
def test_zeta_completes_the_second_derivative_of_the_residual(robot, where):
    state = states(robot, where, 31)
    acceleration = np.random.default_rng(32).uniform(-3, 3, (robot.n_bodies, 6))
    phi_q, zeta = constraints(state)
    along = bodies_along(state, acceleration)
    numerical = second_derivative(lambda t: along(t).constraint_residual()).ravel()
    assert relative_error(phi_q @ acceleration.ravel() - zeta, numerical, zeta) < SECOND


@everywhere
def test_constraint_jacobian_times_velocity_is_the_rate_of_the_residual(robot, where):
    state = states(robot, where, 33)
    phi_q, _ = constraints(state)
    along = bodies_along(state, np.zeros((robot.n_bodies, 6)))
    rate = derivative(lambda t: along(t).constraint_residual()).ravel()
    assert relative_error(phi_q @ state.velocity.ravel(), rate, phi_q, state.velocity) < FIRST


@given(robots(), SEEDS)
def test_null_space_holds_the_velocities_that_the_joints_allow(model, seed):
    q, v, _ = random_state(model, seed)
    state = graphdyn.maximal_state(model, q, v)
    phi_q, _ = constraints(state)
    n = null_space(state)
    assert relative_error(phi_q @ n, np.zeros((5 * model.n_bodies, model.n_bodies)), phi_q, n) < IDENTITY
    assert relative_error(n @ v, state.velocity.ravel(), n) < IDENTITY
    assert np.linalg.matrix_rank(n) == model.n_bodies


def test_the_lever_of_the_last_body_has_its_own_rounding():
    """Not that of positions in the world, meters from the base: p × R c = R (p × c)."""
    model = graphdyn.kr500()
    state = graphdyn.maximal_state(model, *model.random_state(np.random.default_rng(38), 20))
    joint, body = model.joints[-1], model.bodies[-1]
    linear = null_space(state)[:, -6:-3, -1]
    wanted = state.rotation[:, -1] @ np.cross(joint.axis, body.center_of_mass)
    assert np.abs(linear - wanted).max() < LEVER_ROUNDING * np.linalg.norm(body.center_of_mass)


def test_what_a_joint_holds_has_no_share_about_its_axis():
    """Where the center of mass is on the axis, forces at the joint and moments across it do not turn the body, exactly:
    a rounding of theirs would be large against the inertia of a light wrist."""
    model = graphdyn.kr500()
    last = replace(model.bodies[-1], center_of_mass=0.3 * model.joints[-1].axis)
    model = replace(model, bodies=(*model.bodies[:-1], last))
    state = graphdyn.maximal_state(model, *model.random_state(np.random.default_rng(39), 20))
    phi_q, _ = constraints(state)
    assert not (phi_q[:, -5:, -3:] @ model.joints[-1].axis).any()


@given(robots(), SEEDS)
def test_accelerations_that_the_joints_allow_satisfy_the_constraints(model, seed):
    q, v, a = random_state(model, seed)
    state = graphdyn.maximal_state(model, q, v, a)
    phi_q, zeta = constraints(state)
    assert relative_error(phi_q @ state.acceleration.ravel(), zeta, state.acceleration) < IDENTITY
    assert np.abs(state.constraint_residual()).max() < IDENTITY * max(1.0, np.abs(state.position).max())


def motion_of(model, q, v, a):
    return lambda t: graphdyn.maximal_state(model, q + v * t + a * t**2 / 2, v + a * t)


def test_velocities_and_accelerations_are_derivatives_of_the_poses(robot):
    q, v, a = random_state(robot, 34)
    at = motion_of(robot, q, v, a)
    state = graphdyn.maximal_state(robot, q, v, a)
    turning = np.swapaxes(state.rotation, -1, -2) @ derivative(lambda t: at(t).rotation)  # Rᵀ Ṙ = ω̃
    assert relative_error(state.velocity[:, :3], derivative(lambda t: at(t).position)) < FIRST
    assert relative_error(state.velocity[:, 3:], axial(turning), state.velocity) < FIRST
    assert relative_error(state.acceleration, derivative(lambda t: at(t).velocity)) < FIRST


def test_bias_acceleration_is_what_remains_without_joint_accelerations(robot):
    q, v, _ = random_state(robot, 35)
    at = motion_of(robot, q, v, 0 * v)
    bias = bias_acceleration(robot, q, v)
    null_space_rate = derivative(lambda t: null_space(at(t)))
    assert relative_error(bias, derivative(lambda t: at(t).velocity)) < FIRST
    assert relative_error(bias.ravel(), null_space_rate @ v, null_space_rate) < FIRST  # Ṅ v


def test_link_origins_are_where_the_link_frames_stand(robot):
    q, v, _ = random_state(robot, 36)
    state = graphdyn.maximal_state(robot, q, v)
    at_frames = [graphdyn.frame_placement(robot, q, name)[1] for name in robot.body_names]
    np.testing.assert_allclose(link_origins(state), origins(state), rtol=0, atol=IDENTITY)
    np.testing.assert_allclose(at_frames, origins(state), rtol=0, atol=IDENTITY)


# Rotations and Cardano angles


def test_rotation_about_an_axis_is_scipys(rng):
    for _ in range(20):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        angles = rng.uniform(-7, 7, 5)
        expected = Rotation.from_rotvec(angles[:, None] * axis).as_matrix()
        np.testing.assert_allclose(rotation_about(axis, angles), expected, rtol=0, atol=10 * EPS)


def test_skew_is_the_cross_product(rng):
    a, b = rng.normal(size=(2, 5, 3))
    np.testing.assert_allclose((skew(a) @ b[..., None])[..., 0], np.cross(a, b), rtol=0, atol=10 * EPS)


@pytest.mark.parametrize("shapes", [((3,), (3,)), ((5, 3), (3,)), ((4, 1, 3), (6, 3)), ((2, 0, 3), (3,))])
def test_cross_product_has_the_bits_of_numpys(rng, shapes):
    a, b = (rng.choice([0.0, -0.0, 1.0, np.pi, -np.e, 1e-300, 1e150], shape) for shape in shapes)
    product, expected = cross(a, b), np.cross(a, b)
    assert product.shape == expected.shape
    assert product.tobytes() == expected.tobytes()


def test_cardano_matrix_turns_about_x_then_the_new_y_then_the_new_z(rng):
    theta = rng.uniform(-4, 4, (20, 3))
    expected = Rotation.from_euler("XYZ", theta).as_matrix()
    np.testing.assert_allclose(cardano_matrix(theta), expected, rtol=0, atol=10 * EPS)


def test_cardano_angles_invert_the_matrix(rng):
    theta = rng.uniform(-1, 1, (200, 3)) * np.array([np.pi, np.pi / 2 - 0.01, np.pi])
    np.testing.assert_allclose(cardano_angles(cardano_matrix(theta)), theta, rtol=0, atol=1e4 * EPS)  # eps / cos β


@pytest.mark.parametrize("distance", [0.0, 1e-16, 1e-12, 1e-8, 1e-4])
@pytest.mark.parametrize("side", [-1, 1])
def test_cardano_angles_return_the_matrix_in_and_near_gimbal_lock(rng, distance, side):
    alpha, gamma = rng.uniform(-np.pi, np.pi, (2, 50))
    beta = np.full(50, side * (np.pi / 2 - distance))
    rotation = cardano_matrix(np.stack([alpha, beta, gamma], axis=-1))
    np.testing.assert_allclose(cardano_matrix(cardano_angles(rotation)), rotation, rtol=0, atol=10 * EPS)


def test_cardano_angles_in_exact_gimbal_lock():
    """e_3 of the body along the world x axis, to the last bit: sin β = 1, and only α + γ is determined."""
    for upright in (np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 0, -1.0], [0, 1, 0], [1, 0, 0]])):
        theta = cardano_angles(upright)
        assert abs(theta[1]) == np.pi / 2
        np.testing.assert_allclose(cardano_matrix(theta), upright, rtol=0, atol=10 * EPS)


def test_rate_matrix_gives_the_angular_velocity(rng):
    theta, rates = rng.uniform(-1.4, 1.4, (20, 3)), rng.uniform(-2, 2, (20, 3))
    turning = derivative(lambda t: cardano_matrix(theta + t * rates))
    omega = axial(np.swapaxes(cardano_matrix(theta), -1, -2) @ turning)
    assert relative_error((cardano_rate_matrix(theta) @ rates[..., None])[..., 0], omega) < FIRST


def test_rate_matrix_derivative(rng):
    theta, rates = rng.uniform(-3, 3, (20, 3)), rng.uniform(-2, 2, (20, 3))
    numerical = derivative(lambda t: cardano_rate_matrix(theta + t * rates))
    assert relative_error(cardano_rate_matrix_derivative(theta, rates), numerical) < FIRST


def test_cosine_of_beta_is_the_determinant_of_the_rate_matrix(rng):
    theta = rng.uniform(-3, 3, (50, 3))
    determinant = np.linalg.det(cardano_rate_matrix(theta))
    np.testing.assert_allclose(cos_beta(cardano_matrix(theta)), np.abs(determinant), rtol=0, atol=10 * EPS)


def test_cardano_rates_reproduce_the_angular_velocity(robot):
    state = graphdyn.maximal_state(robot, *random_state(robot, 37)[:2])
    omega = (cardano_rate_matrix(state.cardano) @ state.cardano_rates[..., None])[..., 0]
    lock = 1 / cos_beta(state.rotation).min()
    assert relative_error(omega, state.velocity[..., 3:], state.velocity) < IDENTITY * lock
    numerical = derivative(lambda t: cardano_angles(displaced(state, 0 * omega, t * omega).rotation), step=1e-3 / lock)
    assert relative_error(state.cardano_rates, numerical) < FIRST * lock


# Eq. (111) in Cardano coordinates


def far_from_gimbal_lock(model, at_least=0.3):
    """The first of the seeded states in which every body has |cos β| ≥ at_least."""
    for seed in range(2000):
        q, v, tau = random_state(model, seed)
        state = graphdyn.maximal_state(model, q, v)
        if cos_beta(state.rotation).min() >= at_least:
            return q, v, tau, state
    raise AssertionError(f"no state of {model.name} is far from gimbal lock")


def at_coordinates(state, coordinates):
    """The bodies at (r, θ) (n, 6)."""
    return MaximalState(state.model, coordinates[:, :3], cardano_matrix(coordinates[:, 3:]), 0 * state.velocity)


def test_cardano_jacobian_and_zeta_are_derivatives_with_respect_to_position_and_angles(robot):
    q, v, tau, state = far_from_gimbal_lock(robot)
    system = graphdyn.kkt_system(robot, q, v, tau, coordinates="cardano")
    here = np.concatenate([state.position, state.cardano], axis=-1)
    rates = np.concatenate([state.velocity[:, :3], state.cardano_rates], axis=-1)
    acceleration = np.random.default_rng(38).uniform(-2, 2, here.shape)

    def residual(coordinates):
        return at_coordinates(state, coordinates).constraint_residual().ravel()

    columns = [derivative(lambda h, e=e: residual(here + h * e)) for e in np.eye(here.size).reshape(-1, *here.shape)]
    assert relative_error(system.constraint_jacobian, np.stack(columns, axis=-1)) < FIRST

    numerical = second_derivative(lambda t: residual(here + t * rates + t**2 / 2 * acceleration), step=2e-3)
    both = system.constraint_jacobian @ acceleration.ravel() - system.zeta
    assert relative_error(both, numerical, system.zeta) < SECOND_CARDANO


def test_cardano_mass_gives_the_kinetic_energy_and_is_symmetric(robot, rng):
    q, v, tau, state = far_from_gimbal_lock(robot)
    mass = graphdyn.kkt_system(robot, q, v, tau, coordinates="cardano").mass
    rates = rng.normal(size=(robot.n_bodies, 6))
    omega = (cardano_rate_matrix(state.cardano) @ rates[:, 3:, None])[..., 0]
    energy = sum(
        body.mass * r[:3] @ r[:3] + w @ body.inertia @ w for body, r, w in zip(robot.bodies, rates, omega, strict=True)
    )
    assert rates.ravel() @ mass @ rates.ravel() == pytest.approx(energy, rel=IDENTITY)
    assert relative_error(mass, mass.T) < IDENTITY


def test_cardano_form_has_the_same_motion_and_the_same_multipliers_as_the_twist_form(robot):
    q, v, tau, state = far_from_gimbal_lock(robot)
    wrenches = random_wrenches(robot, 39)
    twist = graphdyn.kkt_system(robot, q, v, tau, wrenches).solve()
    cardano = graphdyn.kkt_system(robot, q, v, tau, wrenches, coordinates="cardano").solve()
    f = graphdyn.forward_dynamics(robot, q, v, tau, wrenches)
    d, rates = cardano_rate_matrix(state.cardano), state.cardano_rates
    d_rate = cardano_rate_matrix_derivative(state.cardano, rates)
    second = cardano.acceleration.reshape(-1, 6)
    omega_dot = (d @ second[:, 3:, None] + d_rate @ rates[..., None])[..., 0]  # ω̇ = D θ̈ + Ḋ θ̇
    seen = np.concatenate([second[:, :3], omega_dot], axis=-1)
    lock = np.linalg.cond(d).max() ** 2
    scale = acceleration_scale(graphdyn.mass_matrix(robot, q), f.a, tau, f.joint_wrenches)
    expected = twist.acceleration.reshape(-1, 6)
    assert np.abs(seen - expected).max() < CARDANO * lock * scale
    condition = np.linalg.cond(graphdyn.mass_matrix(robot, q))
    assert relative_error(cardano.multipliers, twist.multipliers, f.joint_wrenches) < CARDANO * lock * condition


def test_gimbal_lock_is_refused_below_its_threshold_and_accepted_above():
    """KR500: body 1 stands upright and turns about the vertical, so that |cos β_1| = |sin q_1|."""
    robot = NAMED["kr500"]
    q, v, tau = random_state(robot, 40)
    q[0] = 1.01e-4
    assert graphdyn.kkt_system(robot, q, v, tau, coordinates="cardano").rank() == 66
    for q[0] in (0.99e-4, -0.99e-4, 0.0):
        with pytest.raises(graphdyn.GimbalLock, match=r"body 'B1' is at \|cos β\| = .*below 0.0001.*'twist'"):
            graphdyn.kkt_system(robot, q, v, tau, coordinates="cardano")
        assert graphdyn.kkt_system(robot, q, v, tau).rank() == 66


def test_the_twist_form_does_not_notice_gimbal_lock():
    robot = NAMED["kr500"]
    q, v, tau = random_state(robot, 41)
    q[0] = 0.0
    f = graphdyn.forward_dynamics(robot, q, v, tau, method="dense")
    fast = graphdyn.forward_dynamics(robot, q, v, tau)
    scale = acceleration_scale(graphdyn.mass_matrix(robot, q), fast.a, tau, fast.joint_wrenches)
    assert np.abs(f.a - fast.a).max() < 10 * EPS * scale


def test_constraint_rows_are_named_as_in_the_paper():
    names = constraint_row_names(6)
    assert len(names) == 30
    assert names[0] == "phi_11"
    assert names[-1] == "phi_65"
    assert constraint_row_names(12)[5 * 10 + 3] == "phi_11,4"  # with two digits a comma keeps joint and row apart
    assert [constraint_row_names(n)[-1] for n in (9, 10)] == ["phi_95", "phi_10,5"]


def test_exponential_of_the_witness_is_the_rotation_of_the_package(rng):
    """The two tools that turn bodies in these tests agree, so that a common error would need two authors."""
    vector = rng.normal(size=(1, 3))
    angle = np.linalg.norm(vector)
    np.testing.assert_allclose(exponential(vector)[0], rotation_about(vector[0] / angle, angle), rtol=0, atol=10 * EPS)
