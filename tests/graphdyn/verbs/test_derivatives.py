"""Derivatives of the dynamics: finite differences, properties of the equations of motion, refusals."""

import functools

import numpy as np
import pytest
from long_check import LONG
from random_trees import NAMED, random_state, random_wrenches
from witnesses import derivative, relative_error

import graphdyn
from graphdyn import BaseMotion, InvalidInput, SingularMassMatrix

DIFFERENCE = 1e-10
"""Sixth-order central differences, relative to the largest derivative and to what is differentiated: measured 5e-12."""

IDENTITY = 1e-13
"""Two sums of the same terms in another order, relative to the largest term: measured 3e-15."""

MOVING = BaseMotion(velocity=[0.1, 0.2, -0.3, 0.5, -0.4, 0.3], acceleration=[1.0, -2.0, 0.5, 0.3, 0.2, -0.7])

ROBOTS = ["kr500", "mixed_chain", "branched"]
"""With turning and sliding joints, in a chain and with branches."""

pytestmark = pytest.mark.usefixtures("interpreted")

robots = pytest.mark.parametrize("model", [NAMED[name] for name in ROBOTS], ids=ROBOTS)
methods = pytest.mark.parametrize("method", ["dense", "projected", "recursive"])
bases = pytest.mark.parametrize("base", [None, MOVING], ids=["fixed", "moving"])


def differences(verb, model, arguments, k, read):
    """∂ read(verb(…)) / ∂ arguments[k], a column per joint."""

    def stepped(t, unit):
        moved = [x + t * unit if i == k else x for i, x in enumerate(arguments)]
        return read(verb(model, *moved))

    columns = [derivative(lambda t, unit=unit: stepped(t, unit)) for unit in np.eye(model.n_bodies)]
    return np.stack(columns, axis=-1)


def differences_of(names, verb, model, arguments, k):
    """The same of several parts of the answer, in the order of their names, from one evaluation for all."""
    here = [np.asarray(getattr(verb(model, *arguments), name)) for name in names]

    def read(found):
        return np.concatenate([np.ravel(getattr(found, name)) for name in names])

    parts = np.split(differences(verb, model, arguments, k, read), np.cumsum([x.size for x in here])[:-1])
    return [part.reshape(*x.shape, -1) for part, x in zip(parts, here, strict=True)]


@functools.cache
def inverse_dynamics_and_differences(model, base):
    """State and loads, the answer there, and its differences by q, v and a, for all methods."""
    state, wrenches = random_state(model, 3), random_wrenches(model, 4)

    def verb(*arguments):
        return graphdyn.inverse_dynamics(*arguments, wrenches, base=base)

    names = ("tau", "multipliers", "joint_wrenches")
    return state, wrenches, verb(model, *state), [differences_of(names, verb, model, state, k) for k in range(3)]


@functools.cache
def forward_dynamics_and_differences(model, base):
    state, wrenches = random_state(model, 5), random_wrenches(model, 6)

    def verb(*arguments):
        return graphdyn.forward_dynamics(*arguments, wrenches, base=base)

    return state, wrenches, verb(model, *state), [differences_of(["a"], verb, model, state, k) for k in range(3)]


@robots
@methods
@bases
def test_of_inverse_dynamics(model, method, base):
    state, wrenches, here, expected = inverse_dynamics_and_differences(model, base)
    found = graphdyn.inverse_dynamics_derivatives(model, *state, wrenches, base=base, method=method)
    reactions = graphdyn.reaction_derivatives(model, *state, wrenches, base=base, method=method)
    for by, differences_by in zip("qva", expected, strict=True):
        answers = (
            getattr(found, f"dtau_d{by}"),
            getattr(reactions, f"dmultipliers_d{by}"),
            getattr(reactions, f"dwrenches_d{by}"),
        )
        for answer, difference in zip(answers, differences_by, strict=True):
            assert relative_error(answer, difference, here.joint_wrenches) < DIFFERENCE


@functools.cache
def first_derivatives_and_differences(model, base):
    state, wrenches = random_state(model, 12), random_wrenches(model, 13)

    def first(*arguments):
        return graphdyn.inverse_dynamics_derivatives(*arguments, wrenches, base=base, method="recursive")

    by_q = differences_of(["dtau_dq", "dtau_dv", "dtau_da"], first, model, state, 0)
    by_v = differences_of(["dtau_dv"], first, model, state, 1)
    return state, wrenches, first(model, *state), by_q, by_v


