"""What only the rounding of angles shows is named beside it."""

import numpy as np
import pytest
from inspected.sample import changed

import urdf
from urdf.inspection.rules import rounding_rules


def told(roll, **reading):
    """Lines and messages about the angle that turns the axis of the elbow along that of the shoulder."""
    text = changed('xyz="0.3 0 0" rpy="0 0 0"', f'xyz="0.3 0 0" rpy="{roll} 0 0"')
    found = [each for each in urdf.inspect(text, **reading).findings if each.code == "rpy-truncated"]
    return [(each.severity, each.element, each.line, each.message) for each in found]


def test_a_link_behind_parallel_axes():
    """It turns about its y axis alone, so that no product of inertia with y acts on a joint."""
    of_angle, of_robot = told("1.5708")
    assert of_angle[1] == "<origin> of joint 'elbow'"
    assert of_robot == (
        "note",
        None,
        26,
        "by the rounding of angles alone torques show 'fore I_xy', 'fore I_yz'; graphdyn identify leaves them "
        "out as nearly undetermined",
    )


@pytest.mark.parametrize("roll", [np.pi / 2, 1.56])
def test_exact_and_other_angles(roll):
    assert told(roll) == []


def test_a_repaired_angle():
    assert told("1.5708", repair=["angles"]) == []


def test_robots_with_many_bodies(monkeypatch):
    monkeypatch.setattr(rounding_rules, "MAX_ROUNDED_BODIES", 1)
    assert len(told("1.5708")) == 1
