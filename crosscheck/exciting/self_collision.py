"""Links of a robot that may hit each other: which pairs, how near they may come, and whether they do in a motion.

The search knows spheres that contain the meshes, with exact gradients; what it finds is judged on the meshes
themselves, at all times of the check. Where the spheres forbid too many poses in which the meshes are free, because two
links always pass each other closely, they may overlap as long as none of the random poses in which the meshes collide
is allowed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from crosscheck.exciting.mesh_contacts import LinkMesh, MeshContacts, Pair
from crosscheck.exciting.sphere_cover import sphere_cover
from graphdyn import RobotModel
from graphdyn.excitation import (
    CHECK_RATE,
    Clearance,
    ExcitationProblem,
    NoFeasibleMotion,
    OptimizedMotion,
    Poses,
    Sphere,
    Trajectory,
    optimized,
    sample_times,
    smallest_distances,
)
from graphdyn.layout import Array

PAIR_POSES = 1000
"""Random poses in which all pairs are looked at."""

MAX_SPHERE_EXCESS = 0.015
"""Spheres stand out of their link by this part of the length of the arm, at most."""

MAX_FORBIDDEN_SHARE = 0.1
"""Spheres that forbid more than this part of the poses in which the meshes are free may overlap."""

CLEARANCE_STEP = 0.002
"""[m] Distance, beyond that at a collision of the meshes, by which spheres must be apart in the next search."""


@dataclass(frozen=True)
class Hit:
    """Two links that collide.

    name: of both
    poses: in which they do, of those at 1 kHz; first: number of the first
    """

    name: str
    poses: int
    first: int


@dataclass(frozen=True, eq=False)
class SelfCollision:
    """What is known of a robot's collisions with itself.

    pairs: of meshes, that are checked
    margins: by which the meshes of each pair stay apart: margin, or 0 where they are always nearer [m]
    clearances: of the pairs that the search checks, by the name of the pair
    disabled: names of the pairs that are left out because the SRDF file disables them
    touching: names of the pairs that are left out because they collide in all of many random poses
    missing: why the shapes of a link cannot be read, by link; it passes unchecked
    margin: by which meshes are to stay apart [m]
    """

    model: RobotModel
    meshes: tuple[LinkMesh, ...]
    pairs: tuple[Pair, ...]
    margins: tuple[float, ...]
    spheres: tuple[tuple[Sphere, ...], ...]
    clearances: Mapping[str, Clearance]
    disabled: tuple[str, ...]
    touching: tuple[str, ...]
    missing: Mapping[str, str]
    margin: float

    @property
    def without_shapes(self) -> tuple[str, ...]:
        """Bodies to which the file gives no shapes; they pass unchecked."""
        seen = {mesh.body for mesh in self.meshes}
        names = enumerate(self.model.body_names, start=1)
        return tuple(name for body, name in names if body not in seen and name not in self.missing)

    @property
    def near(self) -> tuple[str, ...]:
        """Pairs that are nearer than the margin in all of many random poses: they must not touch."""
        both = zip(self.pairs, self.margins, strict=True)
        return tuple(self.name(pair) for pair, margin in both if margin < self.margin)

    def hits(self, q: Array) -> tuple[Hit, ...]:
        """The pairs that collide on the meshes at positions q (N, nv)."""
        touching = self._contacts.touching(self.pairs, Poses(self.model, q), self.margins)
        columns = np.flatnonzero(np.any(touching, axis=0)).tolist()
        return tuple(
            Hit(self.name(self.pairs[k]), int(touching[:, k].sum()), int(touching[:, k].argmax())) for k in columns
        )

    def with_limits(self, problem: ExcitationProblem) -> ExcitationProblem:
        """The problem with these clearances."""
        return replace(problem, limits=replace(problem.limits, clearances=tuple(self.clearances.values())))

    def tightened(self, q: Array) -> SelfCollision:
        """Spheres of the pairs that collide at q stay farther apart than they are there."""
        poses = Poses(self.model, q)
        touching = self._contacts.touching(self.pairs, poses, self.margins)
        tighter = dict(self.clearances)
        for k in np.flatnonzero(np.any(touching, axis=0)).tolist():
            clearance = self._clearance(self.pairs[k], self.margins[k])
            most = smallest_distances(clearance, poses)[touching[:, k]].max()
            tighter[clearance.name] = replace(clearance, distance=min(float(most) + CLEARANCE_STEP, self.margins[k]))
        return replace(self, clearances=tighter)

    def name(self, pair: Pair) -> str:
        return f"{self.meshes[pair[0]].link} - {self.meshes[pair[1]].link}"

    def _clearance(self, pair: Pair, distance: float) -> Clearance:
        return Clearance(self.name(pair), self.spheres[pair[0]], self.spheres[pair[1]], distance)

    @cached_property
    def _contacts(self) -> MeshContacts:
        return MeshContacts(self.meshes)

    def __getstate__(self) -> dict[str, object]:
        """The state without coal's trees."""
        return {name: value for name, value in vars(self).items() if name != "_contacts"}


