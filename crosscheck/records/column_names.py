"""What columns are, by their names: q_1, position.elbow, joint2.tau [N m], qd_shoulder_pan_joint, time_ms.

A name says the quantity first (tau_motor_Nm_2) or, behind a dot, last (joint2.tau). What is left of it without the
quantity and the unit is the joint. Columns that differ only in the joint are a family; two families of one quantity
(motor and secondary encoder) leave open which is meant, and are refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crosscheck.records.errors import AmbiguousColumns, BadMapping
from crosscheck.records.findings import Finding
from crosscheck.records.mapping import QUANTITIES, SI_UNITS, Channel, ColumnMapping, TimeColumn
from crosscheck.records.table import Table
from crosscheck.records.units import unit_of

WORDS = {
    "time": ("t", "time", "stamp", "timestamp", "timestamps", "times", "bag_t", "header_stamp"),
    "q": ("q", "pos", "position", "positions", "angle", "joint_position", "joint_positions", "actual_q"),
    "v": ("v", "qd", "dq", "qdot", "vel", "velocity", "velocities", "joint_velocity", "joint_velocities", "actual_qd"),
    "a": ("a", "qdd", "ddq", "qddot", "acc", "acceleration", "accelerations", "joint_acceleration"),
    "tau": ("tau", "torque", "torques", "effort", "efforts", "joint_torque", "joint_torques", "joint_effort"),
}
"""What programs call the quantities; compared without regard to case."""

CURRENTS = re.compile(r"(?i)(actual_|motor_|target_)?(current|currents|i|amps)[ _.]?\d+|.*\.(current|i)$")
"""Columns that are no torque without a gain: mentioned, never taken."""

SUFFIX_UNITS = {
    "q": {"rad": "rad", "deg": "deg", "m": "m", "mm": "mm"},
    "v": {"rad_s": "rad/s", "rads": "rad/s", "deg_s": "deg/s", "degs": "deg/s", "rpm": "rpm", "m_s": "m/s"},
    "a": {"rad_s2": "rad/s^2", "deg_s2": "deg/s^2", "m_s2": "m/s^2"},
    "tau": {"nm": "N m", "n_m": "N m"},
    "time": {"s": "s", "sec": "s", "ms": "ms", "us": "us", "ns": "ns"},
}
"""Units as parts of a name."""


class Meaning(NamedTuple):
    """Of one column: quantity, family (the name with * for the joint), joint, unit ("" where the name has none)."""

    quantity: str
    family: str
    joint: str
    unit: str


def meaning(name: str, joints: Sequence[str] | None) -> Meaning | None:
    """What the name says; None where it says nothing known."""
    label, unit = name.strip(), ""
    bracket = re.fullmatch(r"(.*\S)\s*[\[(]([^\[\]()]*)[\])]", label)
    if bracket:
        label, unit = bracket[1], bracket[2].strip()
    for quantity, words in WORDS.items():
        alternatives = "|".join(sorted(words, key=len, reverse=True))
        last = quantity != "time" and re.fullmatch(rf"(?i)(.+)\.({alternatives})", label)
        if last:
            return Meaning(quantity, f"*.{last[2]}", last[1], unit)
        first = re.fullmatch(rf"(?i)({alternatives})(?:[ _./-]*(.*))?", label)
        # without a separator only a number may follow: 'q1' is a position, 'quality' is not
        if first and (not first[2] or not label[len(first[1])].isalnum() or first[2][0].isdigit()):
            found = _joint(quantity, first[1], first[2] or "", joints, unit)
            if found:
                return found
    return None


def _joint(quantity: str, word: str, rest: str, joints: Sequence[str] | None, unit: str) -> Meaning | None:
    """Take the rest of a name apart: what of it is unit, what is joint."""
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
    if number:
        return Meaning(quantity, f"{word}_{number[1]}_*".replace("__", "_"), number[2], unit)
    return Meaning(quantity, f"{word}_*", rest, unit)


def mapping_by_name(table: Table, joints: Sequence[str] | None, rate: float | None) -> tuple[ColumnMapping, list[Finding]]:
    """The mapping that the names of the columns say. Raises AmbiguousColumns, BadMapping."""
    where = str(table.path)
    if not table.has_names:
        raise BadMapping(f"{where}: the columns have no names; give a mapping with their numbers")
    families: dict[str, dict[str, dict[str, tuple[int, str]]]] = {name: {} for name in WORDS}
    for number, name in enumerate(table.names, start=1):
        found = meaning(name, joints)
        if found:
            family = families[found.quantity].setdefault(found.family, {})
            if found.joint in family:
                raise AmbiguousColumns(
                    f"{where}: '{table.names[family[found.joint][0] - 1]}' (column {family[found.joint][0]}) and '{name}' "
                    f"(column {number}) are both {found.quantity} of '{found.joint}'; say in a mapping which to take"
                )
            family[found.joint] = (number, found.unit)
    for quantity, candidates in families.items():
        if len(candidates) > 1:
            listed = "; ".join(_listed(table, family) for family in candidates.values())
            raise AmbiguousColumns(
                f"{where}: {len(candidates)} candidates for {quantity}: {listed}; say in a mapping which to take"
            )
    if not families["q"]:
        raise BadMapping(
            f"{where}: no columns of joint positions (q_1, position_1, q_<joint>, <joint>.q, …) among "
            f"{', '.join(table.names)}; give a mapping"
        )
    elements = {name: next(iter(found.values())) for name, found in families.items() if found}
    order = _order(where, list(elements["q"]), joints)
    findings, channels = [], {}
    for name in QUANTITIES:
        if name not in elements:
            continue
        if not set(order) <= set(elements[name]):
            raise BadMapping(
                f"{where}: {name} has columns for {', '.join(elements[name])}, joints are {', '.join(order)}; give a mapping"
            )
        columns = [elements[name][joint] for joint in order]
        units = [unit_of(name, unit or SI_UNITS[name]) for _, unit in columns]
        for (number, text), unit in zip(columns, units, strict=True):
            if unit is None or unit.needs_gain:
                raise BadMapping(
                    f"{where}: column '{table.names[number - 1]}' is in '{text}', which is no unit of {name}; give a mapping"
                )
        known = [unit for unit in units if unit is not None]
        numbers = tuple(number for number, _ in columns)
        slides = tuple(unit.slides if text else None for unit, (_, text) in zip(known, columns, strict=True))
        channels[name] = Channel(numbers, np.array([unit.factor for unit in known]), np.zeros(len(order)), slides)
        if not all(text for _, text in columns):
            names = ", ".join(table.names[number - 1] for number in numbers)
            message = f"{name} in columns without units ({names})"
            findings.append(_note(where, "assumed-unit", message, f"{SI_UNITS[name]} is taken; name units in the header"))
    currents = [name for name in table.names if CURRENTS.fullmatch(name)]
    if "tau" not in channels and currents:
        message = f"no torques, but currents ({', '.join(currents)})"
        findings.append(_note(where, "current-without-gain", message, "give their gains in a mapping"))
    time = _time(table, elements.get("time"), rate, findings)
    names = tuple(f"joint_{joint}" if joint.isdigit() else joint for joint in order)
    if joints and names != tuple(joints):
        names = tuple(joints)
        message = f"the columns have numbers, the joints names ({', '.join(names)})"
        findings.append(_note(where, "numbered-joints", message, "they are taken in this order"))
    return ColumnMapping("by name", names, channels, time=time, rate=rate if time is None else None), findings


def _order(where: str, found: list[str], joints: Sequence[str] | None) -> list[str]:
    """The joints in the order of the robot, if it is known; numbers in their order, names in that of the columns."""
    if all(joint.isdigit() for joint in found):
        found = sorted(found, key=int)
        if joints and len(joints) != len(found):
            raise BadMapping(f"{where}: positions of {len(found)} joints, the robot has {len(joints)}; give a mapping")
        return found
    missing = [joint for joint in joints or () if joint not in found]
    if missing:
        raise BadMapping(f"{where}: no position of '{missing[0]}' (there are {', '.join(found)}); give a mapping")
    return list(joints or found)


def _time(
    table: Table, element: dict[str, tuple[int, str]] | None, rate: float | None, findings: list[Finding]
) -> TimeColumn | None:
    if element is None:
        if rate is None:
            raise BadMapping(f"{table.path}: no column of time (t, time_s, stamp, …); give the rate, or a mapping")
        return None
    number, text = element[""]
    unit = unit_of("time", text or "s")
    if unit is None:
        raise BadMapping(f"{table.path}: time in '{text}', which is no unit of time; give a mapping")
    if not text:
        message = f"time in a column without unit ({table.names[number - 1]})"
        findings.append(_note(str(table.path), "assumed-unit", message, "s is taken; name the unit in the header"))
    return TimeColumn(number, unit.factor)


def _listed(table: Table, family: dict[str, tuple[int, str]]) -> str:
    names = [table.names[number - 1] for number, _ in family.values()]
    return names[0] if len(names) == 1 else f"{names[0]} … {names[-1]}"


def _note(where: str, code: str, message: str, remedy: str) -> Finding:
    return Finding(code, "note", where, None, (), message, remedy)
