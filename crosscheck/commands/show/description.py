"""What `graphdyn show` says of a robot: its parts, its loops, its equations, and one of its states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from crosscheck.report.record_fields import Count, Index, Keywords, Number
from graphdyn import Coupling

Signs = Sequence[Sequence[Literal[-1, 0, 1]]]


@dataclass(frozen=True, kw_only=True)
class BodyPlacementDescription:
    """Placement of the link frame of a body in the world.

    name: of its link
    xyz: origin (3,) [m]
    rpy: roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3,) [degree]
    """

    name: str
    xyz: Sequence[float]
    rpy: Sequence[float]


@dataclass(frozen=True, kw_only=True)
class MassMotionDescription:
    """Center of mass and momentum of all moving bodies together, in world axes.

    center_of_mass: in the world (3,) [m]
    center_of_mass_velocity: (3,) [m/s]
    momentum: linear, then angular about the center of mass (6,) [kg m/s, kg m²/s]
    momentum_about_origin: linear, then angular about the world's origin (6,) [kg m/s, kg m²/s]
    """

    center_of_mass: Sequence[float]
    center_of_mass_velocity: Sequence[float]
    momentum: Sequence[float]
    momentum_about_origin: Sequence[float]


@dataclass(frozen=True, kw_only=True)
class FrameStateDescription:
    """Placement and motion of a named frame.

    name: of the frame, as given
    reference: point and axes of velocity and Jacobian, in Pinocchio's words
    xyz: origin in the world (3,) [m]
    rpy: roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3,) [degree]
    velocity: linear velocity, then angular velocity (6,) [m/s, rad/s]
    jacobian: J with velocity = J v (6, n) [m, 1 of revolute joints, 1, 0 of prismatic ones]
    """

    name: str
    reference: Literal["world", "local", "local_world_aligned"]
    xyz: Sequence[float]
    rpy: Sequence[float]
    velocity: Sequence[float]
    jacobian: Sequence[Sequence[float]]


@dataclass(frozen=True, kw_only=True)
class StateDescription:
    """The robot at one state.

    q: joint positions (n,) [rad or m]
    v: joint velocities (n,) [rad/s or m/s]
    kinetic_energy: [J]
    potential_energy: zero where the centers of mass are at the height of the world's origin [J]
    motion: of the whole robot; None where no body has mass
    gravity_torque: what holds the robot at rest; with loops, at the motors, and None where these are unknown or leave a
        motion free (n,) [N m or N]
    bias_torque: h in M a + h = τ; with loops as gravity_torque (n,) [N m or N]
    mass_matrix: M; of a robot with loops, of the tree, whose joints are free (n, n) [kg m², kg m, kg]
    mass_matrix_condition: 2-norm condition number of M in SI units; None where it is infinite
    bodies: where the link frames are
    frame: where a named frame is, and how it moves
    """

    q: Sequence[float]
    v: Sequence[float]
    kinetic_energy: float
    potential_energy: float
    motion: MassMotionDescription | None
    gravity_torque: Sequence[float] | None
    bias_torque: Sequence[float] | None
    mass_matrix: Sequence[Sequence[float]]
    mass_matrix_condition: Number
    bodies: Sequence[BodyPlacementDescription]
    frame: FrameStateDescription


@dataclass(frozen=True, kw_only=True)
class ChordDescription:
    """A connection that closes a loop.

    number: 1, 2, …
    name: of the chord
    kind: what it allows
    body_i: name of one body, or of the ground
    body_j: name of the other
    xyz_i: origin of the chord's frame in the link frame of body i (3,) [m]
    rpy_i: roll, pitch, yaw of the same, R = R_z(yaw) R_y(pitch) R_x(roll) (3,) [degree]
    xyz_j: origin of the chord's frame in the link frame of body j (3,) [m]
    rpy_j: roll, pitch, yaw of the same (3,) [degree]
    axis: unit axis p of a hinge or slide, in chord axes (3,)
    length: of a distance; None for the others [m]
    rows: what it transmits: a constraint row each, along its t1, t2, p on body i or along the line of a distance
    joints: names of the joints that form the loop with it
    """

    number: Index
    name: str
    kind: Literal["hinge", "ball", "slide", "weld", "distance"]
    body_i: str
    body_j: str
    xyz_i: Sequence[float]
    rpy_i: Sequence[float]
    xyz_j: Sequence[float]
    rpy_j: Sequence[float]
    axis: Sequence[float]
    length: Number
    rows: Sequence[str]
    joints: Sequence[str]


@dataclass(frozen=True, kw_only=True)
class ReactionDescription:
    """What one joint or chord transmits: from the inside body to its body, from body i to body j.

    name: of the joint or chord
    directions: such as force t1, along t_1, t_2, p of the joint or chord
    determined: the equations determine this component
    values: with the robot at rest, held by its motors against gravity; None where undetermined, and where motors are
        unknown or leave a motion free [N or N m]
    """

    name: str
    directions: Sequence[str]
    determined: Sequence[bool]
    values: Sequence[Number]


@dataclass(frozen=True, kw_only=True)
class LoopsDescription:
    """The loops of a robot at one closed pose.

    chords: what closes the loops
    incidence: columns for the chords beside the incidence S of the tree: row = body, column = chord; 1 body i, -1 body
        j
    actuated: names of the joints that have motors; None where that is not known
    q: the pose, closed: that of --state, or the robot's own (nv,) [rad or m]
    n_rows: constraint rows of joints, couplings and chords
    rank: how many of them are independent at this pose
    usual_rank: in a regular pose
    singular: more motions are free at this pose than in a regular one
    mobility: motions that keep all loops closed
    grubler_mobility: 6 bodies less the rows, after Grübler and Kutzbach
    undetermined: names of the reactions that the equations leave undetermined, such as "elbow force p"
    self_stresses: combinations of reactions that hold each other without any load, by name, relative to the largest
    reactions: of all joints, then of all chords
    reactions_missing: why the reactions have no values; None where they have
    """

    chords: Annotated[Sequence[ChordDescription], Keywords(minItems=1)]
    incidence: Signs
    actuated: Sequence[str] | None
    q: Sequence[float]
    n_rows: Count
    rank: Count
    usual_rank: Count
    singular: bool
    mobility: Count
    grubler_mobility: int
    undetermined: Sequence[str]
    self_stresses: Sequence[Mapping[str, float]]
    reactions: Sequence[ReactionDescription]
    reactions_missing: str | None


@dataclass(frozen=True, kw_only=True)
class BodyDescription:
    """A body, in its link axes.

    number: 1 … n
    name: of its link
    mass: [kg]
    center_of_mass: in the link frame (3,) [m]
    principal_moments: of the inertia tensor about the center of mass, ascending (3,) [kg m²]
    consistent: a real body can have these inertials
    problems: why not; empty where it can
    """

    number: Index
    name: str
    mass: Annotated[float, Keywords(minimum=0)]
    center_of_mass: Sequence[float]
    principal_moments: Sequence[float]
    consistent: bool
    problems: Sequence[str]


@dataclass(frozen=True, kw_only=True)
class JointDescription:
    """A joint.

    number: 1 … n
    name: of the joint
    kind: what it allows
    inside: name of the body it starts from
    body: name of the body it carries
    axis: unit axis, in joint axes (3,)
    xyz: origin of the joint frame in the link frame of the inside body (3,) [m]
    rpy: roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3,) [degree]
    lower: lower limit; None where there is none [rad or m]
    upper: upper limit; None where there is none [rad or m]
    velocity: velocity limit; None where there is none [rad/s or m/s]
    effort: effort limit; None where there is none [N m or N]
    damping: not part of the rigid dynamics [N m s/rad or N s/m]
    friction: not part of the rigid dynamics [N m or N]
    """

    number: Index
    name: str
    kind: Literal["revolute", "continuous", "prismatic"]
    inside: str
    body: str
    axis: Sequence[float]
    xyz: Sequence[float]
    rpy: Sequence[float]
    lower: Number
    upper: Number
    velocity: Number
    effort: Number
    damping: float
    friction: float


@dataclass(frozen=True, kw_only=True)
class FrameDescription:
    """A frame.

    name: of the frame
    aliases: further names of the same frame
    body: name of the body that holds it
    xyz: origin in the link frame of that body (3,) [m]
    rpy: roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3,) [degree]
    """

    name: str
    aliases: Sequence[str]
    body: str
    xyz: Sequence[float]
    rpy: Sequence[float]


@dataclass(frozen=True, kw_only=True)
class GraphDescription:
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


@dataclass(frozen=True, kw_only=True)
class SystemDescription:
    """The matrix [A φ_qᵀ; φ_q 0] of Eq. (111) at one random state.

    seed: seed of the state
    q: the state (n,) [rad or m]
    pattern: one string per row: 1 where an entry differs from zero by more than rounding, else 0
    rank: numerical rank; full: size. With loops it is less where rows depend on each other
    condition_number: 2-norm condition number in SI units; None where the matrix is singular
    size: rows and columns: 11n, one for each coupling, one for each row of a chord
    """

    seed: Count
    q: Sequence[float]
    pattern: Sequence[Annotated[str, Keywords(pattern="^[01]+$")]]
    rank: Count
    condition_number: Number
    size: Annotated[int, Keywords(minimum=11)]


@dataclass(frozen=True, kw_only=True)
class RobotDescription:
    """A robot of n bodies: its parts, its graph, and the pattern of its equations.

    robot: name or path as given
    locked: joints that were frozen, and where [rad or m]
    base: name of the ground, body 0
    base_xyz: origin of the ground frame in the world (3,) [m]
    base_rpy: roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3,) [degree]
    gravity: world axes (3,) [m/s²]
    total_mass: of the moving bodies [kg]
    bodies: bodies 1 … n, parents first
    joints: joints 1 … n; joint j carries body j
    couplings: joints that others drive; q, v, a and τ have entries for the other joints, in their order
    loops: None where the robot is a tree
    frames: named frames fixed in the bodies
    graph: its matrices
    system: the matrix of Eq. (111)
    state: what was asked for with --state; None where nothing was
    """

    robot: str
    locked: Mapping[str, float]
    base: str
    base_xyz: Sequence[float]
    base_rpy: Sequence[float]
    gravity: Sequence[float]
    total_mass: Annotated[float, Keywords(minimum=0)]
    bodies: Annotated[Sequence[BodyDescription], Keywords(minItems=1)]
    joints: Annotated[Sequence[JointDescription], Keywords(minItems=1)]
    couplings: Sequence[Coupling]
    loops: LoopsDescription | None = None
    frames: Sequence[FrameDescription]
    graph: GraphDescription
    system: SystemDescription
    state: StateDescription | None = None
