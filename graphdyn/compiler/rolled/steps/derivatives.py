"""Derivatives of inverse and forward dynamics in the joint variables, column after column.

Singh, Russo and Wensing, "Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra", IEEE
Robotics and Automation Letters 7(2), 2022, here with velocities relative to the origins: what a change of joint j does
to the motion of all bodies outside is a field of accelerations L + X × c + 2 w × ċ about O_j. Seen from axes that turn
with these bodies, nothing else changes, and the wrench that the field takes of them is passed on inwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.compiler.rolled.program import ColumnPasses, Index, Pass, Product
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.compiler.rolled.steps.matrices import ACCELERATED, inverse
from graphdyn.compiler.rolled.steps.world import BODIES, along, axis, gathered, ground, moving, per_rate, shifted
from graphdyn.recursions.inverse import Wrench, added
from graphdyn.recursions.motion import places
from graphdyn.scalars.vectors import Scalars, cross, turn, zeros


@dataclass(frozen=True)
class Field:
    """Accelerations L + X × c + 2 w × ċ of points c about the origin, which move at ċ relative to it."""

    linear: Scalars
    angular: Scalars
    coriolis: Scalars

    def moved_by(self, arm: Scalars, change: Scalars) -> Field:
        """The same field about another origin, at an arm that grows at this rate."""
        linear = self.linear + cross(self.angular, arm) + cross(self.coriolis, change) * 2.0
        return Field(linear, self.angular, self.coriolis)


def _fields(x: BodyStep) -> dict[str, Field]:
    """What a unit of q, v and a of the joint adds, with those of all other joints held."""
    p, turned = axis(x), x.kept("turned_axis")
    omega, alpha = x.inside("omega"), x.inside("alpha")
    rolling = cross(alpha, p) + cross(omega, turned)
    none = zeros(3)
    if x.prismatic:
        return {"q": Field(rolling, none, none), "v": Field(turned * 2.0, none, none), "a": Field(p, none, none)}
    by_q = Field(cross(x.kept("compensated"), p), rolling, turned)
    return {"q": by_q, "v": Field(none, turned * 2.0, p), "a": Field(none, p, none)}


def _taken(of: Callable[[str], Scalars], field: Field) -> Wrench:
    """What a field takes of a body and all bodies outside. of: x.kept or x.column, what the body keeps"""
    mass, moment, flow = of("mass"), of("moment"), of("flow")
    force = field.linear * mass + cross(field.angular, moment)
    torque = cross(moment, field.linear) + of("tensor") @ field.angular
    # 2 ∫ w × ċ dm and 2 ∫ c × (w × ċ) dm
    coriolis = cross(field.coriolis, of("impulse")) * 2.0
    return force + coriolis, torque + (field.coriolis * np.trace(flow) - flow @ field.coriolis) * 2.0


def _follows(x: BodyStep) -> Wrench:
    """How the wrench of all bodies outside changes as it turns, or slides, with them."""
    p, (force, moment) = axis(x), x.kept("wrench")
    return (zeros(3), cross(p, force)) if x.prismatic else (cross(p, force), cross(p, moment))


def _disturbed(x: BodyStep) -> None:
    """What the column's joint changes, and what of a field its body and those outside make it feel."""
    p, flow, fields = axis(x), x.kept("flow"), _fields(x)
    x.carry("momentum", per_rate(x))
    x.carry("by_q", added(_taken(x.kept, fields["q"]), _follows(x)))
    x.carry("by_v", _taken(x.kept, fields["v"]))
    felt = cross(x.kept("impulse"), p) if x.prismatic else p * np.trace(flow) - flow.T @ p
    x.carry("felt", felt * 2.0)


def _changed(x: BodyStep) -> None:
    arm, momentum, felt = x.kept("arm"), x.carried("momentum"), x.carried("felt")
    fields = _fields(x)
    for name in "qv":
        here, array, field = x.carried(f"by_{name}"), f"dtau_d{name}", fields[name]
        x.answer(array, along(x, here), "body", "column")
        outside = field.angular @ momentum[1] + field.linear @ momentum[0] + field.coriolis @ felt
        x.answer(array, outside, "column", "body")
        x.carry(f"by_{name}", shifted(here, arm))
    entry = along(x, momentum)
    x.answer("dtau_da", entry, "body", "column")
    x.answer("dtau_da", entry, "column", "body")
    # the origin moves on, and ċ of what is carried grows by the velocity of one relative to the other
    x.carry("felt", felt + cross(x.kept("change"), momentum[0]) * 2.0)
    x.carry("momentum", shifted(momentum, arm))


