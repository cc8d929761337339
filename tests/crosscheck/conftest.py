"""Fixtures of the cross-check tests."""

import pytest
from planting import Plant, mixed_tree
from urdf_text import joint, link, robot_text

SMALL_ARM = robot_text(
    "small",
    link("base", None),
    link("upper", 2.5, xyz="0.1 0.2 0.3", tensor="0.11 0.01 0.02 0.13 0.03 0.17"),
    link("fore", 1.5, xyz="0 0.1 0.4", rpy="0.3 -0.2 0.7", tensor="0.05 0 0 0.06 0 0.02"),
    link("slider", 0.7, xyz="-0.1 0 0.05", rpy="0 0.4 0", tensor="0.004 0.001 0 0.006 0 0.005"),
    link("tool", 0.2, xyz="0.02 0.01 0.03", tensor="0.0001 0 0 0.0002 0 0.0002"),
    joint(
        "z_shoulder", "base", "upper", "continuous",
        '<origin xyz="0 0.1 0.5" rpy="0.4 0.3 -1.1"/><axis xyz="0 0.6 0.8"/>',
    ),
    joint(
        "y_elbow", "upper", "fore", "revolute",
        '<origin xyz="0.3 0 0.1" rpy="1.2 0 0.5"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="2" effort="30" velocity="3"/><dynamics damping="0.5" friction="0.25"/>',
    ),
    joint(
        "a_slide", "upper", "slider", "prismatic",
        '<origin xyz="-0.2 0.1 0" rpy="0 0.2 0"/><axis xyz="1 0 0"/>'
        '<limit lower="-0.3" upper="0.4" effort="30" velocity="1"/>',
    ),
    joint("flange", "fore", "tool", "fixed", '<origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/>'),
)  # fmt: skip
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
