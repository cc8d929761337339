"""Inertial parameters of links, before those that are fixed to one another become one body."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from crosscheck.judging.faults.recursion import DynamicsCode
from graphdyn import RobotModel
from graphdyn.layout import Array
from graphdyn.model import parallel_axis
from urdf.reading import Misreadings

LINK_PARAMETERS = 13
"""Mass, first moment, and the nine entries of the tensor about the link origin: products with a rotation are not
symmetric."""


@dataclass(frozen=True, eq=False)
class PlacedInertial:
    """What a file says of the inertia of a link, and where the link is.

    body: number of the body that carries it, from 0; rotation (3, 3), translation (3,): of the link in that body
    mass [kg], center (3,) [m]; axes (3, 3): of the inertial frame, in link axes; tensor (3, 3): in these [kg m²]
    """

    name: str
    body: int
    rotation: Array
    translation: Array
    mass: float
    center: Array
    axes: Array
    tensor: Array

    @property
    def turned_tensor(self) -> Array:
        """About the center of mass, in link axes."""
        turned: Array = self.axes @ self.tensor @ self.axes.T
        return turned


Parameters = tuple[float, Array, Array]
"""Mass, first moment (3,), tensor about the link origin (3, 3), in link axes."""


def right(link: PlacedInertial) -> Parameters:
    return about_origin(link.mass, link.center, link.turned_tensor)


def about_origin(mass: float, center: Array, tensor: Array) -> Parameters:
    """The parameters, from the tensor about the center of mass."""
    return mass, mass * center, tensor + parallel_axis(mass, center)


def in_body(link: PlacedInertial, parameters: Parameters) -> Array:
    """The same about the body's origin, in body axes (13,)."""
    mass, moment, tensor = parameters
    h, t = link.rotation @ moment, link.translation
    moved = link.rotation @ tensor @ link.rotation.T + parallel_axis(mass, t)
    moved = moved + 2 * (h @ t) * np.eye(3) - np.outer(h, t) - np.outer(t, h)
    return np.concatenate([[mass], h + mass * t, moved.ravel()])


def bodies_of(code: DynamicsCode) -> list[PlacedInertial]:
    """The bodies of a code, without names."""
    x = code.numbers
    numbers = zip(x.masses, x.centers, x.tensors, strict=True)
    return [
        PlacedInertial("", k, np.eye(3), np.zeros(3), float(mass), center, np.eye(3), tensor)
        for k, (mass, center, tensor) in enumerate(numbers)
    ]


def links_of(model: RobotModel, readings: Misreadings | None) -> list[PlacedInertial]:
    """The links with an inertial that moves, as the file has them; the bodies of the model where it has no file, or
    its reading changed them."""
    bodies = [
        PlacedInertial(body.name, k, np.eye(3), np.zeros(3), body.mass, body.center_of_mass, np.eye(3), body.inertia)
        for k, body in enumerate(model.bodies)
    ]
    links = [] if readings is None else list(_of_file(readings, model))
    whole = np.zeros((len(bodies), LINK_PARAMETERS))
    for link in links:
        whole[link.body] += in_body(link, right(link))
    ours = np.array([in_body(body, right(body)) for body in bodies])
    return links if np.allclose(whole, ours, rtol=1e-9, atol=1e-12 * np.abs(ours).max()) else bodies


def _of_file(readings: Misreadings, model: RobotModel) -> Iterator[PlacedInertial]:
    known = {*model.body_names, *(frame.name for frame in model.frames)}
    for link in readings.robot.links:
        if link.inertial is None or link.name not in known:
            continue
        frame = model.frame(link.name)
        origin = np.eye(4) if link.inertial.origin is None else link.inertial.origin
        if frame.body > 0:
            yield PlacedInertial(
                link.name,
                frame.body - 1,
                frame.placement.rotation,
                frame.placement.translation,
                link.inertial.mass or 0.0,
                origin[:3, 3],
                origin[:3, :3],
                np.zeros((3, 3)) if link.inertial.inertia is None else link.inertial.inertia,
            )
