"""What the XML around the robot may look like."""

from numpy.testing import assert_array_equal
from urdf_text import joint, link, robot_text

import urdf
from urdf.document.opening import open_document
from urdf.document.source import reduced
from urdf.document.tree import joint_into, joints_by, root_links


def test_what_says_nothing_of_dynamics_is_ignored(arm):
    odd = (
        '<visual><geometry><mesh filename="package://nowhere/a.stl" scale="x"/></geometry></visual>'
        '<collision/><xacro:thing xmlns:xacro="http://www.ros.org/wiki/xacro" mass="${m}"/>'
    )
    path = arm(
        '<link name="tool"/>', f'<!-- comment --><link name="tool">{odd}</link><material/><transmission/>',
        "</robot>", '<x:property xmlns:x="http://www.ros.org/wiki/xacro"/><gazebo><plugin><loop>true</loop></plugin></gazebo></robot>',
    )  # fmt: skip
    assert urdf.load(path).joint_names == ("shoulder", "slide")


def test_default_namespace(arm):
    plain, spaced = urdf.load(arm()), urdf.load(arm("<robot ", '<robot xmlns="http://www.ros.org" '))
    assert spaced.joint_names == plain.joint_names
    assert_array_equal(spaced.inertial_parameters, plain.inertial_parameters)


def test_byte_order_mark_and_other_alphabets(arm):
    path = arm('"tool"', '"Werkzeughälter 工具"', '"tool"', '"Werkzeughälter 工具"')
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert urdf.load(path).frames[0].name == "Werkzeughälter 工具"


def test_joints_of_a_link_in_file_order():
    """Of two that carry one link, the first."""
    twice = joint("one", "a", "c") + joint("two", "b", "c") + joint("three", "a", "b")
    source = reduced(open_document(robot_text("r", link("a"), link("b"), link("c"), twice)))
    assert {name: one.get("name") for name, one in joint_into(source).items()} == {"c": "one", "b": "three"}
    assert [one.get("name") for one in joints_by(source, "child")["c"]] == ["one", "two"]
    assert root_links(source) == ["a"]
