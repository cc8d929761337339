"""A program in C that compares the functions with numbers of the equations, one state at a time and all together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from graphdyn.export.c.dialect import Dialect
from graphdyn.export.c.identifiers import comment
from graphdyn.export.functions import ExportedFunction
from graphdyn.export.vectors import TOLERANCE, VECTOR_STATES, vectors
from graphdyn.layout import Array

_HEAD = """#include <math.h>
#include <stdio.h>

#include "@name@.h"

enum { STATES = @states@ };

static const double tolerance = @tolerance@;

/* Rows in which the mass matrix is nearly singular are left out: whether they are right is a matter of rounding. */
static int left_out[STATES];

/* The largest error as a share of the largest number, and whether that is too large. NAN is expected as NAN. */
static int compare(const char *what, size_t width, const @real@ *found, const @real@ *expected)
{
    double error = 0.0, scale = 0.0;
    int rows = 0;
    for (size_t k = 0; k < STATES * width; ++k) {
        const double difference = fabs((double) found[k] - (double) expected[k]);
        if (left_out[k / width])
            continue;
        rows += k % width == 0;
        if (expected[k] != expected[k] && found[k] != found[k])
            continue;
        if (!(difference <= error))
            error = difference; /* also where it is NAN, which then stays */
        if (fabs((double) expected[k]) > scale)
            scale = fabs((double) expected[k]);
    }
    if (scale > 0.0)
        error /= scale;
    printf("%-60s %.1e at %d states%s\\n", what, error, rows, error <= tolerance ? "" : "  WRONG");
    return !(error <= tolerance);
}

static int refused(const char *what, size_t row, int status)
{
    left_out[row] = status == @NAME@_SINGULAR;
    if (status != @NAME@_OK && status != @NAME@_SINGULAR)
        printf("%s returns %d  WRONG\\n", what, status);
    return status != @NAME@_OK && status != @NAME@_SINGULAR;
}
"""


def test_program(functions: Sequence[ExportedFunction], dialect: Dialect) -> str:
    """It prints the errors, and ends with exit code 1 where one is too large."""
    rng = np.random.default_rng(0)
    parts = [
        comment(["Tests the functions of this folder with numbers that graphdyn computed from the equations."]),
        dialect.filled(_HEAD, states=VECTOR_STATES, tolerance=TOLERANCE[dialect.precision]),
    ]
    for function in functions:
        x, expected = vectors(function, rng)
        parts.append("\n".join(_test(function, dialect, x, expected)))
    calls = "\n".join(f"    wrong |= test_{function.name}();" for function in functions)
    parts.append(f"int main(void)\n{{\n    int wrong = 0;\n{calls}\n    return wrong;\n}}\n")
    return "\n".join(parts)


def _test(
    function: ExportedFunction, dialect: Dialect, x: Mapping[str, Array], expected: Mapping[str, Array]
) -> Iterator[str]:
    whole, n = f"{dialect.name}_{function.name}", f"{dialect.upper}_N"
    yield f"static int test_{function.name}(void)\n{{"
    for array, values in (*x.items(), *((f"expected_{name}", values) for name, values in expected.items())):
        yield from _constant(array, values, dialect)
    for array in expected:
        yield f"    static {dialect.real} {array}[STATES * {function.size(array)}];"
    each = [f"{array} + {function.size(array)} * k" for array in (*x, *expected)]
    yield "    int wrong = 0;"
    yield "    for (size_t k = 0; k < STATES; ++k)"
    yield f'        wrong |= refused("{whole}", k, {whole}({n}, {", ".join(each)}));'
    yield from _compared(function, whole, expected)
    for array in expected:
        yield f"    for (size_t k = 0; k < STATES * {function.size(array)}; ++k)\n        {array}[k] = 0;"
    yield f"    wrong |= {whole}_batch({n}, STATES, {', '.join((*x, *expected))}) & ~{dialect.upper}_SINGULAR;"
    yield from _compared(function, f"{whole}_batch", expected)
    yield "    return wrong != 0;\n}\n"


def _compared(function: ExportedFunction, call: str, outputs: Iterable[str]) -> Iterator[str]:
    for array in outputs:
        yield f'    wrong |= compare("{call}: {array}", {function.size(array)}, {array}, expected_{array});'


def _constant(name: str, values: Array, dialect: Dialect) -> Iterator[str]:
    yield f"    static const {dialect.real} {name}[] = {{"
    for row in values.reshape(len(values), -1).tolist():
        yield f"        {', '.join(map(dialect.literal, row))},"
    yield "    };"
