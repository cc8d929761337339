"""A rolled program: steps of one body, the order in which they are done, and the memory that they share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from graphdyn.layout import Array
from graphdyn.scalars.expressions import Guard, Program

Order = Literal["ground", "outwards", "inwards", "column", "path", "beyond", "frame"]
"""The bodies for which a step is done, one after the other.

ground: once, for the ground
outwards, inwards: for every body, inside bodies before those outside, or after
frame: for the body of the frame that the request speaks of
Within columns: column: for the body of the column; path: for this and those between it and the ground, inwards;
beyond: for those without the body itself
"""

Index = Literal["body", "inside", "column", "ground"]
"""Whose part of an array: that of the body whose step it is, of its inside body, of the body of the column."""

MEMORY, CARRIED, CONSTANTS = "memory", "carried", "constants"
"""Arrays beside those of the robot: what bodies keep, what is carried from step to step, the table of constants."""


@dataclass(frozen=True)
class Pass:
    """A step for body after body.

    step: what is computed for one body; a function of graphdyn.compiler.rolled.recording.BodyStep
    """

    order: Order
    step: Callable[[Any], None]


@dataclass(frozen=True)
class ColumnPasses:
    """Passes that are done for every body anew, the body of the column.

    of_frame: for the body of the frame alone
    """

    passes: tuple[Pass, ...]
    of_frame: bool = False


@dataclass(frozen=True)
class Product:
    """±leftᵀ right of arrays that steps before have answered, of which to becomes the product.

    triangular: whether row k of left and right is zero left of column k, and the product symmetric
    """

    left: str
    right: str
    to: str
    sign: Literal[1, -1] = 1
    triangular: bool = False


@dataclass(frozen=True)
class Place:
    """A part of an array: the numbers that belong to these bodies, one index for each dimension that counts bodies."""

    array: str
    of: tuple[Index, ...] = ()


@dataclass(frozen=True)
class Write:
    """Numbers of a place that a step overwrites, or to which it adds; the operations are the output of its position."""

    place: Place
    columns: tuple[int, ...]
    added: bool = False


@dataclass(frozen=True)
class BodyProgram:
    """A recorded step. Inputs of the program are places and their columns."""

    program: Program
    writes: tuple[Write, ...]


@dataclass(frozen=True)
class RecordedPass:
    """steps: for each kind of bodies; a pass over the ground, or for a frame, has one for 0"""

    order: Order
    steps: Mapping[int, BodyProgram]


@dataclass(frozen=True)
class RecordedColumnPasses:
    passes: tuple[RecordedPass, ...]
    of_frame: bool


Recorded = RecordedPass | RecordedColumnPasses | Product


@dataclass(frozen=True)
class Extent:
    """An array in memory: its first vector, its width, and the vectors from one body to the next, by dimension."""

    first: int
    width: int
    strides: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class LongProgram:
    """Passes over the bodies of a robot, in their order, and where all arrays are.

    kinds, inside: of every body; kinds have steps of their own; inside is the number of bodies for the ground
    table: constants of every body (bodies, …)
    arrays: where they are in memory, by name: inputs, outputs, and what steps keep
    vectors: of memory in all
    frame_body: of the request's frame
    inputs, outputs: widths of the arrays of the caller; guards: kinds of guards
    """

    kinds: tuple[int, ...]
    inside: tuple[int, ...]
    table: Array
    passes: tuple[Recorded, ...]
    arrays: dict[str, Extent]
    vectors: int
    frame_body: int
    inputs: dict[str, int]
    outputs: dict[str, range]
    guards: tuple[Guard, ...]

    @cached_property
    def arithmetic(self) -> int:
        """Operations of a sample."""
        return sum(
            sum(self._operations(inner, True, each.of_frame) for inner in each.passes)
            if isinstance(each, RecordedColumnPasses)
            else self._multiplications(each)
            if isinstance(each, Product)
            else self._operations(each, False, False)
            for each in self.passes
        )

    def _multiplications(self, product: Product) -> int:
        return 2 * len(self.inside) * self.arrays[product.to].width // (6 if product.triangular else 1)

    def _operations(self, each: RecordedPass, in_columns: bool, of_frame: bool) -> int:
        if each.order in ("ground", "frame"):
            return each.steps[0].program.arithmetic
        of_body = [each.steps[kind].program.arithmetic for kind in self.kinds]
        if each.order in ("path", "beyond"):  # as if the column were one of the body itself, or of those outside
            of_path: list[int] = []
            for body, inside in enumerate(self.inside):
                of_path.append(of_body[body] + (of_path[inside] if inside < len(of_body) else 0))
            return of_path[self.frame_body] if of_frame else sum(of_path)
        if each.order == "column":
            return of_body[self.frame_body] if of_frame else sum(of_body)
        return sum(of_body) * (len(of_body) if in_columns and not of_frame else 1)
