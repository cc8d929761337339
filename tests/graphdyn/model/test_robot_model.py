"""What is no RobotModel is refused by every public function that takes one, with the same sentence.

What no model can have, and what physical_consistency says of bodies: each with the facts it carries.
"""

import dataclasses
import inspect

import numpy as np
import pytest
from parts import POINT, SOLID, hinge
from random_trees import NAMED

import graphdyn
import urdf
from graphdyn import (
    Body,
    Frame,
    InvalidInput,
    InvalidModel,
    Joint,
    JointLimits,
    Placement,
    RobotModel,
    UnknownFrame,
    identification,
)
from graphdyn.identification import terms
from graphdyn.model import unit_of
from graphdyn.model.inertia import consistency_problems

ANYTHING = np.zeros(6)
"""For the other arguments: the model is looked at first."""


def parameters_of(function):
    try:
        return inspect.signature(function).parameters
    except ValueError:  # exceptions
        return {}


TAKE_A_MODEL = {
    f"{module.__name__}.{name}": getattr(module, name)
    for module in (graphdyn, identification, terms, urdf)
    for name in module.__all__
    if callable(getattr(module, name)) and "model" in parameters_of(getattr(module, name))
}


def test_they_are_found():
    assert {
        "graphdyn.joint_torques",
        "graphdyn.simulate_recording",
        "graphdyn.identification.TorqueModel",
        "urdf.save",
    } < set(TAKE_A_MODEL)


@pytest.mark.parametrize(("given", "said"), [("ur5", "'ur5', of type str"), (None, "None, of type NoneType")])
@pytest.mark.parametrize("name", TAKE_A_MODEL)
def test_refused(name, given, said):
    needed = [p for p in parameters_of(TAKE_A_MODEL[name]).values() if p.default is p.empty]
    arguments = {p.name: given if p.name == "model" else ANYTHING for p in needed}
    by_name = {p.name: arguments.pop(p.name) for p in needed if p.kind == p.KEYWORD_ONLY}
    with pytest.raises(InvalidInput, match=f"the model is {said}; give a RobotModel, into which"):
        TAKE_A_MODEL[name](*arguments.values(), **by_name)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mass": -1.5}, r"body 'solid': mass -1\.5 kg is negative"),
        ({"mass": np.nan}, r"body 'solid': mass contains NaN or infinity: nan"),
        ({"mass": "heavy"}, r"body 'solid': mass is not numeric: 'heavy'"),
        ({"mass": [1.0, 2.0]}, r"body 'solid': mass has shape \(2,\), expected \(\)"),
        ({"center_of_mass": [0, 0]}, r"body 'solid': center_of_mass has shape \(2,\), expected \(3,\)"),
        ({"center_of_mass": [0, np.inf, 0]}, r"body 'solid': center_of_mass contains NaN or infinity: \[0\.0, inf"),
        ({"center_of_mass": None}, r"body 'solid': center_of_mass has shape \(\), expected \(3,\)"),
        ({"inertia": [1.0, 1.0, 1.0]}, r"body 'solid': inertia has shape \(3,\), expected \(3, 3\)"),
        (
            {"inertia": [[1, 0.25, 0], [0, 1, 0], [0, 0, 1]]},
            r"body 'solid': inertia tensor is not symmetric \(largest difference 0\.25 kg m²\)",
        ),
    ],
)
def test_body_is_refused(change, message):
    with pytest.raises(InvalidModel, match=message):
        dataclasses.replace(SOLID, **change)