@pytest.mark.parametrize(
    "model",
    [pytest.param(NAMED[name], id=name, marks=[LONG] * (name != "branched")) for name in ROBOTS],
)
@pytest.mark.parametrize("method", ["projected", "recursive"])
@bases
def test_second_ones_of_inverse_dynamics(model, method, base):
    state, wrenches, here, by_q, by_v = first_derivatives_and_differences(model, base)
    found = graphdyn.inverse_dynamics_second_derivatives(model, *state, wrenches, base=base, method=method)
    for answer, expected, value in (
        (found.d2tau_dqdq, by_q[0], here.dtau_dq),
        (found.d2tau_dqdv, by_q[1], here.dtau_dv),
        (found.d2tau_dqda, by_q[2], here.dtau_da),
        (found.d2tau_dvdv, by_v[0], here.dtau_dv),
    ):
        assert relative_error(answer, np.swapaxes(expected, -1, -2), value) < DIFFERENCE
    for symmetric in (found.d2tau_dqdq, found.d2tau_dvdv):
        assert relative_error(symmetric, np.swapaxes(symmetric, -1, -2)) < IDENTITY


@robots
@methods
def test_the_hessian_of_the_potential_energy_is_symmetric(model, method):
    q, v, _ = random_state(model, 14, (3,))
    hessian = graphdyn.inverse_dynamics_derivatives(model, q, 0 * v, 0 * v, method=method).dtau_dq
    wrenches = graphdyn.inverse_dynamics(model, q, 0 * v, 0 * v).joint_wrenches
    assert relative_error(hessian, np.swapaxes(hessian, -1, -2), wrenches) < IDENTITY


@robots
@methods
@bases
def test_of_forward_dynamics(model, method, base):
    state, wrenches, here, expected = forward_dynamics_and_differences(model, base)
    found = graphdyn.forward_dynamics_derivatives(model, *state, wrenches, base=base, method=method)
    for by, (difference,) in zip(("q", "v", "tau"), expected, strict=True):
        assert relative_error(getattr(found, f"da_d{by}"), difference, here.a) < DIFFERENCE


@robots
@methods
def test_forward_and_inverse_belong_together(model, method):
    """Along a = FD(q, v, τ): ∂τ/∂q + M ∂a/∂q = 0, likewise in v, and M ∂a/∂τ = E."""
    q, v, tau = random_state(model, 7, (3,))
    a = graphdyn.joint_accelerations(model, q, v, tau)
    forward = graphdyn.forward_dynamics_derivatives(model, q, v, tau, method=method)
    inverse = graphdyn.inverse_dynamics_derivatives(model, q, v, a, method=method)
    mass, condition = graphdyn.mass_matrix(model, q), np.linalg.cond(graphdyn.mass_matrix(model, q)).max()
    assert relative_error(inverse.dtau_da, mass) < IDENTITY
    assert relative_error(mass @ forward.da_dq, -inverse.dtau_dq) < IDENTITY * condition
    assert relative_error(mass @ forward.da_dv, -inverse.dtau_dv) < IDENTITY * condition
    unit = np.broadcast_to(np.eye(model.n_bodies), mass.shape)
    assert relative_error(mass @ forward.da_dtau, unit) < IDENTITY * condition
    assert relative_error(mass @ graphdyn.mass_matrix_inverse(model, q, method=method), unit) < IDENTITY * condition


@robots
@methods
def test_coriolis_matrix(model, method):
    """C v is what velocities add to the bias torque, and Ṁ - 2C is skew along q̇ = v."""
    q, v, _ = random_state(model, 8)
    c = graphdyn.coriolis_matrix(model, q, v, method=method)
    bias, gravity = graphdyn.bias_torque(model, q, v), graphdyn.gravity_torque(model, q)
    wrenches = graphdyn.inverse_dynamics(model, q, v, 0 * v).joint_wrenches
    assert relative_error(c @ v, bias - gravity, wrenches) < IDENTITY
    rate = derivative(lambda t: graphdyn.mass_matrix(model, q + t * v))
    assert relative_error(c + c.T, rate, graphdyn.mass_matrix(model, q)) < DIFFERENCE


@robots
@methods
def test_power_is_what_the_energies_gain(model, method):
    """d(T + U)/dt = τ·v."""
    q, v, a = random_state(model, 9)

    def energy(t):
        position, velocity = q + v * t + a * t**2 / 2, v + a * t
        kinetic = graphdyn.kinetic_energy(model, position, velocity, method=method)
        return kinetic + graphdyn.potential_energy(model, position, method=method)

    tau = graphdyn.joint_torques(model, q, v, a)
    assert relative_error(derivative(energy), tau @ v, energy(0.0), tau) < DIFFERENCE


@robots
@methods
def test_kinetic_energy_is_half_of_the_momentum_times_the_velocity(model, method):
    q, v, _ = random_state(model, 10, (3,))
    found = graphdyn.kinetic_energy(model, q, v, method=method)
    expected = np.einsum("ki,kij,kj->k", v, graphdyn.mass_matrix(model, q), v) / 2
    assert relative_error(found, expected) < IDENTITY


