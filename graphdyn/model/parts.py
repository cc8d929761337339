"""What a robot is made of: bodies, joints and frames. They never change."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from numbers import Integral, Real
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.display import short_repr
from graphdyn.errors import InvalidModel
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import inertia_from_parameters, parameters_from_inertia
from graphdyn.model.spatial import Placement, cross, skew, turned

JointKind = Literal["revolute", "continuous", "prismatic"]

JOINT_KINDS: tuple[JointKind, ...] = ("revolute", "continuous", "prismatic")

SYMMETRY_TOLERANCE = 1e-9
"""Largest |J - Jᵀ| relative to the largest entry that counts as rounding (and is symmetrized)."""

AXIS_TIE_TOLERANCE = 1e-9
"""Two coordinate axes are equally far from p if their components differ by less than this; the first is taken."""


@dataclass(frozen=True, eq=False)
@short_repr
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
        freeze(self, who, mass=(), center_of_mass=(3,), inertia=(3, 3))
        if self.mass < 0:
            raise InvalidModel(f"{who}: mass {self.mass} kg is negative")
        asymmetry = np.abs(self.inertia - self.inertia.T).max()
        if asymmetry > SYMMETRY_TOLERANCE * np.abs(self.inertia).max():
            raise InvalidModel(f"{who}: inertia tensor is not symmetric (largest difference {asymmetry:.3g} kg m²)")
        object.__setattr__(self, "inertia", read_only((self.inertia + self.inertia.T) / 2))

    @property
    def parameters(self) -> Array:
        """(10,): m, m c, and I_xx, I_xy, I_yy, I_xz, I_yz, I_zz about the link origin, in link axes."""
        return parameters_from_inertia(self.mass, self.center_of_mass, self.inertia)

    @classmethod
    def from_parameters(cls, name: str, parameters: ArrayLike) -> Body:
        """The body with these ten inertial parameters. Raises InvalidModel where m = 0 but m c ≠ 0."""
        pi = as_floats(f"body '{name}'", "parameter vector", parameters, (BODY_PARAMETERS,))
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
@short_repr
class Joint:
    """A joint with one degree of freedom between body i(j) and body j.

    kind: "revolute", "continuous" (revolute without position limits) or "prismatic"
    inside: number of the inside body, 0 for the ground
    placement: the joint frame in the link frame of the inside body
    axis: p, in joint axes, normalized at construction      (3,)
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
        check_type(who, "inside", self.inside, Integral)
        freeze(self, who, axis=(3,), damping=(), friction=())
        check_type(who, "placement", self.placement, Placement)
        check_type(who, "limits", self.limits, JointLimits)
        for name, value in dataclasses.asdict(self.limits).items():
            if value is not None and not np.isfinite(value):
                raise InvalidModel(f"{who}: {name} limit is {value}; leave it out (None) where there is none")
        lower, upper = self.limits.lower, self.limits.upper
        if lower is not None and upper is not None and lower > upper:
            raise InvalidModel(f"{who}: lower limit {lower} is above upper limit {upper}; swap them")
        object.__setattr__(self, "axis", unit_axis(who, self.axis))

    @property
    def is_prismatic(self) -> bool:
        """The joint slides along its axis; the others turn about it."""
        return self.kind == "prismatic"

    @cached_property
    def axis_normals(self) -> Array:
        """t_1, t_2 (2, 3) in joint axes: normal to p, t_1 × t_2 = p, fixed in the inside body.

        They replace the world x and y rows of Eq. (71)-(73), which are dependent for a horizontal axis
        (docs/deviations.md, A2).
        """
        return axis_normals(self.axis)

    def turn(self, angle: Array) -> Array:
        """The rotation by an angle (…) [rad] about the axis (…, 3, 3), in joint axes."""
        return turned(angle, *self._turning)

    @cached_property
    def _turning(self) -> tuple[Array, Array]:
        return skew(self.axis), np.outer(self.axis, self.axis)


@dataclass(frozen=True, eq=False)
@short_repr
class Frame:
    """A named frame fixed in a body (a tool flange, a link fused into its parent); body 0 is the ground.

    aliases: further names of the same frame (the fixed joint that carried it)
    """

    name: str
    body: int
    placement: Placement
    aliases: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_type(f"frame '{self.name}'", "body", self.body, Integral)
        check_type(f"frame '{self.name}'", "placement", self.placement, Placement)


def check_type(who: str, name: str, value: object, kind: type) -> None:
    if not isinstance(value, kind):
        raise InvalidModel(f"{who}: {name} is of type {type(value).__name__}, not {kind.__name__}")


def freeze(owner: object, who: str, **shapes: tuple[int, ...]) -> None:
    """Convert the named fields to floats or read-only arrays; refuse wrong shapes, NaN and infinity by name."""
    for name, shape in shapes.items():
        value = as_floats(who, name, getattr(owner, name), shape)
        object.__setattr__(owner, name, float(value) if shape == () else read_only(value))


def as_floats(who: str, name: str, value: ArrayLike, shape: tuple[int, ...]) -> Array:
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


def read_only(array: Array) -> Array:
    array.setflags(write=False)
    return array


def unit_axis(who: str, axis: Array) -> Array:
    """The direction of an axis. Raises InvalidModel for a zero."""
    if not axis.any():
        raise InvalidModel(f"{who}: axis is zero; give a direction")
    _, exponent = np.frexp(np.abs(axis).max())
    axis = np.ldexp(axis, -exponent)  # exact; keeps the squares of a tiny axis from underflowing
    return read_only(axis / np.linalg.norm(axis))


def axis_normals(axis: Array) -> Array:
    """t_1, t_2 (2, 3) normal to a unit axis p, with t_1 × t_2 = p.

    t_1 is the normalized p × e with e the coordinate axis least aligned with p, t_2 = p × t_1.
    """
    alignment = np.abs(axis)
    least = int(np.argmax(alignment <= alignment.min() + AXIS_TIE_TOLERANCE))
    t_1 = cross(axis, np.eye(3)[least])
    t_1 /= np.linalg.norm(t_1)
    return read_only(np.stack([t_1, cross(axis, t_1)]))
