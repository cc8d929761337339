"""Published robot files with inertials, and the numbers of their links, read without the code under test."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
from lxml import etree
from shared_data import ARMS

import urdf
from urdf.document.numbers import rotation_from_rpy, values
from urdf.document.opening import open_document
from urdf.document.source import reduced
from urdf.document.tree import carriers
from urdf.geometry.mass_properties import Filled, filled_links

ENTRIES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

Numbers = tuple[float, np.ndarray, np.ndarray]
"""Mass, center of mass, tensor in link axes."""


def robot_files() -> list[Path]:
    """The arms of the shared folder and the robots of example-robot-data that have inertials, by name."""
    known = [*ARMS.glob("*.urdf"), *(robot.path for robot in urdf.robots())]
    return sorted((path for path in known if moving(path)), key=lambda path: (path.stem, path.parts))


def numbers(inertial: etree._Element) -> Numbers:
    origin, inertia = inertial.find("origin"), inertial.find("inertia")
    xx, xy, xz, yy, yz, zz = (float(inertia.get(name)) for name in ENTRIES)
    turn = rotation_from_rpy(*(values(origin, "rpy", 3) or (0, 0, 0)))
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    center = np.array(values(origin, "xyz", 3) or (0.0, 0.0, 0.0))
    return float(inertial.find("mass").get("value")), center, turn @ tensor @ turn.T


def all_numbers(path: Path) -> dict[str, Numbers]:
    """Of every link that has valid ones."""
    found = {}
    for link in etree.parse(path).getroot().iter("link"):
        try:
            found[link.get("name")] = numbers(link.find("inertial"))
        except (AttributeError, TypeError, ValueError):
            continue
    return found


@cache
def moving(path: Path) -> dict[str, Numbers]:
    """Of the moving links with mass whose tensors are possible."""
    try:
        tree = carriers(reduced(open_document(path)))
    except urdf.URDFError:
        return {}
    known = {link: each for link, each in all_numbers(path).items() if tree.get(link) is not None}
    return {link: each for link, each in known.items() if each[0] > 0 and each[2].any() and is_possible(each[2])}


@cache
def shapes(path: Path) -> dict[str, Filled]:
    links, _ = filled_links(reduced(open_document(path)), list(moving(path)))
    return {link: found.filled for link, found in links.items()}


@cache
def twins_of(path: Path, link: str) -> list[Numbers]:
    """The links whose inertials are, up to a reflection, that of this one, in the published file."""
    own = moving(path)[link]
    return [each for other, each in moving(path).items() if other != link and is_like(own, [each])]


def is_possible(tensor: np.ndarray) -> bool:
    low, middle, high = np.linalg.eigvalsh(tensor)
    return bool(low > 1e-3 * high and high - low - middle < 0.02 * high)


def is_same(one: Numbers, other: Numbers) -> bool:
    """Up to the digits that such files have."""
    return all(
        np.abs(np.subtract(a, b)).max() <= 0.01 * max(np.abs(a).max(), np.abs(b).max()) + 1e-12
        for a, b in zip(one, other, strict=True)
    )


def is_like(own: Numbers, twins: list[Numbers]) -> bool:
    return any(is_same(own, seen) for twin in twins for seen in _reflected(twin))


def _reflected(own: Numbers) -> Iterator[Numbers]:
    for signs in np.ndindex(2, 2, 2):
        turn = np.diag(1.0 - 2 * np.array(signs))
        yield own[0], turn @ own[1], turn @ own[2] @ turn
