"""Slips in one place of a recursion: named in codes that were written apart from those that the judge tries."""

import re

import numpy as np
import pytest
from faults.textbook_faults import LOCKED
from long_check import few
from slips.planted import FORMS, PLANTED_SLIPS, right_function

import urdf
from crosscheck.judging.faults.recursion import DynamicsCode, torques_of
from crosscheck.judging.functions.projected import projected
from crosscheck.judging.judge import judge
from crosscheck.judging.slips.operations import Slip
from crosscheck.judging.slips.search import TORQUE_FORMULATIONS, all_slips, torques_with
from graphdyn import inverse_dynamics

ROBOTS = ("ur5", "panda")
"""One whose joints all turn, and one with a gripper that slides."""

ROUNDING = 1e-13
"""Relative error that rounding of sums in another order explains."""

SPREAD = [slip for form in FORMS for slip in [x for x in PLANTED_SLIPS if x.form == form][1::15]]
"""A few of each form; python tests/tools planted_slips has all, on ten arms."""

FIRST = {slip.form: slip for slip in reversed(SPREAD)}
"""One of each form, which the tests of every change have."""


def states(model, count=3):
    return tuple(np.random.default_rng(0).normal(size=(3, count, model.n_bodies)))


FORMULATION_NAMES = (
    "link axes",
    "world axes",
    "weights apart",
    "spatial",
    "first moments",
    "composite",
    "christoffel",
    "projected",
)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("formulation", [*TORQUE_FORMULATIONS, projected], ids=FORMULATION_NAMES)
def test_formulations_without_a_slip_are_right(robot, formulation):
    model = urdf.load(robot).uncoupled
    q, v, a = states(model)
    (found,) = torques_with(formulation, [Slip("none of them", 0.0, None)], DynamicsCode.of(model), (q, v, a))
    expected = inverse_dynamics(model, q, v, a).tau
    assert np.abs(found - expected).max() <= ROUNDING * np.abs(expected).max()


@pytest.mark.parametrize("formulation", [*TORQUE_FORMULATIONS, projected], ids=FORMULATION_NAMES)
def test_many_slips_at_once_are_each_alone(formulation):
    code = DynamicsCode.of(urdf.load("panda").uncoupled)
    state = states(urdf.load("panda"))
    slips = all_slips(formulation, code)
    together = torques_with(formulation, slips, code, state)
    right = torques_of([code], state)[0]
    for k in range(0, len(slips), 37):
        (alone,) = torques_with(formulation, [slips[k]], code, state)
        assert np.abs(together[k] - alone).max() <= ROUNDING * np.abs(right).max()
    assert (np.abs(together - right).max(axis=(1, 2)) > 1e-6).mean() > 0.5  # most of them show


def test_every_operation_is_done_wrong_at_each_joint_and_at_all():
    slips = all_slips(TORQUE_FORMULATIONS[0], DynamicsCode.of(urdf.load("ur5")))
    moment = [x for x in slips if x.operation == "the moment r × f of the outer link's force" and x.way == -1.0]
    assert [x.joint for x in moment] == [None, 5, 4, 3, 2, 1]
    said = "the moment r × f of the outer link's force at joint 'elbow_joint' has the opposite sign"
    assert moment[4].message(urdf.load("ur5").joint_names) == said
    said = "the tensor in world axes at every joint is not turned"
    assert Slip("the tensor in world axes", "not turned", None).message([]) == said


@pytest.mark.parametrize("form", FORMS)
def test_right_codes_are_not_accused(form):
    assert judge("z1", inverse_dynamics=right_function(form, urdf.load("z1")), samples=5).agrees


@pytest.mark.parametrize("slip", few(SPREAD, *FIRST.values()), ids=str)
def test_a_planted_slip_is_named(slip):
    short = urdf.load("ur5", lock=LOCKED)
    judgment = judge(short, inverse_dynamics=slip.function(short, joint=2), samples=10)
    (diagnosis,) = judgment.diagnoses
    assert diagnosis.status in ("confirmed", "candidate")
    assert diagnosis.explains <= 1e-12
    texts = [diagnosis.message, *diagnosis.also]
    assert any(re.search(slip.named, text) and re.search("elbow_joint|forearm_link", text) for text in texts)
