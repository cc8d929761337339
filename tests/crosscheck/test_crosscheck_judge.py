"""crosscheck.judge: verdicts, arguments, referees, texts."""

import dataclasses
import json
import math
import operator
import re
import subprocess
import sys
import textwrap

import numpy as np
import pinocchio
import pytest
from planting import mixed_tree, with_body
from rich.cells import cell_len
from shared_data import ARMS, existing
from textbook import TextbookArm

import crosscheck
import graphdyn
import urdf
from crosscheck.judging.foreign import ForeignFailure
from crosscheck.referee.mujoco_model import MujocoModel, MujocoRefuses
from crosscheck.referee.pinocchio_model import PinocchioModel
from crosscheck.report.commands.judge import judge_report
from crosscheck.report.json import plain
from crosscheck.report.records.judge import record as record_of
from crosscheck.report.text import as_text
from graphdyn import InvalidInput, SingularMassMatrix, inverse_dynamics, joint_torque_regressor, kr500

pytest_plugins = ["pytester"]

SAMPLES = 5
ALIKE = 1e-12
"""Two referees on one scale: some hundred roundings each."""


@pytest.fixture(scope="module")
def ur5():
    return urdf.load("ur5")


@pytest.fixture(scope="module")
def arm(ur5):
    return TextbookArm.of(ur5)


@pytest.fixture(scope="module")
def wrong(arm):
    return crosscheck.judge("ur5", inverse_dynamics=arm.but(cross=-1.0).inverse_dynamics, samples=SAMPLES)


def rnea(model):
    return lambda q, v, a: inverse_dynamics(model, q, v, a).tau


class TestAgreement:
    @pytest.mark.parametrize("robot", ["kr500", "ur5", "kinova"])
    def test_textbook(self, robot):
        arm = TextbookArm.of(urdf.load(robot))
        judgement = crosscheck.judge(
            robot,
            inverse_dynamics=arm.inverse_dynamics,
            forward_dynamics=arm.forward_dynamics,
            mass_matrix=arm.mass_matrix,
            samples=SAMPLES,
        )
        assert judgement.agrees
        assert judgement.decided
        assert judgement.diagnoses == ()
        assert set(judgement.functions) == {"inverse_dynamics", "forward_dynamics", "mass_matrix"}
        for function in judgement.functions.values():
            assert all(error.max() <= ALIKE for error in function.errors.values())
            assert all(len(error) == SAMPLES + 11 for error in function.errors.values())

    @pytest.mark.parametrize("robot", ["ur5", "ur3_gripper"])
    def test_pinocchio_as_its_user_calls_it(self, robot):
        """Built from the file; its joint order, which sorts siblings, is given by name."""
        entry = {entry.name: entry for entry in urdf.robots()}.get(robot)
        if entry is None:
            pytest.skip(f"robot {robot} is not in the installed catalogue")
        native = pinocchio.buildModelFromUrdf(str(entry.path))
        data = native.createData()
        if native.nq != native.nv:
            pytest.skip("continuous joints take (cos, sin)")
        judgement = crosscheck.judge(
            robot,
            inverse_dynamics=lambda q, v, a: pinocchio.rnea(native, data, q, v, a),
            forward_dynamics=lambda q, v, tau: pinocchio.aba(native, data, q, v, tau),
            mass_matrix=lambda q: pinocchio.crba(native, data, q),
            regressor=lambda q, v, a: pinocchio.computeJointTorqueRegressor(native, data, q, v, a),
            joint_names=list(native.names[1:]),
            samples=SAMPLES,
        )
        assert judgement.agrees
        assert judgement.joint_names == tuple(native.names[1:])

    def test_mujoco_as_foreign_code(self, ur5):
        pytest.importorskip("mujoco", reason="the package mujoco is not installed")
        foreign = MujocoModel(ur5)

        def call(name):
            def function(*arguments):
                q, *others = (x[None] for x in arguments)
                v, last = others or (0 * q, 0 * q)
                return foreign.evaluate(q, v, last, last)[name][0]

            return function

        names = ("inverse_dynamics", "forward_dynamics", "mass_matrix")
        assert crosscheck.judge("ur5", **{name: call(name) for name in names}, samples=SAMPLES).agrees

    def test_any_tree(self):
        tree = mixed_tree()
        arm = TextbookArm.of(tree.with_base(type(tree.base)()))
        judgement = crosscheck.judge(
            tree.with_base(type(tree.base)()), inverse_dynamics=arm.inverse_dynamics, samples=SAMPLES
        )
        assert judgement.agrees
        assert judgement.robot == tree.name

    def test_locked_joints_and_gravity_are_passed_on(self):
        moon = (0, 0, -1.62)
        model = urdf.load("z1", lock=["jointGripper"], gravity=moon)
        judgement = crosscheck.judge("z1", inverse_dynamics=rnea(model), samples=1, lock=["jointGripper"], gravity=moon)
        assert judgement.agrees
        assert judgement.locked == {"jointGripper": 0.0}

    def test_another_joint_order(self, arm, ur5):
        order = [3, 0, 5, 1, 4, 2]
        names = [ur5.joint_names[k] for k in order]
        back = np.argsort(order)

        def foreign(q, v, a):
            return arm.inverse_dynamics(q[back], v[back], a[back])[order]

        def mass_matrix(q):
            return arm.mass_matrix(q[back])[np.ix_(order, order)]

        def regressor(q, v, a):
            ours = joint_torque_regressor(ur5, q[back], v[back], a[back]).reshape(6, 6, 10)
            return ours[np.ix_(order, order)].reshape(6, 60)

        given = {"inverse_dynamics": foreign, "mass_matrix": mass_matrix, "regressor": regressor}
        assert crosscheck.judge("ur5", **given, joint_names=names, samples=SAMPLES).agrees
        assert not crosscheck.judge("ur5", **given, samples=SAMPLES).agrees


