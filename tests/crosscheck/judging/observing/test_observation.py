"""Experiments with a function under test as rows of torques: right answers leave nothing, wrong ones their error."""

import numpy as np
import pytest
from planting import mixed_tree

import graphdyn
from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.judging.observing.function_under_test import FunctionUnderTest
from crosscheck.judging.observing.observation import observe, of_experiments, of_judged
from crosscheck.judging.searching.search import _of_states
from crosscheck.judging.special_states import N_SPECIAL_STATES
from crosscheck.judging.states import (
    N_EXPERIMENT_STATES,
    N_TURNED_STATES,
    JudgedStates,
    deviations,
    scales,
    split,
    torques,
    usual_acceleration,
)
from crosscheck.quantities import FUNCTIONS
from graphdyn import JointLimits

ROUNDED = 1e-11
"""Two recursions, and an inverse of M; relative to the largest joint wrench."""

SAMPLES = 4


@pytest.fixture(scope="module")
def model():
    return mixed_tree()


@pytest.fixture(scope="module")
def states(model):
    return JudgedStates.draw(model, SAMPLES, 3, needs_tau=True)


@pytest.fixture(scope="module")
def own(model):
    return DynamicsCode.of(model)


def answer(model, name, q, v, x):
    """Right answers by graphdyn's verbs."""
    arguments = {"mass_matrix": (q,), "mass_matrix_inverse": (q,), "gravity_torque": (q,), "bias_torque": (q, v)}
    verb = {"inverse_dynamics": "joint_torques", "forward_dynamics": "joint_accelerations"}.get(name, name)
    return getattr(graphdyn, verb)(model, *arguments.get(name, (q, v, x)))


JUDGED = (
    "inverse_dynamics", "forward_dynamics", "mass_matrix", "mass_matrix_inverse", "joint_torque_regressor",
    "bias_torque", "gravity_torque",
)  # fmt: skip


