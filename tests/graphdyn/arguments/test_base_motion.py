"""Prescribed motion of the base: laws that need no other program. Pinocchio is asked in tests/crosscheck."""

import dataclasses
import inspect

import numpy as np
import pytest
from random_trees import random_rotation, random_state
from witnesses import relative_error

import graphdyn
from graphdyn import BaseMotion, Body, InvalidInput, Joint, Placement, RobotModel
from graphdyn.model.spatial import rotation_about

SUM = 1e-13
"""Two recursions of some hundred roundings, on the scale of the joint wrenches."""

DIFFERENCE = 1e-6
"""Central differences of positions with a step of 1e-4 s: their own error."""

VERBS = (
    graphdyn.maximal_state,
    graphdyn.frame_placement,
    graphdyn.forward_dynamics,
    graphdyn.inverse_dynamics,
    graphdyn.mass_matrix,
    graphdyn.bias_torque,
    graphdyn.kkt_system,
    graphdyn.body_regressor,
    graphdyn.joint_torque_regressor,
)


def random_motion(rng, *batch):
    rotation = np.stack([random_rotation(rng) for _ in range(int(np.prod(batch)))]).reshape(*batch, 3, 3)
    return BaseMotion(rotation, rng.normal(size=(*batch, 3)), *rng.normal(size=(2, *batch, 6)))


@pytest.mark.parametrize("verb", VERBS, ids=lambda verb: verb.__name__)
def test_every_verb_takes_a_base(verb):
    assert inspect.signature(verb).parameters["base"].kind is inspect.Parameter.KEYWORD_ONLY


def test_without_motion_nothing_changes(robot):
    q, v, x = random_state(robot, 1)
    for verb in (graphdyn.forward_dynamics, graphdyn.inverse_dynamics):
        still, moving = verb(robot, q, v, x), verb(robot, q, v, x, base=BaseMotion())
        assert np.array_equal(still.joint_wrenches, moving.joint_wrenches)
        assert np.array_equal(still.multipliers, moving.multipliers)


@pytest.mark.usefixtures("default_method")
def test_steady_translation_is_not_felt(robot):
    """Galilei: at constant velocity, anywhere, all forces are those at rest."""
    q, v, a = random_state(robot, 2)
    steady = BaseMotion(translation=[3.0, -1.0, 2.0], velocity=[1.0, 2.0, -3.0, 0, 0, 0])
    here, there = graphdyn.inverse_dynamics(robot, q, v, a), graphdyn.inverse_dynamics(robot, q, v, a, base=steady)
    assert relative_error(there.joint_wrenches, here.joint_wrenches) < SUM


@pytest.mark.usefixtures("default_method")
def test_accelerated_translation_is_felt_as_gravity(robot):
    """Einstein's lift: the base accelerated by b is gravity g - b."""
    q, v, tau = random_state(robot, 3)
    b = np.array([0.7, -2.0, 1.3])
    lift = BaseMotion(acceleration=[*b, 0, 0, 0])
    here = graphdyn.forward_dynamics(robot.with_gravity(robot.gravity - b), q, v, tau)
    there = graphdyn.forward_dynamics(robot, q, v, tau, base=lift)
    size = np.linalg.cond(graphdyn.mass_matrix(robot, q))
    assert relative_error(there.a, here.a) < SUM * size
    assert relative_error(there.joint_wrenches, here.joint_wrenches) < SUM * size


@pytest.mark.usefixtures("default_method")
def test_turned_base_under_turned_gravity(robot):
    """Only the angle between base and gravity counts."""
    q, v, a = random_state(robot, 4)
    turn = random_rotation(np.random.default_rng(4))
    there = graphdyn.inverse_dynamics(robot.with_gravity(turn @ robot.gravity), q, v, a, base=BaseMotion(rotation=turn))
    assert relative_error(there.joint_wrenches, graphdyn.inverse_dynamics(robot, q, v, a).joint_wrenches) < SUM


