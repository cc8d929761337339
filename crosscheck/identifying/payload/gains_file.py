"""Gains in a TOML file: of a data sheet, or as `graphdyn payload --write-gains` has found them.

joints = ["shoulder", "elbow"]      # others have no gain
gains = [13.3, 9.4]                 # torque per unit of the recorded column
relative_deviations = [0.05, 0.05]  # or covariance, of the logarithms of the gains
recordings = ["weight.csv"]         # files that gave them, if any did
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from graphdyn import InvalidInput
from graphdyn.identification.currents import JointGains
from graphdyn.layout import Array
from urdf.document import toml_document

GAIN_KEYS = ("joints", "gains", "relative_deviations", "covariance", "source", "recordings")


def load_gains(path: Path, joints: Sequence[str]) -> JointGains:
    """Gains of these joints; those that the file leaves out are undetermined.

    Raises InvalidInput, naming the file and the entry.
    """
    try:
        table = toml_document(path.read_bytes())
    except (OSError, ValueError) as error:
        raise InvalidInput(f"{path}: {error}") from error
    unknown = [key for key in table if key not in GAIN_KEYS]
    if unknown:
        raise InvalidInput(f"{path}: {unknown[0]} is unknown; a file of gains has {', '.join(GAIN_KEYS)}")
    named = table.get("joints")
    if not isinstance(named, list) or not named or len({str(name) for name in named}) < len(named):
        raise InvalidInput(f"{path}: joints is {named!r}; list the joints that have a gain, each once")
    strange = [name for name in named if name not in joints]
    if strange:
        raise InvalidInput(f"{path}: the robot has no joint '{strange[0]}'; it has {', '.join(joints)}")
    m = len(named)
    values = _numbers(path, "gains", table.get("gains"), (m,))
    if ("covariance" in table) == ("relative_deviations" in table):
        raise InvalidInput(f"{path}: give either relative_deviations or covariance")
    if "covariance" in table:
        known = _numbers(path, "covariance", table["covariance"], (m, m))
    else:
        known = np.diag(_numbers(path, "relative_deviations", table["relative_deviations"], (m,)) ** 2)
    places = [joints.index(name) for name in named]
    found, covariance = np.full(len(joints), np.nan), np.diag(np.full(len(joints), np.inf))
    found[places], covariance[np.ix_(places, places)] = values, known
    return JointGains(found, covariance)


def recordings_of_gains(path: Path) -> tuple[str, ...]:
    """Files that gave the gains of a file that load_gains reads."""
    found = toml_document(path.read_bytes()).get("recordings", [])
    return tuple(map(str, found)) if isinstance(found, list) else ()


def gains_document(gains: JointGains, joints: Sequence[str], source: str, recordings: Sequence[str] = ()) -> bytes:
    """The text of the file for these gains; those that are undetermined are left out.

    source: what gave them, in words; recordings: files that did
    """
    places = np.flatnonzero(gains.determined)
    covariance = ["  [" + ", ".join(map(repr, row.tolist())) + "]" for row in gains.covariance[np.ix_(places, places)]]
    lines = [
        "# Gains: torque [N m or N] per unit of the recorded current; covariance of their logarithms.",
        f"source = {_quoted(source)}",
        f"recordings = [{', '.join(map(_quoted, recordings))}]",
        f"joints = [{', '.join(_quoted(joints[place]) for place in places.tolist())}]",
        f"gains = [{', '.join(map(repr, gains.values[places].tolist()))}]",
        "covariance = [",
        *(f"{row}," for row in covariance),
        "]",
    ]
    return ("\n".join(lines) + "\n").encode()


def _quoted(text: str) -> str:
    """A basic string of TOML."""
    plain = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in plain) + '"'


def _numbers(path: Path, key: str, value: Any, shape: tuple[int, ...]) -> Array:
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.zeros(0)
    if array.shape != shape or not np.all(np.isfinite(array)):
        raise InvalidInput(f"{path}: {key} is {value!r}; give {' × '.join(map(str, shape))} numbers, as many as joints")
    return array
