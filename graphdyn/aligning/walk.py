"""The links of one robot are laid over those of another, joint by joint from the base outward.

A turning joint leaves its outside links free to turn about its axis until the next axis, or the inertia of its link,
says by how much: that is its zero. What no zero can bring together is a misfit of that one joint, and the links
outside of it are moved along. One displaced axis therefore shows up once, at its own joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from graphdyn.aligning.axes import (
    JointAxes,
    across,
    angle_between,
    carried,
    moved_by,
    turn_about,
    turned_about,
    turned_onto,
)
from graphdyn.aligning.free_translations import FreeTranslations
from graphdyn.aligning.inertias import LinkInertias
from graphdyn.layout import Array

PARALLEL_ANGLE = 0.02
"""Angle [rad] below which two axes count as parallel, and the distance of the axes, not their directions, gives the
zero of the joint: files round angles to 1e-3, and calibrated arms have axes that are parallel to 5e-3."""

COLLINEAR_SHARE = 1e-4
"""Distance of parallel axes, as a part of the reach, below which it has no direction."""

SNAP_ANGLE = 0.01
"""Angle [rad] from a whole right angle within which a zero may be that: most files have their zeros there, and an axis
that is tilted by less would otherwise look like a zero and a smaller tilt."""

MISFIT_ROUNDING = 1e-9
"""Misfit [rad, parts of the reach] by which a place must be better to be taken in place of the usual one."""


@dataclass(eq=False)
class Walk:
    """The links of B over those of A, under one choice of the senses of the joints.

    first, second: axes of A and B; signs: 1 where a joint of B turns the same way, -1 where it turns the other (n,)
    inertias: of the links, which then give zeros too; None where the axes alone do
    start: what moves B before the first axis is looked at, None for nothing                  (4, 4)
    held: the base stays at `start`, and the first axis may have a misfit
    snapped: zeros that are nearly whole right angles are taken as these
    places: what moves ground and links of B, where they are at q = 0, over those of A         (n + 1, 4, 4)
    zeros: position of B's joints where those of A are zero                                   (n,)  [rad or m]
    angles, distances: what no zero brings together at each joint                             (n,)  [rad], [m]
    """

    first: JointAxes
    second: JointAxes
    signs: Array
    inertias: LinkInertias | None = None
    start: Array | None = None
    held: bool = False
    snapped: bool = False
    places: Array = field(init=False)
    zeros: Array = field(init=False)
    angles: Array = field(init=False)
    distances: Array = field(init=False)

    def __post_init__(self) -> None:
        n = len(self.signs)
        self.places = np.tile(np.eye(4) if self.start is None else self.start, (n + 1, 1, 1))
        self.zeros, self.angles, self.distances = np.zeros(n), np.zeros(n), np.zeros(n)
        self._directions = self.signs[:, None] * self.first.directions
        self._free = FreeTranslations(self.held)
        self._before: Array | None = None  # where the links outside the last joint were before its misfit
        turning: int | None = None  # the joint whose links may still turn
        for joint in range(n):
            if turning is not None and self._settle(turning, joint):
                turning = None
            self._lay(joint)
            if not self.first.slides[joint] or (joint == 0 and not self.held):
                turning = joint
            if self.first.slides[joint] and not self._slide_by_inertia(joint):
                self._free.add(self._directions[joint], joint)
        if not self.first.slides[-1]:
            self._settle_by_inertia(n - 1, (0.0, 0.0), None)

    @property
    def cost(self) -> float:
        """The sum of all misfits: angles, and distances as parts of the reach."""
        return float(self.angles.sum() + self.distances.sum() / self.first.reach)

    def _owner(self, joint: int) -> int:
        """What turns with a joint: what is outside of it; all with the first one, whose zero then stays, if it can."""
        return joint if joint or self.held else -1

    def _move(self, owner: int, motion: Array) -> None:
        """Move what is outside a joint, or with owner -1 the whole robot."""
        self.places[owner + 1 :] = motion @ self.places[owner + 1 :]

    def _turn(self, joint: int, angle: float, motion: Array) -> None:
        """Turn the links outside a joint, whose zero this is."""
        self._move(self._owner(joint), motion)
        if self._owner(joint) >= 0:
            self.zeros[joint] += angle

    def _settle(self, joint: int, outer: int) -> bool:
        """Turn the links outside a joint so that the inertia of the link, or the axis of the next one fits."""
        if self.first.slides[joint]:  # the first joint slides: all of B turns about its axis
            angle = self._turn_by_axis(joint, outer, self.places[-1])
            self._move(-1, turned_about(self._directions[joint], self.first.points[joint], angle or 0.0))
            return angle is not None
        angles = [self._turn_by_axis(joint, outer, place) for place in self._choices(joint)]
        if self.snapped:
            angles = [None if angle is None else _snapped(angle) for angle in angles]
        if self._settle_by_inertia(joint, [angle or 0.0 for angle in angles], outer):
            return True
        here, found = self.places[joint + 1], []
        for place, angle in zip(self._choices(joint), angles, strict=True):
            about = carried(place, self.second.directions[joint], self.second.points[joint])
            motion = turned_about(*about, angle or 0.0) @ place
            found.append((self._misfit(outer, motion), angle or 0.0, motion))
        chosen = found[-1] if found[-1][0] < found[0][0] - MISFIT_ROUNDING else found[0]
        self._turn(joint, chosen[1], chosen[2] @ np.linalg.inv(here))
        return angles[0] is not None

    def _choices(self, joint: int) -> list[Array]:
        """Places of the link outside a joint, but for its zero: moved by the misfit of the joint, and not moved."""
        here = self.places[joint + 1].copy()
        return [here] if self._before is None else [here, self._before]

    def _turn_by_axis(self, joint: int, outer: int, place: Array) -> float | None:
        """The angle by which an axis of B must turn about that of an inner joint; None where every angle is as good."""
        about, end = self._directions[joint], self._directions[outer]
        start, point = carried(place, self.second.directions[outer], self.second.points[outer])
        sines = [np.linalg.norm(across(about, each)) for each in (start, end)]
        if min(sines) > PARALLEL_ANGLE:
            return turn_about(about, start, end)
        if self.first.slides[outer] or self._free.reaches(about):
            return None
        target, origin = self.first.points[outer], self.first.points[joint]
        height = about @ (target - point) / (about @ start)  # B's axis and A's at one height along the inner axis
        ends = [point + height * start - origin, target - origin]
        if min(np.linalg.norm(across(about, each)) for each in ends) < COLLINEAR_SHARE * self.first.reach:
            return None
        return turn_about(about, ends[0], ends[1])

    def _misfit(self, joint: int, place: Array) -> float:
        """How far an axis of B moved by place is from that of A, but for translations that are free."""
        start, point = carried(place, self.second.directions[joint], self.second.points[joint])
        angle = angle_between(start, self._directions[joint])
        if self.first.slides[joint] or self._free.reaches(self._directions[joint]):
            return angle
        gap = across(self._directions[joint], self.first.points[joint] - point)
        return angle + float(np.linalg.norm(gap)) / self.first.reach

    def _settle_by_inertia(self, joint: int, by_axis: Sequence[float], outer: int | None) -> bool:
        """Take a place in which the link agrees: turned by the next axis, or by its own inertia, with a shift along its
        axis; moved by the misfit of its joint, or not moved. False where it agrees in none.

        by_axis: the angles of the next axis, for each choice; outer: that axis, which decides between several places,
            as those of a sphere
        """
        if self.inertias is None:
            return False
        here, chosen = self.places[joint + 1].copy(), None
        for place, first in zip(self._choices(joint), by_axis, strict=False):
            about, origin = carried(place, self.second.directions[joint], self.second.points[joint])
            for angle, shift in self.inertias.fits(joint, place, about, origin, first):
                motion = moved_by(shift * about) @ turned_about(about, origin, angle) @ place
                if self.inertias.agree(joint, motion):
                    misfit = 0.0 if outer is None else self._misfit(outer, motion)
                    if chosen is None or misfit < chosen[0] - MISFIT_ROUNDING:
                        chosen = misfit, angle, motion, about
        if chosen is None:
            return False
        _, angle, motion, about = chosen
        self._turn(joint, angle, motion @ np.linalg.inv(here))
        if self._owner(joint) < 0:
            self._free.hold(about)
        return True

    def _slide_by_inertia(self, joint: int) -> bool:
        """Slide the links outside a joint to where the inertia of its link agrees; False where it does not."""
        if self.inertias is None:
            return False
        here, about = self.places[joint + 1], self._directions[joint]
        for _, shift in self.inertias.fits(joint, here, about, self.first.points[joint], 0.0):
            motion = moved_by(shift * about)
            if self.inertias.agree(joint, motion @ here):
                self._move(joint, motion)
                self.zeros[joint] += shift
                return True
        return False

    def _lay(self, joint: int) -> None:
        """Lay an axis of B over that of A, by translations that are still free, and the rest as a misfit."""
        end, target, owner = self._directions[joint], self.first.points[joint], self._owner(joint)
        start, _ = carried(self.places[-1], self.second.directions[joint], self.second.points[joint])
        self._before = self.places[-1].copy() if owner >= 0 else None
        if owner >= 0:
            self.angles[joint] = angle_between(start, end)
        self._move(owner, turned_onto(start, end, target))
        if self.first.slides[joint]:
            return
        for free, vector in self._free.absorbed(end, self._gap(joint)):
            self._move(free, moved_by(vector))
            if free >= 0:
                self.zeros[free] += float(vector @ self._directions[free])
            if self._before is not None:
                self._before = moved_by(vector) @ self._before
        gap = self._gap(joint)
        if owner >= 0:
            self.distances[joint] = float(np.linalg.norm(gap))
        self._move(owner, moved_by(gap))

    def _gap(self, joint: int) -> Array:
        """The vector from an axis of B to that of A, across it."""
        _, point = carried(self.places[-1], self.second.directions[joint], self.second.points[joint])
        return across(self._directions[joint], self.first.points[joint] - point)


def _snapped(angle: float) -> float:
    """The nearest whole right angle, where it is near."""
    whole = float(np.round(angle / (np.pi / 2)) * np.pi / 2)
    return whole if abs(angle - whole) < SNAP_ANGLE else angle
