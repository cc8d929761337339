"""Joints that others drive, as fractions: the positions of all joints are K q + o."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from graphdyn import RobotModel

Ratios = Mapping[str, tuple[Mapping[str, Fraction], Fraction]]
"""Ratios to each driving joint, and the offset, by the name of a joint that others drive."""


@dataclass(frozen=True, eq=False)
class ExactCouplings:
    """matrix K (n, nv), offset o (n,) and reactions (couplings, n), as in graphdyn's DegreesOfFreedom.

    Arrays of fractions, or of what stands for them.
    """

    matrix: Any
    offset: Any
    reactions: Any

    @property
    def entries(self) -> list[Any]:
        return [*self.matrix.ravel(), *self.offset, *self.reactions.ravel()]


def ratios_of_model(model: RobotModel) -> Ratios:
    """Its doubles."""
    return {
        coupling.joint: (
            {name: Fraction(ratio) for name, ratio in coupling.ratios.items()},
            Fraction(coupling.offset),
        )
        for coupling in model.couplings
    }


def exact_couplings(model: RobotModel, ratios: Ratios) -> ExactCouplings:
    """ratios: of the joints that the couplings of the model drive."""
    n, number = model.n_bodies, {name: k for k, name in enumerate(model.joint_names)}
    own, constant, free = _fractions(n, n), _fractions(n), _fractions(n, model.nv)
    free[list(model.degrees_of_freedom.independent), range(model.nv)] = Fraction(1)
    for joint, (terms, offset) in ratios.items():
        constant[number[joint]] = offset
        for name, ratio in terms.items():
            own[number[joint], number[name]] = ratio
    driven = [number[coupling.joint] for coupling in model.couplings]
    among = own[np.ix_(driven, driven)]
    unit = _fractions(len(driven), len(driven))
    unit[np.diag_indices(len(driven))] = Fraction(1)
    matrix, offset, inverse = free, constant, unit
    for _ in driven:  # none drives itself: after so many steps nothing changes
        matrix, offset, inverse = free + own @ matrix, constant + own @ offset, unit + among @ inverse
    reactions = _fractions(len(driven), n)
    reactions[:, driven] = inverse.T
    return ExactCouplings(matrix, offset, reactions)


def _fractions(*shape: int) -> Any:
    return np.full(shape, Fraction(0), dtype=object)