class TestRows:
    @pytest.mark.parametrize("name", JUDGED)
    def test_of_judged_states(self, model, states, own, name):
        """An error of one torque is left in its row only, relative to the largest joint wrench or entry."""
        given = states.tau if name == "forward_dynamics" else states.a
        right = answer(model, name, states.q, states.v, given)
        observed = of_judged(name, right, states)
        assert np.abs(observed.residuals([own])).max() < ROUNDED
        assert set(observed.part) == {"judged"}
        if name in ("inverse_dynamics", "bias_torque", "gravity_torque"):
            wrong = right.copy()
            wrong[1, 2] += 7.0
            (left,) = of_judged(name, wrong, states).residuals([own])
            v, a = (states.v if name != "gravity_torque" else 0 * states.v), 0 * states.v
            wrenches = graphdyn.inverse_dynamics(
                model, states.q, v, states.a if name == "inverse_dynamics" else a
            ).joint_wrenches
            size = max(np.abs(wrenches[1]).max(), np.abs(wrong[1]).max())
            expected = np.zeros_like(left)
            expected[1, 2] = -7.0 / size
            assert left == pytest.approx(expected, abs=ROUNDED)

    def test_loads_of_the_judged_states(self, model, own):
        """τ less what the loads take: of a code without loads nothing is left."""
        states = JudgedStates.draw(model, SAMPLES, 3, needs_tau=True, loaded=True)
        for name, given, verb in (
            ("inverse_dynamics", states.a, graphdyn.joint_torques),
            ("forward_dynamics", states.tau, graphdyn.joint_accelerations),
        ):
            right = verb(model, states.q, states.v, given, external_wrenches=states.loads)
            assert np.abs(of_judged(name, right, states).residuals([own])).max() < ROUNDED

    @pytest.mark.parametrize("name", [*JUDGED, "kinetic_energy", "coriolis_matrix"])
    def test_of_experiments(self, model, states, own, name):
        """What each function shows of g, M and c."""
        trial = states.trial
        assert trial.q.shape == (N_EXPERIMENT_STATES, model.n_bodies)

        def function(q, v=None, x=None):
            if name in ("kinetic_energy", "coriolis_matrix"):
                return getattr(graphdyn, name)(model, q, v)
            return answer(model, name, q, v, x)

        known = FUNCTIONS[name]
        tested = FunctionUnderTest(known, function, np.arange(model.n_bodies), batched=True)
        parts = observe(tested, trial, np.full(model.n_bodies, 30.0))
        expected = {
            "gravity": graphdyn.gravity_torque(model, trial.q),
            "inertia": graphdyn.mass_matrix(model, trial.q),
            "velocity": graphdyn.bias_torque(model, trial.q, trial.v) - graphdyn.gravity_torque(model, trial.q),
            "doubled": graphdyn.bias_torque(model, trial.q, 2 * trial.v) - graphdyn.gravity_torque(model, trial.q),
        }
        shown = {
            "mass_matrix": {"inertia"}, "mass_matrix_inverse": {"inertia"}, "kinetic_energy": {"inertia"},
            "gravity_torque": {"gravity"}, "bias_torque": {"gravity", "velocity", "doubled"},
            "coriolis_matrix": {"velocity", "doubled"},
        }.get(name, set(expected))  # fmt: skip
        for part, wanted in expected.items():
            found = getattr(parts, part)
            assert (found is not None) == (part in shown)
            if found is not None:
                np.testing.assert_allclose(found, wanted, atol=1e-9 * np.abs(wanted).max())
        observed = of_experiments(trial, parts)
        assert np.abs(observed.residuals([own])).max() < 1e3 * ROUNDED
        assert set(observed.part) == shown - {"doubled"}
        if name == "inverse_dynamics":
            tau = observed.torques()  # at rest, accelerated, moving
            n = model.n_bodies
            zero = 0 * trial.q
            rest, moving = (graphdyn.joint_torques(model, trial.q, v, zero) for v in (zero, trial.v))
            each = parts.acceleration * np.tile(np.eye(n), (len(zero), 1))
            repeated = np.repeat(trial.q, n, axis=0)
            faster = graphdyn.joint_torques(model, repeated, 0 * repeated, each)
            np.testing.assert_allclose(tau, np.concatenate([rest, faster, moving]), atol=1e-9 * np.abs(tau).max())

    def test_some_rows_and_the_rows_of_both(self, model, states, own):
        wrong = own.but(gravity=np.array([1.0, 2.0, 3.0]), masses=1.5 * own.numbers.masses)
        parts = split(torques(model), states.trial, usual_acceleration(states.trial))
        experiments = of_experiments(states.trial, parts)
        judged = of_judged("inverse_dynamics", 0.5 * torques(model)(states.q, states.v, states.a), states)
        first, second = (one.residuals([own, wrong]) for one in (experiments, judged))
        both = experiments.and_(judged)
        np.testing.assert_allclose(both.residuals([own, wrong]), np.concatenate([first, second], axis=1), atol=ROUNDED)
        chosen = np.random.default_rng(0).random(len(both.part)) < 0.4
        some = both.only(chosen)
        expected = np.concatenate([first, second], axis=1)[:, chosen]
        np.testing.assert_allclose(some.residuals([own, wrong]), expected, atol=ROUNDED)
        assert some.part.tolist() == both.part[chosen].tolist()
        assert len(some.state[0]) < len(both.state[0])

    def test_the_first_and_the_last_states(self, model, states):
        """Of 1, 2, 3, … states, the odd one among the first; all their rows."""
        trial = states.trial
        parts = split(torques(model), trial, 1.0)
        experiments = of_experiments(trial, parts)
        at = [next(k for k, q in enumerate(trial.q) if np.array_equal(q, x))
              for x in experiments.state[0][experiments.of]]  # fmt: skip
        for number in range(1, len(trial.q) + 1):
            first, last = (number + 1) // 2, number // 2
            wanted = {*range(first), *range(len(trial.q) - last, len(trial.q))}
            assert _of_states(experiments, number).tolist() == [k in wanted for k in at]


