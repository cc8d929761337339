"""Diagnoses that hold, and those that say that they do not: those of `python tests/tools named_faults`, spread out."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from faults.case import ROBOTS
from faults.cases import CASES
from faults.plants import factors
from faults.textbook import TextbookArm
from faults.textbook_faults import WRIST_LOCKED
from faults.verdicts import in_single_precision, judged, verdict
from long_check import few
from planting import mixed_tree
from shared_data import existing
from shown.approved import approve

import urdf
from crosscheck.commands.judge.record import record
from crosscheck.commands.judge.report import judge_report
from crosscheck.judging.faults.fault import factor_said
from crosscheck.judging.faults.geometry import geometry
from crosscheck.judging.faults.recursion import DynamicsCode, torques_of
from crosscheck.judging.faults.terms import _symmetric
from crosscheck.judging.judge import judge
from crosscheck.judging.observing.observation import of_experiments
from crosscheck.judging.states import EquationTerms, JudgedStates, scales
from crosscheck.report.records.record import plain
from crosscheck.report.text import as_text
from graphdyn import inverse_dynamics

SPREAD = CASES[::16]
"""Some of each group; all of them are the long check of docs/contributing.md."""

QUICK = SPREAD[::4]
"""A quarter of them, which the tests of every change have."""

SCALED = [case for case in CASES if case.name in ("all torques", "mass of body 2")]

ALIKE = 1e-12
"""Two recursions: some hundred roundings each."""


def diagnoses(function, robot="ur5"):
    return judge(robot, inverse_dynamics=function, samples=10).diagnoses


@pytest.fixture(scope="module")
def short():
    return urdf.load("ur5", lock=WRIST_LOCKED)


@pytest.fixture(scope="module")
def short_arm(short):
    return TextbookArm.of(short)


@pytest.mark.parametrize("case", few(SPREAD, *QUICK), ids=str)
def test_cases(case):
    if case.robot in ("vx300s", "kr210"):
        existing(Path(ROBOTS[case.robot]))
    judgment = judged(case, 20)[0]
    approve(f"judged/{case.name}, {case.robot}", as_text(judge_report(judgment)))
    assert verdict(case, judgment) not in ("WRONG", "missed"), [x.message for x in judgment.diagnoses]
    for diagnosis in judgment.diagnoses:
        assert diagnosis.remedy
        if diagnosis.status == "confirmed" and math.isfinite(diagnosis.explains):
            assert diagnosis.explains <= 1e-9 or diagnosis.kind == "precision"


def test_many_codes_at_once_are_the_dynamics():
    model = mixed_tree()
    rng = np.random.default_rng(3)
    q, v = model.random_state(rng, 5)
    a = rng.uniform(-5, 5, q.shape)
    heavier = DynamicsCode.of(model)
    heavier = heavier.but(masses=2 * heavier.numbers.masses, tensors=2 * heavier.numbers.tensors)
    expected = inverse_dynamics(model, q, v, a).tau
    own, twice = torques_of([DynamicsCode.of(model), heavier], (q, v, a))
    assert np.abs(own - expected).max() <= ALIKE * np.abs(expected).max()
    assert np.abs(twice - 2 * expected).max() <= ALIKE * np.abs(expected).max()


def test_a_factor_is_of_the_joint_that_it_names(ur5):
    q, v, a = np.random.default_rng(0).normal(size=(3, 4, 6))
    three, said = np.array([3.0]), "the velocity of joint 'elbow_joint' is multiplied by 3"
    single = (fault for fault in geometry(ur5) if fault.right.size == 1)
    (fault,) = (fault for fault in single if said in [found.message for found in fault.say(three)])
    (tau,) = torques_of([fault.change(DynamicsCode.of(ur5), three)], (q, v, a))
    expected = inverse_dynamics(ur5, q, v * [1, 1, 3, 1, 1, 1], a).tau
    assert np.abs(tau - expected).max() <= ALIKE * np.abs(expected).max()


def test_a_symmetric_matrix_of_its_diagonal_and_what_is_above():
    assert _symmetric(np.arange(1.0, 7.0), 3).tolist() == [[1, 4, 5], [4, 2, 6], [5, 6, 3]]


def test_differences_of_torques_are_relative_to_the_joint_wrenches(ur5):
    """Where two parts are known; answers of one part are relative to the largest of them."""
    trial = JudgedStates.draw(ur5, 3, 0, needs_tau=False)
    tiny = np.full_like(trial.q, 1e-9)
    wrench = np.abs(inverse_dynamics(ur5, trial.q, trial.v, 0 * trial.v).joint_wrenches).max()
    both = of_experiments(trial, EquationTerms(gravity=tiny, velocity=tiny))
    assert both.scale == pytest.approx(np.full((2 * len(tiny), 1), wrench))
    assert of_experiments(trial, EquationTerms(gravity=tiny)).scale == pytest.approx(np.full((len(tiny), 1), 1e-9))


def test_velocity_torques_have_a_thousandth_of_the_joint_wrenches_for_a_scale_at_least(ur5):
    trial = JudgedStates.draw(ur5, 3, 0, needs_tau=False)
    wrench = np.abs(inverse_dynamics(ur5, trial.q, trial.v, 0 * trial.v).joint_wrenches).max()
    none = EquationTerms(gravity=0 * trial.q, velocity=0 * trial.q)
    assert scales(trial, none) == pytest.approx({"gravity": wrench, "inertia": 1.0, "velocity": 1e-3 * wrench})


class TestStandings:
    def test_what_torques_cannot_tell_apart_is_a_candidate(self, ur5):
        arm = TextbookArm.of(ur5)
        arm.tensors[0, 2, 2] += 0.01
        (diagnosis,) = diagnoses(arm.inverse_dynamics)
        assert diagnosis.status == "candidate"
        told = (diagnosis.message, *diagnosis.also)
        assert "I_zz of body 'shoulder_link' is 0.01666 kg m², not 0.00666 kg m²" in told
        assert "a constant diagonal (0.01, 0, 0, 0, 0, 0) is added to the mass matrix" in told
        assert diagnosis.apart == "nothing: these faults give identical torques; check each place in the code"

    def test_a_part_says_so(self, short, short_arm):
        """Gravity is reversed, and something that has no name is added where the arm moves."""
        arm = short_arm.but(gravity=-short_arm.gravity)
        part, rest = diagnoses(lambda q, v, a: arm.inverse_dynamics(q, v, a) + np.sin(q) * v**4, short)
        assert (part.message, part.status) == ("gravity has the opposite sign", "part")
        assert part.evidence.startswith("explains at rest (v = 0, a = 0); ")
        assert rest.status == "unknown"
        assert "moving at a = 0, gravity subtracted" in rest.message
        assert part.explains > 1e-3

    def test_a_part_has_the_numbers_alone_that_explain_it(self, short, short_arm):
        """The other entries of the matrix are rounding of a fit to what it does not explain."""
        rotors = np.array([[0, 0, 0], [0, 0, 0.01], [0, 0.01, 0]])
        part, rest = diagnoses(
            lambda q, v, a: short_arm.inverse_dynamics(q, v, a) + rotors @ a + 0.3 * v**3 * np.sin(q), short
        )
        matrix = "a constant matrix, as of coupled rotors, is added to the mass matrix"
        assert (part.message, part.status) == (f"{matrix}: M[2, 3] + 0.01", "part")
        assert [(number.name, number.ours) for number in part.numbers] == [("M[2, 3]", 0.0)]
        assert part.numbers[0].theirs == pytest.approx(0.01, rel=1e-9)
        assert rest.status == "unknown"

    def test_where_an_unknown_deviation_is(self, short, short_arm):
        (diagnosis,) = diagnoses(
            lambda q, v, a: short_arm.inverse_dynamics(q, v, a) + np.sin(3 * q[1] * q) * (np.arange(3) == 2), short
        )
        assert diagnosis.status == "unknown"
        assert diagnosis.message.endswith("; only torques of elbow_joint deviate")
        assert 1e-4 < diagnosis.explains < 1

    def test_a_direction_of_all_deviations(self, short, short_arm):
        way = np.array([0, 1.0, -2.0])
        (diagnosis,) = diagnoses(lambda q, v, a: short_arm.inverse_dynamics(q, v, a) + np.sin(3 * q[0]) * way, short)
        assert "one direction (shoulder_lift_joint -0.5, elbow_joint 1), as from a constraint" in diagnosis.message


class TestPrecision:
    @pytest.mark.parametrize("case", few(SCALED, *SCALED[::2]), ids=str)
    def test_faults_above_single_precision(self, case):
        if case.robot == "kr210":
            existing(Path(ROBOTS[case.robot]))
        judgment = judged(case, 5, single=True)[0]
        assert verdict(case, judgment) == "named"
        assert all(1e-9 < diagnosis.explains < 1e-5 for diagnosis in judgment.diagnoses)
        assert "as in single precision" in judgment.diagnoses[0].evidence

    def test_single_precision_alone(self, textbook):
        single = in_single_precision(textbook.in_single_precision().inverse_dynamics)
        (diagnosis,) = diagnoses(single)
        assert (diagnosis.kind, diagnosis.status) == ("precision", "confirmed")
        assert "as in single precision" in diagnosis.message

    def test_scatter_is_not_single_precision(self):
        (case,) = (case for case in CASES if case.name == "scatter of 1e-4")
        existing(Path(ROBOTS[case.robot]))
        (diagnosis,) = judged(case, 10)[0].diagnoses
        assert diagnosis.kind == "precision"
        assert "the answers scatter by" in diagnosis.message


@pytest.fixture(scope="module")
def judgment(short):
    arm = TextbookArm.of(short)
    arm.centers[2] += [0, 0.01, -0.02]
    return judge(short, inverse_dynamics=arm.inverse_dynamics, samples=10)


class TestFittedNumbers:
    def test_theirs_ours_difference(self, judgment, short):
        (diagnosis,) = judgment.diagnoses
        center = short.bodies[2].center_of_mass
        assert [number.name for number in diagnosis.numbers] == ["c_y", "c_z"]
        assert [number.ours for number in diagnosis.numbers] == pytest.approx(list(center[1:]))
        assert [number.difference for number in diagnosis.numbers] == pytest.approx([0.01, -0.02], abs=1e-9)
        assert {number.unit for number in diagnosis.numbers} == {"m"}
        assert diagnosis.message == ("the center of mass of body 'forearm_link' is off: c_y by 0.01 m, c_z by -0.02 m")

    def test_in_text_and_json(self, judgment):
        text = as_text(judge_report(judgment), 120)
        assert "confirmed: graphdyn with this fault reproduces your function at every state" in text
        (row,) = (line for line in text.splitlines() if "c_y" in line and "│" in line)
        assert [cell.strip() for cell in row.split("│")[4:6]] == ["0.01", "m"]
        (diagnosis,) = json.loads(json.dumps(plain(record(judgment, []))))["diagnoses"]
        assert diagnosis["status"] == "confirmed"
        assert diagnosis["numbers"][1]["difference"] == pytest.approx(-0.02, abs=1e-9)


def test_a_limit_has_no_value_here():
    """It is infinite in graphdyn, null in JSON."""
    (case,) = (case for case in CASES if case.name.startswith("torque clipped"))
    judgment = judged(case, 20)[0]
    (diagnosis,) = json.loads(json.dumps(plain(record(judgment, [])), allow_nan=False))["diagnoses"]
    assert diagnosis["numbers"][0]["ours"] is None


def test_a_pair_is_verified_together(short):
    plant = factors("weight", 2, 0)
    arm = TextbookArm.of(short)
    arm.axes[2] *= -1
    messages = {x.message: x.status for x in diagnoses(plant(arm, short), short)}
    assert messages == {
        "gravity on body 'forearm_link' is left out": "confirmed",
        "the axis of joint 'elbow_joint' points the other way": "confirmed",
    }


@pytest.mark.parametrize(
    ("term", "has"),
    [
        ("all velocity terms", "have"),
        ("the squares v_j²", "have"),
        ("the Coriolis accelerations 2 ω × ṡ of sliding joints", "have"),
        ("the term Ṁ v", "has"),
        ("the angular velocity of the inside body, at joint 'elbow',", "has"),
    ],
)
def test_a_term_and_its_verb_agree_in_number(term, has):
    assert factor_said(term, -1) == f"{term} {has} the opposite sign"
