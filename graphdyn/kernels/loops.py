"""Robots with loops: dependent joints follow from independent ones, which are chosen once per robot.

J v = 0 gives v = K u' with K = [E; -(J_dᵀJ_d)⁻¹ J_dᵀ J_u]: the normal equations of the dependent columns do not care
which rows are redundant in which pose. Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 8.5.
Accelerations, torques and multipliers then follow as from couplings, with a K that depends on the pose.

Every chord is seen from the body nearest to the leaves that lies between the ground and both its ends, in joint axes:
there the rows of plane loops that hold nothing are zeros known while recording.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn._chord import Chord
from graphdyn._loops import CLOSED
from graphdyn._model import RobotModel
from graphdyn.kernels.factorization import inverted
from graphdyn.kernels.inertia import mass_matrix
from graphdyn.kernels.inverse import inverse_dynamics
from graphdyn.kernels.mechanism import Link, rounded
from graphdyn.kernels.motion import Motion, Place, Root, inertial_wrench, motions, places, rotations, stacked
from graphdyn.kernels.reactions import Wrench, transmitted
from graphdyn.kernels.vectors import E_Z, Scalars, cross, scalars, turn, turn_back, zeros

Columns = Sequence[Any]

CAUTION = 2e-6
"""Pivots of J_dᵀJ_d count this much: one of 5e-4 of the squares of all entries in its rows is as suspicious as one of
1e-9 of a mass matrix. Above it accelerations agree with the projected ones to 1e-12, below to 1e-11 and less."""

TINY = 1e20
"""Makes what is left below the bound of an open loop, of the size CLOSED² = 1e-16, comparable to pivots."""


@dataclass(frozen=True, eq=False)
class Seen:
    """A body as the ancestor sees it: joint axes, origin, and its motion at a = 0, in axes of the ancestor."""

    axes: Scalars
    origin: Scalars
    linear: Scalars
    angular: Scalars
    linear_drift: Scalars
    angular_drift: Scalars


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows of a chord that can move: J (k, n), γ (k), how far open (k), and which of its multipliers they have.

    on_i, on_j: force, and moment about O, on the bodies per unit of multiplier, in their joint axes   (k pairs)
    agreeing: what is positive unless an end is flipped
    """

    jacobian: Scalars
    bias: Scalars
    gap: Scalars
    numbers: list[int]
    on_i: list[Wrench]
    on_j: list[Wrench]
    agreeing: list[Any]


@dataclass(frozen=True, eq=False)
class Closing:
    """K (n, n_u), J_d (m, d), (J_dᵀJ_d)⁻¹, the rows of all chords, pivots and what says that loops are open."""

    motions: Scalars
    dependent: list[int]
    dependent_columns: Scalars
    inverse: Scalars
    rows: list[Rows]
    watched: list[Any]

    def opened_by(self, a: Columns) -> list[Any]:
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

    def multipliers(self, torques: Columns) -> Scalars:
        """Of the rows that can move, smallest first, whose Jᵀ λ are these torques (n)."""
        wanted = np.array([torques[j] for j in self.dependent], dtype=object)
        found: Scalars = self.dependent_columns @ (self.inverse @ wanted)
        return found


def closing(model: RobotModel, links: Sequence[Link], q: Columns, v: Columns) -> Closing:
    """Of q, v of all joints that no couplings drive."""
    at = places(links, q)
    rows = [_rows(links, at, chord, v) for chord in model.chords]
    jacobian = np.concatenate([row.jacobian for row in rows])
    dependent = list(model.dependent_joints)
    independent = [j for j in range(len(links)) if j not in dependent]
    columns = jacobian[:, dependent]
    normal = columns.T @ columns
    inverse, pivots = inverted(normal, [range(j)[::-1] for j in range(len(normal))])
    motions_of = zeros(len(links), len(independent))
    motions_of[independent, range(len(independent))] = 1.0
    motions_of[dependent, :] = -(inverse @ (columns.T @ jacobian[:, independent]))
    sizes = [sum(x * x for x in jacobian[[not _is_zero(x) for x in column]].ravel()) for column in columns.T]
    watched = [_ratio(pivot, size) * CAUTION for pivot, size in zip(pivots, sizes, strict=True)]
    for row in rows:
        watched += [1.0 - gap * gap * (1.0 / CLOSED**2) for gap in row.gap]
        watched += row.agreeing
        watched += [_opening(line, v, 0.0) for line in row.jacobian]
    return Closing(motions_of, dependent, columns, inverse, rows, watched)


