"""Two descriptions of one robot: the map between them, and what is planted in one of them."""

from dataclasses import replace

import numpy as np
import pytest
from robots.disguised import AXIS, CENTER, LENGTH, MASS, TENSOR, disguised, planted
from robots.ur5e_like import ur5e_like
from shared_data import ARMS

import graphdyn
import urdf
from graphdyn import Coupling, InvalidInput, Joint, JointLimits, Placement, RobotModel
from graphdyn.aligning import VERDICTS, align, differences

ROUNDING = 1e-12
"""Error of torques and of angles, as a part of the largest: some tens of rotations one after the other, at most 4e-15
over 200 pairs."""

STATES = 10


@pytest.fixture(scope="module")
def arm():
    return urdf.load(str(ARMS / "ur5e.urdf"))


def moves_alike(model, again):
    q, v = model.random_state(np.random.default_rng(1), STATES)
    tau = graphdyn.joint_torques(model, q, v, v)
    return np.abs(graphdyn.joint_torques(again, q, v, v) - tau).max() <= ROUNDING * np.abs(tau).max()


@pytest.mark.parametrize(
    "changes", [("signs", "zeros", "base"), ("tool", "frames", "limits"), ("zeros", "frames", "names")]
)
def test_a_robot_written_in_another_way_is_the_same(arm, changes):
    again, signs, zeros = disguised(arm, np.random.default_rng(0), changes)
    found = align(arm, again)
    assert moves_alike(arm, found.model)
    assert found.model.joint_names == arm.joint_names
    assert differences(arm, again, samples=STATES).joints == ()
    if "base" not in changes:
        assert found.map.signs == pytest.approx(signs)
        assert found.map.zeros == pytest.approx(zeros, abs=ROUNDING)
        q = np.full(6, 0.3)
        assert found.map.positions(q) == pytest.approx(signs * q + zeros)


def test_the_map_of_a_robot_onto_itself_changes_nothing_and_its_class_is_listed(arm):
    found = align(arm, arm)
    assert found.map.n_changes(ROUNDING, 1.0) == 0
    flipped = [each for each in found.others if (each.signs < 0).any()]
    assert flipped, "a wrist of three perpendicular axes can be written flipped"


def without_inertia(model):
    return replace(model, bodies=tuple(replace(body, mass=0.0, inertia=np.zeros((3, 3))) for body in model.bodies))


PARALLEL = {(f"{name}_joint", "length") for name in ("lift", "elbow", "wrist_1", "wrist_2")}
"""Where a length along an axis may be, with links without inertia: that axis has parallel ones before it."""


@pytest.mark.parametrize(
    ("kind", "joint", "causes", "without"),
    [
        # a first axis that is tilted: the base may be tilted back, and then all that follows is
        ("axis", 1, {("pan_joint", "axis")}, {("pan_joint", "axis"), ("lift_joint", "angle")}),
        # the last axis, and how the link before it is turned: the tool absorbs the rest
        ("axis", 6, {("wrist_3_joint", "axis")}, {("wrist_3_joint", "axis"), ("wrist_3_joint", "angle")}),
        # a length along the axis before it: a link without inertia may be moved along that
        ("length", 5, {("wrist_2_joint", "length")}, PARALLEL),
    ],
)
def test_inertia_tells_which_joint_differs_and_without_it_all_that_may_are_named(kind, joint, causes, without):
    def named(model):
        moved = planted(model, np.random.default_rng(1), kind, joint)
        if kind == "length":
            along, here = Placement(translation=model.joints[joint - 2].axis * LENGTH), model.joints[joint - 1]
            longer = replace(here, placement=along @ here.placement)
            moved = replace(model, joints=(*model.joints[: joint - 1], longer, *model.joints[joint:]))
        (found,) = differences(model, moved, samples=STATES).joints
        assert found.value == pytest.approx({"length": LENGTH, "axis": AXIS}[kind], rel=1e-6)
        return {(found.joint, found.kind), *((each.element, each.kind) for each in found.or_else)}

    arm = ur5e_like()
    assert named(arm) == causes
    assert named(without_inertia(arm)) == without


@pytest.mark.parametrize("lifted", [False, True])
def test_a_sliding_joint_is_aligned(lifted):
    model = lifted_arm() if lifted else sliding_arm()
    again, *_ = disguised(model, np.random.default_rng(1), ("signs", "zeros", "base", "frames"))
    found = differences(model, again, samples=STATES)
    assert moves_alike(model, found.alignment.model)
    assert found.verdict == VERDICTS[0]


def lifted_arm():
    """Slides along z, turns about z, x, y: zero of the second joint and base trade but for the inertia of the first."""
    x, y, z = np.eye(3)
    place = Placement(np.eye(3), [0.2, 0.1, 0.3])
    kinds = [("prismatic", z), ("revolute", z), ("revolute", x), ("revolute", y)]
    joints = [Joint(f"j{k}", kind, k, place, axis, JointLimits(-1, 1.5)) for k, (kind, axis) in enumerate(kinds)]
    bodies = [graphdyn.Body(f"b{k}", 1 + k, [0.02, 0.03, 0.05], np.diag([2, 3, 4]) * 1e-2) for k in range(4)]
    return RobotModel("lifted", tuple(bodies), tuple(joints))


def test_a_length_along_a_joint_that_slides_is_its_zero():
    model = sliding_arm()
    place = model.joints[1].placement @ Placement(translation=[0, 0, LENGTH])
    longer = replace(model, joints=(model.joints[0], replace(model.joints[1], placement=place), *model.joints[2:]))
    found = differences(model, longer, samples=STATES)
    assert (found.joints, found.links) == ((), ())
    assert found.alignment.map.zeros == pytest.approx([0, -LENGTH, 0, 0, 0])


