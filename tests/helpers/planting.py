"""Errors planted on purpose, on either side of the comparison, and what has to be noticed."""

import dataclasses
import pickle
from collections.abc import Callable
from functools import cached_property

import numpy as np
from random_trees import random_tree

import crosscheck
import graphdyn
from crosscheck.comparing import compare as comparing
from crosscheck.comparing.compared_states import ComparedStates
from crosscheck.quantities import QUANTITIES, system
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from graphdyn import RobotModel
from graphdyn.equations.system.kkt import KKTSystem

SEED = 3
SAMPLES = 2
"""Enough to tell one sample from another."""

PLANTED = 1e-9
"""A planted error, as a part of the value: far above rounding, and far below what one would notice."""


def mixed_tree() -> RobotModel:
    return random_tree(7, [0, 1, 1], ["revolute", "prismatic", "continuous"])


def compared(robot) -> crosscheck.Comparison:
    return crosscheck.compare(robot, SAMPLES, SEED)


def flagged(comparison: crosscheck.Comparison) -> set[str]:
    """Names of the quantities that disagree."""
    return {name for name, result in comparison.quantities.items() if not result.agrees}


KNOWN: dict[tuple, object] = {}


def _remembered(states, verb, method="auto", *, loaded=False, **options):
    """What graphdyn answers, computed once for each content of the arguments."""
    arrays = (states.q, states.v, states.a, states.tau, states.loads)
    content = states.once("content", lambda: pickle.dumps((states.model, arrays)))
    key = (content, verb, method, loaded, *sorted(options.items()))
    if key not in KNOWN:
        KNOWN[key] = ANSWER(states, verb, method, loaded=loaded, **options)
    return KNOWN[key]


ANSWER = ScaledStates.answer


def remember_our_answers(patch) -> None:
    """Let our side answer the same question once, however often a robot is compared."""
    patch.setattr(ScaledStates, "answer", _remembered)


class _Told:
    """A table of errors that also writes down what it is told."""

    def __init__(self, record):
        self.record, self.calls = record, []

    def __getattr__(self, name):
        def told(*arguments):
            self.calls.append((name, arguments))
            return getattr(self.record, name)(*arguments)

        return told


def _remembered_chunk(record, chunk, pinocchio_models, **options):
    """The errors at these states, computed once for each robot, as graphdyn and as Pinocchio have it."""
    natives = {route: pinocchio.native for route, pinocchio in pinocchio_models.items()}
    key = pickle.dumps((chunk, natives, options))
    if key not in KNOWN:
        told = _Told(record)
        CHUNK(told, chunk, pinocchio_models, **options)
        KNOWN[key] = told.calls
        return
    for name, arguments in KNOWN[key]:
        getattr(record, name)(*arguments)


def _remembered_identification(model, pinocchio, seed):
    key = pickle.dumps((model, pinocchio.native, seed))
    if key not in KNOWN:
        KNOWN[key] = IDENTIFICATION(model, pinocchio, seed)
    return KNOWN[key]


CHUNK, IDENTIFICATION = comparing._compare_chunk, comparing.compare_identification


def remember_comparisons(patch) -> None:
    """Compare the same robot at the same states once, for tests of what is said of it. Where an error is planted, each
    is compared."""
    patch.setattr(comparing, "_compare_chunk", _remembered_chunk)
    patch.setattr(comparing, "compare_identification", _remembered_identification)


