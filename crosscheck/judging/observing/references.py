"""The reference implementations, which answer every function of the table as far as they have it.

Where several conventions are right, the answers of a function under test show which of them it follows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import graphdyn
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import Quantity
from crosscheck.quantities.measures import Chosen
from crosscheck.quantities.scales import backward_error
from crosscheck.reference.mujoco_model import MujocoModel, MujocoRefuses
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from graphdyn import InvalidInput
from graphdyn.layout import Array

BACKWARD_SCALE = "largest of τ, the joint wrenches, the external wrenches and ∣M∣ ∣a∣"


class References:
    """The reference implementations ("references") at the judged states.

    mujoco: None where MuJoCo is not one of them
    """

    def __init__(self, states: JudgedStates, mujoco: MujocoModel | None):
        self.states, self._mujoco = states, mujoco

    @classmethod
    def of(cls, states: JudgedStates, notes: list[str] | None = None) -> References:
        """All that can represent the robot and are installed. notes: gets a note about MuJoCo if it is left out"""
        try:
            return cls(states, MujocoModel(states.model))
        except MujocoRefuses as refusal:
            if notes is not None:
                notes.append(f"MuJoCo is not among the reference implementations: {refusal}")
            return cls(states, None)

    def at(self, selected: NDArray[np.bool_]) -> References:
        """The references at some of the states (N,)."""
        return self if selected.all() else References(self.states.rows(selected), self._mujoco)

    @cached_property
    def pinocchio(self) -> PinocchioAnswers:
        """Pinocchio's answers; the frame is one of its own, also where it is a body."""
        states, model, frame = self.states, self.states.model, None
        if states.frame is not None:
            chosen = model.frame(states.frame)
            frame = f"{chosen.name}, judged"
            model = replace(model, frames=(replace(chosen, name=frame, aliases=()),))
        robot = PinocchioModel.from_model(model)
        return PinocchioAnswers(robot, model, states.q, states.v, states.a, states.tau, states.loads, frame)

    def _has(self, function: Quantity) -> bool:
        """Whether Pinocchio has an answer: it has no motion of what is fixed in the ground."""
        states = self.states
        in_motion = function.of_frame and "reference" in function.conventions
        return not in_motion or (states.frame is not None and states.model.frame(states.frame).body > 0)

    @cached_property
    def _mujoco_answers(self) -> dict[str, Array]:
        assert self._mujoco is not None
        states = self.states
        return self._mujoco.evaluate(states.q, states.v, states.a, states.tau)

    def answers(self, function: Quantity, chosen: Chosen, ours: Array) -> dict[str, Array]:
        """Answers by name of the reference implementation, of those that have the function. ours: graphdyn's."""
        found = {"graphdyn": ours}
        if self._has(function):
            found["pinocchio"] = function.of_pinocchio(self.pinocchio, self.states, chosen)
        if function.mujoco is not None and self._mujoco is not None and self.states.loads is None:
            found["mujoco"] = self._mujoco_answers[function.mujoco]
        return found

    def required(self, reference: str) -> Callable[[Array], Array]:
        """Torques of accelerations (N, n) by one reference implementation."""
        states = self.states
        if reference == "pinocchio":
            return lambda a: self.pinocchio.required(a)[0]
        if reference == "mujoco":
            assert self._mujoco is not None
            mujoco = self._mujoco
            return lambda a: mujoco.evaluate(states.q, states.v, a, states.tau)["inverse_dynamics"]
        return lambda a: graphdyn.inverse_dynamics(states.model, states.q, states.v, a, states.loads).tau


def backward_errors(answer: Array, required: Callable[[Array], Array], states: JudgedStates) -> Array:
    """Backward errors (N,) of accelerations (N, n): how far the torques that they need are from the given ones.

    required: torques of accelerations, by a reference implementation
    Accelerations that are not finite count as infinitely wrong.
    """
    model, q, v, tau = states.model, states.q, states.v, states.tau
    finite = np.all(np.isfinite(answer), axis=-1, keepdims=True)
    a = np.where(finite, answer, 0.0)
    wrenches = graphdyn.inverse_dynamics(model, q, v, a, states.loads).joint_wrenches
    external = () if states.loads is None else (states.loads,)
    errors = backward_error(required(a), tau, wrenches, states.mass, a, *external)
    return np.where(finite[:, 0] & np.isfinite(errors), errors, np.inf)


@dataclass(frozen=True)
class FoundConventions:
    """How the answers of a function are read.

    chosen: the way that fits best
    fits: whether most answers agree when read like this
    said: what is found out for the reader, "link or world" where both fit; empty if none fits
    ours: graphdyn's answers, read as chosen                (N, …)
    """

    chosen: Chosen
    fits: bool
    said: Mapping[str, str]
    ours: Array


def found_conventions(
    function: Quantity, answer: Array, states: JudgedStates, declared: Chosen, tolerance: float
) -> FoundConventions:
    """The conventions with which most answers agree with graphdyn's; else those that are nearest to them.

    answer: (N, …); declared: conventions that are known
    """
    readings = list(function.readings(declared))
    ours = [function.of_graphdyn(states, chosen) for chosen in readings]
    errors = [relative_errors(function, answer, x, states, chosen) for x, chosen in zip(ours, readings, strict=True)]
    deviating = np.array([(error > tolerance).sum() for error in errors])
    middle = np.array([np.median(error) for error in errors])
    best = int(np.lexsort((middle, deviating))[0])
    if middle[best] > tolerance:
        return FoundConventions(readings[best], False, {}, ours[best])
    first = int(np.flatnonzero(deviating == deviating[best])[0])
    as_good = [chosen for chosen, count in zip(readings, deviating, strict=True) if count == deviating[best]]
    said = {
        name: " or ".join(way for way in ways if any(chosen[name] == way for chosen in as_good))
        for name, ways in function.conventions.items()
    }
    said |= {name: readings[first][name] for name in function.widening}
    return FoundConventions(readings[first], True, said, ours[first])


def relative_errors(function: Quantity, answer: Array, reference: Array, states: JudgedStates, chosen: Chosen) -> Array:
    """Relative errors (N,) on the scale of the function; entries that are not finite count as infinite.

    Where the reference vanishes, as velocities at rest do, and its scale with it, the scale is its usual size.
    """
    errors = function.judged_by(answer, reference, states, chosen)
    errors = np.where(np.isfinite(errors), errors, np.inf)
    size = np.abs(reference.reshape(len(errors), -1)).max(axis=1)
    vanishing = (size == 0) & np.isinf(errors)
    if vanishing.any() and (size > 0).any():
        left = np.abs(answer.reshape(len(errors), -1)).max(axis=1) / np.median(size[size > 0])
        errors = np.where(vanishing & np.isfinite(left), left, errors)
    return errors


def check_declared(declared: Chosen, functions: list[Quantity]) -> None:
    """Raise InvalidInput for a convention that no judged function has, or a way that it does not know."""
    known: dict[str, tuple[str, ...]] = {}
    for function in functions:
        known.update(function.conventions)
    for name, way in declared.items():
        if name not in known:
            raise InvalidInput(
                f"convention {name!r} belongs to none of the functions to judge; they have {', '.join(known) or 'none'}"
            )
        if way not in known[name]:
            raise InvalidInput(f"convention {name!r} is {way!r}; give one of {', '.join(map(repr, known[name]))}")
