"""Causes whose size was found, and what changed during a recording, as text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.identifying.data_quality.remedies import change_in_words
from graphdyn.identification.data_quality import Addition, Change, DataFault
from graphdyn.layout import Array

CODES = {
    "friction drift": "torque-drift",
    "torque jump": "torque-drift",
    "gain jump": "torque-drift",
    "attached load": "payload-change",
    "detached load": "payload-change",
    "coupled positions": "coupling",
    "coupled joints": "coupling",
}
"""Codes of findings that are not their kind with hyphens."""


def code_of(cause: Change | Addition) -> str:
    """Stable name of the kind of a cause."""
    return CODES.get(cause.kind, cause.kind.replace(" ", "-"))


def cause_in_words(fault: DataFault, joint_names: Sequence[str], gravity: Array) -> str:
    """The cause of a fault as text, with the standard deviation of its size.

    gravity: that of the model (3,) [m/s²]
    """
    cause, names = fault.change, _names(fault.change, joint_names)
    if isinstance(cause, Addition):
        return _added(cause, names, fault)
    return change_in_words(cause, joint_names, fault.deviation, gravity)


def remedy_of(cause: Change | Addition) -> str:
    """What to do about a cause, in front of lines of a mapping where it has any."""
    if isinstance(cause, Change):
        if cause.gravity is None:
            return "correct it in the mapping"
        if cause.kind == "gravity subtracted":
            return "record whole torques, or take --gravity 0 0 0 to model what is left"
        return f"correct the mounting of the robot: --gravity {' '.join(f'{g:.4g}' for g in cause.gravity)}"
    match cause.kind:
        case "torque drift":
            return "correct the torques for it, or use a part of the recording, by --split"
        case "friction drift":
            return "give it to the model: --terms with coulomb*time and viscous*time beside coulomb and viscous"
        case "friction subtracted":
            return "record whole torques, or take --terms none"
        case "filtered torque":
            return "record the torque in front of that filter"
    return "use one part of the recording, by --split"


def _names(cause: Change | Addition, joint_names: Sequence[str]) -> str:
    if len(cause.joints) == len(joint_names) > 1:
        return "all joints"
    return " and ".join(joint_names[j] for j in cause.joints)


def _added(cause: Addition, names: str, fault: DataFault) -> str:
    x = np.zeros(1) if fault.parameters is None else fault.parameters
    size = f"{x[0]:.3g} ± {fault.deviation:.2g}"
    at = f"after {100 * cause.instant:.0f} % of the recording"
    match cause.kind:
        case "torque drift":
            percent = _growth(cause, float(x[0]), fault.deviation)
            return f"the torque of {names} grows by {percent} during the recording, beside what the motion explains"
        case "gain jump":
            percent = _growth(cause, float(x[0]), fault.deviation)
            return f"the gain of the torque of {names} jumps by {percent} {at}"
        case "friction drift":
            percent = f"{100 * x[0]:.2g} ± {100 * fault.deviation:.1g} %"
            return f"the friction of {names} grows by {percent} during the recording"
        case "attached load":
            return f"a load of {size} kg was attached {at}"
        case "detached load":
            return f"a load of {size} kg was taken off {at}"
        case "torque jump":
            return f"the torque of {names} jumps by {size} N m or N {at}"
        case "filtered torque":
            return (
                f"the torque of {names} went through a low-pass of {1 / (2 * np.pi * x[0]):.3g} Hz, a time constant of "
                f"{1e3 * x[0]:.3g} ± {1e3 * fault.deviation:.2g} ms"
            )
        case "friction subtracted":
            return f"the torque of {names} holds negative friction; too much was subtracted before it was recorded"


def _growth(cause: Addition, x: float, deviation: float) -> str:
    """Growth of a gain from the first row to the last, with its standard deviation."""
    assert cause.growth is not None
    first, last = float(cause.growth[0]), float(cause.growth[-1])
    growth = (1 + x * first) / (1 + x * last) - 1
    slope = (first - last) / (1 + x * last) ** 2
    return f"{100 * growth:.2g} ± {100 * abs(slope) * deviation:.1g} %"
