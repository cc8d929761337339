"""lock=: joints held still become fixed joints."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import graphdyn
import urdf


def test_locked_joint_is_fused_at_its_value(arm):
    path = arm()
    free = urdf.load(path)
    locked = urdf.load(path, lock={"slide": 0.25})
    assert locked.joint_names == ("shoulder",)
    assert locked.frame("slide").name == "fore"
    assert [frame.name for frame in locked.frames] == ["fore", "tool"]
    expected = graphdyn.mass_matrix(free, [0.4, 0.25])[0, 0]
    assert_allclose(graphdyn.mass_matrix(locked, [0.4])[0, 0], expected, rtol=1e-14)
    for name in ("fore", "tool"):
        for got, wanted in zip(
            graphdyn.frame_placement(locked, [0.4], name),
            graphdyn.frame_placement(free, [0.4, 0.25], name),
            strict=True,
        ):
            assert_allclose(got, wanted, rtol=0, atol=1e-15)


def test_locked_revolute_joint_at_the_base(arm):
    path = arm('<axis xyz="0 0 1"/>', '<axis xyz="0.6 0 0.8"/>')
    free, locked = urdf.load(path), urdf.load(path, lock={"shoulder": -0.7})
    assert_allclose(
        graphdyn.bias_torque(locked, [0.3], [0.0])[0],
        graphdyn.bias_torque(free, [-0.7, 0.3], [0.0, 0.0])[1],
        rtol=1e-13,
    )
    assert locked.frame("upper").body == 0


def test_locked_joint_with_an_axis_not_of_unit_length(arm):
    path = arm('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>')
    with pytest.warns(urdf.AxisNotNormalizedWarning, match=r"joint 'slide' \(2\)"):
        model = urdf.load(path, lock={"slide": 0.25})
    assert_allclose(model.frame("slide").placement.translation, [0.3, 0.25, 0], rtol=1e-15)


@pytest.mark.parametrize("lock", [["slide"], ("slide",), {"slide"}, {"slide": 0}, {"slide": np.float32(0)}])
def test_names_lock_at_zero(arm, lock):
    model = urdf.load(arm(), lock=lock)
    assert_allclose(model.frame("fore").placement.translation, [0.3, 0, 0])


@pytest.mark.parametrize("name", ["elbow", "flange"])
def test_unknown_and_fixed_joints_are_refused(arm, name):
    with pytest.raises(
        urdf.InvalidLock,
        match=rf"arm.urdf: cannot lock '{name}': the robot has no such movable joint; known: shoulder, slide",
    ):
        urdf.load(arm(), lock=[name])


@pytest.mark.parametrize("value", [float("nan"), float("inf"), None, "0.1"])
def test_lock_values_are_finite_numbers(arm, value):
    with pytest.raises(urdf.InvalidLock, match=r"cannot lock 'slide' at .*; give a finite number in rad"):
        urdf.load(arm(), lock={"slide": value})


def test_a_single_string_is_refused(arm):
    with pytest.raises(urdf.InvalidLock, match=r"lock is the string 'slide'; give a list of joint names: \['slide'\]"):
        urdf.load(arm(), lock="slide")


def test_locking_everything_is_refused(arm):
    with pytest.raises(urdf.InvalidRobot, match=r"no moving body: every joint is fixed or locked; leave a joint free"):
        urdf.load(arm(), lock=["shoulder", "slide"])
