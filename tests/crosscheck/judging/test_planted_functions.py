"""Faults in functions of every kind, in plain codes written apart: found, and never told as another one."""

from dataclasses import replace

import pytest
from long_check import few
from other_functions.fault import path_of
from other_functions.planted import FAULTS, SPECIAL_FAULTS, verdict
from other_functions.right_functions import OTHERS
from textbook_codes.arm import PlainArm
from textbook_codes.code import FRAMES, function_text, right_code

import urdf
from crosscheck.judging.judge import judge

SELECTED = ("gravity_torque: sign", "potential_energy: sign", "static_torque: loads in world axes")
ALONE = ("kinetic_energy: nan at rest", "power: nan at rest")
HARD = (
    ("gravity_torque: tool", "ur5"),
    ("forward_dynamics: tool on the flange", "ur5"),
    ("multipliers: t_1 and t_2 exchanged", "panda"),
    ("frame_jacobian: rates of roll, pitch, yaw", "kinova"),
)
WAYS = ("world axes", "spatial", "about the world's origin", "zero elsewhere", "on the inside body")


def named(names, faults):
    return [fault for fault in faults if str(fault) in names]


@pytest.mark.parametrize("fault", few(named(SELECTED, FAULTS), *named(SELECTED[:1], FAULTS)), ids=str)
def test_a_fault_is_named(fault):
    robot, _, _, function = fault.planted()
    judgment = judge(path_of(robot), samples=10, **{fault.function: function})
    assert verdict(fault, judgment) in ("named", "candidates"), judgment.diagnoses


@pytest.mark.parametrize(
    ("name", "robot"),
    few(HARD, HARD[0]),
)
def test_a_fault_is_named_on_hard_arms(name, robot):
    """A load of a light link on the axis of its joint, sliding joints, special states at gimbal lock."""
    (fault,) = named([name], FAULTS)
    planted = fault.planted_on(robot)
    assert planted is not None
    options = {**dict(fault.options), **({"frame": planted[2]} if "frame" in fault.function else {})}
    judgment = judge(path_of(robot), samples=10, **{fault.function: planted[3]}, **options)
    assert verdict(replace(fault, robots=(robot,)), judgment) in ("named", "candidates"), judgment.diagnoses


@pytest.mark.parametrize("fault", few(named(ALONE, SPECIAL_FAULTS), *named(ALONE[:1], SPECIAL_FAULTS)), ids=str)
def test_a_fault_at_special_states_is_found(fault):
    robot, _, _, function = fault.planted()
    assert verdict(fault, judge(path_of(robot), samples=10, **{fault.function: function})) == "named"


@pytest.mark.parametrize(
    ("name", "way", "make"), few([x for x in OTHERS if x[1] in WAYS], *[x for x in OTHERS if x[1] == "zero elsewhere"])
)
def test_a_right_function_is_not_accused(name, way, make):
    arm = PlainArm.of(urdf.load("kinova"), FRAMES["kinova"])
    assert judge("kinova", samples=5, **{name: make(arm)}).agrees


def test_the_textbook_codes_stand_for_themselves():
    assert "graphdyn" not in function_text("newton_euler")
    arm = PlainArm.of(urdf.load("kinova"), FRAMES["kinova"])
    right = right_code("forward_dynamics", arm)
    q, v, tau = [0.3, 2.0, 2.5, 0.1, 1.0, 0.2], [0.1] * 6, [1.0, -2.0, 0.5, 0.1, 0.2, 0.0]
    assert abs(right(q, v, tau) - right_code("articulated_accelerations", arm)(q, v, tau)).max() < 1e-9
