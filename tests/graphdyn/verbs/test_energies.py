"""graphdyn.power: what the actuators, the loads and the base supply is what the energies gain."""

import numpy as np
import pytest
from random_trees import NAMED, random_state, random_wrenches
from scipy.spatial.transform import Rotation
from witnesses import derivative, origins, relative_error, twists_at_origins, world_wrenches

import graphdyn
from graphdyn import BaseMotion

DIFFERENCE = 1e-11
"""Sixth-order central differences of the energy, relative to the largest term: measured 3e-13."""

ROBOTS = ["kr500", "mixed_chain", "branched"]
"""With turning and sliding joints, in a chain and with branches, two of them on the ground."""

VELOCITY, ACCELERATION = np.array([0.1, 0.2, -0.3, 0.5, -0.4, 0.3]), np.array([1.0, -2.0, 0.5, 0.3, 0.2, -0.7])

methods = pytest.mark.parametrize("method", ["dense", "projected", "recursive"])


def base_at(t, speed):
    """A moving base on its way, at rest with speed 0."""
    velocity, acceleration = speed * VELOCITY, speed * ACCELERATION
    way = velocity * t + acceleration * t**2 / 2
    rotation = Rotation.from_rotvec(way[3:]).as_matrix()
    return BaseMotion(rotation, way[:3], velocity + acceleration * t, acceleration)


@pytest.mark.parametrize("model", [NAMED[name] for name in ROBOTS], ids=ROBOTS)
@methods
@pytest.mark.parametrize("speed", [0.0, 1.0], ids=["base at rest", "base that moves"])
def test_balance(model, method, speed):
    q, v, a = random_state(model, 1)
    loads, base = random_wrenches(model, 2), base_at(0.0, speed)

    def energy(t):
        there, rate, carried = q + v * t + a * t**2 / 2, v + a * t, base_at(t, speed)
        kinetic = graphdyn.kinetic_energy(model, there, rate, base=carried)
        return kinetic + graphdyn.potential_energy(model, there, base=carried)

    state = graphdyn.maximal_state(model, q, v, base=base)
    of_joints = graphdyn.power(model, q, v, a, loads, base=base, method=method)
    of_loads = np.sum(loads * twists_at_origins(state), axis=-1)
    reactions = world_wrenches(state, graphdyn.inverse_dynamics(model, q, v, a, loads, base=base).joint_wrenches)
    on_ground = np.array([joint.inside == 0 for joint in model.joints])
    linear, omega = base.velocity[:3], base.velocity[3:]
    carried = np.concatenate([linear + np.cross(omega, origins(state)), omega + 0 * origins(state)], axis=-1)
    of_base = np.sum(reactions * carried, axis=-1) * on_ground
    supplied = of_joints.sum() + of_loads.sum() + of_base.sum()
    assert relative_error(derivative(energy), supplied, energy(0.0), of_joints, of_loads, of_base) < DIFFERENCE


@methods
def test_one_link(method):
    """A mass m that slides upwards: P = m (g + a) v."""
    slide = graphdyn.Joint("slide", "prismatic", 0, graphdyn.Placement(), [0, 0, 1])
    model = graphdyn.RobotModel(
        "lift", (graphdyn.Body("cage", 3.0, np.zeros(3), np.eye(3)),), (slide,), gravity=[0, 0, -9.81]
    )
    assert graphdyn.power(model, [0.4], [2.0], [1.5], method=method) == pytest.approx([3.0 * (9.81 + 1.5) * 2.0])