class Plant:
    """Puts one error into a function that the comparison calls, until the test ends."""

    def __init__(self, monkeypatch):
        self._patch = monkeypatch
        monkeypatch.setattr(comparing, "_compare_chunk", CHUNK)
        monkeypatch.setattr(comparing, "compare_identification", IDENTIFICATION)

    def _in_the_pinocchio(self, place: object, name: str, function: object) -> None:
        """Put the function into Pinocchio's side, which leaves our answers as they are: they are computed once."""
        self._patch.setattr(place, name, function)
        remember_our_answers(self._patch)

    def pinocchio_value(self, field: str, change: Callable[[float], float]) -> None:
        """Change the largest entry of one field of PinocchioAnswers, of the last state, where it is first asked for."""
        original, planted = getattr(PinocchioAnswers, field), []
        answer = original.func if isinstance(original, cached_property) else original.fget

        def value(there):
            planted.append(there)
            return _changed(answer(there), change) if there is planted[0] else answer(there)

        self._in_the_pinocchio(PinocchioAnswers, field, property(value))

    def pinocchio_quantity(self, name: str, change: Callable[[float], float], loaded: bool = False) -> dict:
        """Change the largest entry of Pinocchio's answer for a quantity, in the last of the first states.

        loaded: with external wrenches. Returns a dictionary that holds q of that state once the comparison has run.
        """
        row, planted = QUANTITIES[name], {}
        original = row.pinocchio

        def answer(there, chosen):
            values = original(there, chosen)
            if (there.loads is not None) != loaded or planted.setdefault("there", there) is not there:
                return values
            planted["q"] = tuple(there.q[-1].tolist())
            return _changed(values, change)

        self._patch.setitem(row.__dict__, "pinocchio", answer)
        remember_our_answers(self._patch)
        return planted

    def pinocchio_reference(self, reference: str, factor: float) -> set[str]:
        """Multiply Pinocchio's answers of frames in one reference. Returns the names of all that have a reference."""
        rows = [row for row in QUANTITIES.values() if "reference" in row.conventions]
        for row in rows:

            def answer(there, chosen, original=row.pinocchio):
                return original(there, chosen) * (factor if chosen["reference"] == reference else 1.0)

            self._patch.setitem(row.__dict__, "pinocchio", answer)
        remember_our_answers(self._patch)
        return {f"{row.name}{form.suffix}" for row in rows for form in row.forms}

    def pinocchio_required(self, loaded: bool, change: Callable[[float], float]) -> None:
        """Change the largest torque that rnea needs for our accelerations, with or without external wrenches."""
        original = ComparedStates.required

        def required(states, a):
            torques, wrenches = original(states, a)
            return (_changed(torques, change) if (states.loads is not None) == loaded else torques), wrenches

        self._in_the_pinocchio(ComparedStates, "required", required)

    def pinocchio_frames(self, which: int, change: Callable[[float], float]) -> None:
        """Change the largest entry of the frames' rotations (0) or positions (1)."""
        original = PinocchioModel.frame_placements

        def frame_placements(pinocchio, q, names):
            placements = list(original(pinocchio, q, names))
            placements[which] = _changed(placements[which], change)
            return tuple(placements)

        self._in_the_pinocchio(PinocchioModel, "frame_placements", frame_placements)

    def pinocchio_model(self, change: Callable[[RobotModel], RobotModel]) -> None:
        """Pinocchio is built from a changed robot."""
        original = PinocchioModel.from_model
        self._in_the_pinocchio(PinocchioModel, "from_model", staticmethod(lambda model: original(change(model))))

    def pinocchio_gravity(self, factor: float) -> None:
        """Pinocchio computes under another gravity."""
        original = PinocchioModel.turned
        self._in_the_pinocchio(
            PinocchioModel, "turned", lambda self, base, gravity: original(self, base, factor * gravity)
        )

    def pinocchio_regressor(self, change: Callable[[np.ndarray], np.ndarray]) -> None:
        """Pinocchio's regressor of the baseline identification; the one of evaluate stays."""
        original = PinocchioModel.torque_regressor
        self._in_the_pinocchio(PinocchioModel, "torque_regressor", lambda *arguments: change(original(*arguments)))

    def projected_accelerations(self, factor: float) -> None:
        """Our forward dynamics in the null space are off; the others are right."""
        self._accelerations("projected", factor)

    def recursive_accelerations(self, factor: float) -> None:
        """Those by recursion are off."""
        self._accelerations("recursive", factor)

    def _accelerations(self, wrong: str, factor: float) -> None:
        original = graphdyn.forward_dynamics

        def forward_dynamics(*arguments, method="projected"):
            answer = original(*arguments, method=method)
            return dataclasses.replace(answer, a=answer.a * factor) if method == wrong else answer

        self._patch.setattr(graphdyn, "forward_dynamics", forward_dynamics)

    def dense_solution(self, acceleration: float = 1.0, multipliers: float = 1.0) -> None:
        """The solution of Eq. (111) is off by these factors."""
        original = KKTSystem.solve_unchecked

        def solve_unchecked(system):
            answer = original(system)
            return dataclasses.replace(
                answer,
                acceleration=answer.acceleration * acceleration,
                stacked_multipliers=answer.stacked_multipliers * multipliers,
            )

        self._patch.setattr(KKTSystem, "solve_unchecked", solve_unchecked)

    def in_system(self, name: str, replacement: Callable) -> None:
        """Replace a function that crosscheck.quantities.system calls."""
        self._patch.setattr(system, name, replacement)


def _changed(values: np.ndarray, change: Callable[[float], float]) -> np.ndarray:
    """The largest entry of the last sample changed."""
    values = values.copy()
    entry = (-1, *np.unravel_index(np.abs(values[-1]).argmax(), values.shape[1:]))
    values[entry] = change(values[entry])
    return values


def with_body(model: RobotModel, number: int, **changes) -> RobotModel:
    """The robot with body `number` (1 … n) changed."""
    bodies = list(model.bodies)
    bodies[number - 1] = dataclasses.replace(bodies[number - 1], **changes)
    return dataclasses.replace(model, bodies=tuple(bodies))


def with_joint(model: RobotModel, number: int, **changes) -> RobotModel:
    joints = list(model.joints)
    joints[number - 1] = dataclasses.replace(joints[number - 1], **changes)
    return dataclasses.replace(model, joints=tuple(joints))
