"""Friction with memory: at standstill its torque depends on how the joint came to rest.

An element is a spring of some stiffness in series with a Coulomb slider. The deflection of its spring is at most d. As
long as nothing slips, it changes from sample to sample by the motion of the joint:

    z_t = clip(z_{t-1} + (q_t - q_{t-1}) / d, -1, 1),     torque F_m z

Far from reversals z = sign(v): a single element is Coulomb friction with presliding (Dahl's, with corners).
Several elements with different d are the hysteresis of the generalized Maxwell-slip model without its Stribeck curve,
which Stribeck(…) adds. The torque is linear in F_m, but not in d; see graphdyn.identification.estimators.tuning.

Lampaert, Al-Bender and Swevers, "A generalized Maxwell-slip friction model appropriate for control purposes", IEEE
PhysCon 2003; Al-Bender, Lampaert and Swevers, IEEE Transactions on Automatic Control 50(11), 2005.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.friction import TORQUE_UNITS, each_positive
from graphdyn.identification.terms.term import TermParameter, per_joint_columns, per_joint_rows
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

DEFLECTION = 0.01
"""Default deflection [rad or m]: half a degree, as of gears with some elasticity."""


@dataclass(frozen=True, eq=False)
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
        return np.concatenate([per_joint_rows(z[:, k]) for k in range(len(widest))], axis=-1)
