"""What is known of a function that can be judged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product

from crosscheck.judging.functions.pinocchio_answers import PinocchioAnswers
from crosscheck.judging.states.judged_states import JudgedStates
from graphdyn.layout import BODY_PARAMETERS, Array

Chosen = Mapping[str, str]
"""One way to read an answer: for each convention of the function, which one is followed."""

LOADS = "external_wrenches"
"""Name of the argument that functions get last if external wrenches are asked for."""

Measure = Callable[[Array, Array, JudgedStates, Chosen], Array]
"""(answer, reference, states, chosen) → relative error per state (N,)."""


@dataclass(frozen=True, eq=False)
class KnownFunction:
    """One row of the table of functions that can be judged.

    name: its name, that of graphdyn's verb or of a field of its answer
    arguments: names among q, v, a, tau, external_wrenches; (n,) each, external_wrenches (n, 6)
    shape: of the answer; "n" and "10 n" depend on the robot, "p" is any number, the same at all states
    unit: of the answer
    ours: graphdyn's answer at N states, read in one way    (N, …)
    errors: relative errors of answers against reference answers at N states, read alike   (N,)
    scale: what the errors are relative to, in words
    code: Python for graphdyn's answer at one state, of the names model, q, v, a, tau, external_wrenches; in braces what
        is filled in: frame, reference, classical
    pinocchio: Pinocchio's answer; None where it has none, as of a frame that is fixed in the ground
    mujoco: name of its answer in MujocoModel.evaluate; None where it has none
    conventions: for each thing that codes do differently and rightly, the ways to do it; the usual one first
    widening: names of the conventions of which every way includes those before it
    takes_loads: whether it has external_wrenches as a last argument when they are asked for
    needs_frame: whether it belongs to one frame of the robot
    solves: whether it needs a regular mass matrix
    """

    name: str
    arguments: tuple[str, ...]
    shape: tuple[int | str, ...]
    unit: str
    ours: Callable[[JudgedStates, Chosen], Array]
    errors: Measure
    scale: str
    code: str
    pinocchio: Callable[[PinocchioAnswers, Chosen], Array | None]
    mujoco: str | None = None
    conventions: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    widening: tuple[str, ...] = ()
    takes_loads: bool = False
    needs_frame: bool = False
    solves: bool = False

    def __str__(self) -> str:
        """Such as "mass_matrix (q) → (n, n) [kg m², kg m, kg]"."""
        return f"{self.name} ({', '.join(self.arguments)}) → ({', '.join(map(str, self.shape))}) [{self.unit}]"

    def arguments_at(self, states: JudgedStates) -> tuple[Array, ...]:
        """The arguments at all states, in the order of the function (N, …)."""
        return tuple(argument_at(states, name) for name in self.called_with(states.loads is not None))

    def called_with(self, loaded: bool) -> tuple[str, ...]:
        """Names of the arguments; loaded: with external wrenches, where the function takes them."""
        return (*self.arguments, LOADS) if loaded and self.takes_loads else self.arguments

    def shape_for(self, n: int) -> tuple[int | None, ...]:
        """Of one answer for n joints; None for any number."""
        sizes = {"n": n, "10 n": BODY_PARAMETERS * n, "p": None}
        return tuple(size if isinstance(size, int) else sizes[size] for size in self.shape)

    def code_for(self, chosen: Chosen, frame: str | None) -> str | None:
        """The code, filled in; None where a convention is followed for which there is no code."""
        filled_in = {"frame": frame, **chosen, "classical": chosen.get("acceleration") == "classical"}
        code = self.code.format(**filled_in)
        others = (name for name in self.conventions if name not in ("reference", "acceleration"))
        return code if all(chosen[name] == self.conventions[name][0] for name in others) else None

    def readings(self, declared: Chosen) -> Iterator[Chosen]:
        """Every way to read the answer that is in keeping with the declared conventions, the usual ones first."""
        for choice in product(*self.conventions.values()):
            chosen = dict(zip(self.conventions, choice, strict=True))
            if all(chosen.get(name, way) == way for name, way in declared.items()):
                yield chosen


def argument_at(states: JudgedStates, name: str) -> Array:
    """q, v, a, tau or external_wrenches at all states; loads of zero where there are none."""
    if name != LOADS:
        found: Array = getattr(states, name)
        return found
    return states.all_loads
