"""How joint positions, base and tool of two descriptions of one robot relate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.aligning.axes import rotation_angle
from graphdyn.display import short_repr
from graphdyn.layout import Array
from graphdyn.model.spatial import Placement


@dataclass(frozen=True, eq=False)
@short_repr
class JointMap:
    """How q of the second robot follows from q of the first: q_B = signs · q_A + zeros, entry by entry.

    signs: 1, or -1 where the joint of B turns the other way     (n,)
    zeros: the positions of B's joints where A's are zero        (n,)  [rad or m]
    base: ground frame of B in that of A
    tool: last link frame of B in that of A, at q_A = 0
    """

    signs: Array
    zeros: Array
    base: Placement
    tool: Placement

    def positions(self, q: Array) -> Array:
        """q_B (…, n) of q_A (…, n) [rad or m]."""
        return self.signs * q + self.zeros

    def n_changes(self, tolerance: float, length: float) -> int:
        """How many things it changes: signs, zeros, rotation and translation of base and of tool."""
        frames = [
            change
            for frame in (self.base, self.tool)
            for change in (
                rotation_angle(frame.rotation) > tolerance,
                np.linalg.norm(frame.translation) > tolerance * length,
            )
        ]
        return int((self.signs < 0).sum() + (np.abs(self.zeros) > tolerance).sum() + sum(frames))
