"""Center of mass and momentum of all bodies together: what they are, and what changes them."""

import numpy as np
import pytest
from random_trees import NAMED, random_rotation, random_state, random_wrenches
from scipy.spatial.transform import Rotation
from witnesses import derivative, masses, momenta, origins, relative_error, world_wrenches

import graphdyn
from graphdyn import BaseMotion, InvalidInput, Placement
from graphdyn.equations import body_sums
from graphdyn.equations.complex_steps import COMPLEX_STEP_SIZE
from graphdyn.equations.specification import Arguments

DIFFERENCE = 1e-11
"""Sixth-order central differences, relative to the largest term: measured 2e-13."""

IDENTITY = 1e-13
"""Two sums of the same terms in another order, relative to the largest term: measured 9e-16."""

ROBOTS = ["kr500", "mixed_chain", "branched"]
"""With turning and sliding joints, in a chain and with branches, two of them on the ground."""

VERBS = ("center_of_mass", "center_of_mass_velocity", "center_of_mass_jacobian", "momentum", "centroidal_map")

pytestmark = pytest.mark.usefixtures("interpreted")

robots = pytest.mark.parametrize("model", [NAMED[name] for name in ROBOTS], ids=ROBOTS)
methods = pytest.mark.parametrize("method", ["dense", "projected", "recursive"])


def base_at(t):
    """A moving base that moves, turns and accelerates; at t = 0 its velocity and acceleration are those of its
    motion."""
    shift, turn = np.array([0.3, -2.0, 1.0]), Rotation.from_rotvec([0.4, -0.7, 1.1])
    velocity, acceleration = np.array([0.1, 0.2, -0.3, 0.5, -0.4, 0.3]), np.array([1.0, -2.0, 0.5, 0.3, 0.2, -0.7])
    way = velocity * t + acceleration * t**2 / 2
    turned = (Rotation.from_rotvec(way[3:]) * turn).as_matrix()
    return BaseMotion(turned, shift + way[:3], velocity + acceleration * t, acceleration)


def path_of(q, v, a):
    """q(t), v(t) of the motion with constant a."""
    return lambda t: (q + v * t + a * t**2 / 2, v + a * t)


@robots
@methods
def test_center_of_mass(model, method):
    q, v, _ = random_state(model, 1, (3,))
    positions = graphdyn.maximal_state(model, q, v, base=base_at(0)).position
    expected = np.average(positions, axis=-2, weights=masses(model))
    assert relative_error(graphdyn.center_of_mass(model, q, base=base_at(0), method=method), expected) < IDENTITY


@robots
@methods
def test_its_velocity_is_its_rate(model, method):
    q, v, a = random_state(model, 2)
    motion = path_of(q, v, a)
    rate = derivative(lambda t: graphdyn.center_of_mass(model, motion(t)[0], base=base_at(t)))
    found = graphdyn.center_of_mass_velocity(model, q, v, base=base_at(0), method=method)
    assert relative_error(found, rate, graphdyn.center_of_mass(model, q, base=base_at(0))) < DIFFERENCE


@robots
@methods
def test_its_jacobian(model, method):
    """∂c/∂q by complex steps, and times v the velocity on a base at rest."""
    q, v, _ = random_state(model, 3)
    placed = BaseMotion(base_at(0).rotation, base_at(0).translation)
    stepped = q + 1j * COMPLEX_STEP_SIZE * np.eye(model.n_bodies)  # a row per joint
    expected = (
        body_sums.center_of_mass(Arguments(model, {"q": stepped}, placed))["center_of_mass"].imag.T / COMPLEX_STEP_SIZE
    )
    found = graphdyn.center_of_mass_jacobian(model, q, base=placed, method=method)
    assert relative_error(found, expected) < IDENTITY
    assert relative_error(found @ v, graphdyn.center_of_mass_velocity(model, q, v, base=placed), found) < IDENTITY


@robots
@methods
def test_momentum_is_the_sum_over_the_bodies(model, method):
    q, v, _ = random_state(model, 4)
    of_bodies = momenta(model, q, v)
    found = graphdyn.momentum(model, q, v, method=method)
    assert relative_error(found.about_origin, of_bodies.sum(axis=0), of_bodies) < IDENTITY


@robots
@methods
def test_momentum_about_two_points(model, method):
    """P = Σm ċ, and L about the origin is L about the center of mass + c × P."""
    q, v, _ = random_state(model, 5)
    found = graphdyn.momentum(model, q, v, base=base_at(0), method=method)
    center = graphdyn.center_of_mass(model, q, base=base_at(0))
    linear = masses(model).sum() * graphdyn.center_of_mass_velocity(model, q, v, base=base_at(0))
    assert relative_error(found.about_center_of_mass[:3], linear) < IDENTITY
    moved = found.about_center_of_mass[3:] + np.cross(center, linear)
    assert relative_error(found.about_origin, np.r_[linear, moved]) < IDENTITY


@robots
@methods
def test_centroidal_map_gives_the_momentum(model, method):
    q, v, _ = random_state(model, 6)
    placed = BaseMotion(base_at(0).rotation, base_at(0).translation)
    found = graphdyn.centroidal_map(model, q, base=placed, method=method)
    momentum = graphdyn.momentum(model, q, v, base=placed, method="dense").about_center_of_mass
    assert relative_error(found @ v, momentum, found) < IDENTITY


