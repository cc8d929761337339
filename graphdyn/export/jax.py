"""The functions of a robot for JAX: compiled, vectorized and differentiated by its transformations.

    aba = graphdyn.export.jax.function(model, "joint_accelerations")  # python -m pip install 'graphdyn[jax]'
    by_torque = jax.jacfwd(aba, argnums=2)(q, v, tau)

The operations are those of the recorded recursion, on JAX arrays of all samples.
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import cache, partial
from math import prod
from typing import Any

import numpy as np

from graphdyn.errors import InvalidInput, not_installed
from graphdyn.export.c.dialect import Precision
from graphdyn.export.functions import AS_THEY_ARE, ExportChoices, ExportedFunction
from graphdyn.export.recorded import ARITHMETIC, recorded_function
from graphdyn.export.steps import KINDS, EqualSteps, in_steps
from graphdyn.model.robot_model import RobotModel
from graphdyn.scalars.expressions import operands

__all__ = ["function"]

PART_OPERATIONS = 300
"""Operations that XLA may fuse with each other. In a fusion it computes again for each result what several results
share: of the 1565 operations of solve_kkt of a UR5 it would make 44,000, and take seven times as long for a batch.
Measured with joint_accelerations in parts of 100, 300 and 600: the gradient takes 7.4, 5.3 and 4.7 s to compile, and
then 1.4, 2.2 and 3.7 µs a state."""

LONG_PROGRAM = 2000
"""Operations from which XLA gets equal steps in a loop (graphdyn.export.steps). These compile in a second however many
they are, and take some ten times as long for each state, a hundred times for gradients of many states. In parts,
reaction_derivatives of a UR5 compiles for minutes."""

STEP_OPERATIONS = 64


def function(
    model: RobotModel, name: str, choices: ExportChoices = AS_THEY_ARE, *, precision: Precision = "double"
) -> Callable[..., Any]:
    """A verb of this robot as a pure function of JAX arrays, for jit, vmap, grad, jacfwd and jacrev of any order.

    Arguments have the names, order, shapes and units of the verb; their leading dimensions broadcast. The answer is an
    array, or a named tuple of arrays of a verb that answers several. Outputs without entries are left out.
    model: of a robot with loops, states have to be closed; what its loops leave undetermined is NaN
    name: of a verb, such as "joint_torques"
    choices: whether wrenches act on the bodies and the base moves, and of which frame it speaks
    precision: "double", for which JAX has to be told that it may (jax_enable_x64), or "single": all arguments are
        rounded to seven digits

    Raises InvalidInput for a name that is none, for a verb that has no compiled form for this robot, and where JAX is
    not installed or would round double precision to single; UnknownFrame; SingularMassMatrix where torques do not
    determine the accelerations. In single states, as in a singular pose of loops, accelerations come out as infinity
    or NaN. The function raises InvalidInput for arrays of other shapes.
    """
    try:
        import jax
    except ImportError:
        raise InvalidInput(not_installed("jax", "jax")) from None
    replay = _Replay(jax, recorded_function(model, name, choices), precision)
    replay.dtype()  # refused now, not at the first call

    def computed(*arrays: Any) -> Any:
        return replay(arrays)

    computed.__name__ = computed.__qualname__ = name
    computed.__doc__ = f"{replay.recorded.verb}, of robot '{model.name}'"
    compiled: Callable[..., Any] = jax.jit(computed)
    return compiled


@dataclass(frozen=True)
class _Part:
    """Operations one after the other.

    needed: values of others that they take; given: those that others take; compute: the second from the first
    """

    needed: tuple[int, ...]
    given: tuple[int, ...]
    compute: Callable[..., list[Any]]


class _Replay:
    """A recorded function on the arrays of JAX."""

    def __init__(self, jax: Any, recorded: ExportedFunction, precision: Precision) -> None:
        self.recorded, self._jax, self._precision = recorded, jax, precision
        self._operations = {**ARITHMETIC, "sine": jax.numpy.sin, "cosine": jax.numpy.cos}
        numbers = range(len(recorded.program.operations))
        self._constants = {k: value for k in numbers if (value := recorded.program.constant(k)) is not None}
        self._steps = (
            in_steps(recorded.program, STEP_OPERATIONS) if recorded.program.arithmetic >= LONG_PROGRAM else None
        )
        self._parts = [] if self._steps else self._in_parts()

    def __call__(self, arrays: Sequence[Any]) -> Any:
        batch, values = self._inputs(arrays)
        columns = self._in_loop(self._steps, values, batch) if self._steps else self._part_by_part(values, batch)
        recorded = self.recorded
        outputs = [columns[array].reshape(*batch, *recorded.shape(array)) for array in recorded.outputs]
        return outputs[0] if len(outputs) == 1 else _answer(recorded.name, tuple(recorded.outputs))(*outputs)

    def dtype(self) -> Any:
        """Type of arguments and results. Raises InvalidInput where JAX does not compute in double precision."""
        if self._precision == "double" and not self._jax.config.jax_enable_x64:
            raise InvalidInput(
                "JAX rounds all numbers to single precision; say jax.config.update('jax_enable_x64', True) before "
                "anything else, or ask for precision='single'"
            )
        return self._jax.numpy.float64 if self._precision == "double" else self._jax.numpy.float32

    def _inputs(self, arrays: Sequence[Any]) -> tuple[tuple[int, ...], dict[int, Any]]:
        """The common leading dimensions, and the values of constants and inputs by number of operation."""
        recorded, names = self.recorded, tuple(self.recorded.inputs)
        if len(arrays) != len(names):
            raise InvalidInput(f"{len(arrays)} arrays given; {recorded.name} takes {', '.join(names)}")
        batches, columns = [], {}
        for name, given in zip(names, arrays, strict=True):
            array, trailing = self._jax.numpy.asarray(given, self.dtype()), recorded.shape(name)
            if array.shape[-len(trailing) :] != trailing:
                expected = ", ".join(["…", *map(str, trailing)])
                raise InvalidInput(
                    f"{name} has shape {array.shape}, expected ({expected}) for robot '{recorded.model.name}'"
                )
            batches.append(array.shape[: array.ndim - len(trailing)])
            columns[name] = array.reshape(*batches[-1], prod(trailing))
        try:
            batch = np.broadcast_shapes(*batches)
        except ValueError as error:
            shapes = ", ".join(f"{name} {given.shape}" for name, given in zip(names, arrays, strict=True))
            raise InvalidInput(f"leading dimensions do not broadcast: {shapes}") from error
        values = dict(self._constants)
        for number, (kind, *of) in enumerate(recorded.program.operations):
            if kind == "input":
                name, column = of
                values[number] = columns[name][..., column]
        return batch, values

    def _part_by_part(self, values: Mapping[int, Any], batch: tuple[int, ...]) -> dict[str, Any]:
        """The outputs, a column for each entry."""
        known = dict(values)
        for part in self._parts:
            with self._apart():
                found = part.compute(*(known[k] for k in part.needed))
            known.update(zip(part.given, found, strict=True))
        return {array: self._stacked(known, ks, batch, -1) for array, ks in self.recorded.program.outputs.items()}

    def _stacked(self, known: Mapping[int, Any], numbers: Sequence[int], batch: tuple[int, ...], axis: int) -> Any:
        numpy, dtype = self._jax.numpy, self.dtype()
        return numpy.stack([numpy.broadcast_to(numpy.asarray(known[k], dtype), batch) for k in numbers], axis)

    def _in_loop(self, steps: EqualSteps, values: Mapping[int, Any], batch: tuple[int, ...]) -> dict[str, Any]:
        """The same outputs. The values of all samples are a row."""
        numpy, lax = self._jax.numpy, self._jax.lax
        computed = self._computed(steps.before, tuple(values), steps.before, *values.values())
        known = {**values, **dict(zip(steps.before, computed, strict=True))}
        first = self._stacked(known, steps.first, batch, 0)
        rows = numpy.zeros((steps.rows, *batch), self.dtype()).at[: len(steps.first)].set(first)

        def step(state: tuple[Any, Any], operations: Any) -> tuple[tuple[Any, Any], None]:
            rows, place = state
            left, right, kind = operations
            kind = numpy.broadcast_to(kind.reshape(-1, *(1 for _ in batch)), (STEP_OPERATIONS, *batch))
            x, y = rows[left], rows[right]
            divisor = numpy.where(kind == KINDS.index("/"), y, 1.0)  # else 0 / 0 of others spoils derivatives
            found = lax.select_n(kind, x * y, x + y, x - y, x / divisor, -x)
            return (lax.dynamic_update_slice_in_dim(rows, found, place, 0), place + STEP_OPERATIONS), None

        start = numpy.asarray(len(steps.first), numpy.int32)
        (rows, _), _ = lax.scan(step, (rows, start), (steps.left, steps.right, steps.kind))
        outputs = self.recorded.program.outputs
        return {
            array: numpy.moveaxis(rows[np.array([steps.row[k] for k in ks])], 0, -1) for array, ks in outputs.items()
        }

    def _apart(self) -> AbstractContextManager[None]:
        """Keeps XLA from merging the parts again, where it compiles for a processor."""
        if self._jax.default_backend() != "cpu":
            return nullcontext()
        from jax.experimental.xla_metadata import set_xla_metadata

        apart: AbstractContextManager[None] = set_xla_metadata(inlineable="false")
        return apart

    def _in_parts(self) -> list[_Part]:
        """The program in parts of PART_OPERATIONS."""
        program, parts = self.recorded.program, list[_Part]()
        computing = [k for k, (kind, *_) in enumerate(program.operations) if kind not in ("constant", "input")]
        wanted = {k for numbers in program.outputs.values() for k in numbers}
        for first in reversed(range(0, len(computing), PART_OPERATIONS)):
            part = computing[first : first + PART_OPERATIONS]
            given = tuple(k for k in part if k in wanted)
            taken = {k for number in part for k in operands(program.operations[number])}
            needed = tuple(sorted(taken - set(part) - self._constants.keys()))
            wanted |= taken
            parts.append(_Part(needed, given, self._jax.jit(partial(self._computed, part, needed, given))))
        return parts[::-1]

    def _computed(self, part: Sequence[int], needed: Sequence[int], given: Sequence[int], *values: Any) -> list[Any]:
        known = {**self._constants, **dict(zip(needed, values, strict=True))}
        for number in part:
            kind, *arguments = self.recorded.program.operations[number]
            known[number] = self._operations[kind](*(known[k] for k in arguments))
        return [known[k] for k in given]


@cache
def _answer(name: str, outputs: tuple[str, ...]) -> Callable[..., Any]:
    """One class for equal answers, as JAX tells trees apart by their classes."""
    return namedtuple(name, outputs)
