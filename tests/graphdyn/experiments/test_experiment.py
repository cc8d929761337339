"""Virtual experiments: the laws of mechanics in the recorded numbers, the paper's numbers, refusals."""

import numpy as np
import pytest
from random_trees import random_tree
from scipy.spatial.transform import Rotation

import graphdyn
from graphdyn import InvalidInput, Placement
from graphdyn.experiments.experiment import base_motion
from graphdyn.motion_laws import ConstantAcceleration, FourierSeries, Locked, Polynomial, Rail, Turntable

BALANCE = 1e-13
"""Sums of some ten wrenches, relative to the largest: measured 3e-15."""

STEP = 1e-3
DIFFERENCE = 1e-4
"""Central differences with STEP, relative to the largest value: their own error, measured 2e-5."""

SAME = 1e-14
"""Two ways of turning one vector, relative to its length."""

TURN_ABOUT = (0.3, -0.5, 0.8)


@pytest.fixture(scope="module")
def tree():
    return random_tree(7, [0, 1, 1, 3], ["revolute", "prismatic", "continuous", "revolute"])


@pytest.fixture(scope="module")
def shaken(tree):
    """Every joint but one and the moving base in motion."""
    names = tree.joint_names
    return graphdyn.simulate_recording(
        tree,
        np.arange(400) * STEP,
        {
            names[0]: FourierSeries(0.7, (0.5, 0.2), (-0.4, 0.3), 0.2),
            names[1]: Polynomial((0.1, -0.2, 0.4, 1.5)),
            names[3]: ConstantAcceleration(-2.0, 1.0),
        },
        base=[
            Rail((1.0, 2.0, -1.0), FourierSeries(0.5, (0.3,), (0.4,))),
            Rail((0.0, 0.0, 1.0), ConstantAcceleration(1.5)),
            Turntable(TURN_ABOUT, Polynomial((0.2, 0.5, -1.0))),
        ],
    )


def rates(values):
    return (values[2:] - values[:-2]) / (2 * STEP)


def test_newton_and_euler_hold_for_every_body(tree, shaken):
    """What goes in at the inside joint, less what goes out at the outside joints, moves the body."""
    x, turn = shaken, shaken.rotation
    origins = x.position - np.einsum("tiab,ib->tia", turn, [body.center_of_mass for body in tree.bodies])
    for i, body in enumerate(tree.bodies):
        force = x.joint_forces[:, i] + body.mass * (tree.gravity - x.acceleration[:, i])
        moment = x.joint_moments[:, i] + np.cross(origins[:, i] - x.position[:, i], x.joint_forces[:, i])
        for k, joint in enumerate(tree.joints):
            if joint.inside == i + 1:
                force = force - x.joint_forces[:, k]
                moment = moment - x.joint_moments[:, k]
                moment = moment - np.cross(origins[:, k] - x.position[:, i], x.joint_forces[:, k])
        inertia = turn[:, i] @ body.inertia @ np.swapaxes(turn[:, i], -1, -2)
        omega = x.angular_velocity[:, i]
        spin = np.einsum("tab,tb->ta", inertia, omega)
        moment = moment - np.einsum("tab,tb->ta", inertia, x.angular_acceleration[:, i]) - np.cross(omega, spin)
        assert np.abs(force).max() < BALANCE * np.abs(x.joint_forces).max()
        assert np.abs(moment).max() < BALANCE * np.abs(x.joint_moments).max()


def test_accelerations_are_the_second_derivatives_of_the_positions(shaken):
    x = shaken
    assert np.abs(rates(rates(x.position)) - x.acceleration[2:-2]).max() < DIFFERENCE * np.abs(x.acceleration).max()
    angular = x.angular_acceleration
    assert np.abs(rates(x.angular_velocity) - angular[1:-1]).max() < DIFFERENCE * np.abs(angular).max()
    spin = rates(x.rotation) @ np.swapaxes(x.rotation[1:-1], -1, -2)  # ω~, world axes
    omega = np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], axis=-1)
    assert np.abs(omega - x.angular_velocity[1:-1]).max() < DIFFERENCE * np.abs(x.angular_velocity).max()
    assert np.abs(rates(x.q) - x.v[1:-1]).max() < DIFFERENCE * np.abs(x.v).max()


