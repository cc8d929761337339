"""The format `graphdyn show 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.records._fields import FORMAT, Count, Index, Keywords, Number, Vector3, Versions
from crosscheck.report.records.show_loops import LoopsRecord
from crosscheck.report.records.show_state import StateRecord
from crosscheck.report.versions import versions

Matrix = Sequence[Annotated[Sequence[Literal[-1, 0, 1]], Keywords(description="A row.")]]


@dataclass(frozen=True, kw_only=True)
class ShowBodyRecord:
    """A body, in its link axes."""

    number: Index
    """1 … n."""

    name: str
    """Of its link."""

    mass: Annotated[float, Keywords(minimum=0)]
    """[kg]"""

    center_of_mass: Vector3
    """In the link frame (3) [m]."""

    principal_moments: Vector3
    """Of the inertia tensor about the center of mass, ascending (3) [kg m²]."""

    consistent: bool
    """A real body can have these inertials."""

    problems: Sequence[str]
    """Why not; empty where it can."""


@dataclass(frozen=True, kw_only=True)
class JointRecord:
    """A joint."""

    number: Index
    """1 … n."""

    name: str
    """Of the joint."""

    kind: Literal["revolute", "continuous", "prismatic"]
    """What it allows."""

    inside: str
    """Name of the body it starts from."""

    body: str
    """Name of the body it carries."""

    axis: Vector3
    """Unit axis, in joint axes (3)."""

    xyz: Vector3
    """Origin of the joint frame in the link frame of the inside body (3) [m]."""

    rpy: Vector3
    """Roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3) [degree]."""

    lower: Number
    """Lower limit [rad or m]. Null where there is none."""

    upper: Number
    """Upper limit [rad or m]. Null where there is none."""

    velocity: Number
    """Velocity limit [rad/s or m/s]. Null where there is none."""

    effort: Number
    """Effort limit [N m or N]. Null where there is none."""

    damping: float
    """[N m s/rad or N s/m]; not part of the rigid dynamics."""

    friction: float
    """[N m or N]; not part of the rigid dynamics."""


@dataclass(frozen=True)
class CouplingRecord:
    """A joint that others drive: its position is Σ ratio × theirs + offset."""

    joint: str
    """Name of the joint that is driven."""

    ratios: Mapping[str, float]
    """By name of the joint that drives [1, rad/m or m/rad]."""

    offset: float
    """[rad or m]"""


@dataclass(frozen=True, kw_only=True)
class FrameRecord:
    """A frame."""

    name: str
    """Of the frame."""

    aliases: Sequence[str]
    """Further names of the same frame."""

    body: str
    """Name of the body that holds it."""

    xyz: Vector3
    """Origin in the link frame of that body (3) [m]."""

    rpy: Vector3
    """Roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3) [degree]."""


@dataclass(frozen=True, kw_only=True)
class GraphRecord:
    """The graph as matrices (docs/notation.md)."""

    incidence: Matrix
    """S (n, n): row = body, column = joint."""

    path: Matrix
    """T (n, n): row = joint, column = body."""

    force_element: Matrix
    """S^e (n, n): row = body, column = force element."""

    body_joint_vectors: Sequence[
        Annotated[Sequence[Annotated[Vector3, Keywords(description="An entry.")]], Keywords(description="A row.")]
    ]
    """C (n, n, 3): row = body, column = joint, in axes of the row's body [m]."""


@dataclass(frozen=True, kw_only=True)
class SystemRecord:
    """The matrix [A φ_qᵀ; φ_q 0] of Eq. (111) at one random state."""

    seed: Count
    """Seed of the state."""

    q: Sequence[float]
    """The state (n) [rad or m]."""

    pattern: Sequence[Annotated[str, Keywords(pattern="^[01]+$", description="A row.")]]
    """One string per row: 1 where an entry differs from zero by more than rounding, else 0."""

    rank: Count
    """Numerical rank; full: size. With loops it is less where rows depend on each other."""

    condition_number: Number
    """2-norm condition number in SI units. Null where the matrix is singular."""

    size: Annotated[int, Keywords(minimum=11)]
    """Rows and columns: 11n, one for each coupling, one for each row of a chord."""


@dataclass(frozen=True, kw_only=True)
class ShowRecord:
    """A robot of n bodies: its parts, its graph, and the pattern of its equations."""

    format: Annotated[Literal["graphdyn show 1"], FORMAT] = "graphdyn show 1"

    versions: Versions = field(default_factory=versions)

    robot: str
    """Name or path as given."""

    locked: Mapping[str, float]
    """Joints that were frozen, and where [rad or m]."""

    base: str
    """Name of the ground, body 0."""

    base_xyz: Vector3
    """Origin of the ground frame in the world (3) [m]."""

    base_rpy: Vector3
    """Roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3) [degree]."""

    gravity: Vector3
    """World axes (3) [m/s²]."""

    total_mass: Annotated[float, Keywords(minimum=0)]
    """Of the moving bodies [kg]."""

    bodies: Annotated[Sequence[ShowBodyRecord], Keywords(minItems=1)]
    """Bodies 1 … n, parents first."""

    joints: Annotated[Sequence[JointRecord], Keywords(minItems=1)]
    """Joints 1 … n; joint j carries body j."""

    couplings: Sequence[CouplingRecord]
    """Joints that others drive; q, v, a and τ have entries for the other joints, in their order."""

    loops: LoopsRecord | None = None
    """Null where the robot is a tree."""

    frames: Sequence[FrameRecord]
    """Named frames fixed in the bodies."""

    graph: GraphRecord

    system: SystemRecord

    state: StateRecord | None = None
    """What was asked for with --state; null where nothing was."""