@robots
@methods
def test_gravity_loads_and_the_ground_change_the_momentum(model, method):
    """About the world's origin, on a base that moves; the ground acts through every joint that stands on it."""
    q, v, a = random_state(model, 7)
    loads, motion = random_wrenches(model, 8), path_of(q, v, a)

    def about_origin(t):
        return graphdyn.momentum(model, *motion(t), base=base_at(t), method=method).about_origin

    state = graphdyn.maximal_state(model, q, v, base=base_at(0))
    reactions = graphdyn.inverse_dynamics(model, q, v, a, loads, base=base_at(0)).joint_wrenches
    on_ground = np.array([[joint.inside == 0] for joint in model.joints])
    acting = world_wrenches(state, loads + on_ground * reactions)
    acting[:, 3:] += np.cross(origins(state), acting[:, :3])
    weights = masses(model)[:, None] * model.gravity
    acting += np.concatenate([weights, np.cross(state.position, weights)], axis=-1)
    assert relative_error(derivative(about_origin), acting.sum(axis=0), acting, about_origin(0)) < DIFFERENCE


@methods
def test_a_robot_that_is_thrown(method):
    """Nothing turns: the linear momentum is Σm times the velocity, and none is left about the center of mass."""
    model = NAMED["kr500"]
    q, velocity = random_state(model, 9)[0], np.array([2.0, -1.0, 0.5])
    thrown = BaseMotion(velocity=np.r_[velocity, 0, 0, 0])
    found = graphdyn.momentum(model, q, 0 * q, base=thrown, method=method)
    linear = masses(model).sum() * velocity
    assert relative_error(found.about_center_of_mass, np.r_[linear, 0, 0, 0]) < IDENTITY
    center = graphdyn.center_of_mass(model, q)
    assert relative_error(found.about_origin, np.r_[linear, np.cross(center, linear)]) < IDENTITY


@methods
def test_one_link(method):
    """A rod of mass m and length l, hinged about z: c = l/2 (cos q, sin q), L = m l²/3 q̇, and m l²/12 q̇ about c."""
    m, length, angle, rate = 2.0, 0.6, 0.7, 1.3
    rod = graphdyn.Body("rod", m, [length / 2, 0, 0], np.diag([0.0, 1.0, 1.0]) * m * length**2 / 12)
    hinge = graphdyn.Joint("hinge", "revolute", 0, Placement(), [0, 0, 1])
    model = graphdyn.RobotModel("pendulum", (rod,), (hinge,))
    along, across = np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0])
    q, v = [angle], [rate]
    assert graphdyn.center_of_mass(model, q, method=method) == pytest.approx(length / 2 * along)
    assert graphdyn.center_of_mass_velocity(model, q, v, method=method) == pytest.approx(length / 2 * rate * across)
    assert graphdyn.center_of_mass_jacobian(model, q, method=method)[:, 0] == pytest.approx(length / 2 * across)
    found = graphdyn.momentum(model, q, v, method=method)
    linear = m * length / 2 * rate * across
    assert found.about_origin == pytest.approx([*linear, 0, 0, m * length**2 / 3 * rate])
    assert found.about_center_of_mass == pytest.approx([*linear, 0, 0, m * length**2 / 12 * rate])
    column = graphdyn.centroidal_map(model, q, method=method)[:, 0]
    assert column == pytest.approx(found.about_center_of_mass / rate)


@methods
def test_no_digits_are_lost_far_away(method, rng):
    """A base a thousand kilometers off, and a first joint as far from it, change what is added to an exact position."""
    near = NAMED["mixed_chain"]
    q, v, _ = random_state(near, 10)
    turn = random_rotation(rng)
    near = near.with_base(Placement(turn))
    far = near.with_base(Placement(turn, [1e6, -2e6, 1e6]))
    first = far.joints[0]
    moved = Placement(first.placement.rotation, first.placement.translation + np.array([-1e6, 3e6, 1e6]))
    farther = graphdyn.RobotModel(
        "far",
        far.bodies,
        (graphdyn.Joint(first.name, first.kind, 0, moved, first.axis), *far.joints[1:]),
        gravity=far.gravity,
        base=far.base,
    )
    for model in (far, farther):
        for verb, read in (
            ("center_of_mass_velocity", lambda x: x),
            ("center_of_mass_jacobian", lambda x: x),
            ("momentum", lambda x: x.about_center_of_mass),
            ("centroidal_map", lambda x: x),
        ):
            arguments = (q, v) if verb in ("center_of_mass_velocity", "momentum") else (q,)
            expected, found = (
                read(getattr(graphdyn, verb)(robot, *arguments, method=method)) for robot in (near, model)
            )
            assert relative_error(found, expected) < IDENTITY


@methods
@pytest.mark.parametrize("verb", VERBS)
def test_a_robot_without_mass_is_refused(verb, method):
    model = NAMED["kr500"].with_inertial_parameters(np.zeros(60))
    arguments = [np.zeros(6)] * (2 if verb in ("center_of_mass_velocity", "momentum") else 1)
    message = (
        r"robot 'kr500' has no center of mass: the masses of its bodies add up to zero; see physical_consistency\(\)"
    )
    with pytest.raises(InvalidInput, match=message):
        getattr(graphdyn, verb)(model, *arguments, method=method)
    if verb != "momentum":  # which answers two arrays
        with pytest.raises(InvalidInput, match=message):
            graphdyn.compile(model, verb)
