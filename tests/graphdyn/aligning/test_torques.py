"""Differences of torque where torques vanish."""

from dataclasses import replace

import numpy as np
import pytest
from robots.disguised import disguised

from graphdyn import Body, Joint, JointLimits, Placement, RobotModel
from graphdyn.aligning import differences


@pytest.fixture
def planar():
    """Three vertical axes: weight gives no torque but rounding."""
    limits = JointLimits(-1, 1, 1, 10)
    places = [Placement(np.eye(3), [length, 0, 0.1]) for length in (0, 0.5, 0.4)]
    joints = [Joint(f"j{k}", "revolute", k, place, [0, 0, 1], limits) for k, place in enumerate(places)]
    bodies = [Body(f"b{k}", 1 + k, [0.2, 0.03, 0.05], np.diag([2, 3, 4]) * 1e-2) for k in range(3)]
    return RobotModel("planar", tuple(bodies), tuple(joints))


def test_rounding_of_torques_that_are_zero_does_not_count(planar):
    again = disguised(planar, np.random.default_rng(0), ("base", "frames"))[0]
    found = differences(planar, again, samples=10)
    gravity = [each.difference for each in found.torques if each.term == "gravity"]
    assert any(gravity), "rounding should leave something"
    assert found.verdict == "same model"


def test_a_heavier_link_counts_in_motion_and_not_in_weight(planar):
    heavier = replace(planar, bodies=(*planar.bodies[:2], replace(planar.bodies[2], mass=3.01)))
    found = differences(planar, heavier, samples=10)
    assert found.verdict == "same kinematics only"
    assert {each.term for each in found.torques if each.counts} == {"inertia", "velocity"}
