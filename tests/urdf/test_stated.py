"""What a file states of links and joints, against yourdfpy, which reads the same numbers of a file without faults."""

import numpy as np
import pytest
import yourdfpy
from lxml import etree
from urdf_text import joint, link, robot_text

import urdf
from urdf.stated import stated_robot

TURNS = (
    *("0 0 0", "-0.0 0 -0.0", "1.57 -1.57 3.14", "0 1.5707963267948966 0.3", "0.1 -1.5707963267948966 2", "7 -8 9"),
    *("1e-300 1e-9 1e-5", " 3.141592653589793\t-3.141592653589793 1e-16", "0.4 0.3 -1.1", "1 2 3"),
)
"""rpy, also where the three angles cannot be told apart."""

ODD = robot_text(
    "odd",
    link("l0", None),
    *(
        link(f"l{k}", 1 + k / 7, xyz=f"{k / 3} -0.0 1e-3", rpy=turn, tensor="3 .1 -2e-1 4 0 +5")
        for k, turn in enumerate(TURNS, 1)
    ),
    *(joint(f"j{k}", f"l{k - 1}", f"l{k}", "revolute", f'<origin rpy="{turn}"/>') for k, turn in enumerate(TURNS, 1)),
    '<joint name="slide" type="prismatic"><parent link="l1"/><child link="carriage"/><origin xyz="1 2 3"/><axis/>'
    '<limit lower="-1" effort="2" velocity="1.79769e+308"/><dynamics friction="0.3"/>'
    '<mimic joint="j1" offset="2"/></joint>',
    '<joint name="fixed" type="fixed"><parent link="l2"/><child link="carrier"/></joint>',
    '<link name="carriage"/><link name="carrier"><inertial><mass value="2"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>',
)  # fmt: skip
"""Every turn of an inertial and of a joint, and what may be left out."""


def numbers(part, names):
    """The parts of a part, None where there is none, to the last bit."""
    found = [getattr(part, name, None) for name in names]
    return [None if value is None else np.asarray(value, dtype=float).tobytes() for value in found]


@pytest.mark.parametrize("name", ["odd", "panda", "ur5"])
def test_numbers_are_those_that_yourdfpy_reads(name, tmp_path):
    path = next((entry.path for entry in urdf.robots() if entry.name == name), tmp_path / "odd.urdf")
    if name == "odd":
        path.write_text(ODD, encoding="utf-8")
    theirs = yourdfpy.URDF.load(str(path), build_scene_graph=False, load_meshes=False).robot
    ours = stated_robot(etree.parse(path).getroot())
    assert ours.name == theirs.name
    for stated, read in zip(ours.links, theirs.links, strict=True):
        assert (stated.name, stated.inertial is None) == (read.name, read.inertial is None)
        parts = ("mass", "inertia", "origin")
        assert numbers(stated.inertial, parts) == numbers(read.inertial, parts), stated.name
    for stated, read in zip(ours.joints, theirs.joints, strict=True):
        ends = ("name", "type", "parent", "child")
        assert [getattr(stated, end) for end in ends] == [getattr(read, end) for end in ends]
        assert numbers(stated, ("origin", "axis")) == numbers(read, ("origin", "axis")), stated.name
        limits = {side: getattr(read.limit, side, None) for side in ("lower", "upper", "velocity", "effort")}
        assert stated.limits == {side: limit for side, limit in limits.items() if limit is not None}
        for part in ("damping", "friction"):
            assert getattr(stated, part) == float(getattr(read.dynamics, part, None) or 0.0)
        parts = ("joint", "multiplier", "offset")
        assert [getattr(stated.mimic, part, None) for part in parts] == [
            getattr(read.mimic, part, None) for part in parts
        ]
