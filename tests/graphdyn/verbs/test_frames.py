"""Motion of named frames: differences of their placements, identities between the verbs, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from random_trees import NAMED, random_placement, random_state, random_wrenches
from witnesses import axial, derivative, relative_error, second_derivative

import graphdyn
from graphdyn import BaseMotion, Frame, InvalidInput, UnknownFrame

DIFFERENCE = 1e-11
"""Sixth-order central differences, relative to the largest derivative and to what is differentiated: measured 4e-13."""

SECOND_DIFFERENCE = 1e-9
"""The same of second ones: measured 3e-11."""

IDENTITY = 1e-14
"""Two sums of the same terms in another order, relative to the largest entry: measured 2e-15."""

REFERENCES = ("local", "local_world_aligned", "world")
METHODS = ("projected", "recursive")

FIXED = random_placement(np.random.default_rng(5))
MOVING = BaseMotion(
    rotation=FIXED.rotation,
    translation=FIXED.translation,
    velocity=[0.1, 0.2, -0.3, 0.5, -0.4, 0.3],
    acceleration=[1.0, -2.0, 0.5, 0.3, 0.2, -0.7],
)


def with_frames(model):
    """A frame on a body half way, and one on the ground."""
    rng = np.random.default_rng(6)
    tool = Frame("tool", (model.n_bodies + 1) // 2, random_placement(rng), aliases=("tool_joint",))
    return replace(model, frames=(tool, Frame("stand", 0, random_placement(rng))))


pytestmark = pytest.mark.usefixtures("interpreted")

ROBOTS = ["kr500", "mixed_chain", "branched"]
robots = pytest.mark.parametrize("model", [with_frames(NAMED[name]) for name in ROBOTS], ids=ROBOTS)
methods = pytest.mark.parametrize("method", METHODS)
bases = pytest.mark.parametrize("base", [None, MOVING], ids=["fixed", "moving"])
frames = pytest.mark.parametrize("frame", ["tool", "stand", "last body"])


def named(model, frame):
    return model.body_names[-1] if frame == "last body" else frame


def along(model, q, v, a, base, t):
    """Where a motion with these derivatives at t = 0 has taken joints and base after t."""
    moved = base
    if base is not None:
        spin, rate = base.velocity[3:], base.acceleration[3:]
        moved = replace(
            base,
            translation=base.translation + t * base.velocity[:3] + t * t / 2 * base.acceleration[:3],
            rotation=turned(t * spin + t * t / 2 * rate) @ base.rotation,
        )
    return q + t * v + t * t / 2 * a, moved


def turned(vector):
    """Rodrigues; by the third order in t, the ω̇ of exp(t ω + t²/2 ω̇) at t = 0 is ω̇."""
    k = np.array([[0, -vector[2], vector[1]], [vector[2], 0, -vector[0]], [-vector[1], vector[0], 0]])
    angle = np.linalg.norm(vector)
    return np.eye(3) + np.sinc(angle / np.pi) * k + np.sinc(angle / 2 / np.pi) ** 2 / 2 * k @ k


@robots
@methods
@bases
@frames
def test_velocity_and_classical_acceleration_are_derivatives_of_the_placement(model, method, base, frame):
    q, v, a = random_state(model, 3)
    name = named(model, frame)
    keywords = {"base": base, "method": method, "reference": "local_world_aligned"}
    velocity = graphdyn.frame_velocity(model, q, v, name, **keywords)
    acceleration = graphdyn.frame_acceleration(model, q, v, a, name, **keywords)

    def placement(t):
        there, moved = along(model, q, v, a, base, t)
        rotation, position = graphdyn.frame_placement(model, there, name, base=moved)
        return np.column_stack([rotation, position])

    rate, rotation = derivative(placement), placement(0.0)[:, :3]
    expected = np.array([*rate[:, 3], *axial(rate[:, :3] @ rotation.T)])
    assert relative_error(velocity, expected, placement(0.0)) < DIFFERENCE

    second = second_derivative(placement)  # R̈ Rᵀ = S(ω̇) + S(ω)², of which S(ω̇) is the skew part
    expected = np.array([*second[:, 3], *axial(second[:, :3] @ rotation.T)])
    assert relative_error(acceleration, expected, placement(0.0)) < SECOND_DIFFERENCE


@robots
@methods
@bases
@frames
@pytest.mark.parametrize("reference", REFERENCES)
def test_what_the_verbs_say_of_each_other(model, method, base, frame, reference):
    q, v, a = random_state(model, 3, (2,))
    name, keywords = named(model, frame), {"base": base, "method": method, "reference": reference}
    jacobian = graphdyn.frame_jacobian(model, q, name, **keywords)
    velocity = graphdyn.frame_velocity(model, q, v, name, **keywords)
    carried = graphdyn.frame_velocity(model, q, np.zeros_like(v), name, **keywords)
    assert relative_error((jacobian @ v[..., None])[..., 0] + carried, velocity) < IDENTITY

    classical = graphdyn.frame_acceleration(model, q, v, a, name, **keywords)
    spatial = graphdyn.frame_acceleration(model, q, v, a, name, **keywords, classical=False)
    between = np.cross(velocity[:, 3:], velocity[:, :3])
    assert relative_error(classical[:, :3] - spatial[:, :3], between, classical) < IDENTITY
    assert relative_error(classical[:, 3:], spatial[:, 3:]) < IDENTITY  # two programs: products and sums fuse otherwise

    if base is None:
        rate = graphdyn.frame_jacobian_derivative(model, q, v, name, **keywords)
        expected = classical if reference == "local_world_aligned" else spatial
        found = (jacobian @ a[..., None] + rate @ v[..., None])[..., 0]
        assert relative_error(found, expected, classical) < IDENTITY


@robots
@methods
def test_the_references_describe_one_motion(model, method):
    q, v, _ = random_state(model, 3)
    keywords = {"base": MOVING, "method": method}
    local, aligned, world = (
        graphdyn.frame_velocity(model, q, v, "tool", reference=reference, **keywords) for reference in REFERENCES
    )
    rotation, position = graphdyn.frame_placement(model, q, "tool", base=MOVING)
    assert relative_error(rotation @ local.reshape(2, 3).T, aligned.reshape(2, 3).T) < IDENTITY
    assert relative_error(world[:3] + np.cross(world[3:], position), aligned[:3], world) < IDENTITY


@robots
@methods
def test_the_transpose_turns_wrenches_into_torques(model, method):
    q, _, _ = random_state(model, 3)
    wrench = random_wrenches(model, 4)[-1]
    on_last = np.zeros((model.n_bodies, 6))
    on_last[-1] = wrench
    rest = np.zeros(model.n_bodies)
    held = graphdyn.inverse_dynamics(model, q, rest, rest, on_last).tau - graphdyn.gravity_torque(model, q)
    jacobian = graphdyn.frame_jacobian(model, q, model.body_names[-1], reference="local", method=method)
    assert relative_error(jacobian.T @ wrench, -held, graphdyn.gravity_torque(model, q)) < IDENTITY


@methods
@pytest.mark.parametrize("reference", ["local", "local_world_aligned"])
def test_a_robot_far_from_the_worlds_origin_loses_no_digits(method, reference):
    model = with_frames(NAMED["branched"])
    q, v, a = random_state(model, 3)
    far = BaseMotion(translation=[1e7, -2e7, 5e6])
    for verb, arguments in (
        (graphdyn.frame_jacobian, (q,)),
        (graphdyn.frame_velocity, (q, v)),
        (graphdyn.frame_acceleration, (q, v, a)),
        (graphdyn.frame_jacobian_derivative, (q, v)),
    ):
        here, there = (
            verb(model, *arguments, "tool", reference=reference, method=method, base=base) for base in (None, far)
        )
        assert relative_error(there, here) < IDENTITY


def test_an_alias_names_the_same_frame():
    model = with_frames(NAMED["branched"])
    q, v, _ = random_state(model, 3)
    found = [graphdyn.frame_velocity(model, q, v, name, reference="local") for name in ("tool", "tool_joint")]
    assert np.array_equal(*found)


def test_refusals():
    model = with_frames(NAMED["branched"])
    q = np.zeros(model.n_bodies)
    with pytest.raises(UnknownFrame, match=r"has no frame 'flange'; known: .*tool, stand"):
        graphdyn.frame_jacobian(model, q, "flange", reference="local")
    with pytest.raises(InvalidInput, match="reference is 'body'; use one of world, local, local_world_aligned"):
        graphdyn.frame_velocity(model, q, q, "tool", reference="body")
    with pytest.raises(InvalidInput, match="frame_jacobian_derivative takes a base at rest"):
        graphdyn.frame_jacobian_derivative(model, q, q, "tool", reference="local", base=MOVING)
    with pytest.raises(InvalidInput, match="the model is 'ur5'"):
        graphdyn.frame_jacobian("ur5", q, "tool", reference="local")
