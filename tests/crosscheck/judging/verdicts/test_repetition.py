"""How a function under test behaves from call to call, and where among the states it fails or deviates."""

import json
import re

import numpy as np
import pytest
from faults.single_precision import single_precision
from faults.textbook import TextbookArm
from faults.textbook_faults import WRIST_LOCKED
from long_check import few

import crosscheck
import graphdyn
import urdf
from crosscheck.commands.judge.record import record
from crosscheck.commands.judge.report import judge_report
from crosscheck.judging.special_states import N_SPECIAL_STATES
from crosscheck.judging.states import N_TURNED_STATES
from crosscheck.judging.verdicts.regions import region, roundest
from crosscheck.quantities import FUNCTIONS
from crosscheck.quantities.tested_function import Refusal
from crosscheck.quantities.tolerances import FUNCTION_UNDER_TEST, FUNCTION_UNDER_TEST_SINGLE
from crosscheck.report.records.record import plain
from crosscheck.report.text import as_text
from graphdyn import InvalidInput

SAMPLES = 60
ALL_STATES = SAMPLES + N_TURNED_STATES + 1 + N_SPECIAL_STATES
FAR = "only where q of joint 'elbow_joint' > 2.5 rad"
REACTIONS = {f"d{of}_d{x}" for of in ("multipliers", "wrenches") for x in "qva"}
"""Their programs take seconds to record; dtau_dq stands for them."""

ELBOW, LIFT = 2, 1
"""Numbers of the joints with faults."""


@pytest.fixture(scope="module")
def arm():
    return urdf.load("ur5", lock=WRIST_LOCKED)


def tau_of(model):
    return TextbookArm.of(model).inverse_dynamics


def judged(f, samples=SAMPLES, **options):
    return crosscheck.judge("ur5", inverse_dynamics=f, samples=samples, **options)


def only(judgment):
    assert not judgment.agrees
    (diagnosis,) = judgment.diagnoses
    return diagnosis


