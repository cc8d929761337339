"""The loops of a robot, as part of the format `graphdyn show 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from crosscheck.report.records._fields import Count, Index, Keywords, Number, Vector3


@dataclass(frozen=True, kw_only=True)
class ChordRecord:
    """A connection that closes a loop."""

    number: Index
    """1, 2, …"""

    name: str
    """Of the chord."""

    kind: Literal["hinge", "ball", "slide", "weld", "distance"]
    """What it allows."""

    body_i: str
    """Name of one body, or of the ground."""

    body_j: str
    """Name of the other."""

    xyz_i: Vector3
    """Origin of the chord's frame in the link frame of body i (3) [m]."""

    rpy_i: Vector3
    """Roll, pitch, yaw of the same, R = R_z(yaw) R_y(pitch) R_x(roll) (3) [degree]."""

    xyz_j: Vector3
    """Origin of the chord's frame in the link frame of body j (3) [m]."""

    rpy_j: Vector3
    """Roll, pitch, yaw of the same (3) [degree]."""

    axis: Vector3
    """Unit axis p of a hinge or slide, in chord axes (3)."""

    length: Number
    """Of a distance [m]; null for the others."""

    rows: Sequence[str]
    """What it transmits: a constraint row each, along its t1, t2, p on body i or along the line of a distance."""

    joints: Sequence[str]
    """Names of the joints that form the loop with it."""


@dataclass(frozen=True, kw_only=True)
class ReactionRecord:
    """What one joint or chord transmits: from the inside body to its body, from body i to body j."""

    name: str
    """Of the joint or chord."""

    directions: Sequence[str]
    """Such as force t1, along t_1, t_2, p of the joint or chord."""

    determined: Sequence[bool]
    """The equations determine this component."""

    values: Sequence[Number]
    """With the robot at rest, held by its motors against gravity [N or N m]. Null where undetermined, and where motors
    are unknown or leave a motion free."""


@dataclass(frozen=True, kw_only=True)
class LoopsRecord:
    """The loops of a robot at one closed pose."""

    chords: Annotated[Sequence[ChordRecord], Keywords(minItems=1)]
    """What closes the loops."""

    incidence: Sequence[Annotated[Sequence[Literal[-1, 0, 1]], Keywords(description="A row.")]]
    """Columns for the chords beside the incidence S of the tree: row = body, column = chord; 1 body i, -1 body j."""

    actuated: Sequence[str] | None
    """Names of the joints that have motors; null where that is not known."""

    q: Sequence[float]
    """The pose, closed: that of --state, or the robot's own (n_freedoms) [rad or m]."""

    n_rows: Count
    """Constraint rows of joints, couplings and chords."""

    rank: Count
    """How many of them are independent at this pose."""

    usual_rank: Count
    """In a regular pose."""

    singular: bool
    """More motions are free at this pose than in a regular one."""

    mobility: Count
    """Motions that keep all loops closed."""

    grubler_mobility: int
    """6 bodies less the rows, after Grübler and Kutzbach."""

    undetermined: Sequence[str]
    """Names of the reactions that the equations leave undetermined, such as "elbow force p"."""

    self_stresses: Sequence[
        Annotated[Mapping[str, float], Keywords(description="Reactions by name, relative to the largest.")]
    ]
    """Combinations of reactions that hold each other without any load."""

    reactions: Sequence[ReactionRecord]
    """Of all joints, then of all chords."""

    reactions_missing: str | None
    """Why the reactions have no values; null where they have."""
