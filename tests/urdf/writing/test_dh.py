"""Robots as tables of Denavit-Hartenberg parameters: read again they are the same; what a table cannot hold."""

import dataclasses
import math

import numpy as np
import pytest
from shared_data import DATA, existing

import urdf
from graphdyn import Placement, frame_placement, inverse_dynamics
from graphdyn.model import rotation_about

SAME_ROBOT = 1e-12
"""Relative to reach and torque."""


def check_same(model, path, convention):
    """Flange and torques of the file at 50 states are those of the model."""
    urdf.save_dh(model, path, convention)
    table, other = urdf.dh_table(model, convention), urdf.load(path)
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-3, 3, (50, model.nv)), *rng.normal(size=(2, 50, model.nv))
    name = table.tool_name if table.tool_name in {frame.name for frame in model.frames} else model.bodies[-1].name
    (turn, here), (turned, there) = frame_placement(model, q, name), frame_placement(other, q, table.tool_name)
    np.testing.assert_allclose(there, here, atol=SAME_ROBOT * np.abs(here).max())
    np.testing.assert_allclose(turned, turn, atol=SAME_ROBOT)
    tau = inverse_dynamics(model, q, v, a).tau
    np.testing.assert_allclose(inverse_dynamics(other, q, v, a).tau, tau, atol=SAME_ROBOT * np.abs(tau).max())
    for joint, again in zip(model.joints, other.joints, strict=True):
        kept = ("name", "limits", "damping", "friction", "armature")
        assert [getattr(again, name) for name in kept] == [getattr(joint, name) for name in kept]


@pytest.mark.parametrize("convention", urdf.CONVENTIONS)
@pytest.mark.parametrize("name", ["ur5", "kinova", "kr500", "z1"])
def test_read_again_it_is_the_same(name, convention, tmp_path):
    check_same(urdf.load(name), tmp_path / "arm.toml", convention)


@pytest.mark.filterwarnings("ignore::urdf.MissingInertialWarning")
@pytest.mark.parametrize("name", ["kr210_r2700_2.urdf", "gp8l.urdf"])
def test_vendor_arms(name, tmp_path):
    path = existing(DATA / "urdf" / "arms" / name)
    check_same(urdf.load(path), tmp_path / "arm.toml", "modified")


@pytest.mark.parametrize("angle", [0.0, 1e-15, 1e-9, 1e-5, 0.005, math.pi - 1e-6, math.pi])
def test_axes_that_are_nearly_parallel_have_no_far_normal(angle, tmp_path):
    model = urdf.load("ur5")
    joint = model.joints[2]
    tilted = Placement(rotation_about([0.6, 0.0, 0.8], angle) @ joint.placement.rotation, joint.placement.translation)
    joints = (*model.joints[:2], dataclasses.replace(joint, placement=tilted), *model.joints[3:])
    model = dataclasses.replace(model, joints=joints)
    check_same(model, tmp_path / "arm.toml", "standard")
    table = urdf.dh_table(model)
    assert all(abs(row.d) < 1 and abs(row.a) < 1 for row in table.rows)
    assert any("axes 2 and 3" in choice for choice in table.choices)


def test_a_normal_may_be_asked_for():
    model = urdf.load("ur5")
    joint = model.joints[2]
    tilted = Placement(rotation_about([1.0, 0.0, 0.0], 0.005) @ joint.placement.rotation, joint.placement.translation)
    joints = (*model.joints[:2], dataclasses.replace(joint, placement=tilted), *model.joints[3:])
    far = urdf.dh_table(dataclasses.replace(model, joints=joints), parallel_within=1e-6)
    assert max(abs(row.d) for row in far.rows) > 10
    assert not any(row.beta for row in far.rows)


def test_what_a_table_cannot_hold():
    with pytest.raises(urdf.CannotSave, match="the robot is no chain of joints; give a chain"):
        urdf.dh_table(urdf.load("panda"))
    with pytest.raises(urdf.CannotSave, match="it has 'ee_link', 'tool0'"):
        urdf.dh_table(urdf.load("ur5"), tool="wrist")
    with pytest.raises(ValueError, match="there is no convention 'classic'; use standard or modified"):
        urdf.dh_table(urdf.load("ur5"), "classic")


def test_a_table_is_not_edited_in_place(tmp_path):
    model, path = urdf.load("ur5"), tmp_path / "ur5.toml"
    urdf.save_dh(model, path)
    for change in (
        lambda: urdf.update(path, tmp_path / "new.urdf", model.inertial_parameters),
        lambda: urdf.repair(path, tmp_path / "new.urdf", ["limits-crossed"]),
    ):
        with pytest.raises(urdf.CannotUpdate, match="is a table of Denavit-Hartenberg parameters, not URDF; "):
            change()
