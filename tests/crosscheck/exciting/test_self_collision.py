"""Links that must not hit each other: spheres around them, pairs, meshes, and `graphdyn excite` with them."""

import json
import re
from functools import cache
from itertools import pairwise, product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from urdf_text import inertial, joint, robot_text

import urdf
from crosscheck.commands.program import own_process
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.exciting import self_collision as pairing
from crosscheck.exciting.excited import random_plans
from crosscheck.exciting.mesh_contacts import LinkMesh, MeshContacts, link_meshes
from crosscheck.exciting.motion_formats.krl import AxisSettings
from crosscheck.exciting.motion_formats.motion_file import read_motion
from crosscheck.exciting.self_collision import Hit, collision_free, self_collision
from crosscheck.exciting.sphere_cover import sphere_cover
from crosscheck.exciting.srdf import disabled_pairs
from graphdyn import InvalidInput
from graphdyn.excitation import (
    Clearance,
    ExcitationProblem,
    FourierBasis,
    MotionLimits,
    NoFeasibleMotion,
    OptimizedMotion,
    Poses,
    Sphere,
    TabulatedCourse,
    excitation_plan,
    random_trajectory,
)
from graphdyn.excitation.constraints import clearance_signal, smallest_distances
from graphdyn.excitation.trajectory import smooth_maximum, smooth_slope
from graphdyn.identification import TorqueModel
from graphdyn.identification.terms import RigidBodies

DIFFERENCES = 1e-6
"""Central differences with steps of 1e-6 m or rad against exact slopes, relative to the largest: measured 1e-8."""

ROUNDING = 1e-12

FOLDED = np.array([[0, 2.9, 3.0]])
"""Where the third bar is in the first."""

CELL = 0.5
"""Parts of the excess by which spheres may stand out more: two cells, to which depths are rounded."""

ENDS = '<axis xyz="0 {y} {z}"/><limit lower="{low}" upper="3" velocity="2" effort="200"/><origin xyz="{x} 0 0"/>'


def bar(name, length, extra=""):
    """A link along x, as a box."""
    shape = f'<geometry><box size="{length} 0.05 0.05"/></geometry><origin xyz="{length / 2} 0 0"/>'
    return f'<link name="{name}">{inertial(1.0, f"{length / 2} 0 0")}<collision>{shape}</collision>{extra}</link>'


@pytest.fixture(scope="module")
def folding_arm(tmp_path_factory):
    """Three bars, the third of which can fold back into the first; a plate on the last, and a shape that is missing."""
    path = tmp_path_factory.mktemp("arm") / "folding.urdf"
    lost = '<link name="lost"><visual><geometry><mesh filename="lost.stl"/></geometry></visual></link>'
    plate = '<link name="plate"><visual><geometry><box size="0.01 0.2 0.2"/></geometry></visual></link>'
    moving = [(0, 0, 1, -3), (0.4, 1, 0, -3), (0.35, 1, 0, -3)]
    joints = [
        joint(f"j{k}", parent, child, more=ENDS.format(x=x, y=y, z=z, low=low))
        for k, ((x, y, z, low), parent, child) in enumerate(
            zip(moving, ("base", "a", "b"), ("a", "b", "c"), strict=True)
        )
    ]
    joints.append(joint("fixed", "c", "plate", "fixed", '<origin xyz="0.3 0 0"/>'))
    joints.append(joint("other", "base", "lost", "fixed"))
    links = ['<link name="base"/>', bar("a", 0.35), bar("b", 0.3), bar("c", 0.3), plate, lost]
    path.write_text(robot_text("folding", *links, *joints), encoding="utf-8")
    return path


COVERS = {}


def remembered_cover(triangles, excess):
    """Of shapes that several tests have, computed once."""
    key = triangles.tobytes(), excess
    if key not in COVERS:
        COVERS[key] = sphere_cover(triangles, excess)
    return COVERS[key]


@pytest.fixture(autouse=True)
def few_poses(monkeypatch):
    """Enough for three pairs, and faster."""
    monkeypatch.setattr(pairing, "PAIR_POSES", 100)
    monkeypatch.setattr(pairing, "sphere_cover", remembered_cover)


