"""The functions that codes compute by difference quotients, and what of: positions, torques, energies, matrices."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS
from crosscheck.quantities.measures import Chosen, linear_first
from graphdyn.layout import Array

Points = Callable[[Array, NDArray[np.intp]], Array]
"""Points (K, n), and the state that each belongs to (K,) → values (K, …)."""


@dataclass(frozen=True)
class Differences:
    """Difference quotients (f(x + h) - f(x)) / h; backward ones have a negative step.

    central: (f(x + h) - f(x - h)) / 2h
    relative: the step is multiplied by the size of the argument, where that is above 1, and takes its sign
    """

    step: float
    central: bool
    relative: bool = False

    def ends(self) -> tuple[float, float]:
        """The two places in steps."""
        return (1.0, -1.0) if self.central else (1.0, 0.0)

    def of(self, f: Points, x: Array) -> Array:
        """∂f/∂x at N states (N, …, n). x: (N, n)."""
        size, n = x.shape
        steps = self.step * (np.where(x < 0, -1.0, 1.0) * np.maximum(1.0, np.abs(x)) if self.relative else 1 + 0 * x)
        rows = np.repeat(np.arange(size), n)
        ways = (steps[:, :, None] * np.eye(n)).reshape(-1, n)
        there, back = (f(x[rows] + end * ways, rows) for end in self.ends())
        quotient = (there - back) / (steps.reshape(-1, *[1] * (there.ndim - 1)) * (2 if self.central else 1))
        return np.moveaxis(quotient.reshape(size, n, *there.shape[1:]), 1, -1)

    def in_time(self, f: Points, x: Array, rate: Array) -> Array:
        """d/dt of f along x + t rate (N, …)."""
        rows = np.arange(len(x))
        there, back = (f(x + end * self.step * rate, rows) for end in self.ends())
        return (there - back) / (self.step * (2 if self.central else 1))


Form = Callable[[JudgedStates, Chosen, Differences], Array]
"""A function by difference quotients (N, …)."""


def _values(name: str, states: JudgedStates, chosen: Chosen | None = None, /, **arrays: Array) -> Array:
    known = FUNCTIONS[name]
    return known.of_graphdyn(states.but(**arrays), next(known.readings({})) if chosen is None else chosen)


def _derivative(name: str, argument: str, states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    """The derivative of a function in q, v, a or tau."""
    return by.of(lambda x, rows: _values(name, states.rows(rows), None, **{argument: x}), getattr(states, argument))


def _mass_slopes(states: JudgedStates, by: Differences) -> Array:
    """∂M/∂q (N, n, n, n)."""
    return _derivative("mass_matrix", "q", states, {}, by)


def _coriolis(states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    """C of the Christoffel symbols."""
    slopes, v = _mass_slopes(states, by), states.v
    columns = np.einsum("nikj,nk->nij", slopes, v)
    found: Array = 0.5 * (np.einsum("nijk,nk->nij", slopes, v) + columns - np.swapaxes(columns, 1, 2))
    return found


def _torques(moving: bool, weight: bool, states: JudgedStates, by: Differences) -> Array:
    """C v + g; the velocity terms and gravity by differences, or one of them."""
    v = states.v
    bias = _values("bias_torque", states)
    gravity = _values("gravity_torque", states) if moving != weight or moving else bias
    terms = np.einsum("nij,nj->ni", _coriolis(states, {}, by), v) if moving else bias - gravity
    return terms + (_derivative("potential_energy", "q", states, {}, by) if weight else gravity)


def _bias(moving: bool, weight: bool, states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    return _torques(moving, weight, states, by)


def _inverse_dynamics(moving: bool, weight: bool, states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    right = _values("inverse_dynamics", states) - _values("bias_torque", states)
    return right + _torques(moving, weight, states, by)


def _forward_dynamics(moving: bool, weight: bool, states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    more = _torques(moving, weight, states, by) - _values("bias_torque", states)
    return _values("forward_dynamics", states) - np.linalg.solve(states.mass, more[..., None])[..., 0]


Turning = Callable[[Array, Array, Array], Array]
"""Rotations at both ends and at the state (…, 3, 3) → the difference of the rotations as vectors (…, 3)."""


def _by_vector(there: Array, back: Array, here: Array) -> Array:
    turn = there @ np.swapaxes(back, -1, -2)
    found: Array = Rotation.from_matrix(turn.reshape(-1, 3, 3)).as_rotvec().reshape(*turn.shape[:-2], 3)
    return found


def _by_entries(skew: bool, there: Array, back: Array, here: Array) -> Array:
    """Entries of Ṙ Rᵀ: the mean of both triangles, or the lower one and (1, 3)."""
    turn = (there - back) @ np.swapaxes(here, -1, -2)
    if skew:
        turn = (turn - np.swapaxes(turn, -1, -2)) / 2
    return np.stack([turn[..., 2, 1], turn[..., 0, 2], turn[..., 1, 0]], axis=-1)


TURNINGS: tuple[Turning, ...] = (_by_vector, partial(_by_entries, True), partial(_by_entries, False))


def _twist(turning: Turning, jacobian: bool, states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    """The Jacobian (N, 6, n), or the velocity (N, 6), from placements."""
    here = _values("frame_placement", states)
    size, n = states.q.shape
    rows = np.repeat(np.arange(size), n) if jacobian else np.arange(size)
    ways = by.step * (np.tile(np.eye(n), (size, 1)) if jacobian else states.v)
    there, back = (_values("frame_placement", states.rows(rows), q=states.q[rows] + end * ways) for end in by.ends())
    rotation, position = here[rows, :3, :3], here[rows, :3, 3]
    omega = turning(there[:, :3, :3], back[:, :3, :3], rotation)
    twist = np.stack([there[:, :3, 3] - back[:, :3, 3], omega], axis=1) / (by.step * (2 if by.central else 1))
    if chosen["reference"] == "local":
        twist = np.einsum("kba,khb->kha", rotation, twist)
    elif chosen["reference"] == "world":
        twist[:, 0] += np.cross(position, twist[:, 1])
    flat = twist.reshape(len(twist), 6)
    return (
        linear_first(np.swapaxes(flat.reshape(size, n, 6), 1, 2), chosen, -2)
        if jacobian
        else linear_first(flat, chosen)
    )


def _jacobian_derivative(along: bool, states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    """Along the motion, or as the sum of the derivatives in every joint."""

    def jacobian(q: Array, rows: NDArray[np.intp]) -> Array:
        return _values("frame_jacobian", states.rows(rows), chosen, q=q)

    if along:
        return by.in_time(jacobian, states.q, states.v)
    found: Array = np.einsum("n...k,nk->n...", by.of(jacobian, states.q), states.v)
    return found


def _acceleration(from_jacobian: bool, states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    """J a and J̇ v by differences, or differences of velocities. What is right adds what differs by convention."""
    reading = {name: way for name, way in chosen.items() if name != "acceleration"}
    right = FUNCTIONS["frame_acceleration"].of_graphdyn(states, chosen)
    exact = _values("frame_jacobian_derivative", states, reading)
    if from_jacobian:
        moved = _jacobian_derivative(True, states, reading, by) - exact
        more: Array = np.einsum("nij,nj->ni", moved, states.v)
        return right + more
    both = np.concatenate([states.q, states.v], axis=1)
    rate = np.concatenate([states.v, states.a], axis=1)
    n = states.q.shape[1]

    def velocity(x: Array, rows: NDArray[np.intp]) -> Array:
        return _values("frame_velocity", states.rows(rows), reading, q=x[:, :n], v=x[:, n:])

    jacobian = _values("frame_jacobian", states, reading)
    smooth = np.einsum("nij,nj->ni", exact, states.v) + np.einsum("nij,nj->ni", jacobian, states.a)
    found: Array = right + by.in_time(velocity, both, rate) - smooth
    return found


def _in_time(name: str, states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    return by.in_time(lambda q, rows: _values(name, states.rows(rows), q=q), states.q, states.v)


def _by_parameters(states: JudgedStates, chosen: Chosen, by: Differences) -> Array:
    """∂a/∂π (N, n, 10 n), one model per parameter."""
    parameters = states.model.inertial_parameters.ravel()
    columns = []
    for k, own in enumerate(parameters):
        step = by.step * ((-1.0 if own < 0 else 1.0) * max(1.0, abs(own)) if by.relative else 1.0)
        ends = []
        for end in by.ends():
            changed = parameters.copy()
            changed[k] += end * step
            ends.append(
                _values("forward_dynamics", states)
                if not end
                else FUNCTIONS["forward_dynamics"].of_graphdyn(
                    _of_model(states, states.model.with_inertial_parameters(changed)), {}
                )
            )
        columns.append((ends[0] - ends[1]) / (step * (2 if by.central else 1)))
    return np.stack(columns, axis=-1)


def _of_model(states: JudgedStates, model: object) -> JudgedStates:
    return states.but(model=model)  # type: ignore[arg-type]


PARTS = ((True, False), (False, True), (True, True))
"""Whether the velocity terms, and gravity, are found by differences."""


def forms(name: str) -> Iterator[Form]:
    """The ways in which a function is computed by differences; none for functions that are not."""
    if name in DERIVED_FROM:
        yield partial(_derivative, *DERIVED_FROM[name])
    yield from OTHER_FORMS.get(name, ())


DERIVED_FROM: Mapping[str, tuple[str, str]] = {
    **{f"dtau_d{x}": ("inverse_dynamics", x) for x in "qv"},
    **{f"da_d{x}": ("forward_dynamics", x) for x in "qv"},
    **{f"dwrenches_d{x}": ("joint_wrenches", x) for x in "qva"},
    **{f"dmultipliers_d{x}": ("multipliers", x) for x in "qva"},
    "center_of_mass_jacobian": ("center_of_mass", "q"),
    "gravity_torque": ("potential_energy", "q"),
    "mass_matrix": ("inverse_dynamics", "a"),
    "mass_matrix_inverse": ("forward_dynamics", "tau"),
}
"""Functions that are derivatives: of which function, in which argument."""

OTHER_FORMS: Mapping[str, tuple[Form, ...]] = {
    "coriolis_matrix": (_coriolis,),
    "bias_torque": tuple(partial(_bias, *parts) for parts in PARTS),
    "inverse_dynamics": tuple(partial(_inverse_dynamics, *parts) for parts in PARTS),
    "forward_dynamics": tuple(partial(_forward_dynamics, *parts) for parts in PARTS),
    "frame_jacobian": tuple(partial(_twist, turning, True) for turning in TURNINGS),
    "frame_velocity": tuple(partial(_twist, turning, False) for turning in TURNINGS),
    "frame_jacobian_derivative": (partial(_jacobian_derivative, True), partial(_jacobian_derivative, False)),
    "frame_acceleration": (partial(_acceleration, False), partial(_acceleration, True)),
    "center_of_mass_velocity": (partial(_in_time, "center_of_mass"),),
    "forward_dynamics_parameter_derivatives": (_by_parameters,),
}
"""Forms of functions that are not derivatives of another one entry by entry."""
