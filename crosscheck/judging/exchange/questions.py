"""The questions that files hold: the states of one judgment, each with an id that depends on what is asked alone.

Questions as files: CSV, JSON, NumPy and Parquet.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

import numpy as np

from crosscheck.judging.exchange.protocols import number_text
from crosscheck.judging.observing.function_under_test import FunctionUnderTest
from crosscheck.quantities import LOADS
from graphdyn import GraphDynError
from graphdyn.layout import Array

SMALLEST_ID = 10**11
N_IDS = 9 * 10**11
"""Ids are numbers of twelve digits, which every language holds exactly as a double."""

ID_DECIMALS = 9
"""Decimals of the numbers that an id depends on: not on the rounding of the machine that wrote the questions."""

ARGUMENT_NAMES = ("q", "v", "a", "tau", LOADS)
"""Argument names in the order of files."""


NAMES_IN_IDS = {"joint_torque_regressor": "regressor"}
"""Names of functions that were asked under another name: ids stay, so that answers that were written are still
answers."""


class SameId(GraphDynError):
    """Two different questions have the same id."""


@dataclass(frozen=True, eq=False)
class Question:
    """One call of a function.

    id: twelve digits, to be repeated with the answer: [{"id": …, "answer": […]}, …]
    function: its name
    arguments: by name, in the order in which the function takes them and in the joint order of the user code; (n,),
        or (n, 6) for external wrenches [rad or m, …/s, …/s², N m or N]
    """

    id: int
    function: str
    arguments: Mapping[str, Array]


def question(function: str, arguments: Mapping[str, Array]) -> Question:
    """Question with its id."""
    said = [
        f"{name} " + " ".join(f"{x + 0.0:.{ID_DECIMALS}e}" for x in values.flat) for name, values in arguments.items()
    ]
    digest = sha256("\n".join([NAMES_IN_IDS.get(function, function), *said]).encode()).digest()
    return Question(SMALLEST_ID + int.from_bytes(digest[:8], "big") % N_IDS, function, arguments)


def questions(function: FunctionUnderTest, arguments: Sequence[Array]) -> list[Question]:
    """The questions of one call with N states, each once. arguments: (N, …) each, in our joint order."""
    asked = (function.function_arguments(row) for row in zip(*arguments, strict=True))
    return once(question(function.name, given) for given in asked)


def once(asked: Iterable[Question]) -> list[Question]:
    """Each question once. Raises SameId."""
    by_id: dict[int, Question] = {}
    for one in asked:
        known = by_id.setdefault(one.id, one)
        if known.function != one.function or not all(
            np.allclose(known.arguments[name], x, rtol=10.0**-ID_DECIMALS, atol=0) for name, x in one.arguments.items()
        ):
            raise SameId(f"two questions have the id {one.id} by chance; give another --seed")
    return list(by_id.values())


def as_csv(asked: Sequence[Question]) -> bytes:
    """A row per question: id, function, and the numbers of all arguments, empty where the function takes none."""
    names = _names(asked)
    sizes = {name: max(one.arguments[name].size for one in asked if name in one.arguments) for name in names}
    head = ["id", "function", *(f"{name}{k}" for name in names for k in range(1, sizes[name] + 1))]
    lines = [",".join(head)]
    for one in asked:
        cells = [str(one.id), one.function]
        for name in names:
            given = one.arguments.get(name)
            cells += [""] * sizes[name] if given is None else [number_text(x) for x in given.flat]
        lines.append(",".join(cells))
    return "".join(f"{line}\n" for line in lines).encode()


def as_npz(asked: Sequence[Question]) -> bytes:
    """Arrays FUNCTION.id (N,) and FUNCTION.q (N, n), one for each argument."""
    arrays: dict[str, Any] = {}
    for function in dict.fromkeys(one.function for one in asked):
        own = [one for one in asked if one.function == function]
        arrays[f"{function}.id"] = np.array([one.id for one in own])
        for name in own[0].arguments:
            arrays[f"{function}.{name}"] = np.stack([one.arguments[name] for one in own])
    written = io.BytesIO()
    np.savez(written, **arrays)
    return written.getvalue()


def as_parquet(asked: Sequence[Question]) -> bytes:
    """Columns id, function, and one of lists for each argument, null where the function takes none."""
    from crosscheck.recordings.arrow import check_arrow

    check_arrow("questions as .parquet")
    import pyarrow as pa
    import pyarrow.parquet

    columns = {
        name: pa.array(
            [one.arguments[name].ravel() if name in one.arguments else None for one in asked], pa.list_(pa.float64())
        )
        for name in _names(asked)
    }
    table = pa.table(
        {
            "id": pa.array([one.id for one in asked], pa.int64()),
            "function": pa.array([one.function for one in asked], pa.string()),
            **columns,
        }
    )
    written = io.BytesIO()
    pyarrow.parquet.write_table(table, written)
    return written.getvalue()


def _names(asked: Sequence[Question]) -> list[str]:
    """Names of all arguments that some function takes."""
    return [name for name in ARGUMENT_NAMES if any(name in one.arguments for one in asked)]


QUESTION_WRITERS: Mapping[str, Callable[[Sequence[Question]], bytes]] = {
    ".csv": as_csv,
    ".npz": as_npz,
    ".parquet": as_parquet,
}
"""Writers by the ending of the name; JSON, which has a published format, is crosscheck.commands.questions.record."""
