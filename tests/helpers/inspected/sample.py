"""A robot without a flaw, and changes of it."""

import re
from dataclasses import dataclass

from urdf_text import with_changes

CLEAN = """\
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 0.2 0.3" rpy="0 0 0"/>
      <mass value="2.5"/>
      <inertia ixx="0.11" ixy="0" ixz="0" iyy="0.13" iyz="0" izz="0.17"/>
    </inertial>
  </link>
  <link name="fore">
    <inertial>
      <origin xyz="0 0 0.4" rpy="0 0 0"/>
      <mass value="1.5"/>
      <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.5" rpy="0 0 0"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="30" velocity="3"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0.3 0 0" rpy="0 0 0"/>
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="30" velocity="3"/>
  </joint>
  <joint name="flange" type="fixed">
    <origin xyz="0 0 0.2" rpy="0 0 0"/>
    <parent link="fore"/>
    <child link="tool"/>
  </joint>
</robot>
"""

MASS = '<mass value="2.5"/>'
INERTIA = '<inertia ixx="0.11" ixy="0" ixz="0" iyy="0.13" iyz="0" izz="0.17"/>'
FORE = '<inertia ixx="0.05" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.02"/>'
ORIGIN = '<origin xyz="0.1 0.2 0.3" rpy="0 0 0"/>'
SHOULDER = '<joint name="shoulder" type="revolute">'
ELBOW = '<joint name="elbow" type="revolute">'
AXIS = '<axis xyz="0 0 1"/>'
LIMIT = '<limit lower="-1" upper="2" effort="30" velocity="3"/>'
TOOL = '<link name="tool"/>'
UNREADABLE = "Pinocchio gives a link with such a number mass 0 or a tensor of zero and refuses such a joint"
FORE_INERTIAL = re.findall(r"<inertial>.*?</inertial>", CLEAN, re.DOTALL)[1]

LOOP = '<loop name="l" type="{}"><predecessor link="base"/>'
FAR = '<successor link="fore"><origin xyz="9 0 0"/></successor>'
PARALLEL = (
    '<loop name="l" type="spherical"><predecessor link="base"><origin xyz="0.3 0 0.5"/></predecessor>'
    '<successor link="fore"/></loop>'
)
ELBOW_LIMIT = f'<axis xyz="0 1 0"/>\n    {LIMIT}'
"""With the axis that tells it from the other one."""

MOTOR = '<transmission><joint name="shoulder"/><actuator/></transmission>'


@dataclass(frozen=True)
class Case:
    """Replacements in CLEAN (old, new, old, new, …), each old text once, and the first finding of the code."""

    changes: tuple[str, ...]
    severity: str
    element: str | None
    line: int | None
    message: str
    remedy: str


def changed(*changes: str) -> str:
    """CLEAN with these replacements."""
    return with_changes(CLEAN, *changes)


def link_behind(parent: str, name: str, mass: str, inside: str = "") -> str:
    """A further link on a joint without limits, as text."""
    inertia = '<inertia ixx="0.05" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.02"/>'
    return (
        f'<link name="{name}">{inside}<inertial><origin xyz="0 0 0"/><mass value="{mass}"/>{inertia}</inertial></link>'
        f'<joint name="to {name}" type="continuous"><origin xyz="0 0 0.1"/><parent link="{parent}"/>'
        f'<child link="{name}"/><axis xyz="1 0 0"/></joint>'
    )


def mesh_file(name: str) -> str:
    """A <visual> that shows it."""
    return f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'


MESH_CODES = ("center-outside-mesh", "mesh-density", "miswritten-inertia", "inertia-unlike-mesh", "inertia-of-mesh")
"""Codes of findings about inertials beside the meshes of their links."""
