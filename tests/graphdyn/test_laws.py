"""Laws of mechanics that hold for every robot, judged without any other implementation."""

import numpy as np
import pytest
from long_check import LONG
from random_trees import NAMED, random_rotation, random_state, random_tree, random_wrenches
from witnesses import (
    acceleration_scale,
    derivative,
    kinetic_energy,
    masses,
    momenta,
    origins,
    outside_of,
    potential_energy,
    relative_error,
    twists_at_origins,
    world_wrenches,
)

import graphdyn
from graphdyn import Body, Joint, Placement, RobotModel

EPS = np.finfo(float).eps

ENERGY_DRIFT = 2e-8
"""RK4 over 0.2 s, part of the energy exchanged: measured 4.9e-9 with 100 steps for the KR500, falling 16-fold with half
the step."""

DIFFERENCE = 1e-11
"""Sixth-order central differences of energy, momentum and M, relative to the largest term: measured 7.3e-13."""

IDENTITY = 1e-13
"""Two sums of the same terms in another order, relative to the largest term: measured 2.9e-15."""

ACCELERATION = 10 * EPS
"""Times what one eps of rounding in M, τ and the wrenches does to the accelerations (acceleration_scale)."""


def simulate(model, q, v, tau, method, steps, step):
    """Runge-Kutta of fourth order on q̇ = v, v̇ = forward_dynamics; yields every state."""

    def rate(x):
        return np.concatenate([x[n:], graphdyn.forward_dynamics(model, x[:n], x[n:], tau, method=method).a])

    n, x = model.n_bodies, np.concatenate([q, v])
    for _ in range(steps):
        yield x[:n], x[n:]
        k1 = rate(x)
        k2 = rate(x + step / 2 * k1)
        k3 = rate(x + step / 2 * k2)
        k4 = rate(x + step * k3)
        x = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    yield x[:n], x[n:]


@pytest.mark.parametrize(
    "method",
    ["projected", "dense", "recursive, compiled", pytest.param("recursive, NumPy", marks=LONG)],
    indirect=True,
)
@pytest.mark.parametrize("name", [pytest.param("kr500", marks=LONG), "mixed_chain"])
def test_energy_is_conserved_along_a_free_motion(name, method):
    model = NAMED[name]
    q, v, _ = random_state(model, 1)
    steps = 100 if name == "kr500" else 50
    trajectory = list(simulate(model, q, v, np.zeros(model.n_bodies), method, steps=steps, step=0.2 / steps))
    kinetic = np.array([kinetic_energy(model, *state) for state in trajectory])
    potential = np.array([potential_energy(model, q) for q, _ in trajectory])
    total = kinetic + potential
    exchanged = np.ptp(kinetic)
    assert exchanged > 0.05 * kinetic.max()  # otherwise nothing was tested
    assert np.ptp(total) / exchanged < ENERGY_DRIFT


def path_of(q, v, a):
    """q(t), v(t) of the motion with constant a: its accelerations at t = 0 are a."""
    return lambda t: (q + v * t + a * t**2 / 2, v + a * t)


def test_power_of_actuators_and_external_wrenches_changes_the_energy(robot, method):
    q, v, tau = random_state(robot, 2)
    wrenches = random_wrenches(robot, 3)
    a = graphdyn.forward_dynamics(robot, q, v, tau, wrenches, method=method).a
    motion = path_of(q, v, a)
    kinetic = derivative(lambda t: kinetic_energy(robot, *motion(t)))
    potential = derivative(lambda t: potential_energy(robot, motion(t)[0]))
    supplied = tau @ v + np.sum(wrenches * twists_at_origins(graphdyn.maximal_state(robot, q, v)))
    energy = kinetic_energy(robot, q, v), potential_energy(robot, q)
    assert relative_error(kinetic + potential, supplied, kinetic, potential, *energy) < DIFFERENCE


