"""Functions under test against exact values: proven errors, the rule of the verdict, and which truth is meant."""

import functools
import sys
from dataclasses import replace

import numpy as np
import pytest
from faults.textbook import TextbookArm
from planting import with_body
from scipy.spatial.transform import Rotation

import crosscheck
import graphdyn
import urdf
from crosscheck.exact import HALF_ULP, half_ulp_effects
from crosscheck.exact.balls import as_balls, bits
from crosscheck.exact.recorded import CONSTANTS, constants_of, evaluate, recorded
from crosscheck.exact.robot import of_model
from crosscheck.exact.sensitivity import sizes_of_constants
from crosscheck.judging import judge as judging
from crosscheck.judging.special_states import N_SPECIAL_STATES
from crosscheck.judging.states import N_TURNED_STATES
from crosscheck.quantities import FUNCTIONS
from graphdyn import InvalidInput, inverse_dynamics
from graphdyn.compiler import Request

pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")

SAMPLES = 5
ALL_STATES = SAMPLES + N_TURNED_STATES + 1 + N_SPECIAL_STATES

PLANTED = 1e-12
"""Relative error of one mass."""

ROUNDING = 1e-15
"""Of torques, relative to the largest joint wrench; measured below 3e-16 on these arms."""


def heavier(model, share=PLANTED):
    """The second body, heavier by a share."""
    return with_body(model, 2, mass=model.bodies[1].mass * (1 + share))


def rnea(model):
    return TextbookArm.of(model).inverse_dynamics


def judged(robot, function, **options):
    judgment = crosscheck.judge(robot, inverse_dynamics=function, samples=SAMPLES, **options)
    return judgment, judgment.functions["inverse_dynamics"].exact


def slide_at_the_end():
    """Eight joints that turn, and one that slides, all axes askew."""
    placements = [graphdyn.Placement(Rotation.random(random_state=k).as_matrix(), [0.1, 0.2, 0.3]) for k in range(9)]
    kinds = ["revolute"] * 8 + ["prismatic"]
    joints = [graphdyn.Joint(f"j{k}", kinds[k], k, placements[k], [0, 0, 1]) for k in range(9)]
    bodies = [graphdyn.Body(f"b{k}", 1.0, [0.01, 0.02, 0.03], np.diag([0.01, 0.012, 0.015])) for k in range(9)]
    return graphdyn.RobotModel("slide at the end", bodies, joints)


