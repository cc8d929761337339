"""The description of a robot: bodies, joints, gravity. It never changes; states and results are other objects."""

from __future__ import annotations

import dataclasses
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Integral, Real
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from graphdyn._coupling import Coupling, Freedoms, freedoms
from graphdyn._errors import InvalidInput, InvalidModel, UnknownFrame
from graphdyn._graph import Graph
from graphdyn._inertia import (
    Consistency,
    consistency_problems,
    inertia_from_parameters,
    parameters_from_inertia,
    pseudo_inertia,
)
from graphdyn._placement import Placement
from graphdyn.layout import BODY_PARAMETERS, Array, parameter_columns

JointKind = Literal["revolute", "continuous", "prismatic"]
JOINT_KINDS: tuple[JointKind, ...] = ("revolute", "continuous", "prismatic")

STANDARD_GRAVITY = (0.0, 0.0, -9.81)
"""Gravity of a model unless told otherwise [m/s²]: the value Pinocchio and most URDF tools use."""

ANGLE_RANGE = np.pi
SLIDE_RANGE = 0.5
"""Ranges that random_state takes where limits are zero or missing: ±π rad, ±π rad/s; prismatic ±0.5 m, ±0.5 m/s."""

ABSURD = 1e6
"""A limit beyond this [rad, m, …/s] is treated as no limit by random_state."""

SYMMETRY = 1e-9
"""Largest |J - Jᵀ| relative to the largest entry that counts as rounding (and is symmetrised)."""

TIE = 1e-9
"""Two coordinate axes are equally far from p if their components differ by less than this; the first is taken."""


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body, in the axes of its link frame (origin at its inside joint).

    mass: m ≥ 0                                             [kg]
    center_of_mass: c, in the link frame                    (3,)    [m]
    inertia: J about the center of mass, in link axes       (3, 3)  [kg m²]

    Raises InvalidModel for a negative mass, an asymmetric tensor, NaN or infinity. A tensor that no real body can
    have is kept (vendor files have them) and reported by RobotModel.physical_consistency.
    """

    name: str
    mass: float
    center_of_mass: Array
    inertia: Array

    def __post_init__(self) -> None:
        who = f"body '{self.name}'"
        _freeze(self, who, mass=(), center_of_mass=(3,), inertia=(3, 3))
        if self.mass < 0:
            raise InvalidModel(f"{who}: mass {self.mass} kg is negative")
        asymmetry = np.abs(self.inertia - self.inertia.T).max()
        if asymmetry > SYMMETRY * np.abs(self.inertia).max():
            raise InvalidModel(f"{who}: inertia tensor is not symmetric (largest difference {asymmetry:.3g} kg m²)")
        object.__setattr__(self, "inertia", _read_only((self.inertia + self.inertia.T) / 2))

    @property
    def parameters(self) -> Array:
        """(10,): m, m c, and I_xx, I_xy, I_yy, I_xz, I_yz, I_zz about the link origin, in link axes."""
        return parameters_from_inertia(self.mass, self.center_of_mass, self.inertia)

    @classmethod
    def from_parameters(cls, name: str, parameters: ArrayLike) -> Body:
        """The body with these ten inertial parameters. Raises InvalidModel where m = 0 but m c ≠ 0."""
        pi = _as_floats(f"body '{name}'", "parameter vector", parameters, (BODY_PARAMETERS,))
        if pi[0] == 0 and np.any(pi[1:4] != 0):
            raise InvalidModel(f"body '{name}': mass is 0 but the first moment is {pi[1:4].tolist()} kg m")
        return cls(name, *inertia_from_parameters(pi))


@dataclass(frozen=True)
class JointLimits:
    """Limits of a joint; None where the source states none. [rad or m, rad/s or m/s, N m or N]"""

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None

    def __post_init__(self) -> None:
        for name, value in dataclasses.asdict(self).items():
            if value is not None and not isinstance(value, Real):
                raise InvalidModel(f"{name} limit is {value!r}; give a number, or None where there is none")


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint with one freedom between body i(j) and body j.

    kind: "revolute", "continuous" (revolute without position limits) or "prismatic"
    inside: number of the inside body, 0 for the ground
    placement: the joint frame in the link frame of the inside body
    axis: p, in joint axes, normalised at construction      (3,)
    limits, damping, friction: kept, not part of the rigid dynamics; damping [N m s/rad or N s/m], friction [N m or N]

    At q = 0 the link frame of body j coincides with the joint frame.
    """

    name: str
    kind: JointKind
    inside: int
    placement: Placement
    axis: Array
    limits: JointLimits = JointLimits()
    damping: float = 0.0
    friction: float = 0.0

    def __post_init__(self) -> None:
        who = f"joint '{self.name}'"
        if self.kind not in JOINT_KINDS:
            raise InvalidModel(f"{who}: kind '{self.kind}' cannot be represented; use one of {', '.join(JOINT_KINDS)}")
        _check_type(who, "inside", self.inside, Integral)
        _freeze(self, who, axis=(3,), damping=(), friction=())
        _check_type(who, "placement", self.placement, Placement)
        _check_type(who, "limits", self.limits, JointLimits)
        for name, value in dataclasses.asdict(self.limits).items():
            if value is not None and not np.isfinite(value):
                raise InvalidModel(f"{who}: {name} limit is {value}; leave it out (None) where there is none")
        lower, upper = self.limits.lower, self.limits.upper
        if lower is not None and upper is not None and lower > upper:
            raise InvalidModel(f"{who}: lower limit {lower} is above upper limit {upper}; swap them")
        if not self.axis.any():
            raise InvalidModel(f"{who}: axis is zero; give a direction")
        _, exponent = np.frexp(np.abs(self.axis).max())
        axis = np.ldexp(self.axis, -exponent)  # exact; keeps the squares of a tiny axis from underflowing
        object.__setattr__(self, "axis", _read_only(axis / np.linalg.norm(axis)))

    @property
    def is_prismatic(self) -> bool:
        """The joint slides along its axis; the others turn about it."""
        return self.kind == "prismatic"

    @cached_property
    def axis_normals(self) -> Array:
        """t_1, t_2 (2, 3) in joint axes: normal to p, t_1 × t_2 = p, fixed in the inside body.

        t_1 is the normalised p × e with e the coordinate axis least aligned with p, t_2 = p × t_1. They replace the
        world x and y rows of Eq. (71)-(73), which are dependent for a horizontal axis (docs/deviations.md, A2).
        """
        alignment = np.abs(self.axis)
        least = int(np.argmax(alignment <= alignment.min() + TIE))
        t_1 = np.cross(self.axis, np.eye(3)[least])
        t_1 /= np.linalg.norm(t_1)
        return _read_only(np.stack([t_1, np.cross(self.axis, t_1)]))


