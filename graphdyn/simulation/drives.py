"""What acts at the joints beside the commanded torque: friction, springs at the limits, limits of the torque.

Signs are those of the identification: τ = (rigid bodies) + I_a a + F_v v + F_c sign(v) + offset.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel


@dataclass(frozen=True, eq=False)
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
        for name in ("viscous", "coulomb", "offset"):
            array = finite(f"{name} friction" if name != "offset" else "offset", getattr(self, name))
            if name != "offset" and np.any(array < 0):
                raise InvalidInput(f"{name} friction is negative ({array.min():g}); give zero or more")
            object.__setattr__(self, name, array)

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
            array = finite(f"{name} of the stops", getattr(self, name))
            if np.any(array < 0):
                raise InvalidInput(f"{name} of the stops is negative ({array.min():g}); give zero or more")
            object.__setattr__(self, name, array)


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


def per_joint(name: str, value: ArrayLike, model: RobotModel, runs: int | None = None) -> Array:
    """One number for all joints, or one per joint, as (n,); with runs as (runs, n). Raises InvalidInput."""
    array = as_floats(name, value)
    shape = (model.nv,) if runs is None else (runs, model.nv)
    try:
        return np.broadcast_to(array, shape)
    except ValueError:
        expected = f"() or ({model.nv},)" + ("" if runs is None else f" or {shape}")
        raise InvalidInput(
            f"{name} has shape {array.shape}, expected {expected} for the {model.nv} joints of robot '{model.name}'"
        ) from None
