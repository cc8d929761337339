"""Pinocchio: rnea, crba, aba of the file as buildModelFromUrdf reads it."""

import numpy as np
import pinocchio
from robot_file import edited

PACKAGE = "pin"
CAUSES = ()


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge."""
    model = pinocchio.buildModelFromUrdf(edited(file))
    model.gravity.linear = gravity
    data = model.createData()

    def configuration(q):
        """A continuous joint is cos q, sin q."""
        pairs = [[np.cos(x), np.sin(x)] if joint.nq == 2 else [x] for joint, x in zip(model.joints[1:], q, strict=True)]
        return np.concatenate(pairs)

    def mass_matrix(q):
        upper = np.triu(pinocchio.crba(model, data, configuration(q)))
        return upper + np.triu(upper, 1).T

    return {
        "joint_names": list(model.names)[1:],
        "inverse_dynamics": lambda q, v, a: pinocchio.rnea(model, data, configuration(q), v, a).copy(),
        "forward_dynamics": lambda q, v, tau: pinocchio.aba(model, data, configuration(q), v, tau).copy(),
        "mass_matrix": mass_matrix,
    }