def _coriolis(x: BodyStep) -> None:
    """½ ∂τ/∂v."""
    for of in (("body", "column"), ("column", "body")):
        x.answer("coriolis_matrix", x.answered("dtau_dv", *of) * 0.5, *of)


# Reactions, of joints outside and inside of the joint that changes


def _stated(x: BodyStep) -> None:
    """How the reactions of the joint are stated, of force and moment in world axes (graphdyn.recursions.inverse)."""
    moving(x)
    (place,) = places([x.link], [x.joint("q")])
    to_body, none = x.kept("rotation").T, zeros(3, 3)
    if x.prismatic:
        of_force, of_moment = [*to_body[:2], *none], [*none[:2], *to_body]
    else:
        of_force, of_moment = [*np.eye(3), *none[:2]], [*none, *turn(place.c, place.s, to_body)[:2]]
    x.keep("of_force", np.array(of_force, dtype=object))
    x.keep("of_moment", np.array(of_moment, dtype=object))
    x.keep("force_in_world_axes", 0.0 if x.prismatic else 1.0)
    x.keep("to_link", x.link.link_axes @ to_body)


def _reactions(x: BodyStep, of: Callable[[str], Scalars], by: str, wrench: Any, in_link: Any, *at: Index) -> None:
    """The derivatives of a body; in_link: as seen from axes that turn with it."""
    x.answer(f"dmultipliers_d{by}", of("of_force") @ wrench[0] + of("of_moment") @ wrench[1], *at)
    x.answer(f"dwrenches_d{by}", [*(of("to_link") @ in_link[0]), *(of("to_link") @ in_link[1])], *at)


def _reacting(x: BodyStep) -> None:
    """Reactions of the column's joint by its own variables, and what is passed on to the joints inside."""
    for by, field in _fields(x).items():
        own = _taken(x.kept, field)
        turned = added(own, _follows(x)) if by == "q" else own
        _reactions(x, x.kept, by, own if x.prismatic else turned, own, "column", "column")
        x.carry(f"by_{by}", shifted(turned, x.kept("arm")))
    x.carry("arm", x.kept("arm"))
    x.carry("change", x.kept("change"))


def _reacting_inside(x: BodyStep) -> None:
    """Reactions of a joint inside by the variables of the column's, and of the column's by those of that joint."""
    arm, change, (force, _) = x.carried("arm"), x.carried("change"), x.column("wrench")
    for by, field in _fields(x).items():
        passed = x.carried(f"by_{by}")
        _reactions(x, x.kept, by, passed, passed, "body", "column")
        x.carry(f"by_{by}", shifted(passed, x.kept("arm")))
        own = turned = _taken(x.column, field.moved_by(arm, change))
        if by == "q" and not x.prismatic:
            turned = own[0] + cross(axis(x), force) * x.column("force_in_world_axes"), own[1]
        _reactions(x, x.column, by, turned, own, "column", "body")
    x.carry("arm", arm + x.kept("arm"))
    x.carry("change", change + x.kept("change"))


_DERIVATIVES = ColumnPasses((Pass("column", _disturbed), Pass("path", _changed)))

PASSES: dict[str, tuple[Pass | ColumnPasses | Product, ...]] = {
    "inverse_dynamics_derivatives": (*BODIES, _DERIVATIVES),
    "coriolis_matrix": (*BODIES, _DERIVATIVES, ColumnPasses((Pass("path", _coriolis),))),
    "reaction_derivatives": (
        Pass("ground", ground),
        Pass("outwards", _stated),
        Pass("inwards", gathered),
        ColumnPasses((Pass("column", _reacting), Pass("beyond", _reacting_inside))),
    ),
    "forward_dynamics_derivatives": (
        *ACCELERATED,
        _DERIVATIVES,
        *inverse("da_dtau"),
        Product("da_dtau", "dtau_dq", "da_dq", sign=-1),
        Product("da_dtau", "dtau_dv", "da_dv", sign=-1),
    ),
}
"""Passes by recursion."""
