"""Faults planted in the textbook recursion: by kind, functions of (arm, model) that give a faulty inverse dynamics."""

import numpy as np
from scipy.spatial.transform import Rotation

LOCKED = {"wrist_2_joint": 0.0, "wrist_3_joint": 0.0}
"""Four joints of the ur5 show all kinds of faults, in half of the time that six take."""

WRIST_LOCKED = {f"wrist_{k}_joint": 0.0 for k in (1, 2, 3)}
"""Three joints, for what has no name: everything of the catalog is tried on it."""


def outer(center):
    """c·c E - c cᵀ, per body (n, 3, 3)."""
    return np.einsum("ia,ia,bc->ibc", center, center, np.eye(3)) - np.einsum("ia,ib->iab", center, center)


def point_terms(arm):
    return arm.masses[:, None, None] * outer(arm.centers)


def at(k, value, others, n):
    return np.where(np.arange(n) == k, value, others)


def one(arm, field, k, change):
    """The arm with entry k of one of its arrays changed."""
    array = np.array(getattr(arm, field))
    array[k] = change(array[k])
    return arm.but(**{field: array})


def shuffled(f, order):
    """A code whose joint k is our joint order[k]."""
    back = np.argsort(order)
    return lambda q, v, a: f(q[back], v[back], a[back])[order]


def transposed(x):
    return np.swapaxes(x, -1, -2)


def opposite_rpy(rotation):
    return Rotation.from_euler("XYZ", Rotation.from_matrix(rotation).as_euler("xyz")).as_matrix()


SIGNS = {
    "axis of joint 3": lambda arm, _: one(arm, "axes", 2, np.negative).inverse_dynamics,
    "torque of joint 2": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q, v, a) * at(1, -1, 1, len(q)),
    "all torques": lambda arm, _: lambda q, v, a: -arm.inverse_dynamics(q, v, a),
    "products of inertia": lambda arm, _: (
        arm.but(tensors=2 * np.einsum("iaa,ab->iab", arm.tensors, np.eye(3)) - arm.tensors).inverse_dynamics
    ),
    "center of mass of body 2": lambda arm, _: one(arm, "centers", 1, np.negative).inverse_dynamics,
}

PLANTS = {
    "gravity": {
        "reversed": lambda arm, _: arm.but(gravity=-arm.gravity).inverse_dynamics,
        "left out": lambda arm, _: arm.but(gravity=0 * arm.gravity).inverse_dynamics,
        "9.7": lambda arm, _: arm.but(gravity=9.7 / np.linalg.norm(arm.gravity) * arm.gravity).inverse_dynamics,
        "along y": lambda arm, _: arm.but(gravity=np.roll(arm.gravity, -1)).inverse_dynamics,
    },
    "coriolis": {
        "wrong sign of ω × q̇ p": lambda arm, _: arm.but(cross=-1.0).inverse_dynamics,
        "no ω × I ω": lambda arm, _: arm.but(gyroscopic=0.0).inverse_dynamics,
        "no ω × (ω × r)": lambda arm, _: arm.but(centripetal=0.0).inverse_dynamics,
        "none at all": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q, 0 * v, a),
        "doubled": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q, np.sqrt(2) * v, a),
    },
    "sign": SIGNS,
    "joint_order": {
        "2 and 3 exchanged": lambda arm, _: shuffled(arm.inverse_dynamics, [0, 2, 1, *range(3, len(arm.masses))]),
        "reversed": lambda arm, _: shuffled(arm.inverse_dynamics, [5, 4, 3, 2, 1, 0]),
        "any": lambda arm, _: shuffled(arm.inverse_dynamics, [3, 0, 5, 1, 4, 2]),
        "torques not": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q[::-1], v[::-1], a[::-1]),
    },
    "frame": {
        "rotation of joint 2 transposed": lambda arm, _: one(arm, "rotations", 1, transposed).inverse_dynamics,
        "rotations transposed": lambda arm, _: arm.but(rotations=transposed(arm.rotations)).inverse_dynamics,
        "rpy in the opposite order": lambda arm, _: (
            arm.but(rotations=np.stack([opposite_rpy(r) for r in arm.rotations])).inverse_dynamics
        ),
        "translations in joint axes": lambda arm, _: (
            arm.but(translations=np.einsum("iab,ib->ia", arm.rotations, arm.translations)).inverse_dynamics
        ),
        "axis of joint 2 in the inside body's axes": lambda arm, _: (
            one(arm, "axes", 1, lambda p: arm.rotations[1].T @ p).inverse_dynamics
        ),
    },
    "inertia_point": {
        "about the origin, taken about the center": lambda arm, _: (
            arm.but(tensors=arm.tensors + point_terms(arm)).inverse_dynamics
        ),
        "about the center, taken about the origin": lambda arm, _: (
            arm.but(tensors=arm.tensors - point_terms(arm)).inverse_dynamics
        ),
        "of body 3 alone": lambda arm, _: (
            one(arm, "tensors", 2, lambda tensor: tensor + point_terms(arm)[2]).inverse_dynamics
        ),
    },
    "unit": {
        "degrees": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(*np.deg2rad([q, v, a])),
        "positions in degrees": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(np.deg2rad(q), v, a),
        "torques in kN m": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q, v, a) / 1000,
        "tensors in kg mm²": lambda arm, _: arm.but(tensors=1e6 * arm.tensors).inverse_dynamics,
        "centers of mass in mm": lambda arm, _: arm.but(centers=1e3 * arm.centers).inverse_dynamics,
        "translations in mm": lambda arm, _: arm.but(translations=1e3 * arm.translations).inverse_dynamics,
    },
    "continuous_joint": {
        "cosine": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(np.cos(q), v, a),
        "cut off at π": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(np.clip(q, -np.pi, np.pi), v, a),
        "sine and cosine exchanged at joint 4": lambda arm, _: (
            lambda q, v, a: arm.inverse_dynamics(np.where(np.arange(len(q)) == 3, np.pi / 2 - q, q), v, a)
        ),
    },
    "friction": {
        "viscous": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q, v, a) + 3.0 * v,
        "dry": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q, v, a) + 2.0 * np.sign(v),
        "both": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q, v, a) + 3.0 * v + 2.0 * np.sign(v),
    },
    "rotor_inertia": {
        "drives": lambda arm, _: lambda q, v, a: arm.inverse_dynamics(q, v, a) + np.arange(1, len(q) + 1) * a,
    },
    "inertial_parameters": {
        "body 2 heavier": lambda arm, _: one(arm, "masses", 1, lambda m: 1.3 * m).inverse_dynamics,
        "bodies 2 and 3 exchanged": lambda arm, _: (
            arm.but(
                **{
                    name: getattr(arm, name)[[0, 2, 1, *range(3, len(arm.masses))]]
                    for name in ("masses", "centers", "tensors")
                }
            ).inverse_dynamics
        ),
        "no tensors": lambda arm, _: arm.but(tensors=0 * arm.tensors).inverse_dynamics,
        "no center of mass at body 3": lambda arm, _: one(arm, "centers", 2, np.zeros_like).inverse_dynamics,
    },
}
"""Kind of the diagnosis that is right → variants. Fixed links need a file and have their own tests."""

FIRST = {kind: next(iter(variants)) for kind, variants in PLANTS.items()}