class TestVerdict:
    def test_two_against_one(self, arm):
        judgement = crosscheck.judge("ur5", inverse_dynamics=arm.but(cross=-1.0).inverse_dynamics, samples=SAMPLES)
        (function,) = judgement.functions.values()
        assert not judgement.agrees
        assert judgement.decided
        assert function.errors["pinocchio"].max() == pytest.approx(function.errors["graphdyn"].max())
        assert function.referees_differ["pinocchio"].max() <= ALIKE

    def test_worst_call_reproduces(self, arm, ur5):
        faulty = arm.but(cross=-1.0).inverse_dynamics
        judgement = crosscheck.judge("ur5", inverse_dynamics=faulty, samples=SAMPLES)
        worst = judgement.functions["inverse_dynamics"].worst
        state = [np.array(worst.arguments[name]) for name in "qva"]
        assert np.array_equal(faulty(*state), worst.answer)
        assert np.allclose(inverse_dynamics(ur5, *state).tau, worst.expected, rtol=0, atol=1e-12)

    def test_referees_that_differ_decide_nothing(self, arm, plant):
        plant.referee_value("tau", lambda x: x * 1.01)
        with pytest.raises(crosscheck.WrongDynamics, match="UNDECIDED") as caught:
            crosscheck.assert_correct("ur5", inverse_dynamics=arm.inverse_dynamics, samples=SAMPLES)
        judgement = caught.value.judgement
        assert not judgement.decided
        assert judgement.verdict == "UNDECIDED"
        assert any("the reference implementations disagree" in note for note in judgement.notes)

    def test_nan_is_no_agreement(self, arm):
        judgement = crosscheck.judge(
            "ur5", inverse_dynamics=lambda q, v, a: np.where(q > 1, np.nan, arm.inverse_dynamics(q, v, a)), samples=30
        )
        assert not judgement.agrees
        assert judgement.diagnoses[0].message == "the answers are not finite"

    def test_tolerance(self, arm):
        def rounded(q, v, a):
            return arm.inverse_dynamics(q, v, a) * (1 + 1e-7)

        assert not crosscheck.judge("ur5", inverse_dynamics=rounded, samples=1).agrees
        assert crosscheck.judge("ur5", inverse_dynamics=rounded, samples=1, tolerance=1e-6).agrees

    def test_whole_turns_are_judged(self):
        """Where a joint turns without end; within the limits nothing is wrong."""
        model = kr500()

        def cut(q, v, a):
            return inverse_dynamics(model, np.clip(q, -np.pi, np.pi), v, a).tau

        (diagnosis,) = crosscheck.judge(model, inverse_dynamics=cut, samples=SAMPLES).diagnoses
        assert diagnosis.kind == "continuous_joint"

    @pytest.mark.parametrize("limits", ['lower="-1" upper="2"', 'lower="0.5" upper="2"', 'lower="-1" upper="-0.5"'])
    def test_limits_are_kept(self, small_arm, limits):
        """The second joint has limits, perhaps without zero: foreign code may refuse what lies beyond."""
        text = small_arm.read_text(encoding="utf-8")
        small_arm.write_text(text.replace('lower="-1" upper="2"', limits), encoding="utf-8")
        model = urdf.load(small_arm)
        lower, upper = model.joints[1].limits.lower, model.joints[1].limits.upper

        def within(q, v, a):
            assert lower <= q[1] <= upper
            return inverse_dynamics(model, q, v, a).tau

        assert crosscheck.judge(small_arm, inverse_dynamics=within, samples=50).agrees

    def test_forward_dynamics_without_an_answer(self):
        judgement = crosscheck.judge("ur5", forward_dynamics=lambda q, v, tau: np.ones(6), samples=1)
        assert "M⁻¹ from unit torques is singular" in judgement.diagnoses[0].message

    def test_the_same_fault_of_two_functions_is_said_once(self, arm):
        wrong = arm.but(gravity=-arm.gravity)
        judgement = crosscheck.judge(
            "ur5", inverse_dynamics=wrong.inverse_dynamics, forward_dynamics=wrong.forward_dynamics, samples=1
        )
        (diagnosis,) = judgement.diagnoses
        assert diagnosis.function == "inverse_dynamics, forward_dynamics"


