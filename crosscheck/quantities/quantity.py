"""What the table of quantities knows of each: a row, and the forms in which it is compared."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from crosscheck.quantities.measures import Chosen, Measure, linear_first
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.tolerances import AGREEMENT, Tolerance
from crosscheck.reference.native_functions import FrameFunction, NativeFunction
from crosscheck.reference.subject import compared_frames
from graphdyn.arguments import Method
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.recursions import ARRAY_SPECS
from graphdyn.verbs import VERBS

if TYPE_CHECKING:
    from crosscheck.reference.pinocchio_model import PinocchioAnswers

LOADS = "external_wrenches"
"""Name of the argument that functions get last if external wrenches are asked for."""


@dataclass(frozen=True, eq=False)
class Ours:
    """graphdyn's side of a quantity.

    arguments: names among q, v, a, tau, external_wrenches; (n,) each, external_wrenches (n, 6)
    shape: "n" and "10 n" depend on the robot, "p" is any number, the same at all states
    compute: at N states, in the chosen reference, by a method   (N, …)
    code: Python for it at one state, of the names model, q, v, a, tau, external_wrenches; in braces what is filled in:
        frame, reference, classical
    takes_loads: whether it has external_wrenches as a last argument when they are asked for
    verb, output: graphdyn's verb, and which of its outputs this is; empty where it is no output of one
    options: keywords of the verb in the chosen conventions
    """

    arguments: tuple[str, ...]
    shape: tuple[int | str, ...]
    unit: str
    compute: Callable[[ScaledStates, Chosen, Method], Array]
    code: str
    takes_loads: bool = False
    verb: str = ""
    output: str = ""
    options: Callable[[Chosen], dict[str, Any]] = lambda chosen: {}


_SIZES: Mapping[int | str, int | str] = {"bodies": "n", "10 bodies": "10 n"}
"""Sizes of arrays of robots whose joints move by themselves."""


def verb(name: str, output: str = "", *, loads: Literal["none", "taken", "needed"] = "none") -> Ours:
    """An output of a verb of graphdyn, the first if none is named.

    loads: whether it takes external wrenches, only where they are asked for, or always
    """
    outputs, inputs = VERBS[name].outputs, VERBS[name].inputs
    array = ARRAY_SPECS[output or outputs[0]]
    given = (*inputs, *([LOADS] if loads != "none" else []))

    def compute(states: ScaledStates, chosen: Chosen, method: Method) -> Array:
        found = states.answer(name, method, loaded=loads != "none")
        answer: Array = getattr(found, output or outputs[0]) if len(outputs) > 1 else found
        return answer

    return Ours(
        given if loads == "needed" else inputs,
        tuple(_SIZES.get(size, size) for size in array.shape),
        array.unit,
        compute,
        f"graphdyn.{name}(model, {', '.join(given)}){f'.{output or outputs[0]}' if len(outputs) > 1 else ''}",
        takes_loads=loads == "taken",
        verb=name,
        output=output or outputs[0],
    )


def frame_verb(name: str, acceleration: Literal["classical", "spatial"] | None = None) -> Ours:
    """A verb that speaks of a frame: of that of the states, or of all that are compared (N, m, …).

    acceleration: which one, where it is not chosen
    """
    bare = verb(name)

    def options(chosen: Chosen) -> dict[str, Any]:
        found: dict[str, Any] = {"reference": chosen["reference"]}
        if name == "frame_acceleration":
            found["classical"] = (acceleration or chosen["acceleration"]) == "classical"
        return found

    def compute(states: ScaledStates, chosen: Chosen, method: Method) -> Array:
        if states.frame is not None:
            one: Array = states.answer(name, method, frame=states.frame, **options(chosen))
            return one
        names = compared_frames(states.model)
        return np.stack([states.answer(name, method, frame=frame, **options(chosen)) for frame in names], axis=1)

    classical = f", classical={acceleration == 'classical' if acceleration else '{classical}'}"
    code = f"graphdyn.{name}(model, {', '.join(bare.arguments)}, {{frame!r}}, reference={{reference!r}}"
    code = f"{code}{classical if name == 'frame_acceleration' else ''})"
    return replace(bare, compute=compute, code=code, options=options)


@dataclass(frozen=True)
class Form:
    """A form in which a quantity is compared.

    suffix: of the name of the quantity in this form
    method: by which graphdyn computes it; words: this method, where the row does not say it
    loaded: with external wrenches
    when: at which states: all, the first random ones, a few of these
    """

    suffix: str
    method: Method
    words: str = ""
    loaded: bool = False
    when: Literal["all", "first", "few"] = "all"


RECURSIVE = "_recursive"
"""Ending of the names of quantities that the recursive method computes; compared at random states only."""

_BY_RECURSION, _DENSE = "ours body after body", "dense system"
USUAL = (Form("", "auto"),)
USUAL_TWICE = (*USUAL, Form(RECURSIVE, "recursive", _BY_RECURSION))
LOADED = Form("_external", "auto", loaded=True)
SOLVED = (Form("", "dense", _DENSE), Form(RECURSIVE, "recursive", _BY_RECURSION))
SOLVED_LOADED = Form("_external", "dense", _DENSE, loaded=True)
PROJECTED = Form("_projected", "projected", "null space")
DERIVED = (Form("", "projected", when="first"), Form(RECURSIVE, "recursive", _BY_RECURSION, when="first"))
DERIVED_LOADED = tuple(replace(form, loaded=True) for form in DERIVED)
AT_FEW_STATES = tuple(replace(form, when="few") for form in DERIVED)


Shown = Literal[
    "",
    "torques",
    "accelerations",
    "torques per parameter",
    "inertia",
    "inverse of the inertia",
    "inertia as a quadratic form",
    "gravity",
    "gravity and velocity terms",
    "velocity terms as a matrix",
]
"""What of the equations of motion a function of users shows by its answers alone."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Quantity:
    """A row of the table: graphdyn's answer, those of the reference implementations, and how errors are measured.

    name: that of graphdyn's verb, or of a field of its answer
    ours: graphdyn's answer; pinocchio: Pinocchio's, in the same usual conventions   (N, …)
    errors: relative errors of answers against reference answers at N states, read alike   (N,)
    scale: besides the largest reference value, what the errors are relative to, in the terms of docs/notation.md
    against: Pinocchio's function in words, its name if left out; after a semicolon, the method of graphdyn
    tolerance: the bound of graphdyn's errors
    forms: in which it is compared
    massive: whether it needs a body with mass; solves: whether it needs a regular mass matrix
    of_frame: whether it belongs to one frame of the robot; from_file: to Pinocchio's reading of the file
    judged_errors, judged_scale: of functions of users, where they are measured otherwise
    shows: what of the equations of motion its answers show
    mujoco: name of its answer in MujocoModel.evaluate; None where it has none
    conventions: for each thing that codes do differently and rightly, the ways to do it; the usual one first
    as_chosen: the answer in the chosen conventions, from that in the usual ones; reference and order excepted
    widening: names of the conventions of which every way includes those before it
    six: the axis of a twist or wrench, whose order may be chosen
    benchmark: its title where calls for it are measured
    """

    name: str
    ours: Ours
    pinocchio: Callable[[PinocchioAnswers, Chosen], Array]
    errors: Measure
    scale: str
    against: str = ""
    tolerance: Tolerance = AGREEMENT
    forms: tuple[Form, ...] = DERIVED
    massive: bool = False
    solves: bool = False
    of_frame: bool = False
    from_file: bool = False
    judged_errors: Measure | None = None
    judged_scale: str = ""
    shows: Shown = ""
    mujoco: str | None = None
    conventions: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    as_chosen: Callable[[Array, ScaledStates, Chosen], Array] | None = None
    widening: tuple[str, ...] = ()
    six: int = -1
    benchmark: str = ""

    def __str__(self) -> str:
        """Such as "mass_matrix (q) → (n, n) [kg m², kg m, kg]"."""
        ours = self.ours
        return f"{self.name} ({', '.join(ours.arguments)}) → ({', '.join(map(str, ours.shape))}) [{ours.unit}]"

    @property
    def arguments(self) -> tuple[str, ...]:
        return self.ours.arguments

    @property
    def shape(self) -> tuple[int | str, ...]:
        return self.ours.shape

    @property
    def function(self) -> str:
        """Pinocchio's function, or in words how the reference value is found."""
        theirs = self.pinocchio
        return self.against or (theirs.function if isinstance(theirs, NativeFunction | FrameFunction) else "")

    def of_graphdyn(self, states: ScaledStates, chosen: Chosen, method: Method = "auto") -> Array:
        """graphdyn's answer at N states, read in one way   (N, …)."""
        return self._chosen(self.ours.compute(states, chosen, method), states, chosen)

    def of_pinocchio(self, there: PinocchioAnswers, states: ScaledStates, chosen: Chosen) -> Array:
        """Pinocchio's answer at N states, read in one way   (N, …)."""
        return self._chosen(self.pinocchio(there, chosen), states, chosen)

    def _chosen(self, answer: Array, states: ScaledStates, chosen: Chosen) -> Array:
        answer = answer if self.as_chosen is None else self.as_chosen(answer, states, chosen)
        return linear_first(answer, chosen, self.six)

    @property
    def judged_by(self) -> Measure:
        """The errors of functions of users."""
        return self.judged_errors or self.errors

    @property
    def judged_relative_to(self) -> str:
        """What these errors are relative to, in words."""
        return self.judged_scale or f"the largest reference value; {self.scale}"

    def arguments_at(self, states: ScaledStates) -> tuple[Array, ...]:
        """The arguments at all states, in the order of the function (N, …)."""
        return tuple(argument_at(states, name) for name in self.called_with(states.loads is not None))

    def called_with(self, loaded: bool) -> tuple[str, ...]:
        """Names of the arguments; loaded: with external wrenches, where the function takes them."""
        return (*self.arguments, LOADS) if loaded and self.ours.takes_loads else self.arguments

    def shape_for(self, n: int) -> tuple[int | None, ...]:
        """Shape of one answer for n joints; None for any number."""
        sizes = {"n": n, "10 n": BODY_PARAMETERS * n, "p": None}
        return tuple(size if isinstance(size, int) else sizes[size] for size in self.shape)

    def code_for(self, chosen: Chosen, frame: str | None) -> str | None:
        """The code, filled in; None where a convention is followed for which there is no code."""
        filled_in = {"frame": frame, **chosen, "classical": chosen.get("acceleration") == "classical"}
        code = self.ours.code.format(**filled_in)
        others = (name for name in self.conventions if name not in ("reference", "acceleration"))
        return code if all(chosen[name] == self.conventions[name][0] for name in others) else None

    def readings(self, declared: Chosen) -> Iterator[Chosen]:
        """Every way to read the answer that is in keeping with the declared conventions, the usual ones first."""
        for choice in product(*self.conventions.values()):
            chosen = dict(zip(self.conventions, choice, strict=True))
            if all(chosen.get(name, way) == way for name, way in declared.items()):
                yield chosen


def argument_at(states: ScaledStates, name: str) -> Array:
    """q, v, a, tau or external_wrenches at all states; loads of zero where there are none."""
    found: Array = states.all_loads if name == LOADS else getattr(states, name)
    return found