def test_body_parameters_are_refused():
    with pytest.raises(InvalidModel, match=r"body 'b': parameter vector has shape \(9,\), expected \(10,\)"):
        Body.from_parameters("b", np.ones(9))
    with pytest.raises(InvalidModel, match=r"body 'b': mass is 0 but the first moment is \[1\.0, 0\.0, 0\.0\] kg m"):
        Body.from_parameters("b", [0, 1, 0, 0, 1, 0, 1, 0, 0, 1])
    with pytest.raises(InvalidModel, match=r"robot 'tree6': parameter vector has shape \(10,\), expected \(60,\)"):
        NAMED["branched"].with_inertial_parameters(np.ones(10))
    with pytest.raises(InvalidModel, match=r"robot 'tree6': parameter vector is not numeric: 'heavy'"):
        NAMED["branched"].with_inertial_parameters("heavy")
    with pytest.raises(InvalidModel, match=r"robot 'tree6': gravity is not numeric"):
        NAMED["branched"].with_gravity("down")
    negative = NAMED["branched"].inertial_parameters.copy()
    negative[30] = -4.0
    with pytest.raises(InvalidModel, match=r"body 'body4': mass -4\.0 kg is negative"):
        NAMED["branched"].with_inertial_parameters(negative)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "planar"}, r"joint 'hinge': kind 'planar' cannot be represented; use one of revolute, continuous, "),
        ({"axis": [0, 0, 0]}, r"joint 'hinge': axis is zero; give a direction"),
        ({"placement": np.eye(4)}, r"joint 'hinge': placement is of type ndarray, not Placement"),
        ({"limits": (-1, 1)}, r"joint 'hinge': limits is of type tuple, not JointLimits"),
        ({"inside": 0.0}, r"joint 'hinge': inside is of type float, not Integral"),
        ({"axis": [0, 1]}, r"joint 'hinge': axis has shape \(2,\), expected \(3,\)"),
        ({"axis": [0, np.nan, 1]}, r"joint 'hinge': axis contains NaN or infinity: \[0\.0, nan, 1\.0\]"),
        ({"damping": np.inf}, r"joint 'hinge': damping contains NaN or infinity"),
        ({"friction": "dry"}, r"joint 'hinge': friction is not numeric: 'dry'"),
        ({"limits": JointLimits(lower=np.nan)}, r"joint 'hinge': lower limit is nan; leave it out \(None\)"),
        ({"limits": JointLimits(upper=np.inf)}, r"joint 'hinge': upper limit is inf; leave it out \(None\)"),
        ({"limits": JointLimits(velocity=np.inf)}, r"joint 'hinge': velocity limit is inf; leave it out"),
        ({"limits": JointLimits(effort=np.nan)}, r"joint 'hinge': effort limit is nan; leave it out"),
        (
            {"limits": JointLimits(lower=1.0, upper=-1.0)},
            r"joint 'hinge': lower limit 1\.0 is above upper limit -1\.0; swap them",
        ),
    ],
)
def test_joint_is_refused(change, message):
    with pytest.raises(InvalidModel, match=message):
        hinge(**change)


def test_limits_and_frames_of_the_wrong_type_are_refused():
    with pytest.raises(InvalidModel, match=r"lower limit is 'a'; give a number, or None where there is none"):
        JointLimits("a", 1.0)
    with pytest.raises(InvalidModel, match=r"frame 'tool': body is of type float, not Integral"):
        Frame("tool", 0.5, Placement())
    with pytest.raises(InvalidModel, match=r"frame 'tool': placement is of type NoneType, not Placement"):
        Frame("tool", 1, None)


def test_a_tiny_axis_is_a_direction_like_any_other():
    assert (
        np.abs(hinge(axis=[3e-200, 0, 4e-200]).axis - [0.6, 0, 0.8]).max() < 4 * np.finfo(float).eps
    )  # a few roundings


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"bodies": (), "joints": ()}, r"robot 'r': no moving body; the dynamics of a model without joints are empty"),
        ({"joints": ()}, r"robot 'r': 1 body but 0 joints; a tree has one each"),
        ({"bodies": (SOLID, SOLID), "joints": (hinge("a"), hinge("b"))}, r"robot 'r': body name 'solid' is used more"),
        ({"base_name": "solid"}, r"robot 'r': body name 'solid' is used more than once"),
        ({"bodies": (SOLID, POINT), "joints": (hinge(), hinge())}, r"robot 'r': joint name 'hinge' is used more than"),
        (
            {"frames": (Frame("tool", 1, Placement()), Frame("other", 1, Placement(), aliases=("tool",)))},
            r"robot 'r': frame name 'tool' is used more than once",
        ),
        (
            {"joints": (hinge(inside=1),)},
            r"joint 'hinge': inside body 1 does not come before body 1; list parents first \(0 is the ground\)",
        ),
        ({"joints": (hinge(inside=-1),)}, r"joint 'hinge': inside body -1 does not come before body 1"),
        ({"frames": (Frame("solid", 0, Placement()),)}, r"robot 'r': frame name 'solid' is used more than once"),
        ({"frames": (Frame("tool", 2, Placement()),)}, r"frame 'tool': there is no body 2"),
        ({"base": np.eye(4)}, r"robot 'r': base is of type ndarray, not Placement"),
        ({"gravity": [0, 0]}, r"robot 'r': gravity has shape \(2,\), expected \(3,\)"),
        ({"gravity": [0, 0, np.nan]}, r"robot 'r': gravity contains NaN or infinity: \[0\.0, 0\.0, nan\]"),
    ],
)
def test_robot_is_refused(arguments, message):
    with pytest.raises(InvalidModel, match=message):
        RobotModel(**{"name": "r", "bodies": (SOLID,), "joints": (hinge(),)} | arguments)


def test_unknown_frame_is_refused_with_the_known_names():
    with pytest.raises(UnknownFrame, match=r"robot 'kr500' has no frame 'tool'; known: B0, B1, B2, B3, B4, B5, B6"):
        NAMED["kr500"].frame("tool")
    with pytest.raises(UnknownFrame, match=r"has no frame 'tool'"):
        graphdyn.frame_placement(NAMED["kr500"], np.zeros(6), "tool")


