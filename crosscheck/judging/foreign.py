"""A foreign function: called in its own joint order, its answers checked for shape."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.functions.known_function import KnownFunction
from graphdyn import GraphDynError, InvalidInput, RobotModel
from graphdyn.layout import BODY_PARAMETERS, Array


def in_words(error: BaseException) -> str:
    """Type and message, where there is one: "ValueError: out of ideas", "GeneratorExit"."""
    message = str(error)
    return f"{type(error).__name__}: {message}" if message else type(error).__name__


class ForeignFailure(GraphDynError):
    """A foreign function raised an exception or returned an array of the wrong shape."""


@dataclass(frozen=True, eq=False)
class Answers:
    """The answers at N states.

    values: in our joint order, of the states that were answered   (M, …)
    answered: which ones these are                          (N,)
    failures: message by number of the state
    changed: names of the arguments that the function changed
    """

    values: Array
    answered: NDArray[np.bool_]
    failures: dict[int, str]
    changed: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class ForeignFunction:
    """A function under test.

    order: number of our joint at each place of the foreign arrays (n,)
    batched: it takes all states at once, arrays (N, n), and answers (N, …)
    loaded: it takes external wrenches as its last argument, where functions of its kind do
    """

    known: KnownFunction
    function: Callable[..., object]
    order: NDArray[np.intp]
    batched: bool = False
    loaded: bool = False

    @property
    def name(self) -> str:
        return self.known.name

    @property
    def arguments(self) -> tuple[str, ...]:
        """Names of its arguments."""
        return self.known.called_with(self.loaded)

    def __call__(self, *arguments: Array) -> Array:
        """The answers at N states, in our joint order: arguments (N, …) each.

        External wrenches are zero if they are left out. Raises ForeignFailure where a state has no answer.
        """
        if len(arguments) < len(self.arguments):
            arguments = (*arguments, np.zeros((*arguments[0].shape, 6)))
        answers = self.ask(*arguments)
        for message in answers.failures.values():
            raise ForeignFailure(message)
        return answers.values

    def ask(self, *arguments: Array) -> Answers:
        """The answers at N states, in our joint order. Raises ForeignFailure where no state has one."""
        if self.batched:
            values, changed = self._call([x[:, self.order] for x in arguments], len(arguments[0]))
            return Answers(values, np.ones(len(values), dtype=bool), {}, tuple(sorted(changed)))
        found: list[Array] = []
        failures: dict[int, str] = {}
        all_changed: set[str] = set()
        first = None
        for k, row in enumerate(zip(*arguments, strict=True)):
            try:
                value, changed = self._call([x[self.order] for x in row], None)
            except ForeignFailure as failure:
                failures[k] = str(failure)
                first = first or failure
            else:
                found.append(value)
                all_changed |= changed
        if first is not None and not found:
            raise first
        answered = np.array([k not in failures for k in range(len(arguments[0]))])
        return Answers(np.stack(found), answered, failures, tuple(sorted(all_changed)))

    def foreign_arguments(self, row: Sequence[Array]) -> dict[str, Array]:
        """The arguments of one state as the function gets them, by name."""
        return {name: x[self.order] for name, x in zip(self.arguments, row, strict=True)}

    def _call(self, arguments: list[Array], count: int | None) -> tuple[Array, set[str]]:
        """The answer in our order, and the names of the changed arguments; count: of states, None for a single one."""
        kept = [x.copy() for x in arguments]
        try:
            returned = self.function(*arguments)
        except (Exception, SystemExit) as error:  # foreign code may raise anything
            where = "" if count else f"; at {self._said(kept)}"
            raise ForeignFailure(f"{self.name} raised {in_words(error)}{_line(error)}{where}") from error
        changed = {
            name
            for name, x, y in zip(self.arguments, arguments, kept, strict=True)
            if not np.array_equal(x, y, equal_nan=True)
        }
        return self._in_our_order(self._checked(self._real(returned), count)), changed

    def _said(self, arguments: list[Array]) -> str:
        return ", ".join(f"{name} = {x.tolist()}" for name, x in zip(self.arguments, arguments, strict=True))

    def _checked(self, answer: Array, count: int | None) -> Array:
        """Raises ForeignFailure for a wrong shape."""
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
        raise ForeignFailure(
            f"{self.name} returned shape {answer.shape}, expected ({expected}{',' if len(shape) == 1 else ''}): it is "
            f"called with {called}"
        )

    def _real(self, returned: object) -> Array:
        try:
            if returned is None:
                raise TypeError("a return is missing")
            answer = np.asarray(returned)
            if np.iscomplexobj(answer):
                raise TypeError("it has imaginary parts")
            return answer.astype(float)
        except (TypeError, ValueError) as error:
            raise ForeignFailure(
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


def _line(error: BaseException) -> str:
    """Where in the file of the function an exception was raised, or the call that led to it; "" for compiled ones."""
    frames = traceback.extract_tb(error.__traceback__)[1:]  # the first one is ours
    own = [frame for frame in frames if frame.filename == frames[0].filename]
    return f" ({own[-1].filename}, line {own[-1].lineno}, in {own[-1].name})" if own else ""


def joint_order(model: RobotModel, names: Sequence[str] | None) -> NDArray[np.intp]:
    """Number of our joint at each place of a foreign order. Raises InvalidInput unless it names every joint once."""
    if names is None:
        return np.arange(model.n_bodies)
    if isinstance(names, str) or sorted(names) != sorted(model.joint_names):
        raise InvalidInput(
            f"joint_names is {names!r}; it must name each of the {model.n_bodies} joints once: "
            f"{', '.join(model.joint_names)}"
        )
    return np.array([model.joint_names.index(name) for name in names])
