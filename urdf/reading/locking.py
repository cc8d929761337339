"""Joints that the caller locks: they become fixed joints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from urdf.errors import InvalidLock

Lock = Mapping[str, float] | Iterable[str] | None


def locked_values(lock: Lock, movable: Iterable[str], path: Path) -> dict[str, float]:
    """Value per locked joint [rad or m]; 0 where only names are given.

    Raises InvalidLock for a name that is not among the movable joints, and for a value that is not a finite number.
    """
    if lock is None:
        return {}
    if isinstance(lock, str):
        raise InvalidLock(f"lock is the string '{lock}'", f"give a list of joint names: ['{lock}']", path=path)
    wanted = dict(lock) if isinstance(lock, Mapping) else dict.fromkeys(lock, 0.0)
    known = list(movable)
    for name, value in wanted.items():
        if name not in known:
            raise InvalidLock(
                f"cannot lock '{name}': the robot has no such movable joint", f"known: {', '.join(known)}", path=path
            )
        if not isinstance(value, (int, float, np.number)) or not np.isfinite(value):
            raise InvalidLock(
                f"cannot lock '{name}' at {value!r}", "give a finite number in rad (prismatic: m)", path=path
            )
    return {name: float(value) for name, value in wanted.items()}
