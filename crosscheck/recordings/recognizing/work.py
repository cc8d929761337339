"""The work on one log: its tables, the robot, and what was assumed or left open on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from shlex import quote

import numpy as np

from crosscheck.recordings.recognizing.blocks import ColumnBlock
from crosscheck.recordings.recognizing.recognized import OpenChoice, RecognizedBlock, Untold
from crosscheck.recordings.table import RecordedTable, in_words
from graphdyn import InvalidInput, RobotModel
from graphdyn.errors import counted
from graphdyn.layout import Array


@dataclass(eq=False)
class LogWork:
    """The work on one log.

    tables: of its files; model: the robot; untold: what the user says
    assumed: what was taken though the log does not prove it; open: what is left to be said
    without_quantity: labels of the blocks whose quantity is not known
    """

    tables: Sequence[RecordedTable]
    model: RobotModel
    untold: Untold
    assumed: list[str] = field(default_factory=list)
    open: list[OpenChoice] = field(default_factory=list)
    without_quantity: list[str] = field(default_factory=list)

    def take(self, quantity: str) -> tuple[str, ...]:
        """Options that say which block is of a quantity that no block is known to have."""
        return tuple(f"--take {quote(f'{quantity}={label}')}" for label in self.without_quantity or ["LABEL"])

    def values(self, block: ColumnBlock) -> Array:
        table = self.tables[block.table]
        return np.column_stack([table.doubles(k) for k in block.numbers])

    def block(
        self, block: ColumnBlock, quantity: str, unit: str, side: str, why: str, taken: bool = True
    ) -> RecognizedBlock:
        table = self.tables[block.table]
        columns = tuple(column_of(table, k) for k in block.numbers)
        return RecognizedBlock(
            quantity, columns, block.label, table.path.name, "" if unit == "SI" else unit, side, taken, why,
            self.values(block),
        )  # fmt: skip

    def chosen(self, quantity: str, found: Sequence[ColumnBlock]) -> tuple[ColumnBlock | None, list[RecognizedBlock]]:
        """The one block that can be taken, None if that is left to be said; and the others with the reasons."""
        wanted = self.untold.take.get(quantity)
        if wanted is not None:
            match = [block for block in found if block.label == wanted]
            if len(match) != 1:
                listed = in_words(block.label for block in found)
                raise InvalidInput(f"no block {wanted!r} of {quantity}; there are {listed}")
            others = [b for b in found if b is not match[0]]
            return match[0], [self.block(b, quantity, b.unit, b.side, "another was asked for", False) for b in others]
        blocks, possible = [], []
        for block in found:
            zero = [self.model.independent_joints[j] for j in np.flatnonzero(~self.values(block).any(axis=0))]
            reason = f"{block.computed!r} in its name: computed, not measured" if block.computed else ""
            if zero and not reason and (len(found) > 1 or len(zero) == len(block.numbers)):
                reason = f"zero in all rows: {in_words(zero)}"
            if reason:
                blocks.append(self.block(block, quantity, block.unit, block.side, reason, False))
            else:
                possible.append(block)
        if len(possible) == 1:
            return possible[0], blocks
        candidates = possible or list(found)
        question = f"{counted(len(candidates), 'candidate')}: {in_words(block.label for block in candidates)}"
        if not possible:
            question = f"none is measured: {'; '.join(f'{block.label}, {block.why}' for block in blocks)}"
        options = tuple(f"--take {quote(f'{quantity}={block.label}')}" for block in candidates)
        lines = tuple(f"columns = {self.columns_as_text(block)}" for block in candidates)
        self.open.append(OpenChoice(quantity, question, options, lines))
        known = {block.label for block in blocks}
        left = [block for block in candidates if block.label not in known]
        return None, [*(self.block(b, quantity, b.unit, b.side, "one of several", False) for b in left), *blocks]

    def columns_as_text(self, block: ColumnBlock) -> str:
        columns = [column_of(self.tables[block.table], k) for k in block.numbers]
        return "[" + ", ".join(str(c) if isinstance(c, int) else f'"{c}"' for c in columns) + "]"


def column_of(table: RecordedTable, number: int) -> str | int:
    """The name of a column, or its number from 1 where it has none, or shares it."""
    name = table.names[number]
    return name if name and table.names.count(name) == 1 else number + 1


def how_told(block: ColumnBlock) -> str:
    if block.by_joint:
        return "by name, with those of the joints"
    if "*" in block.label:
        return "by name, numbered as the joints"
    return "by how the columns move, in the order of the joints"


def columns_shown(table: RecordedTable, numbers: Sequence[int]) -> str:
    shown = [str(column_of(table, k)) for k in numbers]
    return f"{shown[0]} … {shown[-1]}" if len(shown) > 1 else shown[0]
