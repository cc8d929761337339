"""The loops of a robot as geometry: how far chords are from closed, and which joint motions keep them closed.

Rows are relative motions of body i to body j along directions fixed in body i (distance: along its line): φ = 0,
J v = 0, J a = γ. Nothing here depends on masses, nor on where the ground stands: everything is relative to the ground.

Rank and null spaces of the rows that chords add, pose by pose.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from graphdyn.layout import Array
from graphdyn.model.chord import Chord
from graphdyn.model.coupling import DegreesOfFreedom
from graphdyn.model.graph import Graph
from graphdyn.model.parts import Joint
from graphdyn.model.spatial import apply, cross, rotation_vector

CLOSED_TOLERANCE = 1e-8
"""Largest gap of a closed loop [rad, m in the unit of its loop (Loops.row_units)], and largest relative velocity or
acceleration along a row, relative to the terms that are summed. Assembled states reach 1e-14; angles written to a file
with nine digits still pass."""

SMALL_LOOP, LARGE_LOOP = 0.01, 100.0
"""Loops between these sizes [m] measure gaps in meters; smaller and larger ones in a unit that shrinks and grows with
them, so that a linkage of a micrometer closes as well, for its size, as one of a centimeter."""

LOOP_RANK_TOLERANCE = 1e-6
"""Singular values of J, in the units of its loops, below this part of the largest count as zero: far above what a gap
of CLOSED_TOLERANCE makes of a zero, far below those of a mechanism that works."""

NEAR_SINGULAR_SHARE = 3e-4
"""Singular values of J, in the units of its loops, below this part of the largest are looked at to second order: where
a gap of CLOSED_TOLERANCE is of second order in a motion, it leaves singular values of its root, 1e-4."""

SECOND_ORDER_SHARE = 1e-4
"""Part of the largest γ along redundant rows that is rounding and gaps: below, motions go on to second order."""

SELF_STRESS_SHARE = 1e-6
"""A reaction takes part in a self-stress if its entry reaches this part of the largest: far above rounding and the gaps
that count as CLOSED_TOLERANCE, which leave entries of their size."""


@dataclass(frozen=True, eq=False)
class Links:
    """Ground (row 0) and link frames relative to the ground, and with which velocity and acceleration at a = 0.

    rotation (…, n+1, 3, 3), origin (…, n+1, 3); axis: of the joints   (…, n, 3)
    linear, angular, linear_drift, angular_drift: of the frames; zero where no v was given   (…, n+1, 3)
    """

    rotation: Array
    origin: Array
    axis: Array
    linear: Array
    angular: Array
    linear_drift: Array
    angular_drift: Array

    def rows(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> Links:
        """Values at some of the states (N, …)."""
        return Links(**{name: array[which] for name, array in vars(self).items()})

    def replace_rows(self, which: NDArray[np.intp], others: Links) -> None:
        """Take over those at other states, in place."""
        for name, array in vars(self).items():
            array[which] = getattr(others, name)


@dataclass(frozen=True, eq=False)
class Ends:
    """A chord at a state.

    point_i, point_j: its origins on both bodies            (…, 3)
    directions: of its linear rows, then of its angular ones  (…, rows, 3)
    n_linear: how many are linear
    """

    chord: Chord
    point_i: Array
    point_j: Array
    directions: Array
    n_linear: int


class Loops:
    """The loops that chords close over the joints of a tree; q and v are those of joints that no others drive.

    row_units: units of the gaps                            (m,)  [1; m where a row is a distance]
    column_units: units of q                                (nv,)  [1; m where a joint slides]
    length_unit: the largest unit of length, in which lengths of all loops are compared with angles [m]
    """

    def __init__(self, joints: Sequence[Joint], chords: Sequence[Chord], degrees_of_freedom: DegreesOfFreedom) -> None:
        self.joints, self.chords, self.degrees_of_freedom = tuple(joints), tuple(chords), degrees_of_freedom
        self.n_rows = sum(len(chord.rows) for chord in chords)
        on_path = Graph(tuple(joint.inside for joint in joints)).path_matrix()
        self.paths = np.vstack([np.zeros(len(joints)), on_path.T])  # which joints lie between the ground and a body
        self.turns = np.array([not joint.is_prismatic for joint in joints])
        self._around = [self.paths[chord.body_i] != self.paths[chord.body_j] for chord in chords]
        self._sizes = [_size(joints, chord, members) for chord, members in zip(chords, self._around, strict=True)]
        self._measure([length_unit(size) for size in self._sizes])

    def _measure(self, units: Sequence[float]) -> None:
        """Takes units of length, one for each chord [m]."""
        self.length_unit = max(units, default=1.0)
        self.row_units = np.array(
            [
                1.0 if name.startswith("moment") else unit
                for chord, unit in zip(self.chords, units, strict=True)
                for name in chord.rows
            ]
        )
        of_joints = [
            max([u for u, members in zip(units, self._around, strict=True) if members[k]], default=1.0)
            for k in range(len(self.joints))
        ]
        self.column_units = np.where(self.turns, 1.0, of_joints)[list(self.degrees_of_freedom.independent)]

    @cached_property
    def in_sizes(self) -> Loops:
        """The same loops with their sizes as units: what is found in these is the same for a linkage of any size."""
        same = copy(self)
        same._measure([size or 1.0 for size in self._sizes])
        same.__dict__["in_sizes"] = same
        return same

    @property
    def free_joints(self) -> tuple[Joint, ...]:
        """The joints that no others drive."""
        return tuple(self.joints[k] for k in self.degrees_of_freedom.independent)

    def row_names(self) -> tuple[str, ...]:
        """Such as "closing_hinge force t1", in the order of the rows."""
        return tuple(f"{chord.name} {row}" for chord in self.chords for row in chord.rows)

    def links(self, q: Array, v: Array | None = None) -> Links:
        """Positions and velocities of all joints at q, v (…, nv)."""
        positions = q @ self.degrees_of_freedom.matrix.T + self.degrees_of_freedom.offset
        rates = None if v is None else v @ self.degrees_of_freedom.matrix.T
        batch, n = positions.shape[:-1], len(self.joints)
        number = np.result_type(positions, *(() if rates is None else (rates,)))
        rotation = np.empty((*batch, n + 1, 3, 3), dtype=number)
        rotation[..., 0, :, :] = np.eye(3)
        axis = np.empty((*batch, n, 3), dtype=number)
        origin, linear, angular, linear_drift, angular_drift = (
            np.zeros((*batch, n + 1, 3), dtype=number) for _ in range(5)
        )
        for j, joint in enumerate(self.joints, start=1):
            i, k = joint.inside, j - 1
            in_ground = rotation[..., i, :, :] @ joint.placement.rotation
            p = axis[..., k, :] = in_ground @ joint.axis
            arm = rotation[..., i, :, :] @ joint.placement.translation
            if joint.is_prismatic:
                arm = arm + positions[..., k, None] * p
                rotation[..., j, :, :] = in_ground
            else:
                rotation[..., j, :, :] = in_ground @ joint.turn(positions[..., k])
            origin[..., j, :] = origin[..., i, :] + arm
            if rates is None:
                continue
            rate, omega, drift = rates[..., k, None] * p, angular[..., i, :], angular_drift[..., i, :]
            angular[..., j, :], angular_drift[..., j, :] = omega, drift
            if not joint.is_prismatic:
                angular[..., j, :] += rate
                angular_drift[..., j, :] += cross(omega, rate)
                rate = np.zeros_like(rate)
            carried = cross(omega, arm)
            linear[..., j, :] = linear[..., i, :] + carried + rate
            turning = cross(drift, arm) + cross(omega, carried)
            linear_drift[..., j, :] = linear_drift[..., i, :] + turning + 2 * cross(omega, rate)
        return Links(rotation, origin, axis, linear, angular, linear_drift, angular_drift)

    def ends(self, links: Links) -> list[Ends]:
        """All chords at a state."""
        return [_ends(chord, links) for chord in self.chords]

    def gaps(self, q: Array) -> Array:
        """How far body i is from where its chord would have it on body j, row by row (…, m) [m, rad].

        Orientations by the angle of the shortest turn, so that a body flipped by 180° is not closed.
        """
        return self.gaps_of(self.links(q))

    def gaps_of(self, links: Links) -> Array:
        """The gaps (…, m) of links that are known."""
        return np.concatenate([_gap(end, links) for end in self.ends(links)], axis=-1)

    def jacobian(self, links: Links) -> Array:
        """J (…, m, nv)."""
        rows = []
        for end in self.ends(links):
            between = (self.paths[end.chord.body_i] - self.paths[end.chord.body_j])[:, None]  # (n, 1)
            lever = end.point_j[..., None, :] - links.origin[..., 1:, :]
            at_point = np.where(self.turns[:, None], cross(links.axis, lever), links.axis) * between
            turning = np.where(self.turns[:, None], links.axis, 0.0) * between
            moves = (end.directions[..., : end.n_linear, :], end.directions[..., end.n_linear :, :])
            rows += [u @ np.swapaxes(motion, -1, -2) for u, motion in zip(moves, (at_point, turning), strict=True)]
        return np.concatenate(rows, axis=-2) @ self.degrees_of_freedom.matrix

    def in_units(self, jacobian: Array) -> Array:
        """J (…, m, nv) in the units of its rows and columns: without dimension."""
        scaled: Array = jacobian * (self.column_units / self.row_units[:, None])
        return scaled

    def widest(self, gaps: Array) -> Array:
        """Largest of gaps (…, m) in their units (…)."""
        largest: Array = (np.abs(gaps) / self.row_units).max(axis=-1, initial=0.0)
        return largest

    def spaces(self, jacobian: Array, share: float = LOOP_RANK_TOLERANCE) -> LoopSpaces:
        """Spaces of J (…, m, nv), computed in units; its rank, by this share, in the sizes of the loops."""
        values = np.linalg.svd(self.in_sizes.in_units(jacobian), compute_uv=False)
        found = loop_spaces(self.in_units(jacobian), rank=np.count_nonzero(_counted(values, share), axis=-1))
        return LoopSpaces(found.left / self.row_units[:, None], found.right * self.column_units[:, None], found.inverse)

    def shaky_motions(self, q: Array) -> Array:
        """Joint motions (nv, k) at a pose q (nv,), orthonormal in units, that close the loops to first order only.

        A motion v with J v = 0 goes on where J a = γ(v) has a solution: where wᵀγ(v) = 0 for all w with wᵀJ = 0
        (Connelly and Whiteley, "Second-order rigidity and prestress stability for tensegrity frameworks", SIAM Journal
        on Discrete Mathematics 9(3), 1996). In a regular pose wᵀγ vanishes with all pairs of closed motions; in a
        singular one it tells which lie on none of its branches, or that there are none.
        """
        spaces = loop_spaces(self.in_units(self.jacobian(self.links(q))), NEAR_SINGULAR_SHARE)
        idle, near = spaces.left[:, spaces.redundant], spaces.right[:, spaces.free]
        first, second = np.triu_indices(near.shape[1])
        moves = np.concatenate([near, near[:, first] + near[:, second]], axis=-1).T * self.column_units
        bias = self.bias(self.links(np.broadcast_to(q, moves.shape), moves)) / self.row_units
        alone, both = bias[: near.shape[1]], bias[near.shape[1] :]
        form = np.empty((near.shape[1], near.shape[1], idle.shape[1]))
        form[first, second] = form[second, first] = (both - alone[first] - alone[second]) @ idle
        _, values, right = np.linalg.svd(
            form.transpose(2, 0, 1).reshape(idle.shape[1] * near.shape[1], near.shape[1]), full_matrices=False
        )
        stopped = values > SECOND_ORDER_SHARE * np.abs(bias).max(initial=0.0)
        shaky: Array = self.column_units[:, None] * (near @ right[stopped].T)
        return shaky

    def bias(self, links: Links) -> Array:
        """γ (…, m): J a = γ where J v = 0 is to hold."""
        return -np.concatenate([_second_derivative(end, links) for end in self.ends(links)], axis=-1)


def length_unit(size: float) -> float:
    """The unit of length [m] for a loop of this size [m]."""
    return size / float(np.clip(size, SMALL_LOOP, LARGE_LOOP)) if size else 1.0


def _size(joints: Sequence[Joint], chord: Chord, members: NDArray[np.bool_]) -> float:
    """Largest distance between places where one body of the loop of a chord holds others [m]; members: its joints."""
    inside = np.flatnonzero(members).tolist()
    held: dict[int, list[Array]] = {k + 1: [np.zeros(3)] for k in inside}
    for k in inside:
        held.setdefault(joints[k].inside, []).append(joints[k].placement.translation)
    for body, placement in ((chord.body_i, chord.placement_i), (chord.body_j, chord.placement_j)):
        held.setdefault(body, []).append(placement.translation)
    apart = [float(np.linalg.norm(a - b)) for points in held.values() for a, b in combinations(points, 2)]
    return max([*apart, chord.length or 0.0])


def _ends(chord: Chord, links: Links) -> Ends:
    i, j = chord.body_i, chord.body_j
    point_i = links.origin[..., i, :] + links.rotation[..., i, :, :] @ chord.placement_i.translation
    point_j = links.origin[..., j, :] + links.rotation[..., j, :, :] @ chord.placement_j.translation
    if chord.kind == "distance":
        line = point_i - point_j
        apart = _length(line)[..., None]
        anyhow = links.rotation[..., i, :, :] @ (chord.placement_i.rotation @ chord.triad[:, 0])
        unit = np.where(apart == 0, anyhow, line / np.where(apart == 0, 1.0, apart))
        return Ends(chord, point_i, point_j, unit[..., None, :], 1)
    triad = links.rotation[..., i, :, :] @ (chord.placement_i.rotation @ chord.triad)
    along = [row.split()[1] for row in chord.rows]
    chosen = [("t1", "t2", "p").index(name) for name in along]
    n_linear = sum(row.startswith("force") for row in chord.rows)
    return Ends(chord, point_i, point_j, np.swapaxes(triad, -1, -2)[..., chosen, :], n_linear)


def _gap(end: Ends, links: Links) -> Array:
    chord, apart = end.chord, end.point_i - end.point_j
    if chord.length is not None:
        return (_length(apart) - chord.length)[..., None]
    linear = np.einsum("...ka,...a->...k", end.directions[..., : end.n_linear, :], apart)
    on_i = links.rotation[..., chord.body_i, :, :] @ chord.placement_i.rotation
    on_j = links.rotation[..., chord.body_j, :, :] @ chord.placement_j.rotation
    if chord.kind == "hinge":
        p_i, p_j = on_i @ chord.axis, on_j @ chord.axis
        normal, cosine = cross(p_j, p_i), np.einsum("...a,...a->...", p_j, p_i)
        sine = _length(normal)
        opposite = (sine == 0) & (cosine < 0)  # any normal axis turns one into the other
        normal = np.where(
            opposite[..., None], end.directions[..., 0, :], normal / np.where(sine > 0, sine, 1.0)[..., None]
        )
        turn = np.arctan2(sine, cosine)[..., None] * normal
    else:
        turn = rotation_vector(on_i @ np.swapaxes(on_j, -1, -2))
    angular = np.einsum("...ka,...a->...k", end.directions[..., end.n_linear :, :], turn)
    return np.concatenate([linear, angular], axis=-1)


def _second_derivative(end: Ends, links: Links) -> Array:
    """φ̈ (…, rows) at a = 0."""
    i, j, u = end.chord.body_i, end.chord.body_j, end.directions
    omega = links.angular[..., i, :]
    (rate_i, drift_i), (rate_j, drift_j) = (
        _point_motion(links, body, point) for body, point in ((i, end.point_i), (j, end.point_j))
    )
    apart, rate, drift = end.point_i - end.point_j, rate_i - rate_j, drift_i - drift_j
    if end.chord.length is not None:
        along = np.einsum("...ka,...a->...k", u, rate)
        across = (np.einsum("...a,...a->...", rate, rate)[..., None] - along**2) / end.chord.length
        return np.asarray(np.einsum("...ka,...a->...k", u, drift) + across)
    linear, angular = u[..., : end.n_linear, :], u[..., end.n_linear :, :]
    u_dot = cross(omega[..., None, :], linear)
    u_ddot = cross(links.angular_drift[..., i, None, :], linear) + cross(omega[..., None, :], u_dot)
    of_points = sum(
        np.einsum("...ka,...a->...k", direction, vector)
        for direction, vector in ((linear, drift), (2 * u_dot, rate), (u_ddot, apart))
    )
    relative, relative_drift = (part[..., i, :] - part[..., j, :] for part in (links.angular, links.angular_drift))
    of_angles = np.einsum("...ka,...a->...k", angular, relative_drift) + np.einsum(
        "...ka,...a->...k", cross(omega[..., None, :], angular), relative
    )
    return np.concatenate([of_points, of_angles], axis=-1)


def _point_motion(links: Links, body: int, point: Array) -> tuple[Array, Array]:
    """Velocity of a point of a body, and its acceleration at a = 0 (…, 3)."""
    arm, omega = point - links.origin[..., body, :], links.angular[..., body, :]
    spin = cross(omega, arm)
    drift = links.linear_drift[..., body, :] + cross(links.angular_drift[..., body, :], arm) + cross(omega, spin)
    return links.linear[..., body, :] + spin, drift


def _length(vector: Array) -> Array:
    length: Array = np.sqrt(np.einsum("...a,...a->...", vector, vector))
    return length


PREFERRED_COLUMN_SHARE = 0.05
"""A preferred column becomes dependent only where all others are shorter than this part of the longest of J."""


@dataclass(frozen=True, eq=False)
class LoopSpaces:
    """J⁺ = V Σ⁻¹ Uᵀ with singular values below LOOP_RANK_TOLERANCE taken as zero.

    Of J in units (Loops.in_units) U and V are orthogonal; what is smallest is smallest in units.

    left: U (…, m, m); right: V (…, n, n)
    inverse: 1/σ, and 0 where σ counts as zero              (…, min(m, n))
    """

    left: Array
    right: Array
    inverse: Array

    @property
    def rank(self) -> NDArray[np.intp]:
        return np.asarray(np.count_nonzero(self.inverse, axis=-1))

    @property
    def distance(self) -> Array:
        """Distance from a singular pose (…): smallest by largest of the singular values that count; 1 where none
        does."""
        largest = self.inverse.max(axis=-1, initial=0.0)
        least = np.where(self.inverse > 0, self.inverse, np.inf).min(axis=-1, initial=np.inf)
        return np.where(largest > 0, least / np.where(largest > 0, largest, 1.0), 1.0)

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which columns of V are motions that keep the loops closed (…, n)."""
        return _padded(self.inverse == 0, self.right.shape[-1])

    @property
    def redundant(self) -> NDArray[np.bool_]:
        """Which columns of U are combinations of rows that hold nothing (…, m)."""
        return _padded(self.inverse == 0, self.left.shape[-1])

    @property
    def inverse_matrix(self) -> Array:
        """The pseudoinverse of J (…, n, m)."""
        k = self.inverse.shape[-1]
        matrix: Array = (self.right[..., :k] * self.inverse[..., None, :]) @ _transposed(self.left[..., :k])
        return matrix

    def least_motion(self, rows: Array) -> Array:
        """The smallest x (…, n) with J x = rows (…, m), where there is one; else the nearest."""
        k = self.inverse.shape[-1]
        return apply(self.right[..., :k], self.inverse * apply(_transposed(self.left[..., :k]), rows))

    def least_multipliers(self, torques: Array) -> Array:
        """The smallest λ (…, m) with Jᵀ λ = torques (…, n), where there is one; else the nearest."""
        k = self.inverse.shape[-1]
        return apply(self.left[..., :k], self.inverse * apply(_transposed(self.right[..., :k]), torques))


