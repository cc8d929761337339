"""Robots with the same joint torques and fewer constants: passes over the links.

Fewer inertial parameters: what may belong to either of two bodies goes to the inner one. Gautier and Khalil, "Direct
calculation of minimum set of inertial parameters of serial robots", IEEE Transactions on Robotics and Automation 6(3),
1990. Mass on the axis of a revolute joint moves in the same way whether it belongs to the inside body or to body j, and
has no moment about the axis: any m, m c_z and I_xx = I_yy may change sides, and leave body j without mass. Past a
slide, relative to which nothing turns, goes the whole tensor. What reaches the ground is dropped.

Simpler frames: joint torques and accelerations do not depend on where along its axis the origin of a joint lies, nor on
the direction from which its angle is counted. Khalil and Kleinfinger, "A new geometric notation for open and closed-
loop robots", IEEE Conference on Robotics and Automation, 1986, choose both for chains; here the outer frame of a joint
is turned, and of several joints on one body the first one decides.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.layout import Array
from graphdyn.recursions.mechanism.mechanism import ROTATION_ROUNDING, Link, Links, rounded, without_rounding
from graphdyn.scalars.vectors import scalars


def regrouped(links: Links) -> tuple[Link, ...]:
    """The bodies with as many parameters as possible moved inwards."""
    masses = [link.mass for link in links]
    moments = [link.first_moment.astype(float) for link in links]
    tensors = [link.tensor.astype(float) for link in links]
    for j in reversed(range(len(links))):
        i, rotation, place = links[j].inside, links[j].rotation.astype(float), links[j].translation.astype(float)
        if links[j].prismatic:
            mass, moment, tensor = 0.0, np.zeros(3), tensors[j]
            tensors[j] = np.zeros((3, 3))
        else:
            mass, moment = masses[j], np.array([0.0, 0.0, moments[j][2]])
            tensor = tensors[j][1, 1] * np.diag([1.0, 1.0, 0.0])
            masses[j], moments[j], tensors[j] = 0.0, moments[j] - moment, _without_line(tensors[j])
        if i >= 0:
            seen = rotation @ moment
            masses[i] += mass
            moments[i] = moments[i] + seen + mass * place
            tensors[i] = tensors[i] + rotation @ tensor @ rotation.T + moved_tensor(mass, seen, place)
    return tuple(
        replace(link, mass=mass, first_moment=scalars(_cleaned(moment)), tensor=scalars(_off_diagonal_cleaned(tensor)))
        for link, mass, moment, tensor in zip(links, masses, moments, tensors, strict=True)
    )


def moved_tensor(mass: float, moment: Array, place: Array) -> Array:
    """What a tensor gains about an origin from which its own is seen at place."""
    products = np.outer(moment, place) + np.outer(place, moment) + mass * np.outer(place, place)
    gain: Array = np.trace(products) * np.eye(3) - products
    return gain


def _without_line(tensor: Array) -> Array:
    """I - I_yy diag(1, 1, 0); a body with equal moments of inertia about x and y keeps none of both."""
    rest: Array = tensor - tensor[1, 1] * np.diag([1.0, 1.0, 0.0])
    if abs(rest[0, 0]) <= ROTATION_ROUNDING * abs(tensor[1, 1]):
        rest[0, 0] = 0.0
    return rest


def _cleaned(moment: Array) -> Array:
    return without_rounding(moment, np.abs(moment).max())


def _off_diagonal_cleaned(tensor: Array) -> Array:
    """The moments of inertia stay, however small: the mass matrix may be singular without them."""
    diagonal = np.diag(tensor.diagonal())
    return diagonal + without_rounding(tensor - diagonal, np.abs(tensor).max())


MAX_FOOT_DISTANCE = 2.0
"""Distances of two origins within which the foot of their common normal has to lie. Nearly parallel axes have theirs
far away, and parameters about it would lose digits."""


# Origins


def slid(links: Links) -> tuple[Link, ...]:
    """Origins slid along their axes to the feet of common normals, so that translations have fewer entries.

    On a revolute axis the origin moves to the foot towards the first joint outside; beside the origin of that joint if
    the axes are parallel; at the end of a chain to the foot towards the joint inside.
    """
    moved = []
    slides = _slides(links)
    for link, slide in zip(links, slides, strict=True):
        own, inside = np.array([[0.0, 0.0, slide], [0.0, 0.0, slides[link.inside] if link.inside >= 0 else 0.0]])
        rotation, translation, moment = (x.astype(float) for x in (link.rotation, link.translation, link.first_moment))
        terms = np.abs([translation, own, inside])
        moved.append(
            replace(
                link,
                translation=scalars(without_rounding(translation + rotation @ own - inside, terms.max())),
                first_moment=scalars(moment - link.mass * own),
                tensor=scalars(link.tensor.astype(float) + moved_tensor(link.mass, moment, -own)),
                slide=link.slide + slide,
            )
        )
    return tuple(moved)


def _slides(links: Links) -> list[float]:
    """Slides of every origin along its axis. None until a joint that is not parallel has decided."""
    slides: list[float | None] = [None] * len(links)
    for j in reversed(range(len(links))):
        outside = _first_outside(links, j)
        if links[j].prismatic or outside is None:
            continue
        feet, next_slide = _feet(links[outside]), slides[outside]
        if feet is not None:
            slides[j] = feet[0]
        elif next_slide is not None:
            slides[j] = float(links[outside].translation[2] + links[outside].rotation[2, 2] * next_slide)
    done: list[float] = []
    for link, slide in zip(links, slides, strict=True):
        if slide is None:
            slide = 0.0 if link.prismatic or link.inside < 0 else _towards_inside(link, done[link.inside])
        done.append(slide)
    return done


def _first_outside(links: Links, j: int) -> int | None:
    """The first revolute joint on body j."""
    return next((k for k, link in enumerate(links) if link.inside == j and not link.prismatic), None)


def _feet(link: Link) -> tuple[float, float] | None:
    """Feet of the common normal of both axes, along the inside axis and along the joint's own; None if far away."""
    axis, translation = link.rotation[:, 2].astype(float), link.translation.astype(float)
    sine_squared = axis[0] ** 2 + axis[1] ** 2
    if sine_squared <= ROTATION_ROUNDING**2:
        return None
    own = -float(translation[:2] @ axis[:2]) / sine_squared
    inside = translation[2] + own * axis[2]
    return (inside, own) if max(abs(own), abs(inside)) <= MAX_FOOT_DISTANCE * np.linalg.norm(translation) else None


