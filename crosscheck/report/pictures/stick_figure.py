"""A robot as a stick figure: links, joint axes, chords, centers of mass and fixed frames, from the side and above."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.report.pictures import svg as colors
from crosscheck.report.pictures.svg import CURVES, MIDDLE_COLOR, SOFT_COLOR, picture
from graphdyn import RobotModel, frame_placement, maximal_state
from graphdyn.equations import joint_axes, link_origins
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ELEVATION, AZIMUTH = np.radians(22), np.radians(-60)
"""Angles of the viewer: above the horizon, and from the direction in which the robot reaches."""

FLAT_EXTENT_SHARE = 0.02
"""Link origins are on one line if their second principal extent is less than this part of the first."""

BENT_ANGLE = 0.5
"""Angle of every revolute joint where the zero pose puts all link origins on one line [rad]."""

WIDTH, MIN_HEIGHT_RATIO, MAX_HEIGHT_RATIO = 4.6, 0.62, 1.25
"""Sizes of the picture [inches], and the limits of height over width."""

PICTURE_MARGIN = 0.11
"""Around everything, as a part of the size."""

AXIS, SLIDE, BASE = 0.045, 0.075, 0.12
"""Half lengths of the drawn axes of revolute and prismatic joints, lengths of the base axes, as parts of the size."""

DISC_AREA = 420.0
"""Area of a center of mass that has all the mass [points²]."""

LABEL_DISTANCE = 0.045
"""Joints nearer to each other than this part of the size share one label."""

LINK, JOINT, MASS, EDGE, FAINT, GROUND = SOFT_COLOR, CURVES[0], "#c98a1b", CURVES[3], MIDDLE_COLOR, colors.FAINT_COLOR
CHORD_COLOR = OVERLAY_COLOR = CURVES[1]


def stick_figure(key: str, model: RobotModel, name: str, q: Array | None = None) -> Markup:
    """The robot at q (n,), or where nothing is given as pose says; joints carry their numbers."""
    scene = _Drawing(model, pose(model) if q is None else q)
    slides = sum(joint.is_prismatic for joint in model.joints)
    label = (
        f"Stick figure of {name}: {model.n_bodies - slides} revolute and {slides} prismatic joints, "
        f"{sum(body.mass for body in model.bodies):.3g} kg"
    )
    return picture(key, label, (WIDTH, WIDTH * scene.ratio), scene.draw)


def two_stick_figures(key: str, first: RobotModel, second: RobotModel) -> Markup:
    """Two robots in the pose of the first, one over the other; the second dashed, without labels and masses."""
    q = pose(first)
    scenes = _Drawing(first, q), _Drawing(second, q, _view_of(first, q))
    low = np.minimum(*(scene.corners[0] for scene in scenes))
    high = np.maximum(*(scene.corners[1] for scene in scenes))
    ratio = float(np.clip((high - low)[1] / (high - low)[0], MIN_HEIGHT_RATIO, MAX_HEIGHT_RATIO))

    def draw(axes: Axes) -> None:
        scenes[0].draw(axes)
        scenes[1].draw_over(axes)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        axes.set_aspect("equal", adjustable="datalim")

    return picture(
        key, f"Stick figures of {first.name} and {second.name}, one over the other", (WIDTH, WIDTH * ratio), draw
    )


def _view_of(model: RobotModel, q: Array) -> Array:
    return _view(np.vstack([model.base.translation, link_origins(maximal_state(model, q))]))


def pose(model: RobotModel) -> Array:
    """q (n,) to draw the robot in: zero, unless all link origins would be on one line; with loops a closed one."""
    if model.chords:
        return model.closed_pose
    zero = np.zeros(model.nv)
    points = np.vstack([model.base.translation, link_origins(maximal_state(model, zero))])
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if extents[1] > FLAT_EXTENT_SHARE * extents[0]:
        return zero
    revolute = np.array([not model.joints[k].is_prismatic for k in model.degrees_of_freedom.independent])
    return np.where(revolute, BENT_ANGLE, 0.0)


def pose_text(model: RobotModel) -> str:
    """The pose of the stick figure, for its caption."""
    if model.chords:
        return "A pose that closes the loops"
    if pose(model).any():
        return f"Revolute joints at {BENT_ANGLE} rad, since the zero pose is a straight line"
    return "Zero pose"


class _Drawing:
    """Everything that is drawn, on the plane of the picture [m]; ratio: height over width."""

    def __init__(self, model: RobotModel, q: Array, view: Array | None = None):
        """view: right and up of the picture (2, 3), chosen for this robot where it is not given"""
        self.model = model
        state = maximal_state(model, q)
        origins = np.vstack([model.base.translation, link_origins(state)])
        self._view = _view(origins) if view is None else view
        frames = [frame_placement(model, q, frame.name)[1] for frame in model.frames]
        self.origins = self._flat(origins)
        self.centers = self._flat(state.position)
        self.frames = self._flat(np.array(frames).reshape(-1, 3))
        self.axes = self._flat(joint_axes(state))
        self.shadow = self._flat(np.column_stack([origins[:, :2], np.full(len(origins), origins[0, 2])]))
        self.base_axes = self._flat(model.base.rotation.T)
        ends = [
            position + rotation @ placement.translation
            for chord in model.chords
            for body, placement in ((chord.body_i, chord.placement_i), (chord.body_j, chord.placement_j))
            for rotation, position in [frame_placement(model, q, (model.base_name, *model.body_names)[body])]
        ]
        self.chord_ends = self._flat(np.array(ends).reshape(-1, 3)).reshape(-1, 2, 2)
        points = np.vstack([self.origins, self.centers, self.frames, self.shadow, self.chord_ends.reshape(-1, 2)])
        self.size = max(float(np.ptp(points, axis=0).max()), 1e-3)
        low, high = points.min(axis=0), points.max(axis=0)
        width, height = high - low + 2 * PICTURE_MARGIN * self.size
        self.ratio = float(np.clip(height / width, MIN_HEIGHT_RATIO, MAX_HEIGHT_RATIO))
        half = max(width, height / self.ratio) / 2
        reach = np.array([half, half * self.ratio])
        self.corners = np.stack([(low + high) / 2 - reach, (low + high) / 2 + reach])

    def _flat(self, points: Array) -> Array:
        """Orthographic projection of points or directions (k, 3) → (k, 2)."""
        return points @ self._view.T

    def draw(self, axes: Axes) -> None:
        axes.set_axis_off()
        axes.set(xlim=self.corners[:, 0], ylim=self.corners[:, 1])
        self._draw_ground(axes)
        self._draw_links(axes)
        masses = np.array([body.mass for body in self.model.bodies])
        areas = DISC_AREA * masses / max(masses.sum(), np.finfo(float).tiny)
        x, y = self.centers.T
        axes.scatter(x, y, s=areas, color=MASS, alpha=0.55, edgecolor=EDGE, linewidth=0.6, zorder=4)
        self._draw_chords(axes)
        for k, joint in enumerate(self.model.joints):
            self._draw_joint(axes, self.origins[k + 1], self.axes[k], joint.is_prismatic)
        for point, numbers in _grouped(self.origins[1:], LABEL_DISTANCE * self.size):
            axes.annotate(
                ", ".join(map(str, numbers)),
                tuple(point),
                xytext=(8, 5),
                textcoords="offset points",
                fontsize=9,
                zorder=7,
            )

    def draw_over(self, axes: Axes) -> None:
        """Draw the links alone, dashed over another robot."""
        for j, joint in enumerate(self.model.joints, start=1):
            line = self.origins[[joint.inside, j]].T
            axes.plot(*line, color=OVERLAY_COLOR, linewidth=1.6, linestyle="--", zorder=8)
            axes.plot(*self.origins[j], marker="o", markersize=3.5, color=OVERLAY_COLOR, zorder=8)

    def _draw_ground(self, axes: Axes) -> None:
        """Shadow of the links on the base plane, and the axes of the base."""
        for j, joint in enumerate(self.model.joints, start=1):
            axes.plot(*self.shadow[[joint.inside, j]].T, color=GROUND, linewidth=4, solid_capstyle="round", zorder=0)
        for direction, letter in zip(self.base_axes, "xyz", strict=True):
            end = self.origins[0] + BASE * self.size * direction
            axes.plot(*np.array([self.origins[0], end]).T, color=FAINT, linewidth=1, zorder=1)
            axes.annotate(letter, tuple(end), fontsize=8, color=FAINT, ha="center", va="center", zorder=1)

    def _draw_links(self, axes: Axes) -> None:
        for j, joint in enumerate(self.model.joints, start=1):
            grounded = joint.inside == 0
            line = self.origins[[joint.inside, j]].T
            color, width = (FAINT, 1.5) if grounded else (LINK, 2.6)
            axes.plot(*line, color=color, linewidth=width, solid_capstyle="round", zorder=2)
        for point, center in zip(self.origins[1:], self.centers, strict=True):
            axes.plot(*np.array([point, center]).T, color=MASS, linewidth=0.8, zorder=3)
        for frame, point in zip(self.model.frames, self.frames, strict=True):
            axes.plot(*np.array([self.origins[frame.body], point]).T, color=FAINT, linewidth=0.8, zorder=1)
            axes.plot(*point, marker="x", markersize=4, color=FAINT, zorder=1)

    def _draw_chords(self, axes: Axes) -> None:
        """Draw lines from each of both link origins to the chord, and what lies between its points (of a distance)."""
        for number, (chord, ends) in enumerate(zip(self.model.chords, self.chord_ends, strict=True), start=1):
            for body, end in zip((chord.body_i, chord.body_j), ends, strict=True):
                color, width = (LINK, 2.6) if body else (FAINT, 1.5)
                axes.plot(*np.array([self.origins[body], end]).T, color=color, linewidth=width, zorder=2)
            axes.plot(*ends.T, color=CHORD_COLOR, linewidth=1.4, linestyle=":", zorder=5)
            axes.plot(
                *ends.T, marker="D", markersize=5.5, color="white", mec=CHORD_COLOR, mew=1.4, linewidth=0, zorder=6
            )
            axes.annotate(
                f"c{number}",
                tuple(ends.mean(axis=0)),
                xytext=(-8, -5),
                textcoords="offset points",
                ha="right",
                va="top",
                fontsize=9,
                color=CHORD_COLOR,
                zorder=7,
            )

    def _draw_joint(self, axes: Axes, at: Array, axis: Array, prismatic: bool) -> None:
        half = (SLIDE if prismatic else AXIS) * self.size * axis
        ends = np.array([at - half, at + half])
        axes.plot(*ends.T, color=JOINT, linewidth=1.4 if prismatic else 4.5, solid_capstyle="butt", zorder=5)
        if prismatic:
            axes.plot(*ends.T, marker="D", markersize=3, color=JOINT, linewidth=0, zorder=5)
        axes.plot(*at, marker="s" if prismatic else "o", markersize=5.5, color="white", mec=JOINT, mew=1.4, zorder=6)


def _view(points: Array) -> Array:
    """Right and up of the picture (2, 3), with the horizontal reach of the points (k, 3) mostly to the right."""
    flat = points[:, :2] - points[0, :2]
    far = flat[np.argmax(np.linalg.norm(flat, axis=1))]
    azimuth = np.arctan2(far[1], far[0]) + AZIMUTH
    toward = np.array([np.cos(azimuth), np.sin(azimuth)])
    right = np.array([-toward[1], toward[0], 0.0])
    up = np.array([*(-np.sin(ELEVATION) * toward), np.cos(ELEVATION)])
    return np.stack([right, up])


def _grouped(points: Array, distance: float) -> list[tuple[Array, list[int]]]:
    """Numbers (from 1) of points that are closer than the distance to the first of their group."""
    groups: list[tuple[Array, list[int]]] = []
    for number, point in enumerate(points, start=1):
        for first, numbers in groups:
            if np.linalg.norm(point - first) < distance:
                numbers.append(number)
                break
        else:
            groups.append((point, [number]))
    return groups
