"""crosscheck.judge: codes that agree, verdicts, and the reference implementations."""

import sys

import numpy as np
import pinocchio
import pytest
from faults.textbook import TextbookArm
from faults.textbook_faults import WRIST_LOCKED
from planting import mixed_tree, with_body

import crosscheck
import urdf
from crosscheck.judging.special_states import N_SPECIAL_STATES
from crosscheck.judging.states import N_TURNED_STATES
from crosscheck.reference.mujoco_model import MujocoModel, MujocoRefuses
from graphdyn import inverse_dynamics, joint_torque_regressor, kr500

SAMPLES = 5
ALL_STATES = SAMPLES + N_TURNED_STATES + 1 + N_SPECIAL_STATES


ALIKE = 1e-12
"""Two references on one scale: some hundred roundings each."""


def rnea(model):
    return lambda q, v, a: inverse_dynamics(model, q, v, a).tau


class TestAgreement:
    @pytest.mark.parametrize("robot", ["kr500", "ur5", "kinova"])
    def test_textbook(self, robot):
        textbook = TextbookArm.of(urdf.load(robot))
        judgment = crosscheck.judge(
            robot,
            inverse_dynamics=textbook.inverse_dynamics,
            forward_dynamics=textbook.forward_dynamics,
            mass_matrix=textbook.mass_matrix,
            samples=SAMPLES,
        )
        assert judgment.agrees
        assert judgment.decided
        assert judgment.diagnoses == ()
        assert set(judgment.functions) == {"inverse_dynamics", "forward_dynamics", "mass_matrix"}
        for function in judgment.functions.values():
            assert all(error.max() <= ALIKE for error in function.errors.values())
            assert all(len(error) == ALL_STATES for error in function.errors.values())

    @pytest.mark.parametrize("robot", ["ur5", "ur3_gripper"])
    def test_pinocchio_as_its_user_calls_it(self, robot):
        """Built from the file; its joint order, which sorts siblings, is given by name."""
        entry = {entry.name: entry for entry in urdf.robots()}.get(robot)
        if entry is None:
            pytest.skip(f"robot {robot} is not in the installed catalog")
        native = pinocchio.buildModelFromUrdf(str(entry.path))
        data = native.createData()
        if native.nq != native.nv:
            pytest.skip("continuous joints take (cos, sin)")
        judgment = crosscheck.judge(
            robot,
            inverse_dynamics=lambda q, v, a: pinocchio.rnea(native, data, q, v, a),
            forward_dynamics=lambda q, v, tau: pinocchio.aba(native, data, q, v, tau),
            mass_matrix=lambda q: pinocchio.crba(native, data, q),
            joint_torque_regressor=lambda q, v, a: pinocchio.computeJointTorqueRegressor(native, data, q, v, a),
            joint_names=list(native.names[1:]),
            samples=SAMPLES,
        )
        assert judgment.agrees
        assert judgment.joint_names == tuple(native.names[1:])

    def test_mujoco_as_foreign_code(self, ur5):
        pytest.importorskip("mujoco", reason="the package mujoco is not installed")
        tested = MujocoModel(ur5)

        def call(name):
            def function(*arguments):
                q, *others = (x[None] for x in arguments)
                v, last = others or (0 * q, 0 * q)
                return tested.evaluate(q, v, last, last)[name][0]

            return function

        names = ("inverse_dynamics", "forward_dynamics", "mass_matrix")
        assert crosscheck.judge("ur5", **{name: call(name) for name in names}, samples=SAMPLES).agrees

    def test_any_tree(self):
        tree = mixed_tree()
        textbook = TextbookArm.of(tree.with_base(type(tree.base)()))
        judgment = crosscheck.judge(
            tree.with_base(type(tree.base)()), inverse_dynamics=textbook.inverse_dynamics, samples=SAMPLES
        )
        assert judgment.agrees
        assert judgment.robot == tree.name

    def test_locked_joints_and_gravity_are_passed_on(self):
        moon = (0, 0, -1.62)
        model = urdf.load("z1", lock=["jointGripper"], gravity=moon)
        judgment = crosscheck.judge("z1", inverse_dynamics=rnea(model), samples=1, lock=["jointGripper"], gravity=moon)
        assert judgment.agrees
        assert judgment.locked == {"jointGripper": 0.0}

    @pytest.mark.usefixtures("undiagnosed")
    def test_another_joint_order(self, textbook, ur5):
        order = [3, 0, 5, 1, 4, 2]
        names = [ur5.joint_names[k] for k in order]
        back = np.argsort(order)

        def tested(q, v, a):
            return textbook.inverse_dynamics(q[back], v[back], a[back])[order]

        def mass_matrix(q):
            return textbook.mass_matrix(q[back])[np.ix_(order, order)]

        def regressor(q, v, a):
            ours = joint_torque_regressor(ur5, q[back], v[back], a[back]).reshape(6, 6, 10)
            return ours[np.ix_(order, order)].reshape(6, 60)

        given = {"inverse_dynamics": tested, "mass_matrix": mass_matrix, "joint_torque_regressor": regressor}
        assert crosscheck.judge("ur5", **given, joint_names=names, samples=SAMPLES).agrees
        assert not crosscheck.judge("ur5", inverse_dynamics=tested, samples=1).agrees