class TestParts:
    def test_sizes_and_deviations(self, model, states):
        """Relative to the largest entry, of differences to a joint wrench; c grows with the square of v."""
        trial = states.trial
        ours = split(torques(model), trial, 5.0)
        np.testing.assert_allclose(ours.doubled, 4 * ours.velocity, atol=1e-9 * np.abs(ours.doubled).max())
        q, v = trial.q, trial.v
        wrench = np.abs(graphdyn.inverse_dynamics(model, q, v, 0 * v).joint_wrenches).max()
        twice = split(lambda *state: 2 * torques(model)(*state), trial, 5.0)
        size = scales(trial, ours, twice)
        assert size == {
            "gravity": pytest.approx(max(wrench, 2 * np.abs(ours.gravity).max())),
            "inertia": pytest.approx(2 * np.abs(ours.inertia).max()),
            "velocity": pytest.approx(max(1e-3 * wrench, 2 * np.abs(ours.velocity).max())),
        }
        found = deviations(twice, ours, size)
        assert found == {part: pytest.approx(np.abs(getattr(ours, part)).max() / size[part]) for part in size}

    def test_usual_acceleration(self, model, states):
        """Inertia then takes as much as weight; 1 without gravity."""
        trial = states.trial
        weight = np.abs(graphdyn.inverse_dynamics(model, trial.q, 0 * trial.q, 0 * trial.q).joint_wrenches).max()
        expected = weight / np.abs(graphdyn.mass_matrix(model, trial.q)).max()
        assert expected > 1
        assert usual_acceleration(trial) == pytest.approx(expected)
        light = JudgedStates.draw(model.with_gravity(np.zeros(3)), SAMPLES, 3, needs_tau=False).trial
        assert usual_acceleration(light) == 1.0


class TestStates:
    def test_limits_and_whole_turns(self, model):
        """Random states within limits; ten more with turns added where a joint turns without end; the pose near 0."""
        low, high, speed = 0.4, 1.5, 2.0
        joints = [
            graphdyn.Joint(
                joint.name, joint.kind, joint.inside, joint.placement, joint.axis,
                JointLimits(lower=low, upper=high, velocity=speed, effort=1.0),
            )
            for joint in model.joints
        ]  # fmt: skip
        limited = graphdyn.RobotModel(model.name, model.bodies, joints, model.gravity, model.base)
        every = JudgedStates.draw(limited, SAMPLES, 5, needs_tau=True)
        assert len(every.q) == SAMPLES + N_TURNED_STATES + 1 + N_SPECIAL_STATES
        assert ((every.q >= low) & (every.q <= high))[:, [joint.kind != "continuous" for joint in joints]].all()
        assert (np.abs(every.v) <= speed).all()
        drawn = every.rows(np.arange(SAMPLES + N_TURNED_STATES + 1))
        endless = np.array([joint.kind == "continuous" for joint in joints])
        assert ((drawn.q[:, ~endless] >= low) & (drawn.q[:, ~endless] <= high)).all()
        assert (np.abs(drawn.v) <= speed).all()
        turned = drawn.q[SAMPLES:-1, endless]
        assert 2 * np.pi < np.abs(turned).max() <= 5 * np.pi
        assert np.abs(drawn.q[:SAMPLES, endless]).max() <= np.pi
        np.testing.assert_array_equal(drawn.q[-1], np.where(endless, 0.0, low))
        share = drawn.tau / graphdyn.joint_torques(limited, drawn.q, drawn.v, drawn.a)
        assert ((share >= 0.5 - 1e-9) & (share <= 1.5 + 1e-9)).all()
        assert share.min() < 0.7 < 1.3 < share.max()
        beyond = JudgedStates.draw(limited, 50, 5, needs_tau=False, beyond_limits=True)
        added = slice(50, 60)
        q, v = beyond.q[added][:, ~endless], beyond.v[added]
        outside = (q < low) | (q > high)
        assert 0.2 < outside.mean() < 0.8
        assert ((q > low - 0.5 * (high - low)) & (q < high + 0.5 * (high - low))).all()
        assert (q < low).any()
        assert (q > high).any()
        assert speed < np.abs(v).max() <= 1.5 * speed
        np.testing.assert_array_equal(beyond.q[:50], JudgedStates.draw(limited, 50, 5, needs_tau=False).q[:50])
