"""A rigid-body model as plain numbers, and the format `graphdyn export 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from crosscheck.report.records.record import Count, Index, Keywords, Record, Versions, written
from graphdyn import RobotModel


@dataclass(frozen=True, kw_only=True)
class ExportedBody:
    """A body and the joint that carries it.

    number: 1 … n; entry `number` of q, v, a and τ belongs to its joint
    name: of the link
    joint: name of the joint
    kind: revolute and continuous joints turn about the axis by q [rad], prismatic ones slide along it by q [m]
    parent: number of the body that the joint starts from; 0 is the ground
    rotation: R, row by row: a point with coordinates x in the joint frame has R x + t in the link frame of the parent;
        at q = 0 the link frame coincides with the joint frame (3, 3)
    translation: t (3,) [m]
    axis: unit axis, in joint axes, which is the same in link axes (3,)
    mass: [kg]
    center_of_mass: in the link frame (3,) [m]
    inertia: tensor about the center of mass, in link axes (3, 3) [kg m²]
    """

    number: Index
    name: str
    joint: str
    kind: Literal["revolute", "continuous", "prismatic"]
    parent: Count
    rotation: Sequence[Sequence[float]]
    translation: Sequence[float]
    axis: Sequence[float]
    mass: Annotated[float, Keywords(minimum=0)]
    center_of_mass: Sequence[float]
    inertia: Sequence[Sequence[float]]


@dataclass(frozen=True, kw_only=True)
class ExportedFrame:
    """A named frame fixed in a body.

    name: of the frame
    body: number of the body; 0 is the ground
    rotation: R: a point with coordinates x in the frame has R x + t in the link frame of the body (3, 3)
    translation: t (3,) [m]
    """

    name: str
    body: Count
    rotation: Sequence[Sequence[float]]
    translation: Sequence[float]


@dataclass(frozen=True, kw_only=True)
class ExportedModel:
    """A rigid-body model of n bodies as plain numbers: all that inverse and forward dynamics need.

    robot: name or path as given
    locked: joints that were frozen, and where [rad or m]
    n: number of bodies and of joints
    gravity: in world axes (3,) [m/s²]
    base_rotation: R: a point with coordinates x in the ground frame has R x + t in the world (3, 3)
    base_translation: t (3,) [m]
    bodies: bodies 1 … n, parents first
    frames: named frames beside the link frames
    """

    robot: str
    locked: Mapping[str, float]
    n: Index
    gravity: Sequence[float]
    base_rotation: Sequence[Sequence[float]]
    base_translation: Sequence[float]
    bodies: Annotated[Sequence[ExportedBody], Keywords(minItems=1)]
    frames: Sequence[ExportedFrame]


def exported(model: RobotModel, robot: str, locked: Mapping[str, float]) -> ExportedModel:
    """robot: as given; locked: the joints that were frozen"""
    bodies = [
        ExportedBody(
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
        ExportedFrame(
            name=frame.name,
            body=frame.body,
            rotation=frame.placement.rotation.tolist(),
            translation=frame.placement.translation.tolist(),
        )
        for frame in model.frames
    ]
    return ExportedModel(
        robot=robot,
        locked=locked,
        n=model.n_bodies,
        gravity=model.gravity.tolist(),
        base_rotation=model.base.rotation.tolist(),
        base_translation=model.base.translation.tolist(),
        bodies=bodies,
        frames=frames,
    )


class ExportRecord(Record, of=ExportedModel, format="graphdyn export 1"):
    """A rigid-body model of n bodies as plain numbers: all that inverse and forward dynamics need."""

    versions: Versions


def record(model: ExportedModel) -> dict[str, Any]:
    return written(ExportRecord, model)
