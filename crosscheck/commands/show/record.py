"""What `graphdyn show 1` says of a state: where the bodies are, how they move, what holds them.

The loops of a robot, as part of the format `graphdyn show 1`.

The format `graphdyn show 1`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.record_fields import FORMAT, Count, Index, Keywords, Number, Vector3, Versions
from crosscheck.report.versions import versions

Vector6 = Annotated[Sequence[float], Keywords(minItems=6, maxItems=6)]
NumberMatrix = Sequence[Annotated[Sequence[float], Keywords(description="A row.")]]


@dataclass(frozen=True, kw_only=True)
class BodyPlacementRecord:
    """Where the link frame of a body is in the world."""

    name: str
    """Of its link."""

    xyz: Vector3
    """Origin (3) [m]."""

    rpy: Vector3
    """Roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3) [degree]."""


@dataclass(frozen=True, kw_only=True)
class MassMotionRecord:
    """Center of mass and momentum of all moving bodies together, in world axes."""

    center_of_mass: Vector3
    """In the world (3) [m]."""

    center_of_mass_velocity: Vector3
    """(3) [m/s]"""

    momentum: Vector6
    """Linear, then angular about the center of mass (6) [kg m/s, kg m²/s]."""

    momentum_about_origin: Vector6
    """Linear, then angular about the world's origin (6) [kg m/s, kg m²/s]."""


@dataclass(frozen=True, kw_only=True)
class FrameStateRecord:
    """Where a named frame is, and how it moves."""

    name: str
    """Of the frame, as given."""

    reference: Literal["world", "local", "local_world_aligned"]
    """Point and axes of velocity and Jacobian, in Pinocchio's words."""

    xyz: Vector3
    """Origin in the world (3) [m]."""

    rpy: Vector3
    """Roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3) [degree]."""

    velocity: Vector6
    """Linear velocity, then angular velocity (6) [m/s, rad/s]."""

    jacobian: Annotated[NumberMatrix, Keywords(minItems=6, maxItems=6)]
    """J with velocity = J v (6, n) [m, 1 of revolute joints, 1, 0 of prismatic ones]."""


@dataclass(frozen=True, kw_only=True)
class StateRecord:
    """The robot at one state."""

    q: Sequence[float]
    """Joint positions (n) [rad or m]."""

    v: Sequence[float]
    """Joint velocities (n) [rad/s or m/s]."""

    kinetic_energy: float
    """[J]"""

    potential_energy: float
    """[J], zero where the centers of mass are at the height of the world's origin."""

    motion: MassMotionRecord | None
    """Of the whole robot; null where no body has mass."""

    gravity_torque: Sequence[float] | None
    """What holds the robot at rest (n) [N m or N]; with loops, at the motors, and null where these are unknown or leave
    a motion free."""

    bias_torque: Sequence[float] | None
    """h in M a + h = τ (n) [N m or N]; with loops as gravity_torque."""

    mass_matrix: NumberMatrix
    """M (n, n) [kg m², kg m, kg]; of a robot with loops, of the tree, whose joints are free."""

    mass_matrix_condition: Number
    """2-norm condition number of M in SI units. Null where it is infinite."""

    bodies: Sequence[BodyPlacementRecord]
    """Where the link frames are."""

    frame: FrameStateRecord


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
    """The pose, closed: that of --state, or the robot's own (nv) [rad or m]."""

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
