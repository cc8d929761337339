"""Energies, momenta and accelerations as functions of the inertial parameters."""

import numpy as np
import pytest
from random_trees import NAMED, random_state, random_wrenches
from witnesses import derivative, relative_error

import graphdyn
from graphdyn import BaseMotion, Placement, SingularMassMatrix
from graphdyn.layout import BODY_PARAMETERS
from graphdyn.model.spatial import rotation_about

DIFFERENCE = 1e-10
"""Sixth-order central differences, relative to the largest derivative and to what is differentiated: measured 2e-12."""

IDENTITY = 1e-13
"""Two sums of the same terms in another order, relative to the largest term: measured 3e-15. Times cond(M) where M is
solved for."""

ROBOTS = ["kr500", "mixed_chain", "branched"]
"""With turning and sliding joints, in a chain and with branches."""

MOVING = BaseMotion(
    translation=[0.5, 1.0, -2.0],
    velocity=[0.1, 0.2, -0.3, 0.5, -0.4, 0.3],
    acceleration=[1.0, -2.0, 0.5, 0.3, 0.2, -0.7],
)

pytestmark = pytest.mark.usefixtures("interpreted")

robots = pytest.mark.parametrize("model", [NAMED[name] for name in ROBOTS], ids=ROBOTS)
methods = pytest.mark.parametrize("method", ["dense", "projected", "recursive"])
bases = pytest.mark.parametrize("base", [None, MOVING], ids=["fixed", "moving"])


@robots
@methods
@bases
def test_energies_are_linear_in_the_parameters(model, method, base):
    """Wherever the robot stands; the potential is that of heights above the world's origin."""
    q, v, _ = random_state(model, 1, (3,))
    model = model.with_base(Placement(rotation_about([0.6, 0.0, 0.8], 0.7), [0.3, -0.2, 1.5]))
    columns = graphdyn.energy_regressor(model, q, v, base=base, method=method)
    kinetic = columns.kinetic @ model.inertial_parameters
    potential = columns.potential @ model.inertial_parameters
    terms = columns.potential * model.inertial_parameters
    assert relative_error(kinetic, graphdyn.kinetic_energy(model, q, v, base=base)) < IDENTITY
    assert relative_error(potential, graphdyn.potential_energy(model, q, base=base), terms) < IDENTITY
    masses = [body.mass for body in model.bodies]
    heights = graphdyn.maximal_state(model, q, base=base, method="projected").position @ model.gravity
    assert relative_error(potential, -heights @ masses, terms) < IDENTITY


@robots
@methods
@bases
def test_joint_momenta_are_linear_in_the_parameters(model, method, base):
    q, v, _ = random_state(model, 2, (3,))
    found = graphdyn.momentum_regressor(model, q, v, base=base, method=method) @ model.inertial_parameters
    mass = graphdyn.mass_matrix(model, q)
    assert relative_error(found, np.einsum("kij,kj->ki", mass, v), mass) < IDENTITY


@robots
@methods
def test_identification_without_accelerations(model, method):
    """d(∂T/∂v)/dt = τ + ∂T/∂q - ∂U/∂q, every term a column of the regressors times the parameters."""
    q, v, a = random_state(model, 3)
    pi = model.inertial_parameters

    def momentum(t):
        there = q + v * t + a * t**2 / 2
        return graphdyn.momentum_regressor(model, there, v + a * t, method=method) @ pi

    def lagrangian(q):
        columns = graphdyn.energy_regressor(model, q, v, method=method)
        return (columns.kinetic - columns.potential) @ pi

    gradient = np.array([derivative(lambda t, unit=unit: lagrangian(q + t * unit)) for unit in np.eye(model.n_bodies)])
    tau = graphdyn.joint_torques(model, q, v, a)
    assert relative_error(derivative(momentum), tau + gradient, tau, momentum(0.0), lagrangian(q)) < DIFFERENCE


@robots
@methods
@bases
def test_accelerations_as_parameters_change(model, method, base):
    """Along a random change of all parameters; M ∂a/∂π = -W; and W π is the torque without the external wrenches."""
    q, v, tau = random_state(model, 4)
    wrenches = random_wrenches(model, 5)
    found = graphdyn.forward_dynamics_parameter_derivatives(model, q, v, tau, wrenches, base=base, method=method)
    pi = model.inertial_parameters
    change = np.random.default_rng(6).uniform(-1, 1, pi.size) * np.abs(pi)

    def accelerations(t):
        return graphdyn.joint_accelerations(
            model.with_inertial_parameters(pi + t * change), q, v, tau, wrenches, base=base
        )

    a = accelerations(0.0)
    assert relative_error(found @ change, derivative(accelerations), a) < DIFFERENCE
    mass = graphdyn.mass_matrix(model, q)
    w = graphdyn.joint_torque_regressor(model, q, v, a, base=base)
    assert relative_error(mass @ found, -w) < IDENTITY * np.linalg.cond(mass)
    torque, terms = graphdyn.joint_torques(model, q, v, a, base=base), mass @ (found * pi)
    assert relative_error(mass @ found @ pi, -torque, terms) < IDENTITY * np.linalg.cond(mass)


@methods
def test_one_link(method):
    """A link hinged about z, gravity along -y: I_zz a = τ - g (mc_x cos q - mc_y sin q), T = ½ I_zz q̇², L = I_zz q̇."""
    g, angle, rate, tau = 9.81, 0.7, 1.3, 2.0
    link = graphdyn.Body.from_parameters("link", [2.0, 0.6, 0.1, 0, 0.5, 0, 0.5, 0, 0, 0.4])
    hinge = graphdyn.Joint("hinge", "revolute", 0, graphdyn.Placement(), [0, 0, 1])
    model = graphdyn.RobotModel("pendulum", (link,), (hinge,), gravity=[0, -g, 0])
    c, s = np.cos(angle), np.sin(angle)
    a = (tau - g * (0.6 * c - 0.1 * s)) / 0.4

    def columns(**values):
        places = {"mc_x": 1, "mc_y": 2, "I_zz": 9}
        row = np.zeros(BODY_PARAMETERS)
        for name, value in values.items():
            row[places[name]] = value
        return pytest.approx(row)

    found = graphdyn.forward_dynamics_parameter_derivatives(model, [angle], [rate], [tau], method=method)
    assert found[0] == columns(mc_x=-g * c / 0.4, mc_y=g * s / 0.4, I_zz=-a / 0.4)
    energies = graphdyn.energy_regressor(model, [angle], [rate], method=method)
    assert energies.kinetic == columns(I_zz=rate**2 / 2)
    assert energies.potential == columns(mc_x=g * s, mc_y=g * c)
    assert graphdyn.momentum_regressor(model, [angle], [rate], method=method)[0] == columns(I_zz=rate)


@methods
def test_singular_mass_matrices_are_refused(method):
    model = NAMED["one_revolute"].with_inertial_parameters(np.zeros(BODY_PARAMETERS))
    with pytest.raises(SingularMassMatrix, match="the mass matrix of robot 'tree1' is singular"):
        graphdyn.forward_dynamics_parameter_derivatives(model, *np.zeros((3, 1)), method=method)
