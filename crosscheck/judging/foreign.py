"""A foreign function: called state by state, in its own joint order, its answers checked for shape."""

from __future__ import annotations

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
            answer = np.asarray(self.function(*arguments.values()), dtype=float)
        except Exception as error:  # foreign code may raise anything
            where = ", ".join(f"{name} = {x.tolist()}" for name, x in arguments.items())
            raise ForeignFailure(f"{self.name} raised {type(error).__name__}: {error}; at {where}") from error
        n = len(self.order)
        expected = {"mass_matrix": (n, n), "regressor": (n, BODY_PARAMETERS * n)}.get(self.name, (n,))
        if answer.shape != expected:
            raise ForeignFailure(
                f"{self.name} returned shape {answer.shape}, expected {expected}: it is called with one state at a "
                f"time, arrays of shape ({n},)"
            )
        return self._in_our_order(answer)

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
