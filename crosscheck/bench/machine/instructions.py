"""How many operations a program has, and how many instructions they are: a product and a sum may be one."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from graphdyn.compiler import VectorCode
from graphdyn.scalars import Program

REGISTER_PATTERN, CONTRACT_FLAG = r"%[\w.]+", " contract "
"""Names of values in LLVM code; the mark of sums that may take in a product."""


def floating_point_operations(program: Program) -> int:
    """Additions, multiplications and divisions per sample, including the polynomials of sine and cosine."""
    return len(_kinds(_arithmetic(program)[0]))


def fused_instructions(program: Program) -> tuple[int, int]:
    """Additions, multiplications and divisions with each product fused into the sum that is its only use; and those
    among them that multiply or divide."""
    code, values = _arithmetic(program)
    uses = Counter(re.findall(REGISTER_PATTERN, " ".join(line.split("=", 1)[1] for line in code)))
    uses.update(values[k] for numbers in program.outputs.values() for k in numbers)
    kinds, single = _kinds(code), set()
    for line, kind in kinds:
        if kind == "fmul" and uses[line.split()[0]] == 1:
            single.add(line.split()[0])
    sums = [line for line, kind in kinds if kind in ("fadd", "fsub") and CONTRACT_FLAG in line]
    fused = sum(not single.isdisjoint(re.findall(REGISTER_PATTERN, line.split("=", 1)[1])) for line in sums)
    return len(kinds) - fused, sum(kind in ("fmul", "fdiv") for _, kind in kinds)


def _arithmetic(program: Program) -> tuple[list[str], list[str]]:
    """The lines of its code, and the names of its values."""
    code = VectorCode(2)
    values = code.values(program, lambda name: [f"%{name}.{k}" for k in range(program.inputs[name])])
    return code.lines, values


def _kinds(code: Sequence[str]) -> list[tuple[str, str]]:
    """Lines that add, multiply or divide, and what they do."""
    found = [(line, line.split("=", 1)[1].split()[0]) for line in code]
    return [(line, kind) for line, kind in found if kind in ("fadd", "fsub", "fmul", "fdiv")]
