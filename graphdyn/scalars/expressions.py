"""Scalars that remember how they were computed: a recursion that is run on them is recorded as a program.

A scalar is a float, the same for all samples, or an Expression, with a value for each sample. Operations on floats are
carried out while recording, and 0 x, 1 x, x + 0, x / 1 record nothing. No operation is recorded twice.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from graphdyn.display import short_repr

Operation = Literal["constant", "input", "+", "-", "*", "/", "negate", "sine", "cosine"]
Recorded = tuple[Any, ...]
"""An operation and its operands: numbers of earlier operations, a value, or the name and column of an input."""

MULTIPLIED_COLUMNS = "columns"
"""The output of a program whose columns are not stored but multiplied with each other (graphdyn.compiler.gram.gram)."""

Guard = Literal["finite", "squares", "minimum"]


@dataclass(frozen=True)
@short_repr
class Program:
    """Straight-line code over one sample, parents of an operation before it.

    operations: (operation, operands); operands are numbers of earlier operations, for a constant its value, for an
        input the name of the array and the column
    inputs: widths of the input arrays, by name
    outputs: operations whose values are the columns of each output array, by name
    guards: what to remember of all samples together: operations by kind; "finite" is 0 if all are finite and NaN if
        not, "squares" the sum of x², "minimum" the smallest x without regard to NaN
    """

    operations: tuple[Recorded, ...]
    inputs: dict[str, int]
    outputs: dict[str, tuple[int, ...]]
    guards: dict[Guard, tuple[int, ...]]

    def constant(self, number: int) -> float | None:
        """The value of an operation that is a constant."""
        kind, *operands = self.operations[number]
        return float(operands[0]) if kind == "constant" else None

    @cached_property
    def arithmetic(self) -> int:
        """Number of operations that compute something: the cost of a sample."""
        return sum(operation not in ("constant", "input") for operation, *_ in self.operations)

    @property
    def length(self) -> int:
        """Size of its machine code, in operations: the cost of compiling. A column that is written counts as thirty."""
        columns = sum(self.constant(number) is None for numbers in self.outputs.values() for number in numbers)
        return self.arithmetic + 30 * columns


class Recorder:
    """Numbers every operation that the recursions ask for, each once."""

    def __init__(self) -> None:
        self.operations: list[Recorded] = []
        self.expressions: list[Expression] = []
        self._known: dict[Recorded, Expression] = {}
        self._inputs: dict[str, int] = {}

    def inputs(self, name: str, width: int) -> list[Expression]:
        """The columns of an input array."""
        self._inputs[name] = width
        return [self.operation("input", name, column) for column in range(width)]

    def placeholders(self, name: str, count: int) -> list[Expression]:
        """Inputs of no array: graphdyn.scalars.differentiation.substituted has to put others in their place."""
        return [self.operation("input", f"in place of {name}", column) for column in range(count)]

    def operation(self, kind: Operation, *operands: Any) -> Expression:
        key = (kind, *operands)
        expression = self._known.get(key)
        if expression is None:
            negated = self.expressions[operands[0]] if kind == "negate" else None
            expression = self._known[key] = Expression(self, len(self.operations), negated)
            self.operations.append(key)
            self.expressions.append(expression)
        return expression

    def scalar(self, number: int) -> Any:
        """What an operation gives: a float where it is a constant."""
        kind, *arguments = self.operations[number]
        return arguments[0] if kind == "constant" else self.expressions[number]

    def number(self, scalar: object) -> int:
        """The operation that gives a scalar."""
        if isinstance(scalar, Expression):
            return scalar.number
        return self.operation("constant", float(scalar)).number  # type: ignore[arg-type]

    def program(self, outputs: Mapping[str, Sequence[object]], guards: Mapping[Guard, Sequence[object]]) -> Program:
        """What it takes to compute these outputs and guards, and nothing else."""
        wanted = {name: [self.number(scalar) for scalar in scalars] for name, scalars in outputs.items()}
        guarded = {kind: [self.number(scalar) for scalar in scalars] for kind, scalars in guards.items()}
        return program_of(self.operations, self._inputs, wanted, guarded)


class Expression:
    """A scalar that differs from sample to sample.

    negated: x where this is -x
    """

    __slots__ = ("negated", "number", "recorder")

    def __init__(self, recorder: Recorder, number: int, negated: Expression | None = None) -> None:
        self.recorder = recorder
        self.number = number
        self.negated = negated

    def __add__(self, other: object) -> object:
        if isinstance(other, Expression):
            if self.negated is not None:
                return other - self.negated
            return self._commuting("+", other) if other.negated is None else self - other.negated
        if isinstance(other, np.ndarray):
            return NotImplemented
        if other == 0.0:
            return self
        return self._commuting("+", other) if self.negated is None else other - self.negated

    __radd__ = __add__

    def __sub__(self, other: object) -> object:
        if isinstance(other, Expression):
            if other.negated is not None:
                return self + other.negated
        elif isinstance(other, np.ndarray):
            return NotImplemented
        elif other == 0.0:
            return self
        return self.recorder.operation("-", self.number, self.recorder.number(other))

    def __rsub__(self, other: object) -> object:
        if other == 0.0:
            return -self
        if self.negated is not None:
            return self.negated + other
        return self.recorder.operation("-", self.recorder.number(other), self.number)

    def __mul__(self, other: object) -> object:
        if isinstance(other, Expression):
            if other.negated is not None:
                return -(self * other.negated)  # type: ignore[operator]
        elif isinstance(other, np.ndarray):
            return NotImplemented
        elif other == 0.0:
            return 0.0
        elif other == 1.0:
            return self
        elif other == -1.0:
            return -self
        if self.negated is not None:  # signs outside: what differs only in sign is computed once
            return -(self.negated * other)  # type: ignore[operator]
        return self._commuting("*", other)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> object:
        """x / y, rounded once: never a product with the reciprocal. A known zero divisor raises, as with floats."""
        if isinstance(other, np.ndarray):
            return NotImplemented
        if isinstance(other, Expression):
            if other.negated is not None:
                return -(self / other.negated)  # type: ignore[operator]
        elif other == 0.0:
            raise ZeroDivisionError("an expression is divided by a number that is known to be zero")
        elif other == 1.0:
            return self
        elif other == -1.0:
            return -self
        if self.negated is not None:
            return -(self.negated / other)  # type: ignore[operator]
        return self.recorder.operation("/", self.number, self.recorder.number(other))

    def __rtruediv__(self, other: object) -> object:
        if other == 0.0:
            return 0.0
        if self.negated is not None:
            return -(other / self.negated)  # type: ignore[operator]
        return self.recorder.operation("/", self.recorder.number(other), self.number)

    def __pow__(self, exponent: object) -> object:
        """x to an integer power, by repeated squaring: products that both back ends round alike."""
        if not isinstance(exponent, int | np.integer):
            return NotImplemented
        if exponent < 0:
            return 1.0 / self**-exponent  # type: ignore[operator]
        half = 1.0 if exponent < 2 else self ** (exponent // 2)
        even = half * half  # type: ignore[operator]
        return even * self if exponent % 2 else even

    def __pos__(self) -> Expression:
        return self

    def __neg__(self) -> Expression:
        return self.negated or self.recorder.operation("negate", self.number)

    @property
    def sine(self) -> Expression:
        return self.recorder.operation("sine", self.number)

    @property
    def cosine(self) -> Expression:
        return self.recorder.operation("cosine", self.number)

    def sin(self) -> Expression:
        """What np.sin asks of an object."""
        return self.sine

    def cos(self) -> Expression:
        """What np.cos asks of an object."""
        return self.cosine

    def _commuting(self, kind: Operation, other: object) -> Expression:
        first, second = self.number, self.recorder.number(other)
        return self.recorder.operation(kind, min(first, second), max(first, second))


def program_of(
    operations: Sequence[Recorded],
    inputs: Mapping[str, int],
    outputs: Mapping[str, Sequence[int]],
    guards: Mapping[Guard, Sequence[int]],
) -> Program:
    """The program of the operations that it takes to compute these outputs and guards."""
    needed, pending = set(), [k for numbers in (*outputs.values(), *guards.values()) for k in numbers]
    while pending:
        number = pending.pop()
        if number not in needed:
            needed.add(number)
            pending += operands(operations[number])
    order = sorted(needed)
    new = {number: position for position, number in enumerate(order)}
    return Program(
        operations=tuple(_renumbered(operations[number], new) for number in order),
        inputs=dict(inputs),
        outputs={name: tuple(new[number] for number in numbers) for name, numbers in outputs.items()},
        guards={kind: tuple(new[number] for number in numbers) for kind, numbers in guards.items()},
    )


def operands(operation: Recorded) -> tuple[int, ...]:
    """Numbers of the operations that an operation needs."""
    return () if operation[0] in ("constant", "input") else operation[1:]


def _renumbered(operation: Recorded, new: dict[int, int]) -> Recorded:
    return operation if operation[0] in ("constant", "input") else (operation[0], *(new[k] for k in operation[1:]))
