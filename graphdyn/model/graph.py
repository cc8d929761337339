"""The robot as a graph: bodies are vertices, joints are edges. No mechanics here.

Vertex 0 is the ground; joint j is the edge from its inside body i(j) to body j (paper, section 2.1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.errors import InvalidModel

IntArray = NDArray[np.int64]


@dataclass(frozen=True)
@short_repr
class Graph:
    """A tree in regular labeling: the inside body of joint j has a number below j.

    inside: i(j) for j = 1 … n, the number of the vertex on the inside of joint j; 0 is the ground

    Raises InvalidModel where a joint has its inside vertex after itself.
    """

    inside: tuple[int, ...]

    def __post_init__(self) -> None:
        for j, i in enumerate(self.inside, start=1):
            if not 0 <= i < j:
                raise InvalidModel(f"joint {j} has inside vertex {i}; a tree with parents first needs 0 … {j - 1}")

    @property
    def n(self) -> int:
        """Number of bodies, and of joints."""
        return len(self.inside)

    def incidence(self) -> IntArray:
        """S (n, n): S_ij = +1 if joint j starts with body i, -1 if it ends with body i. Eq. (8)-(10).

        The force element of joint j acts between the same two bodies: the paper's S^e of Eq. (12)-(13) is S.
        """
        s = -np.eye(self.n, dtype=np.int64)
        for j, i in enumerate(self.inside, start=1):
            if i > 0:
                s[i - 1, j - 1] = 1
        return s

    def path_matrix(self) -> IntArray:
        """T (n, n): T_ji = 1 if joint j lies on the path from the ground to body i. T = -S⁻¹."""
        t = np.eye(self.n, dtype=np.int64)
        for j, i in enumerate(self.inside, start=1):
            if i > 0:
                t[:, j - 1] += t[:, i - 1]
        return t

    def outside(self, i: int) -> tuple[int, ...]:
        """Numbers of the bodies that vertex i carries directly."""
        return tuple(j for j, inside in enumerate(self.inside, start=1) if inside == i)
