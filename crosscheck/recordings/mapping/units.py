"""Units of recorded columns, in SI."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crosscheck.recordings.errors import BadMapping

_TURN = 2 * np.pi
_DEGREE = np.pi / 180

TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}

JOINTLESS_UNITS = {"time": TIME_UNITS, "temperature": {"degC": 1.0}}
"""Units of quantities that are the same for revolute and prismatic joints."""

TURNING_UNITS = {
    "q": {"rad": 1.0, "mrad": 1e-3, "deg": _DEGREE, "rev": _TURN},
    "v": {"rad/s": 1.0, "deg/s": _DEGREE, "rev/s": _TURN, "rpm": _TURN / 60},
    "a": {"rad/s^2": 1.0, "deg/s^2": _DEGREE, "rev/s^2": _TURN},
    "tau": {"N m": 1.0, "N mm": 1e-3, "N cm": 1e-2, "kN m": 1e3, "mN m": 1e-3},
}
SLIDING_UNITS = {
    "q": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "v": {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3},
    "a": {"m/s^2": 1.0, "cm/s^2": 1e-2, "mm/s^2": 1e-3},
    "tau": {"N": 1.0, "kN": 1e3},
}
DRIVE_UNITS = {"A": 1.0, "mA": 1e-3, "%": 1.0}
"""Units in which drives report current, or torque as a part of the rated one; they need a gain."""


class Unit(NamedTuple):
    """Factor to SI; whether it is for prismatic joints (None: for both types); whether a torque needs a gain."""

    factor: float
    slides: bool | None
    needs_gain: bool


def _spelling(unit: str) -> str:
    """One spelling for 'N·m', 'Nm' and 'N m', for 'rad/s²' and 'rad/s^2', for '°' and 'deg'."""
    for old, new in (("·", ""), ("*", ""), (" ", ""), ("²", "2"), ("^", ""), ("°", "deg"), ("µ", "u"), ("μ", "u")):
        unit = unit.replace(old, new)
    return unit


def unit_of(quantity: str, name: str) -> Unit | None:
    """The unit of this name, or None if the quantity (q, v, a, tau, temperature, time) has no such unit."""
    tables: list[tuple[dict[str, float], bool | None, bool]]
    if quantity in JOINTLESS_UNITS:
        tables = [(JOINTLESS_UNITS[quantity], None, False)]
    else:
        tables = [(TURNING_UNITS[quantity], False, False), (SLIDING_UNITS[quantity], True, False)]
        if quantity == "tau":
            tables.append((DRIVE_UNITS, None, True))
    for units, slides, needs_gain in tables:
        for known, factor in units.items():
            if _spelling(known) == _spelling(name):
                return Unit(factor, slides, needs_gain)
    return None


def known_unit(quantity: str, name: str, where: str) -> Unit:
    """The unit of this name. Raises BadMapping, listing the units of the quantity."""
    unit = unit_of(quantity, name)
    if unit is None:
        if quantity in JOINTLESS_UNITS:
            names = [*JOINTLESS_UNITS[quantity]]
        else:
            names = [*TURNING_UNITS[quantity], *SLIDING_UNITS[quantity], *(DRIVE_UNITS if quantity == "tau" else ())]
        raise BadMapping(f"{where}: {name!r} is not a unit of {quantity}; use one of: {', '.join(names)}")
    return unit