@cache
def known_of(path, margin=0.0, **more):
    model = urdf.load(path)
    return self_collision(model, *link_meshes(str(path), model, urdf.Reading()), margin, **more)


def problem_of(model, harmonics=2):
    limits = MotionLimits.of_model(model, acceleration=10.0)
    return ExcitationProblem(TorqueModel(model, (RigidBodies(),)), limits, FourierBasis(4.0, harmonics), 1.0, 50.0)


def test_spheres_contain_every_triangle_and_stand_out_by_little():
    """Random points of the surface of a bent bar lie in spheres; random points of the spheres lie little outside."""
    rng, excess = np.random.default_rng(0), 0.03
    boxes = [((0.0, 0.0, 0.0), (0.4, 0.1, 0.1)), ((0.3, 0.0, 0.0), (0.4, 0.1, 0.3))]
    triangles = np.concatenate([box_triangles(*box) for box in boxes])
    centers, radii = sphere_cover(triangles, excess)
    weights = rng.dirichlet(np.ones(3), size=(len(triangles), 200))
    points = np.concatenate([np.einsum("mpk,mkx->mpx", weights, triangles).reshape(-1, 3), triangles.reshape(-1, 3)])
    assert np.all((np.linalg.norm(points[:, None] - centers, axis=-1) <= radii).any(axis=1))
    rays = rng.normal(size=(100, 3))
    ends = (centers[:, None] + radii[:, None, None] * rays / np.linalg.norm(rays, axis=1)[:, None]).reshape(-1, 3)
    outside = [np.linalg.norm(np.maximum(0, np.maximum(low - ends, ends - high)), axis=1) for low, high in boxes]
    assert np.min(outside, axis=0).max() < (1 + CELL) * excess
    assert len(centers) < 40


class Placed:
    """Poses of bodies that are given."""

    def __init__(self, of_body):
        self.of_body = of_body.__getitem__
        self._count = len(of_body[1][1])

    def __len__(self):
        return self._count


def test_every_triangle_counts():
    """A triangle 0.05 m above each of three in turn, both links turned and moved: nearer than 0.06 m, not than 0.04."""
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    three = np.concatenate([flat + np.array([10 * k, 0, 0]) for k in range(3)])
    meshes = LinkMesh("a", 1, three, np.arange(9).reshape(3, 3)), LinkMesh("b", 2, flat, np.arange(3)[None])
    turn = Rotation.from_euler("xyz", [0.3, -0.5, 0.9]).as_matrix()
    above = np.array([[10 * k, 0, 0.05] for k in (0, 1, 2, 0.5)])
    moved = np.array([0.2, -0.3, 0.4])
    turns = np.tile(turn, (4, 1, 1))
    poses = Placed({1: (turns, np.tile(moved, (4, 1))), 2: (turns, moved + above @ turn.T)})
    found = MeshContacts(meshes).touching([(0, 1), (1, 0), (0, 1)], poses, [0.06, 0.06, 0.04])
    assert found.tolist() == [[True, True, False]] * 3 + [[False] * 3]


def box_triangles(low, high):
    corners = np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners[[triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]]


def test_shapes_are_placed_in_their_link(tmp_path):
    """Two boxes of one link, one of them turned about all three axes: corners as SciPy turns them."""
    size, xyz, rpy = np.array([0.4, 0.1, 0.2]), [0.1, -0.2, 0.3], [0.3, -0.5, 0.9]
    places = f'<origin xyz="{" ".join(map(str, xyz))}" rpy="{" ".join(map(str, rpy))}"/>', "<origin/>"
    boxes = [
        f'<collision>{place}<geometry><box size="{" ".join(map(str, size))}"/></geometry></collision>'
        for place in places
    ]
    moving = joint("j", "base", "a", more=ENDS.format(x=0, y=0, z=1, low=-3))
    link = f'<link name="a">{inertial(1.0)}{"".join(boxes)}</link>'
    path = tmp_path / "turned.urdf"
    path.write_text(robot_text("turned", '<link name="base"/>', link, moving), encoding="utf-8")
    ((mesh,), _) = link_meshes(str(path), urdf.load(path), urdf.Reading())
    corners = np.array([*product(*([-x / 2, x / 2] for x in size))])
    expected = np.concatenate([Rotation.from_euler("xyz", rpy).apply(corners) + xyz, corners])
    apart = np.linalg.norm(mesh.vertices[:, None] - expected, axis=-1)
    assert apart.min(axis=0).max() < ROUNDING
    assert apart.min(axis=1).max() < ROUNDING


