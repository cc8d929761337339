"""Friction of gears that grows with the load, and Coulomb friction with several widths.

Hamon, Gautier and Garrec, "Dynamic identification of robots with a dry friction model depending on load and velocity",
IEEE/RSJ IROS 2010; harmonic drives and worm gears lose a part of the torque that they transmit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.friction import TORQUE_UNITS, each_positive, smooth_sign
from graphdyn.identification.terms.term import TermParameter, per_joint_columns, per_joint_rows
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.dynamics import gravity_torque

DEFAULT_WIDTHS = (0.02, 0.1, 0.5)
"""Default widths of SmoothCoulomb [rad/s or m/s]: stiction, Stribeck's range, half the speed of slow motions."""


@dataclass(frozen=True, eq=False)
class LoadFriction:
    """F_l |g_j(q)| sign(v) per joint: Coulomb friction as a fraction of the load that the gear transmits.

    The load g is the torque of gravity on the model's own bodies, as from CAD, so that the torque stays linear in F_l.
    width: as in Coulomb
    """

    width: ArrayLike | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return per_joint_columns(model, "load-dependent friction", "FL", "1", "1")

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        load = np.abs(gravity_torque(model, samples.q, base=samples.base))
        return per_joint_rows(load * smooth_sign(samples.v, self.width))


@dataclass(frozen=True, eq=False)
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
            names += [
                TermParameter(f"{column.name} of width {width:g}", column.symbol, column.unit)
                for column, width in zip(plain, per_joint, strict=True)
            ]
        return tuple(names)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return np.concatenate([per_joint_rows(smooth_sign(samples.v, width)) for width in self.widths], axis=-1)
