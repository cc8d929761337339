"""The meaning of columns by their names: q_1, position.elbow, joint2.tau [N m], qd_shoulder_pan_joint, time_ms.

A name gives the quantity first (tau_motor_Nm_2) or, after a dot, last (joint2.tau). The rest, without the unit, is the
joint. Columns that differ only in the joint are a family; two families of one quantity (motor and secondary encoder)
are ambiguous, and refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

WORDS = {
    "time": ("t", "time", "stamp", "timestamp", "timestamps", "times", "bag_t", "header_stamp"),
    "q": ("q", "pos", "position", "positions", "angle", "joint_position", "joint_positions", "actual_q"),
    "v": ("v", "qd", "dq", "qdot", "vel", "velocity", "velocities", "joint_velocity", "joint_velocities", "actual_qd"),
    "a": ("a", "qdd", "ddq", "qddot", "acc", "acceleration", "accelerations", "joint_acceleration"),
    "tau": ("tau", "torque", "torques", "effort", "efforts", "joint_torque", "joint_torques", "joint_effort"),
}
"""Names of the quantities in files of many programs; upper and lower case are the same."""

CURRENTS = re.compile(r"(?i)(actual_|motor_|target_)?(current|currents|i|amps)[ _.]?\d+|.*\.(current|i)$")
"""Columns of currents, which are torques only with a gain: reported, never used."""

SUFFIX_UNITS = {
    "q": {"rad": "rad", "deg": "deg", "m": "m", "mm": "mm"},
    "v": {"rad_s": "rad/s", "rads": "rad/s", "deg_s": "deg/s", "degs": "deg/s", "rpm": "rpm", "m_s": "m/s"},
    "a": {"rad_s2": "rad/s^2", "deg_s2": "deg/s^2", "m_s2": "m/s^2"},
    "tau": {"nm": "N m", "n_m": "N m"},
    "time": {"s": "s", "sec": "s", "ms": "ms", "us": "us", "ns": "ns"},
}
"""Units by the part of a name that stands for them."""


class Meaning(NamedTuple):
    """Meaning of a column: quantity, family (the name with * for the joint), joint, unit ("" if the name has none)."""

    quantity: str
    family: str
    joint: str
    unit: str


def meaning(name: str, joints: Sequence[str] | None) -> Meaning | None:
    """The meaning of a name; None where it is unknown."""
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
            found = _joint(quantity, first[1], first[2] or "", joints, unit, label[len(first[1]) :].startswith("."))
            if found:
                return found
    return None


def _joint(quantity: str, word: str, rest: str, joints: Sequence[str] | None, unit: str, dot: bool) -> Meaning | None:
    """Split the rest of a name into unit and joint.

    A rest that ends with a number ends with the number of a joint, unless all of it is a joint name: joint_1, or a
    name with a dot.
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
