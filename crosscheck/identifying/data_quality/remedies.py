"""A change of columns as text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphdyn.identification.data_quality import Change
from graphdyn.layout import Array


def change_in_words(change: Change, joint_names: Sequence[str], deviation: float = float("nan")) -> str:
    """The fault as text, such as "the torque of elbow is reversed". deviation: of a lag [s]."""
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
            return f"the positions are in degrees{alone}"
        case "radians":
            return f"the positions are in rad, and were taken for degrees{alone}"
        case "zero":
            degrees = float(np.rad2deg(change.zero[list(change.joints)][0]))  # type: ignore[index]
            return f"the zero of {names} is {-degrees:g}° away from that of the model"
        case "scaled torque":
            if len(change.joints) > 1:
                return f"all torques are {change.factor:.3g} times those of CAD and drives, as in another unit"
            return f"the torque of {names} is {change.factor:.3g} times that of the others, as in another unit"
        case "late torque":
            who = "the torques were" if len(change.joints) > 1 else f"the torque of {names} was"
            when = "late" if change.factor > 0 else "early"
            return f"{who} recorded {1e3 * abs(change.factor):.1f} ± {1e3 * deviation:.1f} ms {when}"


def _with_factors(matrix: Array | None) -> str:
    """Whether the factors of exchanged columns stay with the joints."""
    return "" if matrix is None or np.all((matrix == 0) | (matrix == 1)) else ", their signs and gains are not"
