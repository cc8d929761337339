"""Small robots whose motion is known in closed form, and the reference of a large one."""

import json

import numpy as np
from shared_data import DATA, existing

from graphdyn import Body, Joint, JointLimits, Placement, RobotModel

G = 9.81


def pendulum(length=0.7, mass=1.3, damping=0.0, friction=0.0):
    """A point mass on a rod, hanging at q = 0."""
    body = Body("bob", mass, [0.0, 0.0, -length], np.zeros((3, 3)))
    joint = Joint("swing", "continuous", 0, Placement(), [0.0, 1.0, 0.0], damping=damping, friction=friction)
    return RobotModel("pendulum", (body,), (joint,), gravity=[0.0, 0.0, -G])


def slider(direction=(1.0, 0.0, 0.0), mass=2.0, limits=None, friction=0.0):
    """A mass on a rail."""
    body = Body("carriage", mass, np.zeros(3), np.eye(3))
    joint = Joint("rail", "prismatic", 0, Placement(), direction, limits or JointLimits(), friction=friction)
    return RobotModel("slider", (body,), (joint,), gravity=[0.0, 0.0, -G])


def swing():
    """The reference for graphdyn.kr500() without torque: q0, v0, and the state (12,) after 1 s and 2 s."""
    path = existing(DATA / "loops" / "references.json")
    reference = json.loads(path.read_text(encoding="utf-8"))["kr500_swing"]
    after = {seconds: np.array(reference[str(seconds)]) for seconds in (1, 2)}
    return np.array(reference["q0"]), np.array(reference["v0"]), after