class TestProof:
    """A mass that is off by 1e-12, which no tolerance notices."""

    def test_a_few_states_say_how_wrong_at_least(self, ur5):
        """The verdict of the bound stays."""
        judgment, exact = judged("ur5", rnea(heavier(ur5)))
        assert judgment.verdict == "agrees"
        assert exact.wrong
        assert not exact.everywhere
        worst = judgment.functions["inverse_dynamics"].worst
        state = [np.array(worst.arguments[name]) for name in "qva"]
        away = np.abs(rnea(heavier(ur5))(*state) - rnea(ur5)(*state)).max()
        wrench = np.abs(inverse_dynamics(ur5, *state).joint_wrenches).max()
        assert exact.least.max() == pytest.approx(away / wrench, abs=ROUNDING)
        assert max(errors.max() for errors in exact.references.values()) < ROUNDING

    def test_at_all_states_it_decides(self, ur5):
        with pytest.raises(
            crosscheck.WrongDynamics, match=r"off by at least \d.\de-1\d of the largest joint"
        ) as caught:
            crosscheck.assert_correct("ur5", inverse_dynamics=rnea(heavier(ur5)), samples=SAMPLES, exact=True)
        judgment = caught.value.judgment
        exact = judgment.functions["inverse_dynamics"].exact
        assert judgment.diagnoses == ()
        assert len(exact.states) == ALL_STATES
        assert exact.rounded < 0.5 < exact.ulps

    def test_a_right_function_needs_no_proof(self, ur5):
        _, exact = judged("ur5", rnea(ur5))
        assert exact is None

    def test_right_functions_are_right_at_all_states(self):
        robot = "kinova"
        arm = TextbookArm.of(urdf.load(robot))
        judgment = crosscheck.judge(
            robot, inverse_dynamics=arm.inverse_dynamics, forward_dynamics=arm.forward_dynamics,
            mass_matrix=arm.mass_matrix, samples=SAMPLES, exact=True,
        )  # fmt: skip
        assert judgment.agrees
        for function in judgment.functions.values():
            assert function.exact.digits >= 9
            assert (function.exact.least <= function.exact.most).all()
            assert (function.exact.most <= function.exact.factor * function.exact.caused).all()

    def test_rounding_of_terms_that_cancel_is_no_error(self, ur5):
        """Where the last joint moves alone, entries are far smaller than the terms that other codes sum up."""

        def coriolis(q, v, error=0.0):
            term = np.abs(graphdyn.mass_matrix(ur5, q)).max() * np.abs(v).max()
            return graphdyn.coriolis_matrix(ur5, q, v) + term * (1 + error) - term

        for error, right in ((0.0, True), (1e-14, False)):
            judgment = crosscheck.judge(
                "ur5", coriolis_matrix=functools.partial(coriolis, error=error), samples=SAMPLES, exact=True
            )
            exact = judgment.functions["coriolis_matrix"].exact
            assert exact.wrong != right
            small = np.abs(exact.least) > 1e-14
            assert small.any()

    def test_squares_of_rounded_rotations_are_right(self):
        """Where the slide moves alone, the energy is m v²/2: no rotation moves it, yet codes in world axes turn v."""
        arm = slide_at_the_end()

        def energy(q, v, error):
            return graphdyn.kinetic_energy(arm, q, v, method="projected") * (1 + error)

        for error, right in ((0.0, True), (PLANTED, False)):
            planted = functools.partial(energy, error=error)
            judgment = crosscheck.judge(arm, kinetic_energy=planted, samples=2 * SAMPLES, exact=True)
            assert judgment.functions["kinetic_energy"].exact.wrong != right

    @pytest.mark.parametrize("exact", [True, None])
    def test_placements(self, ur5, exact):
        """A last offset that is off by 1e-12; asked for, exact values decide, else they say how wrong it is."""

        def placement(q, error):
            rotation, position = graphdyn.frame_placement(ur5, q, "tool0")
            last = ur5.frame("tool0").placement.translation
            found = np.eye(4)
            found[:3, :3], found[:3, 3] = rotation, position + error * (rotation @ last)
            return found

        for error, right in ((0.0, True), (1000 * PLANTED, False)):
            planted = functools.partial(placement, error=error)
            judgment = crosscheck.judge(
                "ur5", frame_placement=planted, frame="tool0", samples=SAMPLES, exact=bool(exact)
            )
            found = judgment.functions["frame_placement"].exact
            assert (found is not None and found.wrong) != right

    def test_numbers_in_single_precision_are_rounded_to_it(self, ur5):
        single = TextbookArm.of(ur5).in_single_precision().inverse_dynamics
        assert judged("ur5", single, precision="single", exact=True)[0].agrees
        assert not judged("ur5", single, tolerance=1e-4, exact=True)[0].agrees

    @pytest.mark.usefixtures("undiagnosed")
    def test_numbers_that_are_not_finite_are_wrong(self, ur5):
        right = rnea(ur5)
        judgment, exact = judged("ur5", lambda q, v, a: right(q, v, a) if q[0] > 0 else 0 * q + np.nan, exact=True)
        assert not exact.wrong
        assert len(exact.states) < ALL_STATES
        assert not judgment.agrees


class TestUndecided:
    def test_exact_values_decide(self, ur5, plant):
        plant.pinocchio_value("tau", lambda x: 1.01 * x)
        judgment, exact = judged("ur5", rnea(ur5))
        assert judgment.verdict == "agrees"
        assert exact.references["pinocchio"].max() > 1e-3
        assert exact.references["graphdyn"].max() < ROUNDING
        assert any("disagree: exact values decide" in note for note in judgment.notes)

    @pytest.mark.usefixtures("undiagnosed")
    def test_who_follows_the_wrong_reference_is_wrong(self, ur5, plant):
        plant.pinocchio_value("tau", lambda x: 1.01 * x)
        right = rnea(ur5)
        judgment, exact = judged("ur5", lambda q, v, a: 1.01 * right(q, v, a))
        assert judgment.verdict == "DISAGREES"
        assert exact.least.max() > 1e-3


class TestTruth:
    """Right for the file, or for the doubles that were read from it."""

    @pytest.mark.parametrize("mean", ["file", "model"])
    def test_either_may_be_meant(self, ur5, monkeypatch, mean):
        """A model that is heavier than its file by 1e-12."""
        original = judging.robot_of

        def changed(*arguments):
            found = original(*arguments)
            return replace(found, model=heavier(found.model))

        monkeypatch.setattr(judging, "robot_of", changed)
        judgment, exact = judged("ur5", rnea(ur5 if mean == "file" else heavier(ur5)), exact=True)
        assert judgment.agrees
        assert exact.truth == mean

    def test_of_a_model_there_is_no_file(self, ur5):
        assert judged(ur5, rnea(ur5), exact=True)[1].truth == "model"

    @pytest.mark.filterwarnings("ignore::urdf.MimicJointWarning")
    def test_mimic_joints_are_judged_as_independent(self):
        model = urdf.load("panda", mimic="independent")
        _, exact = judged("panda", lambda q, v, a: inverse_dynamics(model, q, v, a).tau, exact=True)
        assert exact.truth == "file"


