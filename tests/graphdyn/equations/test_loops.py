"""Robots with loops: ranks, determined and undetermined reactions, closed forms and published mechanisms."""

import itertools
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from long_check import few
from robots.mechanisms import andrews, at, bricard, four_bar, hinge, n_four_bar, palletizer, rod
from scipy.linalg import null_space
from scipy.spatial.transform import Rotation
from shared_data import DATA, existing
from witnesses import relative_error

import graphdyn
from graphdyn import (
    Body,
    Chord,
    InconsistentState,
    InvalidInput,
    InvalidModel,
    Joint,
    Placement,
    RobotModel,
    identification,
)
from graphdyn.equations.loops.analysis import _without
from graphdyn.model import random_states
from graphdyn.model.assembly import assembled, moving_apart
from graphdyn.model.chord import CHORD_ROWS
from graphdyn.model.loops import Loops, loop_spaces
from graphdyn.model.spatial import rotation_about, rotation_vector
from graphdyn.verbs import VERBS

ROUNDING = 1e-13
"""Of accelerations and torques relative to the largest: measured 1e-14, at poses with a well-conditioned J."""

STEP, DIFFERENCES = 1e-4, 1e-7
"""Of central differences along a motion [s], and their error relative to the largest: 4e-8, which falls with the square
of the step; below, the gaps at which loops count as closed weigh more."""

METHODS = ("dense", "projected", "recursive")
methods = pytest.mark.parametrize("method", METHODS)
REACTIONS = ("multipliers", "joint_wrenches", "chord_multipliers")


def random_placement(rng):
    axis = rng.normal(size=3)
    return Placement(rotation_about(axis / np.linalg.norm(axis), rng.uniform(-3, 3)), rng.uniform(-0.5, 0.5, 3))


def closed_chain(kind, n=10):
    """A chain of turns and slides in space, closed by such a chord between bodies 1 and n; and a closed pose."""
    rng = np.random.default_rng(len(kind))
    bodies = [Body(f"body {k}", 1.0, rng.uniform(-0.2, 0.2, 3), 0.1 * np.eye(3)) for k in range(1, n + 1)]
    kinds = ["prismatic" if k in (3, 6) else "revolute" for k in range(n)]
    joints = [Joint(f"joint {k}", kinds[k], k, random_placement(rng), rng.normal(size=3)) for k in range(n)]
    tree = RobotModel(kind, tuple(bodies), tuple(joints))
    q, _ = tree.random_state(rng)
    links, on_i, axis = Loops(joints, (), tree.degrees_of_freedom).links(q), random_placement(rng), rng.normal(size=3)
    p = axis / np.linalg.norm(axis)
    left_free = {
        "hinge": Placement(rotation_about(p, 1.1), np.zeros(3)),
        "ball": Placement(random_placement(rng).rotation, np.zeros(3)),
        "slide": Placement(np.eye(3), 0.3 * p),
        "weld": Placement(),
        "distance": random_placement(rng),
    }[kind]
    there = Placement(links.rotation[1], links.origin[1]) @ on_i @ left_free
    length = float(np.linalg.norm(left_free.translation)) if kind == "distance" else None
    on_j = Placement(links.rotation[n], links.origin[n]).inverse() @ there
    return replace(tree, chords=(Chord("chord", kind, 1, on_i, n, on_j, axis, length),), actuated=tree.joint_names), q


def compare(found, wanted, tolerance=ROUNDING):
    """Reactions are NaN in the same places, and equal elsewhere."""
    for name in REACTIONS:
        ours, theirs = getattr(found, name), getattr(wanted, name)
        np.testing.assert_array_equal(np.isnan(ours), np.isnan(theirs), name)
        scale = np.nanmax(np.abs(wanted.multipliers), initial=1.0)
        assert np.nanmax(np.abs(ours - theirs), initial=0.0) <= tolerance * scale, name


@pytest.mark.usefixtures("interpreted")
@pytest.mark.parametrize("kind", CHORD_ROWS)
def test_rows_are_derivatives_of_the_gap_and_methods_agree(kind):
    model, q = closed_chain(kind)
    loops, step, rng = model.loops, 1e-6, np.random.default_rng(1)
    assert np.abs(loops.gaps(q)).max() < 1e-14
    jacobian = loops.jacobian(loops.links(q))
    assert jacobian.shape == (len(CHORD_ROWS[kind]), 10)
    differences = [(loops.gaps(q + step * e) - loops.gaps(q - step * e)) / (2 * step) for e in np.eye(10)]
    np.testing.assert_allclose(jacobian, np.stack(differences, axis=-1), atol=1e-8)  # of central differences
    q, v, a = graphdyn.assemble(model, q, *rng.normal(size=(2, 10)))
    rates = [loops.jacobian(loops.links(q + s * step * v)) @ v for s in (1, -1)]
    np.testing.assert_allclose(jacobian @ a, -(rates[0] - rates[1]) / (2 * step), atol=1e-7)
    tau, wrenches = rng.normal(size=10), rng.normal(size=(10, 6))
    answers = [graphdyn.forward_dynamics(model, q, v, tau, wrenches, method=method) for method in METHODS]
    for answer in answers[1:]:
        assert relative_error(answer.a, answers[0].a) < 1e-12  # of a chain whose masses hang far out
        compare(answer, answers[0], 1e-11)
    assert np.isfinite(answers[0].multipliers).all()  # no row is redundant in space
    back = graphdyn.inverse_dynamics(model, q, v, answers[0].a, wrenches)
    under_motors = graphdyn.forward_dynamics(model, q, v, back.tau, wrenches, method="dense")
    for method in METHODS:
        compare(graphdyn.inverse_dynamics(model, q, v, answers[0].a, wrenches, method=method), under_motors, 1e-11)
    of_tree = graphdyn.joint_torques(model.opened, q, v, answers[0].a, wrenches) @ v  # chords do no work
    for method in ("dense", "projected"):
        power = graphdyn.power(model, q, v, answers[0].a, wrenches, method=method)
        assert power.sum() == pytest.approx(of_tree, rel=1e-10)
        np.testing.assert_allclose(power, back.tau * v, atol=1e-10 * np.abs(power).max())
    moved = graphdyn.joint_accelerations(model, q, v, back.tau, wrenches)
    assert (
        relative_error(moved, answers[0].a) < 1e-12
    )  # ten motors move fewer degrees of freedom: other torques, same motion


@pytest.mark.parametrize("flip", [np.diag([1.0, -1, -1]), np.diag([-1.0, 1, -1])])
def test_a_hinge_turned_over_is_open_by_half_a_turn(flip):
    """Exactly opposite axes, whose cross product is zero; and nearly opposite ones, as by the formula of the angle."""
    model = four_bar()
    q, (chord,) = model.closed_pose, model.chords
    for angle in (0.0, 1e-9, 0.3):
        tilt = Placement(flip @ rotation_about(np.array([1.0, 0, 0]), angle), chord.placement_j.translation)
        over = replace(model, chords=(replace(chord, placement_j=tilt),))
        gaps = over.loops.gaps(q)
        np.testing.assert_allclose(np.linalg.norm(gaps[3:]), np.pi - angle, atol=1e-8)
        with pytest.raises(InconsistentState, match="is open by"):
            graphdyn.forward_dynamics(over, q, np.zeros(3), np.zeros(3))