@robots
@methods
def test_the_gradient_of_the_potential_energy_is_the_gravity_torque(model, method):
    q, _, _ = random_state(model, 11)
    gradient = differences(graphdyn.potential_energy, model, (q,), 0, lambda x: x)
    found = graphdyn.gravity_torque(model, q, method=method)
    assert relative_error(found, gradient, graphdyn.potential_energy(model, q)) < DIFFERENCE


def test_one_link():
    """A rod of mass m, length l, hinged about y: M = m l²/3, U = -m g·r, ∂τ/∂q = -m g l/2 sin q, no C."""
    m, length, g = 2.0, 0.6, 9.81
    tensor = np.diag([0.0, 1.0, 1.0]) * m * length**2 / 12
    rod = graphdyn.Body("rod", m, [length / 2, 0, 0], tensor)
    hinge = graphdyn.Joint("hinge", "revolute", 0, graphdyn.Placement(), [0, -1, 0])
    model = graphdyn.RobotModel("pendulum", (rod,), (hinge,), gravity=[0, 0, -g])
    q, v = np.array([0.7]), np.array([1.3])
    for method in ("dense", "projected", "recursive"):
        found = graphdyn.inverse_dynamics_derivatives(model, q, v, [2.0], method=method)
        assert found.dtau_dq.item() == pytest.approx(-m * g * length / 2 * np.sin(0.7))
        assert abs(found.dtau_dv.item()) < IDENTITY
        assert found.dtau_da.item() == pytest.approx(m * length**2 / 3)
        assert graphdyn.mass_matrix_inverse(model, q, method=method).item() == pytest.approx(3 / (m * length**2))
        assert abs(graphdyn.coriolis_matrix(model, q, v, method=method).item()) < IDENTITY
        kinetic = graphdyn.kinetic_energy(model, q, v, method=method)
        assert kinetic.item() == pytest.approx(m * length**2 / 6 * 1.3**2)
        potential = graphdyn.potential_energy(model, q, method=method)
        assert potential.item() == pytest.approx(m * g * length / 2 * np.sin(0.7))


@methods
def test_energies_of_a_robot_that_is_carried(method):
    """The whole robot thrown: T of a rigid body, and U of its height."""
    model = NAMED["kr500"]
    q = random_state(model, 12)[0]
    thrown = BaseMotion(translation=[0, 0, 3.0], velocity=[2.0, 0, 0, 0, 0, 0])
    mass = sum(body.mass for body in model.bodies)
    assert graphdyn.kinetic_energy(model, q, 0 * q, base=thrown, method=method) == pytest.approx(mass * 2.0)
    higher = graphdyn.potential_energy(model, q, base=thrown, method=method)
    gained = higher - graphdyn.potential_energy(model, q, method=method)
    assert gained == pytest.approx(mass * np.linalg.norm(model.gravity) * 3.0)


@pytest.mark.parametrize("moving", [{"velocity": MOVING.velocity}, {"acceleration": MOVING.acceleration}])
def test_coriolis_matrix_on_a_base_that_moves_is_refused(moving):
    q = np.zeros(6)
    with pytest.raises(InvalidInput, match="coriolis_matrix takes a base at rest: C v is not what a moving base adds"):
        graphdyn.coriolis_matrix(NAMED["kr500"], q, q, base=BaseMotion(**moving))
    placed = BaseMotion(translation=[1.0, 2.0, 3.0])
    assert not graphdyn.coriolis_matrix(NAMED["kr500"], q, q, base=placed).any()


@methods
@pytest.mark.parametrize("verb", ["forward_dynamics_derivatives", "mass_matrix_inverse"])
def test_singular_mass_matrices_are_refused(method, verb):
    model = NAMED["kr500"].with_inertial_parameters(np.zeros(60))
    count = 3 if verb == "forward_dynamics_derivatives" else 1
    with pytest.raises(SingularMassMatrix, match="the mass matrix of robot 'kr500' is singular"):
        getattr(graphdyn, verb)(model, *[np.zeros((2, 6))] * count, method=method)


def test_small_pivots_are_solved_by_the_plain_form():
    """Of a body with negative inertia, which identification without constraints produces."""
    parameters = NAMED["mixed_chain"].inertial_parameters.reshape(4, 10).copy()
    parameters[3, 4:] = [-0.5, 0.0, -0.5, 0.0, 0.0, -0.5]
    odd = NAMED["mixed_chain"].with_inertial_parameters(parameters.ravel())
    state = random_state(odd, 13, (2,))
    found = graphdyn.forward_dynamics_derivatives(odd, *state, method="recursive")
    plain = graphdyn.forward_dynamics_derivatives(odd, *state, method="projected")
    for name in ("da_dq", "da_dv", "da_dtau"):
        assert np.array_equal(getattr(found, name), getattr(plain, name))