class TestRefusals:
    def test_without_flint(self, ur5, monkeypatch):
        """Asked for, it is an error; where it would have decided, a hint."""
        monkeypatch.setitem(sys.modules, "flint", None)
        with pytest.raises(InvalidInput, match=r"python -m pip install 'graphdyn\[exact\]'"):
            judged("ur5", rnea(ur5), exact=True)
        judgment, exact = judged("ur5", rnea(heavier(ur5)))
        assert exact is None
        assert any("graphdyn[exact]" in note for note in judgment.notes)

    def test_functions_without_exact_values(self, ur5):
        with pytest.raises(InvalidInput, match="base_regressor: there are no exact values of this"):
            crosscheck.judge("ur5", base_regressor=lambda q, v, a: q, samples=1, exact=True)

    def test_conventions_without_exact_values(self, ur5):
        def in_world(q, v, a):
            return FUNCTIONS["joint_wrenches"].of_graphdyn(_states(ur5, q, v, a), {"axes": "world"})[0]

        judgment = crosscheck.judge("ur5", joint_wrenches=in_world, samples=2, exact=True)
        assert judgment.agrees
        assert any("there are no exact values in the convention axes: world" in note for note in judgment.notes)


def _states(model, q, v, a):
    return judging.JudgedStates(model, q[None], v[None], a[None], 0 * a[None])


class TestSensitivity:
    """The effect of half an ulp of every input, against differences in balls."""

    @pytest.mark.parametrize(("verb", "output"), [("joint_torques", "tau"), ("joint_accelerations", "a")])
    def test_against_differences(self, small_arm, verb, output):
        model = urdf.load(small_arm)
        rng = np.random.default_rng(5)
        names = {"tau": ("q", "v", "a"), "a": ("q", "v", "tau")}[output]
        inputs = dict(zip(names, rng.normal(size=(3, model.nv)), strict=True))
        found = half_ulp_effects(model, verb, output, *(x[None] for x in inputs.values()))[0]
        request = Request({"tau": "inverse_dynamics", "a": "forward_dynamics"}[output], (output,), False)
        with bits(200):
            robot = of_model(model)
            program = recorded(robot, request, all_inputs=True).program
            known = {name: as_balls(x) for name, x in inputs.items()}
            known[CONSTANTS] = np.array(constants_of(robot, request), dtype=object)
            sizes = {name: np.abs(x) for name, x in inputs.items()}
            sizes[CONSTANTS] = sizes_of_constants(model, request, np.array([float(x.mid()) for x in known[CONSTANTS]]))
            total = sum(
                self._moved(program, known, name, k, HALF_ULP * size)[output]
                for name, entries in sizes.items()
                for k, size in enumerate(entries)
            )
        assert np.allclose(found, total, rtol=1e-6, atol=0)

    def _moved(self, program, known, name, k, by):
        """What the outputs move by if one input does."""
        moved = known[name].copy()
        moved[k] = moved[k] + by
        start, there = (evaluate(program, given) for given in (known, {**known, name: moved}))
        return {
            output: np.array([abs(float((y - x).mid())) for x, y in zip(start[output], values, strict=True)])
            for output, values in there.items()
        }

    def test_sizes_of_constants(self, ur5):
        """Of the first body: entries of rotations and axes move by an ulp of 1, others by one of their norm."""
        request = Request("inverse_dynamics", ("tau",), False)
        with bits(100):
            known = np.array([float(x.mid()) for x in constants_of(of_model(ur5), request)])
        sizes = sizes_of_constants(ur5, request, known)
        body, joint = ur5.bodies[0], ur5.joints[0]
        distance, center = np.linalg.norm(joint.placement.translation), np.linalg.norm(body.center_of_mass)
        expected = [1.0] * 9 + [distance] * 3 + [1.0] * 9 + [body.mass] + [center] * 3 + [body.mass * center] * 3
        assert np.allclose(sizes[: len(expected)], expected, rtol=1e-12)
        assert np.allclose(sizes[-6:], np.linalg.norm(ur5.gravity), rtol=1e-12)