def test_turns_are_those_of_scipy():
    """Of every axis, up to half a turn."""
    axes = np.random.default_rng(0).normal(size=(100, 3))
    turns = axes / np.linalg.norm(axes, axis=1)[:, None] * np.linspace(0.0, 3.14, 100)[:, None]
    rotations = Rotation.from_rotvec(turns).as_matrix()
    np.testing.assert_allclose(rotation_vector(rotations), Rotation.from_matrix(rotations).as_rotvec(), atol=1e-12)


def test_how_far_a_singular_pose_is():
    """The smallest singular value by the largest, which a redundant row does not change."""
    rows = np.diag([4.0, 0.5])
    assert loop_spaces(rows).distance == pytest.approx(0.125)
    assert loop_spaces(np.vstack([rows, rows[0]])).distance == pytest.approx(0.5 / np.sqrt(32))
    assert loop_spaces(np.zeros((1, 2))).distance == 1
    idle = np.vstack([rows, rows.sum(axis=0)]) @ np.eye(2, 4)
    values = np.linalg.svd(idle, compute_uv=False)
    assert loop_spaces(idle).distance == pytest.approx(values[1] / values[0])
    assert np.array_equal(loop_spaces(np.stack([idle, 0 * idle])).distance, [loop_spaces(idle).distance, 1.0])


def test_the_most_regular_pose_has_the_largest_rank_first():
    """And among poses of that rank the largest ratio of singular values: a folded linkage is no regular one."""
    model = n_four_bar(2)
    poses = np.concatenate([[np.zeros(model.nv)], model.random_state(np.random.default_rng(0), 4)[0]])
    values = np.linalg.svd(model.loops.jacobian(model.loops.links(poses)), compute_uv=False)
    ranks = (values > 1e-9).sum(axis=-1)
    ratios = [sizes[rank - 1] / sizes[0] for sizes, rank in zip(values, ranks, strict=True)]
    assert ranks[0] < ranks[1:].min()
    assert ratios[0] > max(ratios[1:])
    best = max(range(5), key=lambda k: (ranks[k], ratios[k]))
    assert np.array_equal(random_states._most_regular(model.loops, poses), poses[best])


def test_motions_beside_others_are_those_at_right_angles_in_units():
    """Of angles and of slides in micrometers; what both have in common is left out."""
    units = np.array([1.0, 1e-6, 1.0, 1e-6, 1e-6])[:, None]
    axes = np.linalg.qr(np.random.default_rng(0).normal(size=(5, 5)))[0]
    others = (axes[:, :1] + 2 * axes[:, 1:2]) / np.sqrt(5)
    rest = _without(units * axes[:, :3], units * others, units) / units
    assert rest.shape == (5, 2)
    np.testing.assert_allclose(rest.T @ np.hstack([rest, others, axes[:, 3:]]), np.eye(2, 5), atol=1e-12)
    assert np.array_equal(_without(units * axes, np.empty((5, 0)), units), units * axes)


def test_motions_apart_are_measured_by_what_is_summed():
    """6 where 4 is wanted, and 1 where 3 is: errors of 2 among numbers of 6 + 4."""
    rows = np.zeros((5, 3))
    rows[0, 0], rows[1, 1] = 2.0, 1.0
    apart = moving_apart(four_bar().loops, rows, np.array([3.0, 1.0, 0.0]), np.array([4.0, 3.0, 0, 0, 0]))
    np.testing.assert_allclose(apart, [0.2, 0.2, 0, 0, 0])


def enlarged(model, size):
    """The same robot, so many times as large and as strongly pulled, of the same masses: it moves alike."""

    def moved(placement):
        return Placement(placement.rotation, placement.translation * size)

    return replace(
        model,
        bodies=tuple(Body(b.name, b.mass, b.center_of_mass * size, b.inertia * size**2) for b in model.bodies),
        joints=tuple(replace(j, placement=moved(j.placement)) for j in model.joints),
        gravity=model.gravity * size,
        chords=tuple(
            replace(
                c,
                placement_i=moved(c.placement_i),
                placement_j=moved(c.placement_j),
                length=None if c.length is None else c.length * size,
            )
            for c in model.chords
        ),
    )


@pytest.mark.usefixtures("interpreted")
@pytest.mark.parametrize(
    ("kind", "size"),
    few(
        [(kind, size) for kind in ("plane", *CHORD_ROWS) for size in (1e-6, 1e6)],
        *(("plane", 1e-6), ("slide", 1e6), ("weld", 1e-6), ("distance", 1e6)),
    ),
)
def test_a_linkage_of_a_micrometer_and_one_of_a_thousand_kilometers_move_as_one_of_a_meter(kind, size):
    rng = np.random.default_rng(4)
    if kind == "plane":
        model = four_bar()
        q = model.random_state(rng)[0]
    else:
        model, q = closed_chain(kind)
    slides = np.array([size if joint.is_prismatic else 1.0 for joint in model.joints])
    q, v, _ = graphdyn.assemble(model, q, *rng.normal(size=(2, len(q))))
    tau = rng.normal(size=len(q))
    usual = graphdyn.forward_dynamics(model, q, v, tau, method="projected")
    other, moments = enlarged(model, size), size * size / slides
    turned = graphdyn.assemble(other, q * slides + 1e-3 * rng.normal(size=len(q)) * slides)
    assert other.loops.widest(other.loops.gaps(turned)) < 1e-12
    for method in METHODS:
        found = graphdyn.forward_dynamics(other, q * slides, v * slides, tau * moments, method=method)
        assert relative_error(found.a / slides, usual.a) < 1e-11, method
        units = np.where([name.startswith("moment") for name in model.chords[0].rows], size * size, size)
        known = np.isfinite(usual.chord_multipliers)
        np.testing.assert_array_equal(np.isfinite(found.chord_multipliers), known, method)
        forces = np.where(known, found.chord_multipliers / units, 0.0)
        tolerance = 1e-9 if method == "recursive" else 1e-11  # 2e-10 also at 0.1 m: its dependent joints are few
        assert relative_error(forces, np.nan_to_num(usual.chord_multipliers)) < tolerance, method
    with pytest.raises(InconsistentState, match="is open by"):
        graphdyn.forward_dynamics(other, (q + 1e-5) * slides, v * slides, tau * moments)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_assembly_tells_the_gaps_that_it_leaves(size):
    """In meters, whatever the size of a linkage that no pose closes."""
    model = enlarged(four_bar(ground=9.0), size)
    found, gaps = assembled(model.loops, np.array([[0.1, 0.2, 0.3], [1.0, -1.0, 2.0]]))
    np.testing.assert_allclose(gaps, model.loops.gaps(found), rtol=1e-12, atol=1e-14 * size)
    assert np.linalg.norm(gaps, axis=-1) == pytest.approx(4.5 * size)