def self_collision(
    model: RobotModel,
    meshes: Sequence[LinkMesh],
    missing: Mapping[str, str],
    margin: float,
    is_disabled: Callable[[str, str], bool] = lambda one, other: False,
) -> SelfCollision:
    """Which pairs of links are checked, and how near their spheres may come to each other."""
    all_pairs = [pair for pair in combinations(range(len(meshes)), 2) if not _joined(model, meshes, pair)]
    links = [mesh.link for mesh in meshes]
    disabled = [pair for pair in all_pairs if is_disabled(*(links[k] for k in pair))]
    pairs = [pair for pair in all_pairs if pair not in set(disabled)]
    spheres = tuple(_spheres(mesh, MAX_SPHERE_EXCESS * _reach(model, meshes)) for mesh in meshes)
    start = SelfCollision(model, tuple(meshes), tuple(pairs), (), spheres, {}, (), (), missing, margin)
    q, _ = model.random_state(np.random.default_rng(0), PAIR_POSES)
    poses = Poses(model, q)
    touching = start._contacts.touching(pairs, poses, [margin] * len(pairs))
    near = np.flatnonzero(np.all(touching, axis=0))
    touching[:, near] = start._contacts.touching([pairs[k] for k in near], poses, np.zeros(len(near)))
    margins = np.full(len(pairs), margin)
    margins[near] = 0.0
    always = np.all(touching, axis=0)
    checked_spheres = [
        clearance
        for k, pair in enumerate(pairs)
        if not always[k]
        and (clearance := _kept_clearance(start._clearance(pair, float(margins[k])), poses, touching[:, k]))
    ]
    return replace(
        start,
        pairs=tuple(pair for k, pair in enumerate(pairs) if not always[k]),
        margins=tuple(margins[~always].tolist()),
        clearances={clearance.name: clearance for clearance in checked_spheres},
        disabled=tuple(start.name(pair) for pair in disabled),
        touching=tuple(start.name(pair) for k, pair in enumerate(pairs) if always[k]),
    )


def _kept_clearance(clearance: Clearance, poses: Poses, touching: NDArray[np.bool_]) -> Clearance | None:
    """The clearance with the distance that the search keeps; None where no random pose collides and spheres would
    forbid too many."""
    distances = smallest_distances(clearance, poses)
    if np.mean(distances[~touching] < clearance.distance) <= MAX_FORBIDDEN_SHARE:
        return clearance
    return replace(clearance, distance=float(distances[touching].max())) if touching.any() else None


def _joined(model: RobotModel, meshes: Sequence[LinkMesh], pair: Collection[int]) -> bool:
    """Links of one body, and a body's own link with those of the body that carries it."""
    one, other = sorted((meshes[k] for k in pair), key=lambda mesh: mesh.body)
    if one.body == other.body:
        return True
    return model.joints[other.body - 1].inside == one.body and other.link == model.body_names[other.body - 1]


def _spheres(mesh: LinkMesh, excess: float) -> tuple[Sphere, ...]:
    centers, radii = sphere_cover(mesh.triangles, excess)
    return tuple(Sphere(mesh.body, center, float(radius)) for center, radius in zip(centers, radii, strict=True))


def _reach(model: RobotModel, meshes: Sequence[LinkMesh]) -> float:
    """Length from the ground to the farthest mesh, along the bodies [m]."""
    lengths = [0.0]
    for joint in model.joints:
        lengths.append(lengths[joint.inside] + float(np.linalg.norm(joint.placement.translation)))
    return max(lengths[mesh.body] + float(np.linalg.norm(mesh.vertices, axis=1).max()) for mesh in meshes)


MAX_SEARCHES = 6
"""Searches at most, each with more distance between the spheres of links that collided in the one before."""


def collision_free(
    problem: ExcitationProblem, robot: SelfCollision, seed: int, start: Trajectory | None = None
) -> OptimizedMotion:
    """The best motion that is found from one start, free of collisions on the meshes at CHECK_RATE.

    problem: without clearances; usages of the result are with those of the last search
    start: as in optimized

    Raises NoFeasibleMotion where none is found.
    """
    times = sample_times(problem.basis.duration, CHECK_RATE)
    found = optimized(robot.with_limits(problem), seed, start=start)
    for _ in range(MAX_SEARCHES - 1):
        q = found.trajectory.motion(times).q
        hits = robot.hits(q)
        if not hits:
            return found
        robot = robot.tightened(q)
        found = _again(robot.with_limits(problem), seed, found)
    hits = robot.hits(found.trajectory.motion(times).q)
    if not hits:
        return found
    raise NoFeasibleMotion(
        f"no motion without collisions was found from seed {seed}: in {MAX_SEARCHES} searches with growing distances, "
        f"{', '.join(hit.name for hit in hits)} still collide; give limits of position that keep them apart"
    )


def _again(problem: ExcitationProblem, seed: int, before: OptimizedMotion) -> OptimizedMotion:
    """Search again from the motion before, or, where that leads to none, from random motions as at first."""
    try:
        return optimized(problem, seed, start=before.trajectory)
    except NoFeasibleMotion:
        return optimized(problem, seed)
