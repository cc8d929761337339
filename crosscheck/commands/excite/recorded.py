"""The record of `graphdyn excite --json`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

from crosscheck.commands.excite.record import (
    CheckedCollisionsRecord,
    CollisionRecord,
    ExciteRecord,
    FourierRecord,
    LimitUseRecord,
    PlannedMotionRecord,
    PlannedParameterRecord,
    PlanSummaryRecord,
)
from crosscheck.exciting.excited import Excited, PlannedMotion
from crosscheck.exciting.self_collision import SelfCollision
from graphdyn import RobotModel
from graphdyn.excitation import CHECK_RATE, ExcitationPlan, FourierBasis, Trajectory


def excite_record(found: Excited, written: Sequence[str], command: Sequence[str]) -> ExciteRecord:
    """written: names of the files of the motions."""
    plan, problem = found.plan, found.problem
    model = problem.torque_model.model
    return ExciteRecord(
        command=command,
        robot=found.robot,
        locked=found.locked,
        criterion=cast(Any, found.criterion),
        noise=problem.noise.tolist(),
        rate=problem.rate,
        motions=[_motion(number, motion, model) for number, motion in enumerate(found.motions, start=1)],
        plan=_summary(plan),
        random=found.random,
        best_random=_summary(found.best_random) if found.best_random else None,
        median_random=_summary(found.median_random) if found.median_random else None,
        recorded=_summary(found.recorded) if found.recorded else None,
        parameters=[_parameter(found, k) for k in range(len(plan.sigma))],
        only_in_sums=plan.only_in_sums,
        without_effect=plan.without_effect,
        failures=found.failures,
        collisions=_collisions(found.collisions),
        out=written,
    )


def _motion(number: int, motion: PlannedMotion, model: RobotModel) -> PlannedMotionRecord:
    return PlannedMotionRecord(
        number=number,
        seed=motion.seed,
        duration=motion.course.duration,
        limits=[LimitUseRecord(kind=cast(Any, x.kind), name=x.name, used=x.used) for x in motion.usages],
        fourier=_fourier(motion, model),
        collisions=[
            CollisionRecord(links=hit.name, poses=hit.poses, first=hit.first / CHECK_RATE) for hit in motion.hits
        ],
    )


def _collisions(known: SelfCollision | None) -> CheckedCollisionsRecord | None:
    if known is None:
        return None
    return CheckedCollisionsRecord(
        margin=known.margin,
        checked=[known.name(pair) for pair in known.pairs],
        near=known.near,
        always=known.touching,
        disabled=known.disabled,
        missing=known.missing,
        without_shapes=known.without_shapes,
    )


def _fourier(motion: PlannedMotion, model: RobotModel) -> list[FourierRecord] | None:
    course = motion.course
    if not isinstance(course, Trajectory) or not isinstance(course.basis, FourierBasis):
        return None
    records = []
    for joint, coefficients in zip(model.independent_joints, course.coefficients, strict=True):
        a, b, offset = course.basis.series(coefficients)
        records.append(FourierRecord(joint=joint, offset=offset, a=a.tolist(), b=b.tolist()))
    return records


def _summary(plan: ExcitationPlan) -> PlanSummaryRecord:
    return PlanSummaryRecord(geometric_mean=plan.geometric_mean, condition_number=plan.condition_number)


def _parameter(found: Excited, k: int) -> PlannedParameterRecord:
    def sigma(plan: ExcitationPlan | None) -> float | None:
        return None if plan is None else float(plan.sigma[k])

    plan = found.plan
    return PlannedParameterRecord(
        name=plan.names[k],
        unit=plan.units[k],
        prior=float(plan.prior[k]),
        spread=float(plan.spread[k]),
        sigma=sigma(plan),
        relative=float(plan.relative[k]),
        verdict=cast(Any, plan.verdicts[k]),
        best_random=sigma(found.best_random),
        median_random=sigma(found.median_random),
        recorded=sigma(found.recorded),
    )