def test_wrench_in_a_joint_balances_the_momentum_of_everything_outside_it(robot, method):
    """For a root joint this is the reaction of the ground; angular momentum is taken about the world origin."""
    q, v, tau = random_state(robot, 4)
    wrenches = random_wrenches(robot, 5)
    f = graphdyn.forward_dynamics(robot, q, v, tau, wrenches, method=method)
    motion = path_of(q, v, f.a)
    rates = derivative(lambda t: momenta(robot, *motion(t)))
    state = graphdyn.maximal_state(robot, q, v)
    weights = masses(robot)[:, None] * robot.gravity
    weights = np.concatenate([weights, np.cross(state.position, weights)], axis=-1)

    def about_world_origin(at_origins):
        w = world_wrenches(state, at_origins)
        return np.concatenate([w[:, :3], w[:, 3:] + np.cross(origins(state), w[:, :3])], axis=-1)

    reactions, applied = about_world_origin(f.joint_wrenches), about_world_origin(wrenches)
    size = momenta(robot, q, v)
    for j in range(1, robot.n_bodies + 1):
        outside = [k - 1 for k in outside_of(robot, j)]
        change = rates[outside].sum(axis=0)
        acting = reactions[j - 1] + (weights + applied)[outside].sum(axis=0)
        for part in (slice(0, 3), slice(3, 6)):
            terms = rates[:, part], reactions[:, part], weights[:, part], size[:, part]
            assert relative_error(acting[part], change[part], *terms) < DIFFERENCE, f"joint {j}"


def free_body(body, gravity):
    """One body on three slides and a spherical wrist of massless carriers: nothing holds it."""
    nothing = [Body(f"carrier{k}", 0.0, np.zeros(3), np.zeros((3, 3))) for k in range(1, 6)]
    kinds = ["prismatic"] * 3 + ["revolute"] * 3
    joints = [
        Joint(f"joint{k}", kind, k, Placement(), axis)
        for k, (kind, axis) in enumerate(zip(kinds, [*np.eye(3), *np.eye(3)], strict=True))
    ]
    return RobotModel("free body", (*nothing, body), tuple(joints), gravity=np.asarray(gravity))


def test_free_body_falls_with_gravity_and_keeps_its_angular_momentum(method):
    body = NAMED["mixed_chain"].bodies[0]
    model = free_body(body, (1.0, -2.0, -9.0))
    q, v, _ = random_state(model, 6)
    q[4] = 0.4  # away from the singular pose of the wrist
    f = graphdyn.forward_dynamics(model, q, v, np.zeros(6), method=method)
    state = graphdyn.maximal_state(model, q, v)
    spin = body.inertia @ state.velocity[-1, 3:]
    gyroscopic = np.cross(state.velocity[-1, 3:], spin)
    assert relative_error(f.body_accelerations[-1, :3], model.gravity) < IDENTITY * np.linalg.cond(
        graphdyn.mass_matrix(model, q)
    )
    assert relative_error(body.inertia @ f.body_accelerations[-1, 3:], -gyroscopic, spin) < IDENTITY * np.linalg.cond(
        graphdyn.mass_matrix(model, q)
    )


@pytest.mark.usefixtures("default_method")
def test_mass_matrix_is_what_inverse_dynamics_multiplies_the_accelerations_with(robot):
    """Columns from the dense form, which never symmetrizes: so M is symmetric by mechanics."""
    q, v, _ = random_state(robot, 7)
    unit = np.eye(robot.n_bodies)
    at_rest = graphdyn.inverse_dynamics(robot, q, v, 0 * unit, method="dense")
    moved = graphdyn.inverse_dynamics(robot, q, v, unit, method="dense")
    columns = (moved.tau - at_rest.tau).T
    size = moved.joint_wrenches
    assert relative_error(columns, columns.T, size) < IDENTITY
    assert relative_error(graphdyn.mass_matrix(robot, q), columns, size) < IDENTITY


@pytest.mark.usefixtures("default_method")
def test_mass_matrix_gives_the_kinetic_energy_and_is_positive_definite(robot):
    q, v, _ = random_state(robot, 8, size=(20,))
    m = graphdyn.mass_matrix(robot, q)
    energy = np.einsum("ki,kij,kj->k", v, m, v) / 2
    np.testing.assert_allclose(energy, kinetic_energy(robot, q, v), rtol=IDENTITY)
    assert np.all(np.linalg.eigvalsh(m)[:, 0] > 0)


def mass_matrix_derivatives(model, q):
    """∂M/∂q_k (n, n, n), first index k."""
    return np.stack([derivative(lambda t, e=e: graphdyn.mass_matrix(model, q + t * e)) for e in np.eye(model.n_bodies)])


