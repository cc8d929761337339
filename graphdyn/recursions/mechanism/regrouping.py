"""Fewer inertial parameters with the same joint torques: what may belong to either of two bodies goes to the inner one.

Gautier and Khalil, "Direct calculation of minimum set of inertial parameters of serial robots", IEEE Transactions on
Robotics and Automation 6(3), 1990. Mass on the axis of a revolute joint moves in the same way whether it belongs to the
inside body or to body j, and has no moment about the axis: any m, m c_z and I_xx = I_yy may change sides, and leave
body j without mass. Past a slide, relative to which nothing turns, goes the whole tensor. What reaches the ground is
dropped.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.layout import Array
from graphdyn.recursions.mechanism.mechanism import ROTATION_ROUNDING, Link, Links, without_rounding
from graphdyn.scalars.vectors import scalars


def regrouped(links: Links) -> tuple[Link, ...]:
    """The bodies with the parameters of graphdyn.recursions.mechanism.regrouping moved inwards."""
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
