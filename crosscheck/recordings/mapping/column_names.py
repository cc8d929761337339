"""Meaning of columns by their names: q_1, position.elbow, joint2.tau [N m], /joint_states/elbow/effort, time_ms.

A name gives the quantity first (tau_motor_Nm_2) or, after a dot, last (joint2.tau). The rest, without the unit, is the
joint. Columns that differ only in the joint are a family. Two families of one quantity (motor and secondary encoder)
are ambiguous and refused.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from crosscheck.recordings.errors import AmbiguousColumns, BadMapping
from crosscheck.recordings.mapping.mapping import SI_UNITS
from crosscheck.recordings.mapping.units import Unit, unit_of
from crosscheck.recordings.table import RecordedTable, in_words

RECEIVED_TIME_COLUMN = "__time"
"""PlotJuggler's name of the time: the time of receipt or that of the stamps, by its user's choice."""

QUANTITY_WORDS = {
    "time": (
        "t",
        "time",
        "stamp",
        "timestamp",
        "timestamps",
        "times",
        "bag_t",
        "header_stamp",
        "rowtimes",
        RECEIVED_TIME_COLUMN,
    ),
    "q": ("q", "pos", "position", "positions", "angle", "joint_position", "joint_positions", "actual_q"),
    "v": ("v", "qd", "dq", "qdot", "vel", "velocity", "velocities", "joint_velocity", "joint_velocities", "actual_qd"),
    "a": ("a", "qdd", "ddq", "qddot", "acc", "acceleration", "accelerations", "joint_acceleration"),
    "tau": ("tau", "torque", "torques", "effort", "efforts", "joint_torque", "joint_torques", "joint_effort"),
}
"""Names of the quantities in files of many programs, regardless of case."""

CURRENT_COLUMNS = re.compile(r"(?i)(actual_|motor_|target_)?(current|currents|i|amps)[ _.]?\d+|.*\.(current|i)$")
"""Columns of currents, which are torques only with a gain: reported, never used."""

SUFFIX_UNITS = {
    "q": {"rad": "rad", "deg": "deg", "m": "m", "mm": "mm"},
    "v": {"rad_s": "rad/s", "rads": "rad/s", "deg_s": "deg/s", "degs": "deg/s", "rpm": "rpm", "m_s": "m/s"},
    "a": {"rad_s2": "rad/s^2", "deg_s2": "deg/s^2", "m_s2": "m/s^2"},
    "tau": {"nm": "N m", "n_m": "N m"},
    "time": {"s": "s", "sec": "s", "ms": "ms", "us": "us", "ns": "ns"},
}
"""Units by the part of a name that denotes them."""


TOPIC_PREFIX = re.compile(r"(?i)(.*/)?joint_states?[./]|.*/")
"""Part before the joint in a name with a path."""

STAMP_PATTERN = re.compile(r"(?i)(|.*[/.])header[/.]stamp|(.*[/.])(t|time|timestamp)")
"""Stamp of a message, or the time of a structure."""

SECONDS_PART = re.compile(r"(?i)(|.*[/._])secs?(onds)?")
NANOSECONDS_PART = re.compile(r"(?i)n(ano)?secs?|nanoseconds")
"""Name of the second column of a ROS stamp: header.stamp.nanosec, which complements header.stamp.sec."""

ALL_WORDS = "|".join(sorted((word for words in QUANTITY_WORDS.values() for word in words), key=len, reverse=True))
ARRAY_ELEMENT = re.compile(rf"(?i)(|.*[/.])({ALL_WORDS})(?:[\[(](\d+)[\])]|[._/]?(\d+))")
"""Element of an array, as PlotJuggler, ROS and MATLAB write it: position[0], field.position0, .position.0, q(1)."""


class Meaning(NamedTuple):
    """Meaning of a column.

    quantity: a key of QUANTITY_WORDS
    family: the name with * for the joint
    joint: its name or number; "" for time
    unit: "" if the name has none
    path: of the message that has the column: "/joint_states"; None for a name without path
    """

    quantity: str
    family: str
    joint: str
    unit: str
    path: str | None = None


def meaning(name: str, joints: Sequence[str] | None) -> Meaning | None:
    """The meaning of a name; None if it is unknown."""
    label, unit = name.strip(), ""
    bracket = re.fullmatch(r"(.*\S)\s*[\[(]([^\[\]()]*[^\[\]()\d][^\[\]()]*)[\])]", label)
    if bracket:
        label, unit = bracket[1], bracket[2].strip()
    return _of_message(label, unit, joints) or _of_table(label, unit, joints)


def _of_message(label: str, unit: str, joints: Sequence[str] | None) -> Meaning | None:
    """The meaning of a field of a message: /joint_states/elbow/position, /joint_states/position[0], field.position0."""
    stamp = STAMP_PATTERN.fullmatch(label)
    if stamp:
        return Meaning("time", label, "", unit, (stamp[1] or stamp[2] or "").rstrip("/."))
    element = ARRAY_ELEMENT.fullmatch(label)
    if element and (quantity := _quantity(element[2])) != "time":
        path, word, bracketed, bare = element.groups()
        if path or bracketed:  # position_1 is a name without path
            return Meaning(quantity, f"{path}{word}[*]", bracketed or bare, unit, path.rstrip("/."))
    word = re.split(r"[/.]", label)[-1]
    quantity, owner = _quantity(word), label[: -len(word) - 1]
    if quantity in ("", "time") or not owner:
        return None
    known = [joint for joint in joints or () if re.fullmatch(rf"(|.*[/.]){re.escape(joint)}", owner)]
    topic = TOPIC_PREFIX.match(owner)
    joint = max(known, key=len) if known else owner[topic.end() :] if topic else ""
    before = owner[: len(owner) - len(joint)]
    if not joint or not (known or before.strip("/")):  # "/gripper/position" is a field of a topic, not of a joint
        return None
    return Meaning(quantity, f"{before}*{label[len(owner) :]}", joint, unit, before.rstrip("/.") if before else None)


def _quantity(word: str) -> str:
    return next((quantity for quantity, words in QUANTITY_WORDS.items() if word.lower() in words), "")


def _of_table(label: str, unit: str, joints: Sequence[str] | None) -> Meaning | None:
    """The meaning of a name without path."""
    for quantity, words in QUANTITY_WORDS.items():
        alternatives = "|".join(sorted(words, key=len, reverse=True))
        last = quantity != "time" and re.fullmatch(rf"(?i)(.+)\.({alternatives})", label)
        if last:
            return Meaning(quantity, f"*.{last[2]}", last[1], unit)
        first = re.fullmatch(rf"(?i)({alternatives})(?:[ _./-]*(.*))?", label)
        # without a separator only a number may follow: 'q1' is a position, 'quality' is not
        if first and (not first[2] or not label[len(first[1])].isalnum() or first[2][0].isdigit()):
            found = _joint(quantity, first[1], first[2] or "", joints, unit, label[len(first[1]) :].startswith("."))
            if found:
                return found
    return None


def _joint(quantity: str, word: str, rest: str, joints: Sequence[str] | None, unit: str, dot: bool) -> Meaning | None:
    """Split the rest of a name into unit and joint.

    A number at the end is that of a joint, unless the whole rest is a joint name: joint_1, or a name with a dot.
    """
    named = dot or re.match(r"(?i)(joint|axis)[ _]?\d", rest)
    for suffix, meant in sorted(SUFFIX_UNITS[quantity].items(), key=lambda pair: -len(pair[0])):
        found = re.fullmatch(rf"(?i)(|.*_){suffix}(_?\d+|)", rest)
        if found:
            rest, unit = f"{found[1]}{found[2]}".strip("_") if found[1] else found[2].strip("_"), unit or meant
            break
    if quantity == "time":
        return Meaning("time", word, "", unit) if not rest else None
    if not rest:
        return None
    for joint in joints or ():
        if rest == joint or rest.endswith(f"_{joint}"):
            return Meaning(quantity, f"{word}_{rest[: -len(joint)]}*", joint, unit)
    number = re.fullmatch(r"(.*?)_?(\d+)", rest)
    if number and not named:
        return Meaning(quantity, f"{word}_{number[1]}_*".replace("__", "_"), number[2], unit)
    return Meaning(quantity, f"{word}_*", rest, unit)


NUMBERED_COLUMN = re.compile(rf"(?i)(|.*[/.])({ALL_WORDS})([\[(._/]?\d+[\])]?)")
"""Name of a column with a numbered joint, whose name may be in an adjacent column: position[0] and name[0]."""


class Named(NamedTuple):
    """A column: its number from 1, its name, its unit ("" if the name has none), the path of its message."""

    number: int
    name: str
    unit: str
    path: str | None = None


Family = dict[str, Named]
"""Columns of one quantity by joint."""


def candidates(table: RecordedTable, joints: Sequence[str] | None) -> dict[str, dict[str, Family]]:
    """Families of columns by quantity. Raises AmbiguousColumns for two columns of the same joint."""
    found: dict[str, dict[str, Family]] = {name: {} for name in QUANTITY_WORDS}
    places = {name: len(table.names) - k for k, name in enumerate(reversed(table.names), start=1)}
    for number, name in enumerate(table.names, start=1):
        said = meaning(name, joints)
        if said is None:
            continue
        joint = _joint_name(table, places, name, said)
        family = found[said.quantity].setdefault(said.family, {})
        if joint in family:
            other = family[joint]
            raise AmbiguousColumns(
                f"{table.path}: {other.name!r} (column {other.number}) and {name!r} (column {number}) are both "
                f"{said.quantity} of {joint!r}; say in a mapping (docs/recordings.md) which to take"
            )
        family[joint] = Named(number, name, said.unit, said.path)
    return found


def only(table: RecordedTable, found: dict[str, dict[str, Family]]) -> dict[str, Family]:
    """The family of every quantity that has one. Raises AmbiguousColumns if a quantity has several."""
    for quantity, families in found.items():
        if len(families) > 1:
            names = "; ".join(listed(family) for family in families.values())
            raise AmbiguousColumns(
                f"{table.path}: {len(families)} candidates for {quantity}: {names}; "
                "say in a mapping (docs/recordings.md) which to take"
            )
    return {name: next(iter(families.values())) for name, families in found.items() if families}


def _joint_name(table: RecordedTable, places: Mapping[str, int], name: str, said: Meaning) -> str:
    """The joint of a column; for position[0] the text in the column name[0], if there is one.

    places: of the columns by their names, the first of each
    """
    element = NUMBERED_COLUMN.fullmatch(name)
    beside = f"{element[1]}name{element[3]}" if element else ""
    if not said.joint.isdigit() or beside not in places:
        return said.joint
    texts = table.texts.get(places[beside], {})
    joints = {text for text in texts.values() if text}  # broken lines have none
    if len(joints) > 1:
        raise AmbiguousColumns(
            f"{table.path}: {beside!r} names several joints ({in_words(sorted(joints))}); give every joint its columns"
        )
    return joints.pop() if joints else said.joint


def known_unit_of(where: str, quantity: str, column: Named) -> Unit:
    """The unit in the name, otherwise SI. A drive's current is refused as a torque."""
    unit = unit_of(quantity, column.unit or SI_UNITS.get(quantity, "s"))
    if unit is None or unit.needs_gain:
        raise BadMapping(
            f"{where}: column {column.name!r} is in {column.unit!r}, which is not a unit of {quantity}; give a mapping"
        )
    return unit


def listed(family: Family) -> str:
    """The first and the last column, for a message."""
    names = [column.name for column in family.values()]
    return in_words(names) if len(names) == 1 else f"{in_words(names[:1])} … {in_words(names[-1:])}"
