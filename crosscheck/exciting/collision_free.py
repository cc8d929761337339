"""Exciting motions in which no meshes collide."""

from __future__ import annotations

from crosscheck.exciting.self_collision import SelfCollision
from graphdyn.excitation import (
    CHECK_RATE,
    ExcitationProblem,
    NoFeasibleMotion,
    OptimizedMotion,
    optimized,
    sample_times,
)

MAX_SEARCHES = 6
"""Searches at most, each with more distance between the spheres of links that collided in the one before."""


def collision_free(problem: ExcitationProblem, robot: SelfCollision, seed: int) -> OptimizedMotion:
    """The best motion that is found from one start, free of collisions on the meshes at CHECK_RATE.

    problem: without clearances; usages of the result are with those of the last search

    Raises NoFeasibleMotion where none is found.
    """
    times = sample_times(problem.basis.duration, CHECK_RATE)
    found = optimized(robot.with_limits(problem), seed)
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
