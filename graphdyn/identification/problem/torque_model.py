"""The terms of the measured torque: unknown parts, linear in their parameters, and known parts.

tau = W x + known,     W = [W_1 … W_k] from the terms
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples, TorqueFreeSamples
from graphdyn.identification.terms import Coulomb, KnownTerm, Offset, RigidBodies, Term, TermParameter, Viscous
from graphdyn.identification.terms.friction import positive
from graphdyn.identification.terms.term import CarriesBodies, CarriesKnownBodies
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.robot_model import RobotModel, check_model

STANDARD_TERMS: tuple[Term, ...] = (RigidBodies(), Viscous(), Coulomb(), Offset())


@dataclass(frozen=True, eq=False)
class TorqueModel:
    """A robot and the terms of its torque; p parameters in all.

    terms: with unknown parameters, in the order of the columns; rigid bodies, viscous and Coulomb friction and offset
        if left out
    known: terms without unknowns; subtracted from the measured torque
    expected: value and standard deviation of parameters that are known beforehand, for instance from a data sheet, by
        symbol: {"IA_3": (764.0, 80.0)}. Methods with takes_expected = True weigh them against the recording
    noise: standard deviation of the torque of each joint, by which methods weigh (n,); estimated if left out

    Raises InvalidInput without a term, and if two columns have the same name.
    """

    model: RobotModel
    terms: Sequence[Term] = STANDARD_TERMS
    known: Sequence[KnownTerm] = ()
    expected: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    noise: ArrayLike | None = None

    def __post_init__(self) -> None:
        check_model(self.model)
        names = [column.name for column in self.columns]
        if not names:
            raise InvalidInput("the torque model has no parameter; give terms such as RigidBodies()")
        repeated = [name for name in names if names.count(name) > 1]
        if repeated:
            raise InvalidInput(f"two parameters of the torque model are called '{repeated[0]}'; give each term once")
        if self.noise is not None:
            positive("noise of the torques", self.noise, self.model.nv)
        symbols = [column.symbol for column in self.columns]
        for symbol, (value, deviation) in self.expected.items():
            if symbol not in symbols:
                raise InvalidInput(
                    f"'{symbol}' is expected, but there is no such parameter; known: {', '.join(symbols)}"
                )
            if not (np.isfinite(value) and 0 < deviation < np.inf):
                raise InvalidInput(
                    f"'{symbol}' is expected to be {value:g} ± {deviation:g}; give a deviation above zero"
                )

    @cached_property
    def columns(self) -> tuple[TermParameter, ...]:
        """Name, symbol and unit of every parameter (p,)."""
        return tuple(column for columns in self._columns_of_terms for column in columns)

    def rows(self, samples: Samples, columns: NDArray[np.int64] | None = None) -> Array:
        """The regressor W (N, n, p) of a short piece, or these columns of it in ascending order."""
        chosen = np.arange(len(self.columns)) if columns is None else columns
        w = np.empty((*samples.q.shape, len(chosen)))
        motion = TorqueFreeSamples(samples)
        for term, part in self._parts:
            first, last = np.searchsorted(chosen, (part.start, part.stop))
            if last - first == part.stop - part.start:
                w[..., first:last] = term.rows(self.model, motion)
            elif first < last:
                w[..., first:last] = term.rows(self.model, motion)[..., chosen[first:last] - part.start]
        return w

    def known_torque(self, samples: Samples) -> Array:
        """Torque of the known terms (N, n) [N m or N]."""
        motion = TorqueFreeSamples(samples)
        parts = (term.torque(self.model, motion) for term in self.known)
        return np.asarray(sum(parts, start=np.zeros(samples.q.shape)))

    def torque(self, samples: Samples, x: Array) -> Array:
        """Torque of all terms, W x + known (N, n)."""
        return self.rows(samples) @ x + self.known_torque(samples)

    @cached_property
    def has_memory(self) -> bool:
        """Whether a term needs all samples of an uninterrupted run at once."""
        return any(getattr(term, "has_memory", False) for term in self.terms)

    def slice_of(self, kind: type) -> slice | None:
        """The columns of the first term of this class, None if there is none."""
        return next((columns for term, columns in self._parts if isinstance(term, kind)), None)

    def inertial_parameters(self, x: Array) -> Array:
        """Inertial parameters of the bodies (10 n,), payload included."""
        total = np.zeros(BODY_PARAMETERS * self.model.n_bodies)
        for term, columns in self._parts:
            if isinstance(term, CarriesBodies):
                total += term.inertial_parameters(self.model, x[columns])
        for known in self.known:
            if isinstance(known, CarriesKnownBodies):
                total += known.known_inertial_parameters(self.model)
        return total

    def expectations(self) -> tuple[NDArray[np.int64], Array, Array]:
        """Columns with an expected value, these values, and their standard deviations (k,)."""
        symbols = [column.symbol for column in self.columns]
        pairs = np.array(list(self.expected.values())).reshape(-1, 2)
        return np.array([symbols.index(symbol) for symbol in self.expected], dtype=np.int64), pairs[:, 0], pairs[:, 1]

    def prior(self) -> Array:
        """Prior mean (p,): the inertial parameters of the model for RigidBodies, zero for the rest."""
        x = np.zeros(len(self.columns))
        for term, columns in self._parts:
            if isinstance(term, RigidBodies):
                x[columns] = self.model.inertial_parameters
        return x

    @cached_property
    def _columns_of_terms(self) -> tuple[tuple[TermParameter, ...], ...]:
        return tuple(term.columns(self.model) for term in self.terms)

    @property
    def _parts(self) -> Iterable[tuple[Term, slice]]:
        start = 0
        for term, columns in zip(self.terms, self._columns_of_terms, strict=True):
            yield term, slice(start, start + len(columns))
            start += len(columns)
