"""Friction, offset and spring of every joint; friction that grows with the load, and friction with memory.

Friction depends on sign(v), or on tanh(v / width) for a smooth change. Sources: Armstrong-Hélouvry, Dupont and Canudas
de Wit, "A survey of models, analysis tools and compensation methods for the control of machines with friction",
Automatica 30(7), 1994 (Stribeck); Khalil and Dombre, Modeling, Identification and Control of Robots, 2002, section 9.3.

Load: Hamon, Gautier and Garrec, "Dynamic identification of robots with a dry friction model depending on load and
velocity", IEEE/RSJ IROS 2010; harmonic drives and worm gears lose a part of the torque that they transmit.

Memory: at standstill the torque depends on how the joint came to rest. An element is a spring of some stiffness in
series with a Coulomb slider. The deflection of its spring is at most d. As long as nothing slips, it changes from
sample to sample by the motion of the joint:

    z_t = clip(z_{t-1} + (q_t - q_{t-1}) / d, -1, 1),     torque F_m z

Far from reversals z = sign(v): a single element is Coulomb friction with presliding (Dahl's, with corners).
Several elements with different d are the hysteresis of the generalized Maxwell-slip model without its Stribeck curve,
which Stribeck(…) adds. The torque is linear in F_m, but not in d; see graphdyn.identification.estimation.tuning.

Lampaert, Al-Bender and Swevers, "A generalized Maxwell-slip friction model appropriate for control purposes", IEEE
PhysCon 2003; Al-Bender, Lampaert and Swevers, IEEE Transactions on Automatic Control 50(11), 2005.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.term import TermParameter, per_joint_columns, per_joint_rows
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.dynamics import gravity_torque

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
@short_repr
class Coulomb:
    """F_c sign(v) per joint, or F_c tanh(v / width) with a width, one for all or one per joint [rad/s or m/s]."""

    width: ArrayLike | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "Coulomb friction", "FC", *TORQUE_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return per_joint_rows(smooth_sign(samples.v, self.width))


@dataclass(frozen=True, eq=False)
@short_repr
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
@short_repr
class AsymmetricCoulomb:
    """One Coulomb friction for v > 0 and one for v < 0; both act against the motion. width: as in Coulomb."""

    width: ArrayLike | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        forth = per_joint_columns(model, "Coulomb friction forth", "FC+", *TORQUE_UNITS)
        return forth + per_joint_columns(model, "Coulomb friction back", "FC-", *TORQUE_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        sign = smooth_sign(samples.v, self.width)
        return per_joint_rows(np.maximum(sign, 0.0), np.minimum(sign, 0.0))


@dataclass(frozen=True)
class AsymmetricViscous:
    """One viscous friction for v > 0 and one for v < 0."""

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        forth = per_joint_columns(model, "viscous friction forth", "FV+", *DAMPING_UNITS)
        return forth + per_joint_columns(model, "viscous friction back", "FV-", *DAMPING_UNITS)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return per_joint_rows(np.maximum(samples.v, 0.0), np.minimum(samples.v, 0.0))


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


DEFAULT_WIDTHS = (0.02, 0.1, 0.5)
"""Default widths of SmoothCoulomb [rad/s or m/s]: stiction, Stribeck's range, half the speed of slow motions."""


@dataclass(frozen=True, eq=False)
@short_repr
class LoadFriction:
    """F_l |g_j(q)| sign(v) per joint: Coulomb friction as a fraction of the load that the gear transmits.

    The load g is the torque of gravity on the model's own bodies, as from CAD, so that the torque stays linear in F_l.
    width: as in Coulomb
    """

    width: ArrayLike | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "load-dependent friction", "FL", "1", "1")

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        sign = smooth_sign(samples.v, self.width)
        if not sign.any():  # mass matrices are made of many rows at rest
            return per_joint_rows(sign)
        load = np.abs(gravity_torque(model, samples.q, base=samples.base, method="reproducible"))
        return per_joint_rows(load * sign)


@dataclass(frozen=True, eq=False)
@short_repr
class SmoothCoulomb:
    """Σ_k F_k tanh(v / width_k) per joint: a friction curve of any shape that saturates.

    A positive narrow part together with a negative wide one is Stribeck friction.
    widths: at least one, each one number for all joints or one per joint    (k,) or (k, n)  [rad/s or m/s]
    """

    widths: Sequence[ArrayLike] = DEFAULT_WIDTHS

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        names: list[TermParameter] = []
        for k, per_joint in enumerate(each_positive("width", self.widths, model.nv), start=1):
            plain = per_joint_columns(model, "Coulomb friction", f"FC{k}", *TORQUE_UNITS)
            for column, width in zip(plain, per_joint, strict=True):
                names.append(replace(column, name=f"{column.name} of width {width:g}"))
        return tuple(names)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return per_joint_rows(*(smooth_sign(samples.v, width) for width in self.widths))


DEFLECTION = 0.01
"""Default deflection [rad or m]: half a degree, as of gears with some elasticity."""


@dataclass(frozen=True, eq=False)
@short_repr
class MaxwellSlip:
    """F_m z(t) per joint and element, in place of Coulomb or in addition to it. At the start of a run the springs are
    free.

    deflections: d of every element, each one number for all joints or one per joint    (k,) or (k, n)  [rad or m]
    """

    deflections: Sequence[ArrayLike] = (DEFLECTION,)
    has_memory: ClassVar[bool] = True

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        count = len(each_positive("deflection", self.deflections, model.nv))
        several = count > 1
        return tuple(
            TermParameter(f"{column.name} {k}" if several else column.name, column.symbol, column.unit)
            for k in range(1, count + 1)
            for column in per_joint_columns(model, "Maxwell-slip friction", f"FM{k if several else ''}", *TORQUE_UNITS)
        )

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        widest = each_positive("deflection", self.deflections, samples.q.shape[1])
        steps = np.diff(samples.q, axis=0, prepend=samples.q[:1])[:, None] / widest
        z = np.empty(steps.shape)
        now = np.zeros(widest.shape)
        for t, step in enumerate(steps):
            now = np.clip(now + step, -1.0, 1.0)
            z[t] = now
        return per_joint_rows(*np.moveaxis(z, 1, 0))
