"""Programs of long robots: the same few steps for one body after the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from graphdyn.layout import Array
from graphdyn.scalars.expressions import Program, Watch

OWN, INSIDE, CONSTANTS = "own", "inside", "constants"
"""Arrays of a step beside those of the robot: memory of the body and of its inside body, its row of the table."""

GROUND_ARRAY_NAME = "ground"
"""The array of the robot that belongs to no body."""


@dataclass(frozen=True)
class Kind:
    """What bodies have in common whose steps are one function. at_ground: whether the inside body is the ground"""

    prismatic: bool
    quarters: int
    at_ground: bool


@dataclass(frozen=True)
class BodyProgram:
    """A step of a kind. Its program reads OWN, INSIDE, CONSTANTS and a body's columns of the robot's arrays.

    kept: columns of OWN that its output OWN overwrites; summed: columns of INSIDE to which its output INSIDE is added
    """

    program: Program
    kept: tuple[int, ...]
    summed: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class LongProgram:
    """Pass after pass over the bodies.

    kinds: of every body; inside: number of its inside body, -1 for the ground; table: its constants (bodies, …)
    passes: whether outwards, and the step of each kind
    inputs, outputs: widths of the robot's arrays; watches: kinds of what is watched; memory: vectors of each body
    """

    kinds: tuple[Kind, ...]
    inside: tuple[int, ...]
    table: Array
    passes: tuple[tuple[bool, Mapping[Kind, BodyProgram]], ...]
    inputs: dict[str, int]
    outputs: dict[str, range]
    watches: tuple[Watch, ...]
    memory: int

    @cached_property
    def arithmetic(self) -> int:
        """Operations of a sample."""
        return sum(steps[kind].program.arithmetic for _, steps in self.passes for kind in self.kinds)
