"""Exact placements of a frame as matrices, and how far they move with their inputs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from crosscheck.exact.balls import as_balls
from crosscheck.exact.sensitivity import HALF_ULP
from crosscheck.exact.source import ExactSource
from crosscheck.exact.values import PLACEMENT, ExactArray, exact_values
from crosscheck.reference.subject import Robot
from graphdyn import RobotModel, frame_jacobian, frame_placement
from graphdyn.layout import ANGULAR, LINEAR, Array


def exact_placements(robot: Robot | ExactSource, q: Array, frame: str, **options: Any) -> ExactArray:
    """[[R, p], [0, 1]] (N, 4, 4) of a frame in the world at positions (N, n). options: those of exact_values"""
    found = exact_values(robot, PLACEMENT, q, frame=frame, **options)
    rotation, position = found["rotation"], found["position"]
    placed = np.full((len(q), 4, 4), as_balls(0.0)[()], dtype=object)
    placed[:, :3, :3], placed[:, :3, 3], placed[:, 3, 3] = rotation.balls, position.balls, as_balls(1.0)[()]
    return replace(rotation, balls=placed, bits=max(rotation.bits, position.bits))


def half_ulp_of_placements(model: RobotModel, q: Array, frame: str) -> Array:
    """What the placement moves by (N, 4, 4), to first order, if every input moves by half an ulp, each so that it does
    most: the rule of half_ulp_effects.

    R = P R_k S and p = p_k + P (t_k + R_k s) for each of the constants R_k, t_k on the way from the base to the frame.
    """
    rotation, position = frame_placement(model, q, frame)
    jacobian = np.moveaxis(frame_jacobian(model, q, frame, reference="local_world_aligned"), -1, 0)
    moved = np.zeros((len(q), 4, 4))
    for column, size in zip(jacobian, np.abs(q).T, strict=True):
        turned = np.cross(column[:, ANGULAR, None], rotation, axis=1)
        moved[:, :3, :3] += size[:, None, None] * np.abs(turned)
        moved[:, :3, 3] += size[:, None] * np.abs(column[:, LINEAR])
    names, body = (model.base_name, *model.body_names), model.frame(frame).body
    steps = [(names[body], model.frame(frame).placement)]
    while body:
        joint, body = model.joints[body - 1], model.joints[body - 1].inside
        steps.append((names[body], joint.placement))
    starts = [(*frame_placement(model, q, inside), constant) for inside, constant in steps]
    for before, origin, constant in [*starts, (np.eye(3), np.zeros(3), model.base)]:
        after = np.swapaxes(before @ constant.rotation, -1, -2)
        outside = position - origin - before @ constant.translation
        reach = np.abs(after @ outside[..., None])[..., 0].sum(axis=-1) + np.linalg.norm(constant.translation)
        spread = np.abs(before).sum(axis=-1)
        moved[:, :3, :3] += spread[..., None] * np.abs(after @ rotation).sum(axis=-2)[:, None, :]
        moved[:, :3, 3] += spread * reach[:, None]
    return HALF_ULP * moved
