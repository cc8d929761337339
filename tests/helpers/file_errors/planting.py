"""Errors planted in the inertials of published files, and every single one undone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass
from itertools import combinations, cycle
from pathlib import Path

import numpy as np
from file_errors.robots import ENTRIES, Numbers, moving, numbers, twins_of
from lxml import etree

from urdf.document.numbers import rotation_from_rpy, rpy_from_rotation, values

MOMENTS, PRODUCTS = ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz")

LEAST_CHANGE = 0.1
"""Part of mass or tensor that an error changes at least."""

MAX_DRAWS = 20
"""Draws after which the next kind has its turn."""


@dataclass(frozen=True)
class FileError:
    """path: of the published file; text: with the error, in this link"""

    path: Path
    link: str
    kind: str
    text: bytes

    @property
    def inertial(self) -> etree._Element:
        return inertial_of(etree.fromstring(self.text), self.link)


def inertial_of(root: etree._Element, link: str) -> etree._Element:
    return next(each for each in root.iter("link") if each.get("name") == link).find("inertial")


def planted(files: Sequence[Path], count: int, seed: int, kinds: Sequence[str]) -> list[FileError]:
    """So many errors, kinds in turn, robots and links by chance; none twice, and none that changes too little."""
    rng = np.random.default_rng(seed)
    found: dict[bytes, FileError] = {}
    for kind in cycle(kinds):
        for _ in range(MAX_DRAWS):
            error = _drawn(kind, files[rng.integers(len(files))], rng)
            if error is not None and error.text not in found:
                found[error.text] = error
                break
        if len(found) == count:
            return list(found.values())
    raise AssertionError


def _drawn(kind: str, path: Path, rng: np.random.Generator) -> FileError | None:
    link = str(rng.choice(list(moving(path))))
    root = etree.parse(path).getroot()
    inertial = inertial_of(root, link)
    before = numbers(inertial)
    if kind == "mass of the robot":
        inertial.find("mass").set("value", f"{sum(each[0] for each in moving(path).values()):.9g}")
    elif kind == "inertial of another":
        other = inertial_of(root, str(rng.choice(list(moving(path)))))
        inertial[:] = deepcopy(other)[:]
    else:
        (KINDS | SECOND)[kind](inertial, rng, twins_of(path, link))
    after = numbers(inertial)
    apart = max(np.abs(np.subtract(a, b)).max() / (np.abs(a).max() or 1) for a, b in zip(before, after, strict=True))
    return FileError(path, link, kind, etree.tostring(root)) if apart >= LEAST_CHANGE else None


def undone(inertial: etree._Element) -> Iterator[etree._Element]:
    """The element with each single error undone."""
    factors = (1e-3, 1e-2, 0.1, 1 / 7.85, 10, 100, 1e3)
    changes: list[Callable[[etree._Element], None]] = [
        *(_scaled(factor, with_tensor) for factor in factors for with_tensor in (False, True)),
        *(_exchanged(*pair) for pair in combinations(ENTRIES, 2)),
        *(_opposite(names) for k in (1, 2, 3) for names in combinations(PRODUCTS, k)),
        *(_opposite([name]) for name in MOMENTS),
        _transpose,
    ]
    for change in changes:
        copy = deepcopy(inertial)
        change(copy)
        yield copy


def _scaled(factor: float, with_tensor: bool) -> Callable[..., None]:
    def scale(inertial: etree._Element, *_: object) -> None:
        for part, names in ((inertial.find("mass"), ["value"]), (inertial.find("inertia"), ENTRIES * with_tensor)):
            for name in names:
                part.set(name, f"{float(part.get(name)) * factor:.10g}")

    return scale


def _exchanged(one: str, other: str) -> Callable[..., None]:
    def exchange(inertial: etree._Element, *_: object) -> None:
        inertia = inertial.find("inertia")
        inertia.attrib.update({one: inertia.get(other), other: inertia.get(one)})

    return exchange


def _opposite(names: Sequence[str]) -> Callable[..., None]:
    def reverse(inertial: etree._Element, *_: object) -> None:
        inertia = inertial.find("inertia")
        for name in names:
            text = inertia.get(name).strip()
            inertia.set(name, text[1:] if text.startswith("-") else f"-{text}")

    return reverse


def _transpose(inertial: etree._Element, *_: object) -> None:
    origin = inertial.find("origin")
    angles = values(origin, "rpy", 3)
    if angles and any(angles):
        new = rpy_from_rotation(rotation_from_rpy(*angles).T)
        origin.set("rpy", " ".join(repr(float(angle)) for angle in new))


def _unreflected(inertial: etree._Element, _rng: np.random.Generator, twins: Sequence[Numbers]) -> None:
    """The tensor of the twin, not reflected."""
    if twins and values(inertial.find("origin"), "rpy", 3) in (None, [0.0, 0.0, 0.0]):
        _write(inertial, twins[0][2])


def _quarter(inertial: etree._Element, rng: np.random.Generator, _twins: Sequence[Numbers]) -> None:
    """The tensor in axes that are turned by 90°."""
    turn = rotation_from_rpy(*(np.pi / 2 * np.eye(3)[rng.integers(3)]))
    _write(inertial, turn @ _tensor(inertial) @ turn.T)


def _tensor(inertial: etree._Element) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = (float(inertial.find("inertia").get(name)) for name in ENTRIES)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _about(sign: float) -> Plant:
    """The term of parallel axes added, for a tensor about the origin of the link, or taken away twice."""

    def shift(inertial: etree._Element, *_: object) -> None:
        if values(inertial.find("origin"), "rpy", 3) in (None, [0.0, 0.0, 0.0]):
            mass, center, _ = numbers(inertial)
            _write(inertial, _tensor(inertial) + sign * mass * (center @ center * np.eye(3) - np.outer(center, center)))

    return shift


def _origin(name: str, factor: float) -> Plant:
    def scale(inertial: etree._Element, *_: object) -> None:
        for origin in inertial.findall("origin"):
            found = values(origin, name, 3) or [0.0, 0.0, 0.0]
            origin.set(name, " ".join(f"{factor * value:.9g}" for value in found))

    return scale


def _tensor_times(factor: float) -> Plant:
    return lambda inertial, *_: _write(inertial, factor * _tensor(inertial))


def _write(inertial: etree._Element, tensor: np.ndarray) -> None:
    for name in ENTRIES:
        row, column = ("xyz".index(axis) for axis in name[1:])
        inertial.find("inertia").set(name, f"{tensor[row, column]:.9g}")


Plant = Callable[[etree._Element, np.random.Generator, Sequence[Numbers]], None]
"""Changes the <inertial>; leaves it as it is where the error cannot be made."""

KINDS: dict[str, Plant] = {
    "mass × 10": _scaled(10, False),
    "mass × 1000": _scaled(1000, False),
    "mass × 7.85": _scaled(7.85, False),
    "mass and tensor × 7.85": _scaled(7.85, True),
    "mass and tensor × 1000": _scaled(1000, True),
    "exchanged entries": lambda inertial, rng, _: _exchanged(*rng.choice(ENTRIES, 2, replace=False))(inertial),
    "sign of a moment": lambda inertial, rng, _: _opposite([rng.choice(MOMENTS)])(inertial),
    "sign of a product": lambda inertial, rng, _: _opposite([rng.choice(PRODUCTS)])(inertial),
    "opposite products": _opposite(PRODUCTS),
    "transposed rotation": _transpose,
    "quarter turn": _quarter,
    "twin not reflected": _unreflected,
}

SECOND: dict[str, Plant] = {
    "center in mm": _origin("xyz", 1000),
    "center in inches": _origin("xyz", 39.3700787),
    "angles in degrees": _origin("rpy", 180 / np.pi),
    "mass in pounds": _scaled(2.20462262, False),
    "weight for mass": _scaled(9.81, False),
    "tensor in g mm²": _tensor_times(1e9),
    "tensor in kg mm²": _tensor_times(1e6),
    "tensor about the origin": _about(1.0),
    "axes shifted twice": _about(-1.0),
    "aluminum for steel": _scaled(2.7 / 7.85, True),
    "mass of the robot": lambda *_: None,
    "inertial of another": lambda *_: None,
}
"""A second set, counted apart: what CAD, other units and copies leave. The last two need the other links."""
