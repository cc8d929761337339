"""What was recognized in a log: its clock, its blocks of columns, what is assumed, and what is left to be said."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from graphdyn.display import Displayed
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Untold:
    """What the user says where a log does not tell.

    rate: samples per second
    ratio: of the gears, q_motor = ratio · q, one per joint
    gain: N m per unit of the torque's columns, one per joint
    units: by quantity
    take: label of the block to take, by quantity; a column's name or number for "time"
    """

    rate: float | None = None
    ratio: tuple[float, ...] = ()
    gain: tuple[float, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    take: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class RecognizedClock:
    """The time of the rows.

    columns: name or number from 1; with a second one for nanoseconds
    file: name of its file
    unit: of the first column
    rate: samples per second
    taken: whether the mapping uses it
    why: how it was recognized
    """

    columns: tuple[str | int, ...]
    file: str
    unit: str
    rate: float
    taken: bool
    why: str
    values: Array = field(repr=False)


@dataclass(frozen=True, eq=False)
class RecognizedBlock:
    """Columns of one quantity, in the order of the joints, and how they are read.

    quantity: "q", "v", "a", "tau", "temperature"; "" for what is not used
    columns: names, or numbers from 1     (n,)
    label: the name with * for the joint, or the numbers of the columns
    file: name of the file
    unit, side: as they are read; "" if that is left to be said
    taken: whether the mapping uses it
    why: how it was recognized, or why it is not used
    values: as recorded                   (N, n)
    """

    quantity: str
    columns: tuple[str | int, ...]
    label: str
    file: str
    unit: str
    side: str
    taken: bool
    why: str
    values: Array = field(repr=False)


@dataclass(frozen=True)
class OpenChoice:
    """What the log does not tell.

    quantity: what it is about: "time" or that of a block
    question: in a sentence
    options: of the command, each of which answers it
    lines: candidates, lines of the mapping
    """

    quantity: str
    question: str
    options: tuple[str, ...]
    lines: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, repr=False)
class RecognizedLog(Displayed):
    """What was recognized in the files of one log.

    files: as given; joints: of the robot; rows: number of rows
    rate: samples per second, None if nothing tells; rate_told: whether it comes from no clock of the log
    clocks, blocks: those that are taken and all others
    others: columns without meaning, with the reasons
    assumed: what was taken though the log does not prove it
    open: what is left to be said
    mapping: the mapping file as text; complete if nothing is open
    """

    files: tuple[str, ...]
    joints: tuple[str, ...]
    rows: int
    rate: float | None
    clocks: tuple[RecognizedClock, ...]
    blocks: tuple[RecognizedBlock, ...]
    others: Mapping[str, str]
    assumed: tuple[str, ...]
    open: tuple[OpenChoice, ...]
    mapping: str

    def summary(self) -> str:
        """Which blocks of columns are what, and what is left to be said."""
        taken = [f"{block.quantity}: {block.label}" for block in self.blocks if block.taken]
        left = [f"left to be said: {choice.quantity}" for choice in self.open]
        return "\n".join([f"{', '.join(self.files)}: {self.rows} rows", *taken, *left])

    @property
    def complete(self) -> bool:
        """Whether the mapping can be used as it is."""
        return not self.open

    def of(self, quantity: str) -> RecognizedBlock | None:
        """The block that is taken for a quantity."""
        return next((block for block in self.blocks if block.quantity == quantity and block.taken), None)