@pytest.mark.usefixtures("interpreted")
@pytest.mark.parametrize("kind", few(["hinge", "slide", "weld"], "hinge"))
def test_a_chord_that_is_open_by_an_angle_alone_is_refused(kind):
    """About each axis that it holds; turns about the axis of a hinge leave it closed."""
    model, q = closed_chain(kind)
    (chord,), still = model.chords, np.zeros(10)
    held = [row.split()[1] for row in CHORD_ROWS[kind] if row.startswith("moment")]
    for name, axis in zip(("t1", "t2", "p"), chord.triad.T, strict=True):
        # an axis of the chord, which stands on body i, as body j sees it
        links = model.loops.links(q)
        on_i = links.rotation[chord.body_i] @ chord.placement_i.rotation
        on_j = links.rotation[chord.body_j] @ chord.placement_j.rotation
        turn = rotation_about(on_j.T @ on_i @ axis, 1e-6)
        place = Placement(chord.placement_j.rotation @ turn, chord.placement_j.translation)
        other = replace(model, chords=(replace(chord, placement_j=place),))
        for method in ("projected", "recursive"):
            if name in held:
                with pytest.raises(InconsistentState, match="loop of chord 'chord' is open by 1e-06 m or rad"):
                    graphdyn.forward_dynamics(other, q, still, still, method=method)
            else:
                graphdyn.forward_dynamics(other, q, still, still, method=method)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("method", METHODS)
def test_how_far_velocities_may_be_from_closed(method, size):
    """By a hundred-millionth of what is summed, however fast the linkage is."""
    model = four_bar()
    q, v = graphdyn.assemble(model, [0.7, 0.0, 1.0], [size, 0, 0], hold=["a"])
    graphdyn.forward_dynamics(model, q, v * [1, 1 + 1e-9, 1], 0 * q, method=method)
    with pytest.raises(InconsistentState, match="the velocity opens the loop of chord 'closing'"):
        graphdyn.forward_dynamics(model, q, v * [1, 1 + 5e-8, 1], 0 * q, method=method)


def on_turntable(model, axis=(0, 1.0, 0)):
    """The mechanism on a body that turns, about y."""
    return replace(
        model,
        bodies=(rod("table"), *model.bodies),
        joints=(
            Joint("turn", "revolute", 0, Placement(), np.array(axis)),
            *(replace(j, inside=j.inside + 1) for j in model.joints),
        ),
        chords=tuple(replace(c, body_i=c.body_i + 1, body_j=c.body_j + 1) for c in model.chords),
        actuated=("turn",),
    )


def triangle():
    """Two rods of 1 m on a ground of 1 m, hinged to each other: with as many joints and two rows that count, nothing
    moves."""
    return RobotModel(
        "triangle", (rod("left"), rod("right")), (hinge("a", 0, (0, 0, 0)), hinge("b", 0, (1, 0, 0))),
        gravity=np.array([0, -9.81, 0]), chords=(Chord("tip", "hinge", 1, at(1), 2, at(1)),), actuated=("a",),
    )  # fmt: skip


@pytest.mark.usefixtures("interpreted")
def test_a_linkage_that_cannot_move_is_analyzed_and_stands_still():
    model = triangle()
    q = model.closed_pose
    np.testing.assert_allclose(np.abs(q), np.deg2rad([60, 120]), atol=1e-12)
    found = graphdyn.analyze_loops(model, q)
    assert (found.n_rows, found.rank, found.usual_rank, found.grubler_mobility) == (15, 12, 12, -3)
    assert (found.mobility, found.infinitesimal_mobility, found.motions.shape) == (0, 0, (2, 0))
    poses, velocities = model.random_state(np.random.default_rng(0), 20)
    np.testing.assert_allclose(poses, np.broadcast_to(q, (20, 2)), atol=1e-7)
    assert not velocities.any()
    for method in METHODS:
        assert np.abs(graphdyn.joint_accelerations(model, q, [0, 0], [3.0, -5.0], method=method)).max() < 1e-15
        assert not graphdyn.inverse_dynamics(model, q, [0, 0], [0, 0], method=method).tau.any()


