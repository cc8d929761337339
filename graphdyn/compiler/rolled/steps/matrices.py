"""The mass matrix, its inverse, and what the inverse multiplies, column after column.

What joint j moves is passed on inwards, origin by origin, and felt by every joint on the way.
"""

from __future__ import annotations

from typing import Any

from graphdyn.compiler.rolled.program import ColumnPasses, Pass, Product
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.compiler.rolled.steps import bodies
from graphdyn.compiler.rolled.steps.bodies import entries, inertia_of, place_of
from graphdyn.compiler.rolled.steps.world import (
    BODIES,
    along,
    ground,
    per_rate,
    placed,
    shifted,
)
from graphdyn.recursions.forward import Inertia, seen_through_joint
from graphdyn.recursions.motion import places
from graphdyn.scalars.vectors import zeros

# Mass matrix: Featherstone, "Rigid Body Dynamics Algorithms", 2008, table 6.2


def _momentum(x: BodyStep) -> None:
    x.carry("momentum", per_rate(x))


def _coupled(x: BodyStep) -> None:
    momentum = x.carried("momentum")
    entry = along(x, momentum)
    x.answer("mass_matrix", entry, "body", "column")
    x.answer("mass_matrix", entry, "column", "body")
    x.carry("momentum", shifted(momentum, x.kept("arm")))


# M⁻¹ = Yᵀ D⁻¹ Y. Y_kj is what joint k feels of a unit torque on joint j outside of it when all joints outside of k are
# free to move. Bodies are eliminated from the leaves to the ground, once for all columns: Featherstone, 2008, table
# 7.1, without velocities.


def _free(x: BodyStep) -> None:
    """Place of the body, and I^A of it alone, in joint axes."""
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


def _pushed(x: BodyStep) -> None:
    """A unit torque on the joint of the column."""
    _push(x, 1.0, (zeros(3), zeros(3)))


def _pushed_back(x: BodyStep) -> None:
    load = x.carried("load")
    _push(x, -along(x, load), load)


def _push(x: BodyStep, u: Any, load: Any) -> None:
    """u: torque that moves the joint; the inside body feels the load and U u / D."""
    U, gain = x.kept("world_U"), x.kept("gain")[0] * u
    x.answer("pushes", u, "body", "column")
    x.answer("released", gain, "body", "column")
    x.carry("load", shifted((load[0] + U[0] * gain, load[1] + U[1] * gain), x.kept("arm")))


def inverse(array: str) -> tuple[ColumnPasses, Product]:
    """M⁻¹, of eliminated bodies."""
    columns = ColumnPasses((Pass("column", _pushed), Pass("beyond", _pushed_back)))
    return columns, Product("pushes", "released", array, triangular=True)


ACCELERATED = (*bodies.FORWARD, *BODIES, Pass("outwards", _in_world_axes))
"""Forward dynamics, and the motion and the sums at the accelerations found."""

PASSES: dict[str, tuple[Pass | ColumnPasses | Product, ...]] = {
    "mass_matrix": (*BODIES, ColumnPasses((Pass("column", _momentum), Pass("path", _coupled)))),
    "mass_matrix_inverse": (
        Pass("ground", ground),
        Pass("outwards", _free),
        Pass("inwards", _eliminated),
        Pass("outwards", _in_world_axes),
        *inverse("mass_matrix_inverse"),
    ),
}
"""Passes by recursion."""
