"""Robots for the tests: any tree, any axes and placements, bodies made of point masses (so that they can exist)."""

import numpy as np
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from graphdyn import BaseMotion, Body, Joint, Placement, RobotModel, kr500

MAX_BODIES = 8
KINDS = ("revolute", "prismatic")


def random_rotation(rng):
    return Rotation.from_rotvec(rng.normal(size=3)).as_matrix()


def random_placement(rng):
    return Placement(random_rotation(rng), rng.uniform(-0.6, 0.6, 3))


def random_axis(rng):
    """Half of the axes are coordinate axes, as in most robots; the others point anywhere."""
    if rng.random() < 0.5:
        return rng.choice([-1.0, 1.0]) * np.eye(3)[rng.integers(3)]
    direction = rng.normal(size=3)
    return direction / np.linalg.norm(direction)


def body_of_points(name, masses, points):
    """The rigid body that these point masses form; points (k, 3) in the link frame."""
    masses, points = np.asarray(masses, dtype=float), np.asarray(points, dtype=float)
    mass = masses.sum()
    center = masses @ points / mass
    arms = points - center
    inertia = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, arms, strict=True))
    return Body(name, mass, center, inertia)


def random_body(rng, name):
    points = rng.uniform(-0.4, 0.4, 3) + rng.uniform(-0.3, 0.3, (6, 3))
    return body_of_points(name, rng.uniform(0.2, 3.0, 6), points)


def random_tree(seed, inside, kinds):
    """A robot of this topology with everything else drawn at random, gravity and base included."""
    rng = np.random.default_rng(seed)
    bodies = [random_body(rng, f"body{i}") for i in range(1, len(inside) + 1)]
    joints = [
        Joint(f"joint{j}", kind, i, random_placement(rng), random_axis(rng))
        for j, (i, kind) in enumerate(zip(inside, kinds, strict=True), start=1)
    ]
    return RobotModel(
        f"tree{seed}", tuple(bodies), tuple(joints), gravity=rng.uniform(-10, 10, 3), base=random_placement(rng)
    )


def random_state(model, seed, size=()):
    """q, v, a or tau: joint coordinates of a few units, velocities up to 2, accelerations up to 5."""
    rng = np.random.default_rng(seed)
    shape = (*size, model.n_bodies)
    return rng.uniform(-3, 3, shape), rng.uniform(-2, 2, shape), rng.uniform(-5, 5, shape)


def random_wrenches(model, seed, size=()):
    return np.random.default_rng(seed).uniform(-10, 10, (*size, model.n_bodies, 6))


def random_base_motion(seed, size=()):
    """A moving base anywhere that moves and turns."""
    rng = np.random.default_rng(seed)
    rotation = Rotation.from_rotvec(rng.normal(size=(int(np.prod(size)), 3))).as_matrix().reshape(*size, 3, 3)
    translation, velocity, acceleration = (rng.normal(size=(*size, width)) for width in (3, 6, 6))
    return BaseMotion(rotation, translation, velocity, acceleration)


@st.composite
def topologies(draw, max_bodies=MAX_BODIES):
    """inside bodies and kinds of the joints of a tree; the ground may carry several roots."""
    n = draw(st.integers(1, max_bodies))
    inside = [draw(st.integers(0, j)) for j in range(n)]
    return inside, [draw(st.sampled_from(KINDS)) for _ in range(n)]


SEEDS = st.integers(0, 2**32 - 1)


@st.composite
def robots(draw, max_bodies=MAX_BODIES):
    return random_tree(draw(SEEDS), *draw(topologies(max_bodies)))


NAMED = {
    "kr500": kr500(),
    "one_revolute": random_tree(1, [0], ["revolute"]),
    "one_prismatic": random_tree(2, [0], ["prismatic"]),
    "revolute_chain": random_tree(3, [0, 1, 2, 3], ["revolute"] * 4),
    "mixed_chain": random_tree(4, [0, 1, 2, 3], ["revolute", "prismatic", "revolute", "revolute"]),
    "prismatic_inside_and_out": random_tree(5, [0, 1, 2], ["prismatic", "revolute", "prismatic"]),
    "branched": random_tree(6, [0, 1, 1, 3, 0, 3], ["revolute", "prismatic", "revolute"] * 2),
}
"""The robots that every law and every Jacobian is checked on, by name."""
