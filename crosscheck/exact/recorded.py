"""The recursions of graphdyn on balls: recorded with the constants of the robot as inputs, and computed in balls.

Constants that are exactly 0 or ±1 are recorded as such; none is rounded, and no frames or bodies are merged.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import isfinite
from typing import Any

import numpy as np

from crosscheck.exact.balls import ball, eye
from crosscheck.exact.robot import ExactRobot
from graphdyn import RobotModel
from graphdyn.compiler import Parts, Request, trace
from graphdyn.model import DegreesOfFreedom, parallel_axis
from graphdyn.recursions import FixedFrame, Link, Root
from graphdyn.scalars import Program, Recorder

CONSTANTS = "constants"
"""The input of a program in which the constants of the robot are."""

GROUND = "ground"
"""The input in which the motion of a base is."""


MAX_PROGRAMS = 32
"""Programs that are kept: some megabytes each, and some tenths of a second where they hold derivatives."""


@dataclass(frozen=True, eq=False)
class RecordedRequest:
    """A program, and which constants are its input.

    known: 0 or ±1 for each constant that is exactly that; None for those that are inputs, in order
    """

    program: Program
    request: Request
    known: tuple[float | None, ...]

    @property
    def divides_by_zero(self) -> bool:
        """Whether recording has divided by an inertia that is zero."""
        return any(kind == "constant" and not isfinite(rest[0]) for kind, *rest in self.program.operations)

    def constants(self, robot: ExactRobot) -> list[Any]:
        """The input CONSTANTS of a robot, at the precision of its balls."""
        return [x for x, known in zip(constants_of(robot, self.request), self.known, strict=True) if known is None]


def recorded(robot: ExactRobot, request: Request, *, all_inputs: bool = False) -> RecordedRequest:
    """The program of a request for robots with these constants, whatever their digits.

    all_inputs: constants that are exactly 0 or ±1 are inputs too
    """
    known = tuple(None if all_inputs else _known(x) for x in constants_of(robot, request))
    return RecordedRequest(_program(_Recording(robot.model.digest, request, known, robot.model)), request, known)


@dataclass(frozen=True)
class _Recording:
    """What a program depends on."""

    digest: bytes
    request: Request
    known: tuple[float | None, ...]
    model: RobotModel = field(compare=False)


@lru_cache(MAX_PROGRAMS)
def _program(recording: _Recording) -> Program:
    model, request, known = recording.model, recording.request, recording.known

    def parts(recorder: Recorder) -> Parts:
        columns = iter(recorder.inputs(CONSTANTS, known.count(None)))
        scalars = iter([next(columns) if x is None else x for x in known])

        def array(*shape: int) -> Any:
            return np.array([next(scalars) for _ in range(int(np.prod(shape)))], dtype=object).reshape(shape)

        links = [
            Link(
                inside=joint.inside - 1,
                prismatic=joint.is_prismatic,
                rotation=array(3, 3),
                translation=array(3),
                link_axes=array(3, 3),
                mass=array(1)[0],
                center_of_mass=array(3),
                first_moment=array(3),
                tensor=array(3, 3),
            )
            for joint in model.joints
        ]
        rotation, position, gravity, compensated = array(3, 3), array(3), array(3), array(3)
        at_rest = {name: np.zeros(3).astype(object) for name in ("velocity", "omega", "alpha", "acceleration")}
        root = Root(rotation=rotation, position=position, gravity=gravity, compensated=compensated, **at_rest)
        frame = None
        if request.frame is not None:
            frame = FixedFrame(model.frame(request.frame.name).body - 1, array(3, 3), array(3), request.frame)
        return Parts(tuple(links), root, _degrees_of_freedom(model, array), frame)

    return trace(model, request, parts)


def _degrees_of_freedom(model: RobotModel, array: Callable[..., Any]) -> DegreesOfFreedom:
    """What the couplings leave free, as scalars. array: the next ones, in this shape"""
    known = model.degrees_of_freedom
    if not model.couplings:
        return known
    shapes = known.matrix.shape, known.offset.shape, known.reactions.shape
    matrix, offset, reactions = (array(*shape) for shape in shapes)
    return replace(known, matrix=matrix, offset=offset, reactions=reactions)


def evaluate(program: Program, inputs: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
    """The outputs of a program, by name, for one state in balls."""
    values: list[Any] = []
    for operation in program.operations:
        kind, first = operation[0], operation[1]
        if kind in _OF_TWO:
            values.append(_OF_TWO[kind](values[first], values[operation[2]]))
        elif kind == "input":
            values.append(inputs[first][operation[2]])
        elif kind == "constant":
            values.append(ball(first))
        else:
            values.append(_OF_ONE[kind](values[first]))
    return {name: [values[k] for k in numbers] for name, numbers in program.outputs.items()}


_OF_TWO: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}
_OF_ONE: dict[str, Callable[[Any], Any]] = {
    "negate": operator.neg,
    "sine": operator.methodcaller("sin"),
    "cosine": operator.methodcaller("cos"),
}


def constants_of(robot: ExactRobot, request: Request) -> list[Any]:
    """All constants of Link, Root, FixedFrame and DegreesOfFreedom, one after the other, in joint axes."""
    found: list[Any] = []
    axes = [eye(), *(body.joint_axes for body in robot.bodies)]
    for body, own in zip(robot.bodies, axes[1:], strict=True):
        inside, center = axes[body.inside], own.T @ body.center_of_mass
        about_origin = own.T @ body.tensor @ own + parallel_axis(body.mass, center)
        found += [
            *(inside.T @ body.placement.rotation @ own).ravel(),
            *(inside.T @ body.placement.translation),
            *own.ravel(),
            body.mass,
            *center,
            *(center * body.mass),
            *about_origin.ravel(),
        ]
    rotation, gravity = robot.base.rotation, robot.gravity
    found += [*rotation.ravel(), *robot.base.translation, *gravity, *(-(rotation.T @ gravity))]
    if request.frame is not None:
        number, placement = robot.frames[robot.model.frame(request.frame.name).name]
        found += [*(axes[number].T @ placement.rotation).ravel(), *(axes[number].T @ placement.translation)]
    if robot.model.couplings:
        found += map(ball, robot.couplings.entries)
    return found


def _known(x: Any) -> float | None:
    """0 or ±1 where a ball is exactly that."""
    return next((value for value in (0.0, 1.0, -1.0) if (x - value).is_zero()), None)
