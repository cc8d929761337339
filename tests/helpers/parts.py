"""The parts of the smallest robots: a point mass, a solid, a hinge."""

import dataclasses

import numpy as np

from graphdyn import Body, Joint, Placement

POINT = Body("point", 2.0, np.zeros(3), np.zeros((3, 3)))
SOLID = Body("solid", 2.0, np.zeros(3), np.eye(3))


def hinge(name="hinge", inside=0, **changes):
    return dataclasses.replace(Joint(name, "revolute", inside, Placement(), [0, 0, 1.0]), **changes)