def single_precision(model):
    """M⁻¹ (τ − h), the last step rounded to single precision."""

    def forward_dynamics(q, v, tau):
        mass, rest = graphdyn.mass_matrix(model, q), tau - graphdyn.bias_torque(model, q, v)
        return np.linalg.solve(mass.astype(np.float32), rest.astype(np.float32))

    return forward_dynamics


def wrong_gravity(model):
    other = model.with_gravity(model.gravity * 9.811 / np.linalg.norm(model.gravity))
    return lambda q, v, tau: graphdyn.forward_dynamics(other, q, v, tau).a


class TestBackwardError:
    """The scale of accelerations has cond(M), up to 1e6 on arms, which hides faults; backward errors do not."""

    @pytest.mark.parametrize("robot", ["kr500", "ur5", "kinova"])
    def test_single_precision(self, robot):
        judgement = crosscheck.judge(robot, forward_dynamics=single_precision(urdf.load(robot)), samples=SAMPLES)
        function = judgement.functions["forward_dynamics"]
        assert not judgement.agrees
        assert judgement.decided
        assert set(function.backward_errors) == set(judgement.referees)
        for backward in function.backward_errors.values():
            assert 1e-8 < backward.max() < 1e-6
        assert "single precision" in judgement.diagnoses[0].message

    def test_gravity_where_the_condition_number_hides_it(self):
        """The worst conditioned arm among the makers' files."""
        model = urdf.load(existing(ARMS / "j2s6s200_standalone.urdf"))
        judgement = crosscheck.judge(model, forward_dynamics=wrong_gravity(model), samples=SAMPLES)
        function = judgement.functions["forward_dynamics"]
        assert function.backward_errors["graphdyn"].max() > 4e-5
        assert [diagnosis.kind for diagnosis in judgement.diagnoses] == ["gravity"]

    def test_an_error_that_only_the_backward_error_shows(self, ur5):
        """A part in ten million of the acceleration, in the direction that needs most torque."""

        def forward_dynamics(q, v, tau):
            a = graphdyn.forward_dynamics(ur5, q, v, tau).a
            heaviest = np.linalg.eigh(graphdyn.mass_matrix(ur5, q))[1][:, -1]
            return a + 1e-7 * np.abs(a).max() * heaviest

        judgement = crosscheck.judge(ur5, forward_dynamics=forward_dynamics, samples=SAMPLES)
        function = judgement.functions["forward_dynamics"]
        assert function.within(function.errors)
        assert not function.within(function.backward_errors)
        assert not function.agrees
        text = as_text(judge_report(judgement), width=140)
        rows = {line.split("│")[1].strip(): line for line in text.splitlines() if line.startswith("│")}
        assert "agrees" in rows["forward_dynamics"]
        assert "DISAGREES" in rows["backward_error"]
        worst = int(np.argmax(function.backward_errors["graphdyn"]))
        assert f"{function.backward_errors['graphdyn'][worst]:.1e}" in rows["backward_error"]
        written = plain(record_of(judgement, ["graphdyn", "judge"]))["functions"]["forward_dynamics"]
        assert written["backward_errors"]["graphdyn"]["1"] == function.backward_errors["graphdyn"][worst]
        assert list(function.worst.answer) == list(forward_dynamics(*map(np.array, function.worst.arguments.values())))

    @pytest.mark.parametrize("value", [math.nan, math.inf, 1e300])
    @pytest.mark.filterwarnings("ignore::RuntimeWarning")
    def test_no_finite_answer(self, ur5, value):
        judgement = crosscheck.judge(ur5, forward_dynamics=lambda q, v, tau: value + 0 * q, samples=SAMPLES)
        function = judgement.functions["forward_dynamics"]
        assert all((error > 0.01).all() for error in function.backward_errors.values())
        assert not judgement.agrees

    def test_only_accelerations_have_one(self, arm):
        judgement = crosscheck.judge("ur5", inverse_dynamics=arm.inverse_dynamics, samples=SAMPLES)
        assert judgement.functions["inverse_dynamics"].backward_errors == {}

    def test_a_referee_that_differs_backward_decides_nothing(self, arm, monkeypatch):
        """Pinocchio's accelerations are off by what the forward scale does not notice."""
        original = PinocchioModel.evaluate

        def evaluate(referee, *arguments):
            values = original(referee, *arguments)
            heaviest = np.linalg.eigh(values.mass_matrix)[1][..., -1]
            return dataclasses.replace(values, a=values.a + 1e-8 * np.abs(values.a).max() * heaviest)

        monkeypatch.setattr(PinocchioModel, "evaluate", evaluate)
        judgement = crosscheck.judge("ur5", forward_dynamics=arm.forward_dynamics, samples=SAMPLES)
        function = judgement.functions["forward_dynamics"]
        assert function.within(function.referees_differ)
        assert not judgement.decided
        assert judgement.verdict == "UNDECIDED"


