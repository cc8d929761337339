"""The format `graphdyn show 1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np

from crosscheck.commands.show.description import RobotDescription, SystemDescription
from crosscheck.commands.show.dh import ShownDHRecord, dh_record
from crosscheck.commands.show.loops import LoopsDescription
from crosscheck.commands.show.state import rpy_in_degrees
from crosscheck.report.records.record import Index, Keywords, Record, Versions, Warnings, attribute, written
from graphdyn import Body, Chord, Frame, Joint, RobotModel

Vector = Annotated[Sequence[float], Keywords(minItems=3, maxItems=3)]
Signs = Sequence[Sequence[Literal[-1, 0, 1]]]


class PlacedRecord(Record):
    """xyz: origin in the link frame of the body (3,) [m]
    rpy: roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) [degree]
    """

    xyz = attribute("placement.translation")
    rpy: Vector


class ShownBodyRecord(Record, of=Body, only=("name", "mass", "center_of_mass")):
    """A body, in its link axes.

    number: 1 … n
    name: of its link
    principal_moments: of the inertia tensor about the center of mass, ascending [kg m²]
    consistent: a real body can have these inertials
    problems: why not; empty where it can
    """

    number: Index
    mass: Annotated[float, Keywords(minimum=0)]
    principal_moments: Vector
    consistent: bool
    problems: Sequence[str]


class ShownJointRecord(PlacedRecord, of=Joint, only=("name", "kind", "axis", "damping", "friction")):
    """A joint.

    number: 1 … n
    name: of the joint
    inside: name of the body it starts from
    body: name of the body it carries
    xyz: origin of the joint frame in the link frame of the inside body (3,) [m]
    lower, upper: limits of position; None where there are none [rad or m]
    velocity: velocity limit; None where there is none [rad/s or m/s]
    effort: effort limit; None where there is none [N m or N]
    damping: not part of the rigid dynamics [N m s/rad or N s/m]
    friction: not part of the rigid dynamics [N m or N]
    """

    number: Index
    inside: str
    body: str
    lower = attribute("limits.lower")
    upper = attribute("limits.upper")
    velocity = attribute("limits.velocity")
    effort = attribute("limits.effort")


class ShownFrameRecord(PlacedRecord, of=Frame, only=("name", "aliases")):
    """A frame.

    name: of the frame
    body: name of the body that holds it
    """

    body: str


class ShownChordRecord(Record, of=Chord, only=("name", "kind", "axis", "length")):
    """A connection that closes a loop.

    number: 1, 2, …
    name: of the chord
    body_i: name of one body, or of the ground
    body_j: name of the other
    xyz_i: origin of the chord's frame in the link frame of body i (3,) [m]
    rpy_i: roll, pitch, yaw of the same, R = R_z(yaw) R_y(pitch) R_x(roll) [degree]
    xyz_j: origin of the chord's frame in the link frame of body j (3,) [m]
    rpy_j: roll, pitch, yaw of the same [degree]
    rows: what it transmits: a constraint row each, along its t1, t2, p on body i or along the line of a distance
    joints: names of the joints that form the loop with it
    """

    number: Index
    body_i: str
    body_j: str
    xyz_i = attribute("placement_i.translation")
    rpy_i: Vector
    xyz_j = attribute("placement_j.translation")
    rpy_j: Vector
    rows = attribute()
    joints: Sequence[str]


class ShownLoopsRecord(Record, of=LoopsDescription, only=("q", "reactions", "reactions_missing")):
    """The loops of a robot at one closed pose.

    chords: what closes the loops
    n_rows: constraint rows of joints, couplings and chords
    rank: how many of them are independent at this pose
    """

    chords: Annotated[Sequence[ShownChordRecord], Keywords(minItems=1)]
    incidence: Signs = attribute()
    actuated = attribute("model.actuated")
    n_rows = attribute("analysis.n_rows")
    rank = attribute("analysis.rank")
    usual_rank = attribute("analysis.usual_rank")
    singular = attribute("analysis.is_singular")
    mobility = attribute("analysis.mobility")
    infinitesimal_mobility = attribute("analysis.infinitesimal_mobility")
    grubler_mobility = attribute("analysis.grubler_mobility")
    undetermined = attribute()
    self_stresses = attribute("analysis.self_stresses")


class ShownGraphRecord(Record):
    """The graph as matrices (docs/notation.md).

    incidence: S: row = body, column = joint (n, n)
    path: T: row = joint, column = body (n, n)
    force_element: S^e: row = body, column = force element (n, n)
    body_joint_vectors: C: row = body, column = joint, in axes of the row's body (n, n, 3) [m]
    """

    incidence: Signs
    path: Signs
    force_element: Signs
    body_joint_vectors: Sequence[Sequence[Sequence[float]]]


class ShownSystemRecord(Record, of=SystemDescription):
    """The matrix [A φ_qᵀ; φ_q 0] of Eq. (111) at one random state.

    pattern: one string per row: 1 where an entry differs from zero by more than rounding, else 0
    """

    pattern: Sequence[Annotated[str, Keywords(pattern="^[01]+$")]]


class ShowRecord(Record, of=RobotDescription, leave_out=("model", "reading"), format="graphdyn show 1"):
    """A robot of n bodies: its parts, its graph, and the pattern of its equations.

    base: name of the ground, body 0
    base_xyz: origin of the ground frame in the world (3,) [m]
    base_rpy: roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) [degree]
    bodies: bodies 1 … n, parents first
    joints: joints 1 … n; joint j carries body j
    couplings: joints that others drive; q, v, a and τ have entries for the other joints, in their order
    frames: named frames fixed in the bodies
    graph: its matrices
    dh: Denavit-Hartenberg parameters; null without --dh
    """

    versions: Versions
    warnings: Warnings
    base = attribute("model.base_name")
    locked = attribute()
    chain = attribute()
    base_xyz = attribute("model.base.translation")
    base_rpy: Vector
    gravity = attribute("model.gravity")
    total_mass: Annotated[float, Keywords(minimum=0)] = attribute()
    bodies: Annotated[Sequence[ShownBodyRecord], Keywords(minItems=1)]
    joints: Annotated[Sequence[ShownJointRecord], Keywords(minItems=1)]
    couplings = attribute("model.couplings")
    loops: ShownLoopsRecord | None
    frames: Sequence[ShownFrameRecord]
    graph: ShownGraphRecord
    system: ShownSystemRecord
    dh: ShownDHRecord | None


def record(robot: RobotDescription) -> dict[str, Any]:
    model, pattern = robot.model, robot.system.pattern
    names = (model.base_name, *model.body_names)
    return written(
        ShowRecord,
        robot,
        base_rpy=rpy_in_degrees(model.base),
        bodies=_bodies(model),
        joints=[
            written(
                ShownJointRecord,
                joint,
                number=number,
                inside=names[joint.inside],
                body=names[number],
                rpy=rpy_in_degrees(joint.placement),
            )
            for number, joint in enumerate(model.joints, start=1)
        ],
        loops=None if robot.loops is None else _loops(robot.loops, names),
        frames=[
            written(ShownFrameRecord, frame, body=names[frame.body], rpy=rpy_in_degrees(frame.placement))
            for frame in model.frames
        ],
        graph=written(
            ShownGraphRecord,
            incidence=model.graph.incidence(),
            path=model.graph.path_matrix(),
            force_element=model.graph.incidence(),
            body_joint_vectors=model.body_joint_vectors(),
        ),
        dh=None if robot.dh is None else dh_record(robot.dh),
        system=written(
            ShownSystemRecord,
            robot.system,
            pattern=["".join("01"[entry] for entry in row) for row in pattern.astype(int)],
        ),
    )


def _bodies(model: RobotModel) -> list[dict[str, Any]]:
    return [
        written(
            ShownBodyRecord,
            body,
            number=number,
            principal_moments=np.linalg.eigvalsh(body.inertia),
            consistent=verdict.consistent,
            problems=verdict.problems,
        )
        for number, (body, verdict) in enumerate(zip(model.bodies, model.physical_consistency(), strict=True), start=1)
    ]


def _loops(loops: LoopsDescription, names: Sequence[str]) -> dict[str, Any]:
    chords = [
        written(
            ShownChordRecord,
            chord,
            number=number,
            body_i=names[chord.body_i],
            body_j=names[chord.body_j],
            rpy_i=rpy_in_degrees(chord.placement_i),
            rpy_j=rpy_in_degrees(chord.placement_j),
            joints=loops.joints(chord),
        )
        for number, chord in enumerate(loops.model.chords, start=1)
    ]
    return written(ShownLoopsRecord, loops, chords=chords)
