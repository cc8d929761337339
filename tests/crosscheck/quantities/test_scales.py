"""The scales of relative errors: what they are, and that none of them vanishes or forgives."""

import numpy as np
import pytest
from planting import mixed_tree
from random_trees import random_tree

from crosscheck.quantities.scales import (
    SHORTEST_LEVER,
    acceleration_scale,
    backward_error,
    by_parameter_type,
    by_part,
    ratio,
    relative,
    term_sizes,
)
from crosscheck.quantities.tolerances import BACKWARD, FUNCTION_UNDER_TEST
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import (
    Body,
    Joint,
    Placement,
    RobotModel,
    bias_torque,
    forward_dynamics,
    inverse_dynamics,
    mass_matrix,
    maximal_state,
)
from graphdyn.equations.kinematics import link_origins

ERROR = 1e-9


def sizes_of(model, q, v, a):
    q, v, a = (np.atleast_2d(x) for x in (q, v, a))
    state = maximal_state(model, q, v, a)
    return term_sizes(model, v, a, link_origins(state), state.velocity, state.acceleration)


def test_relative_is_per_sample():
    x, reference = np.array([[1.0, -3.6], [0.1, 0.5]]), np.array([[1.0, -4.0], [0.0, 0.5]])
    assert relative(x, reference) == pytest.approx([0.1, 0.2])


def test_relative_takes_the_largest_scale():
    reference = np.array([[1.0], [1.0]])
    assert relative(reference + 1, reference, np.array([4.0, 0.5])) == pytest.approx([0.25, 1.0])


def test_an_error_without_scale_is_infinite_and_none_is_zero():
    assert ratio(np.array([0.0, 1.0]), np.zeros(2)).tolist() == [0.0, np.inf]
    assert relative(np.zeros((1, 2)), np.zeros((1, 2))).tolist() == [0.0]


class TestSizes:
    """Of a turning and a sliding body of 2 and 3 kg at two states, worked out by hand."""

    @pytest.fixture
    def sizes(self):
        bodies = (
            Body("one", 2.0, [0.0, -0.4, 0.0], np.diag([0.1, 0.3, 0.3])),
            Body("two", 3.0, [0.1, 0.2, 0.0], np.diag([0.2, 0.2, 0.1])),
        )
        joints = (
            Joint("turn", "revolute", 0, Placement(), [0, 0, 1]),
            Joint("slide", "prismatic", 1, Placement(), [1, 0, 0]),
        )
        base = Placement(np.eye(3), [0.0, 1.0, 0.0])
        model = RobotModel("two", bodies, joints, gravity=[0.0, 3.0, -4.0], base=base)
        position = np.array([[[1.0, 0, 0], [0, -3.0, 0]], [[0, 1.0, 0], [0, 1.0, 0]]])
        velocity, acceleration = np.full((2, 2, 6), 100.0), np.full((2, 2, 6), -100.0)
        velocity[..., 3:], acceleration[..., 3:] = [[[1.0]], [[0.0]]], [[[-6.0]], [[0.5]]]
        velocity[0, 1, 4] = -1.5
        v, a = np.array([[9.0, -0.5], [9.0, 0.0]]), np.array([[9.0, 7.0], [9.0, -2.0]])
        return term_sizes(model, v, a, position, velocity, acceleration)

    def test_by_hand(self, sizes):
        lever = np.array([4.0 + 0.4 + 1e-3, 0.4 + 1e-3])
        turn = np.array([6.0 + 1.5**2, 0.5])
        swing = turn * lever + [2 * 1.5 * 0.5 + 7.0, 2.0]
        compensated, spin = swing + 5.0, 0.3 * turn
        assert sizes.lever == pytest.approx(lever)
        assert sizes.arm == pytest.approx([lever[0], 1.0])  # a joint slides: a meter for each meter
        assert sizes.omega == pytest.approx([1.5, 0.0])
        assert sizes.slide_rate == pytest.approx([0.5, 0.0])
        assert sizes.velocity == pytest.approx([1.5 * lever[0] + 0.5, 0.0])
        assert sizes.acceleration == pytest.approx(swing)
        assert sizes.turn == pytest.approx(turn)
        assert sizes.compensated == pytest.approx(compensated)
        assert sizes.force == pytest.approx(5.0 * compensated)
        assert sizes.moment == pytest.approx(5.0 * compensated * lever + spin)
        assert sizes.spin == pytest.approx(spin)
        mass, first_moment, tensor = sizes.regressor_columns
        assert mass == pytest.approx(compensated * lever)
        assert first_moment == pytest.approx(compensated)
        assert tensor == pytest.approx(turn)

    def test_farther(self, sizes):
        """Two meters: ‖ω‖ and turn carry them, forces and moments do not change."""
        there = sizes.farther(2.0)
        assert there.lever == pytest.approx(sizes.lever + 2.0)
        assert there.arm == pytest.approx(sizes.lever + 2.0)
        assert there.velocity == pytest.approx(sizes.velocity + np.array([3.0, 0.0]))
        assert there.acceleration == pytest.approx(sizes.acceleration + 2.0 * sizes.turn)
        assert there.moment == pytest.approx(sizes.moment)

    def test_loads_are_added(self, sizes):
        wrenches = np.zeros((2, 2, 6))
        wrenches[0, 0], wrenches[1, 1] = [0, -8.0, 0, 0, 0, 3.0], [1.0, 0, 0, 0, -2.0, 0]
        loaded = sizes.loaded(wrenches)
        assert loaded.force - sizes.force == pytest.approx([8.0, 1.0])
        assert loaded.moment - sizes.moment == pytest.approx([3.0 + 8.0 * 4.401, 2.0 + 0.401])
        assert loaded.turn is sizes.turn


