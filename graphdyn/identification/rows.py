"""Equations of consecutive samples, one per joint and sample."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Rows:
    """W x = τ in the base parameters of the structure, for N consecutive samples.

    matrix: W (N, n, b); right: measured minus known torque (N, n); measured: measured torque (N, n)
    velocity: (N, n); kept: which count in the fit (N, n)
    block: number of the time block; first: whether an uninterrupted run of the recording starts here
    """

    matrix: Array
    right: Array
    measured: Array
    velocity: Array
    kept: NDArray[np.bool_]
    block: int = 0
    first: bool = False

    def __len__(self) -> int:
        return len(self.right)

    def __getitem__(self, rows: slice) -> Rows:
        return replace(
            self,
            matrix=self.matrix[rows],
            right=self.right[rows],
            measured=self.measured[rows],
            velocity=self.velocity[rows],
            kept=self.kept[rows],
            first=self.first and not rows.start,
        )
