"""Errors of answers on scales that cannot vanish: the largest reference value and the sizes of the summed terms."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import acceleration_scale, by_parameter_type, by_part, largest, ratio, relative
from graphdyn.layout import Array

Chosen = Mapping[str, str]
"""One way to read an answer: for each convention of the quantity, which one is followed."""

Measure = Callable[[Array, Array, ScaledStates, Chosen], Array]
"""(answer, reference, states, chosen) → relative error per state (N,)."""

Size = Callable[[ScaledStates], Array]
"""Size of the summed terms at N states (N,)."""

ORDER = {"order": ("linear first", "angular first")}
"""Convention: which three of the six entries of a twist or wrench come first."""


def linear_first(x: Array, chosen: Chosen, axis: int = -1) -> Array:
    """A twist or wrench of one order in the usual one; and back: both exchange the halves."""
    return np.roll(x, 3, axis=axis) if chosen.get("order") == "angular first" else x


def relative_to(*sizes: Size) -> Measure:
    """Relative to the largest reference value and the given sizes."""
    return lambda x, y, states, _: relative(x, y, *(size(states) for size in sizes))


def parts_relative_to(linear: Size, angular: Size, axis: int = -1) -> Measure:
    """The larger error of the linear and angular parts: the first and last three entries of an axis of six."""

    def measure(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
        x, y = (np.moveaxis(linear_first(z, chosen, axis), axis, -1) for z in (x, y))
        return by_part(x, y, linear(states), angular(states))

    return measure


def columns_relative_to(mass: Size, first_moment: Size, tensor: Size) -> Measure:
    """The largest error of the columns of m, of m c and of I of a regressor, each on its own scale."""
    sizes = mass, first_moment, tensor
    return lambda x, y, states, _: by_parameter_type(x, y, *(size(states) for size in sizes))


def through_mass_matrix(*sizes: Size) -> Measure:
    """Errors of accelerations in columns (N, n, p): M × the error, over the largest of ∣M∣ ∣reference∣ and the given
    sizes."""

    def measure(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
        required = [largest(np.abs(states.mass) @ np.abs(y)), *(size(states) for size in sizes)]
        return ratio(largest(states.mass @ (x - y)), np.maximum.reduce(required))

    return measure


def acceleration_bound(states: ScaledStates) -> Array:
    """scales.acceleration_scale of the accelerations at tau (N,)."""

    def bound() -> Array:
        a, _, wrenches = states.solved
        size = largest(wrenches) if states.loads is None else np.maximum(largest(wrenches), largest(states.loads))
        return acceleration_scale(states.mass, a, states.tau, size)

    found: Array = states.once("bound of the accelerations", bound)
    return found


def largest_wrench(states: ScaledStates) -> Array:
    return largest(states.wrenches)


def spin(states: ScaledStates) -> Array:
    return states.sizes.spin


def rate_size(states: ScaledStates) -> Array:
    """Largest entry of M × largest velocity."""
    return largest(states.mass) * largest(states.v)


def total_mass(states: ScaledStates) -> float:
    return sum(body.mass for body in states.model.bodies)


def constant(number: float, states: ScaledStates) -> Array:
    """The same size at every state."""
    return np.full(len(states.q), number)


ZERO_DIRECTION_SHARE = 1e-10
"""Part of the largest singular value below which a direction of the column space is rounding."""

WEAK_COLUMN_SHARE = 0.1
"""Part of the largest entry of all columns below which a column counts as smaller, so that rounding in a column of
zeros does not count as a direction."""


def span_errors(answer: Array, reference: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """Per state, the largest entry of either regressor that no combination of the other's columns gives (N,).

    It is zero for base regressors of any basis, which have the same column space over many states.

    answer (N, n, p), reference (N, n, m); their columns over all states are brought to largest entries of 1.
    """
    if not np.isfinite(answer).all():
        return np.where(np.isfinite(answer).all(axis=(1, 2)), 0.0, np.inf)
    outside = np.concatenate([outside_of(answer, reference), outside_of(reference, answer)], axis=-1)
    errors: Array = outside.max(axis=(1, 2), initial=0.0)
    return errors


def outside_of(x: Array, y: Array) -> Array:
    """What is left of each column of x (N, n, p), at largest entry 1, without its part in the column space of y."""
    basis = column_space(y)
    columns = _unit_columns(x)
    rest: Array = np.abs(columns - basis @ (basis.T @ columns))
    return rest.reshape(x.shape)


def column_space(x: Array) -> Array:
    """An orthonormal basis of the column space of a regressor over all states (N, n, p) → (N n, rank)."""
    u, sizes, _ = np.linalg.svd(_unit_columns(x), full_matrices=False)
    found: Array = u[:, sizes > ZERO_DIRECTION_SHARE * sizes.max(initial=0.0)]
    return found


def _unit_columns(x: Array) -> Array:
    """Columns over all states with largest entry 1 (N n, p); weak ones with less."""
    columns = x.reshape(-1, x.shape[-1])
    largest = np.abs(columns).max(axis=0, initial=0.0)
    whole = largest.max(initial=0.0)
    found: Array = columns / np.maximum(largest, WEAK_COLUMN_SHARE * whole if whole > 0 else 1.0)
    return found