def test_actuators_and_carriage_supply_the_power(tree, shaken):
    """The kinetic and potential energy grow by what the actuators and the moving ground frame supply."""
    x = shaken
    masses = np.array([body.mass for body in tree.bodies])
    inertias = np.array([body.inertia for body in tree.bodies])
    velocity = rates(x.position)
    spin = np.einsum("tiba,tib->tia", x.rotation, x.angular_velocity)[1:-1]
    energy = np.einsum("i,tia,tia->t", masses, velocity, velocity) / 2
    energy += np.einsum("tia,iab,tib->t", spin, inertias, spin) / 2
    energy -= np.einsum("i,tia,a->t", masses, x.position[1:-1], tree.gravity)
    origin_1 = x.position[:, 0] - x.rotation[:, 0] @ tree.bodies[0].center_of_mass
    axis = np.array(TURN_ABOUT) / np.linalg.norm(TURN_ABOUT)
    base_omega = (0.5 - 2.0 * x.time)[:, None] * axis
    power = np.einsum("tj,tj->t", x.tau, x.v)[2:-2]
    power += np.einsum("ta,ta->t", x.joint_forces[2:-2, 0], rates(origin_1)[1:-1])
    power += np.einsum("ta,ta->t", x.joint_moments[2:-2, 0], base_omega[2:-2])
    assert np.abs(rates(energy) - power).max() < DIFFERENCE * np.abs(power).max()


def test_joints_without_a_law_are_locked_at_zero_and_a_list_has_the_order_of_the_model(tree):
    law = ConstantAcceleration(1.0)
    named = graphdyn.simulate_recording(tree, [0.0, 1.0], {tree.joint_names[2]: law})
    listed = graphdyn.simulate_recording(tree, [0.0, 1.0], [Locked(), Locked(), law, Locked(0.0)])
    assert named.q.tolist() == [[0, 0, 0, 0], [0, 0, 0.5, 0]]
    assert np.array_equal(named.joint_moments, listed.joint_moments)
    assert named.prismatic == (False, True, False, False)


def test_any_function_of_time_is_a_law(tree):
    def law(times):
        return np.sin(times), np.cos(times), -np.sin(times)

    recorded = graphdyn.simulate_recording(tree, [0.0, 0.5], {tree.joint_names[0]: law}, base=Rail((0, 1, 0), law))
    assert recorded.v[:, 0] == pytest.approx(np.cos([0.0, 0.5]))


def test_a_turned_carriage_is_a_turned_robot():
    """Half a turn of the moving base about the vertical: the forces turn with it."""
    model = graphdyn.kr500().with_base(Placement(translation=np.array([0.3, 0.2, 0.1])))
    law = {"O2": ConstantAcceleration(0.5)}
    straight = graphdyn.simulate_recording(model, [1.0], law)
    turned = graphdyn.simulate_recording(model, [1.0], law, base=Turntable((0, 0, 1), Locked(np.pi)))
    half_turn = np.diag([-1.0, -1.0, 1.0])
    largest = np.abs(straight.joint_forces).max()
    assert np.abs(turned.joint_forces - straight.joint_forces @ half_turn).max() < SAME * largest
    assert np.abs(turned.position - straight.position @ half_turn).max() < SAME


# The paper's experiment


def test_a_base_moves_along_and_about_the_axes_of_its_laws():
    """The turn by exp(θ axis×), with rates along the axis; rails add, and neither of them turns."""
    times = np.array([0.0, 0.4, 1.1])
    course, turn = Polynomial((0.2, 0.5, -1.0)), np.array(TURN_ABOUT) / np.linalg.norm(TURN_ABOUT)
    slides = [np.array([3.0, -4.0, 0.0]) / 5, np.array([0.0, 0.0, -1.0])]
    laws = [*(Rail(axis, course) for axis in slides), Turntable(TURN_ABOUT, course)]
    found, (theta, rate, acceleration) = base_motion(laws, times), course(times)
    np.testing.assert_allclose(found.rotation, Rotation.from_rotvec(theta[:, None] * turn).as_matrix(), atol=1e-15)
    along = sum(slides)
    np.testing.assert_allclose(found.translation, theta[:, None] * along, atol=1e-15)
    for told, size in ((found.velocity, rate), (found.acceleration, acceleration)):
        np.testing.assert_allclose(told[:, :3], size[:, None] * along, atol=1e-15)
        np.testing.assert_allclose(told[:, 3:], size[:, None] * turn, atol=1e-15)


@pytest.fixture(scope="module")
def paper():
    return graphdyn.kr500_experiment()


def test_the_paper_takes_100_steps_in_2_seconds(paper):
    assert paper.time.shape == (101,)
    assert paper.time[[0, -1]].tolist() == [0.0, 2.0]
    assert not paper.v[0].any()


