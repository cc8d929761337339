"""Automatic differentiation of recorded scalars: derivatives are recorded beside them, and compiled like them.

Reverse mode, Griewank and Walther, "Evaluating Derivatives", 2008, chapter 3: one sweep from a result back to all
variables. Any recursion can be differentiated; no derivative is written by hand.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from typing import Any

import numpy as np

from graphdyn.scalars.expressions import Expression, Recorder, operands
from graphdyn.scalars.vectors import Scalars, zeros


def jacobian(results: Sequence[Any], variables: Sequence[Any], held: Sequence[Any] = ()) -> Scalars:
    """∂results/∂variables (len(results), len(variables)). A result may be a float, and depends on nothing then.

    variables: inputs of the program, columns of Recorder.inputs
    held: scalars that stay what they are while the variables change, although they are computed from them
    """
    rows = [gradient(result, variables, held) for result in results]
    return np.array(rows, dtype=object).reshape(len(results), len(variables))


def gradient(result: Any, variables: Sequence[Expression], held: Sequence[Any] = ()) -> Scalars:
    """∂result/∂variables (len(variables),), of scalars as in jacobian."""
    if not isinstance(result, Expression):
        return zeros(len(variables))
    recorder = result.recorder
    needed = _needed(recorder, [result.number], _as_recorded(held))
    counts = _dependent(recorder, needed, {x.number for x in variables})
    # by how much the result grows with each operation, once all operations after it are counted
    growth: dict[int, Any] = {result.number: 1.0}
    for number in reversed(needed):
        if number in counts and number in growth:
            for k, part in _parts(recorder, number, growth[number]):
                growth[k] = growth[k] + part if k in growth else part
    return np.array([growth.get(x.number, 0.0) for x in variables], dtype=object)


def directional(results: Sequence[Any], variables: Sequence[Expression], direction: Sequence[Any]) -> list[Any]:
    """Σ ∂results/∂variables direction (len(results),): forward mode, one sweep for all results."""
    expressions = [result for result in results if isinstance(result, Expression)]
    if not expressions:
        return [0.0] * len(results)
    recorder = expressions[0].recorder
    rates: dict[int, Any] = {x.number: rate for x, rate in zip(variables, direction, strict=True)}
    for number in _needed(recorder, [result.number for result in expressions]):
        if number not in rates and any(k in rates for k in operands(recorder.operations[number])):
            first, *others = [rates[k] * part for k, part in _parts(recorder, number, 1.0) if k in rates]
            rates[number] = sum(others, first)
    return [rates.get(result.number, 0.0) if isinstance(result, Expression) else 0.0 for result in results]


def substituted(results: Sequence[Any], values: Mapping[Expression, Any]) -> list[Any]:
    """The results with other scalars in place of inputs."""
    expressions = [result for result in results if isinstance(result, Expression)]
    if not expressions:
        return list(results)
    recorder = expressions[0].recorder
    new: dict[int, Any] = {x.number: value for x, value in values.items()}
    for number in _needed(recorder, [result.number for result in expressions]):
        if number not in new:
            kind, *arguments = recorder.operations[number]
            new[number] = recorder.scalar(number) if kind in ("constant", "input") else _computed(kind, new, arguments)
    return [new[result.number] if isinstance(result, Expression) else result for result in results]


def _computed(kind: str, values: Mapping[int, Any], arguments: Sequence[int]) -> Any:
    x, *others = (values[k] for k in arguments)
    if kind == "negate":
        return -x
    if kind in ("sine", "cosine"):
        return getattr(x, kind)
    (y,) = others
    return x + y if kind == "+" else x - y if kind == "-" else x * y if kind == "*" else x / y


def _as_recorded(scalars: Sequence[Any]) -> set[int]:
    """The operations that stand for these scalars: with -x also x, because recording moves signs outside."""
    numbers: set[int] = set()
    for x in scalars:
        if isinstance(x, Expression):
            kind, *arguments = x.recorder.operations[x.number]
            numbers |= {x.number, *(arguments if kind == "negate" else ())}
    return numbers


def _needed(recorder: Recorder, numbers: Iterable[int], held: Set[int] = frozenset()) -> list[int]:
    """The operations that these need, themselves included, without those held, in order: each after its operands."""
    found = set(held)
    pending = list(numbers)
    while pending:
        number = pending.pop()
        if number not in found:
            found.add(number)
            pending += operands(recorder.operations[number])
    return sorted(found - held)


def _dependent(recorder: Recorder, needed: Iterable[int], variables: set[int]) -> set[int]:
    """The ones of the needed operations that depend on a variable."""
    found: set[int] = set()
    for number in needed:
        if number in variables or not found.isdisjoint(operands(recorder.operations[number])):
            found.add(number)
    return found


def _parts(recorder: Recorder, number: int, growth: Any) -> list[tuple[int, Any]]:
    """growth times the partial derivatives of an operation, with the operand that each belongs to."""
    kind, *arguments = recorder.operations[number]
    if kind in ("constant", "input"):
        return []
    x, *others = (recorder.scalar(k) for k in arguments)
    first, *further = arguments
    if kind == "negate":
        return [(first, -growth)]
    if kind == "sine":
        return [(first, growth * x.cosine)]
    if kind == "cosine":
        return [(first, -(growth * x.sine))]
    (second,), (y,) = further, others
    if kind == "+":
        return [(first, growth), (second, growth)]
    if kind == "-":
        return [(first, growth), (second, -growth)]
    if kind == "*":
        return [(first, growth * y), (second, growth * x)]
    # d(x / y) = dx / y - (x / y) dy / y, with x / y as it is recorded
    quotient = growth / y
    return [(first, quotient), (second, -(quotient * recorder.scalar(number)))]
