"""The recursions of graphdyn on balls: recorded with the constants of the robot as inputs, and computed in balls.

Constants that are exactly 0 or ±1 are recorded as such; none is rounded, and no frames or bodies are merged.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from crosscheck.exact.balls import ball, eye
from crosscheck.exact.robot import ExactRobot
from graphdyn.compiler import Parts, Request, trace
from graphdyn.model import parallel_axis
from graphdyn.recursions import FixedFrame, Link, Root
from graphdyn.scalars import Program, Recorder

CONSTANTS = "constants"
"""The input of a program in which the constants of the robot are."""


@dataclass(frozen=True, eq=False)
class RecordedRequest:
    """A program, and whose constants are its input: all of them, in order."""

    program: Program
    request: Request

    def computed(self, robot: ExactRobot, inputs: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]] | None:
        """The outputs in balls, or None where recording has divided by an inertia that is zero.

        inputs: of one state, by name, flat
        """
        if any(kind == "constant" and not isfinite(rest[0]) for kind, *rest in self.program.operations):
            return None
        constants = [x for x in _constants(robot, self.request) if _known(x) is None]
        return evaluate(self.program, {**inputs, CONSTANTS: constants})


def recorded(robot: ExactRobot, request: Request) -> RecordedRequest:
    """The program of a request for robots with these constants, whatever their digits."""

    def parts(recorder: Recorder) -> Parts:
        balls = _constants(robot, request)
        known = [_known(x) for x in balls]
        columns = iter(recorder.inputs(CONSTANTS, known.count(None)))
        scalars = iter([next(columns) if x is None else x for x in known])

        def array(*shape: int) -> Any:
            return np.array([next(scalars) for _ in range(int(np.prod(shape)))], dtype=object).reshape(shape)

        links = [
            Link(
                inside=body.inside - 1,
                prismatic=body.prismatic,
                rotation=array(3, 3),
                translation=array(3),
                link_axes=array(3, 3),
                mass=array(1)[0],
                center_of_mass=array(3),
                first_moment=array(3),
                tensor=array(3, 3),
            )
            for body in robot.bodies
        ]
        rotation, position, gravity, compensated = array(3, 3), array(3), array(3), array(3)
        at_rest = {name: np.zeros(3).astype(object) for name in ("velocity", "omega", "alpha", "acceleration")}
        root = Root(rotation=rotation, position=position, gravity=gravity, compensated=compensated, **at_rest)
        frame = None
        if request.frame is not None:
            number, _ = robot.frames[robot.model.frame(request.frame.name).name]
            frame = FixedFrame(number - 1, array(3, 3), array(3), request.frame)
        return Parts(tuple(links), root, frame)

    return RecordedRequest(trace(robot.model, request, parts), request)


def evaluate(program: Program, inputs: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
    """The outputs of a program, by name, for one state in balls."""
    values: list[Any] = []
    for kind, *operands in program.operations:
        if kind == "constant":
            values.append(ball(operands[0]))
        elif kind == "input":
            name, column = operands
            values.append(inputs[name][column])
        elif kind == "negate":
            values.append(-values[operands[0]])
        elif kind == "sine":
            values.append(values[operands[0]].sin())
        elif kind == "cosine":
            values.append(values[operands[0]].cos())
        else:
            x, y = (values[k] for k in operands)
            values.append(x + y if kind == "+" else x - y if kind == "-" else x * y if kind == "*" else x / y)
    return {name: [values[k] for k in numbers] for name, numbers in program.outputs.items()}


def _constants(robot: ExactRobot, request: Request) -> list[Any]:
    """All constants of Link, Root and FixedFrame, one after the other, in joint axes."""
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
    return found


def _known(x: Any) -> float | None:
    """0 or ±1 where a ball is exactly that."""
    return next((value for value in (0.0, 1.0, -1.0) if (x - value).is_zero()), None)