def test_slopes_of_clearances(folding_arm):
    """Of the smooth smallest distance by the positions, against differences; and against all pairs of spheres."""
    model = urdf.load(folding_arm)
    rng = np.random.default_rng(1)
    spheres = {body: tuple(Sphere(body, x, 0.02) for x in rng.normal(0, 0.2, (7, 3))) for body in (0, 1, 3)}
    q, step = rng.normal(size=(6, 3)), 1e-6
    for one, other in ((1, 3), (3, 1), (0, 3)):
        clearance = Clearance("x", spheres[one], spheres[other], -0.1)
        signal = clearance_signal(clearance, Poses(model, q))
        poses = Poses(model, q)
        apart = poses.centers(spheres[one])[:, :, None] - poses.centers(spheres[other])[:, None]
        nearest = np.linalg.norm(apart, axis=-1).min(axis=(1, 2)) - 0.04
        assert np.abs(smallest_distances(clearance, poses) - nearest).max() < ROUNDING
        assert signal.values.max() == pytest.approx(1 - (nearest.min() + 0.1) / 0.01, abs=1e-9)
        slope = smooth_slope(signal, [np.eye(6)], 3.0)
        direction = rng.normal(size=q.shape)
        high, low = (
            smooth_maximum(clearance_signal(clearance, Poses(model, q + sign * step * direction)), 3.0)
            for sign in (1, -1)
        )
        assert abs((high - low) / (2 * step) - np.sum(slope.T * direction)) < DIFFERENCES * np.abs(slope).max()


def test_pairs(folding_arm, tmp_path):
    """Links that a joint connects are left out, and those that an SRDF file names; what cannot be read is told."""
    known = known_of(folding_arm)
    assert {known.name(pair) for pair in known.pairs} == {"a - c", "a - plate", "b - plate"}
    assert known.missing == {"lost": "lost.stl: line 7: no such file"}
    assert {"a - c", "a - plate"} <= set(known.clearances)

    path = tmp_path / "folding.srdf"
    path.write_text(
        '<robot name="x"><disable_collisions link1="c" link2="a" reason="Never"/><disable_default_collisions '
        'link="plate"/><enable_collisions link1="plate" link2="a"/></robot>',
        encoding="utf-8",
    )
    told = known_of(folding_arm, is_disabled=disabled_pairs(path, ["a", "b", "c", "plate"]))
    assert {told.name(pair) for pair in told.pairs} == {"a - plate"}
    assert set(told.disabled) == {"a - c", "b - plate"}


def test_links_that_are_always_nearer(folding_arm):
    """A margin that no pose keeps: such pairs are named, and checked for contact all the same."""
    known = known_of(folding_arm, margin=2.0)
    assert set(known.near) == {"a - c", "a - plate", "b - plate"}
    assert known.touching == ()
    assert known.hits(np.zeros((1, 3))) == ()
    assert "a - c" in {hit.name for hit in known.hits(FOLDED)}
    assert {clearance.distance <= 0.0 for clearance in known.clearances.values()} == {True}


def test_links_that_always_collide(tmp_path):
    """A bar that turns inside a longer one, two joints away: named, and left out."""
    path = tmp_path / "inside.urdf"
    moving = '<axis xyz="1 0 0"/><limit lower="-3" upper="3" velocity="2" effort="200"/>'
    joints = [joint("j0", "a", "b", more=moving), joint("j1", "b", "c", more=moving)]
    bare = f'<link name="b">{inertial(1.0)}</link>'
    path.write_text(robot_text("inside", bar("a", 0.35), bare, bar("c", 0.35), *joints), encoding="utf-8")
    known = known_of(path)
    assert (known.touching, known.pairs, known.margins) == (("a - c",), (), ())
    assert known.hits(np.zeros((2, 2))) == ()


