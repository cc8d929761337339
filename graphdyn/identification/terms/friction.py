"""Friction, offset and spring of every joint.

Friction depends on sign(v), or on tanh(v / width) for a smooth change. Sources: Armstrong-Hélouvry, Dupont and Canudas
de Wit, "A survey of models, analysis tools and compensation methods for the control of machines with friction",
Automatica 30(7), 1994 (Stribeck); Khalil and Dombre, Modeling, Identification and Control of Robots, 2002, section 9.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.term import TermParameter, per_joint_columns, per_joint_rows
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

TORQUE_UNITS = ("N m", "N")
DAMPING_UNITS = ("N m s/rad", "N s/m")


@dataclass(frozen=True)
class Viscous:
    """F_v v per joint."""

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "viscous friction", "FV", *DAMPING_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return per_joint_rows(samples.v)


@dataclass(frozen=True, eq=False)
class Coulomb:
    """F_c sign(v) per joint, or F_c tanh(v / width) with a width, one for all or one per joint [rad/s or m/s]."""

    width: ArrayLike | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "Coulomb friction", "FC", *TORQUE_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return per_joint_rows(smooth_sign(samples.v, self.width))


@dataclass(frozen=True, eq=False)
class Stribeck:
    """F_s sign(v) exp(-|v / velocity|^exponent): additional friction at low speed. Use it together with Coulomb.

    velocity, exponent: one for all or one per joint [rad/s or m/s, 1]; they are given, not identified
    width: as in Coulomb
    """

    velocity: ArrayLike
    exponent: ArrayLike = 2.0
    width: ArrayLike | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "Stribeck friction", "FS", *TORQUE_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        v_s = positive("Stribeck velocity", self.velocity, model.nv)
        falling = np.exp(-(np.abs(samples.v / v_s) ** positive("exponent", self.exponent, model.nv)))
        return per_joint_rows(smooth_sign(samples.v, self.width) * falling)


@dataclass(frozen=True, eq=False)
class AsymmetricCoulomb:
    """One Coulomb friction for v > 0 and one for v < 0; both act against the motion. width: as in Coulomb."""

    width: ArrayLike | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        forth = per_joint_columns(model, "Coulomb friction forth", "FC+", *TORQUE_UNITS)
        return forth + per_joint_columns(model, "Coulomb friction back", "FC-", *TORQUE_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        sign = smooth_sign(samples.v, self.width)
        forth, back = np.maximum(sign, 0.0), np.minimum(sign, 0.0)
        return np.concatenate([per_joint_rows(forth), per_joint_rows(back)], axis=-1)


@dataclass(frozen=True)
class AsymmetricViscous:
    """One viscous friction for v > 0 and one for v < 0."""

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        forth = per_joint_columns(model, "viscous friction forth", "FV+", *DAMPING_UNITS)
        return forth + per_joint_columns(model, "viscous friction back", "FV-", *DAMPING_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        forth, back = np.maximum(samples.v, 0.0), np.minimum(samples.v, 0.0)
        return np.concatenate([per_joint_rows(forth), per_joint_rows(back)], axis=-1)


@dataclass(frozen=True)
class Offset:
    """A constant torque per joint: offset of the current sensor, asymmetry of the friction."""

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "offset", "OFF", *TORQUE_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return per_joint_rows(np.ones(samples.v.shape))


@dataclass(frozen=True)
class Spring:
    """K q per joint; together with Offset, a linear spring with any rest position."""

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "spring", "K", "N m/rad", "N/m")

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return per_joint_rows(samples.q)


def smooth_sign(v: Array, width: ArrayLike | None) -> Array:
    """sign(v), or tanh(v / width)."""
    return np.sign(v) if width is None else np.tanh(v / positive("width", width, v.shape[-1]))


def each_positive(who: str, values: Sequence[ArrayLike], n: int) -> Array:
    """Positive numbers (k, n) from a list of k. Raises InvalidInput."""
    if np.isscalar(values) or len(values) == 0:
        raise InvalidInput(f"{who}s are {values!r}; give a list of at least one")
    return np.array([positive(who, value, n) for value in values])


def positive(who: str, value: ArrayLike, n: int) -> Array:
    """Positive numbers (n,) from one or n. Raises InvalidInput."""
    array = as_floats(who, value)
    if array.shape not in ((), (n,)) or not np.all(np.isfinite(array)) or not np.all(array > 0):
        raise InvalidInput(f"{who} is {np.array2string(array)}; give one positive number, or {n}")
    return np.broadcast_to(array, (n,))
