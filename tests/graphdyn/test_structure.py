"""What does not depend on mechanics: imports, immutability, the graph, axes, frames, random states."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_trees import NAMED, SEEDS, body_of_points, random_placement, random_state, random_tree, robots, topologies

import graphdyn
from graphdyn import Body, Frame, Graph, Joint, JointLimits, Placement, RobotModel
from graphdyn.layout import (
    block_diagonal,
    body_rows,
    joint_rows,
    parameter_columns,
    per_body,
    per_joint,
    stacked,
    stacked_rows,
)
from graphdyn.model.inertia import pseudo_inertia

ROUNDING = 1e-14
"""A handful of products of numbers of size one."""


def test_import_stays_light():
    """graphdyn takes arrays: no file format, no Pinocchio, and no scipy at import, nor at the sight of any name."""
    heavy = ("scipy", "pinocchio", "yourdfpy", "lxml", "typer", "rich")
    names = "import graphdyn.excitation, graphdyn.identification; [getattr(graphdyn, x) for x in graphdyn.__all__]"
    program = f"import sys; {names}; print([name for name in {heavy} if name in sys.modules], graphdyn.__file__)"
    root = str(Path(graphdyn.__file__).parents[1])
    result = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": root},
        capture_output=True,
        text=True,
        check=True,
    )
    assert result.stdout.startswith("[] "), result.stdout


def test_every_public_name_exists_and_the_version_is_a_version():
    assert all(hasattr(graphdyn, name) for name in graphdyn.__all__)
    assert sorted(graphdyn.__all__) == graphdyn.__all__
    with pytest.raises(AttributeError, match="module 'graphdyn' has no attribute 'nonsense'"):
        graphdyn.nonsense  # noqa: B018
    assert [part.isdigit() for part in graphdyn.__version__.split(".")] == [True] * 3


# Immutability


def arrays_of(model):
    yield "gravity", model.gravity
    yield "base rotation", model.base.rotation
    yield "base translation", model.base.translation
    yield "inertial_parameters", model.inertial_parameters
    for body in model.bodies:
        yield "center_of_mass", body.center_of_mass
        yield "inertia", body.inertia
    for joint in model.joints:
        yield "axis", joint.axis
        yield "axis_normals", joint.axis_normals
        yield "placement rotation", joint.placement.rotation


def test_arrays_of_a_model_are_read_only():
    for name, array in arrays_of(random_tree(80, [0, 1], ["revolute", "prismatic"])):
        assert not array.flags.writeable, f"{name} can be overwritten in place"


@pytest.mark.parametrize("name", ["name", "bodies", "joints", "gravity"])
def test_fields_of_a_model_cannot_be_assigned(name):
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(graphdyn.kr500(), name, None)


def test_a_model_keeps_copies_of_the_arrays_it_is_given():
    center, inertia, axis, gravity = np.ones(3), np.eye(3), np.array([0, 0, 2.0]), np.array([0, 0, -1.0])
    body = Body("b", 1.0, center, inertia)
    joint = Joint("j", "revolute", 0, Placement(), axis)
    model = RobotModel("r", [body], [joint], gravity=gravity)
    for array in (center, inertia, axis, gravity):
        array[:] = 7
        assert array.flags.writeable  # the caller's array stays the caller's
    assert np.array_equal(body.center_of_mass, np.ones(3))
    assert np.array_equal(body.inertia, np.eye(3))
    assert np.array_equal(joint.axis, [0, 0, 1])
    assert np.array_equal(model.gravity, [0, 0, -1])
    assert isinstance(model.bodies, tuple)


def test_variants_of_a_model_leave_the_original_alone():
    model = NAMED["branched"]
    gravity, base = model.gravity.copy(), model.base
    lighter = model.with_inertial_parameters(model.inertial_parameters / 2)
    turned = model.with_gravity([1.0, 2.0, 3.0]).with_base(Placement())
    assert np.array_equal(model.gravity, gravity)
    assert model.base is base
    assert np.array_equal(turned.gravity, [1, 2, 3])
    assert np.array_equal(turned.base.translation, np.zeros(3))
    for body, half in zip(model.bodies, lighter.bodies, strict=True):
        assert half.mass == body.mass / 2
        np.testing.assert_allclose(half.center_of_mass, body.center_of_mass, rtol=ROUNDING)
        np.testing.assert_allclose(
            half.inertia, body.inertia / 2, rtol=0, atol=ROUNDING * np.abs(body.parameters).max()
        )


# Graph and layout


@given(topologies(max_bodies=15))
def test_path_matrix_is_minus_the_inverse_of_the_incidence_matrix(topology):
    inside, _ = topology
    graph = Graph(tuple(inside))
    s, t = graph.incidence(), graph.path_matrix()
    assert np.array_equal(-s @ t, np.eye(graph.n))  # integers: exact
    for i in range(1, graph.n + 1):
        path, vertex = set(), i
        while vertex > 0:
            path.add(vertex)
            vertex = inside[vertex - 1]
        assert set(np.flatnonzero(t[:, i - 1]) + 1) == path


@given(topologies(max_bodies=15))
def test_every_body_is_outside_exactly_one_vertex(topology):
    graph = Graph(tuple(topology[0]))
    carried = [j for i in range(graph.n + 1) for j in graph.outside(i)]
    assert sorted(carried) == list(range(1, graph.n + 1))
    assert all(graph.inside[j - 1] == i for i in range(graph.n + 1) for j in graph.outside(i))


@given(robots())
def test_body_joint_vectors_point_from_the_centers_to_the_joints(model):
    """Eq. (11) in world axes at q = 0: a joint is reached from both of its bodies."""
    state = graphdyn.maximal_state(model, np.zeros(model.n_bodies))
    c, s = model.body_joint_vectors(), model.graph.incidence()
    assert np.array_equal(np.any(c != 0, axis=-1), s != 0)
    for j, joint in enumerate(model.joints, start=1):
        ends = [
            state.position[i - 1] + s[i - 1, j - 1] * state.rotation[i - 1] @ c[i - 1, j - 1]
            for i in (joint.inside, j)
            if i > 0
        ]
        origin = graphdyn.frame_placement(model, np.zeros(model.n_bodies), model.body_names[j - 1])[1]
        np.testing.assert_allclose(ends, np.broadcast_to(origin, (len(ends), 3)), rtol=0, atol=10 * ROUNDING)


def test_stacking_and_slices_count_six_per_body_five_per_joint_ten_parameters(rng):
    blocks = rng.normal(size=(2, 4, 6))
    assert np.array_equal(per_body(stacked(blocks)), blocks)
    assert np.array_equal(stacked(blocks)[:, body_rows(3)], blocks[:, 2])
    multipliers = rng.normal(size=(4, 5))
    assert np.array_equal(per_joint(stacked(multipliers)), multipliers)
    assert np.array_equal(stacked(multipliers)[joint_rows(4)], multipliers[3])
    parameters = rng.normal(size=(4, 10))
    assert np.array_equal(stacked(parameters)[parameter_columns(1)], parameters[0])
    matrices = rng.normal(size=(2, 3, 6, 4))
    assert np.array_equal(stacked_rows(matrices)[:, 6:12], matrices[:, 1])
    diagonal = block_diagonal(matrices)
    assert diagonal.shape == (2, 18, 12)
    for i in range(3):
        assert np.array_equal(diagonal[:, 6 * i : 6 * i + 6, 4 * i : 4 * i + 4], matrices[:, i])
    assert np.count_nonzero(diagonal) == matrices.size


# Joints


def triad_of(axis):
    """Rows t_1, t_2, p."""
    joint = Joint("j", "revolute", 0, Placement(), axis)
    return np.stack([*joint.axis_normals, joint.axis])


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda x: np.linalg.norm(x) > 1e-6))
def test_axis_normals_and_axis_are_a_right_handed_triad(axis):
    triad = triad_of(axis)
    np.testing.assert_allclose(triad @ triad.T, np.eye(3), rtol=0, atol=ROUNDING)
    assert np.linalg.det(triad) > 0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("k", range(3))
def test_axis_normals_of_coordinate_axes_are_coordinate_axes(k, sign):
    """p × e with e the first coordinate axis that is least aligned with p."""
    p = sign * np.eye(3)[k]
    first = np.eye(3)[0 if k != 0 else 1]
    t_1, t_2, _ = triad_of(p)
    assert np.array_equal(t_1, np.cross(p, first))
    assert np.array_equal(t_2, np.cross(p, np.cross(p, first)))


@pytest.mark.parametrize("axis", [(1, 1, 1), (0, 0, 1), (0, 1, 0), (1, 0, 0)])
def test_axis_normals_do_not_jump_where_coordinate_axes_are_equally_far(axis):
    """An axis read from a file with twelve digits has the normals of the exact axis."""
    exact = triad_of(np.array(axis, dtype=float))
    for rounding in 1e-12 * np.stack([np.eye(3), -np.eye(3)]).reshape(6, 3):
        np.testing.assert_allclose(triad_of(axis + rounding), exact, rtol=0, atol=1e-11)


def test_axis_is_normalized():
    assert np.array_equal(Joint("j", "prismatic", 0, Placement(), [0, -3, 0]).axis, [0, -1, 0])


# Bodies


@given(SEEDS)
def test_parameters_and_body_are_inverse_of_each_other(seed):
    rng = np.random.default_rng(seed)
    masses, points = rng.uniform(0.1, 5, 5), rng.uniform(-1, 1, (5, 3))
    body = body_of_points("b", masses, points)
    about_origin = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, points, strict=True))
    xx, xy, xz, yy, yz, zz = about_origin[np.triu_indices(3)]
    expected = np.array([masses.sum(), *(masses @ points), xx, xy, yy, xz, yz, zz])
    np.testing.assert_allclose(body.parameters, expected, rtol=0, atol=10 * ROUNDING * expected.max())
    back = Body.from_parameters("b", body.parameters)
    assert back.mass == body.mass
    np.testing.assert_allclose(back.center_of_mass, body.center_of_mass, rtol=0, atol=10 * ROUNDING)
    np.testing.assert_allclose(back.inertia, body.inertia, rtol=0, atol=10 * ROUNDING * expected.max())


@given(SEEDS)
def test_pseudo_inertia_is_the_second_moment_of_the_mass(seed):
    """∫ (x, 1)(x, 1)ᵀ dm of point masses, hence positive semidefinite."""
    rng = np.random.default_rng(seed)
    masses, points = rng.uniform(0.1, 5, 6), rng.uniform(-1, 1, (6, 3))
    body = body_of_points("b", masses, points)
    homogeneous = np.column_stack([points, np.ones(6)])
    expected = homogeneous.T @ (masses[:, None] * homogeneous)
    matrix = pseudo_inertia(body.mass, body.center_of_mass, body.inertia)
    np.testing.assert_allclose(matrix, expected, rtol=0, atol=10 * ROUNDING * expected.max())


def test_rounding_in_a_tensor_is_symmetrized():
    tensor = np.diag([1.0, 2.0, 2.5])
    tensor[0, 1] = 1e-12
    body = Body("b", 1.0, np.zeros(3), tensor)
    assert np.array_equal(body.inertia, body.inertia.T)
    assert body.inertia[0, 1] == 5e-13


def test_placements_compose_and_invert(rng):
    a, b = random_placement(rng), random_placement(rng)
    point = rng.normal(size=3)

    def apply(placement, x):
        return placement.rotation @ x + placement.translation

    np.testing.assert_allclose(apply(a @ b, point), apply(a, apply(b, point)), rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(apply(a.inverse(), apply(a, point)), point, rtol=0, atol=ROUNDING)


# Frames


@pytest.fixture
def with_frames():
    rng = np.random.default_rng(81)
    model = NAMED["branched"]
    frames = (
        Frame("tool0", 4, random_placement(rng), aliases=("flange_joint",)),
        Frame("camera_mount", 0, random_placement(rng)),
    )
    return dataclasses.replace(model, frames=frames, base_name="pedestal")


def test_frames_are_found_by_name_of_body_ground_frame_and_alias(with_frames):
    assert with_frames.frame("body4").body == 4
    assert with_frames.frame("pedestal").body == 0
    assert with_frames.frame("tool0") is with_frames.frames[0]
    assert with_frames.frame("flange_joint") is with_frames.frames[0]
    assert with_frames.frame("camera_mount").body == 0


def test_frame_placement_is_the_chain_of_placements(with_frames):
    """The tool at q = 0 by composing placements along the path, the ground from the base alone."""
    q = np.zeros(6)
    chain, body, path = with_frames.base, 4, []
    while body > 0:
        path.append(body)
        body = with_frames.joints[body - 1].inside
    for j in reversed(path):
        chain = chain @ with_frames.joints[j - 1].placement
    tool = chain @ with_frames.frame("tool0").placement
    for name, expected in (
        ("tool0", tool),
        ("flange_joint", tool),
        ("body4", chain),
        ("pedestal", with_frames.base),
        ("camera_mount", with_frames.base @ with_frames.frame("camera_mount").placement),
    ):
        rotation, position = graphdyn.frame_placement(with_frames, q, name)
        np.testing.assert_allclose(rotation, expected.rotation, rtol=0, atol=ROUNDING)
        np.testing.assert_allclose(position, expected.translation, rtol=0, atol=ROUNDING)


def test_frame_placement_moves_rigidly_with_its_body(with_frames):
    q, _, _ = random_state(with_frames, 82, size=(5,))
    on_body = with_frames.frame("tool0").placement
    rotation, position = graphdyn.frame_placement(with_frames, q, "tool0")
    body_rotation, body_position = graphdyn.frame_placement(with_frames, q, "body4")
    np.testing.assert_allclose(rotation, body_rotation @ on_body.rotation, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(position, body_position + body_rotation @ on_body.translation, rtol=0, atol=ROUNDING)
    assert np.ptp(position, axis=0).min() > 0.01


# Random states


def one_joint(kind="revolute", **limits):
    joint = Joint("j", kind, 0, Placement(), [0, 0, 1], JointLimits(**limits))
    return RobotModel("r", (NAMED["one_revolute"].bodies[0],), (joint,))


def extremes(model):
    """Least and largest q and v of many samples: uniform samples come within 1 % of both ends."""
    q, v = model.random_state(np.random.default_rng(83), 2000)
    return q.min(), q.max(), v.min(), v.max()


SHARE = 0.01
"""2000 uniform samples leave the outer 1 % of an interval empty with probability 2e-9."""


@pytest.mark.parametrize(
    ("kind", "limits", "expected"),
    [
        ("revolute", {"lower": -0.5, "upper": 2.0, "velocity": 3.0}, (-0.5, 2.0, 3.0)),
        ("revolute", {}, (-np.pi, np.pi, np.pi)),
        ("revolute", {"lower": 0.0, "upper": 0.0, "velocity": 0.0}, (-np.pi, np.pi, np.pi)),
        ("revolute", {"lower": None, "upper": None, "velocity": 1.5}, (-np.pi, np.pi, 1.5)),
        ("revolute", {"lower": 4.0}, (4.0, 4.0 + 2 * np.pi, np.pi)),
        ("revolute", {"upper": -1.0}, (-1.0 - 2 * np.pi, -1.0, np.pi)),
        ("revolute", {"lower": -1e16, "upper": 1e16, "velocity": 1e308}, (-np.pi, np.pi, np.pi)),
        ("revolute", {"lower": -1e6, "upper": 1e6, "velocity": 1e6}, (-1e6, 1e6, 1e6)),
        ("revolute", {"lower": -1.01e6, "upper": 1.01e6, "velocity": 1.01e6}, (-np.pi, np.pi, np.pi)),
        ("revolute", {"lower": 0.3, "upper": 0.3}, (0.3, 0.3, np.pi)),
        ("continuous", {"lower": -0.1, "upper": 0.1, "velocity": 2.0}, (-np.pi, np.pi, 2.0)),
        ("prismatic", {"lower": 0.1, "upper": 0.4, "velocity": 0.2}, (0.1, 0.4, 0.2)),
        ("prismatic", {}, (-0.5, 0.5, 0.5)),
        ("prismatic", {"lower": 0.0, "upper": 0.0, "velocity": 0.0}, (-0.5, 0.5, 0.5)),
    ],
)
def test_random_states_fill_the_limits_or_their_stand_ins(kind, limits, expected):
    lower, upper, speed = expected
    q_min, q_max, v_min, v_max = extremes(one_joint(kind, **limits))
    for least, largest, low, high in ((q_min, q_max, lower, upper), (v_min, v_max, -speed, speed)):
        assert low <= least <= low + SHARE * (high - low)
        assert high - SHARE * (high - low) <= largest <= high


@pytest.mark.parametrize("size", [(), 4, np.int64(4), (2, 3)])
def test_random_states_have_the_asked_shape_and_follow_the_seed(size):
    model = NAMED["branched"]
    q, v = model.random_state(np.random.default_rng(84), size)
    leading = size if isinstance(size, tuple) else (size,)
    assert q.shape == v.shape == (*leading, 6)
    again = model.random_state(np.random.default_rng(84), size)
    other = model.random_state(np.random.default_rng(85), size)
    assert np.array_equal(q, again[0])
    assert np.array_equal(v, again[1])
    assert not np.any(q == other[0])