def test_it_ends_in_the_posture_of_figure_10(paper):
    """O1 has turned by +60°, O2 by -60°; the robot has gone 4 m along the rail."""
    assert np.degrees(paper.q[-1]) == pytest.approx([60, -60, 0, 0, 0, 0], abs=1e-12)
    assert paper.position[-1, 0] == pytest.approx([4.0, 0.0, 1.045 / 2], abs=1e-14)
    out, up = np.array([0.5, np.sqrt(0.75), 0.0]), np.array([0.0, 0.0, 1.0])
    assert paper.rotation[-1, 0, :, 0] == pytest.approx(up, abs=1e-14)
    assert paper.rotation[-1, 1, :, 0] == pytest.approx(up / 2 - np.sqrt(0.75) * out, abs=1e-14)  # leans back
    assert paper.rotation[-1, 5, :, 0] == pytest.approx(out / 2 + np.sqrt(0.75) * up, abs=1e-14)
    elbow = np.array([4.0, 0.0, 1.045]) + 1.245 * paper.rotation[-1, 1, :, 0]
    tip = elbow + (1.21 + 0.315 + 0.29 + 0.15) * paper.rotation[-1, 5, :, 0]
    assert paper.position[-1, 5] == pytest.approx(tip, abs=1e-14)


def test_the_ratio_of_angular_velocities_is_the_one_printed(paper):
    """tan 33.75° = 0.668179: with equal rates of O1 and O2 it is the tilt of B3 … B6 at 1.5 s, seen in body axes."""
    now = paper.at(1.5)
    omega = np.einsum("iba,ib->ia", now.rotation[0], now.angular_velocity[0])
    assert omega[2:, 0] / omega[2:, 2] == pytest.approx(np.full(4, np.tan(np.radians(33.75))), rel=1e-14)


def test_forces_at_1_5_seconds(paper):
    """The numbers of an independent program, to their last digit, in units of which a rounded number is within 1/2.

    The first component of the last force was printed as 854.4670 with the masses of Table 2, which has four decimals;
    with the exact mass of the cylinder B6 (661.70424 kg) it is 854.46709.
    """
    forces = paper.at(1.5).joint_forces[0]
    digit = np.array([1e-2, 1e-3, 1e-2])
    assert np.abs((forces[0] - [24853.75, -7277.143, 110108.77]) / digit).max() < 0.5
    printed_mass = forces[5] * 661.7042 / graphdyn.kr500().bodies[5].mass
    assert np.abs((printed_mass - [854.4670, -2008.935, 5947.395]) / [1e-4, 1e-3, 1e-3]).max() < 0.5
    assert forces[5] == pytest.approx([854.467087, -2008.934711, 5947.395383], abs=6e-7)


def test_other_times(paper):
    assert np.array_equal(graphdyn.kr500_experiment([0.3, 1.5]).joint_forces, paper.at([0.3, 1.5]).joint_forces)


SECONDS = [0.0, 1.0]


@pytest.mark.parametrize(
    ("joints", "base", "message"),
    [
        ({"O7": Locked()}, (), r"there is no joint 'O7'; joints of robot 'kr500': O1, O2, O3, O4, O5, O6"),
        ([Locked()], (), r"1 motion laws for 6 joints; give one each, or name them \(joints of robot 'kr500': O1"),
        ({"O1": 30.0}, (), r"joint 'O1': 30.0 is not a motion law; take one of graphdyn.motion_laws"),
        (
            {"O2": lambda t: (t, t)},
            (),
            r"joint 'O2': the law must answer .* of shape \(2,\); it answers \(2,\), \(2,\)$",
        ),
        ({"O2": lambda t: (t, t, t[0])}, (), r"joint 'O2': the law must answer .*; it answers \(2,\), \(2,\), \(\)$"),
        ({"O2": lambda t: (t, t, t / 0)}, (), r"joint 'O2': the law must answer position, velocity and acc.*, finite"),
        ({}, Rail((1, 0, 0), lambda t: (t, t)), r"rail: the law must answer"),
        ({}, [Turntable((1, 0, 0), Locked())] * 2, r"more than one turntable; turns about several axes do not add"),
        ({}, [Locked()], r"the base cannot move by Locked\(position=0.0\); use Rail or Turntable"),
    ],
)
def test_refusals(joints, base, message):
    with pytest.raises(InvalidInput, match=message), np.errstate(all="ignore"):
        graphdyn.simulate_recording(graphdyn.kr500(), SECONDS, joints, base=base)


@pytest.mark.parametrize("times", [[[0.0, 1.0]], [0.0, np.nan]])
def test_times_are_refused_that_are_not_a_list_of_numbers(times):
    with pytest.raises(InvalidInput, match=r"times must be finite numbers of shape \(N,\); they have shape"):
        graphdyn.simulate_recording(graphdyn.kr500(), times, {})


def test_times_that_do_not_increase_are_refused():
    with pytest.raises(InvalidInput, match=r"time 0 s in row 1 does not increase"):
        graphdyn.simulate_recording(graphdyn.kr500(), [1.0, 0.0], {})