def test_acceleration_scale_by_hand():
    """M = [[2, 1], [1, 3]]: ‖M⁻¹‖∞ = 4/5, cond = (5 + √5)/(5 − √5); a mass matrix that is not finite has no scale."""
    mass = np.array([[[2.0, 1.0], [1.0, 3.0]], [[np.inf, 1.0], [1.0, 3.0]], np.eye(2)])
    a, tau, wrenches = np.array([[1.0, -3.0]] * 3), np.array([[-10.0, 1.0]] * 3), np.full((3, 2, 6), -20.0)
    condition = (5 + np.sqrt(5)) / (5 - np.sqrt(5))
    found = acceleration_scale(mass, a, tau, wrenches)
    assert found[0] == pytest.approx(condition * 3.0 + 0.8 * 30.0)
    assert np.isnan(found[1])


def test_by_parameter_type_takes_each_column_by_its_own_size():
    """m, three of m c, six of I; an error in the first or last column of a type is on the scale of that type."""
    for sizes in ((100.0, 10.0, 1.0), (1.0, 10.0, 100.0)):
        for column, kind in ((0, 0), (1, 1), (3, 1), (4, 2), (9, 2)):
            x = np.zeros((1, 1, 10))
            x[..., column] = 0.5
            found = by_parameter_type(x, 0 * x, *(np.array([size]) for size in sizes))
            assert found == pytest.approx([0.5 / sizes[kind]])


class TestBackwardError:
    def test_largest_of_all_terms(self):
        """By hand: torques 3 off; given 10, wrenches 20, |M| |a| = 2·3 + 4·5 = 26, loads 40."""
        required, tau = np.array([[13.0, 1.0]]), np.array([[10.0, 1.0]])
        wrenches, mass = np.full((1, 2, 6), -20.0), np.array([[[1.0, 0.0], [2.0, -4.0]]])
        a = np.array([[-3.0, 5.0]])
        assert backward_error(required, tau, 0 * wrenches, 0 * mass, a) == pytest.approx([3 / 10])
        assert backward_error(required, tau, wrenches, 0 * mass, a) == pytest.approx([3 / 20])
        assert backward_error(required, tau, wrenches, mass, a) == pytest.approx([3 / 26])
        assert backward_error(required, tau, wrenches, mass, a, 2 * wrenches) == pytest.approx([3 / 40])

    @pytest.mark.parametrize("n", [6, 30, 100])
    def test_chains(self, n):
        """Ours are backward stable however long the chain; single precision and g = 9.811 show on every one."""
        model = random_tree(5, range(n), ["revolute"] * n).with_gravity([0.0, 0.0, -9.81])
        q, v = model.random_state(np.random.default_rng(0), 3)
        a = np.random.default_rng(1).uniform(-10, 10, q.shape)
        tau = inverse_dynamics(model, q, v, a).tau * np.linspace(0.5, 1.5, n)
        mass, rest = mass_matrix(model, q), tau - bias_torque(model, q, v)
        pinocchio = PinocchioModel.from_model(model)

        def error(a):
            required, wrenches = pinocchio.inverse_dynamics(q, v, a)
            return backward_error(required, tau, wrenches, mass, a)

        for method in ("dense", "projected", "recursive"):
            assert error(forward_dynamics(model, q, v, tau, method=method).a).max() <= BACKWARD.bound / 10
        single = np.linalg.solve(mass.astype(np.float32), rest.astype(np.float32)[..., None])[..., 0]
        assert error(single.astype(float)).max() > 10 * FUNCTION_UNDER_TEST.bound
        other = model.with_gravity([0.0, 0.0, -9.811])
        assert error(forward_dynamics(other, q, v, tau).a).max() > FUNCTION_UNDER_TEST.bound