class TestReferees:
    def test_without_mujoco(self, arm, monkeypatch):
        monkeypatch.setitem(sys.modules, "mujoco", None)
        judgement = crosscheck.judge("ur5", inverse_dynamics=arm.inverse_dynamics, samples=1)
        assert judgement.agrees
        assert judgement.referees == ("graphdyn", "pinocchio")
        assert judgement.notes == (
            "MuJoCo is not among the reference implementations: the package mujoco is not installed: "
            "pip install 'graphdyn[mujoco]'",
        )

    def test_what_mujoco_cannot_represent(self):
        pytest.importorskip("mujoco", reason="the package mujoco is not installed")
        odd = with_body(kr500(), 3, inertia=np.diag([1.0, 1.0, 5.0]))
        with pytest.raises(MujocoRefuses, match=r"MuJoCo cannot represent robot 'kr500': .*inertia"):
            MujocoModel(odd)
        judgement = crosscheck.judge(odd, inverse_dynamics=rnea(odd), samples=1)
        assert judgement.agrees
        assert judgement.referees == ("graphdyn", "pinocchio")

    @pytest.mark.parametrize("robot", [kr500(), urdf.load("ur5"), mixed_tree()], ids=lambda model: model.name)
    def test_mujoco_agrees(self, robot):
        pytest.importorskip("mujoco", reason="the package mujoco is not installed")
        judgement = crosscheck.judge(robot, inverse_dynamics=rnea(robot), mass_matrix=None, samples=SAMPLES)
        (function,) = judgement.functions.values()
        assert function.referees_differ["mujoco"].max() <= ALIKE


