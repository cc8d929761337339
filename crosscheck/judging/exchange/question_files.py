"""Questions as files: CSV, JSON, NumPy and Parquet."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from crosscheck.judging.exchange.protocols import number_text
from crosscheck.judging.exchange.questions import ARGUMENTS, Question


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
    """Of all arguments that some function takes."""
    return [name for name in ARGUMENTS if any(name in one.arguments for one in asked)]


FORMS: Mapping[str, Callable[[Sequence[Question]], bytes]] = {".csv": as_csv, ".npz": as_npz, ".parquet": as_parquet}
"""By the ending of the name; JSON, which has a published format, is crosscheck.report.records.questions."""
