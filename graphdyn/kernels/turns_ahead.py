"""Sines and cosines one turn of a loop ahead.

Everything waits for sines and cosines, and they wait for nothing: those of the following rows are computed while the
processor waits for other results of these rows.
"""

from __future__ import annotations

from graphdyn.kernels.expressions import Program, program_of
from graphdyn.kernels.vector_code import Carried, VectorCode

Turns = dict[int, tuple[str, str]]
"""Names of sine and cosine of angles, by the number of the angle."""


def turns_ahead(program: Program, lanes: int) -> tuple[Turns, Carried]:
    """All sines and cosines as the lines of the loop know them, and what computes them a turn before."""
    angles = sorted({given[0] for kind, *given in program.operations if kind in ("sine", "cosine")})
    part = program_of(program.operations, program.inputs, {"angles": angles}, {})
    turns = {angle: (f"%sine{angle}", f"%cosine{angle}") for angle in angles}
    names = [name for pair in turns.values() for name in pair]
    return turns, Carried(
        names, _turns(part, VectorCode(lanes, "f"), "%first"), _turns(part, VectorCode(lanes, "n"), "%next")
    )


def _turns(part: Program, code: VectorCode, row: str) -> tuple[VectorCode, list[str]]:
    """Code for the rows from this one on, and sine and cosine of its angles in turn."""

    def columns(name: str) -> list[str]:
        width = part.inputs[name]
        return code.columns_of(code.rows_of(f"in.{name}", width, row), width)

    values = code.values(part, columns)
    return code, [name for k in part.outputs["angles"] for name in code.sine_and_cosine(values[k])]
