"""Columns that belong together, one for each joint, and what their names say of them.

Names that differ only in the joint, or only in a number, are one block: q_mot_link_rad_*, actual_q_*, position.*.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from crosscheck.recordings.mapping.column_names import QUANTITY_WORDS, SUFFIX_UNITS
from crosscheck.recordings.mapping.units import DRIVE_UNITS, unit_of
from crosscheck.recordings.table import RecordedTable

BLOCK_WORDS = {
    "q": frozenset((*QUANTITY_WORDS["q"], "angles", "theta")),
    "v": frozenset((*QUANTITY_WORDS["v"], "speed", "speeds", "omega")),
    "a": frozenset(QUANTITY_WORDS["a"]),
    "tau": frozenset((*QUANTITY_WORDS["tau"], "moment", "moments", "trq")),
    "current": frozenset(("current", "currents", "curr", "cur", "i", "amps")),
    "temperature": frozenset(("temp", "temps", "temperature", "temperatures")),
}
"""Words of a name that tell the quantity of its block."""

ENCODER_WORDS = frozenset(("enc", "encoder", "encoders", "secenc"))
"""Words of positions, unless the name tells another quantity: velocities come from encoders too."""

COMPUTED_WORDS = frozenset(
    ["target", "desired", "des", "command", "commanded", "cmd", "reference", "ref", "setpoint", "goal", "model",
     "upstream", "sim", "simulated", "predicted", "expected", "error", "err", "external", "ext"]
)  # fmt: skip
"""Words of what a controller or a model has computed, which is no measurement."""

OTHER_WORDS = frozenset(["tcp", "cartesian", "pose", "tool", "wrench", "force", "ft", "voltage", "window", "mode"])
"""Words of what is not of the joints."""

SIDE_WORDS = {"joint": frozenset(("link", "load")), "motor": frozenset(("motor", "mot", "rotor"))}
"""Words that tell the side of the gears; motor encoders converted to the link have both, and are of the link."""


BRACKET = re.compile(r"[\[(]([^\[\]()*]+)[\])]")
"""A unit in brackets."""


@dataclass(frozen=True, eq=False)
class ColumnBlock:
    """Columns of one quantity, one for each joint, in the order of the robot.

    table, numbers: the number of the file, and of the columns in it from 0      (n,)
    label: the name with * for the joint
    quantity: q, v, a, tau, current, temperature; "" if the name does not tell
    unit, side: "" if the name does not tell
    computed: the word that tells that the block is no measurement; "" if there is none
    by_joint: whether the columns have the names of the joints, not numbers
    """

    table: int
    numbers: tuple[int, ...]
    label: str
    quantity: str
    unit: str = ""
    side: str = ""
    computed: str = ""
    by_joint: bool = False


def named_blocks(tables: Sequence[RecordedTable], joints: Sequence[str]) -> list[ColumnBlock]:
    """The blocks of all files that have one column for each joint."""
    return [block for number, table in enumerate(tables) for block in _of_table(number, table, joints, len(tables) > 1)]


def block_sizes(table: RecordedTable, joints: Sequence[str]) -> dict[str, int]:
    """How many numbered columns each block of another size has, by label, for what is said of them."""
    groups = _groups(table, joints)
    return {label: len(found) for label, found in groups.items() if len(found) > 1 and not _order(found, len(joints))}


def _of_table(number: int, table: RecordedTable, joints: Sequence[str], several: bool) -> Iterator[ColumnBlock]:
    taken: set[int] = set()
    for label, found in sorted(_groups(table, joints).items(), key=lambda pair: "joint:" not in pair[0]):
        order = _order(found, len(joints))
        if not order or taken & set(order):
            continue
        taken |= set(order)
        shown = label.removeprefix("joint:")
        words = frozenset(_in_order(shown))
        quantity = quantity_of(shown) or (quantity_of(table.path.stem) if several else "")
        if words & OTHER_WORDS:
            quantity = ""
        sides = [side for side, known in SIDE_WORDS.items() if words & known]
        computed = next((word for word in _in_order(shown) if word in COMPUTED_WORDS), "")
        unit = _unit(shown, quantity) or ("SI" if table.in_si else "")
        yield ColumnBlock(
            number, order, shown, quantity, unit, sides[0] if sides else "", computed, label.startswith("joint:")
        )


def _groups(table: RecordedTable, joints: Sequence[str]) -> dict[str, dict[int, int]]:
    """Columns by label and by number of the joint; labels of columns named after joints begin with "joint:"."""
    groups: dict[str, dict[int, int]] = {}
    for column, name in enumerate(table.names):
        for label, number in _places(name, joints):
            groups.setdefault(label, {}).setdefault(number, column)
    return groups


def _places(name: str, joints: Sequence[str]) -> Iterator[tuple[str, int]]:
    """The name with * in each place where the joint may be, and the number there."""
    named = [(joint, number) for number, joint in enumerate(joints) if _holds(name, joint)]
    if named:
        joint, number = max(named, key=lambda pair: len(pair[0]))
        yield "joint:" + re.sub(_alone(joint), "*", name, count=1), number
    for digits in re.finditer(r"\d+", name):
        yield f"{name[: digits.start()]}*{name[digits.end() :]}", int(digits[0][:9])


def _alone(joint: str) -> str:
    return rf"(?<![A-Za-z0-9]){re.escape(joint)}(?![A-Za-z0-9])"


def _holds(name: str, joint: str) -> bool:
    return re.search(_alone(joint), name) is not None


def _order(found: dict[int, int], n: int) -> tuple[int, ...]:
    """The columns in the order of the joints, where there is one for each; numbers begin at 0 or 1."""
    first = min(found)
    complete = len(found) == n and first in (0, 1) and set(found) == set(range(first, first + n))
    return tuple(found[number] for number in sorted(found)) if complete else ()


def _in_order(label: str) -> list[str]:
    parts = re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", label)
    return [part.lower() for part in parts]


def quantity_of(label: str) -> str:
    """The quantity that a unit in brackets tells, or else the first telling word of a name; "" if there is none.

    Single letters tell less than words: the a of A1 may be that of an axis.
    """
    bracket = re.search(BRACKET, label)
    if bracket:
        of_unit = [quantity for quantity in ("q", "v", "a", "tau") if unit_of(quantity, bracket[1].strip())]
        if len(of_unit) == 1 and bracket[1].strip() not in DRIVE_UNITS:
            return of_unit[0]
    words = sorted(_in_order(label), key=lambda word: len(word) == 1)
    found = [quantity for word in words for quantity, known in BLOCK_WORDS.items() if word in known]
    if bracket and found[:1] == ["a"]:  # in a unit that no acceleration has
        return ""
    return found[0] if found else "q" if ENCODER_WORDS.intersection(words) else ""


def _unit(label: str, quantity: str) -> str:
    """The unit in a name, as in brackets or at its end; "" if there is none."""
    known = "tau" if quantity == "current" else quantity
    if known not in SUFFIX_UNITS:
        return ""
    bracket = re.search(BRACKET, label)
    if bracket and unit_of(known, bracket[1].strip()):
        return bracket[1].strip()
    for suffix, unit in sorted(SUFFIX_UNITS[known].items(), key=lambda pair: -len(pair[0])):
        if re.search(rf"(?i)[_ .]{suffix}(?![a-z0-9])(?!_[a-z])", label):
            return unit
    return ""
