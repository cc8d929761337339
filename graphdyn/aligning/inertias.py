"""The inertias of the links of two robots, one laid over the other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from graphdyn.aligning.axes import JointAxes, across, turn_about
from graphdyn.layout import Array
from graphdyn.model.parts import axis_normals
from graphdyn.model.robot_model import RobotModel


@dataclass(frozen=True, eq=False)
class LinkInertias:
    """Masses, centers of mass and tensors of the links of A and B, each where its robot has it at q = 0.

    tolerance: differences that do not count, as a part of the mass, the length and the tensor
    """

    masses: tuple[Array, Array]
    centers: tuple[Array, Array]
    tensors: tuple[Array, Array]
    tolerance: float
    length: float

    @classmethod
    def of(
        cls, models: tuple[RobotModel, RobotModel], axes: tuple[JointAxes, JointAxes], tolerance: float
    ) -> LinkInertias:
        """The inertias of two robots; length: the reach of the first."""
        masses, centers, tensors = [], [], []
        for model, lines in zip(models, axes, strict=True):
            rotations, origins = lines.links[:, :3, :3], lines.links[:, :3, 3]
            c = np.array([body.center_of_mass for body in model.bodies])
            masses.append(np.array([body.mass for body in model.bodies]))
            centers.append(origins + (rotations @ c[:, :, None])[:, :, 0])
            inner = np.array([body.inertia for body in model.bodies])
            tensors.append(rotations @ inner @ rotations.transpose(0, 2, 1))
        one, two, three = ((each[0], each[1]) for each in (masses, centers, tensors))
        return cls(one, two, three, tolerance, axes[0].reach)

    def agree(self, body: int, place: Array) -> bool:
        """Whether the inertias agree where B's link is moved by place (4, 4); never of a link without mass."""
        mass, other = (float(each[body]) for each in self.masses)
        if mass == 0 or abs(other - mass) > self.tolerance * mass:
            return False
        rotation = place[:3, :3]
        center = rotation @ self.centers[1][body] + place[:3, 3]
        if np.linalg.norm(center - self.centers[0][body]) > self.tolerance * self.length:
            return False
        tensor = rotation @ self.tensors[1][body] @ rotation.T
        largest = float(np.abs(self.tensors[0][body]).max())
        return bool(np.abs(tensor - self.tensors[0][body]).max() <= self.tolerance * largest)

    def fits(
        self, body: int, place: Array, direction: Array, point: Array, angle: float
    ) -> Iterator[tuple[float, float]]:
        """Angles about a line and shifts along it that may bring B's link over A's [rad], [m].

        angle: what the axes say, tried first; then that of the centers of mass, and those of the tensors
        """
        rotation = place[:3, :3]
        center, target = rotation @ self.centers[1][body] + place[:3, 3] - point, self.centers[0][body] - point
        shift = float(direction @ (target - center))
        yield angle, 0.0
        yield angle, shift
        if min(np.linalg.norm(across(direction, each)) for each in (center, target)) > self.tolerance * self.length:
            yield turn_about(direction, center, target), shift
            return
        tensors = rotation @ self.tensors[1][body] @ rotation.T, self.tensors[0][body]
        sizes = [float(np.abs(each).max()) for each in tensors]
        slanted = [across(direction, each @ direction) for each in tensors]
        if min(np.linalg.norm(one) - self.tolerance * size for one, size in zip(slanted, sizes, strict=True)) > 0:
            yield turn_about(direction, slanted[0], slanted[1]), shift
            return
        normals = axis_normals(direction)
        flat = [normals @ each @ normals.T for each in tensors]
        doubled = [np.array([each[0, 0] - each[1, 1], 2 * each[0, 1]]) for each in flat]
        turn = float(np.arctan2(*doubled[1][::-1]) - np.arctan2(*doubled[0][::-1])) / 2
        yield turn, shift
        yield turn + np.pi, shift
