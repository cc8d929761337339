"""urdf.load gives back what urdf.save wrote: random trees, rotations at pitch ±π/2 included."""

from pathlib import Path

import numpy as np
from examples import examples
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import graphdyn
import urdf
from graphdyn import Body, Frame, Joint, JointLimits, Placement, RobotModel
from graphdyn.model.spatial import rotation_about
from urdf.document.numbers import rpy_from_rotation

ROUNDING = 1e-15
"""Largest entry by which a reloaded rotation may differ: angles are rounded, then four products. Measured: 8e-16."""

E1, E2, E3 = np.eye(3)


def reload(model: RobotModel, folder: Path) -> RobotModel:
    path = folder / "saved.urdf"
    urdf.save(model, path)
    return urdf.load(path)


def rpy_matrix(roll: float, pitch: float, yaw: float) -> np.ndarray:
    return rotation_about(E3, yaw) @ rotation_about(E2, pitch) @ rotation_about(E1, roll)


angles = st.floats(-np.pi, np.pi)
poles = st.sampled_from([0.0, 1e-16, 1e-15, 1e-12, 1e-8, 1e-4]).map(lambda gap: np.pi / 2 - gap)
pitches = st.one_of(st.floats(-np.pi / 2, np.pi / 2), poles, poles.map(lambda pitch: -pitch))
vectors = st.lists(st.floats(-3, 3), min_size=3, max_size=3).map(np.array)


@st.composite
def rotations(draw) -> np.ndarray:
    """Any rotation, often at pitch ±π/2, with the rounding of a few products in its entries."""
    turn = rpy_matrix(draw(angles), draw(angles), draw(angles))
    return turn.T @ (turn @ rpy_matrix(draw(angles), draw(pitches), draw(angles)))


placements = st.builds(Placement, rotations(), vectors)
limit_values = st.none() | st.floats(0, 1e4)


@st.composite
def bodies(draw, name: str) -> Body:
    root = np.array(draw(st.lists(st.floats(-1, 1), min_size=9, max_size=9))).reshape(3, 3)
    tensor = root @ root.T + 0.01 * np.eye(3)
    return Body(name, draw(st.floats(0.01, 100)), draw(vectors), np.triu(tensor) + np.triu(tensor, 1).T)


@st.composite
def joints(draw, number: int, inside: int) -> Joint:
    kind = draw(st.sampled_from(["revolute", "continuous", "prismatic"]))
    bounds = {} if kind == "continuous" else {"lower": draw(st.none() | st.floats(-4, 0)), "upper": draw(limit_values)}
    limits = JointLimits(velocity=draw(limit_values), effort=draw(limit_values), **bounds)
    axis = draw(vectors.filter(lambda v: np.linalg.norm(v) > 1e-3))
    damping, friction = draw(st.floats(0, 10)), draw(st.floats(0, 10))
    return Joint(f"j{number}", kind, inside, draw(placements), axis, limits, damping, friction)


@st.composite
def models(draw) -> RobotModel:
    """A random tree numbered depth first: the inside body is on the path from the ground to the previous body."""
    n = draw(st.integers(1, 5))
    path, links, edges = [0], [], []
    for number in range(1, n + 1):
        path = path[: draw(st.integers(1, len(path)))]
        edges.append(draw(joints(number, path[-1])))
        links.append(draw(bodies(f"b{number}")))
        path.append(number)
    frames = tuple(
        Frame(f"f{k}", draw(st.integers(0, n)), draw(placements), draw(st.sampled_from([(), (f"alias{k}",)])))
        for k in range(draw(st.integers(0, 3)))
    )
    return RobotModel("random", tuple(links), tuple(edges), frames=frames)


def assert_same_placement(got: Placement, expected: Placement) -> None:
    assert_array_equal(got.translation, expected.translation)
    assert_allclose(got.rotation, expected.rotation, rtol=0, atol=ROUNDING)


@examples(40)
@given(model=models())
def test_round_trip(tmp_path_factory, model):
    again = reload(model, tmp_path_factory.mktemp("round_trip"))
    assert (again.name, again.base_name) == (model.name, model.base_name)
    assert again.body_names == model.body_names
    assert again.joint_names == model.joint_names
    for got, expected in zip(again.bodies, model.bodies, strict=True):
        assert got.mass == expected.mass
        assert_array_equal(got.center_of_mass, expected.center_of_mass)
        assert_array_equal(got.inertia, expected.inertia)
    for got, expected in zip(again.joints, model.joints, strict=True):
        assert (got.kind, got.inside, got.limits) == (expected.kind, expected.inside, expected.limits)
        assert (got.damping, got.friction) == (expected.damping, expected.friction)
        assert_allclose(got.axis, expected.axis, rtol=0, atol=ROUNDING)
        assert_same_placement(got.placement, expected.placement)
    for got, expected in zip(again.frames, model.frames, strict=True):
        assert (got.name, got.body, got.aliases) == (expected.name, expected.body, expected.aliases)
        assert_same_placement(got.placement, expected.placement)
    q = np.linspace(-1, 1, model.n_bodies)
    mass_matrix = graphdyn.mass_matrix(model, q)
    assert np.abs(graphdyn.mass_matrix(again, q) - mass_matrix).max() <= 1e-13 * np.abs(mass_matrix).max()


@examples(30)
@given(model=models(), base=placements)
def test_base_placement(tmp_path_factory, model, base):
    assume(base.translation.any())
    mounted = model.with_base(base)
    again = reload(mounted, tmp_path_factory.mktemp("base"))
    assert again.base_name == "world"
    assert [frame.name for frame in again.frames] == [model.base_name, *(frame.name for frame in model.frames)]
    q = np.linspace(-1, 1, model.n_bodies)
    for name in (model.base_name, *model.body_names, *(frame.name for frame in model.frames)):
        for got, expected in zip(
            graphdyn.frame_placement(again, q, name), graphdyn.frame_placement(mounted, q, name), strict=True
        ):
            assert_allclose(got, expected, rtol=0, atol=1e-13)


@given(rotation=rotations())
def test_roll_pitch_yaw_give_the_rotation_back(rotation):
    roll, pitch, yaw = rpy_from_rotation(rotation)
    assert_allclose(rpy_matrix(roll, pitch, yaw), rotation, rtol=0, atol=ROUNDING)
    assert abs(pitch) <= np.pi / 2