@pytest.mark.usefixtures("interpreted")
def test_a_triangle_on_a_turning_table_turns_as_one_body():
    """The rods as points at their centers and at rest in their own frame; the table about z, gravity along x."""
    model = replace(on_turntable(triangle(), [0, 0, 1.0]), gravity=np.array([9.81, 0, 0]))
    q = graphdyn.assemble(model, [0.4, 1.0, 2.0], hold=["turn"])
    q, v, a = graphdyn.assemble(model, q, [3.0, 1.0, -2.0], [5.0, 2.0, 7.0], hold=["turn"])
    np.testing.assert_allclose((v, a), [[3.0, 0, 0], [5.0, 0, 0]], atol=1e-13)
    centers = np.array([[0.5, 0.0], [0.25, 0.75**0.5 / 2], [0.75, 0.75**0.5 / 2]])  # of table and rods, of 1 kg each
    inertia = (centers**2).sum() + 3 / 12
    across = (np.sin(0.4) * centers[:, 0] + np.cos(0.4) * centers[:, 1]).sum()  # of the centers in world axes
    for method in METHODS:
        found = graphdyn.inverse_dynamics(model, q, v, a, method=method)
        np.testing.assert_allclose(found.tau, [inertia * 5 + 9.81 * across, 0, 0], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(graphdyn.forward_dynamics(model, q, v, found.tau, method=method).a, a, atol=1e-11)


@pytest.mark.usefixtures("interpreted")
def test_a_linkage_at_rest_on_a_turning_table_has_the_torque_of_the_tree():
    """About any axis: the centripetal terms of a linkage that does not move cancel up to rounding."""
    for seed, method in zip(range(6), 2 * METHODS, strict=True):
        axis = np.random.default_rng(seed).normal(size=3)
        model = replace(on_turntable(four_bar(), axis), actuated=("turn", "a"))
        q, _ = model.random_state(np.random.default_rng(seed))
        v, a = np.array([[3.0, 0, 0, 0], [2.0, 0, 0, 0]])
        wanted = graphdyn.inverse_dynamics(replace(model, chords=(), actuated=None), q, v, a).tau[0]
        found = graphdyn.inverse_dynamics(model, q, v, a, method=method).tau
        np.testing.assert_allclose(found[0], wanted, rtol=1e-11)
        np.testing.assert_allclose(graphdyn.assemble(model, q, v, a)[1:], (v, a), atol=1e-12)
        with pytest.raises(InconsistentState, match="the acceleration opens the loop of chord 'closing'"):
            graphdyn.inverse_dynamics(model, q, v, np.add(a, [0, 1e-5, 0, 0]), method=method)


@pytest.mark.parametrize(
    ("bars", "is_on_turntable"),
    few(
        [
            ((1, 1, 1, 3), False),
            ((3e-6, 1e-6, 1e-6, 1e-6), False),
            ((1e6, 4e6, 2e6, 1e6), False),
            ((1, 1, 1, 3 + 1e-9), False),
            ((1, 1, 1, 3), True),
        ],
        *(((1e6, 4e6, 2e6, 1e6), False), ((1, 1, 1, 3 + 1e-9), False), ((1, 1, 1, 3), True)),
    ),
)
def test_stretched_linkages_have_infinitesimal_mobility_and_no_accelerations(bars, is_on_turntable):
    model = on_turntable(four_bar(*bars)) if is_on_turntable else four_bar(*bars)
    found = graphdyn.analyze_loops(model, model.closed_pose)
    assert (found.mobility, found.infinitesimal_mobility) == (int(is_on_turntable), 2)
    if is_on_turntable:
        np.testing.assert_allclose(np.abs(found.motions[:, 0]), [1, 0, 0, 0], atol=1e-5)
    zero, questions = np.zeros(model.nv), (graphdyn.forward_dynamics, graphdyn.inverse_dynamics)
    for question, method in itertools.product(questions, METHODS):
        with pytest.raises(InconsistentState, match=r"motions of a, b, c keep them closed .* mobility 2"):
            question(model, model.closed_pose, zero, zero, method=method)


def test_the_motion_of_a_stretched_linkage_with_a_slide_is_that_of_its_table():
    """Two bars in line from the table to a carriage that slides across them; its meters and their radians differ."""
    model = four_bar(1e-6, 1e-6, 1e-6, 1e-6)
    slide = replace(model.joints[2], kind="prismatic", axis=np.array([0, 1.0, 0]))
    model = on_turntable(replace(model, joints=(*model.joints[:2], slide)))
    found = graphdyn.analyze_loops(model, np.zeros(4))
    assert (found.mobility, found.infinitesimal_mobility) == (1, 2)
    np.testing.assert_allclose(np.abs(found.motions[:, 0]), [1, 0, 0, 0], atol=1e-12)


def sliding(model, number, *axis):
    """The mechanism, one of whose joints slides."""
    joints = list(model.joints)
    joints[number] = replace(joints[number], kind="prismatic", axis=np.array(axis))
    return replace(model, joints=tuple(joints))


def found_at(model, q, size):
    """What the analysis decides of the mechanism so many times as large."""
    slides = np.array([size if joint.is_prismatic else 1.0 for joint in model.loops.free_joints])
    found = graphdyn.analyze_loops(enlarged(model, size), q * slides)
    flags = (found.determined_multipliers, found.determined_wrenches, found.determined_chord_multipliers)
    return (
        (found.rank, found.usual_rank, found.mobility, found.infinitesimal_mobility),
        [flag.tolist() for flag in flags],
        sorted(sorted(stress) for stress in found.self_stresses),
    )


SCALED = {
    "crank and rocker": on_turntable(four_bar()),
    "far slide": on_turntable(sliding(four_bar(), 2, 0.6, 0.8, 0)),
    "in line": four_bar(1, 1, 1, 3),
    "with a slide across": on_turntable(sliding(four_bar(1, 1, 1, 1), 2, 0, 1.0, 0)),
    "with a slide below": on_turntable(sliding(four_bar(1, 1, 1, 3), 0, 0, 1.0, 0)),
    "parallelogram in line": four_bar(1, 2, 1, 2),
    "bricard": bricard(),
}


SIZES = (1e-6, 100.0, 1e6)


@pytest.mark.parametrize(
    ("name", "size"),
    few(
        [(name, size) for name in (*SCALED, *CHORD_ROWS) for size in SIZES],
        *(("crank and rocker", 1e-6), ("in line", 1e6), ("with a slide below", 1e-6), ("bricard", 1e6)),
        *(("hinge", 1e6), ("weld", 100.0)),
    ),
)
def test_the_analysis_does_not_depend_on_the_unit_of_length(name, size):
    """Mechanisms in a plane and in space, and random chains with offsets, of turns and slides."""
    model, q = closed_chain(name, 8) if name in CHORD_ROWS else (SCALED[name], SCALED[name].closed_pose)
    assert found_at(model, q, size) == found_at(model, q, 1.0)


def test_a_stretched_linkage_that_is_slightly_open_is_one():
    model, q = four_bar(1, 1, 1, 3), np.array([1e-5, -2e-5, np.pi])
    assert 0 < np.abs(model.loops.gaps(q)).max() < 1e-9
    found = graphdyn.analyze_loops(model, q)
    assert (found.mobility, found.rank, found.usual_rank) == (0, 16, 16)
    with pytest.raises(InconsistentState, match="infinitesimal mobility"):
        graphdyn.forward_dynamics(model, q, np.zeros(3), np.zeros(3))
    assert graphdyn.kkt_system(model, q, np.zeros(3), np.zeros(3)).n_chord_rows == 5
    for coordinates in ("twist", "cardano"):
        with pytest.raises(InconsistentState, match="infinitesimal mobility"):
            graphdyn.kkt_system(model, q, np.zeros(3), np.zeros(3), coordinates=coordinates).solve()
    with pytest.raises(InconsistentState, match="infinitesimal mobility"):
        model.random_state(np.random.default_rng(0))
    with pytest.raises(InconsistentState, match="infinitesimal mobility"):
        graphdyn.simulate(model, q, np.zeros(3), 1.0)


@pytest.mark.parametrize("short", [1e-6, 1e-4])
def test_a_linkage_that_moves_a_little_has_mobility(short):
    model = four_bar(1, 1, 1, 3 - short)
    found = graphdyn.analyze_loops(model, model.closed_pose)
    assert (found.mobility, found.infinitesimal_mobility) == (1, 0)


@methods
def test_velocities_of_no_branch_have_no_acceleration(method):
    """A parallelogram in line: its cranks turn together, q = (t, -t, t), or against each other."""
    model, zero = four_bar(1, 2, 1, 2), np.zeros(3)
    together, mixed = np.array([1.0, -1, 1]), np.array([0, 1.0, 2])
    np.testing.assert_allclose(model.loops.jacobian(model.loops.links(zero)) @ np.stack([together, mixed]).T, 0)
    a = graphdyn.joint_accelerations(model, zero, together, zero, method=method)
    np.testing.assert_allclose(a, 1.2 * -9.81 * together, rtol=1e-12)
    with pytest.raises(InconsistentState, match="no acceleration keeps the loop of chord 'closing' closed at this"):
        graphdyn.joint_accelerations(model, zero, mixed, zero, method=method)


@pytest.fixture(scope="module")
def moving_palletizer():
    """A palletizing arm, k of its closed form v = k u̇, and states q and v (20, 10)."""
    model, k = palletizer(existing(DATA / "loops").parent)
    rng, count = np.random.default_rng(2), 20
    u = rng.uniform((-3, -0.6, -0.5, -3), (3, 0.6, 0.5, 3), (count, 4))
    return model, k, u @ k.T, rng.uniform(-2, 2, (count, 4)) @ k.T


@methods
def test_the_palletizer_is_what_its_closed_form_says(moving_palletizer, method):
    model, k, q, v = moving_palletizer
    rng, count = np.random.default_rng(7), len(q)
    tau, wrenches = np.zeros((count, 10)), rng.normal(size=(count, 10, 6)) * 50
    motors = [model.joint_names.index(name) for name in model.actuated]
    tau[:, motors] = rng.normal(size=(count, 4)) * 300
    tree = replace(model, chords=(), actuated=None)
    needed = tau - graphdyn.joint_torques(tree, q, v, np.zeros_like(q), wrenches)
    a = np.linalg.solve(k.T @ graphdyn.mass_matrix(tree, q) @ k, (needed @ k)[..., None])[..., 0] @ k.T
    answer = graphdyn.forward_dynamics(model, q, v, tau, wrenches, method=method)
    assert relative_error(answer.a, a) < ROUNDING
    determined = np.isfinite(answer.multipliers).sum(axis=(1, 2)) + np.isfinite(answer.chord_multipliers).sum(axis=1)
    np.testing.assert_array_equal(determined, 32)
    compare(answer, graphdyn.forward_dynamics(model, q, v, tau, wrenches, method="projected"))
    back = graphdyn.inverse_dynamics(model, q, v, a, wrenches, method=method if method != "dense" else "projected")
    assert relative_error(back.tau, tau) < ROUNDING


def test_torques_of_a_palletizer_are_linear_in_its_parameters_by_every_method(moving_palletizer):
    model, k, q, v = moving_palletizer
    a = graphdyn.assemble(model, q, v, np.random.default_rng(8).uniform(-5, 5, (len(q), 4)) @ k.T)[2]
    regressor = graphdyn.joint_torque_regressor(model, q, v, a)
    without = graphdyn.joint_torques(model, q, v, a)
    assert relative_error(regressor @ model.inertial_parameters, without) < ROUNDING
    for verb, arguments in (("bias_torque", (q, v)), ("gravity_torque", (q,)), ("joint_torque_regressor", (q, v, a))):
        fast, plain = (getattr(graphdyn, verb)(model, *arguments, method=m) for m in ("recursive", "projected"))
        assert relative_error(fast, plain) < ROUNDING, verb


def test_the_payload_of_a_palletizer_is_identified_at_its_motors():
    model, k = palletizer(existing(DATA / "loops").parent)
    rng = np.random.default_rng(3)
    u = rng.uniform((-3, -0.6, -0.5, -3), (3, 0.6, 0.5, 3), (200, 4))
    q, (v, a) = u @ k.T, rng.uniform(-2, 2, (2, 200, 4)) @ k.T
    loaded = model.inertial_parameters.copy()
    loaded[-10] += 80.0  # kg at the flange
    tau = graphdyn.joint_torques(model.with_inertial_parameters(loaded), q, v, a)
    torque_model = identification.TorqueModel(model, (identification.terms.RigidBodies(),))
    problem = identification.Problem(torque_model, identification.Samples(q, v, a, tau))
    found = model.with_inertial_parameters(identification.OrdinaryLeastSquares().estimate(problem).parameters)
    u = rng.uniform(-0.4, 0.4, (20, 4))
    q, (v, a) = u @ k.T, rng.uniform(-2, 2, (2, 20, 4)) @ k.T
    torques = [graphdyn.joint_torques(robot, q, v, a) for robot in (found, model.with_inertial_parameters(loaded))]
    assert relative_error(*torques) < 1e-9  # exact data, as well as the regressor is conditioned
    with pytest.raises(InconsistentState, match="is open by"):
        identification.Problem(torque_model, identification.Samples(q + 0.1, v, a, torques[0])).base.rank  # noqa: B018


def test_andrews_mechanism_starts_as_published():
    model, given = andrews(existing(DATA / "loops").parent)
    names, constants = given["order"].split(";")[0].split(), given["parameters"]
    q = np.array([float(given["q0"][names.index(name)]) for name in model.joint_names])
    tau = constants["mom"] * (np.array(model.joint_names) == "beta")
    rotation, origin = graphdyn.frame_placement(model, q, "K3")
    hook = np.array([constants["sd"], -constants["sc"], 0])
    line = np.array([constants["xc"], constants["yc"], 0]) - (origin + rotation @ hook)
    length = np.linalg.norm(line)
    force = rotation.T @ line / length * constants["c0"] * (length - constants["l0"])
    wrenches = np.zeros((7, 6))
    wrenches[model.body_names.index("K3")] = [*force, *np.cross(hook, force)]
    published = np.array([given["a0"][names.index(name)] for name in model.joint_names])
    for method in METHODS:
        answer = graphdyn.forward_dynamics(model, q, np.zeros(7), tau, wrenches, method=method)
        assert relative_error(answer.a, published) < 1e-12
        in_ground = []
        for chord, (f_1, f_2) in zip(model.chords, answer.chord_multipliers.reshape(3, 5)[:, :2], strict=True):
            turned, _ = graphdyn.frame_placement(model, q, model.body_names[chord.body_i - 1])
            in_ground += list((turned @ (chord.triad[:, :2] @ [f_1, f_2]))[:2])
        assert relative_error(np.array(in_ground), np.array(given["lambda0"])) < 1e-12


def test_ranks_mobility_and_self_stresses():
    plane = graphdyn.analyze_loops(four_bar(), four_bar().closed_pose)
    assert (plane.n_rows, plane.rank, plane.mobility, plane.grubler_mobility) == (20, 17, 1, -2)
    np.testing.assert_array_equal(plane.determined_multipliers, [[True, True, False, False, False]] * 3)
    np.testing.assert_array_equal(plane.determined_chord_multipliers, [True, True, False, False, False])
    assert len(plane.self_stresses) == 3
    of_chord = {name for stress in plane.self_stresses for name in stress if name.startswith("closing")}
    assert of_chord == {"closing force p", "closing moment t1", "closing moment t2"}
    in_space = graphdyn.analyze_loops(bricard(), np.zeros(5))
    assert (in_space.n_rows, in_space.rank, in_space.mobility) == (30, 29, 1)
    assert not in_space.determined_multipliers.any()
    assert not in_space.determined_chord_multipliers.any()
    (stress,) = in_space.self_stresses
    assert len(stress) == 30
    chords_and_joints = graphdyn.kkt_system(bricard(), *np.zeros((3, 5))).constraint_jacobian
    np.testing.assert_allclose(np.array(list(stress.values())) @ chords_and_joints, 0, atol=1e-14)  # in equilibrium
    np.testing.assert_allclose(np.abs(list(stress.values())), 1)  # all forces [N] and moments [N m] alike: rods of 1 m
    model = n_four_bar(2)
    in_line = graphdyn.analyze_loops(model, np.zeros(5))
    assert in_line.is_singular
    assert (in_line.rank, in_line.usual_rank, in_line.mobility) == (27, 29, 3)
    upright = np.pi / 2 * np.array([1, 1, 1, -1, -1])
    assert not graphdyn.analyze_loops(model, upright).is_singular
    system = graphdyn.kkt_system(model, upright, np.zeros(5), np.zeros(5))
    assert system.constraint_rank() == 29
    least = system.solve(least_norm=True)
    assert least.dynamics_residual() < 1e-14
    assert np.isnan(system.solve().multipliers).any()


def test_assembly_holds_joints_and_keeps_the_branch():
    model = four_bar(1.0, 2.0, 1.0, 2.0)  # a parallelogram, which could also close crossed over
    q = graphdyn.assemble(model, [0.7, -0.6, 0.8], hold=["a"])
    np.testing.assert_allclose(q, [0.7, -0.7, 0.7], atol=1e-12)
    q, v, a = graphdyn.assemble(model, [0.7, -0.6, 0.8], [1.0, 0, 0], [0.5, 0, 0], hold=["a"])
    np.testing.assert_allclose(v, [1, -1, 1], atol=1e-12)
    np.testing.assert_allclose(a, [0.5, -0.5, 0.5], atol=1e-12)
    flipped = replace(model, bodies=(rod("long", 2.0), *model.bodies[1:]))
    assert np.abs(flipped.loops.gaps(np.array([0.7, -0.7, 0.7]))).max() < 1e-12  # masses do not matter
    weld = RobotModel(
        "two", (rod("a"), rod("b")), (four_bar().joints[0], four_bar().joints[1]),
        chords=(Chord("weld", "weld", 0, at(2, 0, 0), 2, at(1, 0, 0)),),
    )  # fmt: skip
    assert np.abs(weld.loops.gaps(np.array([0.0, np.pi]))).max() > 1  # turned by half a turn is not closed
    with pytest.raises(InconsistentState, match=r"the loop of chord 'closing' is open by 1 m .* with a, b, c held"):
        graphdyn.assemble(replace(model, chords=model.chords), [0, 0, np.pi / 2], hold=["a", "b", "c"])


def test_corners():
    model = four_bar()
    q, v = model.random_state(np.random.default_rng(0), 0)
    assert q.shape == v.shape == graphdyn.assemble(model, q).shape == (0, 3)
    q, v = model.random_state(np.random.default_rng(0))
    cardano = graphdyn.kkt_system(model, q, v, np.zeros(3), coordinates="cardano").solve(least_norm=True)
    twist = graphdyn.kkt_system(model, q, v, np.zeros(3)).solve(least_norm=True)
    assert relative_error(cardano.chord_multipliers, twist.chord_multipliers) < 1e-10
    arms = (four_bar().joints[0], replace(four_bar().joints[0], name="other"))
    roped = RobotModel(
        "two arms", (rod("a"), rod("b")), arms, chords=(Chord("rope", "distance", 1, at(1), 2, at(1), length=0.5),)
    )  # at q = 0 the ends of the rope coincide
    assert np.abs(roped.loops.gaps(roped.closed_pose)).max() < 1e-12


def test_random_states_are_closed_and_gravity_and_inertia_of_trees_are_untouched():
    model = four_bar()
    q, v = model.random_state(np.random.default_rng(0), (2, 3))
    assert np.abs(model.loops.gaps(q)).max() < 1e-12
    assert np.abs(np.einsum("...mn,...n->...m", model.loops.jacobian(model.loops.links(q)), v)).max() < 1e-12
    tree = replace(model, chords=(), actuated=None)
    for verb in ("mass_matrix", "kinetic_energy", "coriolis_matrix"):
        arguments = (q,) if verb == "mass_matrix" else (q, v)
        np.testing.assert_array_equal(
            getattr(graphdyn, verb)(model, *arguments), getattr(graphdyn, verb)(tree, *arguments)
        )


@pytest.mark.parametrize("model", [four_bar(), bricard()], ids=["plane", "in space, redundant"])
def test_derivatives_along_closed_motions(model):
    rng, step = np.random.default_rng(5), STEP
    q, v = model.random_state(rng, 3)
    tau = rng.normal(size=q.shape)
    found = graphdyn.forward_dynamics_derivatives(model, q, v, tau)
    motion = graphdyn.assemble(model, q, v)[1]

    def at(s):
        moved = graphdyn.assemble(model, q + s * motion)
        return moved, graphdyn.assemble(model, moved, v)[1]

    (q_1, v_1), (q_0, v_0) = at(step), at(-step)
    change = [
        np.einsum("...ij,...j->...i", part, d) for part, d in ((found.da_dq, q_1 - q_0), (found.da_dv, v_1 - v_0))
    ]
    difference = graphdyn.joint_accelerations(model, q_1, v_1, tau) - graphdyn.joint_accelerations(model, q_0, v_0, tau)
    assert relative_error(sum(change) / step, difference / step) < DIFFERENCES
    motors = model.with_actuated(["a", "c"] if len(q[0]) == 3 else ["hinge 0"])
    torques = graphdyn.inverse_dynamics_derivatives(motors, q, v, graphdyn.joint_accelerations(model, q, v, tau))
    (a_1, a_0) = (graphdyn.joint_accelerations(model, *state, tau) for state in ((q_1, v_1), (q_0, v_0)))
    parts = ((torques.dtau_dq, q_1 - q_0), (torques.dtau_dv, v_1 - v_0), (torques.dtau_da, a_1 - a_0))
    change = [np.einsum("...ij,...j->...i", part, d) for part, d in parts]
    differences = [graphdyn.joint_torques(motors, *state) for state in ((q_1, v_1, a_1), (q_0, v_0, a_0))]
    difference = (differences[0] - differences[1]) / step
    assert relative_error(sum(change) / step, difference, *np.array(change) / step) < DIFFERENCES
    linear = graphdyn.joint_accelerations(model, q, v, tau + 1.0) - graphdyn.joint_accelerations(model, q, v, tau)
    assert relative_error(found.da_dtau.sum(axis=-1), linear, graphdyn.joint_accelerations(model, q, v, tau)) < 1e-12


def test_motors():
    model = four_bar()
    q, v = model.random_state(np.random.default_rng(1), 4)
    a = graphdyn.joint_accelerations(model, q, v, np.zeros_like(q))
    both = graphdyn.inverse_dynamics(model, q, v, a + 0, actuated=["a", "c"]).tau
    assert np.abs(both).max() < 1e-12  # no torque accelerates it so
    q, v, a = graphdyn.assemble(model, q, v, a + 1.0)
    one, both = (graphdyn.inverse_dynamics(model, q, v, a, actuated=names).tau for names in (["a"], ["a", "c"]))
    assert (np.linalg.norm(both, axis=-1) < np.linalg.norm(one, axis=-1)).all()
    assert relative_error(graphdyn.joint_accelerations(model, q, v, both), a) < ROUNDING
    two = n_four_bar(2)
    two = replace(two, chords=two.chords[:1])  # a2 and b1 stay open
    q = graphdyn.assemble(two, np.pi / 2 * np.array([1, 1, 1, -1, -1]))
    with pytest.raises(InvalidInput, match=r"motors at a0 leave 2 of 3 motions free: (a2 1; b1 1|b1 1; a2 1)\. .*more"):
        graphdyn.inverse_dynamics(two, q, 0 * q, 0 * q, actuated=["a0"])
    with pytest.raises(InvalidInput, match=r"which joints have motors is not known: give actuated= .* among a0, a1"):
        graphdyn.gravity_torque(two, q)


PRINTED = 5e-3
"""Of numbers with three digits."""


def motions_in(message, names):
    """The motions that a message names: "knee 1, hip -0.5; toe 1". Each begins with what moves most, by one."""
    found = []
    for text in message.split(": ")[-1].split(". ")[0].split("; "):
        parts = [part.rsplit(" ", 1) for part in text.split(", ")]
        sizes = [abs(float(amount)) for _, amount in parts]
        assert sizes == sorted(sizes, reverse=True)
        assert sizes[0] == 1
        found.append([float(dict(parts).get(name, 0.0)) for name in names])
    return np.array(found)


def test_motions_that_nothing_resists_are_named_with_their_signs():
    """Those of the null space of J: of all its motions where no body has mass, of those with motors at rest there."""
    model = four_bar()
    nothing = tuple(Body(body.name, 0.0, np.zeros(3), np.zeros((3, 3))) for body in model.bodies)
    q, _ = model.random_state(np.random.default_rng(1))
    with pytest.raises(graphdyn.SingularMassMatrix, match="can move without inertia") as caught:
        graphdyn.joint_accelerations(replace(model, bodies=nothing), q, 0 * q, 0 * q)
    (named,) = motions_in(str(caught.value), model.joint_names)
    (closed,) = null_space(model.loops.jacobian(model.loops.links(q))).T
    np.testing.assert_allclose(named / named[0], closed / closed[0], atol=PRINTED * np.abs(1 / named[0]))
    assert (named < 0).any()
    assert (named > 0).any()
    two = n_four_bar(2)
    two = replace(two, chords=two.chords[:1])
    q = graphdyn.assemble(two, [1.2, 0.9, 1.4, -1.3, -1.0])
    with pytest.raises(InvalidInput, match=r"motors at b1 leave 2 of 3 motions free") as caught:
        graphdyn.inverse_dynamics(two, q, 0 * q, 0 * q, actuated=["b1"])
    named = motions_in(str(caught.value), two.joint_names)
    assert np.linalg.matrix_rank(named, tol=10 * PRINTED) == 2
    assert np.abs(named @ two.loops.jacobian(two.loops.links(q)).T).max() < 5 * PRINTED
    assert np.abs(named[:, two.joint_names.index("b1")]).max() < PRINTED


def test_random_states_keep_away_from_singular_poses(monkeypatch):
    """N-four-bars are singular at q = 0, where walks to random states begin and half of them stay."""
    model = n_four_bar(2)
    q, v = model.random_state(np.random.default_rng(0), 10)
    graphdyn.joint_accelerations(model, q, v, 0 * q)  # refuses velocities that open a loop
    monkeypatch.setattr(random_states, "CLOSING_STARTS", 1)
    with pytest.raises(InconsistentState, match=r"'n-four-bar': \d of 10 random states did not close; .*assemble"):
        model.random_state(np.random.default_rng(0), 10)


def test_refusals():
    model = four_bar()
    q, v = model.random_state(np.random.default_rng(1), 3)
    still = np.zeros_like(q)
    opened = q.copy()
    opened[1, 0] += 1e-3
    for method in METHODS:
        message = r"'four-bar': the loop of chord 'closing' is open by [-.e\d]+ m or rad"
        with pytest.raises(InconsistentState, match=message + " in row 1; "):
            graphdyn.forward_dynamics(model, opened, still, still, method=method)
        with pytest.raises(InconsistentState, match=message + "; "):
            graphdyn.forward_dynamics(model, opened[1], still[0], still[0], method=method)
    spoilt = np.concatenate([[np.full(3, np.nan)], opened])  # samples that nobody wants looked at
    with pytest.raises(InconsistentState, match=r"the loop of chord 'closing' is open by .* in row 2; "):
        graphdyn.forward_dynamics(model, spoilt, 0 * spoilt, 0 * spoilt, method="recursive", check=False)
    with pytest.raises(InconsistentState, match=r"the velocity opens the loop of chord 'closing' in row 1 .*assemble"):
        graphdyn.forward_dynamics(model, q, v + 1, still)
    for method in ("projected", "recursive"):
        for verb in (graphdyn.inverse_dynamics, graphdyn.joint_torque_regressor):
            with pytest.raises(InconsistentState, match=r"the acceleration opens the loop"):
                verb(model, q, v, v + 1, method=method)
        with pytest.raises(InvalidInput, match=r"which joints have motors is not known"):
            graphdyn.gravity_torque(replace(model, actuated=None), q, method=method)
    with pytest.raises(InconsistentState, match=r"the loop of chord 'closing' is open"):
        graphdyn.kkt_system(model, opened[1], still[0], still[0])
    message = r"mass_matrix_inverse does not know the loops of robot 'four-bar'; joint_accelerations says what torques"
    for method in METHODS:
        with pytest.raises(InvalidInput, match=message):
            graphdyn.mass_matrix_inverse(model, q, method=method)
    with pytest.raises(InvalidInput, match=message):
        graphdyn.compile(model, "mass_matrix_inverse")
    message = r"power of robot 'four-bar', which has loops, has no compiled form; "
    with pytest.raises(InvalidInput, match=message + r"use method='projected'$"):
        graphdyn.power(model, q, still, still, method="recursive")
    with pytest.raises(InvalidInput, match=message + r"use method='projected' and omit out=$"):
        graphdyn.power(model, q, still, still, out=np.zeros_like(q))
    with pytest.raises(InvalidInput, match=message + r"call graphdyn\.power$"):
        graphdyn.compile(model, "power")
    with pytest.raises(InvalidInput, match=r"has no loops: all its reactions are determined"):
        graphdyn.analyze_loops(graphdyn.kr500(), np.zeros(6))
    with pytest.raises(InvalidInput, match=r"no free joint 'x' to hold; choose among a, b, c"):
        graphdyn.assemble(model, q, hold=["x"])
    with pytest.raises(InvalidInput, match=r"hold is the text 'a'; give a list of joint names"):
        graphdyn.assemble(model, q, hold="a")
    with pytest.raises(InvalidModel, match=r"'four-bar': actuated is the text 'abc'; give a list of joint names"):
        model.with_actuated("abc")
    with pytest.raises(InvalidInput, match=r"a is given without v"):
        graphdyn.assemble(model, q, a=still)
    with pytest.raises(InconsistentState, match=r"'closing' is open by 4.5 m .*None of 100 poses leads"):
        _ = four_bar(ground=9.0).closed_pose
    massless = replace(
        model, bodies=tuple(Body(body.name, 0.0, np.zeros(3), np.zeros((3, 3))) for body in model.bodies)
    )
    with pytest.raises(graphdyn.SingularMassMatrix, match=r"can move without inertia in row 0: .*b 1|a 1|c 1"):
        graphdyn.joint_accelerations(massless, q, still, still)
    with pytest.raises(
        graphdyn.SingularMassMatrix, match=r"system has rank \d+ although its constraints .* no inertia"
    ):
        graphdyn.kkt_system(massless, q[0], still[0], still[0]).solve()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "belt"}, "kind 'belt' is unknown; use one of hinge, ball, slide, weld, distance"),
        ({"body_j": 2}, "both ends are on body 2"),
        ({"body_j": 7}, "there is no body 7"),
        ({"axis": np.zeros(3)}, "axis is zero"),
        ({"placement_i": None}, "placement_i is of type NoneType"),
        ({"length": 1.0}, "only a distance has one"),
        ({"kind": "distance"}, "a distance needs its length"),
        ({"kind": "distance", "length": -1.0}, "length is -1.0 m; give a positive one"),
        ({"kind": "distance", "length": 0.0}, "length is 0.0 m; give a positive one, or use a ball"),
    ],
)
def test_refused_chords(change, message):
    model = four_bar()
    with pytest.raises(InvalidModel, match=message):
        replace(model, chords=(replace(model.chords[0], **change),))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"actuated": ("a", "a")}, "joint 'a' is actuated more than once"),
        ({"actuated": ("x",)}, "there is no joint 'x' to actuate; choose among a, b, c"),
        ({"chords": ()}, "every joint of a tree is"),
        ({"chords": four_bar().chords * 2}, "chord name 'closing' is used more than once"),
        ({"chords": (replace(four_bar().chords[0], name="b"),)}, "chord name 'b' is used more than once"),
    ],
)
def test_refused_models(change, message):
    with pytest.raises(InvalidModel, match=message):
        replace(four_bar(), **change)


