"""A function of one's own, recorded once, compiled, and differentiated like the dynamics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.compiler.running import Prepared, chosen_backend
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.scalars.differentiation import jacobian
from graphdyn.scalars.expressions import Expression, Recorder

__all__ = ["RecordedFunction"]

VALUE, JACOBIAN = "value", "jacobian"


class RecordedFunction:
    """y = f(x, …) of arrays, and its derivatives by reverse automatic differentiation: a spring, a friction, a cost.

    function: takes a vector of scalars for each input, and answers one of them or a sequence; it is called once. It may
        use +, -, *, /, integer powers, np.sin and np.cos, and NumPy's operations made of these (sums, @, np.cross); no
        comparisons, since it is recorded for all values at once
    widths: scalars of each input, in the order of its arguments

    Raises InvalidInput for other operations, naming the first, and where what it answers are not scalars.

    Calls take arrays (…, width), whose leading dimensions broadcast; NaN and infinity come out as NaN in their own
    sample. Angles are accurate up to 1e6 rad. Pickles hold what was recorded, not the function: a lambda will do.
    """

    def __init__(self, function: Callable[..., Any], *widths: int) -> None:
        recorder = Recorder()
        self.widths = widths
        self._names = [f"x{k}" for k in range(len(widths))]
        columns = [recorder.inputs(name, width) for name, width in zip(self._names, widths, strict=True)]
        results = _scalars(function, [np.array(column, dtype=object) for column in columns])
        self.size = len(results)
        flat = [x for column in columns for x in column]
        outputs = {VALUE: results, JACOBIAN: list(jacobian(results, flat).ravel())}
        self._prepared = {
            name: Prepared(recorder.program({name: scalars}, {}), chosen_backend()) for name, scalars in outputs.items()
        }

    def __call__(self, *arrays: ArrayLike) -> Array:
        """f (…, size). Raises InvalidInput for wrong shapes."""
        return self._run(VALUE, arrays, (self.size,))

    def jacobian(self, *arrays: ArrayLike) -> tuple[Array, ...]:
        """∂f/∂x (…, size, width), one for each input. Raises InvalidInput for wrong shapes."""
        whole = self._run(JACOBIAN, arrays, (self.size, sum(self.widths)))
        return tuple(np.split(whole, np.cumsum(self.widths)[:-1], axis=-1))

    def _run(self, output: str, arrays: Sequence[ArrayLike], trailing: tuple[int, ...]) -> Array:
        if len(arrays) != len(self.widths):
            raise InvalidInput(f"{len(arrays)} arrays given; this function takes {len(self.widths)}")
        given = [as_floats(f"argument {k}", array) for k, array in enumerate(arrays, start=1)]
        for k, (array, width) in enumerate(zip(given, self.widths, strict=True), start=1):
            if array.shape[-1:] != (width,):
                raise InvalidInput(f"argument {k} has shape {array.shape}, expected (…, {width})")
        try:
            batch = np.broadcast_shapes(*(array.shape[:-1] for array in given))
        except ValueError as error:
            shapes = ", ".join(str(array.shape) for array in given)
            raise InvalidInput(f"leading dimensions do not broadcast: {shapes}") from error
        count = int(np.prod(batch))
        rows = {
            name: np.ascontiguousarray(np.broadcast_to(array, (*batch, width)).reshape(count, width))
            for name, array, width in zip(self._names, given, self.widths, strict=True)
        }
        out = np.empty((count, int(np.prod(trailing))))
        if count:
            self._prepared[output].backend.bind(rows, {output: out})(0, count)
        return out.reshape(*batch, *trailing)


def _scalars(function: Callable[..., Any], columns: Sequence[Any]) -> list[Any]:
    try:
        answer = list(np.ravel(np.array(function(*columns), dtype=object)))
    except (TypeError, AttributeError, ZeroDivisionError) as error:
        raise InvalidInput(
            f"{_name(function)} cannot be recorded: {error}; it may use +, -, *, /, **, sin, cos"
        ) from error
    for x in answer:
        if not isinstance(x, Expression | float | int | np.number):
            raise InvalidInput(f"{_name(function)} answers {type(x).__name__}; it should answer scalars")
    return answer


def _name(function: Callable[..., Any]) -> str:
    return getattr(function, "__name__", type(function).__name__)
