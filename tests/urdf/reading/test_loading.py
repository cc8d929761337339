"""What urdf.load makes of a file: numbers bit by bit, fusing, frames, order, warnings."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from urdf_text import joint, link

import graphdyn
import urdf
from graphdyn.model.inertia import parallel_axis
from graphdyn.model.spatial import rotation_about

E1, E2, E3 = np.eye(3)


def rpy(roll: float, pitch: float, yaw: float) -> np.ndarray:
    return rotation_about(E3, yaw) @ rotation_about(E2, pitch) @ rotation_about(E1, roll)


def test_the_arm(arm):
    model = urdf.load(arm())
    assert model.name == "arm"
    assert model.base_name == "base"
    assert model.body_names == ("upper", "fore")
    assert model.joint_names == ("shoulder", "slide")
    assert_array_equal(model.gravity, [0, 0, -9.81])
    shoulder, slide = model.joints
    assert (shoulder.kind, slide.kind) == ("revolute", "prismatic")
    assert (shoulder.inside, slide.inside) == (0, 1)
    assert shoulder.limits == graphdyn.JointLimits(lower=-1, upper=2, velocity=3, effort=30)
    assert (shoulder.damping, shoulder.friction) == (0.5, 0.25)
    assert slide.limits == graphdyn.JointLimits()
    assert (slide.damping, slide.friction) == (0.0, 0.0)
    assert_array_equal(slide.axis, E2)
    assert_array_equal(slide.placement.translation, [0.3, 0, 0])
    assert_array_equal(slide.placement.rotation, np.eye(3))


def test_unrotated_inertia_is_bit_identical(arm):
    upper = urdf.load(arm()).bodies[0]
    assert upper.mass == 2.5
    assert_array_equal(upper.center_of_mass, [0.1, 0.2, 0.3])
    assert_array_equal(upper.inertia, [[0.11, 0.01, 0.02], [0.01, 0.13, 0.03], [0.02, 0.03, 0.17]])


def test_inertial_frame_is_rotated(arm):
    fore = urdf.load(arm()).bodies[1]
    rotation = rpy(0.3, -0.2, 0.7)
    assert_array_equal(fore.center_of_mass, [0, 0, 0.4])
    assert_allclose(fore.inertia, rotation @ np.diag([0.05, 0.06, 0.02]) @ rotation.T, rtol=0, atol=4e-16)


def test_truncated_angle_is_used_as_written(arm):
    rotation = urdf.load(arm()).joints[0].placement.rotation
    assert_allclose(rotation, rotation_about(E3, 1.5708), rtol=0, atol=4e-16)
    assert abs(rotation[0, 0]) > 3e-6


def test_fixed_child_is_fused_and_stays_as_frame(robot):
    path = robot(
        link("base"),
        link("body", mass=2, xyz="0.1 0 0"),
        link("cap", mass=3, xyz="0 0 0.2"),
        joint("turn", "base", "body"),
        joint("glue", "body", "cap", "fixed", '<origin xyz="0 0.5 0" rpy="1.1 0.2 -0.4"/>'),
    )
    model = urdf.load(path)
    body = model.bodies[0]
    rotation, offset = rpy(1.1, 0.2, -0.4), np.array([0, 0.5, 0])
    centers = np.array([0.1, 0, 0]), rotation @ [0, 0, 0.2] + offset
    center = (2 * centers[0] + 3 * centers[1]) / 5
    tensor = 0.2 * np.eye(3) + parallel_axis(2, centers[0] - center) + parallel_axis(3, centers[1] - center)
    assert body.mass == 5
    assert_allclose(body.center_of_mass, center, rtol=4e-16, atol=4e-16)
    assert_allclose(body.inertia, tensor, rtol=1e-14, atol=4e-16)
    (frame,) = model.frames
    assert (frame.name, frame.body, frame.aliases) == ("cap", 1, ("glue",))
    assert model.frame("glue") is frame
    assert_array_equal(frame.placement.translation, offset)
    assert_allclose(frame.placement.rotation, rotation, rtol=0, atol=4e-16)


def test_joint_behind_a_fixed_link(robot):
    path = robot(
        link("base"),
        link("bracket", mass=None),
        link("body"),
        joint("bolt", "base", "bracket", "fixed", '<origin xyz="1 0 0" rpy="0 0 0.5"/>'),
        joint("turn", "bracket", "body", more='<origin xyz="0 2 0"/>'),
    )
    placement = urdf.load(path).joints[0].placement
    assert_allclose(placement.translation, [1 - 2 * np.sin(0.5), 2 * np.cos(0.5), 0], rtol=4e-16, atol=4e-16)
    assert_allclose(placement.rotation, rotation_about(E3, 0.5), rtol=0, atol=4e-16)


def test_inertia_fused_to_the_ground_is_dropped(robot):
    path = robot(
        link("base", mass=5), link("plate", mass=7), link("body"), joint("a", "base", "plate", "fixed"),
        joint("b", "plate", "body"),
    )  # fmt: skip
    model = urdf.load(path)
    assert [body.mass for body in model.bodies] == [1.0]
    assert [(frame.name, frame.body) for frame in model.frames] == [("plate", 0)]


def test_massless_inertials_fuse(robot):
    path = robot(
        link("base"), link("a", mass=0, xyz="1 0 0"), link("b", mass=0, xyz="0 1 0"), joint("turn", "base", "a"),
        joint("glue", "a", "b", "fixed"),
    )  # fmt: skip
    with pytest.warns(urdf.ZeroMassWarning, match="moving links of mass zero: 'a', 'b'; they have no weight"):
        body = urdf.load(path).bodies[0]
    assert body.mass == 0
    assert_array_equal(body.center_of_mass, np.zeros(3))
    assert_allclose(body.inertia, 0.2 * np.eye(3), rtol=1e-15)


def test_order_is_depth_first_with_siblings_in_file_order(robot):
    links = [link(name) for name in ("d", "c", "b", "a", "base")]
    path = robot(
        *links, joint("jc", "base", "c"), joint("jb", "a", "b"), joint("ja", "base", "a"), joint("jd", "c", "d")
    )
    model = urdf.load(path)
    assert model.body_names == ("c", "d", "a", "b")
    assert model.joint_names == ("jc", "jd", "ja", "jb")
    assert [j.inside for j in model.joints] == [0, 1, 0, 3]


def test_frames_are_in_file_order(robot):
    path = robot(
        *(link(name) for name in ("base", "a", "x", "y")),
        joint("fy", "a", "y", "fixed"), joint("ja", "base", "a"), joint("fx", "base", "x", "fixed"),
    )  # fmt: skip
    assert [frame.name for frame in urdf.load(path).frames] == ["y", "x"]


def test_alias_is_dropped_where_a_link_has_the_name(robot):
    path = robot(
        *(link(name) for name in ("base", "a", "tool")), joint("a", "base", "a"), joint("base", "a", "tool", "fixed")
    )
    model = urdf.load(path)
    assert model.frames[0].aliases == ()
    assert model.frame("base").body == 0


def test_axis_defaults_to_x(robot):
    path = robot(link("base"), link("a"), joint("j", "base", "a"))
    assert_array_equal(urdf.load(path).joints[0].axis, E1)


def test_a_fixed_joint_may_have_a_zero_axis(arm):
    model = urdf.load(arm('<child link="tool"/>', '<child link="tool"/><axis xyz="0 0 0"/>'))
    assert model.frame("flange").name == "tool"


def test_limits_that_make_no_sense_are_kept(arm):
    shoulder = urdf.load(arm('effort="30" velocity="3"', 'effort="-1" velocity="0"')).joints[0]
    assert (shoulder.limits.effort, shoulder.limits.velocity) == (-1, 0)


def test_absent_limits_are_none(arm):
    shoulder = urdf.load(arm('lower="-1" upper="2" ', "")).joints[0]
    assert shoulder.limits == graphdyn.JointLimits(velocity=3, effort=30)


@pytest.mark.parametrize("endless", ["1.79769e+308", "1.7976931348623157e308"])
def test_the_largest_double_says_no_limit(arm, endless):
    """As SDFormat and others print it, with six digits, and in full."""
    stated = f'lower="-{endless}" upper="{endless}" effort="{endless}" velocity="{endless}"'
    shoulder = urdf.load(arm('lower="-1" upper="2" effort="30" velocity="3"', stated)).joints[0]
    assert shoulder.limits == graphdyn.JointLimits()


def test_a_continuous_joint_has_no_position_limits(arm):
    shoulder = urdf.load(arm('"shoulder" type="revolute"', '"shoulder" type="continuous"')).joints[0]
    assert shoulder.kind == "continuous"
    assert shoulder.limits == graphdyn.JointLimits(velocity=3, effort=30)


def test_gravity(arm):
    assert_array_equal(urdf.load(arm(), gravity=(0, 1, 2)).gravity, [0, 1, 2])


@pytest.mark.parametrize(
    ("axis", "length"), [("0 0 0.99", "0.99"), ("1 1 0", "1.41421356"), ("0 0.5773 0.8165", "0.99997377")]
)
def test_axis_is_normalized_with_a_warning(arm, axis, length):
    path = arm('<axis xyz="0 0 1"/>', f'<axis xyz="{axis}"/>')
    with pytest.warns(
        urdf.AxisNotNormalizedWarning, match=rf"axis not of unit length, normalized: joint 'shoulder' \({length}\)"
    ):
        model = urdf.load(path)
    direction = np.array(axis.split(), dtype=float)
    assert_allclose(model.joints[0].axis, direction / np.linalg.norm(direction), rtol=0, atol=4e-16)


def test_an_axis_of_nearly_unit_length_is_silent(arm):
    path = arm('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1.0000000009"/>')
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model = urdf.load(path)
    assert caught == []
    assert_array_equal(model.joints[0].axis, E3)


def test_missing_inertial_is_warned_about(robot):
    path = robot(
        link("base", mass=None), link("a", mass=None), link("b", mass=None), link("tip", mass=None), link("c"),
        joint("ja", "base", "a"), joint("f", "a", "tip", "fixed"), joint("jb", "a", "b"), joint("jc", "b", "c"),
    )  # fmt: skip
    with pytest.warns(
        urdf.MissingInertialWarning,
        match=r"without <inertial>: 'a', 'tip', 'b'; their mass is zero and forward dynamics are not determined",
    ) as caught:
        model = urdf.load(path)
    assert [body.mass for body in model.bodies] == [0, 0, 1]
    assert caught[0].filename == __file__


def test_a_long_chain(robot):
    names = [f"l{k}" for k in range(300)]
    joints = [joint(f"j{k}", names[k - 1], names[k], "fixed" if k % 30 else "revolute") for k in range(1, 300)]
    assert urdf.load(robot(*map(link, names), *joints)).n_bodies == 9


def test_fused_links_tell_their_share(robot):
    path = robot(
        link("base"), link("arm", xyz="0.1 0 0"), link("tool", mass=2.0, xyz="0 0.2 0"), link("tip", mass=None),
        joint("turn", "base", "arm"), joint("screws", "arm", "tool", "fixed", '<origin xyz="0.5 0 0" rpy="0 0 0.3"/>'),
        joint("end", "tool", "tip", "fixed"),
    )  # fmt: skip
    shares = urdf.fused_links(path)
    assert list(shares) == ["tool"]
    number, share = shares["tool"]
    assert number == 1
    assert share[0] == 2.0
    with_tool = urdf.load(path).bodies[0].parameters
    bare = robot(
        link("base"), link("arm", xyz="0.1 0 0"), link("tool", mass=None),
        joint("turn", "base", "arm"), joint("screws", "arm", "tool", "fixed", '<origin xyz="0.5 0 0" rpy="0 0 0.3"/>'),
    )  # fmt: skip
    assert_allclose(with_tool - share, urdf.load(bare).bodies[0].parameters, rtol=0, atol=1e-15)


def test_locked_links_are_fused_links_too(arm):
    path = arm()
    assert urdf.fused_links(path) == {}
    assert set(urdf.fused_links(path, lock=["slide"])) == {"fore"}
