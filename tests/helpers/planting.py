"""Errors planted on purpose, on either side of the comparison, and what has to be noticed."""

import dataclasses
import pickle
from collections.abc import Callable

import numpy as np
from random_trees import random_tree

import crosscheck
from crosscheck.comparing import compare as comparing
from crosscheck.quantities import answers, quantities
from crosscheck.reference.pinocchio_model import PinocchioModel
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


def _remembered(function: Callable) -> Callable:
    """The function, computed once for each content of its arguments."""
    known = {}

    def answer(*arguments, **options):
        key = pickle.dumps((arguments, options))
        if key not in known:
            known[key] = function(*arguments, **options)
        return known[key]

    return answer


OUR_ANSWERS = {
    name: _remembered(getattr(comparing, name)) for name in ("passive_answers", "forward_answers", "derived_answers")
}


def remember_our_answers(patch) -> None:
    """Let our side answer the same question once, however often a robot is compared."""
    for name, answer in OUR_ANSWERS.items():
        patch.setattr(comparing, name, answer)


class Plant:
    """Puts one error into a function that the comparison calls, until the test ends."""

    def __init__(self, monkeypatch):
        self._patch = monkeypatch

    def _in_the_referee(self, name: str, function: object) -> None:
        """Put the function into Pinocchio's side, which leaves our answers as they are: they are computed once."""
        self._patch.setattr(PinocchioModel, name, function)
        remember_our_answers(self._patch)

    def referee_value(self, field: str, change: Callable[[float], float]) -> dict:
        """Change the largest entry of one field of RefereeValues, in the last state of the first call of evaluate.

        Returns a dictionary that holds q of that state once the comparison has run.
        """
        original, planted = PinocchioModel.evaluate, {}

        def evaluate(referee, q, v, a, tau, external_wrenches):
            values = original(referee, q, v, a, tau, external_wrenches)
            if planted:
                return values
            planted["q"] = tuple(q[-1].tolist())
            return dataclasses.replace(values, **{field: _changed(getattr(values, field), change)})

        self._in_the_referee("evaluate", evaluate)
        return planted

    def referee_torque(self, function: str, change: Callable[[float], float]) -> dict:
        """Change the largest torque that this function of Pinocchio gives in the last state of its first call.

        Returns a dictionary that holds q of that state once the comparison has run.
        """
        original, planted = PinocchioModel.joint_torques, {}

        def joint_torques(referee, name, q, *rates):
            torques = original(referee, name, q, *rates)
            if name != function or planted:
                return torques
            planted["q"] = tuple(q[-1].tolist())
            return _changed(torques, change)

        self._in_the_referee("joint_torques", joint_torques)
        return planted

    def referee_derived(self, name: str, change: Callable[[float], float]) -> None:
        """Change the largest entry of one of the values of derive or derive_twice, in the last state."""
        for function in ("derive", "derive_twice"):
            self._in_the_referee(function, _with_changed(getattr(PinocchioModel, function), name, change))

    def referee_required(self, loaded: bool, change: Callable[[float], float]) -> None:
        """Change the largest torque that rnea needs for our accelerations, with or without external wrenches."""
        original = PinocchioModel.inverse_dynamics

        def inverse_dynamics(referee, q, v, a, *external):
            torques, wrenches = original(referee, q, v, a, *external)
            return (_changed(torques, change) if bool(external) == loaded else torques), wrenches

        self._in_the_referee("inverse_dynamics", inverse_dynamics)

    def referee_frames(self, which: int, change: Callable[[float], float]) -> None:
        """Change the largest entry of the frames' rotations (0) or positions (1)."""
        original = PinocchioModel.frame_placements

        def frame_placements(referee, q, names):
            placements = list(original(referee, q, names))
            placements[which] = _changed(placements[which], change)
            return tuple(placements)

        self._in_the_referee("frame_placements", frame_placements)

    def referee_model(self, change: Callable[[RobotModel], RobotModel]) -> None:
        """Pinocchio is built from a changed robot."""
        original = PinocchioModel.from_model
        self._in_the_referee("from_model", staticmethod(lambda model: original(change(model))))

    def referee_gravity(self, factor: float) -> None:
        """Pinocchio computes under another gravity."""
        original = PinocchioModel.turned
        self._in_the_referee("turned", lambda self, base, gravity: original(self, base, factor * gravity))

    def referee_regressor(self, change: Callable[[np.ndarray], np.ndarray]) -> None:
        """Pinocchio's regressor of the baseline identification; the one of evaluate stays."""
        original = PinocchioModel.torque_regressor
        self._in_the_referee("torque_regressor", lambda *arguments: change(original(*arguments)))

    def projected_accelerations(self, factor: float) -> None:
        """Our forward dynamics in the null space are off; the others are right."""
        self._accelerations("projected", factor)

    def recursive_accelerations(self, factor: float) -> None:
        """Those by recursion are off."""
        self._accelerations("recursive", factor)

    def _accelerations(self, wrong: str, factor: float) -> None:
        original = answers.forward_dynamics

        def forward_dynamics(*arguments, method="projected"):
            answer = original(*arguments, method=method)
            return dataclasses.replace(answer, a=answer.a * factor) if method == wrong else answer

        self._patch.setattr(answers, "forward_dynamics", forward_dynamics)

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

    def in_quantities(self, name: str, replacement: Callable) -> None:
        """Replace a function that crosscheck.quantities.quantities calls."""
        self._patch.setattr(quantities, name, replacement)


def _with_changed(original: Callable[..., dict], name: str, change: Callable[[float], float]) -> Callable[..., dict]:
    def changed(*arguments):
        return {key: _changed(x, change) if key == name else x for key, x in original(*arguments).items()}

    return changed


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
