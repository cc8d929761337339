"""What a search for exciting motions found, and what it is compared with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.recordings import Recording
from graphdyn.excitation import (
    Course,
    ExcitationPlan,
    ExcitationProblem,
    JointMotion,
    Usage,
    excitation_plan,
    random_trajectory,
    sample_times,
)
from graphdyn.identification.one_thread import one_thread
from graphdyn.layout import Array

CHECK_RATE = 1000.0
"""[Hz] At which limits are checked."""

PIECE = 1000
"""Rows of a recording whose regressor is in memory at once."""


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """course: the motion; usages: of every limit, at CHECK_RATE; seed: that found it, None for one that was given"""

    course: Course
    usages: tuple[Usage, ...]
    seed: int | None = None


@dataclass(frozen=True, eq=False)
class Excited:
    """Motions and what they promise.

    problem: of the first motion; the others know those before them
    motions: in the order in which they are to be made
    plan: of recordings of all of them
    best_random, median_random: plans of as many random motions, each the best of `random` or their median; None
        without
    recorded: plan of a recording, for as many samples as the motions have; None without
    failures: why seeds found nothing
    """

    robot: str
    locked: Mapping[str, float]
    problem: ExcitationProblem
    noise_words: str
    criterion: str
    motions: tuple[PlannedMotion, ...]
    plan: ExcitationPlan
    random: int = 0
    best_random: ExcitationPlan | None = None
    median_random: ExcitationPlan | None = None
    recorded: ExcitationPlan | None = None
    failures: tuple[str, ...] = ()

    @property
    def violated(self) -> list[Usage]:
        """The limits that a motion does not keep."""
        return [usage for motion in self.motions for usage in motion.usages if usage.used > 1]


def planned(problem: ExcitationProblem, course: Course, seed: int | None = None) -> PlannedMotion:
    motion = course.motion(sample_times(course.duration, CHECK_RATE))
    return PlannedMotion(course, tuple(problem.usages(motion)), seed)


def random_plans(problem: ExcitationProblem, motions: int, count: int) -> tuple[ExcitationPlan, ExcitationPlan]:
    """Plans of as many random motions as asked for: each time the best of count, and the median, by the criterion."""
    with one_thread():
        first = _from_best_to_worst(problem, count, 0)
        chosen = [first[0], first[count // 2]]
        for number in range(1, motions):
            for k, place in enumerate((0, count // 2)):
                chosen[k] = _from_best_to_worst(replace(problem, known=chosen[k]), count, number)[place]
    return excitation_plan(problem.torque_model, chosen[0]), excitation_plan(problem.torque_model, chosen[1])


def _from_best_to_worst(problem: ExcitationProblem, count: int, seed: int) -> list[Array]:
    """Information matrices of random motions, with what is known."""
    rng = np.random.default_rng([seed, 2])
    totals = []
    for _ in range(count):
        course = random_trajectory(problem.torque_model.model, problem.limits, problem.watched, problem.basis, rng)
        totals.append(problem.total_information(course))
    return sorted(totals, key=lambda total: problem.criterion(total)[0])


def recorded_information(problem: ExcitationProblem, recordings: Sequence[Recording]) -> tuple[Array, int]:
    """F of recordings that have v and a, and their number of rows."""
    total, rows = np.zeros((len(problem.information.independent),) * 2), 0
    for recording in recordings:
        q, v, a = (recording.channel(name) for name in "qva")
        for first in range(0, len(q), PIECE):
            piece = slice(first, first + PIECE)
            motion = JointMotion(q[piece], v[piece], a[piece], np.zeros_like(q[piece]))
            total += problem.information.matrix(motion, len(motion.q))
        rows += len(q)
    return total, rows
