"""A change of columns as text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphdyn.identification.data_quality import Change
from graphdyn.layout import Array

MIN_TILT = 0.5
"""Angle [°] from which gravity has another direction than that of the model."""

GEAR_RATIOS = (30, 40, 50, 60, 80, 81, 100, 101, 120, 121, 160, 161)
"""Ratios of strain wave gears in data sheets; the odd ones are those of the other output."""

RATIO_DEVIATIONS, MAX_RATIO_DEVIATION, MAX_RATIOS = 2.0, 0.02, 3
"""Distance of a quotient of two such ratios in σ, largest relative σ that tells them from each other, and the number of
pairs that are named."""

SAME_DIRECTION = 1e-6
"""Relative difference of vectors below which they are the same up to rounding."""


def change_in_words(
    change: Change, joint_names: Sequence[str], deviation: float = float("nan"), gravity: Array | None = None
) -> str:
    """The fault as text, such as "the torque of elbow is reversed".

    deviation: of the size that was found: a delay [s], an angle [°], a factor; gravity: that of the model (3,) [m/s²]
    """
    names = " and ".join(joint_names[j] for j in change.joints)
    alone = {"": "", "position": " (velocity right)", "velocity": " in its velocity alone"}[change.alone]
    turned = ""
    if change.zero is not None and change.kind != "zero":
        turned = ", with its zero half a turn away"
    match change.kind:
        case "reversed torque":
            return f"the torque of {names} is reversed"
        case "reversed position":
            return f"the position of {names} is reversed{alone}{turned}"
        case "reversed joint":
            return f"{names} turns the other way than in the model, position and torque{turned}"
        case "exchanged torques":
            return f"the torques of {names} are exchanged{_with_factors(change.torque)}"
        case "exchanged positions":
            return f"the positions of {names} are exchanged{_with_factors(change.position)}{alone}"
        case "exchanged joints":
            return f"{names} are exchanged, positions and torques{_with_factors(change.torque)}"
        case "all torques reversed":
            return "all torques are reversed, or gravity"
        case "all positions reversed":
            return "all positions are reversed"
        case "degrees":
            return f"the {_positions(change, names)} in degrees{alone}"
        case "radians":
            return f"the {_positions(change, names)} in rad, and taken for degrees{alone}"
        case "zero":
            degrees = -float(np.rad2deg(change.zero[list(change.joints)][0]))  # type: ignore[index]
            size = f"{degrees:.3g} ± {deviation:.2g}" if np.isfinite(deviation) else f"{degrees:g}"
            return f"the zero of {names} is {size}° away from that of the model"
        case "gear ratio":
            torques = "" if change.torque is None else f", and its torque {change.factor:.4g} times"
            size = f"{1 / change.factor:.4g}{_plus_minus(deviation / change.factor**2)}"
            ratios = _ratios(1 / change.factor, deviation / change.factor**2)
            return f"the position of {names} is {size} times the right one{torques}, as with {ratios}"
        case "time scale":
            size = f"{1 / change.factor:.4g}{_plus_minus(deviation / change.factor**2)}"
            return f"the clock runs at {size} times the right rate, or gravity has another size than in the model"
        case "gravity":
            return _mounting(np.asarray(change.gravity), gravity, deviation)
        case "gravity subtracted":
            return "the torques hold no gravity; it was subtracted before they were recorded"
        case "coupled positions" | "coupled joints":
            driven, driving = (joint_names[j] for j in change.joints)
            sign = "plus" if change.factor > 0 else "minus"
            torques = ", and its torque acts on both" if change.torque is not None else ""
            return f"the angle of {driven} is its column {sign} that of {driving}{torques}"
        case "scaled torque":
            if len(change.joints) > 1:
                return f"all torques are {change.factor:.3g} times those of CAD and drives, as in another unit"
            size = f"{change.factor:.3g}{_plus_minus(deviation)}"
            return f"the torque of {names} is {size} times that of the others, as in another unit"
        case "late torque":
            who = "the torques were" if len(change.joints) > 1 else f"the torque of {names} was"
            when = "late" if change.factor > 0 else "early"
            return f"{who} recorded {1e3 * abs(change.factor):.1f} ± {1e3 * deviation:.1f} ms {when}"


def _ratios(found: float, deviation: float) -> str:
    """Pairs of gear ratios of data sheets whose quotient is the one found, within its deviations, as text."""
    pairs = [(one, other) for one in GEAR_RATIOS for other in GEAR_RATIOS if one != other]
    near = [pair for pair in pairs if abs(pair[0] / pair[1] - found) <= RATIO_DEVIATIONS * deviation]
    near = sorted(near, key=lambda pair: (abs(pair[0] / pair[1] - found), pair[0]))[:MAX_RATIOS]
    if not near or deviation > MAX_RATIO_DEVIATION * found:
        return "another gear ratio"
    return "a gear ratio of " + " or ".join(f"{one} in place of {other}" for one, other in near)


def _positions(change: Change, names: str) -> str:
    """Whose positions a unit concerns, with the verb."""
    return "positions are" if len(change.joints) > 1 else f"position of {names} is"


def _plus_minus(deviation: float) -> str:
    return f" ± {deviation:.1g}" if np.isfinite(deviation) else ""


def _with_factors(matrix: Array | None) -> str:
    """Whether the factors of exchanged columns stay with the joints."""
    return "" if matrix is None or np.all((matrix == 0) | (matrix == 1)) else ", their signs and gains are not"


def _mounting(found: Array, gravity: Array | None, deviation: float) -> str:
    """Direction and size of gravity against those of the model."""
    told = f"gravity is ({', '.join(f'{g:.3g}' for g in found)}) m/s² in world axes"
    if gravity is None or not np.any(gravity):
        return told
    size, given = float(np.linalg.norm(found)), float(np.linalg.norm(gravity))
    cosine = float(np.clip(found @ gravity / (size * given), -1, 1))
    angle = float(np.rad2deg(np.arccos(cosine)))
    if angle > MIN_TILT:
        axis = np.cross(found, gravity)
        told += f", {angle:.3g} ± {deviation:.2g}° from that of the model"
        if np.linalg.norm(axis) > SAME_DIRECTION * size * given:  # turned the other way than gravity in its frame
            told += f": the robot is mounted turned by this angle about ({_unit(axis)})"
    if abs(size / given - 1) > SAME_DIRECTION:
        told += f", {size / given:.3g} times its size"
    return told


def _unit(axis: Array) -> str:
    return ", ".join(f"{x + 0:.2g}" for x in np.round(axis / np.linalg.norm(axis), 2))