def loop_spaces(
    jacobian: Array, share: float = LOOP_RANK_TOLERANCE, rank: NDArray[np.intp] | None = None
) -> LoopSpaces:
    """Spaces of J (…, m, n) whose entries have one unit.

    Singular values below this share of the largest are zero, or all but the largest where the rank (…) is given.
    """
    left, values, right = np.linalg.svd(jacobian)
    kept = _counted(values, share) if rank is None else np.arange(values.shape[-1]) < np.asarray(rank)[..., None]
    return LoopSpaces(left, _transposed(right), np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0))


def _counted(values: NDArray[np.floating[Any]], share: float) -> NDArray[np.bool_]:
    """Which singular values (…, k) are not zero."""
    return np.asarray(values > share * values.max(axis=-1, keepdims=True, initial=0.0))


def pivoted_columns(matrix: Array, count: int, last: Sequence[int] = ()) -> list[int]:
    """Independent columns: each the longest once what the chosen ones span is taken away.

    Golub and Van Loan, Matrix Computations, section 5.4 (QR with column pivoting).
    last: columns that are chosen only where all others are short (PREFERRED_COLUMN_SHARE)
    """
    rest, chosen = matrix.copy(), list[int]()
    for _ in range(count):
        length = np.linalg.norm(rest, axis=0)
        length[chosen] = 0.0
        others = np.delete(length, last)
        if others.size and others.max() > PREFERRED_COLUMN_SHARE * np.linalg.norm(matrix, axis=0).max():
            length[list(last)] = 0.0
        longest = int(length.argmax())
        direction = rest[:, longest] / np.linalg.norm(rest[:, longest])
        rest = rest - np.outer(direction, direction @ rest)
        chosen.append(longest)
    return chosen


def _padded(flags: NDArray[np.bool_], size: int) -> NDArray[np.bool_]:
    return np.concatenate([flags, np.ones((*flags.shape[:-1], size - flags.shape[-1]), dtype=bool)], axis=-1)


def _transposed(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)
