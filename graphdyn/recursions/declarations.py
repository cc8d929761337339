"""How a recursion is declared: beside its function, with shape and unit of what it answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from graphdyn.layout import BODY_PARAMETERS
from graphdyn.model.robot_model import RobotModel

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class ArraySpec:
    """An array of the dynamics.

    shape: for one sample; "n" is the number of joints that no others drive, "bodies" that of all, "10 bodies" that of
        their inertial parameters
    unit: the second one, after "or", is that of prismatic joints
    """

    shape: tuple[int | str, ...]
    unit: str

    def shape_for(self, model: RobotModel) -> tuple[int, ...]:
        return tuple([size if isinstance(size, int) else MODEL_SIZES[size](model) for size in self.shape])


MODEL_SIZES: dict[str, Callable[[RobotModel], int]] = {
    "n": lambda model: model.nv,
    "bodies": lambda model: model.n_bodies,
    "10 bodies": lambda model: BODY_PARAMETERS * model.n_bodies,
    "couplings": lambda model: len(model.couplings),
    "chord rows": lambda model: model.n_chord_rows,
}
"""Sizes of a robot, by the words in which shapes speak of them."""

ACCELERATIONS, TORQUES = ArraySpec(("n",), "rad/s² or m/s²"), ArraySpec(("n",), "N m or N")

INPUTS = {
    "q": ArraySpec(("n",), "rad or m"),
    "v": ArraySpec(("n",), "rad/s or m/s"),
    "a": ACCELERATIONS,
    "tau": TORQUES,
}
"""The joint arrays that recursions take."""

ARRAY_SPECS = {**INPUTS}
"""All inputs and outputs by name."""


@dataclass(frozen=True)
class Recursion:
    """inputs: names of its joint arrays, q first; outputs: of what it answers.

    compute(sample, *inputs) answers scalars: the one output, or a dictionary of outputs, of any shape; the sample
        is a graphdyn.compiler.programs.Sample
    on_moving_base: whether the motion of the base matters
    of_frame: whether it speaks of a frame, which the sample has
    of_torques: whether it answers torques, or torques per parameter, of all joints; with chords those of the motors
    coupled: compute for robots with couplings, where it is not the projection of what compute answers for all joints
    closed: compute for robots with chords and without couplings, where the chords matter
    """

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    compute: Callable[..., Any]
    on_moving_base: bool
    of_frame: bool
    of_torques: bool

    @property
    def coupled(self) -> Callable[..., Any] | None:
        return COUPLED.get(self.name)

    @property
    def closed(self) -> Callable[..., Any] | None:
        return CLOSED.get(self.name)


RECURSIONS: dict[str, Recursion] = {}
COUPLED: dict[str, Callable[..., Any]] = {}
CLOSED: dict[str, Callable[..., Any]] = {}


def recursion(**outputs: ArraySpec) -> Callable[[Function], Function]:
    """Declares a function as the recursion of its name, which answers these outputs.

    Its parameters say what it takes. Those named in INPUTS are its inputs; the others are attributes of the sample:
    links, root where the motion of the base matters, frame where it speaks of one, degrees of freedom (None without
    couplings) where it knows couplings itself, external, mass, joints_only.
    """
    return partial(_declare, outputs, False)


def recursion_of_torques(**outputs: ArraySpec) -> Callable[[Function], Function]:
    """Declare like recursion a function of torques or torques per parameter of all joints. With chords it answers those
    of the motors."""
    return partial(_declare, outputs, True)


def _declare(outputs: dict[str, ArraySpec], of_torques: bool, function: Function) -> Function:
    name, parameters = function.__name__, _parameters(function)
    compute = _of_samples(function, but="degrees_of_freedom")
    inputs = tuple(each for each in parameters if each in INPUTS)
    moving, of_frame = "root" in parameters, "frame" in parameters
    RECURSIONS[name] = Recursion(name, inputs, tuple(outputs), compute, moving, of_frame, of_torques)
    ARRAY_SPECS.update(outputs)
    return with_couplings(function) if "degrees_of_freedom" in parameters else function


def with_couplings(function: Function) -> Function:
    """Declares a function as the form of the recursion of its name for robots with couplings (Recursion.coupled)."""
    COUPLED[function.__name__] = _of_samples(function)
    return function


def with_chords(function: Function) -> Function:
    """Declares a function as the form of the recursion of its name for robots with chords (Recursion.closed)."""
    CLOSED[function.__name__] = _of_samples(function)
    return function


def _parameters(function: Callable[..., Any]) -> tuple[str, ...]:
    """Parameters without those that are keywords only, which are for other callers."""
    code = function.__code__
    return code.co_varnames[: code.co_argcount]


def _of_samples(function: Callable[..., Any], but: str = "") -> Callable[..., Any]:
    """compute(sample, *inputs): the function of the inputs, and of what the sample has of its other parameters."""
    parameters = [name for name in _parameters(function) if name != but]
    inputs = [name for name in parameters if name in INPUTS]
    of_robot = [name for name in parameters if name not in INPUTS]

    def compute(sample: Any, *arrays: Any) -> Any:
        known = {name: getattr(sample, name) for name in of_robot}
        return function(**known, **dict(zip(inputs, arrays, strict=True)))

    return compute