@dataclass(frozen=True, eq=False)
class Frame:
    """A named frame fixed in a body (a tool flange, a link fused into its parent); body 0 is the ground.

    aliases: further names of the same frame (the fixed joint that carried it)
    """

    name: str
    body: int
    placement: Placement
    aliases: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check_type(f"frame '{self.name}'", "body", self.body, Integral)
        _check_type(f"frame '{self.name}'", "placement", self.placement, Placement)


@dataclass(frozen=True, eq=False)
class RobotModel:
    """A tree of n rigid bodies on n joints of one freedom each, some of which others may drive.

    bodies, joints: in regular labelling, parents first; joints[j-1] is the inside joint of bodies[j-1]
    gravity: in world axes                                  (3,)  [m/s²]
    base: the ground frame (body 0) in the world
    base_name: name of the ground frame (the root link of a URDF)
    frames: named frames fixed in the bodies
    couplings: joints that others drive, in any order; joint states q, v, a and tau have entries for the others only

    Raises InvalidModel, naming the body or joint, for duplicate names, joints out of order, non-finite numbers, and
    couplings that name unknown joints, drive one twice or in a circle.
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    gravity: Array = field(default_factory=lambda: np.array(STANDARD_GRAVITY))
    base: Placement = field(default_factory=Placement)
    base_name: str = "base"
    frames: tuple[Frame, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    freedoms: Freedoms = field(init=False, repr=False)

    def __post_init__(self) -> None:
        who = f"robot '{self.name}'"
        for name in ("bodies", "joints", "frames", "couplings"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        _freeze(self, who, gravity=(3,))
        _check_type(who, "base", self.base, Placement)
        if not self.bodies:
            raise InvalidModel(f"{who}: no moving body; the dynamics of a model without joints are empty")
        if len(self.bodies) != len(self.joints):
            raise InvalidModel(f"{who}: {len(self.bodies)} bodies but {len(self.joints)} joints; a tree has one each")
        bodies = [self.base_name, *(body.name for body in self.bodies)]
        frames = [name for frame in self.frames for name in (frame.name, *frame.aliases)]
        joints = [joint.name for joint in self.joints]
        for what, names in (("body", bodies), ("joint", joints), ("frame", bodies + frames)):
            repeated = [name for name in names if names.count(name) > 1]
            if repeated:
                raise InvalidModel(f"{who}: {what} name '{repeated[0]}' is used more than once")
        for j, joint in enumerate(self.joints, start=1):
            if not 0 <= joint.inside < j:
                raise InvalidModel(
                    f"joint '{joint.name}': inside body {joint.inside} does not come before body {j}; "
                    "list parents first (0 is the ground)"
                )
        for frame in self.frames:
            if not 0 <= frame.body <= self.n_bodies:
                raise InvalidModel(f"frame '{frame.name}': there is no body {frame.body}")
        object.__setattr__(self, "freedoms", freedoms(who, joints, self.couplings))

    @property
    def n_bodies(self) -> int:
        """n, the number of moving bodies and of joints."""
        return len(self.bodies)

    @property
    def n_freedoms(self) -> int:
        """The number of joints that no others drive: n, where there are no couplings."""
        return len(self.freedoms.independent)

    @property
    def independent_joints(self) -> tuple[str, ...]:
        """Names of the joints that no others drive: the order of q, v, a and τ."""
        return tuple(self.joints[k].name for k in self.freedoms.independent)

    def joint_positions(self, q: ArrayLike) -> Array:
        """Of all joints (…, n) [rad or m], from those of the independent ones (…, n_freedoms)."""
        return np.asarray(q) @ self.freedoms.matrix.T + self.freedoms.offset

    @property
    def body_names(self) -> tuple[str, ...]:
        """In the order of the bodies."""
        return tuple(body.name for body in self.bodies)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """In the order of the joints."""
        return tuple(joint.name for joint in self.joints)

    @cached_property
    def graph(self) -> Graph:
        """Bodies as vertices, joints as edges."""
        return Graph(tuple(joint.inside for joint in self.joints))

    def frame(self, name: str) -> Frame:
        """The frame of this name: a body, the ground, a fused link or the fixed joint that carried it.

        Raises UnknownFrame with the known names.
        """
        own = [Frame(self.base_name, 0, Placement())]
        own += [Frame(body.name, i, Placement()) for i, body in enumerate(self.bodies, start=1)]
        candidates = [*own, *self.frames]
        for frame in candidates:
            if frame.name == name:
                return frame
        for frame in candidates:
            if name in frame.aliases:
                return frame
        raise UnknownFrame(f"robot '{self.name}' has no frame '{name}'; known: {', '.join(f.name for f in candidates)}")

    def body_joint_vectors(self) -> Array:
        """C (n, n, 3): S_ij c_ij, c_ij from the center of mass of body i to joint j, in axes of body i. Eq. (11) [m].

        A prismatic joint is taken at q = 0: its force acts along the axis, through the same line at every q. The joint
        force elements act at the joints: the paper's C^e of Eq. (17)-(18) is C.
        """
        c = np.zeros((self.n_bodies, self.n_bodies, 3))
        for j, joint in enumerate(self.joints, start=1):
            c[j - 1, j - 1] = self.bodies[j - 1].center_of_mass  # S_jj c_jj = -1 · (-c)
            if joint.inside > 0:
                c[joint.inside - 1, j - 1] = joint.placement.translation - self.bodies[joint.inside - 1].center_of_mass
        return c

    @cached_property
    def inertial_parameters(self) -> Array:
        """(10 n,): the parameters of all bodies (Body.parameters), body after body."""
        return _read_only(np.concatenate([body.parameters for body in self.bodies]))

    @cached_property
    def skeleton(self) -> RobotModel:
        """The rooted robot with massless bodies whose centers of mass are their link origins.

        Its maximal states are the motions of the link frames, free of any inertial parameter.
        """
        bodies = tuple(Body(body.name, 0.0, np.zeros(3), np.zeros((3, 3))) for body in self.bodies)
        return dataclasses.replace(self.rooted, bodies=bodies)

    @cached_property
    def rooted(self) -> RobotModel:
        """The same robot shifted so that joint 1 is at the world's origin.

        The dynamics do not depend on where in the world it stands; their rounding errors would, through differences of
        large positions.
        """
        shift = self.base.rotation @ self.joints[0].placement.translation
        return dataclasses.replace(self, base=Placement(self.base.rotation, -shift))

    @cached_property
    def uncoupled(self) -> RobotModel:
        """The same robot without couplings: every joint is free. Itself where it has none."""
        return dataclasses.replace(self, couplings=()) if self.couplings else self

    def with_inertial_parameters(self, parameters: ArrayLike) -> RobotModel:
        """The same robot with other inertial parameters (10 n,). Raises InvalidModel for a wrong length."""
        pi = _as_floats(f"robot '{self.name}'", "parameter vector", parameters, (BODY_PARAMETERS * self.n_bodies,))
        bodies = [
            Body.from_parameters(body.name, pi[parameter_columns(i)]) for i, body in enumerate(self.bodies, start=1)
        ]
        return dataclasses.replace(self, bodies=tuple(bodies))

    def with_gravity(self, gravity: ArrayLike) -> RobotModel:
        """The same robot under another gravity vector (3,) [m/s²], world axes."""
        return dataclasses.replace(self, gravity=np.asarray(gravity))

    def with_base(self, base: Placement) -> RobotModel:
        """The same robot mounted with its ground frame at another placement in the world."""
        return dataclasses.replace(self, base=base)

    def random_state(self, rng: np.random.Generator, size: int | Sequence[int] = ()) -> tuple[Array, Array]:
        """q, v (size, n_freedoms), uniform within limits, or default ranges where these are zero, missing or absurd.

        Continuous joints are drawn from [-π, π] rad. The default ranges are ±π rad, ±π rad/s, ±0.5 m and ±0.5 m/s;
        a limit beyond 1e6 is absurd. Limits of joints that others drive are not looked at.
        """
        shape = (size,) if isinstance(size, Integral) else tuple(size)  # type: ignore[arg-type]
        ranges = [_sampling_range(self.joints[k]) for k in self.freedoms.independent]
        lower, upper, speed = (np.array(values) for values in zip(*ranges, strict=True))
        q = rng.uniform(lower, upper, (*shape, self.n_freedoms))
        v = rng.uniform(-speed, speed, (*shape, self.n_freedoms))
        return q, v

    def physical_consistency(self) -> tuple[Consistency, ...]:
        """Per body: whether a real body can have these inertials, and if not why. Reports; refuses nothing."""
        return tuple(
            Consistency(
                body.name,
                float(np.linalg.eigvalsh(pseudo_inertia(body.mass, body.center_of_mass, body.inertia))[0]),
                consistency_problems(body.mass, body.inertia),
            )
            for body in self.bodies
        )


def check_model(model: object) -> None:
    """Raise InvalidInput for anything but a RobotModel, such as the name of a robot."""
    if not isinstance(model, RobotModel):
        raise InvalidInput(
            f"the model is {reprlib.repr(model)}, of type {type(model).__name__}; give a RobotModel, into which a "
            "robot's name or file is loaded first"
        )


def total_mass(model: RobotModel) -> float:
    """Σ m [kg]. Raises InvalidInput for a robot without any mass, which has no center of mass."""
    mass = float(sum(body.mass for body in model.bodies))
    if mass == 0:
        raise InvalidInput(
            f"robot '{model.name}' has no center of mass: the masses of its bodies add up to zero; "
            "see physical_consistency()"
        )
    return mass


def _sampling_range(joint: Joint) -> tuple[float, float, float]:
    """lower, upper and speed of random_state."""
    reach = SLIDE_RANGE if joint.is_prismatic else ANGLE_RANGE
    lower, upper, speed = (
        None if limit is None or abs(limit) > ABSURD else limit
        for limit in (joint.limits.lower, joint.limits.upper, joint.limits.velocity)
    )
    speed = abs(speed or 0.0) or reach
    if joint.kind == "continuous" or not (lower or upper):  # both zero or missing
        return -reach, reach, speed
    if lower is None:
        assert upper is not None  # one of them is given
        return upper - 2 * reach, upper, speed
    return lower, lower + 2 * reach if upper is None else upper, speed


def _check_type(who: str, name: str, value: object, kind: type) -> None:
    if not isinstance(value, kind):
        raise InvalidModel(f"{who}: {name} is of type {type(value).__name__}, not {kind.__name__}")


def _freeze(owner: object, who: str, **shapes: tuple[int, ...]) -> None:
    """Convert the named fields to floats or read-only arrays; refuse wrong shapes, NaN and infinity by name."""
    for name, shape in shapes.items():
        value = _as_floats(who, name, getattr(owner, name), shape)
        object.__setattr__(owner, name, float(value) if shape == () else _read_only(value))


def _as_floats(who: str, name: str, value: ArrayLike, shape: tuple[int, ...]) -> Array:
    """A fresh float array of this shape; anything else is refused by name."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InvalidModel(f"{who}: {name} is not numeric: {value!r}") from error
    if array.shape != shape:
        raise InvalidModel(f"{who}: {name} has shape {array.shape}, expected {shape}")
    if not np.all(np.isfinite(array)):
        raise InvalidModel(f"{who}: {name} contains NaN or infinity: {array.tolist()}")
    return array


def _read_only(array: Array) -> Array:
    array.setflags(write=False)
    return array
