"""A rigid-body model as plain numbers, the format `graphdyn export 1`; a folder of exported C, `graphdyn code 1`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from crosscheck.reference.subject import OfReading
from crosscheck.report.records.record import (
    CommandRecord,
    Count,
    Index,
    Keywords,
    Record,
    Versions,
    Warnings,
    attribute,
    written,
)
from graphdyn import Body, Frame, Joint, RobotModel
from graphdyn.export import CCode, ExportedFunction
from urdf import Reading


@dataclass(frozen=True, eq=False)
class JointedBody:
    """A body and the joint that carries it.

    number: 1 … n; entry `number` of q, v, a and τ belongs to its joint
    """

    number: Index
    body: Body
    joint: Joint


@dataclass(frozen=True, eq=False)
class ExportedModel(OfReading):
    """A rigid-body model of n bodies as plain numbers: all that inverse and forward dynamics need.

    robot: name or path as given
    reading: how it was loaded
    """

    model: RobotModel
    robot: str
    reading: Reading

    @property
    def bodies(self) -> list[JointedBody]:
        """Bodies 1 … n, parents first."""
        parts = zip(self.model.bodies, self.model.joints, strict=True)
        return [JointedBody(number, *part) for number, part in enumerate(parts, start=1)]


class ExportedBodyRecord(Record, of=JointedBody, only=("number",)):
    """A body and the joint that carries it.

    name: of the link
    joint: name of the joint
    kind: revolute and continuous joints turn about the axis by q [rad], prismatic ones slide along it by q [m]
    parent: number of the body that the joint starts from; 0 is the ground
    rotation: R, row by row: a point with coordinates x in the joint frame has R x + t in the link frame of the parent;
        at q = 0 the link frame coincides with the joint frame (3, 3)
    translation: t (3,) [m]
    axis: unit axis, in joint axes, which is the same in link axes (3,)
    lower, upper: limits of q, null where there is none [rad or m]
    velocity, effort: limits, null where there is none [rad/s or m/s, N m or N]
    damping: N m s/rad or N s/m; friction: N m or N; armature: kg m² or kg. They are in no function of the model
    """

    name: str = attribute("body.name")
    joint: str = attribute("joint.name")
    kind = attribute("joint.kind")
    parent: Count = attribute("joint.inside")
    rotation = attribute("joint.placement.rotation")
    translation = attribute("joint.placement.translation")
    axis = attribute("joint.axis")
    mass: Annotated[float, Keywords(minimum=0)] = attribute("body.mass")
    center_of_mass = attribute("body.center_of_mass")
    inertia = attribute("body.inertia")
    lower = attribute("joint.limits.lower")
    upper = attribute("joint.limits.upper")
    velocity = attribute("joint.limits.velocity")
    effort = attribute("joint.limits.effort")
    damping = attribute("joint.damping")
    friction = attribute("joint.friction")
    armature = attribute("joint.armature")


class ExportedFrameRecord(Record, of=Frame, only=("name", "body")):
    """A named frame fixed in a body.

    name: of the frame
    body: number of the body; 0 is the ground
    rotation: R: a point with coordinates x in the frame has R x + t in the link frame of the body (3, 3)
    translation: t (3,) [m]
    """

    body: Count
    rotation = attribute("placement.rotation")
    translation = attribute("placement.translation")


class ExportRecord(Record, of=ExportedModel, only=("robot",), format="graphdyn export 1"):
    """A rigid-body model of n bodies as plain numbers: all that inverse and forward dynamics need.

    n: number of bodies and of joints
    base_rotation: R: a point with coordinates x in the ground frame has R x + t in the world (3, 3)
    base_translation: t (3,) [m]
    frames: named frames beside the link frames
    """

    versions: Versions
    warnings: Warnings
    locked = attribute()
    chain = attribute()
    n: Index = attribute("model.n_bodies")
    gravity = attribute("model.gravity")
    base_rotation = attribute("model.base.rotation")
    base_translation = attribute("model.base.translation")
    bodies: Annotated[Sequence[ExportedBodyRecord], Keywords(minItems=1)] = attribute()
    frames: Sequence[ExportedFrameRecord] = attribute("model.frames")


def record(model: ExportedModel) -> dict[str, Any]:
    return written(ExportRecord, model)


class CodeArrayRecord(Record):
    """An argument or a result of a function in C.

    name: of the argument or result
    shape: whose numbers stand row by row; empty of one number
    unit: of its numbers; the second one, after "or", is that of prismatic joints
    """

    name: str
    shape: Sequence[int]
    unit: str


class CodeFunctionRecord(Record):
    """A function in C. It takes the number of joints, then its arguments, then room for its results.

    name: that of graphdyn's verb
    symbol: its name in C; that for rows of states ends in _batch
    arguments: what it reads, in this order
    results: what it writes, in this order
    frame, reference: that it speaks of; null where it speaks of none
    """

    name: str
    symbol: str
    arguments: Sequence[CodeArrayRecord]
    results: Sequence[CodeArrayRecord]
    frame: str | None
    reference: str | None


class CodeRecord(CommandRecord, format="graphdyn code 1"):
    """A folder of functions of one robot in C.

    files: names of the other files in this folder
    robot: as given
    name: with which all names in C begin
    precision: of all numbers
    sines: sine and cosine of its own, or those of the C library
    joint_names: the order of the joints
    gravity: in world axes (3,) [m/s²]
    functions: what the files compute
    """

    files: Sequence[str]
    robot: str
    name: str
    precision: Literal["double", "single"]
    sines: Literal["own", "libm"]
    joint_names: Sequence[str]
    gravity: Sequence[float]
    functions: Sequence[CodeFunctionRecord]


def code_record(code: CCode, robot: str, command: Sequence[str]) -> dict[str, Any]:
    """robot: as given"""
    model = code.functions[0].model
    return written(
        CodeRecord,
        command=command,
        files=list(code.files),
        robot=robot,
        name=code.name,
        precision=code.precision,
        sines=code.sines,
        joint_names=model.independent_joints,
        gravity=model.gravity,
        functions=[_function(code, function) for function in code.functions],
    )


def _function(code: CCode, function: ExportedFunction) -> dict[str, Any]:
    arrays = [
        [
            written(CodeArrayRecord, name=name, shape=list(function.shape(name)), unit=spec.unit)
            for name, spec in specs.items()
        ]
        for specs in (function.inputs, function.outputs)
    ]
    return written(
        CodeFunctionRecord,
        name=function.name,
        symbol=f"{code.name}_{function.name}",
        arguments=arrays[0],
        results=arrays[1],
        frame=function.frame and function.frame.name,
        reference=function.frame and function.frame.reference,
    )