class TestStateBetweenCalls:
    @pytest.mark.parametrize(
        ("stale", "message"),
        [
            (["q"], "q is that of the call before"),
            (["q", "v"], "q and v are those of the call before"),
            (["q", "v", "a"], "q and v and a are those of the call before"),
        ],
    )
    def test_arguments_of_the_call_before(self, ur5, stale, message):
        kept = {}

        def delayed(q, v, a):
            now = {"q": q.copy(), "v": v.copy(), "a": a.copy()}
            used = {**now, **{name: kept.get(name, now[name]) for name in stale}}
            kept.update(now)
            return tau_of(ur5)(used["q"], used["v"], used["a"])

        diagnosis = only(judged(delayed))
        assert (diagnosis.kind, diagnosis.message) == ("kept_state", message)
        asked_again = rf"asked again in the reverse order, 8[4-9] of {ALL_STATES} answers differ, by a relative"
        assert re.match(asked_again, diagnosis.evidence)  # the next call may have the same positions
        assert diagnosis.explains <= FUNCTION_UNDER_TEST.bound

    def test_what_is_computed_once(self, ur5):
        kept = []

        def once(q):
            kept.append(graphdyn.mass_matrix(ur5, q))
            return kept[0]

        judgment = crosscheck.judge("ur5", mass_matrix=once, samples=SAMPLES)
        assert only(judgment).message == "q is that of the first call"

    def test_an_order_that_matters_in_another_way(self, ur5):
        """Once it has seen a stretched elbow, it stays off."""
        seen = []

        def spoilt(q, v, a):
            seen.append(q[ELBOW] > 2.5)
            return tau_of(ur5)(q, v, a) + 1e-3 * any(seen)

        diagnosis = only(judged(spoilt))
        assert (diagnosis.kind, diagnosis.message) == ("kept_state", "an answer depends on the calls before it")

    def test_right_the_first_time_alone(self, ur5):
        """The first round agrees at every state; it does not count as agreement."""
        calls = []

        def worn(q, v, a):
            calls.append(1)
            return tau_of(ur5)(q, v, a) + 1e-3 * (len(calls) > ALL_STATES)

        judgment = judged(worn)
        (function,) = judgment.functions.values()
        assert function.within(function.errors)
        assert only(judgment).kind == "kept_state"
        assert function.repeated.min() > FUNCTION_UNDER_TEST.bound
        assert "inverse_dynamics: other answers when asked again." in as_text(judge_report(judgment), 100)

    def test_not_repeatable(self, ur5):
        rng = np.random.default_rng(1)
        diagnosis = only(judged(lambda q, v, a: tau_of(ur5)(q, v, a) + 1e-5 * rng.normal(size=6)))
        assert diagnosis.kind == "not_repeatable"
        assert diagnosis.message == "the same question, asked several times in a row, has different answers"

    def test_an_answer_only_the_first_time(self, ur5):
        calls = []

        def tired(q, v, a):
            calls.append(1)
            if len(calls) > ALL_STATES:
                raise RuntimeError("tired")
            return tau_of(ur5)(q, v, a)

        diagnosis = only(judged(tired))
        assert diagnosis.kind == "kept_state"
        assert diagnosis.evidence.endswith(f"{ALL_STATES} of {ALL_STATES} answers differ, or fail")

    def test_a_memory_that_does_no_harm(self, ur5):
        memory = np.empty(6)

        def reused(q, v, a):
            memory[:] = tau_of(ur5)(q, v, a)
            return memory

        judgment = judged(reused)
        assert judgment.agrees
        assert judgment.functions["inverse_dynamics"].repeated.max() == 0.0

    def test_changed_arguments_are_told(self, ur5):
        def destructive(q, v, a):
            tau = tau_of(ur5)(q, v, a)
            q[0] += 1
            a *= 0
            return tau

        judgment = judged(destructive, samples=3)
        assert judgment.agrees
        assert judgment.notes == (
            "inverse_dynamics changes its argument a: give it a copy",
            "inverse_dynamics changes its argument q: give it a copy",
        )


@pytest.fixture(scope="module")
def failing(ur5):
    def narrow(q, v, a):
        if q[ELBOW] > 2.5:
            raise ValueError("elbow too far")
        return tau_of(ur5)(q, v, a)

    return judged(narrow)


class TestSingleStates:
    def test_the_others_are_judged(self, failing):
        (function,) = failing.functions.values()
        q = crosscheck.judging.states.JudgedStates.draw(failing.model, SAMPLES, 0, needs_tau=False).q
        expected = np.flatnonzero(q[:, ELBOW] > 2.5)
        assert [failure.number for failure in function.failures] == expected.tolist()
        assert all(len(errors) == ALL_STATES - len(expected) for errors in function.errors.values())
        assert function.within(function.errors)
        assert not function.agrees

    def test_they_are_named(self, failing):
        diagnosis = only(failing)
        assert diagnosis.kind == "no_answer"
        assert diagnosis.message == f"no answer at 14 of {ALL_STATES} states, {FAR}"
        assert diagnosis.evidence.startswith("inverse_dynamics raised ValueError: elbow too far (")

    def test_they_are_shown(self, failing):
        text = " ".join(as_text(judge_report(failing), 100).split())
        assert "Your functions on ur5: DISAGREES inverse_dynamics: no answer at single states. " in text
        assert "States without an answer inverse_dynamics states " in text
        written = plain(record(failing, []))["functions"]["inverse_dynamics"]["failures"]
        assert len(written) == 14
        assert set(written[0]) == {"number", "message"}
        json.dumps(written, allow_nan=False)

    def test_refusals_of_a_batch(self, ur5):
        class Batch:
            def answers(self, function, states, shape):
                assert (function, shape) == ("inverse_dynamics", (6,))
                return [Refusal("too far") if state["q"][ELBOW] > 2.5 else tau_of(ur5)(**state) for state in states]

        diagnosis = only(judged(Batch()))
        assert diagnosis.message == f"no answer at 14 of {ALL_STATES} states, {FAR}"
        assert diagnosis.evidence.startswith("inverse_dynamics has no answer: too far; at q = [")

    def test_numbers_that_are_not_finite(self, ur5):
        diagnosis = only(judged(lambda q, v, a: tau_of(ur5)(q, v, a) + (np.nan if q[ELBOW] > 2.5 else 0.0)))
        assert diagnosis.message == "the answers are not finite, only where q of joint 'elbow_joint' > 2.5 rad"
        assert diagnosis.evidence == f"14 of {ALL_STATES} answers, {FAR}"

    @pytest.mark.parametrize("name", ["bias_torque", "inverse_dynamics"])
    def test_absurd_numbers(self, name):
        judgment = crosscheck.judge("ur5", **{name: lambda *state: np.full(6, 1e300)}, samples=3)
        assert only(judgment).message == "answers beyond 1e+100"

    def test_shapes_that_differ(self, ur5):
        with pytest.raises(
            crosscheck.judging.observing.function_under_test.FunctionFailure,
            match=r"returned different shapes at different sta",
        ):
            crosscheck.judge(
                "ur5",
                base_regressor=lambda q, v, a: graphdyn.joint_torque_regressor(ur5, q, v, a)[:, : 60 - (q[0] > 0)],
                samples=5,
            )


