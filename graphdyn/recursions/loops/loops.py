"""Robots with loops: dependent joints follow from independent ones, which are chosen once per robot.

J v = 0 gives v = K u' with K = [E; -(J_dᵀJ_d)⁻¹ J_dᵀ J_u]: the normal equations of the dependent columns do not care
which rows are redundant in which pose. Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 8.5.
Accelerations, torques and multipliers then follow as from couplings, with a K that depends on the pose.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.model.loops import CLOSED_TOLERANCE
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions.declarations import Recursion, with_chords
from graphdyn.recursions.inertia import inverted, mass_matrix
from graphdyn.recursions.inverse import Loads, along_pins, transmitted
from graphdyn.recursions.loops.chords import ChordRows, rows_of_chords
from graphdyn.recursions.loops.couplings import torques
from graphdyn.recursions.mechanism.mechanism import Links
from graphdyn.recursions.motion import Root, inertial_wrench, motions, places
from graphdyn.scalars.vectors import PerJoint, Scalars, is_known, zeros

DEPENDENT_PIVOT_FACTOR = 2e-6
"""Pivots of J_dᵀJ_d count this much: one of 5e-4 of the squares of all entries in its rows is as suspicious as one of
1e-9 of a mass matrix. Above it accelerations agree with the projected ones to 1e-12, below to 1e-11 and less."""

OPEN_LOOP_FACTOR = 1e20
"""Makes what is left below the bound of an open loop, of the size CLOSED² = 1e-16, comparable to pivots."""


@dataclass(frozen=True, eq=False)
class Closing:
    """K (n, n_u), J_d (m, d), (J_dᵀJ_d)⁻¹, the rows of all chords, pivots and what says that loops are open.

    Rows are in their units (Loops.row_units).
    """

    motions: Scalars
    dependent: list[int]
    dependent_columns: Scalars
    inverse: Scalars
    rows: list[ChordRows]
    guarded: list[Any]

    def opened_by(self, a: PerJoint) -> list[Any]:
        """Negative where accelerations (n) of all joints open a loop."""
        return [
            _opening(line, a, bias) for rows in self.rows for line, bias in zip(rows.jacobian, rows.bias, strict=True)
        ]

    def start(self, n: int) -> list[Any]:
        """The accelerations (n) of the dependent joints while the independent ones have none."""
        bias = np.concatenate([row.bias for row in self.rows])
        a: list[Any] = [0.0] * n
        for j, x in zip(self.dependent, self.inverse @ (self.dependent_columns.T @ bias), strict=True):
            a[j] = x
        return a

    def multipliers(self, torques: Sequence[Any]) -> Scalars:
        """Multipliers of the rows that can move, smallest first, whose Jᵀ λ are these torques (n)."""
        wanted = np.array([torques[j] for j in self.dependent], dtype=object)
        found: Scalars = self.dependent_columns @ (self.inverse @ wanted)
        return found


def closing(model: RobotModel, links: Links, q: PerJoint, v: PerJoint) -> Closing:
    """The closing at q, v of all joints that no couplings drive."""
    rows = rows_of_chords(model, links, q, v)
    jacobian = np.concatenate([row.jacobian for row in rows])
    dependent = list(model.dependent_joints)
    independent = [j for j in range(len(links)) if j not in dependent]
    units = model.loops.in_sizes.column_units
    columns, in_units = jacobian[:, dependent], jacobian * units
    normal = in_units[:, dependent].T @ in_units[:, dependent]
    inverse, pivots = inverted(normal, [range(j)[::-1] for j in range(len(normal))])
    inverse = inverse * np.outer(units[dependent], units[dependent])
    motions_of = zeros(len(links), len(independent))
    motions_of[independent, range(len(independent))] = 1.0
    motions_of[dependent, :] = -(inverse @ (columns.T @ jacobian[:, independent]))
    sizes = [sum(x * x for x in in_units[[not is_known(x, 0.0) for x in column]].ravel()) for column in columns.T]
    guarded = [_ratio(pivot, size) * DEPENDENT_PIVOT_FACTOR for pivot, size in zip(pivots, sizes, strict=True)]
    for row in rows:
        guarded += [1.0 - gap * gap * (1.0 / CLOSED_TOLERANCE**2) for gap in row.gap]
        guarded += row.agreeing
        guarded += [_opening(line, v, 0.0) for line in row.jacobian]
    return Closing(motions_of, dependent, columns, inverse, rows, guarded)


@with_chords
def forward_dynamics(
    model: RobotModel, links: Links, root: Root, q: PerJoint, v: PerJoint, tau: PerJoint, external: Loads = None
) -> dict[str, list[Any]]:
    """Answers like those of graphdyn.recursions.forward, with chord_multipliers, and forces along the pins."""
    held = closing(model, links, q, v)
    k, start = held.motions, held.start(len(links))
    mass = k.T @ mass_matrix(links, q) @ k
    inverse, pivots = inverted(mass, [range(j)[::-1] for j in range(len(mass))])
    needed = torques(links, root, q, v, start, external)
    gained = k @ (inverse @ (k.T @ (np.array(tau, dtype=object) - needed)))
    a = [x + y for x, y in zip(start, gained, strict=True)]
    guarded = [_ratio(pivot, size) for pivot, size in zip(pivots, mass.diagonal(), strict=True)]
    answer = _reactions(model, links, root, held, q, v, a, tau, external)
    return {"a": a, **answer, "pivots": held.guarded + guarded}


@with_chords
def inverse_dynamics(
    model: RobotModel, links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint, external: Loads = None
) -> dict[str, list[Any]]:
    """Answers like those of graphdyn.recursions.inverse, with torques at the actuated joints alone, the smallest that
    do."""
    held = closing(model, links, q, v)
    needed = torques(links, root, q, v, a, external)
    to_motors, pivots = _actuation(model, held)
    tau = list(to_motors @ needed)
    answer = _reactions(model, links, root, held, q, v, a, tau, external)
    return {"tau": tau, **answer, "pivots": held.guarded + held.opened_by(a) + pivots}


def at_motors(recursion: Recursion) -> Callable[..., dict[str, Any]]:
    """The form for robots with chords of a recursion that answers torques (n) or torques per parameter (n, k).

    What the recursion answers for the joints without chords, at the actuated joints. Accelerations, where it takes
    some, must keep the loops closed.
    """

    def at_actuated(x: Any, q: PerJoint, v: PerJoint | None = None, *a: PerJoint) -> dict[str, Any]:
        ((name,), arrays) = recursion.outputs, (q, *([] if v is None else [v]), *a)
        of_tree = np.asarray(recursion.compute(x, *arrays), dtype=object)
        held = closing(x.model, x.links, q, x.zeros if v is None else v)
        to_motors, pivots = _actuation(x.model, held)
        opened = [each for rates in a for each in held.opened_by(rates)]
        return {name: to_motors @ of_tree, "pivots": held.guarded + opened + pivots}

    return at_actuated


def _actuation(model: RobotModel, held: Closing) -> tuple[Scalars, list[Any]]:
    """T (n, n) with τ = T f: K_s (K_sᵀK_s)⁻¹ Kᵀ at the motors s, and what says that these leave a motion free."""
    motors = [model.joint_names.index(name) for name in model.actuated or ()]
    units = model.loops.column_units
    independent = [j for j in range(len(held.motions)) if j not in held.dependent]
    whole, motions_of = zeros(len(held.motions), len(held.motions)), held.motions * units[independent]
    of_motors = motions_of[motors] * (1.0 / units[motors, None])
    square = of_motors.T @ of_motors
    inverse, pivots = inverted(square, [range(j)[::-1] for j in range(len(square))])
    whole[motors, :] = (of_motors @ inverse @ motions_of.T) * (1.0 / units[motors, None])
    if model.actuated is None:
        return whole, [0.0]  # suspicious, so that the specification refuses
    return whole, [
        _ratio(pivot, size) * DEPENDENT_PIVOT_FACTOR for pivot, size in zip(pivots, square.diagonal(), strict=True)
    ]


def _reactions(
    model: RobotModel,
    links: Links,
    root: Root,
    held: Closing,
    q: PerJoint,
    v: PerJoint,
    a: PerJoint,
    tau: PerJoint,
    external: Loads,
) -> dict[str, list[Any]]:
    """body_accelerations, multipliers, joint_wrenches and chord_multipliers; zero in rows that hold nothing."""
    at = places(links, q)
    moving = motions(links, at, root, v, a)
    required = [inertial_wrench(*pair) for pair in zip(links, moving, strict=True)]
    without = transmitted(links, at, required, external)
    needed = [force[2] if link.prismatic else moment[2] for link, (force, moment) in zip(links, without, strict=True)]
    found = held.multipliers([x - y for x, y in zip(tau, needed, strict=True)])
    loads = [(zeros(3), zeros(3)) for _ in links] if external is None else list(external)
    of_chords, first = [], 0
    for chord, rows in zip(model.chords, held.rows, strict=True):
        of_rows = found[first : first + len(rows.numbers)]
        multipliers = [x * (1.0 / unit) for x, unit in zip(of_rows, rows.units, strict=True)]
        first += len(rows.numbers)
        whole: list[Any] = [0.0] * len(chord.rows)
        for number, multiplier, on_i, on_j in zip(rows.numbers, multipliers, rows.on_i, rows.on_j, strict=True):
            whole[number] = multiplier
            for body, (force, moment) in ((chord.body_i, on_i), (chord.body_j, on_j)):
                if body:
                    f, n = loads[body - 1]
                    loads[body - 1] = f + force * multiplier, n + moment * multiplier
        of_chords += whole
    wrenches = transmitted(links, at, required, loads)
    return {"chord_multipliers": of_chords, **along_pins(links, at, root, moving, wrenches)}


def _opening(line: Scalars, rates: Sequence[Any], wanted: Any) -> Any:
    """Negative where a row times rates is not as wanted, to CLOSED of its terms."""
    terms = [x * rate for x, rate in zip(line, rates, strict=True)]
    error, size = sum(terms) - wanted, sum(x * x for x in terms) + wanted * wanted
    return (size * CLOSED_TOLERANCE**2 - error * error) * OPEN_LOOP_FACTOR + 1e-6


def _ratio(pivot: Any, size: Any) -> Any:
    """pivot / size, and the pivot itself where it is known to be zero."""
    return pivot if is_known(pivot, 0.0) else pivot / size