def forward_dynamics(
    model: RobotModel,
    links: Sequence[Link],
    root: Root,
    q: Columns,
    v: Columns,
    tau: Columns,
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """As graphdyn.kernels.forward answers, with chord_multipliers, and forces along the pins."""
    held = closing(model, links, q, v)
    k, start = held.motions, held.start(len(links))
    mass = k.T @ mass_matrix(links, q) @ k
    inverse, pivots = inverted(mass, [range(j)[::-1] for j in range(len(mass))])
    needed = np.array(inverse_dynamics(links, root, q, v, start, external)["tau"], dtype=object)
    gained = k @ (inverse @ (k.T @ (np.array(tau, dtype=object) - needed)))
    a = [x + y for x, y in zip(start, gained, strict=True)]
    watched = [_ratio(pivot, size) for pivot, size in zip(pivots, mass.diagonal(), strict=True)]
    answer = _reactions(model, links, root, held, q, v, a, tau, external)
    return {"a": a, **answer, "pivots": held.watched + watched}


def inverse_dynamics_at_motors(
    model: RobotModel,
    links: Sequence[Link],
    root: Root,
    q: Columns,
    v: Columns,
    a: Columns,
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """As graphdyn.kernels.inverse answers, with torques at the actuated joints alone, the smallest that do."""
    held = closing(model, links, q, v)
    needed = np.array(inverse_dynamics(links, root, q, v, a, external)["tau"], dtype=object)
    to_motors, pivots = _actuation(model, held)
    tau = list(to_motors @ needed)
    answer = _reactions(model, links, root, held, q, v, a, tau, external)
    return {"tau": tau, **answer, "pivots": held.watched + held.opened_by(a) + pivots}


def at_motors(
    model: RobotModel,
    links: Sequence[Link],
    q: Columns,
    v: Columns,
    name: str,
    torques: Scalars | Columns,
    a: Columns = (),
) -> dict[str, list[Any]]:
    """Torques (n) or torques per parameter (n, k) of the joints without chords, at the actuated joints, by name.

    a: accelerations that must keep the loops closed, if any
    """
    held = closing(model, links, q, v)
    to_motors, pivots = _actuation(model, held)
    return {
        name: list((to_motors @ np.asarray(torques, dtype=object)).ravel()),
        "pivots": held.watched + (held.opened_by(a) if len(a) else []) + pivots,
    }


def _actuation(model: RobotModel, held: Closing) -> tuple[Scalars, list[Any]]:
    """T (n, n) with τ = T f: K_s (K_sᵀK_s)⁻¹ Kᵀ at the motors s, and what says that these leave a motion free."""
    motors = [model.joint_names.index(name) for name in model.actuated or ()]
    whole, of_motors = zeros(len(held.motions), len(held.motions)), held.motions[motors]
    square = of_motors.T @ of_motors
    inverse, pivots = inverted(square, [range(j)[::-1] for j in range(len(square))])
    whole[motors, :] = of_motors @ inverse @ held.motions.T
    if model.actuated is None:
        return whole, [0.0]  # suspicious, so that the specification refuses
    return whole, [_ratio(pivot, size) * CAUTION for pivot, size in zip(pivots, square.diagonal(), strict=True)]


def _reactions(
    model: RobotModel,
    links: Sequence[Link],
    root: Root,
    held: Closing,
    q: Columns,
    v: Columns,
    a: Columns,
    tau: Columns,
    external: Sequence[Wrench] | None,
) -> dict[str, list[Any]]:
    """body_accelerations, multipliers, joint_wrenches and chord_multipliers; zero in rows that hold nothing."""
    at = places(links, q)
    moving = motions(links, at, root, v, a)
    required = [inertial_wrench(*pair) for pair in zip(links, moving, strict=True)]
    without = transmitted(links, at, required, external)
    torques = [force[2] if link.prismatic else moment[2] for link, (force, moment) in zip(links, without, strict=True)]
    found = held.multipliers([x - y for x, y in zip(tau, torques, strict=True)])
    loads = [(zeros(3), zeros(3)) for _ in links] if external is None else list(external)
    of_chords, first = [], 0
    for chord, rows in zip(model.chords, held.rows, strict=True):
        multipliers = list(found[first : first + len(rows.numbers)])
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
    return {"chord_multipliers": of_chords, **_along_pins(links, at, root, moving, wrenches)}


def _along_pins(
    links: Sequence[Link], at: Sequence[Place], root: Root, moving: Sequence[Motion], wrenches: Sequence[Wrench]
) -> dict[str, list[Any]]:
    """body_accelerations; multipliers and joint_wrenches along t_1, t_2, p, which turn with the inside body."""
    accelerations, multipliers, along = [], [], []
    for link, place, motion, wrench, to_world in zip(
        links, at, moving, wrenches, rotations(links, at, root), strict=True
    ):
        at_center = motion.compensated + motion.spread() @ link.center_of_mass
        accelerations += [to_world @ at_center + root.gravity, link.link_axes @ motion.alpha]
        force, moment = (turn(place.c, place.s, part) for part in wrench)
        multipliers += [force[:2], moment] if link.prismatic else [force, moment[:2]]
        along += [force, moment]
    return {
        "body_accelerations": stacked(accelerations),
        "multipliers": stacked(multipliers),
        "joint_wrenches": stacked(along),
    }


def _rows(links: Sequence[Link], at: Sequence[Place], chord: Chord, v: Columns) -> Rows:
    paths = [_path(links, body - 1) for body in (chord.body_i, chord.body_j)]
    while paths[0] and paths[1] and paths[0][0] == paths[1][0]:
        paths = [path[1:] for path in paths]
    seen_i, seen_j = (_outwards(links, at, path, v) for path in paths)
    ends = (
        (chord.body_i, chord.placement_i, seen_i[-1]),
        (chord.body_j, chord.placement_j, seen_j[-1]),
    )
    (arm_i, turn_i), (arm_j, turn_j) = (
        (_in_joint_axes(links, body, placement.translation), _in_joint_axes(links, body, placement.rotation))
        for body, placement, _ in ends
    )
    (point_i, rate_i, drift_i), (point_j, rate_j, drift_j) = (
        _point(seen, seen.axes @ arm) for seen, arm in ((seen_i[-1], arm_i), (seen_j[-1], arm_j))
    )
    body_i, body_j = seen_i[-1], seen_j[-1]
    triad_i, triad_j = (
        seen.axes @ scalars(rounded(part.astype(float) @ chord.triad))
        for seen, part in ((body_i, turn_i), (body_j, turn_j))
    )
    apart, rate, drift = point_i - point_j, rate_i - rate_j, drift_i - drift_j
    jacobian, bias, gaps, numbers = [], [], [], []
    on_i: list[Wrench] = []
    on_j: list[Wrench] = []
    for number, name in enumerate(chord.rows):
        linear = not name.startswith("moment")
        if chord.length is not None:
            length = (apart @ apart) * (0.5 / chord.length) + 0.5 * chord.length  # |d| to second order, exact if closed
            u, gap = apart * (1.0 / chord.length), length - chord.length
            second = u @ drift + (rate @ rate - (u @ rate) * (u @ rate)) * (1.0 / chord.length)
        else:
            axis = ("t1", "t2", "p").index(name.split()[1])
            u, omega = triad_i[:, axis], body_i.angular
            u_dot = cross(omega, u)
            if linear:
                gap = u @ apart
                u_ddot = cross(body_i.angular_drift, u) + cross(omega, u_dot)
                second = u @ drift + 2.0 * (u_dot @ rate) + u_ddot @ apart
            else:
                gap = _turned(chord, triad_i, triad_j, axis)
                second = u @ (body_i.angular_drift - body_j.angular_drift) + u_dot @ (omega - body_j.angular)
        line = zeros(len(links))
        for path, seen, sign in ((paths[0], seen_i[1:], 1.0), (paths[1], seen_j[1:], -1.0)):
            for j, body in zip(path, seen, strict=True):
                axis_j = body.axes[:, 2]
                if links[j].prismatic:
                    line[j] = sign * (u @ axis_j) if linear else 0.0
                else:
                    line[j] = sign * (u @ (cross(axis_j, point_j - body.origin) if linear else axis_j))
        if all(_is_zero(x) for x in line):
            continue
        jacobian.append(line)
        bias.append(-second)
        gaps.append(gap)
        numbers.append(number)
        for store, end, sign in ((on_i, body_i, -1.0), (on_j, body_j, 1.0)):
            direction, lever = end.axes.T @ u, end.axes.T @ (point_j - end.origin)
            force = direction * sign
            store.append((force, cross(lever, force)) if linear else (zeros(3), force))
    agreeing = [] if chord.kind in ("distance", "ball") else [triad_i[:, 2] @ triad_j[:, 2]]
    if chord.kind in ("weld", "slide"):
        agreeing.append(triad_i[:, 0] @ triad_j[:, 0])
    return Rows(
        np.array(jacobian, dtype=object).reshape(-1, len(links)),
        np.array(bias, dtype=object),
        np.array(gaps, dtype=object),
        numbers,
        on_i,
        on_j,
        agreeing,
    )


def _turned(chord: Chord, triad_i: Scalars, triad_j: Scalars, axis: int) -> Any:
    """The sine of the angle of body i to body j about an axis of the chord, near enough to tell a closed loop."""
    if chord.kind == "hinge":
        return cross(triad_j[:, 2], triad_i[:, 2]) @ triad_i[:, axis]
    a, b = (axis + 1) % 3, (axis + 2) % 3
    return 0.5 * (triad_j[:, a] @ triad_i[:, b] - triad_j[:, b] @ triad_i[:, a])


def _path(links: Sequence[Link], body: int) -> list[int]:
    """The joints from the ground to a body, outwards."""
    path: list[int] = []
    while body >= 0:
        path.insert(0, body)
        body = links[body].inside
    return path


def _outwards(links: Sequence[Link], at: Sequence[Place], path: Sequence[int], v: Columns) -> list[Seen]:
    """The ancestor itself, at rest, and the bodies of a path as it sees them."""
    done = [Seen(scalars(np.eye(3)), *(zeros(3) for _ in range(5)))]
    for j in path:
        inside, place, link = done[-1], at[j], links[j]
        axes = turn_back(place.c, place.s, (inside.axes @ place.rotation).T).T
        arm, omega = inside.axes @ place.translation, inside.angular
        spin = cross(omega, arm)
        linear, angular = inside.linear + spin, inside.angular
        drift = inside.linear_drift + cross(inside.angular_drift, arm) + cross(omega, spin)
        angular_drift = inside.angular_drift
        rate = (axes @ E_Z) * v[j]
        if link.prismatic:
            linear, drift = linear + rate, drift + 2.0 * cross(omega, rate)
        else:
            angular, angular_drift = angular + rate, angular_drift + cross(omega, rate)
        done.append(Seen(axes, inside.origin + arm, linear, angular, drift, angular_drift))
    return done


def _point(seen: Seen, arm: Scalars) -> tuple[Scalars, Scalars, Scalars]:
    """Place, velocity and acceleration at a = 0 of a point of a body."""
    spin = cross(seen.angular, arm)
    drift = seen.linear_drift + cross(seen.angular_drift, arm) + cross(seen.angular, spin)
    return seen.origin + arm, seen.linear + spin, drift


def _in_joint_axes(links: Sequence[Link], body: int, given: Any) -> Scalars:
    """A vector or matrix of link axes."""
    return scalars(given) if body == 0 else links[body - 1].link_axes.T @ scalars(given)


def _opening(line: Scalars, rates: Columns, wanted: Any) -> Any:
    """Negative where a row times rates is not as wanted, to CLOSED of its terms."""
    terms = [x * rate for x, rate in zip(line, rates, strict=True)]
    error, size = sum(terms) - wanted, sum(x * x for x in terms) + wanted * wanted
    return (size * CLOSED**2 - error * error) * TINY + 1e-6


def _is_zero(scalar: Any) -> bool:
    return isinstance(scalar, float | int) and scalar == 0


def _ratio(pivot: Any, size: Any) -> Any:
    """pivot / size, and the pivot itself where it is known to be zero."""
    return pivot if _is_zero(pivot) else pivot / size
