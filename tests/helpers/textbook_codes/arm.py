"""The numbers of a robot, as plain arrays."""

import dataclasses
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class PlainArm:
    """Arrays per joint and body, in the order of the joints; body 0 is the base.

    tensors: about the centers of mass, in link axes        (n, 3, 3)
    frame_body, frame_rotation, frame_point: the frame of functions of a frame, in a body
    """

    inside: tuple[int, ...]
    prismatic: tuple[bool, ...]
    rotations: np.ndarray
    translations: np.ndarray
    axes: np.ndarray
    masses: np.ndarray
    centers: np.ndarray
    tensors: np.ndarray
    gravity: np.ndarray
    base_rotation: np.ndarray
    base_origin: np.ndarray
    frame_body: int
    frame_rotation: np.ndarray
    frame_point: np.ndarray

    @classmethod
    def of(cls, model, frame):
        """The numbers of a RobotModel. frame: name of one of its frames or bodies"""
        places = {f.name: (f.body, f.placement.rotation, f.placement.translation) for f in model.frames}
        places |= {b.name: (k, np.eye(3), np.zeros(3)) for k, b in enumerate(model.bodies, start=1)}
        return cls(
            tuple(joint.inside for joint in model.joints),
            tuple(joint.kind == "prismatic" for joint in model.joints),
            np.array([joint.placement.rotation for joint in model.joints]),
            np.array([joint.placement.translation for joint in model.joints]),
            np.array([joint.axis for joint in model.joints]),
            np.array([body.mass for body in model.bodies]),
            np.array([body.center_of_mass for body in model.bodies]),
            np.array([body.inertia for body in model.bodies]),
            np.array(model.gravity),
            np.array(model.base.rotation),
            np.array(model.base.translation),
            *places[frame],
        )

    @property
    def n(self):
        return len(self.masses)

    def but(self, **changes):
        return dataclasses.replace(self, **changes)

    def one(self, field, k, change):
        """The arm with entry k of one of its arrays changed."""
        array = np.array(getattr(self, field))
        array[k] = change(array[k])
        return self.but(**{field: array})

    def path(self, body):
        """Joints between the base and a body, from the inside out."""
        found = []
        while body > 0:
            found.insert(0, body - 1)
            body = self.inside[body - 1]
        return found
