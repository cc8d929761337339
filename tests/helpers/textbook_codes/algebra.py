"""Vectors and rotations as people write them for a robot, for real and complex angles."""

import numpy as np


def cross(a, b):
    """a × b of two vectors (3,)."""
    (a1, a2, a3), (b1, b2, b3) = a, b
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def hat(x):
    """The matrix of x ×."""
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def turn(axis, angle):
    """Rodrigues' formula for a unit axis."""
    p = hat(axis)
    return np.eye(3) + np.sin(angle) * p + (1 - np.cos(angle)) * p @ p


def gradient(f, x):
    """∂f/∂x by complex steps, along the last axis."""
    step = 1e-30
    return np.stack([np.imag(f(x + 1j * step * e)) / step for e in np.eye(len(x))], axis=-1)
