"""One function as it was recorded, for libraries that differentiate it and solve with it."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from graphdyn.export.functions import ExportChoices, ExportedFunction, exported_functions
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

ARITHMETIC: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
}
"""Recorded operations on the scalars of any library; sine and cosine are its own."""


def recorded_function(model: RobotModel, name: str, choices: ExportChoices) -> ExportedFunction:
    """The function of this name, of a robot for which it has answers.

    Raises what exported_functions raises, and what the verb does at a random state, such as SingularMassMatrix: there
    is no other place for it than here, and numbers without it would be NaN or infinity.
    """
    (function,) = exported_functions(model, [name], choices)
    function.expected(_one_state(function))
    return function


def _one_state(function: ExportedFunction) -> dict[str, Array]:
    """A state within the limits, without motion; the base stands where it is."""
    q, _ = function.model.random_state(np.random.default_rng(0), 1)
    rest = {name: np.zeros((1, *function.shape(name))) for name in function.inputs}
    base = {"base_rotation": np.eye(3)[None]} if "base_rotation" in rest else {}
    return {**rest, **base, "q": q}