def test_hits_on_the_meshes(folding_arm):
    """Folded by 174°, the third bar is in the first; unfolded, and at a right angle, nothing collides."""
    known = known_of(folding_arm)
    q = np.array([[0, 0, 0], [0, 0, 1.57], [0, 2.9, 3.0], [0, 2.9, 3.0]])
    found = {hit.name: hit for hit in known.hits(q)}
    assert found["a - c"] == Hit("a - c", 2, 2)
    widened = known.tightened(q[2:3])
    assert widened.clearances["a - c"].distance <= known.margin


def test_tightened_by_the_farthest_that_collide(folding_arm):
    """Of four poses three collide: two millimeters more than the largest distance of spheres in any of them."""
    known, q = known_of(folding_arm), np.array([[0, 2.9, 3.0], [0, 2.8, 2.9], [0, 2.95, 2.6], [0, 0, 0]])
    assert {hit.name: hit.poses for hit in known.hits(q)}["a - c"] == 3
    widened = known.tightened(q).clearances["a - c"]
    apart = smallest_distances(widened, Poses(known.model, q))[:3]
    assert np.ptp(apart) > 1e-3
    assert widened.distance == pytest.approx(min(apart.max() + pairing.CLEARANCE_STEP, known.margin))


@pytest.mark.parametrize(
    ("colliding", "forbidden", "distance"),
    [(3, 0, 0.5), (3, 1, 0.5), (3, 30, 0.02), (0, 30, None), (3, 3, 0.5)],
    ids=["none", "one", "many", "many, for nothing", "as many as collide"],
)
def test_spheres_may_forbid_few_poses_that_are_free(colliding, forbidden, distance, monkeypatch):
    """Of a hundred poses that are free; those that collide are meant to be forbidden."""
    one, other = (Sphere(body, np.zeros(3), 0.1) for body in (1, 2))
    apart = np.concatenate([np.linspace(-0.1, 0.02, colliding), np.full(forbidden, 0.3), np.full(100 - forbidden, 0.7)])
    monkeypatch.setattr(pairing, "smallest_distances", lambda clearance, poses: apart)
    touching = np.arange(len(apart)) < colliding
    kept = pairing._kept_clearance(Clearance("x", (one,), (other,), 0.5), None, touching)
    assert (kept and kept.distance) == distance


def test_motions_that_still_collide(folding_arm, monkeypatch):
    """Each search with more distance; at the end an error that says so."""
    known, problem = known_of(folding_arm), problem_of(urdf.load(folding_arm))
    folded = type("Folded", (), {"motion": lambda self, times: type("Q", (), {"q": np.array([[0, 2.9, 3.0]])})})()
    starts = []

    def not_optimized(tried, seed, start=None):
        starts.append([clearance.distance for clearance in tried.limits.clearances])
        return type("Found", (), {"trajectory": folded})

    monkeypatch.setattr(pairing, "optimized", not_optimized)
    with pytest.raises(
        NoFeasibleMotion,
        match=r"no motion without collisions was found from seed 3: in 6 searches with growing distances, .*a - c.* "
        r"still collide; give limits of position that keep them apart",
    ):
        collision_free(problem, known, 3)
    assert len(starts) == 6


