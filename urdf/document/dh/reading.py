"""The TOML file of a table of Denavit-Hartenberg parameters. Nothing is guessed: units and convention are named."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from graphdyn import Body, GraphDynError, JointLimits, Placement
from graphdyn.arguments import closest
from graphdyn.layout import Array
from graphdyn.model import STANDARD_GRAVITY, parallel_axis
from urdf.document.dh.table import CONVENTIONS, DHLink, DHRow, DHTable
from urdf.document.numbers import MAX_NUMBER, rotation_from_rpy
from urdf.document.toml_text import toml_document
from urdf.errors import InvalidDH, listed, shortened

T = TypeVar("T")

TABLE_ANGLE_UNITS = {"rad": 1.0, "deg": math.pi / 180}
TABLE_LENGTH_UNITS = {"m": 1.0, "mm": 1e-3}
TENSOR_POINTS = ("center", "frame")
TABLE_JOINT_TYPES = ("revolute", "prismatic")

MAX_ANGLE = 2 * math.pi
"""Largest angle of a table [rad]: more than a turn is in degrees."""

MAX_LENGTH = 100.0
"""Largest length of a table [m]: more than the longest arms have is in mm."""

_JOINT = re.compile(r"\s*\[\[\s*joint\s*\]\]")


class _Settings:
    """One table of the file, read key by key."""

    def __init__(self, path: Path, where: str, line: int | None, values: object) -> None:
        self._path, self._where, self._line = path, where, line
        if not isinstance(values, dict):
            raise self.error(f"{where} is {shortened(repr(values))}, not a table", f"write [{where}] and keys below it")
        self._left: dict[str, Any] = dict(values)
        self._known: list[str] = []

    def error(self, problem: str, remedy: str, code: str = "invalid-dh") -> InvalidDH:
        return InvalidDH(problem, remedy, code=code, path=self._path, line=self._line, element=self._where)

    def take(self, key: str, read: Callable[[object], T], otherwise: T | None = None) -> T:
        """The value of a key, which read turns into what is meant. Raises InvalidDH where there is none."""
        self._known.append(key)
        if key not in self._left:
            if otherwise is None:
                raise self.error(f"'{key}' is missing", f"add {key} = …", "missing-key")
            return otherwise
        given = self._left.pop(key)
        try:
            return read(given)
        except ValueError as error:
            said = shortened(repr(given))
            raise self.error(f"{key} = {said}: {error}", f"correct {key}", "invalid-value") from None

    def optional(self, key: str, read: Callable[[object], float]) -> float | None:
        self._known.append(key)
        return self.take(key, read) if key in self._left else None

    def settings(self, key: str, *, required: bool = False) -> _Settings:
        """A table within this one; empty where there is none."""
        self._known.append(key)
        if required and key not in self._left:
            raise self.error(f"[{key}] is missing", f"add [{key}]", "missing-key")
        where = f"{self._where}, {key}" if self._where != "the file" else key
        return _Settings(self._path, where, self._line, self._left.pop(key, {}))

    def refuse_others(self) -> None:
        for key in self._left:
            near = closest(key, self._known)
            remedy = f"did you mean '{near}'?" if near else f"it has {', '.join(self._known)}"
            raise self.error(f"'{shortened(key)}' is no key here", remedy, "unknown-key")


def read_table(path: Path, content: bytes) -> tuple[DHTable, Sequence[int]]:
    """The table, and the line of each [[joint]]. Raises InvalidDH."""
    try:
        document = toml_document(content)
    except ValueError as error:
        remedy = "correct it there; docs/dh.md shows a whole file"
        raise InvalidDH(f"the file {error}", remedy, code="malformed-toml", path=path) from None
    whole = _Settings(path, "the file", None, document)
    name = whole.take("name", _name)
    convention = whole.take("convention", _one_of(CONVENTIONS))
    angle, length = (
        TABLE_ANGLE_UNITS[whole.take("angles", _one_of(tuple(TABLE_ANGLE_UNITS)))],
        TABLE_LENGTH_UNITS[whole.take("lengths", _one_of(tuple(TABLE_LENGTH_UNITS)))],
    )
    gravity = whole.take("gravity", _vector(1.0, MAX_NUMBER), np.array(STANDARD_GRAVITY))
    base_name, base = _placement(whole.settings("base"), "base", angle, length)
    tool_name, tool = _placement(whole.settings("tool"), "tool", angle, length)
    given = whole.take("joint", _tables)
    whole.refuse_others()
    numbers = [k for k, line in enumerate(content.decode().splitlines(), start=1) if _JOINT.match(line)]
    lines = numbers if len(numbers) == len(given) else [1] * len(given)
    rows = [
        _row(_Settings(path, f"joint {number}", line, values), number, angle, length)
        for number, (line, values) in enumerate(zip(lines, given, strict=True), start=1)
    ]
    _refuse_twice(path, lines, [row.name for row in rows], "joint")
    _refuse_twice(path, [1, 1, *lines], [base_name, tool_name, *(row.link.name for row in rows)], "link")
    return DHTable(name, convention, base, tuple(rows), tool, tool_name, base_name, gravity), lines


def _row(given: _Settings, number: int, angle: float, length: float) -> DHRow:
    name = given.take("name", _name, f"joint{number}")
    kind = given.take("type", _one_of(TABLE_JOINT_TYPES), "revolute")
    slides = kind == "prismatic"
    turn, distance = _number(angle, MAX_ANGLE, "rad"), _number(length, MAX_LENGTH, "m")
    theta, d = (
        given.take(key, read, 0.0 if free else None)
        for key, read, free in (("theta", turn, not slides), ("d", distance, slides))
    )
    a, alpha = given.take("a", distance), given.take("alpha", turn)
    beta = given.take("beta", turn, 0.0)
    sign = given.take("sign", _sign, 1.0)
    unit = length if slides else angle
    position, rate, positive = _number(unit), _number(unit, low=0.0), _number(1.0, low=0.0)
    lower, upper = given.optional("lower", position), given.optional("upper", position)
    if (lower is None) != (upper is None):
        raise given.error("one of 'lower' and 'upper' is given", "give both, or none", "half-a-limit")
    velocity, effort = given.optional("velocity", rate), given.optional("effort", positive)
    if lower is not None and upper is not None and lower > upper:
        raise given.error(f"lower = {lower:g} is above upper = {upper:g}", "exchange them", "exchanged-limits")
    limits = JointLimits(lower, upper, velocity, effort)
    damping, friction, armature = (given.take(key, positive, 0.0) for key in ("damping", "friction", "armature"))
    link = _link(given.settings("link"), number, length)
    given.refuse_others()
    if not slides and lower is None:
        kind = "continuous"
    return DHRow(name, kind, theta, d, a, alpha, beta, link, sign, limits, damping, friction, armature)


def _link(given: _Settings, number: int, length: float) -> DHLink:
    name = given.take("name", _name, f"link{number}")
    mass = given.optional("mass", _number(1.0, low=0.0))
    if mass is None:
        given.refuse_others()
        return DHLink(name, None)
    center = given.take("center", _vector(length, MAX_LENGTH))
    about = given.take("about", _one_of(TENSOR_POINTS), "center")
    entries = given.settings("inertia", required=True)
    xx, yy, zz = (entries.take(key, _number(1.0, low=0.0)) for key in ("xx", "yy", "zz"))
    xy, xz, yz = (entries.take(key, _number(1.0), 0.0) for key in ("xy", "xz", "yz"))
    entries.refuse_others()
    given.refuse_others()
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if about == "frame":
        tensor = tensor - parallel_axis(mass, center)
    try:
        return DHLink(name, Body(name, mass, center, tensor))
    except GraphDynError as error:
        raise given.error(str(error), "correct mass, center and inertia", "invalid-inertia") from None


def _placement(given: _Settings, name: str, angle: float, length: float) -> tuple[str, Placement]:
    called = given.take("name", _name, name)
    xyz, rpy = (
        given.take("xyz", _vector(length, MAX_LENGTH), np.zeros(3)),
        given.take("rpy", _vector(angle, MAX_ANGLE), np.zeros(3)),
    )
    given.refuse_others()
    return called, Placement(rotation_from_rpy(*rpy), xyz)


def _refuse_twice(path: Path, lines: Sequence[int], names: Sequence[str], what: str) -> None:
    for k, name in enumerate(names):
        if name in names[:k]:
            problem = f"{what} '{shortened(name)}' is there twice"
            raise InvalidDH(problem, "give each another name", code="duplicate-name", path=path, line=lines[k])


def _name(value: object) -> str:
    if isinstance(value, str) and value.strip() and value.isprintable():
        return value
    raise ValueError("give a name in quotes")


def _one_of(words: Sequence[T]) -> Callable[[object], T]:
    def read(value: object) -> T:
        for word in words:
            if value == word:
                return word
        raise ValueError(f"use one of {listed(map(str, words))}")

    return read


def _sign(value: object) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) == 1:
        return float(value)
    raise ValueError("give 1 or -1")


def _number(
    unit: float, largest: float = MAX_NUMBER, named: str = "", low: float = -math.inf
) -> Callable[[object], float]:
    """A reader of numbers in this unit. largest, low: in SI units; named: that of a unit whose mistake is likely"""
    other = {"rad": "are the angles in degrees?", "m": "are the lengths in mm?"}.get(named, "")

    def read(value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ValueError("give a finite number")
        found = value * unit
        if found < low:
            raise ValueError(f"it is below {low:g}")
        if abs(found) > largest * (1 + 1e-12):
            raise ValueError(f"it is {abs(found):.4g} {named}, more than {largest:.4g}; {other}".strip("; "))
        return float(found)

    return read


def _vector(unit: float, largest: float) -> Callable[[object], Array]:
    one = _number(unit, largest, "m" if largest == MAX_LENGTH else "rad" if largest == MAX_ANGLE else "")

    def read(value: object) -> Array:
        if not isinstance(value, list) or len(value) != 3:
            raise ValueError("give three numbers, [x, y, z]")
        return np.array([one(x) for x in value])

    return read


def _tables(value: object) -> list[Mapping[str, Any]]:
    if isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
        return value
    raise ValueError("write [[joint]] before each joint, at least once")