class TestInput:
    def test_nothing_to_judge(self):
        with pytest.raises(InvalidInput, match="no function to judge; give at least one of inverse_dynamics, forward_"):
            crosscheck.judge("ur5")

    def test_no_function(self):
        with pytest.raises(InvalidInput, match="mass_matrix is of type ndarray; give a function"):
            crosscheck.judge("ur5", mass_matrix=np.eye(6))

    @pytest.mark.parametrize("names", ["abc", ["a", "b"], ["elbow_joint"] * 6])
    def test_joint_names(self, arm, names):
        with pytest.raises(InvalidInput, match="it must name each of the 6 joints once: shoulder_pan_joint, "):
            crosscheck.judge("ur5", inverse_dynamics=arm.inverse_dynamics, joint_names=names)

    @pytest.mark.parametrize(
        ("option", "message"),
        [
            ({"samples": 0}, "samples is 0; give a whole number"),
            ({"seed": -1}, "seed is -1; give a whole number"),
            ({"tolerance": 0}, "tolerance is 0; give a relative error between 0 and 1"),
            ({"tolerance": "x"}, "tolerance is 'x'; give a relative error between 0 and 1"),
        ],
    )
    def test_numbers(self, arm, option, message):
        with pytest.raises(InvalidInput, match=message):
            crosscheck.judge("ur5", inverse_dynamics=arm.inverse_dynamics, **option)

    def test_lock_with_a_model(self, arm, ur5):
        with pytest.raises(InvalidInput, match="a RobotModel already has its joints and gravity"):
            crosscheck.judge(ur5, inverse_dynamics=arm.inverse_dynamics, lock=["elbow_joint"])

    def test_wrong_shape(self):
        with pytest.raises(ForeignFailure, match=r"inverse_dynamics returned shape \(6, 1\), expected \(6,\)"):
            crosscheck.judge("ur5", inverse_dynamics=lambda q, v, a: q[:, None])
        with pytest.raises(ForeignFailure, match=r"regressor returned shape \(6, 6\), expected \(6, 60\)"):
            crosscheck.judge("ur5", regressor=lambda q, v, a: np.eye(6))

    def test_foreign_exception_without_a_message(self):
        def silent(q, v, a):
            raise ValueError

        with pytest.raises(
            ForeignFailure, match=r"inverse_dynamics raised ValueError \(.*, line \d+, in silent\); at q"
        ):
            crosscheck.judge("ur5", inverse_dynamics=silent, samples=SAMPLES)

    def test_foreign_exception(self):
        def broken(q):
            raise KeyError("wrist")

        line = broken.__code__.co_firstlineno + 1
        words = rf"mass_matrix raised KeyError: 'wrist' \({re.escape(__file__)}, line {line}, in broken\); at q = \["
        with pytest.raises(ForeignFailure, match=words) as caught:
            crosscheck.judge("ur5", mass_matrix=broken)
        assert isinstance(caught.value.__cause__, KeyError)

    def test_the_line_is_that_of_the_file_of_the_function(self):
        """Not of NumPy, which it called."""

        def broken(q):
            return np.linalg.inv(np.zeros((6, 6)))

        words = rf"LinAlgError: Singular matrix \({re.escape(__file__)}, line \d+, in broken\)"
        with pytest.raises(ForeignFailure, match=words):
            crosscheck.judge("ur5", mass_matrix=broken)

    def test_a_compiled_function_has_no_line(self):
        with pytest.raises(ForeignFailure, match=r"mass_matrix raised TypeError: [^(]*; at q = \["):
            crosscheck.judge("ur5", mass_matrix=operator.index)

    def test_foreign_exit(self):
        """It would end the caller's program with the exit code of an agreement."""
        with pytest.raises(ForeignFailure, match="mass_matrix raised SystemExit: 0"):
            crosscheck.judge("ur5", mass_matrix=lambda q: sys.exit(0))

    @pytest.mark.parametrize("error", [KeyboardInterrupt, pytest.skip.Exception])
    def test_what_ends_more_than_the_function_passes(self, error):
        def interrupted(q):
            raise error

        with pytest.raises(error):
            crosscheck.judge("ur5", mass_matrix=interrupted)

    @pytest.mark.parametrize(
        ("returned", "words"),
        [
            (None, "NoneType, which is no array of real numbers: a return is missing"),
            (np.eye(6) + 0j, "ndarray, which is no array of real numbers: it has imaginary parts"),
            ([[1.0], [1.0, 2.0]], "list, which is no array of real numbers"),
            ("heavy", "str, which is no array of real numbers"),
        ],
    )
    def test_no_numbers(self, returned, words):
        with pytest.raises(ForeignFailure, match=f"mass_matrix returned {words}"):
            crosscheck.judge("ur5", mass_matrix=lambda q: returned)

    def test_no_forward_dynamics(self):
        massless = kr500().with_inertial_parameters(np.zeros(60))
        with pytest.raises(SingularMassMatrix, match="singular"):
            crosscheck.judge(massless, forward_dynamics=lambda q, v, tau: tau)

    def test_a_robot_without_mass(self):
        massless = kr500().with_inertial_parameters(np.zeros(60))
        judgement = crosscheck.judge(massless, inverse_dynamics=lambda q, v, a: 0 * q, samples=1)
        assert judgement.agrees
        assert "no body has mass: all torques vanish, and little can be judged" in judgement.notes

    def test_foreign_code_cannot_change_our_states(self, arm):
        def destructive(q, v, a):
            tau = arm.inverse_dynamics(q, v, a)
            q[:], v[:], a[:] = 0, 0, 0
            return tau

        assert crosscheck.judge("ur5", inverse_dynamics=destructive, samples=SAMPLES).agrees

    def test_progress(self, arm):
        said = []
        crosscheck.judge("ur5", inverse_dynamics=arm.but(cross=0.0).inverse_dynamics, samples=1, progress=said.append)
        assert said == [
            "evaluating the reference implementations",
            "judging inverse_dynamics",
            "looking for the fault of inverse_dynamics",
        ]


