"""The rows of chords, J a = γ, as recursions state them, and which forces on their bodies go with them.

Every chord is seen from the body nearest to the leaves that lies between the ground and both its ends, in joint axes:
there the rows of plane loops that hold nothing are zeros known while recording.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.model.chord import Chord
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions.inverse import Wrench
from graphdyn.recursions.mechanism.mechanism import Link, Links, path, rounded
from graphdyn.recursions.motion import JointPlacement, places
from graphdyn.scalars.vectors import E_Z, PerJoint, Scalars, cross, is_known, scalars, turn_back, zeros


@dataclass(frozen=True, eq=False)
class _AncestorView:
    """A body as the ancestor sees it: joint axes, origin, and its motion at a = 0, in axes of the ancestor."""

    axes: Scalars
    origin: Scalars
    linear: Scalars
    angular: Scalars
    linear_drift: Scalars
    angular_drift: Scalars


@dataclass(frozen=True, eq=False)
class ChordRows:
    """The rows of a chord that can move, in units of theirs: J (k, n), γ (k), how far open (k), and which of its
    multipliers they have.

    units: of the rows                                      (k)
    on_i, on_j: force, and moment about O, on the bodies per unit of multiplier, in their joint axes   (k pairs)
    agreeing: what is positive unless an end is flipped
    """

    jacobian: Scalars
    bias: Scalars
    gap: Scalars
    numbers: list[int]
    units: list[float]
    on_i: list[Wrench]
    on_j: list[Wrench]
    agreeing: list[Any]


def rows_of_chords(model: RobotModel, links: Links, q: PerJoint, v: PerJoint) -> list[ChordRows]:
    """Rows of all chords at q, v of all joints, in their units (Loops.row_units)."""
    at, rows, first = places(links, q), list[ChordRows](), 0
    for chord in model.chords:
        own = slice(first, first := first + len(chord.rows))
        rows.append(chord_rows(links, at, chord, v, model.loops.row_units[own].tolist()))
    return rows


def chord_rows(
    links: Links, at: Sequence[JointPlacement], chord: Chord, v: PerJoint, units: Sequence[float]
) -> ChordRows:
    """Rows of the chords at q, v of all joints that no couplings drive; at: the places of their bodies; units: of all
    its rows."""
    paths = [path(links, body - 1) for body in (chord.body_i, chord.body_j)]
    # the joints that carry both ends move neither end against the other
    while paths[0] and paths[1] and paths[0][0] == paths[1][0]:
        paths = [joints[1:] for joints in paths]
    seen_i, seen_j = (_outwards(links, at, joints, v) for joints in paths)
    ends = _ends(links, chord, seen_i[-1], seen_j[-1])
    jacobian, bias, gaps, numbers, on_i, on_j = [], [], [], [], list[Wrench](), list[Wrench]()
    for number, name in enumerate(chord.rows):
        linear = not name.startswith("moment")
        u, gap, second = _row(chord, ends, name)
        line = zeros(len(links))
        for joints, seen, sign in ((paths[0], seen_i[1:], 1.0), (paths[1], seen_j[1:], -1.0)):
            for j, body in zip(joints, seen, strict=True):
                line[j] = sign * (u @ _motion(links[j], body, ends.point_j, linear))
        # a row that no joint can move, as those out of the plane of a plane loop
        if all(is_known(x, 0.0) for x in line):
            continue
        per_unit = 1.0 / units[number]
        jacobian.append(line * per_unit)
        bias.append(-second * per_unit)
        gaps.append(gap * per_unit)
        numbers.append(number)
        for store, end, sign in ((on_i, ends.body_i, -1.0), (on_j, ends.body_j, 1.0)):
            # the multiplier acts on body j along u, and on body i against it; a moment comes without a force
            direction, lever = end.axes.T @ u, end.axes.T @ (ends.point_j - end.origin)
            force = direction * sign
            store.append((force, cross(lever, force)) if linear else (zeros(3), force))
    # the sines of the gaps vanish for an end turned by 180° too; these cosines then are negative
    agreeing = [] if chord.kind in ("distance", "ball") else [ends.triad_i[:, 2] @ ends.triad_j[:, 2]]
    if chord.kind in ("weld", "slide"):
        agreeing.append(ends.triad_i[:, 0] @ ends.triad_j[:, 0])
    return ChordRows(
        np.array(jacobian, dtype=object).reshape(-1, len(links)),
        np.array(bias, dtype=object),
        np.array(gaps, dtype=object),
        numbers,
        [units[number] for number in numbers],
        on_i,
        on_j,
        agreeing,
    )


def _motion(link: Link, body: _AncestorView, point: Scalars, linear: bool) -> Scalars:
    """Velocity of a point of a body, or angular velocity, per rate of its joint."""
    axis = body.axes[:, 2]
    if link.prismatic:
        return axis if linear else zeros(3)
    return cross(axis, point - body.origin) if linear else axis


@dataclass(frozen=True, eq=False)
class _Ends:
    """The bodies of a chord, its axes on both, its origin on body j, and how that on body i moves relative to it.

    drift: relative acceleration at a = 0
    """

    body_i: _AncestorView
    body_j: _AncestorView
    triad_i: Scalars
    triad_j: Scalars
    point_j: Scalars
    apart: Scalars
    rate: Scalars
    drift: Scalars


def _ends(links: Links, chord: Chord, body_i: _AncestorView, body_j: _AncestorView) -> _Ends:
    given = ((chord.body_i, chord.placement_i, body_i), (chord.body_j, chord.placement_j, body_j))
    (point_i, rate_i, drift_i), (point_j, rate_j, drift_j) = (
        _point(seen, seen.axes @ _in_joint_axes(links, body, placement.translation)) for body, placement, seen in given
    )
    triad_i, triad_j = (
        seen.axes @ scalars(rounded(_in_joint_axes(links, body, placement.rotation).astype(float) @ chord.triad))
        for body, placement, seen in given
    )
    return _Ends(body_i, body_j, triad_i, triad_j, point_j, point_i - point_j, rate_i - rate_j, drift_i - drift_j)


def _row(chord: Chord, ends: _Ends, name: str) -> tuple[Scalars, Any, Any]:
    """The direction u of a row, the gap φ, and φ̈ at a = 0."""
    apart, rate, drift = ends.apart, ends.rate, ends.drift
    if chord.length is not None:
        length = (apart @ apart) * (0.5 / chord.length) + 0.5 * chord.length  # |d| to second order, exact if closed
        u = apart * (1.0 / chord.length)
        second = u @ drift + (rate @ rate - (u @ rate) * (u @ rate)) * (1.0 / chord.length)
        return u, length - chord.length, second
    what, along = name.split()
    axis = ("t1", "t2", "p").index(along)
    u, omega = ends.triad_i[:, axis], ends.body_i.angular
    u_dot = cross(omega, u)
    if what == "moment":
        relative, drifting = omega - ends.body_j.angular, ends.body_i.angular_drift - ends.body_j.angular_drift
        return u, _turned(chord, ends, axis), u @ drifting + u_dot @ relative
    # φ = u·d with u fixed in body i: φ̈ = u·d̈ + 2 u̇·ḋ + ü·d
    u_ddot = cross(ends.body_i.angular_drift, u) + cross(omega, u_dot)
    return u, u @ apart, u @ drift + 2.0 * (u_dot @ rate) + u_ddot @ apart


def _turned(chord: Chord, ends: _Ends, axis: int) -> Any:
    """The sine of the angle of body i to body j about an axis of the chord, near enough to tell a closed loop."""
    on_i, on_j = ends.triad_i, ends.triad_j
    # of a hinge the two axes p must agree, of others the whole triads
    if chord.kind == "hinge":
        return cross(on_j[:, 2], on_i[:, 2]) @ on_i[:, axis]
    a, b = (axis + 1) % 3, (axis + 2) % 3
    return 0.5 * (on_j[:, b] @ on_i[:, a] - on_j[:, a] @ on_i[:, b])


def _outwards(links: Links, at: Sequence[JointPlacement], joints: Sequence[int], v: PerJoint) -> list[_AncestorView]:
    """The ancestor itself, at rest, and the bodies of a path as it sees them."""
    done = [_AncestorView(scalars(np.eye(3)), *(zeros(3) for _ in range(5)))]
    for j in joints:
        inside, place, link = done[-1], at[j], links[j]
        axes = turn_back(place.c, place.s, (inside.axes @ place.rotation).T).T
        arm, omega = inside.axes @ place.translation, inside.angular
        spin = cross(omega, arm)
        # first as if the joint were locked; then what its rate adds (2 ω × rate for a slide, ω × rate for a turn)
        linear, angular = inside.linear + spin, inside.angular
        drift = inside.linear_drift + cross(inside.angular_drift, arm) + cross(omega, spin)
        angular_drift = inside.angular_drift
        rate = (axes @ E_Z) * v[j]
        if link.prismatic:
            linear, drift = linear + rate, drift + 2.0 * cross(omega, rate)
        else:
            angular, angular_drift = angular + rate, angular_drift + cross(omega, rate)
        done.append(_AncestorView(axes, inside.origin + arm, linear, angular, drift, angular_drift))
    return done


def _point(seen: _AncestorView, arm: Scalars) -> tuple[Scalars, Scalars, Scalars]:
    """Place, velocity and acceleration at a = 0 of a point of a body."""
    spin = cross(seen.angular, arm)
    drift = seen.linear_drift + cross(seen.angular_drift, arm) + cross(seen.angular, spin)
    return seen.origin + arm, seen.linear + spin, drift


def _in_joint_axes(links: Links, body: int, given: Any) -> Scalars:
    """A vector or matrix of link axes."""
    return scalars(given) if body == 0 else links[body - 1].link_axes.T @ scalars(given)
