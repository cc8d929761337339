"""What every verb has in common: how it is declared; arguments in, a method chosen, arrays out.

The dynamics body after body, compiled for the robot at hand: graphdyn.equations.projected for many samples.

The arguments are arrays of one common leading shape (arrays.joint_arrays, unchecked); external wrenches are
absent where there are none.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import FLOAT, joint_arrays, refuse_non_finite, with_wrenches
from graphdyn.arguments.choices import KEYWORDS, Answer, FrameChoice, VerbKeywords, is_recursive, with_keywords
from graphdyn.arguments.keywords import refuse_unknown
from graphdyn.compiler.batch import Evaluation, evaluate, request_of
from graphdyn.compiler.llvm.precision import precision_of
from graphdyn.compiler.programs import Request
from graphdyn.compiler.running import WORTH_COMPILING, beyond_reduction, has_paid
from graphdyn.equations import projected
from graphdyn.equations.loops.reactions import in_self_stress_usually
from graphdyn.equations.projected import refuse_singular
from graphdyn.equations.specification import Arguments, Specification
from graphdyn.errors import GraphDynError, InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions import ARRAY_SPECS, RECURSIONS

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True, eq=False)
class Verb:
    """What is declared of a public function (verb): how its answer is computed.

    specification: the answer as the equations read, which the recursion must agree with
    recursion: its name in graphdyn.recursions.RECURSIONS, where inputs, outputs, shapes and units are
    outputs: which of the recursion's outputs the verb answers
    closed: the specification for robots with loops, where these matter
    remedy: what to do with robots with loops instead, of a verb that has no answer for them
    answer: the class that holds several outputs; without one they are a tuple, and a single output is an array
    worth_compiling: number of samples for which the projected method takes as long as compiling
    """

    function: Callable[..., Any]
    specification: Specification
    recursion: str
    outputs: tuple[str, ...]
    closed: Specification | None
    remedy: str | None
    answer: type | None
    worth_compiling: int

    @property
    def name(self) -> str:
        return self.function.__name__

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the arrays that it takes, in order."""
        return RECURSIONS[self.recursion].inputs

    @cached_property
    def of_frame(self) -> bool:
        """Whether it is about one frame."""
        return RECURSIONS[self.recursion].of_frame

    def __str__(self) -> str:
        """Such as "mass_matrix(q) → mass_matrix (n, n) [kg m², kg m, kg]"."""
        answers = (f"{name} ({_listed(ARRAY_SPECS[name].shape)}) [{ARRAY_SPECS[name].unit}]" for name in self.outputs)
        return f"{self.name}({_listed(self.inputs)}) → {', '.join(answers)}"

    def refuse_loops(self, model: RobotModel) -> None:
        """Raises InvalidInput for a robot with loops where the verb has no answer for them."""
        if model.chords and self.remedy is not None:
            raise InvalidInput(f"{self.name} does not know the loops of robot '{model.name}'; {self.remedy}")

    def is_compiled(self, model: RobotModel) -> bool:
        """Whether it has a compiled form for this robot."""
        knows_loops = RECURSIONS[self.recursion].closed is not None and not model.couplings
        return knows_loops or not model.chords or self.closed is None

    def refuse_uncompiled(self, model: RobotModel, remedy: str) -> None:
        """Raises InvalidInput where there is no compiled form for this robot."""
        if not self.is_compiled(model):
            what = "loops and couplings" if model.couplings else "loops"
            raise InvalidInput(f"{self.name} of robot '{model.name}', which has {what}, has no compiled form; {remedy}")

    def packed(self, arrays: dict[str, Array]) -> Any:
        """The answer, of its arrays by name."""
        found = [np.asarray(arrays[name]) for name in self.outputs]  # a number of one state, too
        if self.answer is not None:
            return self.answer(*found)
        return found[0] if len(found) == 1 else tuple(found)

    def memory(self, out: Any) -> dict[str, Array] | None:
        """The arrays of out by name. Raises InvalidInput where it has another form than the answer."""
        if out is None:
            return None
        if self.answer is not None:
            if not isinstance(out, self.answer):
                wanted = f"{self.answer.__name__} with an array for each of its fields"
                raise InvalidInput(f"out is {type(out).__name__}; give {wanted}")
            return {name: getattr(out, name) for name in self.outputs}
        if len(self.outputs) == 1:
            return {self.outputs[0]: out}
        if not isinstance(out, tuple) or len(out) != len(self.outputs):
            raise InvalidInput(f"out is {type(out).__name__}; give a pair of arrays, for {' and '.join(self.outputs)}")
        return dict(zip(self.outputs, out, strict=True))


VERBS: dict[str, Verb] = {}
"""The public verbs by name, of the modules that were imported: graphdyn.verbs imports all."""


