"""What a search for exciting motions found, and what it is compared with.

The noise of torque measurements where none is given.
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.exciting.encoder_noise import EncoderNoise, EncoderPlan
from crosscheck.exciting.self_collision import Hit, SelfCollision
from crosscheck.recordings import Recording
from crosscheck.reference.subject import OfReading
from graphdyn import RobotModel, joint_torques
from graphdyn.display import Displayed
from graphdyn.excitation import (
    CHECK_RATE,
    ExcitationPlan,
    ExcitationProblem,
    FiniteMotion,
    JointMotion,
    Usage,
    excitation_plan,
    random_trajectory,
    sample_times,
)
from graphdyn.identification import one_thread
from graphdyn.layout import Array
from graphdyn.model import unit_of
from urdf import Reading

log = logging.getLogger(__name__)

REGRESSOR_ROWS_AT_ONCE = 1000
"""Rows of a recording whose regressor is in memory at once."""


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """A motion and what it needs, at CHECK_RATE.

    usages: of every limit, over all its times
    hits: links that collide
    poses: of the robot that were looked at
    seed: from which it was found; None for a motion that was given
    """

    course: FiniteMotion
    usages: tuple[Usage, ...]
    hits: tuple[Hit, ...]
    poses: int
    seed: int | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Excited(OfReading, Displayed):
    """Motions and what they promise.

    robot: name or path, as given
    criterion: what was minimized
    problem: of the first motion; the others know those before them
    motions: in the order in which they are to be made
    plan: of recordings of all of them
    random: number of random motions that were compared
    best_random, median_random: plans of as many random motions, each the best of `random` or their median; None
        without
    recorded: plan of recordings of --against, for as many samples as the motions have; None without
    failures: why seeds found no motion
    collisions: what is known of the robot's collisions with itself; None where they were not looked at
    encoder: scatter and bias with noise of positions too, and that noise; None without
    """

    robot: str
    reading: Reading
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
    collisions: SelfCollision | None = None
    encoder: tuple[EncoderNoise, EncoderPlan] | None = None

    def summary(self) -> str:
        """The motions, and how well they determine the parameters."""
        verdicts = Counter(self.plan.verdicts)
        determined = ", ".join(f"{verdicts[word]} {word}" for word in ("well", "roughly", "not"))
        return (
            f"{len(self.motions)} exciting {'motion' if len(self.motions) == 1 else 'motions'} for {self.robot}, "
            f"{sum(motion.course.duration for motion in self.motions):g} s; of {len(self.plan.names)} base parameters "
            f"determined: {determined}"
        )

    @property
    def hits(self) -> list[Hit]:
        """Links that collide, in all motions."""
        return [hit for motion in self.motions for hit in motion.hits]

    @property
    def violated(self) -> list[Usage]:
        """The limits that a motion does not keep."""
        return [usage for motion in self.motions for usage in motion.usages if usage.used > 1]


def planned(
    problem: ExcitationProblem, course: FiniteMotion, collisions: SelfCollision | None, seed: int | None = None
) -> PlannedMotion:
    motion = course.motion(sample_times(course.duration, CHECK_RATE))
    hits = collisions.hits(motion.q) if collisions else ()
    return PlannedMotion(course, tuple(problem.usages(motion)), hits, len(motion.q), seed)


def random_plans(
    problem: ExcitationProblem, motions: int, count: int, collisions: SelfCollision | None
) -> tuple[ExcitationPlan, ExcitationPlan]:
    """Plans of as many random motions as asked for: each time the best of count, and the median, by the criterion.

    The best is the best without collisions. All keep the distances of the spheres; where meshes collide all the same in
    every one of them, the best stands for them.
    """
    if collisions is not None:
        problem = collisions.with_limits(problem)
    with one_thread():
        best, median = _best_and_median(problem, count, 0, collisions)
        for number in range(1, motions):
            best = _best_and_median(replace(problem, known=best), count, number, collisions)[0]
            median = _best_and_median(replace(problem, known=median), count, number, collisions)[1]
    return excitation_plan(problem.torque_model, best), excitation_plan(problem.torque_model, median)


def _best_and_median(
    problem: ExcitationProblem, count: int, seed: int, collisions: SelfCollision | None
) -> tuple[Array, Array]:
    """Information matrices of random motions, with what is known."""
    rng, model = np.random.default_rng([seed, 2]), problem.torque_model.model
    courses, totals = [], []
    for number in range(count):
        log.info("random motion %d of %d", number + 1, count)
        courses.append(random_trajectory(model, problem.limits, problem.checked_spheres, problem.basis, rng))
        totals.append(problem.total_information(courses[-1]))
    order = sorted(range(count), key=lambda k: problem.criterion(totals[k])[0])
    free = (k for k in order if collisions is None or not planned(problem, courses[k], collisions).hits)
    return totals[next(free, order[0])], totals[order[count // 2]]


def recorded_information(problem: ExcitationProblem, recordings: Sequence[Recording]) -> tuple[Array, int]:
    """F of recordings that have v and a, and their number of rows."""
    total, rows = np.zeros((len(problem.information.independent),) * 2), 0
    for recording in recordings:
        q, v, a = (recording.channel(name) for name in "qva")
        for first in range(0, len(q), REGRESSOR_ROWS_AT_ONCE):
            piece = slice(first, first + REGRESSOR_ROWS_AT_ONCE)
            motion = JointMotion(q[piece], v[piece], a[piece], np.zeros_like(q[piece]))
            total += problem.information.matrix(motion, len(motion.q))
        rows += len(q)
    return total, rows


TORQUE_NOISE_SHARE = 0.01
"""Standard deviation, as a part of the effort that the file states, or of the torque of the bodies."""

NOISE_STATES = 1000
"""Random states over which the torque of the bodies is looked at."""


def assumed_noise(model: RobotModel) -> tuple[Array, str]:
    """Standard deviations (nv,) [N m or N], and in words where they come from."""
    joints = [model.joints[k] for k in model.degrees_of_freedom.independent]
    efforts = np.array([joint.limits.effort or 0.0 for joint in joints])
    if np.all(efforts > 0):
        return TORQUE_NOISE_SHARE * efforts, f"{100 * TORQUE_NOISE_SHARE:g} % of the efforts of the file"
    q, v = model.random_state(np.random.default_rng(0), NOISE_STATES)
    sizes = np.sqrt(np.mean(joint_torques(model, q, v, np.zeros_like(q), method="reproducible") ** 2, axis=0))
    if np.all(sizes > 0):
        return (
            TORQUE_NOISE_SHARE * sizes,
            f"{100 * TORQUE_NOISE_SHARE:g} % of the torque that the bodies of the file take in random states",
        )
    unit = unit_of(joints, "N m", "N")
    return np.ones(len(joints)), f"1 {unit}, because the file states neither efforts nor masses"