@pytest.mark.usefixtures("default_method")
def test_bias_torque_is_christoffel_symbols_plus_gradient_of_the_potential(robot):
    q, v, _ = random_state(robot, 9)
    dm = mass_matrix_derivatives(robot, q)
    # Γ_ijk = ½ (∂M_ij/∂q_k + ∂M_ik/∂q_j - ∂M_jk/∂q_i)
    christoffel = (np.einsum("kij->ijk", dm) + np.einsum("jik->ijk", dm) - dm) / 2
    coriolis = np.einsum("ijk,j,k->i", christoffel, v, v)
    gravity = np.array([derivative(lambda t, e=e: potential_energy(robot, q + t * e)) for e in np.eye(robot.n_bodies)])
    h = graphdyn.bias_torque(robot, q, v)
    size = graphdyn.inverse_dynamics(robot, q, v, 0 * v).joint_wrenches
    assert relative_error(h, coriolis + gravity, size, potential_energy(robot, q)) < DIFFERENCE
    assert relative_error(graphdyn.bias_torque(robot, q, 0 * v), gravity, size, potential_energy(robot, q)) < DIFFERENCE


@pytest.mark.usefixtures("default_method")
def test_mass_matrix_rate_minus_twice_coriolis_is_skew(robot):
    """C from the bias torque by polarization, Ṁ by differences: neither is skew by construction."""
    q, v, _ = random_state(robot, 10)
    unit = np.eye(robot.n_bodies)
    c = ((graphdyn.bias_torque(robot, q, v + unit) - graphdyn.bias_torque(robot, q, v - unit)) / 4).T
    m_rate = derivative(lambda t: graphdyn.mass_matrix(robot, q + t * v))
    difference = m_rate - 2 * c
    size = graphdyn.inverse_dynamics(robot, q, v, 0 * v).joint_wrenches
    assert relative_error(difference, -difference.T, m_rate, c, size, graphdyn.mass_matrix(robot, q)) < DIFFERENCE


@pytest.mark.usefixtures("default_method")
def test_torque_is_linear_in_the_inertial_parameters(robot, rng):
    q, v, a = random_state(robot, 11, size=(4,))
    parameters = rng.normal(size=10 * robot.n_bodies)
    parameters[::10] = np.abs(parameters[::10])  # masses
    other = robot.with_inertial_parameters(parameters)
    i = graphdyn.inverse_dynamics(other, q, v, a)
    predicted = graphdyn.joint_torque_regressor(robot, q, v, a) @ parameters
    assert relative_error(predicted, i.tau, i.joint_wrenches) < IDENTITY


@pytest.mark.usefixtures("default_method")
def test_body_regressors_sum_to_the_wrenches_in_the_joints(robot):
    q, v, a = random_state(robot, 12)
    y = graphdyn.body_regressor(robot, q, v, a)
    needed = np.einsum("iwp,ip->iw", y, robot.inertial_parameters.reshape(-1, 10))
    state = graphdyn.maximal_state(robot, q, v)
    needed, points = world_wrenches(state, needed), origins(state)
    actual = world_wrenches(state, graphdyn.inverse_dynamics(robot, q, v, a).joint_wrenches)
    for j in range(1, robot.n_bodies + 1):
        outside = [k - 1 for k in outside_of(robot, j)]
        force = needed[outside, :3].sum(axis=0)
        moment = (needed[:, 3:] + np.cross(points - points[j - 1], needed[:, :3]))[outside].sum(axis=0)
        assert relative_error(actual[j - 1], np.concatenate([force, moment]), needed) < IDENTITY


@pytest.mark.usefixtures("default_method")
def test_torques_superpose(robot):
    """Linear in the accelerations, in gravity and in the external wrenches; quadratic in the velocities."""
    q, v, a = random_state(robot, 13)
    _, _, b = random_state(robot, 14)
    w, zero = random_wrenches(robot, 15), 0 * v
    weightless = robot.with_gravity(np.zeros(3))

    def tau(model, velocity, acceleration, wrenches=None):
        return graphdyn.inverse_dynamics(model, q, velocity, acceleration, wrenches).tau

    everything = graphdyn.inverse_dynamics(robot, q, v, a, w)
    size = everything.joint_wrenches, graphdyn.inverse_dynamics(robot, q, v, a).joint_wrenches
    parts = (
        tau(weightless, zero, a) + tau(weightless, v, zero) + tau(robot, zero, zero) + tau(weightless, zero, zero, w)
    )
    assert relative_error(everything.tau, parts, *size) < IDENTITY
    assert (
        relative_error(tau(weightless, zero, a - 2 * b), tau(weightless, zero, a) - 2 * tau(weightless, zero, b), *size)
        < IDENTITY
    )
    assert relative_error(tau(weightless, -3 * v, zero), 9 * tau(weightless, v, zero), *size) < IDENTITY
    doubled = robot.with_gravity(2 * robot.gravity)
    assert relative_error(tau(doubled, zero, zero), 2 * tau(robot, zero, zero), *size) < IDENTITY
    assert relative_error(tau(weightless, zero, zero, 2 * w), 2 * tau(weightless, zero, zero, w), *size) < IDENTITY


