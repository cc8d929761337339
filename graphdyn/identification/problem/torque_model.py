"""The terms of the measured torque: unknown parts, linear in their parameters, and known parts.

tau = W x + known,     W = [W_1 … W_k] from the terms

The parameters that some motion could determine are its base parameters over random states. Gram matrices of a torque
model come directly from the motion, without stored equations: the rigid bodies from compiler.gram, which multiplies the
columns of the regressor as it computes them. The columns of the other terms are passed to it, joint by joint.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import refuse_non_finite
from graphdyn.compiler.gram.gram import torque_gram
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.base_parameters import BaseParameters, Indices, base_parameters
from graphdyn.identification.data.samples import Samples, TorqueFreeSamples
from graphdyn.identification.problem.exact_angles import with_exact_angles
from graphdyn.identification.terms import Coulomb, KnownTerm, Offset, RigidBodies, Term, TermParameter, Viscous
from graphdyn.identification.terms.friction import positive
from graphdyn.identification.terms.term import CarriesBodies, CarriesKnownBodies
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.verbs.assembly import assemble

STANDARD_TERMS: tuple[Term, ...] = (RigidBodies(), Viscous(), Coulomb(), Offset())


@dataclass(frozen=True, eq=False)
@short_repr
class TorqueModel:
    """A robot and the terms of its torque; p parameters in all.

    terms: with unknown parameters, in the order of the columns; rigid bodies, viscous and Coulomb friction and offset
        if left out
    known: terms without unknowns; subtracted from the measured torque
    expected: value and standard deviation of parameters that are known beforehand, for instance from a data sheet, by
        symbol: {"IA_3": (764.0, 80.0)}. Methods with takes_expected = True weigh them against the recording
    noise: standard deviation of the torque of each joint, by which methods weigh (n,); estimated if left out
    exact_angles: leave out parameters that only the rounding of angles in the robot's file shows (exact_angles.py)

    Raises InvalidInput without a term, and if two columns have the same name.
    """

    model: RobotModel
    terms: Sequence[Term] = STANDARD_TERMS
    known: Sequence[KnownTerm] = ()
    expected: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    noise: ArrayLike | None = None
    exact_angles: bool = True

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
        for term, part in self.parts:
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
        return next((columns for term, columns in self.parts if isinstance(term, kind)), None)

    def inertial_parameters(self, x: Array) -> Array:
        """Inertial parameters of the bodies (10 n,), payload included."""
        total = np.zeros(BODY_PARAMETERS * self.model.n_bodies)
        for term, columns in self.parts:
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
        for term, columns in self.parts:
            if isinstance(term, RigidBodies):
                x[columns] = self.model.inertial_parameters
        return x

    @cached_property
    def _columns_of_terms(self) -> tuple[tuple[TermParameter, ...], ...]:
        return tuple(term.columns(self.model) for term in self.terms)

    @property
    def parts(self) -> Iterator[tuple[Term, slice]]:
        """The terms with their columns."""
        start = 0
        for term, columns in zip(self.terms, self._columns_of_terms, strict=True):
            yield term, slice(start, start + len(columns))
            start += len(columns)


STATES_PER_PARAMETER = 4
"""Random states per parameter: each gives n equations, far more than there are unknowns."""

MAX_RANDOM_ACCELERATION = 10.0
"""Largest random acceleration [rad/s² or m/s²]: inertia is then visible against gravity."""

MAX_RANDOM_SPEED = 10.0
"""Largest random speed [rad/s or m/s]: beyond it centrifugal torques would dominate all others."""

MIN_STEP, MAX_STEP = 1e-6, 0.1
"""Steps between random states of friction with memory [rad or m]: with only long steps all elements slip alike."""


@dataclass(frozen=True, eq=False)
class ParameterStructure:
    """Base parameters of a torque model, and the joints on which they act.

    base: over random states
    nearly_undetermined: columns of base parameters that only rounded angles show, which are regrouped instead   (k,)
    support: (n, b): whether column base.independent[k] can differ from zero in the torque of joint j
    """

    base: BaseParameters
    support: NDArray[np.bool_]
    nearly_undetermined: Indices


@functools.lru_cache(maxsize=8)
def structure(torque_model: TorqueModel, seed: int = 0) -> ParameterStructure:
    """Structure of a torque model. The same model and seed give the same result; the last few are cached."""
    samples = random_samples(torque_model, STATES_PER_PARAMETER * len(torque_model.columns), seed)
    w = torque_model.rows(samples)
    base, left_out = base_parameters(w.reshape(-1, w.shape[-1])), np.zeros(0, dtype=np.int64)
    exact = with_exact_angles(torque_model.model) if torque_model.exact_angles else torque_model.model
    if exact is not torque_model.model and not exact.chords:
        meant = replace(torque_model, model=exact).rows(samples)
        of_exact = base_parameters(meant.reshape(-1, w.shape[-1]))
        if of_exact.rank < base.rank:
            base, left_out = of_exact, np.setdiff1d(base.independent, of_exact.independent)
    support = np.any(w[..., base.independent] != 0, axis=0)
    return ParameterStructure(base, support, left_out)


def random_samples(torque_model: TorqueModel, size: int, seed: int) -> Samples:
    """Random states within the limits of the robot, torques zero; times and temperatures random too.

    For friction with memory every second state is a random step away from the previous one.
    """
    rng = np.random.default_rng(seed)
    q, v = torque_model.model.random_state(rng, size)
    v = np.clip(v, -MAX_RANDOM_SPEED, MAX_RANDOM_SPEED)
    a = rng.uniform(-MAX_RANDOM_ACCELERATION, MAX_RANDOM_ACCELERATION, q.shape)
    if torque_model.has_memory:
        sizes = np.exp(rng.uniform(np.log(MIN_STEP), np.log(MAX_STEP), q[1::2].shape))
        q[1::2] = q[: 2 * len(sizes) : 2] + sizes * rng.choice([-1.0, 1.0], sizes.shape)
    if torque_model.model.chords:
        q, v, a = assemble(torque_model.model, q, v, a)
    time, temperature = rng.normal(size=size), rng.normal(size=q.shape)
    return Samples(q, v, a, np.zeros_like(q), time=time, temperature=temperature)


class DirectSums:
    """[W_j | τ_j]ᵀ [W_j | τ_j] of every joint, in the base parameters of the structure."""

    def __init__(self, torque_model: TorqueModel, structure: ParameterStructure) -> None:
        self._torque_model = torque_model
        self._independent = independent = structure.base.independent
        known_to_kernel = any(type(term) is RigidBodies for term in torque_model.terms)  # another regressor is not
        rigid = (torque_model.slice_of(RigidBodies) if known_to_kernel else None) or slice(0, 0)
        is_rigid = (independent >= rigid.start) & (independent < rigid.stop)
        self._rigid, self._others = np.flatnonzero(is_rigid), np.flatnonzero(~is_rigid)
        self._other_columns = independent[self._others]
        acting = [np.flatnonzero(row[self._others]) for row in structure.support]
        self._acting = acting
        self._n_extra = max(map(len, acting))
        if not torque_model.model.chords:  # which the kernel does not cover
            columns = (independent[self._rigid] - rigid.start).tolist()
            self._gram = torque_gram(torque_model.model, columns, self._n_extra, weighted=True)
        self._width = len(independent) + 1

    def __call__(self, samples: Samples, kept: NDArray[np.bool_]) -> list[Array]:
        """Gram matrices of all joints (b + 1, b + 1), over the equations that count (N, n).

        Raises InvalidInput for NaN, infinity.
        """
        right = np.asarray(samples.tau, dtype=float) - self._torque_model.known_torque(samples)
        if samples.base is not None or self._torque_model.model.chords:
            return self._plain_sums(samples, right, kept)
        others = self._torque_model.rows(samples, self._other_columns)
        extra = np.zeros((*right.shape, self._n_extra))
        for joint, columns in enumerate(self._acting):
            extra[:, joint, : len(columns)] = others[:, joint, columns]
        matrices, seen = self._gram(samples.q, samples.v, samples.a, right, extra, kept.astype(float))
        if np.isnan(seen["finite"]):
            arrays = {name: getattr(samples, name) for name in ("q", "v", "a", "tau")}
            refuse_non_finite(self._torque_model.model, arrays)
        return [self._spread(joint, matrix) for joint, matrix in enumerate(matrices)]

    def _plain_sums(self, samples: Samples, right: Array, kept: NDArray[np.bool_]) -> list[Array]:
        """Gram matrices on a moving base and with loops, which the kernel does not cover."""
        equations = np.concatenate([self._torque_model.rows(samples, self._independent), right[..., None]], axis=-1)
        chosen = [equations[kept[:, joint], joint] for joint in range(right.shape[1])]
        return [rows.T @ rows for rows in chosen]

    def _spread(self, joint: int, matrix: Array) -> Array:
        """Expand the columns that act on a joint to all columns."""
        own = self._acting[joint]
        rigid = self._rigid[self._gram.columns[joint]]
        used = np.concatenate([np.arange(len(rigid) + len(own)), [len(matrix) - 1]])
        places = np.concatenate([rigid, self._others[own], [self._width - 1]])
        spread = np.zeros((self._width, self._width))
        spread[np.ix_(places, places)] = matrix[np.ix_(used, used)]
        return spread
