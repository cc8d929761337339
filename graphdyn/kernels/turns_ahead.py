"""Sines and cosines one turn of a loop ahead.

Everything waits for sines and cosines, and they wait for nothing: those of the following rows are computed while the
processor waits for other results of these rows.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from graphdyn.kernels.expressions import Program, program_of
from graphdyn.kernels.vector_code import Carried, VectorCode

_ANGLES = "angles"


@dataclass(frozen=True)
class TurnsAhead:
    """What the lines of a loop know of its rows from the turn before.

    columns: those of arrays from which angles follow, by name; turns: sine and cosine of every angle, by its number
    carried: how they get there
    """

    columns: dict[str, list[str]]
    turns: dict[int, tuple[str, str]]
    carried: Carried


def turns_ahead(program: Program, lanes: int) -> TurnsAhead:
    angles = sorted({given[0] for kind, *given in program.operations if kind in ("sine", "cosine")})
    part = program_of(program.operations, program.inputs, {_ANGLES: angles}, {})
    arrays = sorted({given[0] for kind, *given in part.operations if kind == "input"})
    columns = {name: [f"%ahead.{name}{k}" for k in range(program.inputs[name])] for name in arrays}
    turns = {angle: (f"%sine{angle}", f"%cosine{angle}") for angle in angles}
    first, following = VectorCode(lanes, "f"), VectorCode(lanes, "n")
    carried = Carried(
        names=_flat(columns.values(), turns.values()),
        first=(first, _turns(part, arrays, first, "%first")),
        following=(following, _turns(part, arrays, following, "%next")),
    )
    return TurnsAhead(columns, turns, carried)


def _turns(part: Program, arrays: list[str], code: VectorCode, row: str) -> list[str]:
    """Code for the rows from this one on, and its values in the order of the names."""
    columns = {}
    for name in arrays:
        width = part.inputs[name]
        columns[name] = code.columns_of(code.rows_of(f"in.{name}", width, row), width)
    values = code.values(part, columns.__getitem__)
    return _flat(columns.values(), (code.sine_and_cosine(values[k]) for k in part.outputs[_ANGLES]))


def _flat(columns: Iterable[list[str]], turns: Iterable[tuple[str, str]]) -> list[str]:
    return [*(name for each in columns for name in each), *(name for pair in turns for name in pair)]