REGIONS = {
    "q of joint 'elbow_joint' > 2 rad": lambda m, q, v, a: q[ELBOW] > 2,
    "q of joint 'elbow_joint' < -1.5 rad": lambda m, q, v, a: q[ELBOW] < -1.5,
    "∣v∣ of joint 'shoulder_lift_joint' > 2.52 rad/s (80 % of its limit)": (
        lambda m, q, v, a: abs(v[LIFT]) > 0.8 * m.joints[LIFT].limits.velocity
    ),
    "q of joint 'shoulder_pan_joint' > 0 rad and a of joint 'shoulder_lift_joint' > 3 rad/s²": (
        lambda m, q, v, a: q[0] > 0 and a[LIFT] > 3
    ),
}
"""What is said of a region, and which states lie in it."""


class TestRegions:
    @pytest.mark.parametrize("where", REGIONS)
    def test_said(self, arm, where):
        states = crosscheck.judging.states.JudgedStates.draw(arm, 100, 0, needs_tau=False)
        chosen = [bool(REGIONS[where](arm, *state)) for state in zip(states.q, states.v, states.a, strict=True)]
        assert region(np.array(chosen), states, ("q", "v", "a")) == where

    @pytest.mark.parametrize("where", few(REGIONS, list(REGIONS)[-1]))
    def test_found(self, arm, where):
        def tested(q, v, a):
            return tau_of(arm)(q, v, a) + 0.3 * bool(REGIONS[where](arm, q, v, a))

        diagnosis = only(judged(tested, samples=100, lock=WRIST_LOCKED))
        assert (diagnosis.kind, diagnosis.message) == ("region", f"the answers deviate only where {where}")
        assert diagnosis.evidence.endswith(f"states deviate, only where {where}")

    def test_chance_is_no_region(self, ur5):
        """Two of 89 states, at random; eight of them at rest or nearly: some quantity always separates them."""
        states = crosscheck.judging.states.JudgedStates.draw(ur5, SAMPLES, 0, needs_tau=False)
        for seed in range(200):
            chosen = np.zeros(ALL_STATES, dtype=bool)
            chosen[np.random.default_rng(seed).choice(len(chosen), 2, replace=False)] = True
            assert region(chosen, states, ("q", "v", "a")) is None

    @pytest.mark.parametrize(("count", "said"), [(4, False), (5, False), (7, True)])
    def test_two_thresholds_may_be_chance(self, ur5, count, said):
        """80 sides of 40 quantities, 80 places of the second threshold: 80² · 80 / C(80, k) is 3e-1, 2e-2, 2e-4."""
        states = crosscheck.judging.states.JudgedStates.draw(ur5, SAMPLES, 0, needs_tau=False)
        (x, y), above = states.q[:, :2].T, states.q[:, 0] > np.median(states.q[:, 0])
        chosen = above & (y >= np.sort(y[above])[-count])
        assert chosen.sum() == count < (x >= x[chosen].min()).sum()
        assert (region(chosen, states, ("q", "v", "a")) is not None) is said

    def test_no_state_and_all_states_are_no_region(self, ur5):
        states = crosscheck.judging.states.JudgedStates.draw(ur5, 3, 0, needs_tau=False)
        for all_or_none in (np.ones(len(states.q), dtype=bool), np.zeros(len(states.q), dtype=bool)):
            assert region(all_or_none, states, "q") is None

    @pytest.mark.parametrize(
        ("x", "y", "between"),
        [(1.93, 2.14, 2.0), (-0.02, 0.03, 0.0), (0.71, 0.752, 0.75), (-3.3, -2.6, -3.0), (480.0, 770.0, 500.0)],
    )
    def test_the_roundest_number_between(self, x, y, between):
        assert roundest(x, y) == roundest(y, x) == between

    @pytest.mark.usefixtures("undiagnosed")
    def test_beyond_the_limits(self, arm):
        """A function that cuts off at the limits is right within them."""
        lower, upper = np.transpose([(joint.limits.lower, joint.limits.upper) for joint in arm.joints])

        def cut(q, v, a):
            return tau_of(arm)(np.clip(q, lower, upper), v, a)

        assert judged(cut, lock=WRIST_LOCKED).agrees
        judgment = judged(cut, beyond_limits=True, lock=WRIST_LOCKED)
        assert not judgment.agrees
        assert judgment.beyond_limits
        (function,) = judgment.functions.values()
        assert all(len(errors) == ALL_STATES + SAMPLES // 5 for errors in function.errors.values())
        assert (function.largest_errors[:SAMPLES] <= function.bound).all()

    def test_a_fault_beyond_the_limits_of_velocity(self, arm):
        limit = arm.joints[LIFT].limits.velocity

        def saturated(q, v, a):
            return tau_of(arm)(q, v, a) * (1.1 if abs(v[LIFT]) > limit else 1.0)

        diagnosis = only(judged(saturated, samples=100, lock=WRIST_LOCKED, beyond_limits=True))
        limits = "v is beyond the velocity limits of joint 'shoulder_lift_joint'"
        assert diagnosis.message == f"the answers deviate only where {limits}"


class TestPrecision:
    @pytest.mark.parametrize("name", sorted(set(FUNCTIONS) - {"frame_placement", *REACTIONS}))
    def test_single(self, arm, name):
        """The recursions in single precision: no agreement in double, agreement in single."""
        options = {name: single_precision(arm, name, "wrist_3_link"), "frame": "wrist_3_link", "batched": True}
        judgment = crosscheck.judge(arm, **options, precision="single", samples=10)
        assert judgment.agrees
        (function,) = judgment.functions.values()
        assert (
            FUNCTION_UNDER_TEST.bound
            < function.largest_errors.max()
            <= function.bound
            == FUNCTION_UNDER_TEST_SINGLE.bound
        )
        assert judgment.precision == "single"

    @pytest.mark.usefixtures("undiagnosed")
    def test_tolerance_comes_first(self, ur5):
        f = single_precision(ur5, "inverse_dynamics")
        assert not judged(f, precision="single", tolerance=1e-12, batched=True, samples=3).agrees
        with pytest.raises(InvalidInput, match="precision is 'half'; give one of 'double', 'single'"):
            judged(f, precision="half")
