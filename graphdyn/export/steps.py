"""A long program as equal steps, each of many operations at once: code of one size, however long the program is.

The values are rows of one array. A step takes two rows for each of its operations, and appends as many.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.scalars.expressions import Program, operands

KINDS = ("*", "+", "-", "/", "negate")
"""Operations of a step; sines and cosines come before all steps."""


@dataclass(frozen=True, eq=False)
class EqualSteps:
    """before: operations to be computed one by one, sines, cosines and what they need
    first: operations in the first rows: inputs, constants and these
    left, right: rows of the operands (steps, width); of one operand, twice the same
    kind: places in KINDS (steps, width)
    row: that of each operation
    """

    before: tuple[int, ...]
    first: tuple[int, ...]
    left: NDArray[np.int32]
    right: NDArray[np.int32]
    kind: NDArray[np.int32]
    row: dict[int, int]

    @property
    def rows(self) -> int:
        return len(self.first) + self.kind.size


def in_steps(program: Program, width: int) -> EqualSteps:
    """The program in steps of this width: an operation comes in the first step with room after its operands."""
    operations = program.operations
    needed = set[int]()
    for k in reversed(range(len(operations))):
        if operations[k][0] in ("sine", "cosine") or k in needed:
            needed |= {k, *operands(operations[k])}
    given = [k for k, (kind, *_) in enumerate(operations) if kind in ("constant", "input")]
    before = tuple(sorted(needed.difference(given)))
    first = (*given, *before)
    step, members = dict.fromkeys(first, -1), list[list[int]]()
    for k in sorted(set(range(len(operations))).difference(first)):
        at = 1 + max(step[x] for x in operands(operations[k]))
        while at < len(members) and len(members[at]) == width:
            at += 1
        if at == len(members):
            members.append([])
        members[at].append(k)
        step[k] = at
    row = {k: place for place, k in enumerate(first)}
    row |= {k: len(first) + width * at + place for at, numbers in enumerate(members) for place, k in enumerate(numbers)}
    left, right, kind = np.zeros((3, len(members), width), dtype=np.int32)
    for at, numbers in enumerate(members):
        for place, k in enumerate(numbers):
            name, *arguments = operations[k]
            left[at, place], right[at, place] = row[arguments[0]], row[arguments[-1]]
            kind[at, place] = KINDS.index(name)
    return EqualSteps(before, first, left, right, kind, row)
