"""The format `graphdyn export 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.record_fields import FORMAT, Count, Index, Keywords, Vector3, Versions
from crosscheck.report.versions import versions
from graphdyn import RobotModel

Matrix3 = Annotated[
    Sequence[Annotated[Vector3, Keywords(description="A row.")]],
    Keywords(minItems=3, maxItems=3),
]


@dataclass(frozen=True, kw_only=True)
class ExportedBodyRecord:
    """A body and the joint that carries it."""

    number: Index
    """1 … n; entry `number` of q, v, a and τ belongs to its joint."""

    name: str
    """Of the link."""

    joint: str
    """Name of the joint."""

    kind: Literal["revolute", "continuous", "prismatic"]
    """Revolute and continuous joints turn about the axis by q [rad], prismatic ones slide along it by q [m]."""

    parent: Count
    """Number of the body that the joint starts from; 0 is the ground."""

    rotation: Matrix3
    """R (3, 3), row by row: a point with coordinates x in the joint frame has R x + t in the link frame of the parent.

    At q = 0 the link frame coincides with the joint frame.
    """

    translation: Vector3
    """t (3) [m]"""

    axis: Vector3
    """Unit axis, in joint axes, which is the same in link axes (3)."""

    mass: Annotated[float, Keywords(minimum=0)]
    """[kg]"""

    center_of_mass: Vector3
    """In the link frame (3) [m]."""

    inertia: Matrix3
    """Tensor about the center of mass, in link axes (3, 3) [kg m²]."""


@dataclass(frozen=True, kw_only=True)
class ExportedFrameRecord:
    """A named frame fixed in a body."""

    name: str
    """Of the frame."""

    body: Count
    """Number of the body; 0 is the ground."""

    rotation: Matrix3
    """R (3, 3): a point with coordinates x in the frame has R x + t in the link frame of the body."""

    translation: Vector3
    """t (3) [m]"""


@dataclass(frozen=True, kw_only=True)
class ExportRecord:
    """A rigid-body model of n bodies as plain numbers: all that inverse and forward dynamics need."""

    format: Annotated[Literal["graphdyn export 1"], FORMAT] = "graphdyn export 1"

    versions: Versions = field(default_factory=versions)

    robot: str
    """Name or path as given."""

    locked: Mapping[str, float]
    """Joints that were frozen, and where [rad or m]."""

    n: Index
    """Number of bodies and of joints."""

    gravity: Vector3
    """In world axes (3) [m/s²]."""

    base_rotation: Matrix3
    """R (3, 3): a point with coordinates x in the ground frame has R x + t in the world."""

    base_translation: Vector3
    """t (3) [m]"""

    bodies: Annotated[Sequence[ExportedBodyRecord], Keywords(minItems=1)]
    """Bodies 1 … n, parents first."""

    frames: Sequence[ExportedFrameRecord]
    """Named frames beside the link frames."""


def record(model: RobotModel, robot: str, locked: Mapping[str, float]) -> ExportRecord:
    """robot: as given; locked: the joints that were frozen"""
    bodies = [
        ExportedBodyRecord(
            number=number,
            name=body.name,
            joint=joint.name,
            kind=joint.kind,
            parent=joint.inside,
            rotation=joint.placement.rotation.tolist(),
            translation=joint.placement.translation.tolist(),
            axis=joint.axis.tolist(),
            mass=body.mass,
            center_of_mass=body.center_of_mass.tolist(),
            inertia=body.inertia.tolist(),
        )
        for number, (body, joint) in enumerate(zip(model.bodies, model.joints, strict=True), start=1)
    ]
    frames = [
        ExportedFrameRecord(
            name=frame.name,
            body=frame.body,
            rotation=frame.placement.rotation.tolist(),
            translation=frame.placement.translation.tolist(),
        )
        for frame in model.frames
    ]
    return ExportRecord(
        robot=robot,
        locked=locked,
        n=model.n_bodies,
        gravity=model.gravity.tolist(),
        base_rotation=model.base.rotation.tolist(),
        base_translation=model.base.translation.tolist(),
        bodies=bodies,
        frames=frames,
    )