class TestTexts:
    def test_assert_correct_shows_the_diagnosis(self, arm):
        with pytest.raises(crosscheck.WrongDynamics) as caught:
            crosscheck.assert_correct("ur5", inverse_dynamics=arm.but(cross=-1.0).inverse_dynamics, samples=1)
        message = str(caught.value)
        assert isinstance(caught.value, AssertionError)
        assert "ur5: DISAGREES" in message
        assert "the terms ω × q̇ p in the angular accelerations have the opposite sign [coriolis]" in message
        assert "remedy " in message
        assert caught.value.judgement.diagnoses

    def test_assert_correct_returns(self, arm):
        assert crosscheck.assert_correct("ur5", inverse_dynamics=arm.inverse_dynamics, samples=1).agrees

    def test_alternatives_are_shown(self, wrong):
        several = dataclasses.replace(wrong, diagnoses=(dataclasses.replace(wrong.diagnoses[0], also=("one", "two")),))
        assert "same numbers from  one; or two" in as_text(judge_report(several))

    def test_an_unexplained_deviation(self, wrong):
        unknown = dataclasses.replace(wrong, diagnoses=(dataclasses.replace(wrong.diagnoses[0], explains=math.inf),))
        assert "unexplained  the whole deviation" in as_text(judge_report(unknown))

    @pytest.mark.parametrize("width", [80, 120])
    def test_fits_the_terminal(self, wrong, width):
        text = as_text(judge_report(wrong), width)
        assert max(map(cell_len, text.splitlines())) <= width
        assert re.search(r"│ inverse_dynamics │ DISAGREES │ +\d", text)
        assert ("relative to" in text) == (width == 120)

    def test_needs_neither_template_nor_plot(self):
        """The message of a failed test costs no import that only pages need."""
        code = textwrap.dedent(
            """
            import sys, numpy, crosscheck
            from graphdyn import Body, Joint, Placement, RobotModel
            body = Body("body", 1.0, [0.1, 0.2, 0.3], numpy.eye(3))
            joint = Joint("joint", "revolute", 0, Placement(), [0.0, 1.0, 0.0])
            robot = RobotModel("pendulum", (body,), (joint,))
            try:
                crosscheck.assert_correct(robot, inverse_dynamics=lambda q, v, a: q, samples=1)
            except crosscheck.WrongDynamics as wrong:
                assert "inverse_dynamics" in str(wrong) and "DISAGREES" in str(wrong)
                sys.exit(bool({"jinja2", "matplotlib"} & set(sys.modules)))
            sys.exit(2)
            """
        )
        assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

    def test_json(self, wrong):
        record = json.loads(json.dumps(plain(record_of(wrong, [])), allow_nan=False))
        assert record["verdict"] == "disagrees"
        function = record["functions"]["inverse_dynamics"]
        assert set(function["errors"]) == set(wrong.referees)
        assert function["errors"]["pinocchio"]["1"] > function["bound"]
        assert set(function["worst"]["arguments"]) == {"q", "v", "a"}
        (diagnosis,) = record["diagnoses"]
        assert diagnosis["kind"] == "coriolis"

    def test_infinities_become_null(self):
        judgement = crosscheck.judge("ur5", inverse_dynamics=lambda q, v, a: q * np.nan, samples=1)
        record = plain(record_of(judgement, []))
        assert record["functions"]["inverse_dynamics"]["errors"]["graphdyn"]["1"] is None
        json.dumps(record, allow_nan=False)


class TestPlugin:
    """Two lines in a foreign test suite."""

    SUITE = """
        import graphdyn

        def rnea(q, v, a):
            return graphdyn.inverse_dynamics(graphdyn.kr500(), q, v, a).tau

        def test_right(judge_dynamics):
            judge_dynamics("kr500", inverse_dynamics=rnea, samples=2)

        def test_wrong(judge_dynamics):
            judge_dynamics("kr500", inverse_dynamics=lambda *state: -rnea(*state), samples=2)
    """

    def test_fixture(self, pytester):
        pytester.makepyfile(self.SUITE)
        outcome = pytester.runpytest_inprocess()
        outcome.assert_outcomes(passed=1, failed=1)
        outcome.stdout.fnmatch_lines(["*all torques have the opposite sign*"])

    def test_installed(self, pytester):
        """The entry point announces it; it costs no import of Pinocchio."""
        pytester.makepyfile("def test(judge_dynamics):\n    import sys\n    assert 'pinocchio' in sys.modules\n")
        pytester.makeconftest("import sys\nassert 'pinocchio' not in sys.modules\n")
        pytester.runpytest_subprocess().assert_outcomes(passed=1)
