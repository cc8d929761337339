"""Search for numbers that enter a torque model nonlinearly: widths, Stribeck velocities, deflections.

    min over s, x of Σ_g ‖W_g(s) x - τ_g‖² / σ_g²

The method is variable projection: for every s, linear least squares gives the best x. The search is over s alone, one
number per joint, in logarithms. σ_g is the noise at the start. x has no bounds.

Golub and Pereyra, "Separable nonlinear least squares: the variable projection method and its applications", Inverse
Problems 19, 2003.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.compressed import joint_noise
from graphdyn.identification.algebra.least_squares import orthonormal_basis
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms.term import Term, TermParameter
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

SEARCH_RANGE_FACTOR = 30.0
"""Factor of the search interval: from the start divided by this to the start times this."""

RELATIVE_DIFFERENCE_STEP = 0.02
"""Relative step of the finite differences: far above the spacing of samples around the corners of the friction."""

SEARCH_TOLERANCE = 1e-4
"""Relative change of the sum of squares at which the search ends."""

MAX_EQUATION_BYTES = 1e9
"""Largest size of the equations in memory [bytes]."""


@dataclass(frozen=True, eq=False)
@short_repr
class Tunable:
    """A term with settings that `tuned` finds, one number for each joint; used directly, it is the term at the start.

    name: of the term, as text
    make: the term with these settings, each (n,)
    start: by name; positive                                [the unit of the setting]
    """

    name: str
    make: Callable[..., Term]
    start: Mapping[str, float]

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return self._at_start(model).columns(model)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return self._at_start(model).rows(model, samples)

    @property
    def has_memory(self) -> bool:
        """Whether the term has memory."""
        return getattr(self.make(**self.start), "has_memory", False)

    def _at_start(self, model: RobotModel) -> Term:
        return self.make(**{name: np.full(model.nv, value) for name, value in self.start.items()})


@dataclass(frozen=True, eq=False)
@short_repr
class Tuned:
    """A setting that was found.

    name: of term and setting, such as "coulomb width"
    values: one per joint  (n,)  [the unit of the setting]
    at_end: whether it is at the end of the range of the search, because the recording does not determine it  (n,)
    """

    name: str
    values: Array
    at_end: NDArray[np.bool_]


def tuned(problem: Problem) -> tuple[TorqueModel, tuple[Tuned, ...]]:
    """The torque model of a problem with the best settings in place of every Tunable, and these settings.

    Raises InvalidInput if the equations do not fit in memory.
    """
    from scipy.optimize import least_squares  # imported where first used: import graphdyn stays light

    model = problem.torque_model
    searched = [(k, term) for k, term in enumerate(model.terms) if isinstance(term, Tunable)]
    if not searched:
        return model, ()
    n = model.model.nv
    names = [(term, name, value) for _, term in searched for name, value in term.start.items()]

    def settings(u: Array) -> list[Array]:
        return [value * np.exp(part) for (*_, value), part in zip(names, np.split(u, len(names)), strict=True)]

    def terms(u: Array) -> dict[int, Term]:
        found = list(zip(names, settings(u), strict=True))
        return {
            k: term.make(**{name: values for (owner, name, _), values in found if owner is term})
            for k, term in searched
        }

    projected = _Projected(problem, [k for k, _ in searched])

    def residual(u: Array) -> Array:
        return projected.residual(list(terms(u).values()))

    def jacobian(u: Array) -> Array:
        here = residual(u)
        return np.column_stack(
            [
                (residual(u + RELATIVE_DIFFERENCE_STEP * unit) - here) / RELATIVE_DIFFERENCE_STEP
                for unit in np.eye(len(u))
            ]
        )

    end = np.log(SEARCH_RANGE_FACTOR)
    start = np.zeros(n * len(names))
    best = least_squares(
        residual,
        start,
        jacobian,
        bounds=(-end - RELATIVE_DIFFERENCE_STEP, end + RELATIVE_DIFFERENCE_STEP),
        ftol=SEARCH_TOLERANCE,
        xtol=RELATIVE_DIFFERENCE_STEP / 2,
    )
    found = terms(best.x)
    at_end = np.split(np.abs(best.x) > end - RELATIVE_DIFFERENCE_STEP, len(names))
    said = [
        Tuned(f"{term.name} {name}", values, there)
        for (term, name, _), values, there in zip(names, settings(best.x), at_end, strict=True)
    ]
    return replace(model, terms=[found.get(k, term) for k, term in enumerate(model.terms)]), tuple(said)


class _Projected:
    """The equations without the other terms: projected by 1 - Q Qᵀ, Q an orthonormal basis of their columns."""

    def __init__(self, problem: Problem, searched: list[int]) -> None:
        self._problem = problem
        model = problem.torque_model
        noise = joint_noise(problem.equations)
        parts = list(problem.rows())
        if 8.0 * sum(part.matrix.size for part in parts) > MAX_EQUATION_BYTES:
            raise InvalidInput("the equations do not fit in memory for settings that are to be found; decimate more")
        self._kept = np.concatenate([part.kept for part in parts])
        self._noise = np.broadcast_to(noise, self._kept.shape)[self._kept]
        others = [term for k, term in enumerate(model.terms) if k not in searched]
        self._basis = np.zeros((len(self._noise), 0))
        if others:
            self._basis = orthonormal_basis(self._columns(others), problem.rank_tolerance)
        self._right = self._without(np.concatenate([part.right for part in parts])[self._kept] / self._noise)

    def residual(self, terms: list[Term]) -> Array:
        """Residual (rows,) in units of the noise, with the best x."""
        columns = self._without(self._columns(terms))
        x, *_ = np.linalg.lstsq(columns, self._right, rcond=None)
        return np.asarray(columns @ x - self._right)

    def _columns(self, terms: list[Term]) -> Array:
        """Filtered columns of terms over the rows that count, in units of the noise."""
        problem = self._problem
        own = replace(problem, torque_model=TorqueModel(problem.torque_model.model, terms), progress=None)
        matrix = np.concatenate([part.matrix for part in own.rows()])
        return np.asarray(matrix[self._kept] / self._noise[:, None])

    def _without(self, columns: Array) -> Array:
        return np.asarray(columns - self._basis @ (self._basis.T @ columns))