def test_joints_that_follow_a_coupling_several_turns_away_are_read():
    """Driven by 3 at 2.5 rad, a joint is at 7.5 rad, read as 1.217: by a full turn off, and no further."""
    model = replace(four_bar(), chords=(), couplings=(graphdyn.Coupling("c", {"a": 3.0}),), actuated=None)
    u, rate = np.array([2.5, 0.4]), np.array([1.0, -2.0])
    q, v = graphdyn.joint_state(model, graphdyn.maximal_state(model, u, rate))
    np.testing.assert_allclose(q, u, atol=1e-14)
    np.testing.assert_allclose(v, rate, atol=1e-14)
    elsewhere = graphdyn.maximal_state(model.uncoupled, [2.5, 0.4, 7.6], [1.0, -2.0, 3.0])
    with pytest.raises(InconsistentState, match=r"position of joint 'c' is off its coupling by 0\.1 rad"):
        graphdyn.joint_state(model, elsewhere)


RATIO, GEAR_INERTIA = -2.0, 0.3


def geared():
    """A four-bar whose crank turns a disk beside it."""
    model = four_bar()
    disk = Body("disk", 1.0, np.zeros(3), GEAR_INERTIA * np.eye(3))
    return replace(
        model,
        bodies=(*model.bodies, disk),
        joints=(*model.joints, Joint("d", "revolute", 0, at(-1.0), np.array([0, 0, 1.0]))),
        couplings=(graphdyn.Coupling("d", {"a": RATIO}, 0.1),),
    )


