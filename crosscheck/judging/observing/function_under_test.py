"""A function under test: called in its own joint order, its answers checked for shape."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.quantities import Quantity
from crosscheck.quantities.tested_function import BatchFunction, Refusal
from graphdyn import GraphDynError, InvalidInput, RobotModel
from graphdyn.layout import BODY_DOF, BODY_PARAMETERS, Array


def in_words(error: BaseException) -> str:
    """Type and message, where there is one: "ValueError: out of ideas", "GeneratorExit"."""
    message = str(error)
    return f"{type(error).__name__}: {message}" if message else type(error).__name__


class FunctionFailure(GraphDynError):
    """A function under test raised an exception or returned an array of the wrong shape."""


@dataclass(frozen=True, eq=False)
class Answers:
    """The answers at N states.

    values: in our joint order, of the states that were answered   (M, …)
    answered: which ones these are                          (N,)
    failures: message by number of the state
    changed: names of the arguments that the function changed
    decimals: the values as objects, where some of them are a LongDecimal   (M, …)
    """

    values: Array
    answered: NDArray[np.bool_]
    failures: dict[int, str]
    changed: frozenset[str]
    decimals: NDArray[Any] | None = None


class ReturnedArrays:
    """The last array that a function returned, and whether it was overwritten by a later call.

    overwritten: whether some array was
    """

    def __init__(self) -> None:
        self.overwritten = False
        self._last: NDArray[Any] | None = None
        self._kept: NDArray[Any] | None = None

    def after(self, returned: object) -> object:
        """What the function returns, compared with what it returned before."""
        if self._last is not None and self._kept is not None and not self.overwritten:
            self.overwritten = not np.array_equal(self._last, self._kept, equal_nan=self._last.dtype.kind == "f")
        self._last = returned if isinstance(returned, np.ndarray) else None
        self._kept = None if self._last is None else self._last.copy()
        return returned


@dataclass(frozen=True, eq=False)
class FunctionUnderTest:
    """A function under test.

    order: number of our joint at each place of the function's arrays (n,)
    batched: it takes all states at once, arrays (N, n), and answers (N, …)
    loaded: it takes external wrenches as its last argument, where functions of its kind do
    """

    known: Quantity
    function: Callable[..., object] | BatchFunction
    order: NDArray[np.intp]
    batched: bool = False
    loaded: bool = False
    returned: ReturnedArrays = field(default_factory=ReturnedArrays)

    @property
    def name(self) -> str:
        return self.known.name

    @property
    def arguments(self) -> tuple[str, ...]:
        """Names of its arguments."""
        return self.known.called_with(self.loaded)

    def __call__(self, *arguments: Array) -> Array:
        """The answers at N states, in our joint order: arguments (N, …) each.

        External wrenches are zero if they are left out. Raises FunctionFailure where a state has no answer.
        """
        if len(arguments) < len(self.arguments):
            arguments = (*arguments, np.zeros((*arguments[0].shape, BODY_DOF)))
        answers = self.ask(*arguments)
        for message in answers.failures.values():
            raise FunctionFailure(message)
        return answers.values

    def ask(self, *arguments: Array) -> Answers:
        """The answers at N states, in our joint order. Raises FunctionFailure where no state has one."""
        changed: set[str] = set()
        all_answers = list(self._answers(arguments, changed))
        failures = {k: str(answer) for k, answer in enumerate(all_answers) if isinstance(answer, FunctionFailure)}
        values = [answer for answer in all_answers if not isinstance(answer, FunctionFailure)]
        if not values:
            raise next(answer for answer in all_answers if isinstance(answer, FunctionFailure))
        if len({value.shape for value in values}) > 1:
            shapes = " and ".join(sorted({str(value.shape) for value in values}))
            raise FunctionFailure(f"{self.name} returned different shapes at different states: {shapes}")
        answered = np.array([k not in failures for k in range(len(all_answers))])
        found = self._in_our_order(np.stack(values))
        decimals = found if found.dtype == object else None
        return Answers(found.astype(float), answered, failures, frozenset(changed), decimals)

    def function_arguments(self, row: Sequence[Array]) -> dict[str, Array]:
        """The arguments of one state as the function gets them, by name; copies."""
        return {name: x[self.order] for name, x in zip(self.arguments, row, strict=True)}

    def _answers(self, arguments: tuple[Array, ...], changed: set[str]) -> Iterator[Array | FunctionFailure]:
        """The answer at each state, or what was wrong; adds names of changed arguments to `changed`."""
        if isinstance(self.function, BatchFunction):
            states = [self.function_arguments(row) for row in zip(*arguments, strict=True)]
            shape = self.known.shape_for(len(self.order))
            for answer, state in zip(self.function.answers(self.name, states, shape), states, strict=True):
                if isinstance(answer, Refusal):
                    yield FunctionFailure(f"{self.name} has no answer: {answer.reason}; at {_where(state)}")
                else:
                    yield answer
        elif self.batched:
            given = [x[:, self.order] for x in arguments]
            yield from self._call(self.function, dict(zip(self.arguments, given, strict=True)), len(given[0]), changed)
        else:
            for row in zip(*arguments, strict=True):
                try:
                    yield self._call(self.function, self.function_arguments(row), None, changed)
                except FunctionFailure as failure:
                    yield failure

    def _call(
        self, function: Callable[..., object], arguments: dict[str, Array], count: int | None, changed: set[str]
    ) -> Array:
        """One call; count: the number of states, None for a single one."""
        kept = {name: x.copy() for name, x in arguments.items()}
        try:
            returned = self.returned.after(function(*arguments.values()))
        except (Exception, SystemExit) as error:  # user code may raise anything
            where = "" if count else f"; at {_where(kept)}"
            raise FunctionFailure(f"{self.name} raised {in_words(error)}{_line(error)}{where}") from error
        changed |= {name for name, x in arguments.items() if not np.array_equal(x, kept[name])}
        return self._checked(self._real(returned), count)

    def _checked(self, answer: Array, count: int | None) -> Array:
        """Raises FunctionFailure for a wrong shape."""
        n = len(self.order)
        shape = self.known.shape_for(n) if count is None else (count, *self.known.shape_for(n))
        if len(shape) == answer.ndim and all(
            size in (None, there) for size, there in zip(shape, answer.shape, strict=True)
        ):
            return answer
        expected = ", ".join("p" if size is None else str(size) for size in shape)
        called = f"one state at a time, arrays of shape ({n},)"
        if count is not None:
            called = f"all states at once, arrays of shape ({count}, {n})"
        raise FunctionFailure(
            f"{self.name} returned shape {answer.shape}, expected ({expected}{',' if len(shape) == 1 else ''}): it is "
            f"called with {called}"
        )

    def _real(self, returned: object) -> Array:
        try:
            if returned is None:
                raise TypeError("a return is missing")
            if np.ma.is_masked(returned):
                raise TypeError("some of its entries are masked; give numbers in their place")
            answer = np.asarray(returned)
            if np.iscomplexobj(answer):
                if np.abs(answer.imag).max(initial=0.0) != 0:
                    raise TypeError(f"it has imaginary parts of up to {np.abs(answer.imag).max():.2g}")
                answer = answer.real
            return answer.astype(float)
        except (TypeError, ValueError) as error:
            raise FunctionFailure(
                f"{self.name} returned {type(returned).__name__}, which is no array of real numbers: {error}"
            ) from error

    def _in_our_order(self, answer: Array) -> Array:
        """Every axis of joints or of parameters in our order; leading axes are states."""
        for axis, size in enumerate(reversed(self.known.shape), start=1):
            if size == "n":
                answer = np.take(answer, np.argsort(self.order), axis=-axis)
            elif size == "10 n":
                columns = BODY_PARAMETERS * np.argsort(self.order)[:, None] + np.arange(BODY_PARAMETERS)
                answer = np.take(answer, columns.ravel(), axis=-axis)
        return answer


OWN_FILES = str(Path(__file__).parents[2])
"""Folder of the files that are no user code."""


def _where(arguments: Mapping[str, Array]) -> str:
    return ", ".join(f"{name} = {x.tolist()}" for name, x in arguments.items())


def _line(error: BaseException) -> str:
    """The place in the file of the function where an exception was raised, or the call that led to it; "" for compiled
    ones."""
    frames = [x for x in traceback.extract_tb(error.__traceback__) if not x.filename.startswith(OWN_FILES)]
    own = [frame for frame in frames if frame.filename == frames[0].filename]
    return f" ({own[-1].filename}, line {own[-1].lineno}, in {own[-1].name})" if own else ""


def joint_order(model: RobotModel, names: Sequence[str] | None) -> NDArray[np.intp]:
    """Number of our joint at each place of another order. Raises InvalidInput unless it names every joint once."""
    if names is None:
        return np.arange(model.n_bodies)
    if isinstance(names, str) or sorted(names) != sorted(model.joint_names):
        raise InvalidInput(
            f"joint_names is {names!r}; it must name each of the {model.n_bodies} joints once: "
            f"{', '.join(model.joint_names)}"
        )
    return np.array([model.joint_names.index(name) for name in names])
