"""Pinocchio's functions by their names: what the table of quantities says of them, without an import of Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from graphdyn.layout import Array

if TYPE_CHECKING:
    from crosscheck.reference.pinocchio_model import PinocchioAnswers
    from crosscheck.reference.pinocchio_model.answers import NativeState
    from crosscheck.reference.pinocchio_model.model import PinocchioModel


@dataclass(frozen=True)
class NativeFunction:
    """One of Pinocchio's functions of a state, as a reference for a quantity.

    function: its name; arguments: names among q, v, a, tau, forces
    form: what its answer is, as a method of PinocchioModel that brings it into our order; None for what has no joints
    rooted: computed at the world's origin
    item: which of several answers
    """

    function: str
    arguments: tuple[str, ...]
    form: str | None = None
    rooted: bool = False
    item: int | None = None

    @property
    def native(self) -> Callable[..., Any]:
        """The function itself, of a model, its data and the arguments in Pinocchio's order."""
        from crosscheck.reference.pinocchio_model import function_named  # help lists the table without Pinocchio

        return function_named(self.function)

    def __call__(self, there: PinocchioAnswers, chosen: Mapping[str, str]) -> Array:
        """The answer at every state (N, …)."""
        function = self.native

        def of_one(robot: PinocchioModel, state: NativeState) -> Array:
            found = function(robot.native, robot.data, *(getattr(state, name) for name in self.arguments))
            found = found if self.item is None else found[self.item]
            return np.array(getattr(found, "vector", found)) if self.form is None else getattr(robot, self.form)(found)

        return there.each(of_one, there.rooted if self.rooted else None)


@dataclass(frozen=True)
class FrameFunction:
    """One of Pinocchio's functions of a frame, in the chosen reference.

    function: its name, after the kinematics; spatial: in place of it for spatial accelerations
    alone: name of the function that computes the kinematics, too
    """

    function: str
    spatial: str = ""
    alone: str = ""

    @property
    def native(self) -> Callable[..., Any]:
        """The function that computes the kinematics, too, of a model, its data, q, a frame and a reference."""
        from crosscheck.reference.pinocchio_model import function_named

        return function_named(self.alone)

    def __call__(self, there: PinocchioAnswers, chosen: Mapping[str, str]) -> Array:
        """The answer at every state (N, …)."""
        function = self.spatial if chosen.get("acceleration") == "spatial" else self.function
        return there.of_frames(function, chosen["reference"])
