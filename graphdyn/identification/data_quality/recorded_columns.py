"""Conversion of recorded columns to joint coordinates: faults occur in columns, before gears and offsets."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from graphdyn.identification.data.samples import Samples
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class RecordedColumns:
    """q = position c_q + zero,   tau = torque c_tau   with the columns c in SI units.

    position, torque: unit matrices if the columns are those of the joints          (n, n)
    zero: joint coordinates at zero of the position columns                         (n,) [rad or m]
    """

    position: Array
    torque: Array
    zero: Array

    @classmethod
    def of_joints(cls, n: int) -> RecordedColumns:
        """Columns that are the joint coordinates themselves."""
        return cls(np.eye(n), np.eye(n), np.zeros(n))

    def changed(
        self,
        samples: Samples,
        *,
        position: Array | None = None,
        velocity: Array | None = None,
        torque: Array | None = None,
        zero: Array | None = None,
    ) -> Samples:
        """The samples after a multiplication of the columns by these matrices (n, n).

        velocity: of the columns of v and a
        zero: added to the resulting joint positions        (n,)
        """
        q, v, a = samples.q, samples.v, samples.a
        if position is not None:
            q = (q - self.zero) @ _conjugated(position, self.position).T + self.zero
        if zero is not None:
            q = q + zero
        if velocity is not None:
            matrix = _conjugated(velocity, self.position).T
            v, a = v @ matrix, a @ matrix
        tau = samples.tau if torque is None else samples.tau @ _conjugated(torque, self.torque).T
        return replace(samples, q=q, v=v, a=a, tau=tau)


def _conjugated(change: Array, to_joints: Array) -> Array:
    """The change of the columns, expressed in joint coordinates."""
    return np.asarray(to_joints @ change @ np.linalg.inv(to_joints))
