"""One state after the other, in memory that is reused: for control loops."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from graphdyn._dynamics import VERBS
from graphdyn._errors import InvalidInput
from graphdyn._model import RobotModel
from graphdyn._verb import Verb
from graphdyn.kernels.programs import Request
from graphdyn.kernels.recursions import ARRAYS
from graphdyn.kernels.running import prepared
from graphdyn.layout import Array

SINGLE = {name: verb for name, verb in VERBS.items() if len(verb.outputs) == 1}
"""The verbs that answer one array."""


class SingleState:
    """A verb for one state at a time. Call it with new arguments (n,), or change `arguments` and call it without.

    arguments: its memory, by name                          (n,) each
    result: what each call returns, and the next overwrites: copy what is to stay

    Raises InvalidInput for wrong shapes, and another number of arguments.
    """

    def __init__(self, model: RobotModel, verb: Verb[Array]) -> None:
        n, (output,) = model.n_bodies, verb.outputs
        shape = ARRAYS[output].shape_for(n)
        backend = prepared(model, Request(verb.recursion, verb.outputs)).backend
        memory = {name: np.zeros((backend.lanes, n)) for name in verb.inputs}
        answer = np.zeros((backend.lanes, int(np.prod(shape))))
        self.arguments: dict[str, Array] = {name: rows[0] for name, rows in memory.items()}
        self.result: Array = answer[0].reshape(shape)
        self._places = tuple(self.arguments.values())
        self._n = n
        self._run = backend.bind_row(memory, {output: answer})

    def __call__(self, *arguments: ArrayLike) -> Array:
        if arguments:
            try:
                for place, argument in zip(self._places, arguments, strict=True):
                    if len(argument) != self._n:  # type: ignore[arg-type]  # a third of the time that shape takes
                        raise ValueError
                    place[...] = argument  # half of the time that [:] takes
            except (TypeError, ValueError):
                self._refuse_shapes(arguments)
                raise
        self._run()
        return self.result

    def _refuse_shapes(self, arguments: tuple[ArrayLike, ...]) -> None:
        if len(arguments) != len(self._places):
            names = ", ".join(self.arguments)
            raise InvalidInput(f"{len(arguments)} arguments given; give {names}, or none where their memory is filled")
        for name, argument in zip(self.arguments, arguments, strict=True):
            if np.shape(argument) != (self._n,):
                raise InvalidInput(f"{name} has shape {np.shape(argument)}, expected {(self._n,)}")


class CompiledModel:
    """The verbs of graphdyn that answer one array, for single states of one robot, each compiled when first used.

    NaN, infinity and singular mass matrices are not looked for. Angles are accurate up to 1e6 rad. One object per
    thread. On the NumPy back end the calls work, slowly. Its attributes, each a SingleState:
    """

    def __init__(self, model: RobotModel) -> None:
        self.model = model

    def __getattr__(self, name: str) -> SingleState:
        if name not in SINGLE:
            raise AttributeError(f"there is no single-state call '{name}'; use some of {', '.join(SINGLE)}")
        call = self.__dict__[name] = SingleState(self.model, SINGLE[name])  # found there from now on
        return call

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *SINGLE})


if CompiledModel.__doc__:  # python -OO strips docstrings
    CompiledModel.__doc__ += "\n".join(["", *(f"    {verb}" for verb in SINGLE.values())])


def compile(model: RobotModel, *verbs: str) -> CompiledModel:
    """The robot's verbs for single states; those named are compiled now, so that the first call is as fast as the rest.

    Raises InvalidInput for a verb that CompiledModel does not have.
    """
    compiled = CompiledModel(model)
    for verb in verbs:
        if verb not in SINGLE:
            raise InvalidInput(f"there is no single-state call '{verb}'; use some of {', '.join(SINGLE)}")
        getattr(compiled, verb)
    return compiled
