"""One state after the other, in memory that is reused: for control loops."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.compiler.native import CompiledProgram, RowCall
from graphdyn.compiler.programs import Request
from graphdyn.compiler.python_calls import PythonCall, can_call, of_this_thread
from graphdyn.compiler.running import Backend, prepared
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.recursions import ARRAYS
from graphdyn.verbs.table import VERBS

SINGLE = {name: verb for name, verb in VERBS.items() if len(verb.outputs) == 1 and not verb.of_frame}
"""The verbs that answer one array, and need no choice of a frame."""


class SingleState(threading.local):  # __init__ runs again in every thread that uses the object
    """A verb for one state at a time. Call it with new arguments (n,), or change `arguments` and call it without.

    Every thread has memory of its own, and so has a copy. It is NaN at first, so that a call without arguments where
    nothing was filled in gives NaN.

    arguments: the memory of this thread, by name           (n,) each
    result: what each call in this thread returns, and the next overwrites: copy what is to stay

    Raises InvalidInput for what is no vector of n real numbers, and another number of arguments; the memory is then as
    before.
    """

    _backend: Backend
    _python_call: PythonCall | None = None

    def __new__(cls, model: RobotModel, name: str) -> Self:
        """Of a class of its own, which holds what all threads share.

        Python looks for __call__ in the class, and calls a C function there at once.
        """
        verb = SINGLE[name]
        verb.refuse_loops(model)
        verb.refuse_uncompiled(model, f"call graphdyn.{name}")
        own: type[Self] = type(cls.__name__, (cls,), {"__module__": cls.__module__, "__doc__": cls.__doc__})
        own._backend = prepared(model, Request(verb.recursion, verb.outputs), one_row=True).backend
        single = super().__new__(own, model, name)  # type: ignore[call-arg]  # for __init__ in other threads
        if isinstance(own._backend, CompiledProgram) and can_call():
            own._python_call = PythonCall(single.__call__)
            own.__call__ = own._python_call.function(len(verb.inputs), model.n_freedoms)  # type: ignore[method-assign]
        return single

    def __init__(self, model: RobotModel, name: str) -> None:
        verb, lanes = SINGLE[name], self._backend.lanes
        (output,) = verb.outputs
        shape = ARRAYS[output].shape_for(model)
        memory = {name: np.zeros((lanes, model.n_freedoms)) for name in verb.inputs}
        answer = np.zeros((lanes, int(np.prod(shape))))
        self.model, self._name = model, name
        self.arguments: dict[str, Array] = {name: rows[0] for name, rows in memory.items()}
        self.result: Array = answer[0].reshape(shape)
        for unfilled in (*self.arguments.values(), self.result):
            unfilled.fill(np.nan)
        self._places = tuple(self.arguments.values())
        self._own_result: Array = self.result
        self._run = run = self._backend.bind_row(memory, {output: answer})
        if isinstance(run, RowCall) and self._python_call is not None:
            self._memory = of_this_thread(run, self._places, self._own_result)

    def __call__(self, *arguments: ArrayLike) -> Array:
        """The call from any thread, with anything that NumPy turns into vectors of real numbers."""
        if self._python_call is not None:
            self._python_call.served = self._memory
        if arguments:
            vectors = self._vectors(arguments)
            for place, vector in zip(self._places, vectors, strict=True):
                place[:] = vector
        self._run()
        return self._own_result

    def __reduce__(self) -> tuple[Callable[[RobotModel, str], SingleState], tuple[RobotModel, str]]:
        return SingleState, (self.model, self._name)

    def _vectors(self, arguments: tuple[ArrayLike, ...]) -> Array:
        """Copies, as an argument may be in the place of another."""
        names, shape = SINGLE[self._name].inputs, (self.model.n_freedoms,)
        if len(arguments) != len(names):
            given = f"{len(arguments)} arguments given"
            raise InvalidInput(f"{given}; give {', '.join(names)}, or none where their memory is filled")
        vectors = [as_floats(name, argument) for name, argument in zip(names, arguments, strict=True)]
        for name, vector in zip(names, vectors, strict=True):
            if vector.shape != shape:
                raise InvalidInput(f"{name} has shape {vector.shape}, expected {shape}")
        return np.array(vectors)


class CompiledModel:
    """The verbs of graphdyn that answer one array, for single states of one robot, each compiled when first used.

    NaN, infinity, singular mass matrices and open loops are not looked for. Angles are accurate up to 1e6 rad. Threads
    may share it: each has arguments and results of its own. On the NumPy back end the calls work, slowly. Its
    attributes, each a SingleState:
    """

    def __init__(self, model: RobotModel) -> None:
        check_model(model)
        self.model = model

    def __getattr__(self, name: str) -> SingleState:
        if name not in SINGLE:
            raise AttributeError(f"there is no single-state call '{name}'; use some of {', '.join(SINGLE)}")
        call: SingleState = self.__dict__.setdefault(name, SingleState(self.model, name))  # found there from now on
        return call

    def __reduce__(self) -> tuple[Callable[..., CompiledModel], tuple[RobotModel | str, ...]]:
        return compile, (self.model, *(name for name in self.__dict__ if name in SINGLE))

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *SINGLE})


if CompiledModel.__doc__:  # python -OO strips docstrings
    CompiledModel.__doc__ += "\n".join(["", *(f"    {verb}" for verb in SINGLE.values())])


def compile(model: RobotModel, *verbs: str) -> CompiledModel:
    """The robot's verbs for single states; those named are compiled now, so that the first call is as fast as the rest.

    The array that a call returns is overwritten by the next call of the same verb in the same thread: copy what is to
    stay. Other threads do not touch it. Copies and pickles have memory of their own.

    Raises InvalidInput for a verb that CompiledModel does not have.
    """
    compiled = CompiledModel(model)
    for verb in verbs:
        if verb not in SINGLE:
            raise InvalidInput(f"there is no single-state call '{verb}'; use some of {', '.join(SINGLE)}")
        getattr(compiled, verb)
    return compiled
