"""The format `graphdyn excite 1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from crosscheck.exciting.excited import Excited, PlannedMotion
from crosscheck.exciting.self_collision import Hit, SelfCollision
from crosscheck.report.records.record import CommandRecord, Count, Index, Number, Record, attribute, written
from graphdyn import RobotModel
from graphdyn.excitation import CHECK_RATE, ExcitationPlan, FourierBasis, Trajectory, Usage


class LimitUseRecord(Record, of=Usage):
    """A limit of a motion, over all its times, looked at at 1 kHz; how near links come is in `collisions`."""

    kind: Literal["position", "velocity", "acceleration", "jerk", "torque", "plane"]


class FourierRecord(Record):
    """A joint's motion: offset + Σ_l (a_l sin(l ω t) - b_l cos(l ω t)) / (l ω), ω = 2π / duration.

    joint: name, as in the file
    offset: mean position [rad or m]
    a: a_1 … a_L [rad/s or m/s]
    b: b_1 … b_L [rad/s or m/s]
    """

    joint: str
    offset: float
    a: Sequence[float]
    b: Sequence[float]


class CollisionRecord(Record, of=Hit, only=("poses",)):
    """Two links whose meshes collide.

    links: names of both
    first: time of the first pose [s]
    """

    links: str = attribute("name")
    poses: Count
    first: float


class CheckedCollisionsRecord(Record, of=SelfCollision, only=("margin", "disabled", "missing")):
    """Which pairs of links were looked at. Links that a joint connects are in none of these, nor
    those that are fixed to the inner one with the outer one.

    checked: pairs that were checked
    """

    checked: Sequence[str]
    near = attribute()
    always = attribute("touching")
    without_shapes = attribute()


class PlannedMotionRecord(Record, of=PlannedMotion, only=("seed",)):
    """A motion.

    number: 1 … K
    duration: of the motion [s]
    fourier: in the order of the robot; null for motions that are no Fourier series
    collisions: of links with each other
    """

    number: Index
    duration: float = attribute("course.duration")
    limits: Sequence[LimitUseRecord] = attribute("usages")
    fourier: Sequence[FourierRecord] | None
    collisions: Sequence[CollisionRecord]


class PlannedParameterRecord(Record):
    """A base parameter, as recordings of all motions will determine it.

    name: such as "XX_2 - YY_2 + 0.18 M_3"
    unit: of the parameter
    prior: value in the robot's file; 0 for friction and drives
    spread: how far from it the parameter may be before the experiment
    sigma: standard deviation after it; null where the motions do not determine it
    relative: sigma divided by the larger of |prior| and spread
    verdict: determined: relative up to 0.1, up to 0.5, or beyond
    best_random: sigma of the best random motions; null without
    median_random: sigma of the median random motions; null without
    recorded: sigma of the recordings of --against, for as many samples; null without
    encoder_sigma: standard deviation with the noise of --position-noise too; null without
    bias: mean error with that noise; null without
    """

    name: str
    unit: str
    prior: float
    spread: float
    sigma: Number
    relative: Number
    verdict: Literal["well", "roughly", "not"]
    best_random: Number
    median_random: Number
    recorded: Number
    encoder_sigma: Number
    bias: Number


class PlanSummaryRecord(Record, of=ExcitationPlan, only=()):
    """All base parameters together."""

    geometric_mean: Number = attribute()
    condition_number: Number = attribute()


class ExciteRecord(
    CommandRecord,
    of=Excited,
    only=("robot", "motions", "plan", "random", "best_random", "median_random", "recorded", "failures", "collisions"),
    format="graphdyn excite 1",
):
    """Motions, the limits they use, and what they promise.

    noise: standard deviation of the torques, of each joint that no others drive [N m or N]
    rate: samples per second of the measurement
    parameters: the base parameters
    out: files of the motions
    """

    locked = attribute()
    chain = attribute()
    criterion: Literal["log-det", "sigma", "condition"]
    noise: Sequence[float] = attribute("problem.noise")
    rate: float = attribute("problem.rate")
    motions: Sequence[PlannedMotionRecord]
    plan: PlanSummaryRecord
    random: Count
    best_random: PlanSummaryRecord | None
    median_random: PlanSummaryRecord | None
    recorded: PlanSummaryRecord | None
    parameters: Sequence[PlannedParameterRecord]
    only_in_sums = attribute("plan.only_in_sums")
    without_effect = attribute("plan.without_effect")
    collisions: CheckedCollisionsRecord | None
    out: Sequence[str]


def excite_record(found: Excited, out: Sequence[str], command: Sequence[str]) -> dict[str, Any]:
    """out: names of the files of the motions"""
    model = found.problem.torque_model.model
    return written(
        ExciteRecord,
        found,
        command=command,
        motions=[_motion(number, motion, model) for number, motion in enumerate(found.motions, start=1)],
        parameters=[_parameter(found, k) for k in range(len(found.plan.sigma))],
        collisions=_collisions(found.collisions),
        out=out,
    )


def _motion(number: int, motion: PlannedMotion, model: RobotModel) -> dict[str, Any]:
    return written(
        PlannedMotionRecord,
        motion,
        number=number,
        fourier=_fourier(motion, model),
        collisions=[written(CollisionRecord, hit, first=hit.first / CHECK_RATE) for hit in motion.hits],
    )


def _collisions(known: SelfCollision | None) -> dict[str, Any] | None:
    if known is None:
        return None
    return written(CheckedCollisionsRecord, known, checked=[known.name(pair) for pair in known.pairs])


def _fourier(motion: PlannedMotion, model: RobotModel) -> list[dict[str, Any]] | None:
    course = motion.course
    if not isinstance(course, Trajectory) or not isinstance(course.basis, FourierBasis):
        return None
    records = []
    for joint, coefficients in zip(model.independent_joints, course.coefficients, strict=True):
        a, b, offset = course.basis.series(coefficients)
        records.append(written(FourierRecord, joint=joint, offset=offset, a=a, b=b))
    return records


def _parameter(found: Excited, k: int) -> dict[str, Any]:
    plan, others = found.plan, ("best_random", "median_random", "recorded")
    return written(
        PlannedParameterRecord,
        name=plan.names[k],
        unit=plan.units[k],
        prior=plan.prior[k],
        spread=plan.spread[k],
        sigma=plan.sigma[k],
        relative=plan.relative[k],
        verdict=plan.verdicts[k],
        encoder_sigma=None if found.encoder is None else found.encoder[1].sigma[k],
        bias=None if found.encoder is None else found.encoder[1].bias[k],
        **{name: None if (other := getattr(found, name)) is None else other.sigma[k] for name in others},
    )
