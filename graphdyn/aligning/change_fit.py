"""One robot, changed in one thing, fitted to another by base and zeros (Gauss-Newton)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from graphdyn.aligning.axes import JointAxes, matrix, moved_by, turned_about
from graphdyn.aligning.inertias import LinkInertias
from graphdyn.aligning.joint_map import JointMap
from graphdyn.layout import Array
from graphdyn.model import skew
from graphdyn.model.robot_model import RobotModel

Flags = NDArray[np.bool_]

CauseKind = Literal["length", "angle", "axis", "mass", "center", "tensor"]

JOINT_KINDS: tuple[CauseKind, ...] = ("length", "angle", "axis")
LINK_KINDS: tuple[CauseKind, ...] = ("mass", "center", "tensor")

Change = tuple[CauseKind | None, int]
"""A kind, and the number of the joint or link, from 0."""

NO_CHANGE: Change = (None, 0)

MOST_STEPS = 10
"""Steps of Gauss-Newton, of which each squares what is left [rad, parts of the reach]."""

LAST_STEP = 1e-12
"""Length of a step that is rounding [rad, m, parts of what is fitted]."""

PROMISING = 0.3
"""Part of the misfit that a linear step may leave, of a change that is tried."""

SMALLEST_SHARE = 1e-4
"""Singular values, as a part of the largest, that count as zero: what axes say that are nearly parallel."""


@dataclass(frozen=True, eq=False)
class FittedChange:
    """Base and zeros with which a change explains everything.

    zeros: positions of B's joints where those of A are zero                                    (n,)  [rad or m]
    places: what moves ground and links of B, where they are at q = 0, over those of A          (n + 1, 4, 4)
    """

    zeros: Array
    places: Array


@dataclass(frozen=True, eq=False)
class _FitState:
    """What the fit varies. ground: what moves B's world over A's (4, 4); zeros (n,); size of the change (k,)."""

    ground: Array
    zeros: Array
    size: Array


@dataclass(frozen=True, eq=False)
class _FitParts:
    """Axes and links of B with its zeros, over A: (n, 3), (n, 3), (n, 3), (n, 3, 3)."""

    directions: Array
    points: Array
    centers: Array
    tensors: Array


@dataclass(frozen=True, eq=False)
class _FitStep:
    """map: turn and translation of the base, zeros (6 + n,); size: of the change (k,); left: of the misfit (n · 19,)"""

    map: Array
    size: Array
    left: Array


_ROWS = {"mass": slice(6, 7), "center": slice(7, 10), "tensor": slice(10, 19)}
_SIZES = {None: 0, "mass": 1, "tensor": 9}
_N_ROWS = 19
"""Rows of a joint and its link: axis (3), its place (3), mass (1), center of mass (3), tensor (9)."""


class ChangeFit:
    """Base and zeros of B, fitted to A with one change.

    joint_map: with which the fit begins; kept: which of its zeros stay, None for none           (n,)
    """

    def __init__(
        self,
        robots: tuple[RobotModel, RobotModel],
        axes: tuple[JointAxes, JointAxes],
        joint_map: JointMap,
        inertias: LinkInertias,
        kept: Flags | None,
    ) -> None:
        self._kept: Flags = np.zeros(len(joint_map.signs), bool) if kept is None else kept
        self._axes, self._signs, self._inertias = axes, joint_map.signs, inertias
        self._ground = matrix(robots[0].base) @ matrix(joint_map.base) @ np.linalg.inv(matrix(robots[1].base))
        self._zeros = joint_map.zeros
        self._turns: Flags = np.array([not slides for slides in axes[0].slides])
        masses, tensors = np.array(inertias.masses), np.array(inertias.tensors)
        self._mass_scale, self._tensor_scale = masses.max(axis=0), np.abs(tensors).max(axis=(0, 2, 3))
        for scale in (self._mass_scale, self._tensor_scale):
            scale[scale == 0] = 1.0
        self._have_centers = (masses > 0).all(axis=0)

    def promising(self, changes: list[Change]) -> list[Change]:
        """The changes with which a linear step explains most of the misfit."""
        state = self._start(NO_CHANGE)
        misfit, parts = self._misfit(state, NO_CHANGE), self._parts(state)
        most = PROMISING * np.linalg.norm(misfit)
        return [change for change in changes if np.linalg.norm(self._step(change, parts, misfit).left) <= most]

    def fitted(self, change: Change) -> FittedChange | None:
        """Base and zeros with which all agrees after the smallest such change; None where there are none."""
        state = self._start(change)
        for _ in range(MOST_STEPS):
            step = self._step(change, self._parts(state), self._misfit(state, change))
            motion = moved_by(step.map[3:6]) @ _turned(step.map[:3], np.zeros(3))
            state = _FitState(motion @ state.ground, state.zeros + step.map[6:], state.size + step.size)
            if np.linalg.norm(step.map) + np.linalg.norm(step.size) <= LAST_STEP:
                break
        if np.abs(self._misfit(state, change)).max() > self._inertias.tolerance:
            return None
        inverse = np.linalg.inv(self._changed_links(state, change))
        return FittedChange(state.zeros, np.concatenate([state.ground[None], inverse @ self._motions(state)]))

    def _step(self, change: Change, parts: _FitParts, misfit: Array) -> _FitStep:
        """A step of Gauss-Newton: the map explains what it can, the change the rest."""
        of_map, of_change = self._columns_of_map(parts), self._columns_of(change, parts)
        left, values, right = np.linalg.svd(of_map, full_matrices=False)
        found = values > SMALLEST_SHARE * values[0]
        free, back = left[:, found], right[found].T / values[found]
        rest, alone = misfit - free @ (free.T @ misfit), of_change - free @ (free.T @ of_change)
        size = np.zeros(of_change.shape[1])
        if size.size:
            left, values, right = np.linalg.svd(alone, full_matrices=False)
            found = values > SMALLEST_SHARE * np.linalg.norm(of_change, axis=0).max()
            size = -(right[found].T / values[found]) @ (left[:, found].T @ rest)
        return _FitStep(-back @ (free.T @ (misfit + of_change @ size)), size, rest + alone @ size)

    def _start(self, change: Change) -> _FitState:
        return _FitState(self._ground, self._zeros, np.zeros(_SIZES.get(change[0], 3)))

    def _motions(self, state: _FitState) -> Array:
        """What moves the links of B, where they are at q = 0, to where its zeros and its base put them (n, 4, 4)."""
        links, here = [], state.ground
        lines = zip(state.zeros, self._axes[1].directions, self._axes[1].points, self._turns, strict=True)
        for zero, direction, point, turns in lines:
            here = here @ (turned_about(direction, point, zero) if turns else moved_by(zero * direction))
            links.append(here)
        return np.array(links)

    def _parts(self, state: _FitState) -> _FitParts:
        links, axes, inertias = self._motions(state), self._axes[1], self._inertias
        turns = links[:, :3, :3]
        directions = self._signs[:, None] * _times(turns, axes.directions)
        points, centers = (_times(turns, each) + links[:, :3, 3] for each in (axes.points, inertias.centers[1]))
        return _FitParts(directions, points, centers, turns @ inertias.tensors[1] @ turns.transpose(0, 2, 1))

    def _changed_links(self, state: _FitState, change: Change) -> Array:
        """What moves the links of A to where they are with the change (n, 4, 4)."""
        kind, number = change
        motion = np.eye(4)
        if kind == "length":
            motion = moved_by(state.size)
        elif kind == "angle":
            motion = _turned(state.size, self._axes[0].points[number])
        return np.array([np.eye(4)] * number + [motion] * (len(self._signs) - number))

    def _misfit(self, state: _FitState, change: Change) -> Array:
        """B minus A with the change, in parts of mass, reach and tensor (n · 19,)."""
        parts, first, inertias = self._parts(state), self._axes[0], self._inertias
        links, (kind, number) = self._changed_links(state, change), change
        turns, shifts = links[:, :3, :3], links[:, :3, 3]
        targets, points, centers = (
            _times(turns, each) for each in (first.directions, first.points, inertias.centers[0])
        )
        if kind == "axis":
            targets[number] = _turned(state.size, np.zeros(3))[:3, :3] @ targets[number]
        rows = np.zeros((len(self._signs), _N_ROWS))
        rows[:, :3] = parts.directions - targets
        rows[self._turns, 3:6] = (_across(parts.directions, parts.points - points - shifts) / first.reach)[self._turns]
        rows[:, 6] = (inertias.masses[1] - inertias.masses[0]) / self._mass_scale
        rows[self._have_centers, 7:10] = ((parts.centers - centers - shifts) / first.reach)[self._have_centers]
        tensors = parts.tensors - turns @ inertias.tensors[0] @ turns.transpose(0, 2, 1)
        rows[:, 10:] = (tensors / self._tensor_scale[:, None, None]).reshape(-1, 9)
        if kind in _ROWS:
            rows[number, _ROWS[kind]] -= state.size
        return rows.ravel()

    def _columns_of_map(self, parts: _FitParts) -> Array:
        """What turns and translations of the base, and zeros, do to the misfit (n · 19, 6 + n)."""
        n, unit, none = len(self._signs), np.eye(3), np.zeros((3, 3))
        about = self._signs[:, None] * parts.directions
        about[self._kept] = 0.0
        turning, sliding = about * self._turns[:, None], about * ~self._turns[:, None]
        everything: Flags = np.ones((6, n), bool)
        outside: Flags = np.arange(n) >= np.arange(n)[:, None]
        return self._columns_of_motions(
            parts,
            np.concatenate([unit, none, turning]),
            np.concatenate([none, unit, sliding - np.cross(turning, parts.points)]),
            np.concatenate([everything, np.arange(n) > np.arange(n)[:, None]]),
            np.concatenate([everything, outside]),
        )

    def _columns_of(self, change: Change, parts: _FitParts) -> Array:
        """What a change of A does to the misfit (n · 19, k)."""
        kind, number = change
        n, unit = len(self._signs), np.eye(3)
        if kind is None:
            return np.zeros((n * _N_ROWS, 0))
        if kind in _ROWS:
            rows = range(n * _N_ROWS)[number * _N_ROWS : (number + 1) * _N_ROWS][_ROWS[kind]]
            return -np.eye(n * _N_ROWS)[:, rows]
        if kind == "axis":
            columns = np.zeros((n, _N_ROWS, 3))
            columns[number, :3] = np.cross(unit, parts.directions[number]).T
            return -columns.reshape(-1, 3)
        outside = np.tile(np.arange(n) >= number, (3, 1))
        turns = unit if kind == "angle" else 0 * unit
        shifts = unit if kind == "length" else -np.cross(unit, self._axes[0].points[number])
        return -self._columns_of_motions(parts, turns, shifts, outside, outside)

    def _columns_of_motions(self, parts: _FitParts, turns: Array, shifts: Array, axes: Flags, links: Flags) -> Array:
        """What small motions of axes and links do to the misfit (n · 19, m).

        turns, shifts: each turns about the origin, and moves it                                (m, 3), (m, 3)
        axes, links: which are moved                                                            (m, n), (m, n)
        """
        rows = np.zeros((*axes.shape, _N_ROWS))
        reach, turns, shifts = self._axes[0].reach, turns[:, None], shifts[:, None]
        along = ((parts.points - self._axes[0].points) * parts.directions).sum(axis=-1)
        feet = parts.points - along[:, None] * parts.directions  # of B's axes, next to A's joints
        rows[..., :3] = np.cross(turns, parts.directions) * axes[..., None]
        gaps = _across(parts.directions, np.cross(turns, feet) + shifts) / reach
        rows[..., 3:6] = gaps * (axes & self._turns)[..., None]
        apart = (np.cross(turns, parts.centers) + shifts) / reach
        rows[..., 7:10] = apart * (links & self._have_centers)[..., None]
        spins = skew(turns)
        spun = (spins @ parts.tensors - parts.tensors @ spins) / self._tensor_scale[:, None, None]
        rows[..., 10:] = spun.reshape(*axes.shape, 9) * links[..., None]
        return rows.reshape(len(axes), -1).T


def _turned(vector: Array, point: Array) -> Array:
    """The rotation about a point by a rotation vector [rad], as a homogeneous matrix (4, 4)."""
    angle = float(np.linalg.norm(vector))
    return turned_about(vector / angle, point, angle) if angle else np.eye(4)


def _times(matrices: Array, vectors: Array) -> Array:
    """Each matrix (n, 3, 3) times its vector (n, 3)."""
    product: Array = (matrices @ vectors[..., None])[..., 0]
    return product


def _across(directions: Array, vectors: Array) -> Array:
    """The parts of vectors (…, n, 3) that are perpendicular to unit vectors (n, 3)."""
    part: Array = vectors - (vectors * directions).sum(axis=-1)[..., None] * directions
    return part