@pytest.mark.usefixtures("default_method")
def test_base_and_gravity_turned_together_change_nothing_that_the_robot_feels(robot, rng):
    q, v, tau = random_state(robot, 16)
    wrenches, turn = random_wrenches(robot, 17), random_rotation(rng)
    turned = robot.with_gravity(turn @ robot.gravity).with_base(Placement(turn, rng.normal(size=3)) @ robot.base)
    one, two = (graphdyn.forward_dynamics(model, q, v, tau, wrenches) for model in (robot, turned))
    m = graphdyn.mass_matrix(robot, q)
    scale = acceleration_scale(m, one.a, tau, one.joint_wrenches)
    assert relative_error(graphdyn.mass_matrix(turned, q), m) < IDENTITY
    assert np.abs(two.a - one.a).max() < ACCELERATION * scale
    assert relative_error(two.joint_wrenches, one.joint_wrenches) < IDENTITY * np.linalg.cond(m)
    for j, joint in enumerate(robot.joints):
        expected = one.multipliers[j].copy()
        if not joint.is_prismatic:
            expected[:3] = turn @ expected[:3]  # world axes; the moments are about axes that turn with the robot
        assert relative_error(two.multipliers[j], expected, one.multipliers) < IDENTITY * np.linalg.cond(m)


@pytest.mark.usefixtures("default_method")
@pytest.mark.parametrize("speed", [0.0, 3.0])
def test_accelerated_base_is_a_change_of_gravity_and_uniform_motion_is_none(robot, rng, speed):
    """The base rides on a slide: acceleration s along d acts as gravity g - s d; a constant speed as nothing."""
    direction, thrust = rng.normal(size=3), 4.0
    direction /= np.linalg.norm(direction)
    base_motion = NAMED["one_prismatic"].bodies[0]
    slide = Joint("slide", "prismatic", 0, Placement(), direction)
    joints = [slide] + [
        Joint(j.name, j.kind, j.inside + 1, robot.base @ j.placement if j.inside == 0 else j.placement, j.axis)
        for j in robot.joints
    ]
    bodies = [Body("base_motion", base_motion.mass, base_motion.center_of_mass, base_motion.inertia), *robot.bodies]
    riding = RobotModel("riding", tuple(bodies), tuple(joints), gravity=robot.gravity)
    q, v, a = random_state(robot, 18)
    ridden = graphdyn.inverse_dynamics(riding, np.r_[0.7, q], np.r_[speed, v], np.r_[thrust, a])
    standing = graphdyn.inverse_dynamics(robot.with_gravity(robot.gravity - thrust * direction), q, v, a)
    size = standing.joint_wrenches
    assert relative_error(ridden.tau[1:], standing.tau, size) < IDENTITY
    assert relative_error(ridden.joint_wrenches[1:], size) < IDENTITY
    assert relative_error(ridden.multipliers[1:], standing.multipliers, size) < IDENTITY


@pytest.mark.usefixtures("default_method")
def test_actio_and_reactio_cancel_in_the_sum_over_all_bodies(robot):
    """Joint forces are internal: on each body inside joint minus outside joints make the accelerations."""
    q, v, tau = random_state(robot, 19)
    f = graphdyn.forward_dynamics(robot, q, v, tau)
    forces = world_wrenches(graphdyn.maximal_state(robot, q, v), f.joint_wrenches)[:, :3]
    needed = masses(robot)[:, None] * (f.body_accelerations[:, :3] - robot.gravity)
    net = -robot.graph.incidence() @ forces  # Eq. (14)
    assert relative_error(net, needed, forces) < IDENTITY


@pytest.mark.usefixtures("default_method")
def test_trees_on_the_same_ground_do_not_feel_each_other():
    pair = random_tree(20, [0, 1, 0, 3], ["revolute", "prismatic", "revolute", "revolute"])
    alone = RobotModel("alone", pair.bodies[:2], pair.joints[:2], gravity=pair.gravity, base=pair.base)
    q, v, tau = random_state(pair, 21)
    both = graphdyn.forward_dynamics(pair, q, v, tau)
    one = graphdyn.forward_dynamics(alone, q[:2], v[:2], tau[:2])
    m = graphdyn.mass_matrix(pair, q)
    assert np.all(m[:2, 2:] == 0)
    assert relative_error(both.a[:2], one.a) < IDENTITY * np.linalg.cond(m)
    assert relative_error(both.joint_wrenches[:2], one.joint_wrenches) < IDENTITY * np.linalg.cond(m)