@pytest.mark.usefixtures("default_method")
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_a_moving_base_is_a_joint_that_moves_as_prescribed(robot, kind):
    """The robot behind one more joint, whose position, velocity and acceleration are given."""
    rng = np.random.default_rng(5)
    mount = Placement(random_rotation(rng), rng.normal(size=3))
    axis = rng.normal(size=3) / np.linalg.norm(rng.normal(size=3))
    axis /= np.linalg.norm(axis)
    base_motion = Joint("base_motion", kind, 0, mount, axis)
    first = [
        dataclasses.replace(
            j, inside=j.inside + 1, placement=robot.base @ j.placement if j.inside == 0 else j.placement
        )
        for j in robot.joints
    ]
    massless = Body("base_motion", 0.0, np.zeros(3), np.zeros((3, 3)))
    whole = RobotModel("whole", (massless, *robot.bodies), (base_motion, *first), gravity=robot.gravity)
    q, v, a = random_state(robot, 6)
    s, s_dot, s_ddot = 0.4, -1.2, 2.3
    expected = graphdyn.inverse_dynamics(whole, [s, *q], [s_dot, *v], [s_ddot, *a])
    p = mount.rotation @ axis
    if kind == "prismatic":
        motion = BaseMotion(
            mount.rotation, mount.translation + s * p, [*(s_dot * p), 0, 0, 0], [*(s_ddot * p), 0, 0, 0]
        )
    else:
        turn = mount.rotation @ rotation_about(axis, s)
        motion = BaseMotion(turn, mount.translation, [0, 0, 0, *(s_dot * p)], [0, 0, 0, *(s_ddot * p)])
    found = graphdyn.inverse_dynamics(robot, q, v, a, base=motion)
    assert relative_error(found.tau, expected.tau[1:], expected.joint_wrenches) < SUM
    assert relative_error(found.joint_wrenches, expected.joint_wrenches[1:]) < SUM


@pytest.mark.usefixtures("default_method")
def test_velocities_and_accelerations_are_derivatives(robot):
    """A moving base on a circle that turns as it goes, and joints that move as well."""
    h = 1e-4
    q, v, a = random_state(robot, 7)

    def at(t):
        axis = np.array([0.6, 0.0, 0.8])
        angle, rate, growth = 0.3 + 1.1 * t + 0.4 * t**2, 1.1 + 0.8 * t, 0.8
        p = np.array([np.cos(2 * t), np.sin(2 * t), t**2])
        p_dot = np.array([-2 * np.sin(2 * t), 2 * np.cos(2 * t), 2 * t])
        p_ddot = np.array([-4 * np.cos(2 * t), -4 * np.sin(2 * t), 2])
        motion = BaseMotion(rotation_about(axis, angle), p, [*p_dot, *(rate * axis)], [*p_ddot, *(growth * axis)])
        return graphdyn.maximal_state(robot, q + v * t + a * t**2 / 2, v + a * t, a, base=motion)

    before, now, after = at(-h), at(0.0), at(h)
    velocity = (after.position - before.position) / (2 * h)
    acceleration = (after.velocity - before.velocity) / (2 * h)
    assert relative_error(now.velocity[..., :3], velocity) < DIFFERENCE
    assert relative_error(now.acceleration, acceleration) < DIFFERENCE
    spin = np.swapaxes(now.rotation, -1, -2) @ (after.rotation - before.rotation) / (2 * h)
    omega = np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], axis=-1)
    assert relative_error(now.velocity[..., 3:], omega) < DIFFERENCE
    assert np.abs(now.constraint_residual()).max() < SUM


@pytest.mark.usefixtures("default_method")
def test_the_66_equations_hold_on_a_moving_base(robot):
    """φ_q q̈ = ζ with ∂²φ/∂t² in ζ, Eq. (108); dense, projected and inverse dynamics agree."""
    rng = np.random.default_rng(8)
    motion = random_motion(rng)
    q, v, tau = random_state(robot, 9)
    k = graphdyn.kkt_system(robot, q, v, tau, base=motion)
    f = graphdyn.forward_dynamics(robot, q, v, tau, base=motion)
    dense = graphdyn.forward_dynamics(robot, q, v, tau, base=motion, method="dense")
    size = np.linalg.cond(graphdyn.mass_matrix(robot, q))
    moved = k.constraint_jacobian @ f.body_accelerations.ravel()
    assert relative_error(moved, k.zeta, f.body_accelerations) < SUM
    assert relative_error(f.a, dense.a) < SUM * size
    assert relative_error(f.multipliers, dense.multipliers, f.joint_wrenches) < SUM * size
    back = graphdyn.inverse_dynamics(robot, q, v, f.a, base=motion)
    assert relative_error(back.tau, tau, back.joint_wrenches) < SUM * size
    assert relative_error(back.multipliers, f.multipliers, f.joint_wrenches) < SUM * size


def test_cardano_form_on_a_moving_base(robot):
    motion = BaseMotion(velocity=[1, 2, 3, 0.4, -0.2, 0.3], acceleration=[3, -1, 2, 0.3, 0.5, -0.7])
    q, v, tau = random_state(robot, 10)
    twist = graphdyn.kkt_system(robot, q, v, tau, base=motion).solve()
    cardano = graphdyn.kkt_system(robot, q, v, tau, base=motion, coordinates="cardano").solve()
    assert relative_error(cardano.multipliers, twist.multipliers) < 1e-9  # near lock the Cardano form loses digits