def sliding_arm():
    """Turns about z, slides along z and x, turns about x, slides along y."""
    x, y, z = np.eye(3)
    axes = [("revolute", z), ("prismatic", z), ("prismatic", x), ("revolute", x), ("prismatic", y)]
    place = Placement(np.eye(3), [0.2, 0.1, 0.3])
    joints = [Joint(f"j{k}", kind, k, place, axis, JointLimits(-1, 1)) for k, (kind, axis) in enumerate(axes)]
    bodies = [graphdyn.Body(f"b{k}", 1 + k, [0.02, 0.03, 0.05], np.diag([2, 3, 4]) * 1e-2) for k in range(len(axes))]
    return RobotModel("sliding", tuple(bodies), tuple(joints))


@pytest.mark.parametrize(
    ("kind", "size"), [("mass", None), ("center", CENTER), ("tensor", None), ("length", LENGTH), ("axis", AXIS)]
)
def test_what_is_planted_in_one_link_is_named_alone(arm, kind, size):
    rng = np.random.default_rng(3)
    again = disguised(planted(arm, rng, kind, 3), rng, ("signs", "zeros", "base", "frames"))[0]
    found = differences(arm, again, samples=STATES)
    named = [(each.joint, each.kind, each.value) for each in found.joints]
    named += [(each.link, each.kind, each.value) for each in found.links]
    values = {"mass": MASS * arm.bodies[2].mass, "tensor": TENSOR * np.abs(arm.bodies[2].inertia).max()}
    where = arm.joint_names[2] if kind in ("length", "axis") else arm.body_names[2]
    ((element, told, value),) = named
    assert (element, told) == (where, kind)
    assert value == pytest.approx(values.get(kind, size), rel=1e-6)  # of a difference of numbers 1e3 times as large
    assert found.verdict == (VERDICTS[3] if kind in ("length", "axis") else VERDICTS[2])
    assert (found.first_cause is None) == (kind not in ("length", "axis"))


def test_torques_decide_between_the_verdicts(arm):
    """Mass moved between two links so that the torques stay: m c and I of the first joint's link about its axis."""
    first = arm.bodies[0]
    lighter = replace(first, mass=first.mass / 2, center_of_mass=np.array([0, 0, 0.0]), inertia=first.inertia)
    heavier = replace(first, mass=first.mass, center_of_mass=np.array([0, 0, 0.0]), inertia=first.inertia)
    pair = [replace(arm, bodies=(body, *arm.bodies[1:])) for body in (heavier, lighter)]
    found = differences(*pair, samples=STATES)
    assert found.verdict == "equal in all joint torques"
    assert [each.kind for each in found.links] == ["mass"]
    assert found.base_parameters == ()
    rubbing = replace(arm, joints=(replace(arm.joints[0], friction=3.0, damping=1.0), *arm.joints[1:]))
    found = differences(arm, rubbing, samples=STATES)
    assert found.verdict == "same kinematics only"
    assert [(each.name, each.second) for each in found.settings] == [("damping", 1.0), ("friction", 3.0)]


def test_the_worst_state_of_a_torque_gives_its_difference(arm):
    heavier = planted(arm, np.random.default_rng(0), "mass", 3)
    found = differences(arm, heavier, samples=STATES)
    worst = max(found.torques, key=lambda each: abs(each.difference) if each.term == "gravity" else 0.0)
    joint = arm.joint_names.index(worst.joint)
    there = [graphdyn.gravity_torque(model, worst.q)[joint] for model in (arm, heavier)]
    assert worst.counts
    assert worst.difference == pytest.approx(there[1] - there[0])
    assert 0 < worst.relative < 1
    assert found.base_parameters
    assert any("m" in each.name and each.first != each.second for each in found.base_parameters)


def branched(arm):
    return replace(arm, joints=(*arm.joints[:5], replace(arm.joints[5], inside=4)))


def shortened(arm):
    return replace(arm, bodies=arm.bodies[:5], joints=arm.joints[:5], frames=())


def sliding_last(arm):
    return replace(arm, joints=(*arm.joints[:5], replace(arm.joints[5], kind="prismatic")))


def coupled(arm):
    return replace(arm, couplings=(Coupling("wrist_3_joint", {"wrist_2_joint": 1.0}),))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            branched,
            r"branches at link 'wrist_1_link', before joint 'wrist_3_joint'; choose the chain to one tip \(--tip\)",
        ),
        (shortened, r"has 5 \(shoulder_pan_joint, .*\); choose the chain to one tip \(--tip\)"),
        (sliding_last, r"joint 'wrist_3_joint' slides, and joint 'wrist_3_joint' in its place turns"),
        (coupled, r"has couplings or loops; choose the chain to one tip \(--tip\)"),
        (lambda _: chain_of(13), r"has 13 joints; 12 can be aligned: choose a shorter chain \(--tip\)"),
        (lambda _: "ur5", r"the model is 'ur5'.*give a RobotModel"),
    ],
)
def test_what_cannot_be_aligned_is_refused_by_name(arm, change, message):
    with pytest.raises(InvalidInput, match=message):
        align(arm, change(arm))


def chain_of(n):
    joints = [Joint(f"j{k}", "revolute", k, Placement(np.eye(3), [0, 0, 0.1]), [1, 0, 0]) for k in range(n)]
    return RobotModel("long", tuple(graphdyn.Body(f"b{k}", 1, np.zeros(3), np.eye(3)) for k in range(n)), tuple(joints))


def test_numbers_that_are_none_are_refused(arm):
    with pytest.raises(InvalidInput, match=r"tolerance is 0; give a number above zero"):
        align(arm, arm, tolerance=0.0)
    with pytest.raises(InvalidInput, match=r"samples is 0; give a whole number of states from 1 on"):
        differences(arm, arm, samples=0)