def test_searches_that_end_without_a_motion(folding_arm, monkeypatch):
    """From a motion that collides none is found: random motions are started from again, with the grown distances."""
    known, problem = known_of(folding_arm), problem_of(urdf.load(folding_arm))
    folded, unfolded = (
        OptimizedMotion(TabulatedCourse(np.linspace(0, 4, 7), np.tile(q, (7, 1))), (), 0.0, 3, 1)
        for q in ([0, 2.9, 3.0], [0, 0, 0])
    )
    tried = []

    def not_optimized(at, seed, start=None):
        tried.append((start, [clearance.distance for clearance in at.limits.clearances]))
        if start is not None:
            raise NoFeasibleMotion("none")
        return folded if len(tried) == 1 else unfolded

    monkeypatch.setattr(pairing, "optimized", not_optimized)
    assert collision_free(problem, known, 3) is unfolded
    assert [start for start, _ in tried] == [None, folded.trajectory, None]
    assert tried[1][1] == tried[2][1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot", r"a\.srdf: not well-formed XML: .*; give an SRDF file"),
        ("<model/>", r"a\.srdf: the root element is <model>, not <robot>; give an SRDF file"),
        ('<robot>\n<disable_collisions link1="a"/></robot>', r"a\.srdf, line 2: <disable_collisions> has no link2"),
        (
            '<robot><disable_collisions link1="x" link2="y"/></robot>',
            r"a\.srdf: names none of the robot's links; give the SRDF of this robot",
        ),
        (" " * 10_000_001, r"a\.srdf: is larger than 10 MB; give an SRDF file"),
    ],
)
def test_faulty_srdf(text, message, tmp_path):
    path = tmp_path / "a.srdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidInput, match=message):
        disabled_pairs(path, ["a", "b"])


def test_faulty_clearance():
    with pytest.raises(InvalidInput, match=r"'x' has spheres of the bodies \{1, 2\} and \{\} and the distance 0"):
        Clearance("x", (Sphere(1, np.zeros(3)), Sphere(2, np.zeros(3))), ())


def test_the_program(program, folding_arm, tmp_path, monkeypatch):
    """A motion without collisions, with a term of one's own and the moving arm on the page; and one that collides."""
    monkeypatch.setattr(own_process, "tell", lambda _: None)  # the term runs in this process
    file, page, term = tmp_path / "r.json", tmp_path / "r.html", tmp_path / "own.py"
    term.write_text("from graphdyn.identification.terms import Offset as Own\n", encoding="utf-8")
    few = ("--duration", 4, "--harmonics", 2, "--seeds", 1, "--jobs", 1, "--rate", 50, "--random", 0)
    own = ("--terms", "none", "--term", f"{term}:Own")
    done = program(
        "excite", "--robot", folding_arm, *few, *own, "--clearance", 0.01, "--json", file, "--html", page, "--3d"
    )  # fmt: skip
    assert done.code == AGREED, done.err
    record = json.loads(file.read_text(encoding="utf-8"))
    assert record["motions"][0]["collisions"] == []
    kinds = {limit["kind"] for limit in record["motions"][0]["limits"]}
    assert kinds == {
        "position",
        "velocity",
        "acceleration",
        "torque",
    }  # distances are judged on the meshes, not on the spheres of the search
    assert (record["collisions"]["margin"], len(record["collisions"]["checked"])) == (0.01, 3)
    assert [row["unit"] for row in record["parameters"]].count("N m") == 3
    shown = page.read_text(encoding="utf-8")
    assert "as planned" in shown
    assert "none nearer than 10 mm on the meshes (4 links, 3 pairs, 4001 poses at 1 kHz)" in shown
    assert "links without shapes pass unchecked: lost" in shown
    assert "Not checked, because their shapes cannot be read: lost (lost.stl: " in shown

    folded = motion_file(tmp_path, [0, 2.9, 3.0])
    done = program("excite", "--robot", folding_arm, "--motion", folded, "--random", 0, "--json", file)
    assert done.code == DISAGREED, done.err
    assert "LINKS COLLIDE" in done.out
    (hit,) = [hit for hit in json.loads(file.read_text())["motions"][0]["collisions"] if hit["links"] == "a - c"]
    known = known_of(folding_arm)
    with pytest.warns(UserWarning, match="all-zero-channel"):
        course = read_motion(folded, urdf.load(folding_arm), AxisSettings())
    instants = np.array([hit["first"] - 1e-3, hit["first"]])
    before, first = ({one.name for one in known.hits(course.motion(instants[k : k + 1]).q)} for k in (0, 1))
    assert "a - c" in first - before
    assert re.search(rf"a - c +│ +{hit['poses']} +│ +{hit['first']:.3f} ", done.out)
    done = program("excite", "--robot", folding_arm, "--motion", folded, "--random", 0, "--no-collisions")
    assert done.code == AGREED, done.err
    assert "not looked at (--no-collisions)" in done.out

    near = program("excite", "--robot", folding_arm, "--motion", folded, "--random", 0, "--clearance", 0.01)
    assert near.code == DISAGREED, near.err
    assert "LINKS COME TOO NEAR" in near.out
    assert "nearer than 10 mm in" in near.out

    assert program("excite", "--robot", folding_arm, "--3d").code == BAD_INPUT
    refused = program("excite", "--robot", folding_arm, "--no-collisions", "--clearance", 0.01)
    assert refused.code == BAD_INPUT
    assert "leave out --clearance and --srdf" in refused.err
    assert program("excite", "--robot", folding_arm, "--clearance", "inf").code == BAD_INPUT