@pytest.fixture(scope="module")
def geared_motion():
    """States that it moves through under no torque."""
    q, v = geared().random_state(np.random.default_rng(3), 12)
    return {"q": q, "v": v, "a": graphdyn.joint_accelerations(geared(), q, v, 0 * q), "tau": 0 * q}


def test_loops_and_couplings_in_one_robot():
    """The disk is felt at the crank as its inertia times the square of the ratio."""
    plain, model = four_bar(), geared()
    q, v = plain.random_state(np.random.default_rng(3), 12)
    a = graphdyn.joint_accelerations(plain, q, v, 0 * q)
    q, v, a = graphdyn.assemble(plain, q, v, a + 1.0)
    added = GEAR_INERTIA * RATIO**2 * a[:, 0]
    for method in ("auto", "projected", "dense"):
        tau = graphdyn.inverse_dynamics(model, q, v, a, method=method).tau
        wanted = graphdyn.inverse_dynamics(plain, q, v, a).tau + np.stack([added, 0 * added, 0 * added], axis=-1)
        assert relative_error(tau, wanted) < ROUNDING, method
        assert relative_error(graphdyn.joint_accelerations(model, q, v, tau, method=method), a) < 1e-12, method


@pytest.mark.parametrize("name", VERBS)
def test_no_verb_compiles_loops_and_couplings_as_something_else(name, geared_motion):
    """Where there is no compiled form it says so, and the other methods answer alike."""
    row = VERBS[name]
    verb = partial(getattr(graphdyn, name), geared(), *(geared_motion[argument] for argument in row.inputs))
    verb = partial(verb, frame="rocker", reference="world") if row.of_frame else verb
    if row.remedy is not None:
        with pytest.raises(InvalidInput, match=r"does not know the loops of robot 'four-bar'"):
            verb()
        return
    wanted = verb(method="projected")
    if row.closed is not None:
        message = f"{name} of robot 'four-bar', which has loops and couplings, has no compiled form"
        with pytest.raises(InvalidInput, match=message):
            verb(method="recursive")
    for method in ("auto",) if row.closed else ("auto", "recursive"):
        found = verb(method=method)
        pairs = [(found, wanted)] if isinstance(found, np.ndarray) else zip(parts(found), parts(wanted), strict=True)
        for ours, theirs in pairs:
            np.testing.assert_allclose(ours, theirs, atol=1e-10 * np.nanmax(np.abs(theirs), initial=1.0))


