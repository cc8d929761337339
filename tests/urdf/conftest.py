"""A small valid robot as text, to be changed in one place and written to a file."""

from collections.abc import Callable
from pathlib import Path

import pytest
from robots.mesh_files import box, one_link, visual
from shared_data import ARMS, existing
from urdf_text import robot_text, with_changes

ARM = """\
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 0.2 0.3" rpy="0 0 0"/>
      <mass value="2.5"/>
      <inertia ixx="0.11" ixy="0.01" ixz="0.02" iyy="0.13" iyz="0.03" izz="0.17"/>
    </inertial>
  </link>
  <link name="fore">
    <inertial>
      <origin xyz="0 0 0.4" rpy="0.3 -0.2 0.7"/>
      <mass value="1.5"/>
      <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.5" rpy="0 0 1.5708"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="30" velocity="3"/>
    <dynamics damping="0.5" friction="0.25"/>
  </joint>
  <joint name="slide" type="prismatic">
    <origin xyz="0.3 0 0"/>
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0 1 0"/>
  </joint>
  <joint name="flange" type="fixed">
    <origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/>
    <parent link="fore"/>
    <child link="tool"/>
  </joint>
</robot>
"""

Writer = Callable[..., Path]


@pytest.fixture
def arm(tmp_path: Path) -> Writer:
    """arm(old, new, old, new, …): the file with these replacements, each old text once."""

    def write(*changes: str) -> Path:
        path = tmp_path / "arm.urdf"
        path.write_text(with_changes(ARM, *changes), encoding="utf-8")
        return path

    return write


@pytest.fixture
def written(tmp_path: Path) -> Writer:
    """written(text): a file of this text, or of these bytes."""

    def write(content: str | bytes) -> Path:
        path = tmp_path / "arm.urdf"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.fixture
def robot(tmp_path: Path) -> Writer:
    """robot(*elements): the file with exactly these elements in <robot>."""

    def write(*elements: str) -> Path:
        path = tmp_path / "robot.urdf"
        path.write_text(robot_text("robot", *elements), encoding="utf-8")
        return path

    return write


@pytest.fixture(scope="session")
def vendor_arms() -> Path:
    return existing(ARMS)


@pytest.fixture
def drawn(tmp_path):
    """drawn(geometry, content): the one link of a robot in folder/pkg/urdf, beside the file folder/pkg/meshes/a.stl."""

    def write(geometry, content=None, name="a.stl"):
        path = tmp_path / "pkg" / "meshes" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content or box().export(file_type="stl"))
        robot = tmp_path / "pkg" / "urdf" / "r.urdf"
        robot.parent.mkdir(exist_ok=True)
        robot.write_text(one_link(visual(geometry)), encoding="utf-8")
        return robot

    return write
