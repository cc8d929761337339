"""The process that calls a C function of a shared library: questions as lines of JSON in, answers as such lines out.

It runs by its path and needs the standard library alone: it starts in some hundredths of a second. The function may
end it, print to its standard output, and write beyond its arrays.

arguments: FILE SYMBOL
"""

from __future__ import annotations

import ctypes
import json
import math
import os
import sys
from collections.abc import Iterator
from typing import Any

N_GUARD_NUMBERS = 64
"""Numbers behind the array of the answer that must stay as they are."""

GUARD_VALUE = 1.2345678901234567e-300
"""Value of these numbers."""


def main(path: str, symbol: str) -> None:
    """Answer until the input ends."""
    output = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what the function prints is no answer
    try:
        function = getattr(ctypes.CDLL(path), symbol)
    except OSError as error:
        sys.exit(str(error))
    except AttributeError:
        sys.exit(f'{path} has no symbol {symbol}; `nm -D {path}` lists what it has; functions in C++ need extern "C"')
    function.restype = ctypes.c_int
    for line in sys.stdin:
        question = json.loads(line)
        answer = _call(function, question["arguments"], math.prod(question["shape"]))
        print(json.dumps({"id": question["id"], **answer}), file=output, flush=True)


def _call(function: Any, arguments: dict[str, list[Any]], count: int) -> dict[str, Any]:
    """The answer, or what was wrong with the call. Entries that the function leaves alone are NaN."""
    numbers = {name: list(_flat(x)) for name, x in arguments.items()}
    given = {name: (ctypes.c_double * len(x))(*x) for name, x in numbers.items()}
    result = (ctypes.c_double * (count + N_GUARD_NUMBERS))(*[math.nan] * count, *[GUARD_VALUE] * N_GUARD_NUMBERS)
    returned = function(ctypes.c_int(len(arguments["q"])), *given.values(), result)
    if returned != 0:
        return {"error": f"it returned {returned}; 0 means that the answer is valid"}
    if any(x != GUARD_VALUE for x in result[count:]):
        return {"error": f"it wrote beyond the {count} {'number' if count == 1 else 'numbers'} of its answer"}
    for name, x in given.items():
        if list(x) != numbers[name]:
            return {"error": f"it changed its argument {name}, which is const"}
    return {"answer": result[:count]}


def _flat(rows: list[Any]) -> Iterator[float]:
    """The numbers of an array (n,), or of one with rows, row by row."""
    for row in rows:
        yield from row if isinstance(row, list) else [row]


if __name__ == "__main__":
    main(*sys.argv[1:])
