"""A foreign function: called state by state, in its own joint order, its answers checked for shape."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn import GraphDynError, InvalidInput, RobotModel
from graphdyn.layout import BODY_PARAMETERS, Array

ARGUMENTS = {
    "inverse_dynamics": ("q", "v", "a"),
    "forward_dynamics": ("q", "v", "tau"),
    "mass_matrix": ("q",),
    "regressor": ("q", "v", "a"),
}
"""Arguments of each function, (n,) each. They return τ (n,), a (n,), M (n, n) and W (n, 10n)."""


def in_words(error: BaseException) -> str:
    """Type and message, where there is one: "ValueError: out of ideas", "GeneratorExit"."""
    message = str(error)
    return f"{type(error).__name__}: {message}" if message else type(error).__name__


class ForeignFailure(GraphDynError):
    """A foreign function raised an exception or returned an array of the wrong shape."""


@dataclass(frozen=True, eq=False)
class ForeignFunction:
    """A function under test, with the joint order of its arrays.

    order: number of our joint at each place of the foreign arrays (n,)
    """

    name: str
    function: Callable[..., object]
    order: NDArray[np.intp]

    def __call__(self, *arguments: Array) -> Array:
        """The answers at N states, in our joint order: arguments (N, n) each. Raises ForeignFailure."""
        return np.stack([self._one(row) for row in zip(*arguments, strict=True)])

    def foreign_arguments(self, row: Sequence[Array]) -> dict[str, Array]:
        """The arguments of one state as the function gets them, by name."""
        return {name: x[self.order] for name, x in zip(ARGUMENTS[self.name], row, strict=True)}

    def _one(self, row: Sequence[Array]) -> Array:
        arguments = self.foreign_arguments(row)
        try:
            returned = self.function(*arguments.values())
        except (Exception, SystemExit) as error:  # foreign code may raise anything
            where = ", ".join(f"{name} = {x.tolist()}" for name, x in arguments.items())
            raise ForeignFailure(f"{self.name} raised {in_words(error)}{_line(error)}; at {where}") from error
        answer = self._real(returned)
        n = len(self.order)
        expected = {"mass_matrix": (n, n), "regressor": (n, BODY_PARAMETERS * n)}.get(self.name, (n,))
        if answer.shape != expected:
            raise ForeignFailure(
                f"{self.name} returned shape {answer.shape}, expected {expected}: it is called with one state at a "
                f"time, arrays of shape ({n},)"
            )
        return self._in_our_order(answer)

    def _real(self, returned: object) -> Array:
        try:
            if returned is None:
                raise TypeError("a return is missing")
            answer = np.asarray(returned)
            if np.iscomplexobj(answer):
                raise TypeError("it has imaginary parts")
            return answer.astype(float)
        except (TypeError, ValueError) as error:
            raise ForeignFailure(
                f"{self.name} returned {type(returned).__name__}, which is no array of real numbers: {error}"
            ) from error

    def _in_our_order(self, answer: Array) -> Array:
        ours = np.empty_like(answer)
        if self.name == "mass_matrix":
            ours[np.ix_(self.order, self.order)] = answer
        elif self.name == "regressor":
            blocks = answer.reshape(len(self.order), -1, BODY_PARAMETERS)
            ours.reshape(blocks.shape)[np.ix_(self.order, self.order)] = blocks
        else:
            ours[self.order] = answer
        return ours


def _line(error: BaseException) -> str:
    """Where in the file of the function an exception was raised, or the call that led to it; "" for compiled ones."""
    frames = traceback.extract_tb(error.__traceback__)[1:]  # the first one is ours
    own = [frame for frame in frames if frame.filename == frames[0].filename]
    return f" ({own[-1].filename}, line {own[-1].lineno}, in {own[-1].name})" if own else ""


def joint_order(model: RobotModel, names: Sequence[str] | None) -> NDArray[np.intp]:
    """Number of our joint at each place of a foreign order. Raises InvalidInput unless it names every joint once."""
    if names is None:
        return np.arange(model.n_bodies)
    if isinstance(names, str) or sorted(names) != sorted(model.joint_names):
        raise InvalidInput(
            f"joint_names is {names!r}; it must name each of the {model.n_bodies} joints once: "
            f"{', '.join(model.joint_names)}"
        )
    return np.array([model.joint_names.index(name) for name in names])