def _towards_inside(link: Link, inside: float) -> float:
    """The foot on the joint's own axis, or the point nearest to the origin of the inside body, which slid."""
    feet = _feet(link)
    if feet is not None:
        return feet[1]
    from_origin = link.translation.astype(float) - np.array([0.0, 0.0, inside])
    return -float(from_origin @ link.rotation[:, 2].astype(float))


# Axes


def turned(links: Links) -> tuple[Link, ...]:
    """Joint axes turned about p_j, so that most joints are Rx(α) Rz(q + θ).

    x_j points along the common normal with the first joint outside. What a file rounds in a turn about the axis,
    1.5707963 for π/2, becomes part of θ. Quarter turns cost nothing.
    """
    done: list[Link] = []
    axes: list[Array] = []  # Rz of every body, from the new axes to the old ones
    for j, link in enumerate(links):
        before = axes[link.inside] if link.inside >= 0 else np.eye(3)
        translation = link.translation.astype(float)
        place = before.T @ link.rotation.astype(float)
        own = _own_axes(links, j)
        tilt, rest = (place, np.eye(3)) if link.inside < 0 else _tilt_and_turn(place)
        at_zero = 1.0, 0.0
        if link.inside < 0:  # seen from the ground every direction is a constant
            own = np.eye(3) if own is None else own
            tilt = rounded(tilt @ own)
        elif link.prismatic or own is None:
            own = rest.T
        else:
            turn = rounded(rest @ own)
            at_zero = float(turn[0, 0]), float(turn[1, 0])
        axes.append(own)
        done.append(
            replace(
                link,
                rotation=scalars(tilt),
                translation=scalars(without_rounding(before.T @ translation, np.abs(translation).max())),
                link_axes=scalars(rounded(link.link_axes.astype(float) @ own)),
                first_moment=scalars(own.T @ link.first_moment.astype(float)),
                tensor=scalars(own.T @ link.tensor.astype(float) @ own),
                at_zero=at_zero,
            )
        )
    return tuple(done)


def _own_axes(links: Links, j: int) -> Array | None:
    """Rz with x along the common normal of joint j and the first joint outside; None where any direction is as good."""
    outside = None if links[j].prismatic else next((link for link in links if link.inside == j), None)
    if outside is None:
        return None
    axis, translation = outside.rotation[:, 2].astype(float), outside.translation.astype(float)
    tilted = np.hypot(axis[0], axis[1]) > ROTATION_ROUNDING
    x, y = (-axis[1], axis[0]) if tilted else (translation[0], translation[1])
    return _turn(x, y) if np.hypot(x, y) > 0 else None


def _tilt_and_turn(rotation: Array) -> tuple[Array, Array]:
    """Rz(γ) Rx(α) and Rz(β), whose product is the rotation."""
    axis = rotation[:, 2]
    sine = np.hypot(axis[0], axis[1])
    cosine, sine = rounded(np.array([axis[2], sine]) / np.hypot(axis[2], sine))
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
    tilt = (_turn(-axis[1], axis[0]) if sine else np.eye(3)) @ about_x
    rest = tilt.T @ rotation
    return rounded(tilt), _turn(rest[0, 0], rest[1, 0])


def _turn(x: float, y: float) -> Array:
    """Rz that takes the x axis to the direction (x, y)."""
    c, s = rounded(np.array([x, y]) / np.hypot(x, y))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