def test_nan_stays_nan():
    assert np.isnan(relative(np.array([[np.nan]]), np.array([[1.0]]))).all()


def test_a_small_moment_is_not_hidden_by_a_large_force():
    reference = np.array([[[1e6, 0, 0, 1.0, 0, 0]]])
    wrong = reference.copy()
    wrong[0, 0, 3] += ERROR
    none = np.zeros(1)
    assert by_part(wrong, reference, none, none) == pytest.approx([ERROR])
    assert by_part(wrong, reference, none, np.array([10.0])) == pytest.approx([ERROR / 10])


def test_parameter_types_are_apart():
    """Columns m, m c, I of two bodies; an error in a column of I is judged by I, whatever the others are."""
    reference = np.tile(np.concatenate([[1e6], [1e3] * 3, [1.0] * 6]), 2)[None, None]
    for column, size in ((10, 1e6), (12, 1e3), (19, 1.0)):
        wrong = reference.copy()
        wrong[..., column] += ERROR
        assert by_parameter_type(wrong, reference, *np.zeros((3, 1))) == pytest.approx([ERROR / size], rel=1e-6)


def test_a_hanging_arm_at_rest_has_a_scale():
    """Upright, its moments are rounding; the scale is weight times lever."""
    body = Body("rod", 3.0, [0.0, 0.0, 0.5], np.diag([0.1, 0.1, 0.01]))
    arm = RobotModel("rod", (body,), (Joint("hinge", "revolute", 0, Placement(), [0, 1.0, 0]),))
    size = sizes_of(arm, [0.0], [0.0], [0.0])
    assert inverse_dynamics(arm, [0.0], [0.0], [0.0]).tau == pytest.approx(0, abs=1e-14)
    assert size.force == pytest.approx([3.0 * 9.81])
    assert size.moment == pytest.approx([3.0 * 9.81 * (0.5 + SHORTEST_LEVER)])


def test_the_lever_starts_at_the_base():
    body = Body("rod", 3.0, np.zeros(3), np.eye(3))
    arm = RobotModel("rod", (body,), (Joint("hinge", "revolute", 0, Placement(translation=[2.0, 0, 0]), [0, 0, 1.0]),))
    for base in (Placement(), Placement(translation=[100.0, 0, 0])):
        assert sizes_of(arm.with_base(base), [0.3], [0.0], [0.0]).lever == pytest.approx([2.0 + SHORTEST_LEVER])


@pytest.mark.parametrize("seed", range(5))
def test_no_wrench_is_larger_than_its_scale_by_far(seed):
    """The scales are sums of terms: they bound what the terms give, up to the number of entries and bodies."""
    model = mixed_tree()
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng, 1)
    a = rng.normal(size=q.shape)
    wrenches = inverse_dynamics(model, q, v, a).joint_wrenches
    size = sizes_of(model, q, v, a)
    assert np.abs(wrenches[..., :3]).max() <= 3 * model.n_bodies * size.force
    assert np.abs(wrenches[..., 3:]).max() <= 9 * model.n_bodies * size.moment


def test_external_wrenches_add_their_moment_about_every_joint():
    model = mixed_tree()
    q, v = model.random_state(np.random.default_rng(0), 1)
    size = sizes_of(model, q, v, 0 * v)
    wrench = np.zeros((1, 3, 6))
    wrench[0, 2] = [0, 50.0, 0, 0, 0, -7.0]
    loaded = size.loaded(wrench)
    assert loaded.force == pytest.approx(size.force + 50)
    assert loaded.moment == pytest.approx(size.moment + 7 + 50 * size.lever)
