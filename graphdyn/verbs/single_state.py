"""A verb for one state after the other, in memory that is reused: for control loops."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable
from typing import Any, Generic, Protocol, Self, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.compiler.native import CompiledProgram, RowCall
from graphdyn.compiler.programs import Request
from graphdyn.compiler.python_calls import PythonCall, can_call, of_this_thread
from graphdyn.compiler.running import Backend, prepared
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions import ARRAY_SPECS
from graphdyn.verbs.verb import VERBS, Verb


class OfPositions(Protocol):
    """Called with q, or with nothing where it is filled in."""

    @overload
    def __call__(self) -> Array: ...
    @overload
    def __call__(self, q: ArrayLike, /) -> Array: ...


class OfState(Protocol):
    """Called with q and v, or with nothing where they are filled in."""

    @overload
    def __call__(self) -> Array: ...
    @overload
    def __call__(self, q: ArrayLike, v: ArrayLike, /) -> Array: ...


class OfMotion(Protocol):
    """Called with q, v and a, or with nothing where they are filled in."""

    @overload
    def __call__(self) -> Array: ...
    @overload
    def __call__(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, /) -> Array: ...


class OfTorques(Protocol):
    """Called with q, v and tau, or with nothing where they are filled in."""

    @overload
    def __call__(self) -> Array: ...
    @overload
    def __call__(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, /) -> Array: ...


Form = TypeVar("Form", bound=Callable[..., Array])


class SingleState(threading.local, Generic[Form]):  # __init__ runs again in every thread that uses the object
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
        """Make an object of a class of its own, which holds what all threads share.

        Python looks for __call__ in the class, and calls a C function there at once.
        """
        verb = VERBS[name]
        verb.refuse_loops(model)
        verb.refuse_uncompiled(model, f"call graphdyn.{name}")
        text = f"{verb}\n\n{cls.__doc__ or ''}"  # python -OO strips docstrings
        says = {"__module__": cls.__module__, "__doc__": text, "__signature__": _signature(verb)}
        own: type[Self] = type(cls.__name__, (cls,), says)
        own._backend = prepared(model, Request(verb.recursion, verb.outputs), one_row=True).backend
        single = super().__new__(own, model, name)  # type: ignore[call-arg]  # for __init__ in other threads
        if isinstance(own._backend, CompiledProgram) and can_call():
            own._python_call = PythonCall(single.__call__)
            own.__call__ = own._python_call.function(len(verb.inputs), model.nv)  # type: ignore[method-assign]
        return single

    def __init__(self, model: RobotModel, name: str) -> None:
        verb, lanes = VERBS[name], self._backend.lanes
        (output,) = verb.outputs
        shape = ARRAY_SPECS[output].shape_for(model)
        memory = {name: np.zeros((lanes, model.nv)) for name in verb.inputs}
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

    def _call(self, *arguments: ArrayLike) -> Array:
        """The call from any thread, with anything that NumPy turns into vectors of real numbers."""
        if self._python_call is not None:
            self._python_call.served = self._memory
        if arguments:
            vectors = self._vectors(arguments)
            for place, vector in zip(self._places, vectors, strict=True):
                place[:] = vector
        self._run()
        return self._own_result

    __call__: Form = _call  # type: ignore[assignment]  # which takes what every form takes

    def __reduce__(self) -> tuple[Callable[[RobotModel, str], SingleState[Any]], tuple[RobotModel, str]]:
        return SingleState, (self.model, self._name)

    def _vectors(self, arguments: tuple[ArrayLike, ...]) -> Array:
        """Copies, as an argument may be in the place of another."""
        names, shape = VERBS[self._name].inputs, (self.model.nv,)
        if len(arguments) != len(names):
            given = f"{len(arguments)} arguments given"
            raise InvalidInput(f"{given}; give {', '.join(names)}, or none where their memory is filled")
        vectors = [as_floats(name, argument) for name, argument in zip(names, arguments, strict=True)]
        for name, vector in zip(names, vectors, strict=True):
            if vector.shape != shape:
                raise InvalidInput(f"{name} has shape {vector.shape}, expected {shape}")
        return np.array(vectors)


def _signature(verb: Verb) -> inspect.Signature:
    """That of the public function, without what a call for one state does not take."""
    whole = inspect.signature(verb.function)
    vectors = [whole.parameters[name].replace(kind=inspect.Parameter.POSITIONAL_ONLY) for name in verb.inputs]
    return whole.replace(parameters=vectors)