def parts(answer):
    return answer if isinstance(answer, tuple) else vars(answer).values()


@pytest.mark.parametrize("ground_first", [False, True])
def test_a_chord_on_a_ground_that_accelerates(ground_first):
    """Along a line, as in a field of gravity that is less by as much."""
    there, end = at(2.2, 0, 0), at(1.5, 0, 0)
    chord = Chord("end", "hinge", 0, there, 3, end) if ground_first else Chord("end", "hinge", 3, end, 0, there)
    joints = (*four_bar().joints[:2], Joint("c", "revolute", 2, at(2, 0, 0), np.array([0, 0, 1.0])))
    model = replace(four_bar(), joints=joints, chords=(chord,))
    q, v = graphdyn.assemble(model, [0.7, -0.3, -2.0], [1.0, 0.5, -0.3])
    tau, acceleration = np.array([1.0, 2.0, -0.5]), np.array([1.0, -2.0, 0.5])
    base = graphdyn.BaseMotion(acceleration=[*acceleration, 0, 0, 0])
    wanted = graphdyn.forward_dynamics(model.with_gravity(model.gravity - acceleration), q, v, tau, method="dense")
    for method in METHODS:
        found = graphdyn.forward_dynamics(model, q, v, tau, base=base, method=method)
        assert relative_error(found.a, wanted.a) < 1e-12, method
        compare(found, wanted, 1e-11)
