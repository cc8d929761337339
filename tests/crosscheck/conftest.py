"""Fixtures of the cross-check tests; the random trees come from the tests of graphdyn."""

import importlib.util
import sys
from pathlib import Path

import pytest

TREES = Path(__file__).parents[1] / "graphdyn"
if importlib.util.find_spec("random_trees") is None:  # this folder is tested alone
    sys.path.append(str(TREES))

from planting import Plant, mixed_tree  # noqa: E402

SMALL_ARM = """\
<robot name="small">
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
      <origin xyz="0 0.1 0.4" rpy="0.3 -0.2 0.7"/>
      <mass value="1.5"/>
      <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <link name="slider">
    <inertial>
      <origin xyz="-0.1 0 0.05" rpy="0 0.4 0"/>
      <mass value="0.7"/>
      <inertia ixx="0.004" ixy="0.001" ixz="0" iyy="0.006" iyz="0" izz="0.005"/>
    </inertial>
  </link>
  <link name="tool">
    <inertial>
      <origin xyz="0.02 0.01 0.03" rpy="0 0 0"/>
      <mass value="0.2"/>
      <inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0002" iyz="0" izz="0.0002"/>
    </inertial>
  </link>
  <joint name="z_shoulder" type="continuous">
    <origin xyz="0 0.1 0.5" rpy="0.4 0.3 -1.1"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 0.6 0.8"/>
  </joint>
  <joint name="y_elbow" type="revolute">
    <origin xyz="0.3 0 0.1" rpy="1.2 0 0.5"/>
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="30" velocity="3"/>
    <dynamics damping="0.5" friction="0.25"/>
  </joint>
  <joint name="a_slide" type="prismatic">
    <origin xyz="-0.2 0.1 0" rpy="0 0.2 0"/>
    <parent link="upper"/>
    <child link="slider"/>
    <axis xyz="1 0 0"/>
    <limit lower="-0.3" upper="0.4" effort="30" velocity="1"/>
  </joint>
  <joint name="flange" type="fixed">
    <origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/>
    <parent link="fore"/>
    <child link="tool"/>
  </joint>
</robot>
"""
"""One joint of each kind, branching; the order of the file is the reverse of the alphabet; a tool with mass."""


@pytest.fixture
def small_arm(tmp_path):
    path = tmp_path / "small.urdf"
    path.write_text(SMALL_ARM, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def tree():
    """Three bodies, one joint of each kind, branching, mounted anywhere: compared in a fifth of a second."""
    return mixed_tree()


@pytest.fixture
def plant(monkeypatch):
    return Plant(monkeypatch)
