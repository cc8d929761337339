"""A recursion in spatial vectors of the world, about its origin, for these tests alone.

Featherstone, "Rigid Body Dynamics Algorithms", 2008, table 5.1 in the coordinates of the base: no frame changes, and
other sums than a recursion in link axes.
"""

import numpy as np
from scipy.spatial.transform import Rotation


def world_axes_rnea(model):
    """(q, v, a) → τ of a robot that does not move its base."""

    def rnea(q, v, a):
        places = [(model.base.rotation, model.base.translation)]
        rates, accelerations = [np.zeros(6)], [np.concatenate([np.zeros(3), -model.gravity])]
        axes, wrenches = [], []
        for joint, body, q_j, v_j, a_j in zip(model.joints, model.bodies, q, v, a, strict=True):
            rotation, origin = places[joint.inside]
            origin = origin + rotation @ joint.placement.translation
            rotation = rotation @ joint.placement.rotation
            p = rotation @ joint.axis
            if joint.is_prismatic:
                origin, axis = origin + p * q_j, np.concatenate([np.zeros(3), p])
            else:
                rotation = rotation @ Rotation.from_rotvec(q_j * joint.axis).as_matrix()
                axis = np.concatenate([p, np.cross(origin, p)])
            rate = rates[joint.inside] + axis * v_j
            acceleration = accelerations[joint.inside] + axis * a_j + crossed(rate, axis) * v_j
            inertia = spatial_inertia(body, rotation, origin)
            wrenches.append(inertia @ acceleration + crossed_force(rate, inertia @ rate))
            places.append((rotation, origin))
            rates.append(rate)
            accelerations.append(acceleration)
            axes.append(axis)
        tau = np.zeros(len(q))
        for j in reversed(range(len(q))):
            tau[j] = axes[j] @ wrenches[j]
            if (inside := model.joints[j].inside) > 0:
                wrenches[inside - 1] = wrenches[inside - 1] + wrenches[j]
        return tau

    return rnea


def spatial_inertia(body, rotation, origin):
    c = origin + rotation @ body.center_of_mass
    across = np.array([[0, -c[2], c[1]], [c[2], 0, -c[0]], [-c[1], c[0], 0]])
    about_origin = rotation @ body.inertia @ rotation.T - body.mass * across @ across
    return np.block([[about_origin, body.mass * across], [-body.mass * across, body.mass * np.eye(3)]])


def crossed(x, y):
    """Of two motions, ω first."""
    return np.concatenate([np.cross(x[:3], y[:3]), np.cross(x[:3], y[3:]) + np.cross(x[3:], y[:3])])


def crossed_force(x, y):
    """Of a motion and a wrench, moment first."""
    return np.concatenate([np.cross(x[:3], y[:3]) + np.cross(x[3:], y[3:]), np.cross(x[:3], y[3:])])