def verb(
    specification: Specification,
    *,
    recursion: str | None = None,
    outputs: tuple[str, ...] = (),
    closed: Specification | None = None,
    remedy: str | None = None,
    answer: type | None = None,
    worth_compiling: int = WORTH_COMPILING,
) -> Callable[[Function], Function]:
    """Declares a public function as the verb of its name (Verb), and completes its docstring by its keywords.

    recursion: that of the same name if left out; outputs: all of the recursion if left out
    """

    def declared(function: Function) -> Function:
        name = recursion or function.__name__
        wanted = outputs or RECURSIONS[name].outputs
        VERBS[function.__name__] = Verb(function, specification, name, wanted, closed, remedy, answer, worth_compiling)
        return with_keywords(function)

    return declared


def computed(
    function: Callable[..., Answer],
    model: RobotModel,
    arguments: tuple[ArrayLike, ...],
    keywords: VerbKeywords[Answer],
    external_wrenches: ArrayLike | None = None,
    frame: FrameChoice | None = None,
) -> Answer:
    """What a verb answers.

    function: the public function of the verb; arguments: in the order of its inputs
    frame: given to the verbs that speak of one (graphdyn.arguments.choices.frame_choice)

    Raises TypeError for a keyword that is none of KEYWORDS, naming the closest.
    """
    if not keywords.keys() <= KEYWORDS.keys():
        refuse_unknown(function, keywords, ())
    verb = VERBS[function.__name__]
    base, method, out = keywords.get("base"), keywords.get("method", "auto"), keywords.get("out")
    dtype = precision_of(keywords["dtype"]).dtype if "dtype" in keywords else FLOAT
    given = dict(zip(verb.inputs, arguments, strict=True))
    if external_wrenches is not None:
        given["external_wrenches"] = external_wrenches
    x = joint_arrays(model, base, check=False, dtype=dtype, **given)
    verb.refuse_loops(model)
    closed = verb.closed if model.chords else None
    specification = closed or verb.specification
    moving = base if closed or RECURSIONS[verb.recursion].on_moving_base else None
    request = request_of(verb.recursion, verb.outputs, x, moving, frame, dtype)
    recursive = is_recursive(method, x["q"][..., 0].size, lambda: _has_paid(verb, model, request, x["q"]), out, dtype)
    asked = method == "recursive" or out is not None
    if closed and dtype != FLOAT:
        raise InvalidInput(f"{verb.name} of robot '{model.name}' with loops computes in float64 only; omit dtype=")
    if not recursive or (closed and not asked and not verb.is_compiled(model)):
        refuse_non_finite(model, x)
        found = specification(Arguments(model, with_wrenches(model, x), base, method == "dense", frame))
        return cast(Answer, verb.packed(found))
    if closed:
        verb.refuse_uncompiled(model, f"use method='projected'{'' if out is None else ' and omit out='}")
    threads, check = keywords.get("threads"), keywords.get("check", True)
    memory = verb.memory(out)
    answer = evaluate(model, request, x, moving, memory, threads=threads, check=check)
    if answer.suspects.size:
        _decide(answer, specification, Arguments(model, with_wrenches(model, x), moving, frame=frame))
    if closed:
        for name, undetermined in in_self_stress_usually(model).items():
            if name in answer.arrays:
                answer.arrays[name][..., undetermined] = np.nan
    return cast(Answer, verb.packed(answer.arrays))


def _listed(names: Sequence[int | str]) -> str:
    return ", ".join(map(str, names)) + ("," if names == ("n",) else "")


def _has_paid(verb: Verb, model: RobotModel, request: Request, q: Array) -> bool:
    """Whether compiling has paid for the verb, and compiled code has an answer for these positions."""
    paid = has_paid(model, request, q[..., 0].size, verb.worth_compiling)
    return paid and not (model.couplings and beyond_reduction(model, q, {"squares": np.inf}))


def _decide(answer: Evaluation, specification: Specification, x: Arguments) -> None:
    """Refuse samples with a singular mass matrix; solve those that merely have a small pivot by projection."""
    batch = x["q"].shape[:-1]
    index = np.unravel_index(answer.suspects, batch) if batch else ()
    base = None if x.base is None else x.base.at(batch, index)
    chosen = replace(x, arrays={name: array[index].astype(float) for name, array in x.arrays.items()}, base=base)
    if not x.model.chords:  # whose specification refuses by itself
        rows = list(zip(*index, strict=True)) if batch else None
        refuse_singular(x.model, projected.mass_matrix(chosen)["mass_matrix"], rows)
    try:
        solved = specification(chosen)
    except GraphDynError:
        if x.model.chords:  # that of all samples names the row
            specification(x)
        raise
    for name, array in answer.arrays.items():
        array[index] = solved[name]
