"""The mass matrix, its inverse, and what the inverse multiplies, column after column.

What joint j moves is passed on inwards, origin by origin, and felt by every joint on the way.
"""

from __future__ import annotations

from typing import Any

from graphdyn.compiler.rolled.program import Columns, Pass
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.compiler.rolled.steps import bodies
from graphdyn.compiler.rolled.steps.bodies import entries, inertia_of, place_of
from graphdyn.compiler.rolled.steps.world import (
    BODIES,
    along,
    axis,
    ground,
    per_rate,
    placed,
    shifted,
)
from graphdyn.recursions.forward import Inertia, seen_through_joint
from graphdyn.recursions.inverse import Wrench
from graphdyn.recursions.motion import places
from graphdyn.scalars.vectors import cross, zeros

# Mass matrix: Featherstone, "Rigid Body Dynamics Algorithms", 2008, table 6.2


def _momentum(x: BodyStep) -> None:
    x.carry("momentum", per_rate(x))


def _coupled(x: BodyStep) -> None:
    momentum = x.carried("momentum")
    entry = along(x, momentum)
    x.answer("mass_matrix", entry, "body", "column")
    x.answer("mass_matrix", entry, "column", "body")
    x.carry("momentum", shifted(momentum, x.kept("arm")))


# M⁻¹ and what it multiplies: bodies are eliminated from the leaves to the ground, once for all columns; then the
# torques of a column go inwards and the accelerations outwards. Featherstone, 2008, table 7.1, without velocities.


def _free(x: BodyStep) -> None:
    """Where the body is, and I^A of it alone, in joint axes."""
    (place,) = places([x.link], [x.joint("q")])
    x.keep("turn", [place.c, place.s])
    x.sum("inertia", entries(Inertia.of(x.link)))
    placed(x)


def _eliminated(x: BodyStep) -> None:
    inertia = inertia_of(x.kept("inertia"))
    leaf = seen_through_joint(x.prismatic, inertia, (zeros(3), zeros(3)), 0.0)
    x.add("inertia", entries(leaf.inertia.inwards(place_of(x))))
    x.answer("pivots", (inertia.m[2, 2] if x.prismatic else inertia.j[2, 2]) * x.pivot_scale)
    x.keep("U", leaf.U)
    x.keep("gain", [leaf.D_inverse, 0.0])


def _in_world_axes(x: BodyStep) -> None:
    """U of the eliminated body."""
    x.keep("world_U", [x.kept("rotation") @ part for part in x.kept("U")])


def _passed_on(x: BodyStep, load: Any, u: Any) -> Wrench:
    """What the inside body feels of a load on this one, with its joint free: p + U u / D."""
    U, gain = x.kept("world_U"), x.kept("gain")[0] * u
    return shifted((load[0] + U[0] * gain, load[1] + U[1] * gain), x.kept("arm"))


def _released(x: BodyStep, u: Any, inside: Any) -> tuple[Any, Wrench]:
    """The acceleration of the joint, and those of the body; inside: those of the inside body."""
    linear, angular, U = inside[0] + cross(inside[1], x.kept("arm")), inside[1], x.kept("world_U")
    a = x.kept("gain")[0] * (u - (U[0] @ linear + U[1] @ angular))
    moves = axis(x) * a
    return a, (linear + moves, angular) if x.prismatic else (linear, angular + moves)


def _still(x: BodyStep) -> None:
    x.keep("pushed", zeros(2, 3))


def _pushed(x: BodyStep) -> None:
    """A unit torque on the joint of the column."""
    x.keep("push", 1.0)
    x.carry("load", _passed_on(x, (zeros(3), zeros(3)), 1.0))


def _pushed_back(x: BodyStep) -> None:
    load = x.carried("load")
    u = -along(x, load)
    x.keep("push", u)
    x.carry("load", _passed_on(x, load, u))


def inverse(array: str) -> tuple[Pass | Columns, ...]:
    """M⁻¹, of eliminated bodies."""

    def released(x: BodyStep) -> None:
        a, moves = _released(x, x.kept("push"), x.inside("pushed"))
        x.answer(array, a, "body", "column")
        x.keep("pushed", moves)
        x.keep("push", 0.0)  # for the next column

    columns = Columns((Pass("column", _pushed), Pass("beyond", _pushed_back), Pass("outwards", released)))
    return Pass("ground", _still), columns


def accelerations(needed: str, array: str) -> tuple[Pass | Columns, ...]:
    """-M⁻¹ times the torques that are needed, of eliminated bodies; the columns of one body are done together."""
    load, push, moved = (f"{what}_{array}" for what in ("load", "push", "moved"))

    def still(x: BodyStep) -> None:
        (count,) = x.answered(needed, "body", "column").shape
        x.sum(load, zeros(count, 2, 3))
        x.keep(moved, zeros(count, 2, 3))

    def pushed(x: BodyStep) -> None:
        loads = x.kept(load)
        us = [-(tau + along(x, one)) for tau, one in zip(x.answered(needed, "body", "column"), loads, strict=True)]
        x.keep(push, us)
        x.add(load, [_passed_on(x, one, u) for one, u in zip(loads, us, strict=True)])
        x.sum(load, zeros(*loads.shape))  # for the next column

    def released(x: BodyStep) -> None:
        found = [_released(x, u, inside) for u, inside in zip(x.kept(push), x.inside(moved), strict=True)]
        x.answer(array, [a for a, _ in found], "body", "column")
        x.keep(moved, [moves for _, moves in found])

    return Pass("ground", still), Columns((Pass("inwards", pushed), Pass("outwards", released)))


FORWARD = (*bodies.FORWARD, *BODIES, Pass("outwards", _in_world_axes))
"""Forward dynamics, and the motion and the sums at the accelerations found."""

PASSES: dict[str, tuple[Pass | Columns, ...]] = {
    "mass_matrix": (*BODIES, Columns((Pass("column", _momentum), Pass("path", _coupled)))),
    "mass_matrix_inverse": (
        Pass("ground", ground),
        Pass("outwards", _free),
        Pass("inwards", _eliminated),
        Pass("outwards", _in_world_axes),
        *inverse("mass_matrix_inverse"),
    ),
}
"""Passes by recursion."""
