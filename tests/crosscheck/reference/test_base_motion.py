"""A robot on a moving base against Pinocchio with a free joint in front, whose motion is imposed."""

import numpy as np
import pytest
from planting import mixed_tree
from random_trees import random_rotation, random_tree

import urdf
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.pinocchio_model.moving_base import carried
from graphdyn import BaseMotion, forward_dynamics, inverse_dynamics, kr500, mass_matrix

AGREEMENT = 1e-13
"""Of torques and wrenches, on the scale of the wrenches: two recursions; measured 9e-16."""

ACCELERATION = 1e-13
"""Relative, times the condition number of M; measured 2e-15 altogether."""

ROBOTS = {
    "kr500": kr500,
    "ur5": lambda: urdf.load("ur5"),
    "kinova": lambda: urdf.load("kinova"),
    "mixed": mixed_tree,
    "star": lambda: random_tree(3, [0, 0, 1, 2, 2], ["revolute", "prismatic", "revolute", "continuous", "revolute"]),
}
SAMPLES = 20


@pytest.mark.parametrize("name", ROBOTS)
def test_carried_robot(name):
    model, rng = ROBOTS[name](), np.random.default_rng(0)
    q, v = model.random_state(rng, SAMPLES)
    a, tau = rng.normal(size=q.shape), 100 * rng.normal(size=q.shape)
    motion = BaseMotion(
        np.stack([random_rotation(rng) for _ in range(SAMPLES)]),
        rng.normal(size=(SAMPLES, 3)),
        *rng.normal(size=(2, SAMPLES, 6)),
    )
    there = carried(PinocchioModel.from_model(model), q, v, a, tau, motion)
    scale = np.abs(there.joint_wrenches).max()
    for method in ("projected", "dense"):
        inverse = inverse_dynamics(model, q, v, a, base=motion, method=method)
        assert np.abs(inverse.tau - there.tau).max() <= AGREEMENT * scale
        assert np.abs(inverse.joint_wrenches - there.joint_wrenches).max() <= AGREEMENT * scale
        forward = forward_dynamics(model, q, v, tau, base=motion, method=method)
        condition = np.linalg.cond(mass_matrix(model, q)).max()
        assert np.abs(forward.a - there.a).max() <= ACCELERATION * condition * np.abs(there.a).max()


def test_one_motion_for_all_states():
    model = ROBOTS["ur5"]()
    q = model.random_state(np.random.default_rng(1), 3)[0]
    motion = BaseMotion(acceleration=[2.0, 0, 0, 0, 0, 0])
    there = carried(PinocchioModel.from_model(model), q, 0 * q, 0 * q, 0 * q, motion)
    here = inverse_dynamics(model, q, 0 * q, 0 * q, base=motion)
    assert np.abs(here.joint_wrenches - there.joint_wrenches).max() <= AGREEMENT * np.abs(there.joint_wrenches).max()