def motion_file(folder, far):
    """From zero to the positions far."""
    times = np.linspace(0, 4, 81)
    rows = np.column_stack([times, np.sin(times * np.pi / 8)[:, None] ** 2 * far]).tolist()
    names = ",".join(["time", *(f"q_j{k}" for k in range(len(far)))])
    path = folder / "motion.csv"
    path.write_text("\n".join([names, *(",".join(map(repr, row)) for row in rows)]), encoding="utf-8")
    return path


def test_best_and_median_of_random_motions(folding_arm):
    """Of five, the one with the smallest value of the criterion, and the third."""
    problem = problem_of(urdf.load(folding_arm))
    model, rng = problem.torque_model.model, np.random.default_rng([0, 2])
    courses = [random_trajectory(model, problem.limits, problem.checked_spheres, problem.basis, rng) for _ in range(5)]
    totals = [problem.total_information(course) for course in courses]
    order = sorted(totals, key=lambda total: problem.criterion(total)[0])
    best, median = random_plans(problem, 1, 5, None)
    for found, total in ((best, order[0]), (median, order[2])):
        expected = excitation_plan(problem.torque_model, total)
        assert found.sigma.tolist() == expected.sigma.tolist()
    rng, totals = np.random.default_rng([1, 2]), {}
    courses = [random_trajectory(model, problem.limits, problem.checked_spheres, problem.basis, rng) for _ in range(5)]
    for place, known in ((0, order[0]), (2, order[2])):  # a second motion adds to the first
        sums = [known + problem.total_information(course) for course in courses]
        totals[place] = sorted(sums, key=lambda total: problem.criterion(total)[0])[place]
    for found, total in zip(random_plans(problem, 2, 5, None), totals.values(), strict=True):
        expected = excitation_plan(problem.torque_model, total)
        np.testing.assert_allclose(found.sigma, expected.sigma, rtol=1e-9)


def test_links_without_shapes(program, tmp_path):
    """They are told in the report and the record, apart from those whose shapes cannot be read."""
    path, file, names = tmp_path / "bare.urdf", tmp_path / "r.json", ("b", "c", "d", "e", "f")
    links = [f'<link name="{name}">{inertial(1.0, "0.1 0 0")}</link>' for name in names]
    joints = [
        joint(f"j{k}", parent, child, more=ENDS.format(x=0.4, y=1, z=0, low=-3))
        for k, (parent, child) in enumerate(pairwise(("a", *names)))
    ]
    path.write_text(robot_text("bare", bar("a", 0.35), *links, *joints), encoding="utf-8")
    motion = motion_file(tmp_path, [0.1] * 5)
    done = program("excite", "--robot", path, "--motion", motion, "--random", 0, "--json", file)
    assert done.code == AGREED, done.err
    told = " ".join(done.out.split())
    assert "links without shapes pass unchecked: b, c, d, and 2 others" in told
    assert "Not checked, because the file gives them no shapes: b, c, d, and 2 others" in told
    known = json.loads(file.read_text(encoding="utf-8"))["collisions"]
    assert (known["missing"], known["without_shapes"]) == ({}, [*names])
