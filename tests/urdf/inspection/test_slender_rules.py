"""Slender links whose tensor lies across them."""

import numpy as np
import pytest

import urdf

ARM = """<robot name="rods"><link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 {center}" rpy="{rpy}"/><mass value="4"/>
    <inertia ixx="{ixx}" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="{izz}"/></inertial></link>
  <link name="lower"><inertial><mass value="2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="a" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
  <joint name="b" type="continuous"><parent link="upper"/><child link="lower"/><axis xyz="0 1 0"/>
    <origin xyz="0 {x} {z}"/></joint></robot>"""


def told(ixx=0.06, izz=0.005, rpy="0 0 0", x=0.0, z=0.5):
    text = ARM.format(ixx=ixx, izz=izz, rpy=rpy, x=x, z=z, center=z / 2)
    return [one for one in urdf.inspect(text).findings if one.code == "inertia-across-link"]


@pytest.mark.parametrize("given", [{"ixx": 0.005, "izz": 0.06}, {"rpy": f"0 {np.pi / 2} 0"}], ids=["moments", "frame"])
def test_a_rod_across_its_link(given):
    (finding,) = told(**given)
    assert (finding.severity, finding.element) == ("warning", "<inertial> of link 'upper'")
    assert finding.message == (
        "the tensor is that of a slender body that lies at 90° to the line from this joint to the next"
    )
    assert finding.remedy == "give it in the axes of the link, or turn its <origin>; axes may be exchanged"


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"rpy": "0.9 0 0"},  # 52°
        {"ixx": 0.03, "izz": 0.06},  # not slender
        {"ixx": 0.005, "izz": 0.06, "z": 0.09},  # the next joint is near
        {"ixx": 0.005, "izz": 0.06, "x": 0.5, "z": 0.0, "rpy": f"0 0 {np.pi / 2}"},
        {"ixx": -0.005, "izz": 0.06},  # impossible, which has a finding
    ],
)
def test_silence(given):
    assert told(**given) == []