class TestVerdict:
    def test_two_against_one(self, wrong_judgment):
        (function,) = wrong_judgment.functions.values()
        assert not wrong_judgment.agrees
        assert wrong_judgment.decided
        assert function.errors["pinocchio"].max() == pytest.approx(function.errors["graphdyn"].max())
        assert function.references_differ["pinocchio"].max() <= ALIKE

    def test_worst_call_reproduces(self, wrong_judgment, textbook, ur5):
        faulty = textbook.but(cross=-1.0).inverse_dynamics
        worst = wrong_judgment.functions["inverse_dynamics"].worst
        state = [np.array(worst.arguments[name]) for name in "qva"]
        assert np.array_equal(faulty(*state), worst.answer)
        assert np.allclose(inverse_dynamics(ur5, *state).tau, worst.expected, rtol=0, atol=1e-12)

    def test_references_that_differ_decide_nothing(self, textbook, plant, monkeypatch):
        """Without exact values, which a hint names."""
        monkeypatch.setitem(sys.modules, "flint", None)
        plant.pinocchio_value("tau", lambda x: x * 1.01)
        with pytest.raises(crosscheck.WrongDynamics, match="UNDECIDED") as caught:
            crosscheck.assert_correct("ur5", inverse_dynamics=textbook.inverse_dynamics, samples=SAMPLES)
        judgment = caught.value.judgment
        assert not judgment.decided
        assert judgment.verdict == "UNDECIDED"
        assert any("the reference implementations disagree: no verdict" in note for note in judgment.notes)
        assert any("python -m pip install 'graphdyn[exact]'" in note for note in judgment.notes)

    def test_nan_is_no_agreement(self, textbook):
        judgment = crosscheck.judge(
            "ur5",
            inverse_dynamics=lambda q, v, a: np.where(q > 1, np.nan, textbook.inverse_dynamics(q, v, a)),
            samples=30,
        )
        assert not judgment.agrees
        assert judgment.diagnoses[0].message == "the answers are not finite"

    @pytest.mark.usefixtures("undiagnosed")
    def test_tolerance(self):
        short = urdf.load("ur5", lock=WRIST_LOCKED)

        def rounded(q, v, a):
            return inverse_dynamics(short, q, v, a).tau * (1 + 1e-7)

        assert not crosscheck.judge(short, inverse_dynamics=rounded, samples=1).agrees
        assert crosscheck.judge(short, inverse_dynamics=rounded, samples=1, tolerance=1e-6).agrees

    def test_whole_turns_are_judged(self):
        """Where a joint turns without end; within the limits nothing is wrong."""
        model = kr500()
        arm = TextbookArm.of(model)

        def cut(q, v, a):
            return arm.inverse_dynamics(np.clip(q, -np.pi, np.pi), v, a)

        (diagnosis,) = crosscheck.judge(model, inverse_dynamics=cut, samples=1).diagnoses
        assert diagnosis.kind == "continuous_joint"

    @pytest.mark.parametrize("limits", ['lower="-1" upper="2"', 'lower="0.5" upper="2"', 'lower="-1" upper="-0.5"'])
    def test_limits_are_kept(self, small_arm, limits):
        """The second joint has limits, perhaps without zero: user code may refuse what lies beyond."""
        text = small_arm.read_text(encoding="utf-8")
        small_arm.write_text(text.replace('lower="-1" upper="2"', limits), encoding="utf-8")
        model = urdf.load(small_arm)
        lower, upper = model.joints[1].limits.lower, model.joints[1].limits.upper

        def within(q, v, a):
            assert lower <= q[1] <= upper
            return inverse_dynamics(model, q, v, a).tau

        assert crosscheck.judge(small_arm, inverse_dynamics=within, samples=50).agrees

    def test_forward_dynamics_without_an_answer(self):
        short = urdf.load("ur5", lock=WRIST_LOCKED)
        judgment = crosscheck.judge(short, forward_dynamics=lambda q, v, tau: np.ones(3), samples=1)
        assert "M⁻¹ from unit torques is singular" in judgment.diagnoses[0].message

    def test_the_same_fault_of_two_functions_is_said_once(self):
        short = urdf.load("ur5", lock=WRIST_LOCKED)
        wrong = TextbookArm.of(short.with_gravity(-short.gravity))
        judgment = crosscheck.judge(
            short, inverse_dynamics=wrong.inverse_dynamics, forward_dynamics=wrong.forward_dynamics, samples=1
        )
        (diagnosis,) = judgment.diagnoses
        assert diagnosis.function == "inverse_dynamics, forward_dynamics"


class TestReferees:
    def test_without_mujoco(self, textbook, monkeypatch):
        monkeypatch.setitem(sys.modules, "mujoco", None)
        judgment = crosscheck.judge("ur5", inverse_dynamics=textbook.inverse_dynamics, samples=1)
        assert judgment.agrees
        assert judgment.references == ("graphdyn", "pinocchio")
        assert judgment.notes == (
            "MuJoCo is not among the reference implementations: the package mujoco is not installed; run: "
            "python -m pip install 'graphdyn[mujoco]'",
        )

    def test_what_mujoco_cannot_represent(self):
        pytest.importorskip("mujoco", reason="the package mujoco is not installed")
        odd = with_body(kr500(), 3, inertia=np.diag([1.0, 1.0, 5.0]))
        with pytest.raises(MujocoRefuses, match=r"MuJoCo cannot represent robot 'kr500': .*inertia"):
            MujocoModel(odd)
        judgment = crosscheck.judge(odd, inverse_dynamics=rnea(odd), samples=1)
        assert judgment.agrees
        assert judgment.references == ("graphdyn", "pinocchio")

    @pytest.mark.parametrize("load", [kr500, lambda: urdf.load("ur5"), mixed_tree], ids=["kr500", "ur5", "tree"])
    def test_mujoco_agrees(self, load):
        pytest.importorskip("mujoco", reason="the package mujoco is not installed")
        robot = load()
        judgment = crosscheck.judge(robot, inverse_dynamics=rnea(robot), mass_matrix=None, samples=SAMPLES)
        (function,) = judgment.functions.values()
        assert function.references_differ["mujoco"].max() <= ALIKE
