"""How a frame moves, as steps of its body and of those between it and the ground (graphdyn.recursions.frames)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from graphdyn.compiler.rolled.program import ColumnPasses, Pass
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.compiler.rolled.steps.world import axis, ground, moving
from graphdyn.recursions.motion import BodyMotion
from graphdyn.scalars.vectors import Scalars, cross, scalars, zeros


def _arm(x: BodyStep) -> Scalars:
    """The point that is spoken of, from the body's origin, in world axes."""
    if x.frame.choice.reference == "world":
        return -x.kept("origin")
    arm: Scalars = x.kept("rotation") @ x.frame.translation
    return arm


def _axes(x: BodyStep) -> Scalars:
    """The rotation from world axes to those of the reference."""
    if x.frame.choice.reference != "local":
        return scalars(np.eye(3))
    axes: Scalars = (x.kept("rotation") @ x.frame.rotation).T
    return axes


def _velocity(x: BodyStep) -> None:
    omega, axes = x.kept("omega"), _axes(x)
    x.answer("frame_velocity", [*(axes @ (x.kept("velocity") + cross(omega, _arm(x)))), *(axes @ omega)])


def _with_gravity(x: BodyStep) -> None:
    """The ground as it moves, not as if it accelerated against gravity."""
    ground(x)
    x.keep("compensated", x.root.rotation @ x.root.acceleration)


def _acceleration(x: BodyStep) -> None:
    omega, alpha, arm, axes = x.kept("omega"), x.kept("alpha"), _arm(x), _axes(x)
    linear = x.kept("compensated") + BodyMotion(omega, alpha, zeros(3)).spread() @ arm
    if not x.frame.choice.classical:
        linear = linear - cross(omega, x.kept("velocity") + cross(omega, arm))
    x.answer("frame_acceleration", [*(axes @ linear), *(axes @ alpha)])


def _started(x: BodyStep) -> None:
    """The point, from the origin of the body, and how fast it leaves that."""
    arm, omega = _arm(x), x.kept("omega")
    x.carry("arm", arm)
    x.carry("axes", _axes(x))
    x.carry("omega", omega)
    fixed = x.frame.choice.reference == "world"  # the world's origin, which does not move
    x.carry("change", -x.kept("velocity") if fixed else cross(omega, arm))


def _column(x: BodyStep) -> None:
    x.answer("frame_jacobian", _turned(x, *_unit_twist(x)))
    x.carry("arm", x.carried("arm") + x.kept("arm"))


def _rate(x: BodyStep) -> None:
    arm, change, axes_move = x.carried("arm"), x.carried("change"), x.kept("turned_axis")
    if x.prismatic:
        linear, angular = axes_move, zeros(3)
    else:
        linear, angular = cross(axes_move, arm) + cross(axis(x), change), axes_move
    if x.frame.choice.reference == "local":  # the axes turn with the frame
        parts = zip((linear, angular), _unit_twist(x), strict=True)
        linear, angular = (rate - cross(x.carried("omega"), part) for rate, part in parts)
    x.answer("frame_jacobian_derivative", _turned(x, linear, angular))
    x.carry("arm", arm + x.kept("arm"))
    x.carry("change", change + x.kept("change"))


def _unit_twist(x: BodyStep) -> tuple[Scalars, Scalars]:
    """Velocity of the point and ω by a unit velocity of the joint."""
    p = axis(x)
    return (p, zeros(3)) if x.prismatic else (cross(p, x.carried("arm")), p)


def _turned(x: BodyStep, linear: Scalars, angular: Scalars) -> list[Any]:
    if x.frame.choice.reference != "local":
        return [*linear, *angular]
    axes = x.carried("axes")
    return [*(axes @ linear), *(axes @ angular)]


def _of_joints(step: Callable[[BodyStep], None]) -> tuple[Pass | ColumnPasses, ...]:
    path = ColumnPasses((Pass("column", _started), Pass("path", step)), of_frame=True)
    return Pass("ground", ground), Pass("outwards", moving), path


PASSES: dict[str, tuple[Pass | ColumnPasses, ...]] = {
    "frame_jacobian": _of_joints(_column),
    "frame_jacobian_derivative": _of_joints(_rate),
    "frame_velocity": (Pass("ground", ground), Pass("outwards", moving), Pass("frame", _velocity)),
    "frame_acceleration": (Pass("ground", _with_gravity), Pass("outwards", moving), Pass("frame", _acceleration)),
}
"""Passes by recursion."""
