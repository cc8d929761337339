"""How much of every limit a motion uses, and how that changes with its coefficients.

A limit of a joint is one number: a smooth maximum over the grid of time and both directions,

    K = m + ln Σ_t exp(ρ (g_t - m)) / ρ,    m = max g_t ≤ K ≤ m + ln(2 N) / ρ,    g_t = |v_t| / v_max and so on

(Kreisselmeier and Steinhauser, 1979): never below the true maximum, and differentiable. A motion keeps the limit
where K ≤ 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn._derivatives import inverse_dynamics_derivatives
from graphdyn._dynamics import joint_torques
from graphdyn._model import RobotModel
from graphdyn.excitation.limits import MotionLimits
from graphdyn.excitation.trajectory import JointMotion
from graphdyn.excitation.watched_points import Ball, centers
from graphdyn.layout import Array

ENDLESS = 1.0
"""Positions with one limit alone are measured in this [rad or m]; speeds of planes likewise in m."""


@dataclass(frozen=True)
class Usage:
    """Of one limit.

    kind: "position", "velocity", "acceleration", "jerk", "torque" or "plane"
    name: of the joint, or of the plane
    used: largest part of the limit that the motion uses; above 1 it is violated. Of a position or a plane it is 1 at
        the limit
    """

    kind: str
    name: str
    used: float


@dataclass(frozen=True, eq=False)
class Signal:
    """Numbers over time that have to stay below 1, and their derivatives by q, v and a.

    values: (N, m), the m of them are one limit together
    linear: for limits linear in one derivative of the motion: its order, and weights of the joints (m, n)
    slopes: otherwise the derivatives by q, v and a, (N, m, n) each or None
    """

    kind: str
    name: str
    values: Array
    order: int | None = None
    weights: Array | None = None
    slopes: tuple[Array | None, Array | None, Array | None] = (None, None, None)


def signals(
    model: RobotModel, limits: MotionLimits, balls: Sequence[Ball], motion: JointMotion, slopes: bool = True
) -> list[Signal]:
    """Those of all limits, in a fixed order. slopes: whether derivatives are needed."""
    found = [*_of_positions(model, limits, motion)]
    matrix = model.freedoms.matrix
    for order, kind in enumerate(("velocity", "acceleration", "jerk"), start=1):
        largest = getattr(limits, kind)
        for j in np.flatnonzero(np.isfinite(largest)):
            rate = motion[order] @ matrix[j] / largest[j]
            weights = np.stack([matrix[j], -matrix[j]]) / largest[j]
            found.append(Signal(kind, model.joint_names[j], np.stack([rate, -rate], 1), order, weights))
    found += _of_torques(model, limits, motion, slopes)
    return found + _of_planes(model, limits, balls, motion)


def usage(signal: Signal) -> Usage:
    """The true maximum over the grid."""
    return Usage(signal.kind, signal.name, float(signal.values.max()))


def smooth_maximum(signal: Signal, phi: Sequence[Array], sharpness: float) -> tuple[float, Array]:
    """K, and its derivative by the coefficients (n, K_basis). phi: the rows of the basis, of orders 0 … 3."""
    top = signal.values.max()
    grown = np.exp(sharpness * (signal.values - top))
    total = grown.sum()
    share = grown / total
    if signal.weights is not None and signal.order is not None:
        slope = signal.weights.T @ (share.T @ phi[signal.order])
    else:
        slope = sum(
            np.einsum("tm,tmn->nt", share, part) @ phi[order]
            for order, part in enumerate(signal.slopes)
            if part is not None
        )
    return float(top + np.log(total) / sharpness), np.asarray(slope)


def _of_positions(model: RobotModel, limits: MotionLimits, motion: JointMotion) -> list[Signal]:
    found = []
    matrix, offset = model.freedoms.matrix, model.freedoms.offset
    for j, (lower, upper) in enumerate(zip(limits.lower, limits.upper, strict=True)):
        half = (upper - lower) / 2 if np.isfinite(upper - lower) else ENDLESS
        position = motion.q @ matrix[j] + offset[j]
        sides = [(1.0, upper), (-1.0, -lower)]
        bounded = [(sign, limit) for sign, limit in sides if np.isfinite(limit)]
        if bounded:
            values = np.stack([1 + (sign * position - limit) / half for sign, limit in bounded], axis=1)
            weights = np.stack([sign * matrix[j] / half for sign, _ in bounded])
            found.append(Signal("position", model.joint_names[j], values, 0, weights))
    return found


def _of_torques(model: RobotModel, limits: MotionLimits, motion: JointMotion, slopes: bool) -> list[Signal]:
    """Of the rigid bodies and the friction that the model states."""
    limited = np.flatnonzero(np.isfinite(limits.torque))
    if not limited.size:
        return []
    q, v, a = motion[:3]
    joints = [model.joints[k] for k in model.freedoms.independent]
    damping = np.array([joint.damping for joint in joints])
    friction = np.array([joint.friction for joint in joints])
    tau = joint_torques(model, q, v, a, method="recursive") + damping * v
    if slopes:
        by = inverse_dynamics_derivatives(model, q, v, a, method="recursive")
        by_v = by.dtau_dv + np.diag(damping)
    found = []
    for j in limited:
        largest = limits.torque[j]
        values = (np.stack([tau[:, j], -tau[:, j]], axis=1) + friction[j]) / largest
        parts = [np.stack([x[:, j], -x[:, j]], 1) / largest for x in (by.dtau_dq, by_v, by.dtau_da)] if slopes else []
        found.append(Signal("torque", joints[j].name, values, slopes=(*parts,) if slopes else (None, None, None)))
    return found


def _of_planes(model: RobotModel, limits: MotionLimits, balls: Sequence[Ball], motion: JointMotion) -> list[Signal]:
    if not limits.planes:
        return []
    positions, by_q = centers(model, balls, motion.q)
    radii = np.array([ball.radius for ball in balls])
    found = []
    for number, plane in enumerate(limits.planes, start=1):
        normal = np.asarray(plane.normal, dtype=float)
        height = positions @ normal - radii - plane.distance
        slope = -np.einsum("tbxn,x->tbn", by_q, normal) / ENDLESS
        found.append(Signal("plane", f"plane {number}", 1 - height / ENDLESS, slopes=(slope, None, None)))
    return found