def test_graph_out_of_order_is_refused():
    with pytest.raises(InvalidModel, match=r"joint 2 has inside vertex 2; a tree with parents first needs 0 … 1"):
        graphdyn.Graph((0, 2))
    with pytest.raises(InvalidModel, match=r"joint 1 has inside vertex -1"):
        graphdyn.Graph((-1,))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"rotation": "upright"}, r"rotation is not numeric: 'upright'"),
        ({"rotation": np.eye(2)}, r"rotation has shape \(2, 2\), expected \(3, 3\)"),
        ({"translation": [1.0]}, r"translation has shape \(1,\), expected \(3,\)"),
        ({"translation": [1.0, np.nan, 0.0]}, r"translation contains NaN or infinity: \[1\.0, nan, 0\.0\]"),
        ({"rotation": np.diag([1.0, 1.0, 1.1])}, r"not a proper rotation matrix \(\|RᵀR - E\| = 2\.1e-01\)"),
        ({"rotation": np.diag([1.0, 1.0, -1.0])}, r"rotation is not a proper rotation matrix"),
    ],
)
def test_placement_is_refused(arguments, message):
    with pytest.raises(InvalidModel, match=message):
        Placement(**arguments)


def test_a_trillionth_of_the_trace_is_rounding():
    """The trace is 4 kg m²."""

    def problems(moments):
        return len(consistency_problems(1.0, np.diag(moments)))

    assert problems([1.0, 1.0, 2 + 3.9e-12]) == 0
    assert problems([1.0, 1.0, 2 + 4.1e-12]) == 1
    assert problems([4.1e-12, 2.0, 2.0]) == 0
    assert problems([3.9e-12, 2.0, 2.0]) == 1


@pytest.mark.parametrize(
    ("mass", "moments", "problems"),
    [
        (1.0, (1.0, 1.0, 1.5), ()),
        (1.0, (1.0, 1.0, 2.0), ()),  # a plane body, just possible
        (0.0, (0.0, 0.0, 0.0), ("mass is zero",)),
        (0.0, (1.0, 1.0, 1.0), ("mass is zero but the inertia tensor is not",)),
        (1.0, (0.0, 0.0, 0.0), ("inertia tensor is zero: a point mass",)),
        (1.0, (1.0, 1.0, 2.02), ("triangle inequality violated: principal moment 2.02 exceeds the sum 2 kg m²",)),
        (1.0, (1.0, 1.0, 2.5), ("triangle inequality violated: principal moment 2.5 exceeds the sum 2 kg m²",)),
        (
            1.0,
            (-0.5, 1.0, 1.0),
            ("inertia tensor is not positive definite (smallest principal moment -0.5", "triangle inequality violated"),
        ),
    ],
)
def test_physical_consistency_says_why_no_body_is_like_this(rng, mass, moments, problems):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]  # the verdict does not depend on the axes
    body = Body("b", mass, np.array([0.1, 0.2, 0.3]), turn @ np.diag(moments) @ turn.T)
    model = RobotModel("r", (SOLID, body), (hinge("one"), hinge("two", inside=1)))
    fine, verdict = model.physical_consistency()
    assert fine.consistent
    assert fine.body == "solid"
    assert verdict.body == "b"
    assert verdict.consistent == (not problems)
    assert len(verdict.problems) == len(problems)
    for found, expected in zip(verdict.problems, problems, strict=True):
        assert found.startswith(expected)


def test_pseudo_inertia_eigenvalue_has_the_sign_of_the_verdict():
    for robot in NAMED.values():
        for verdict in robot.physical_consistency():
            assert verdict.consistent
            assert verdict.pseudo_inertia_eigenvalue > 0
    slab = Body("slab", 1.0, np.zeros(3), np.diag([1.0, 1.0, 2.5]))
    verdict = RobotModel("r", (slab,), (hinge(),)).physical_consistency()[0]
    # ½ tr J E - J has the smallest entry ½ · 4.5 - 2.5
    assert verdict.pseudo_inertia_eigenvalue == pytest.approx(-0.25, abs=1e-15)


def test_units_of_the_joints_at_hand():
    """Of those that turn, of those that slide, or both; of no joint as of one that turns."""
    turning = Joint("a", "revolute", 0, Placement(), (0, 0, 1))
    sliding = Joint("b", "prismatic", 1, Placement(), (0, 0, 1))
    for joints, unit in (
        ([turning], "N m"), ([sliding], "N"), ([sliding, turning], "N m or N"), ([], "N m"),
    ):  # fmt: skip
        assert unit_of(joints, "N m", "N") == unit
