"""The answers that a function under test would give without rounding, and how far they move with their inputs."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.exact import (
    HALF_ULP,
    PLACEMENT,
    ExactArray,
    Truth,
    exact_placements,
    exact_values,
    half_ulp_effects,
    half_ulp_of_placements,
)
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import LOADS, Quantity
from crosscheck.quantities.measures import Chosen, linear_first
from crosscheck.quantities.scales import PARAMETER_TYPES, largest, ratio
from crosscheck.reference.subject import Subject
from graphdyn.layout import ANGULAR, BODY_PARAMETERS, Array
from graphdyn.verbs import VERBS

PROVEN_DIGITS = 30
"""Digits of exact values beside doubles: small numbers beside large ones still have more than doubles."""

_ONLY = {"axes": "link", "actuator": "included", "matrix": "of the Christoffel symbols", "about": "the center of mass"}
"""Conventions that exact values are computed in; others of these names have none."""

_AT_REST: Mapping[str, Callable[[JudgedStates], Array]] = {
    "inverse_dynamics": lambda states: largest(states.wrenches),
    "bias_torque": lambda states: states.largest_wrench(states.v),
    "gravity_torque": lambda states: states.largest_wrench(0 * states.v),
    "static_torque": lambda states: states.largest_wrench(0 * states.v, states.all_loads),
}
"""The largest joint wrench of each function whose errors are relative to it (N,)."""


@dataclass(frozen=True, eq=False)
class ExactAnswers:
    """A function of the table in the conventions that are chosen. robot: as it was read; states: of its tree"""

    known: Quantity
    chosen: Chosen
    robot: Subject

    @property
    def refusal(self) -> str | None:
        """Why there are no exact values; None where there are."""
        if not has_exact_values(self.known):
            return "it has no exact values"
        others = [f"{name}: {way}" for name, way in self.chosen.items() if _ONLY.get(name, way) != way]
        if self.chosen.get("zero") == "elsewhere":
            others.append("zero: elsewhere")
        return f"there are no exact values in the convention {others[0]}" if others else None

    @property
    def truths(self) -> tuple[Truth, ...]:
        """Truths that the function may mean: of a file also the model that was read from it."""
        return ("model",) if self.robot.file is None else ("file", "model")

    def at(self, states: JudgedStates, truth: Truth, digits: int = PROVEN_DIGITS) -> ExactArray:
        """The exact answers (N, …)."""
        source: Any = states.model
        options = self._options(states)
        if truth == "file":
            source = self.robot.name
            options["reading"] = replace(self.robot.reading, mimic=_independent(self.robot))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # reading the file has warned before
            if self._is_placement:
                return exact_placements(source, states.q, digits=digits, truth=truth, **options)
            found = exact_values(source, self._verb, *self._inputs(states), digits=digits, truth=truth, **options)
        array = found[self.known.ours.output]
        return replace(array, balls=self._as_chosen(array.balls))

    def caused(self, states: JudgedStates) -> Array:
        """What half an ulp of all inputs causes (N, …)."""
        output, options = self.known.ours.output, self._options(states)
        if self._is_placement:
            return half_ulp_of_placements(states.model, states.q, **options)
        found = half_ulp_effects(states.model, self._verb, output, *self._inputs(states), **options)
        caused: Array = np.abs(self._as_chosen(found + self._of_mass_matrix(states)))
        return caused

    def of_summed_terms(self, exact: Array, states: JudgedStates) -> Array:
        """What half an ulp of the summed terms causes, for each group (N, g): the scale of the cross-check.

        exact: the answers (N, …)

        Where terms cancel, as where one joint moves alone, inputs cause less than the rounding of each term. Of kinetic
        energies half an ulp counts once for each body: they do not depend on the turns from link to link, which round
        the velocities of codes in world axes. Functions that solve have what rounding of M causes in place of it.
        """
        groups, flat = self.groups(states), exact.reshape(len(exact), -1)
        number = groups.max() + 1
        if self.known.solves:
            return np.zeros((len(exact), number))
        sizes = []
        for k in range(number):
            step = np.abs(flat[:, groups == k]).max(axis=1) + 1.0  # far above the rounding of a sum
            moved = (flat + step[:, None] * (groups == k)).reshape(exact.shape)
            sizes.append(ratio(step, self.known.errors(moved, exact, states, self.chosen)))
        turns = states.model.n_bodies if self.known.name.startswith("kinetic_energy") else 1
        found: Array = turns * HALF_ULP * np.stack(sizes, axis=1)
        return found

    def _of_mass_matrix(self, states: JudgedStates) -> Array | float:
        """What half an ulp of the entries of M causes in a solution of M x = b, for most codes round M before they
        solve: ∣M⁻¹∣ ∣δM∣ ∣x∣, half an ulp of the largest entry of M for each entry of δM."""
        if not self.known.solves:
            return 0.0
        x = np.abs(self.known.of_graphdyn(states, self.chosen))
        inverse = np.abs(np.linalg.inv(states.mass)).sum(axis=-1)
        moved = HALF_ULP * largest(states.mass)[:, None] * inverse
        found: Array = np.einsum("ki,k...->ki...", moved, x.sum(axis=1))
        return found

    def groups(self, states: JudgedStates) -> NDArray[np.intp]:
        """Which entries of an answer are of one kind, numbered (…): forces, moments; rotation, position; columns by
        type of parameter."""
        shape = tuple(size or 0 for size in self.known.shape_for(states.model.n_bodies))
        found = np.zeros(shape, dtype=np.intp)
        if self.known.name.startswith("dwrenches"):
            found[:, ANGULAR] = 1
        elif self._is_placement:
            found[:3, 3] = 1
        elif "order" in self.known.conventions:
            np.moveaxis(found, self.known.six, -1)[..., ANGULAR] = 1
        elif shape and shape[-1] % BODY_PARAMETERS == 0 and self.known.shape[-1] in ("10 n", BODY_PARAMETERS):
            for number, part in enumerate(PARAMETER_TYPES):
                found.reshape(*shape[:-1], -1, BODY_PARAMETERS)[..., part] = number
        return self._ordered(found).ravel()

    def sizes(self, exact: Array, states: JudgedStates) -> Array:
        """What errors are relative to, for each group (N, g). exact: the answers (N, …)"""
        if self.known.name in _AT_REST:
            return _AT_REST[self.known.name](states)[:, None]
        return largest_of_groups(exact, self.groups(states))

    @property
    def scale(self) -> str:
        """What errors are relative to, in words."""
        return "the largest joint wrench" if self.known.name in _AT_REST else "the largest entry"

    @property
    def _is_placement(self) -> bool:
        """Whether it is the function that is none of the verbs."""
        return self.known.name == PLACEMENT

    @property
    def _verb(self) -> str:
        """The short form of inverse and forward dynamics, which computes nothing beside."""
        return {"tau": "joint_torques", "a": "joint_accelerations"}.get(self.known.ours.output, self.known.ours.verb)

    def _inputs(self, states: JudgedStates) -> list[Array]:
        """Zero velocities of functions of positions alone, whose verb has others beside."""
        given = {name: getattr(states, name) for name in VERBS[self._verb].inputs}
        return [x if name in self.known.arguments else 0 * x for name, x in given.items()]

    def _options(self, states: JudgedStates) -> dict[str, Any]:
        found = dict(self.known.ours.options(self.chosen))
        if self.known.of_frame:
            found["frame"] = states.frame
        if LOADS in self.known.called_with(states.loads is not None):
            found[LOADS] = states.all_loads
        return found

    def _as_chosen(self, answer: NDArray[Any]) -> NDArray[Any]:
        return self._ordered(-answer if self.chosen.get("acts on") == "the inside body" else answer)

    def _ordered(self, answer: NDArray[Any]) -> NDArray[Any]:
        return linear_first(answer, self.chosen, self.known.six) if answer.ndim else answer


def largest_of_groups(values: Array, groups: NDArray[np.intp]) -> Array:
    """The largest absolute value of each group (N, g). values: (N, …); groups: as ExactAnswers numbers them"""
    flat = np.abs(values).reshape(len(values), -1)
    return np.stack([flat[:, groups == k].max(axis=1) for k in range(groups.max() + 1)], axis=1)


def has_exact_values(known: Quantity) -> bool:
    return "p" not in known.shape and (known.ours.verb in VERBS or known.name == PLACEMENT)


def _independent(robot: Subject) -> Any:
    return "independent" if robot.model.couplings else robot.reading.mimic
