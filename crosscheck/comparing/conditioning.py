"""Ranks of the constraints and of Eq. (111), and how well both are conditioned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from crosscheck.comparing.compared_states import ComparedStates
from crosscheck.quantities.system import kkt_system
from graphdyn.layout import Array


@dataclass(frozen=True)
class Conditioning:
    """Extremes of rank and condition number over the samples of one case: (smallest, largest).

    constraint_rank: of φ_q; full: 5n
    constraint_condition: condition number of φ_q
    kkt_rank: of the matrix of Eq. (111); full: 11n
    kkt_condition: condition number of the matrix of Eq. (111)
    mass_matrix_condition: condition number of the joint-space mass matrix M
    """

    constraint_rank: tuple[int, int]
    constraint_condition: tuple[float, float]
    kkt_rank: tuple[int, int]
    kkt_condition: tuple[float, float]
    mass_matrix_condition: tuple[float, float]

    def merged(self, other: Conditioning) -> Conditioning:
        pairs = ((getattr(self, name), getattr(other, name)) for name in self.__dataclass_fields__)
        return Conditioning(*((min(a[0], b[0]), max(a[1], b[1])) for a, b in pairs))


def rank_errors(states: ComparedStates) -> tuple[dict[str, Array], Conditioning]:
    """Missing ranks of φ_q and of the matrix of Eq. (111), as parts of the full rank, and the conditioning.

    Only where the mass matrix is regular, the matrix of Eq. (111) must have full rank.
    """
    system = kkt_system(states)
    rank, kkt_rank = np.asarray(system.constraint_rank()), np.asarray(system.rank())
    n_rows, size = system.constraint_jacobian.shape[-2], system.matrix.shape[-1]
    errors = {"constraint_rank": 1.0 - rank / n_rows}
    if states.regular.any():
        errors["kkt_rank"] = np.where(states.regular, 1.0 - kkt_rank / size, 0.0)
    conditioning = Conditioning(
        _range(rank),
        _range(np.linalg.cond(system.constraint_jacobian)),
        _range(kkt_rank),
        _range(np.asarray(system.condition_number())),
        _range(np.linalg.cond(states.answer("mass_matrix"))),
    )
    return errors, conditioning


def _range(x: Array) -> tuple[Any, Any]:
    return x.min().item(), x.max().item()
