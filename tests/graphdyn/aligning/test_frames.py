"""Named frames that two robots share."""

from dataclasses import replace

import pytest
from robots.ur5e_like import ur5e_like

from graphdyn import Frame, Placement
from graphdyn.aligning import differences
from graphdyn.model import rotation_about


def flanged(*frames):
    return replace(ur5e_like(), frames=frames)


def flange(height=0.1, angle=0.0, body=6):
    return Frame("flange", body, Placement(rotation_about([0, 0, 1], angle), [0, 0, height]))


def test_a_longer_and_turned_flange_is_told():
    found = differences(flanged(flange()), flanged(flange(0.101, 0.2)), samples=10)
    (told,) = found.frames
    assert (told.name, told.link) == ("flange", "wrist_3_link")
    assert told.distance == pytest.approx(1e-3)
    assert told.angle == pytest.approx(0.2)
    assert found.verdict == "equal in all joint torques"


def test_a_flange_of_other_link_frames_is_the_same():
    """Its joint placed 0.3 m along the last axis, and turned about it; zero, inertia and flange go with it."""
    arm = flanged(flange())
    turn = Placement(rotation_about([0, 0, 1], 0.5), [0, 0, 0.3])
    last, body = arm.joints[-1], arm.bodies[-1]
    rotation = turn.rotation
    moved = replace(
        body,
        center_of_mass=rotation.T @ (body.center_of_mass - turn.translation),
        inertia=rotation.T @ body.inertia @ rotation,
    )
    again = replace(
        arm,
        joints=(*arm.joints[:-1], replace(last, placement=last.placement @ turn)),
        bodies=(*arm.bodies[:-1], moved),
        frames=(Frame("flange", 6, turn.inverse() @ arm.frames[0].placement),),
    )
    assert differences(arm, again, samples=10).verdict == "same model"


def test_frames_of_one_robot_alone_or_of_other_links_are_not_compared():
    other = flanged(flange(body=5), Frame("camera", 6, Placement()))
    assert differences(flanged(flange()), other, samples=10).frames == ()
