"""A robot whose constants can be had at any precision, of either truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from fractions import Fraction
from typing import get_args

from crosscheck.exact.robot import ExactRobot, Truth, of_file, of_model
from crosscheck.reference.subject import Robot, subject
from graphdyn import InvalidInput, RobotModel
from urdf import Reading, written


class ExactSource:
    """A robot at any precision."""

    def __init__(self, robot: Robot, truth: Truth | None, reading: Reading) -> None:
        known = subject(robot, reading)
        if truth is not None and truth not in get_args(Truth):
            raise InvalidInput(f"truth is {truth!r}; use 'file' or 'model'")
        if truth == "file" and known.file is None:
            raise InvalidInput(f"robot '{known.name}' is a model: there is no file of it; use truth='model'")
        self.model = known.model
        self.truth: Truth = truth or ("model" if known.file is None else "file")
        self._known: dict[int, ExactRobot] = {}
        self._written = None
        if self.truth == "file":
            assert not isinstance(robot, RobotModel)
            self._written = written(robot, reading=reading)

    def at(self, precision: int) -> ExactRobot:
        """Its constants with so many bits; to be called inside `bits` of these."""
        if precision not in self._known:
            self._known[precision] = (
                of_model(self.model) if self._written is None else of_file(self.model, self._written)
            )
        return self._known[precision]

    def moved(self, model: RobotModel) -> ExactSource:
        """The same robot on another base and in another gravity, those of a model of it."""
        found = copy(self)
        found.model, found._known = model, {}
        return found

    def inertials(self) -> Iterator[tuple[str, Fraction, Sequence[Sequence[Fraction]]]]:
        """Name, mass, and tensor (3, 3) about the center of mass: of each <inertial>, or of each body of the model."""
        if self._written is not None:
            for name, inertial in self._written.inertials.items():
                yield name, inertial.mass, inertial.tensor
            return
        for body in self.model.bodies:
            rows = [[Fraction(x) for x in row] for row in body.inertia.tolist()]
            tensor = [[(rows[j][k] + rows[k][j]) / 2 for k in range(3)] for j in range(3)]
            yield body.name, Fraction(body.mass), tensor
