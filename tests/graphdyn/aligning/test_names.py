"""Joints of two robots that have the same name, written in two ways."""

import pytest

from graphdyn.aligning import same_names


@pytest.mark.parametrize(
    ("first", "second", "numbers"),
    [
        (["pan_joint", "lift_joint"], ["lift_joint", "pan_joint"], [(0, 1), (1, 0)]),  # letter for letter
        (["pan_joint", "lift_joint"], ["rail", "Lift", "arm-pan"], [(1, 1)]),  # capitals and the word joint
        (["shoulder_pan_joint", "elbow_joint"], ["ur/shoulder-pan", "ur/elbow"], [(0, 0), (1, 1)]),  # a word of all
        (["joint_1", "joint_2"], ["J02", "J01"], [(0, 1), (1, 0)]),
        (["j1", "j2"], ["axis_2", "axis_3"], [(1, 0)]),  # one counts from 1, the other from 2
        (["j1", "j2"], ["finger1", "panda_joint1", "panda_joint2"], []),  # 1 is a word of two
        (["a_1", "a-1"], ["a_1", "b"], [(0, 0)]),  # the strictest way
        (["a_1", "a-1"], ["A1", "b"], []),  # each of two might be meant
        (["joint"], ["joint_joint"], []),  # no word left
        (["a"], ["b"], []),
    ],
)
def test_joints_of_the_same_name(first, second, numbers):
    assert same_names(first, second) == {first[one]: second[other] for one, other in numbers}