@pytest.mark.usefixtures("default_method")
def test_state_and_back(robot):
    motion = random_motion(np.random.default_rng(11))
    q, v, a = random_state(robot, 12)
    state = graphdyn.maximal_state(robot, q, v, a, base=motion)
    q_again, v_again = graphdyn.joint_state(robot, state)
    assert np.abs(np.exp(1j * q_again) - np.exp(1j * q)).max() < SUM
    assert np.abs(v_again - v).max() < SUM * 10
    assert relative_error(graphdyn.joint_acceleration(robot, state), a, state.acceleration) < SUM


@pytest.mark.usefixtures("default_method")
def test_regressors_on_a_moving_base(robot):
    motion = random_motion(np.random.default_rng(13))
    q, v, a = random_state(robot, 14)
    i = graphdyn.inverse_dynamics(robot, q, v, a, base=motion)
    w = graphdyn.joint_torque_regressor(robot, q, v, a, base=motion)
    assert relative_error(w @ robot.inertial_parameters, i.tau, i.joint_wrenches) < SUM
    own = graphdyn.body_regressor(robot, q, v, a, base=motion)[-1] @ robot.bodies[-1].parameters
    assert relative_error(own, i.joint_wrenches[-1]) < SUM  # the last body carries no other


def test_frames_move_with_the_base():
    model = dataclasses.replace(
        graphdyn.kr500(), frames=(graphdyn.Frame("tip", 6, Placement(translation=[0.3, 0, 0])),)
    )
    motion = random_motion(np.random.default_rng(15))
    rotation, position = graphdyn.frame_placement(model, np.zeros(6), "tip")
    moved = graphdyn.frame_placement(model, np.zeros(6), "tip", base=motion)
    np.testing.assert_allclose(moved[0], motion.rotation @ rotation, rtol=0, atol=SUM)
    np.testing.assert_allclose(moved[1], motion.rotation @ position + motion.translation, rtol=0, atol=SUM)


@pytest.mark.usefixtures("default_method")
def test_leading_dimensions_broadcast():
    """One joint state on many base motions, many joint states on one, and both."""
    model, rng = graphdyn.kr500(), np.random.default_rng(16)
    q, v, a = model.random_state(rng, 4)[0], *rng.normal(size=(2, 4, 6))
    many, one = random_motion(rng, 4), random_motion(rng)
    assert graphdyn.inverse_dynamics(model, q[0], v[0], a[0], base=many).tau.shape == (4, 6)
    assert graphdyn.inverse_dynamics(model, q, v, a, base=one).tau.shape == (4, 6)
    both = graphdyn.inverse_dynamics(model, q, v, a, base=many).tau
    for k in range(4):
        row = BaseMotion(many.rotation[k], many.translation[k], many.velocity[k], many.acceleration[k])
        np.testing.assert_allclose(
            both[k], graphdyn.inverse_dynamics(model, q[k], v[k], a[k], base=row).tau, rtol=1e-12
        )
    assert graphdyn.mass_matrix(model, q[0], base=many).shape == (4, 6, 6)
    assert graphdyn.maximal_state(model, q, base=one).position.shape == (4, 6, 3)


class TestRefusals:
    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            ({"translation": [1, 2]}, r"translation of the base has shape \(2,\), expected \(…, 3\)"),
            ({"velocity": np.zeros(3)}, r"velocity of the base has shape \(3,\), expected \(…, 6\)"),
            ({"acceleration": [np.nan] * 6}, "acceleration of the base contains NaN or infinity"),
            ({"rotation": 2 * np.eye(3)}, "rotation of the base is not a rotation matrix"),
            ({"rotation": np.diag([1, 1, -1.0])}, "rotation of the base is not a rotation matrix"),
            (
                {"velocity": np.zeros((3, 6)), "acceleration": np.zeros((2, 6))},
                "leading dimensions of the base motion do not broadcast",
            ),
        ],
    )
    def test_motion(self, arguments, message):
        with pytest.raises(InvalidInput, match=message):
            BaseMotion(**arguments)

    def test_batches_that_do_not_fit(self):
        model = graphdyn.kr500()
        motion = BaseMotion(velocity=np.zeros((3, 6)))
        with pytest.raises(InvalidInput, match=r"do not broadcast: q \(2, 6\).*, base \(3, '…'\)"):
            graphdyn.maximal_state(model, np.zeros((2, 6)), base=motion)

    def test_one_state(self):
        with pytest.raises(InvalidInput, match="one state expected"):
            graphdyn.kkt_system(graphdyn.kr500(), *np.zeros((3, 6)), base=BaseMotion(velocity=np.zeros((2, 6))))
