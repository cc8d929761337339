"""A robot with all that acts on it: what stays the same during a simulation.

Beside the commanded torque, friction, springs at the limits and limits of the torque act at the joints. Signs are those
of the identification: τ = (rigid bodies) + I_a a + F_v v + F_c sign(v) + offset.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.experiments.experiment import BaseMotionLaw
from graphdyn.layout import BODY_DOF, BODY_PARAMETERS, Array
from graphdyn.model.robot_model import RobotModel, check_model


@dataclass(frozen=True, eq=False)
@short_repr
class Friction:
    """F_v v + F_c sign(v) + offset per joint; at rest, dry friction holds the joint up to F_c, and it does not creep.

    viscous: F_v ≥ 0                                        () or (…, n)  [N m s/rad or N s/m]
    coulomb: F_c ≥ 0                                        () or (…, n)  [N m or N]
    offset: of the measured torque                          () or (…, n)  [N m or N]

    Raises InvalidInput for negative or non-finite numbers.
    """

    viscous: ArrayLike = 0.0
    coulomb: ArrayLike = 0.0
    offset: ArrayLike = 0.0

    def __post_init__(self) -> None:
        for name in ("viscous", "coulomb"):
            object.__setattr__(self, name, nonnegative(f"{name} friction", getattr(self, name)))
        object.__setattr__(self, "offset", finite("offset", self.offset))

    @classmethod
    def of_model(cls, model: RobotModel) -> Friction:
        """The damping and friction that the joints of the model carry, as a URDF file states them.

        Those of a joint that another drives act at that other, through the ratio. Raises InvalidInput where several
        joints drive it: its friction is none of single joints then.
        """
        ratios = np.abs(model.degrees_of_freedom.matrix)
        viscous, coulomb = np.array([[joint.damping, joint.friction] for joint in model.joints]).T
        for j in np.flatnonzero((np.count_nonzero(ratios, axis=1) > 1) & ((viscous != 0) | (coulomb != 0))).tolist():
            raise InvalidInput(
                f"joint '{model.joint_names[j]}' has friction, and several joints drive it: which of them it holds "
                "is not decided; state friction by Friction(…)"
            )
        return cls(viscous @ ratios**2, coulomb @ ratios)

    @classmethod
    def identified(cls, model: RobotModel, parameters: Mapping[str, float]) -> Friction:
        """Friction from identified parameters by symbol: FV_j, FC_j and OFF_j of joint j; other symbols are passed
        over."""
        numbers = [k + 1 for k in model.degrees_of_freedom.independent]
        return cls(*([parameters.get(f"{symbol}_{j}", 0.0) for j in numbers] for symbol in ("FV", "FC", "OFF")))


@dataclass(frozen=True, eq=False)
@short_repr
class JointStops:
    """A spring and a damper beyond the position limits of the joints; they push, and never pull.

    stiffness                                               () or (n,)  [N m/rad or N/m]
    damping                                                 () or (n,)  [N m s/rad or N s/m]

    Joints without limits have none, nor have joints that others drive.

    Raises InvalidInput for negative or non-finite numbers.
    """

    stiffness: ArrayLike
    damping: ArrayLike = 0.0

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping"):
            object.__setattr__(self, name, nonnegative(f"{name} of the stops", getattr(self, name)))


@dataclass(frozen=True, eq=False)
@short_repr
class Bristles:
    """Dry friction as torque of bristles (LuGre): presliding, Stribeck curve, breakaway that depends on the rate.

        dz/dt = v - σ₀ |v| z / g(v),   torque σ₀ z + σ₁ dz/dt,   g = F_c + (F_s - F_c) / (1 + (v / v_s)²)

    coulomb, breakaway: F_c and F_s, both above zero        () or (n,)  [N m or N]
    velocity: v_s, at which half of F_s - F_c is left       () or (n,)  [rad/s or m/s]
    stiffness: σ₀; stiff bristles leave the curve g alone   () or (n,)  [N m/rad or N/m]
    damping: σ₁                                             () or (n,)  [N m s/rad or N s/m]

    Canudas de Wit, Olsson, Åström and Lischinsky, IEEE Trans. Automatic Control 40(3), 1995; g of Hess and Soom,
    Journal of Tribology 112(1), 1990. Raises InvalidInput for numbers that are not above zero, damping aside.
    """

    coulomb: ArrayLike
    breakaway: ArrayLike
    velocity: ArrayLike
    stiffness: ArrayLike
    damping: ArrayLike = 0.0

    def __post_init__(self) -> None:
        for name in vars(self):
            value = nonnegative(f"{name} of the bristles", getattr(self, name))
            if name != "damping" and not np.all(value > 0):
                raise InvalidInput(f"{name} of the bristles is zero; give numbers above zero")
            object.__setattr__(self, name, value)


def refuse_loops(what: str, model: RobotModel, remedy: str) -> None:
    """Raises InvalidInput for a robot with loops."""
    if model.chords:
        raise InvalidInput(f"{what} does not know the loops of robot '{model.name}'; {remedy}")


def position_limits(model: RobotModel) -> tuple[Array, Array]:
    """Lower and upper limits of all joints (n_bodies,), infinite where there is none."""
    of = [joint.limits for joint in model.joints]
    lower = [-np.inf if x.lower is None else x.lower for x in of]
    upper = [np.inf if x.upper is None else x.upper for x in of]
    return np.array(lower), np.array(upper)


def effort_limits(model: RobotModel) -> Array:
    """Largest torques that the model states (n,), infinite where it states none, or zero."""
    return np.array([model.joints[k].limits.effort or np.inf for k in model.degrees_of_freedom.independent])


def finite(name: str, value: ArrayLike) -> Array:
    """A float array. Raises InvalidInput, naming the argument, for NaN and infinity."""
    array = as_floats(name, value)
    if not np.all(np.isfinite(array)):
        raise InvalidInput(f"{name} contains NaN or infinity")
    return array


def nonnegative(name: str, value: ArrayLike) -> Array:
    """The same of numbers of which none is below zero."""
    array = finite(name, value)
    if np.any(array < 0):
        raise InvalidInput(f"{name} is negative ({array.min():g}); give zero or more")
    return array


def per_joint(name: str, value: ArrayLike, model: RobotModel, runs: int | None = None) -> Array:
    """One number for all joints, or one per joint, as (n,); with runs as (runs, n). Raises InvalidInput."""
    shape = (model.nv,) if runs is None else (runs, model.nv)
    expected = f"() or ({model.nv},)" + ("" if runs is None else f" or {shape}")
    return _of_shape(name, value, shape, f"{expected} for the {model.nv} joints of robot '{model.name}'")


def _of_shape(name: str, value: ArrayLike, shape: tuple[int, ...], expected: str) -> Array:
    array = as_floats(name, value)
    try:
        return np.broadcast_to(array, shape)
    except ValueError:
        raise InvalidInput(f"{name} has shape {array.shape}, expected {expected}") from None


Wrenches = Callable[[float, Array, Array], ArrayLike]
"""external_wrenches as a function of t, q and v."""


@dataclass(frozen=True, eq=False)
class PlantConstants:
    """The constants of one run, or of several at once.

    constants: by name (…, width), those that are there: viscous, coulomb, offset; least_torque, largest_torque; lower,
        upper, stiffness, damping; bristle_… of Bristles; resolution of the positions that a controller sees; rotor;
        external_wrenches (6 n); parameters (10 n)
    base: laws of the moving base
    wrenches: external wrenches that are a function
    """

    model: RobotModel
    constants: dict[str, Array]
    base: tuple[BaseMotionLaw, ...] = ()
    wrenches: Wrenches | None = None

    @property
    def has_friction(self) -> bool:
        return "viscous" in self.constants

    @property
    def sticks(self) -> bool:
        """Whether there is dry friction, which holds joints."""
        return self.has_friction and bool(np.any(self.constants["coulomb"] > 0))

    @property
    def has_stops(self) -> bool:
        return "stiffness" in self.constants

    @property
    def has_bristles(self) -> bool:
        return "bristle_stiffness" in self.constants

    @property
    def is_rounded(self) -> bool:
        """Whether the controller sees rounded positions."""
        return "resolution" in self.constants

    @property
    def is_clamped(self) -> bool:
        return "least_torque" in self.constants

    @property
    def is_loaded(self) -> bool:
        """Whether external wrenches act."""
        return self.wrenches is not None or "external_wrenches" in self.constants

    @property
    def rotor(self) -> Array:
        """I_a (…, n), zero where there is none."""
        return self.constants.get("rotor", np.zeros(self.model.nv))

    def of_run(self, run: int) -> PlantConstants:
        """One of several runs, with its inertial parameters in the model."""
        constants = {name: array[run] for name, array in self.constants.items() if name != "parameters"}
        model = self.model
        if "parameters" in self.constants:
            model = model.with_inertial_parameters(self.constants["parameters"][run])
        return PlantConstants(model, constants, self.base, self.wrenches)


def make_plant(
    model: RobotModel,
    *,
    runs: int | None = None,
    friction: Friction | Literal["model"] | None = None,
    rotor_inertia: ArrayLike | None = None,
    limits: JointStops | Literal["stop"] | None = None,
    bristles: Bristles | None = None,
    resolution: ArrayLike = 0.0,
    torque_limits: ArrayLike | Literal["model"] | None = None,
    external_wrenches: ArrayLike | Wrenches | None = None,
    parameters: ArrayLike | None = None,
    base: BaseMotionLaw | Sequence[BaseMotionLaw] = (),
) -> PlantConstants:
    """The arguments of simulate and rollout, checked. Raises InvalidInput."""
    check_model(model)
    constants: dict[str, Array] = {}
    if isinstance(friction, str):
        if friction != "model":
            raise InvalidInput(f"friction is '{friction}'; give a Friction, 'model' for that of the file, or None")
        friction = Friction.of_model(model)
    if friction is not None:
        for name, value in vars(friction).items():
            constants[name] = per_joint(name, value, model, runs)
    if rotor_inertia is not None:
        constants["rotor"] = per_joint("rotor_inertia", finite("rotor_inertia", rotor_inertia), model, runs)
        if np.any(constants["rotor"] < 0):
            raise InvalidInput("rotor_inertia is negative; give zero or more")
    if isinstance(limits, JointStops):
        lower, upper = (side[list(model.degrees_of_freedom.independent)] for side in position_limits(model))
        for name, value in {"lower": lower, "upper": upper, **vars(limits)}.items():
            constants[name] = per_joint(name, value, model, runs)
    elif limits not in (None, "stop"):
        raise InvalidInput(f"limits is {limits!r}; give 'stop', a JointStops, or None")
    if bristles is not None:
        for name, value in vars(bristles).items():
            constants[f"bristle_{name}"] = per_joint(f"{name} of the bristles", value, model, runs)
    if np.any(nonnegative("resolution", resolution) > 0):
        constants["resolution"] = per_joint("resolution", resolution, model, runs)
    if torque_limits is not None:
        if isinstance(torque_limits, str):
            if torque_limits != "model":
                raise InvalidInput(f"torque_limits is '{torque_limits}'; give numbers, 'model', or None")
            torque_limits = effort_limits(model)
        largest = per_joint("torque_limits", torque_limits, model, runs)
        if not np.all(largest >= 0):
            raise InvalidInput("torque_limits are largest magnitudes; give zero or more")
        constants["largest_torque"], constants["least_torque"] = largest, -largest
    wrenches: Wrenches | None = None
    if callable(external_wrenches):
        wrenches = external_wrenches
    elif external_wrenches is not None:
        shape = (*(() if runs is None else (runs,)), model.n_bodies, BODY_DOF)
        given = finite("external_wrenches", external_wrenches)
        constants["external_wrenches"] = _of_shape("external_wrenches", given, shape, f"{shape}").reshape(
            *shape[:-2], -1
        )
    if parameters is not None:
        width = BODY_PARAMETERS * model.n_bodies
        shape = (width,) if runs is None else (runs, width)
        given = finite("parameters", parameters)
        constants["parameters"] = _of_shape("parameters", given, shape, f"({width},) or {shape}")
    return PlantConstants(model, constants, (base,) if isinstance(base, BaseMotionLaw) else tuple(base), wrenches)
