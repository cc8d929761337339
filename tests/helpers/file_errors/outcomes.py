"""What urdf.inspect and urdf.repair say of a planted error, and what could be said."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
from file_errors.planting import FileError, undone
from file_errors.robots import Numbers, all_numbers, is_like, is_possible, is_same, moving, numbers, shapes, twins_of
from lxml import etree
from scipy.linalg import eigh

import urdf
from urdf.inspection import NOTHING

MAX_MOMENT_FACTOR, MAX_DENSITY_FACTOR = 2.0, 5.0
"""Up to which moments beside those of the mesh, and densities beside those of the other links, show nothing wrong."""

LOOSELY = 1.5
"""By this factor larger, they are those from which another error undone is clearly no explanation."""


@dataclass(frozen=True)
class FileErrorOutcome:
    """shows: the mass is wrong, or the tensor impossible, unlike that of the mesh, or of all twins

    named: inspect has a finding about the link, or repair a change or a candidate, that the published file does not
        have
    unique: one error undone, and clearly no other, makes the link possible and like its mesh and its twins
    right: corrected to the numbers that were there; false: a number that was right, or is still wrong, is changed
    """

    error: FileError
    shows: bool
    named: bool
    unique: bool
    right: bool
    false: bool
    said: str

    @property
    def line(self) -> str:
        marks = (self.shows, self.named, self.unique, self.right, self.false)
        letters = "".join(letter if yes else "." for letter, yes in zip("SNURF", marks, strict=True))
        return f"{letters} {self.error.kind:24} {self.error.path.stem:28} {self.error.link:24} {self.said}"


def outcome_of(error: FileError, folder: Path) -> FileErrorOutcome:
    path, out = beside(error.path, folder), folder / "repaired.urdf"
    path.write_bytes(error.text)
    given, published = all_numbers(path), all_numbers(error.path)
    done = urdf.repair(path, out, ["inertials"])
    new = all_numbers(out) if done.changes else given
    changed = {link for link in new if not all(map(np.array_equal, new[link], given[link]))}
    right = error.link in changed and is_same(new[error.link], published[error.link])
    false = any(not is_same(new[link], published[link]) for link in changed - corrected_as_published(error.path))
    said = named(path, done) - named_as_published(error.path)
    told = sorted(code for code, link in said if link == error.link)
    told += [change for change in done.changes if f"'{error.link}'" in change]
    return FileErrorOutcome(error, shows(error), bool(told), is_unique(error), right, false, "; ".join(told))


def named(path: Path, done: urdf.RepairedFile) -> set[tuple[str, str]]:
    """Codes of findings that ask for something, and links that they are about; those of repair by what it tells."""
    return set(_named(path, done))


def _named(path: Path, done: urdf.RepairedFile) -> Iterator[tuple[str, str]]:
    links = [str(link.get("name")) for link in etree.parse(path).getroot().iter("link")]
    for finding in urdf.inspect(path).findings:
        about = finding.element or finding.message
        if not finding.remedy.startswith(NOTHING):
            yield from ((finding.code, link) for link in links if f"'{link}'" in about)
    for text in (*done.changes, *done.candidates):
        yield from (("repair", link) for link in links if f"link '{link}':" in text)


@cache
def named_as_published(path: Path) -> set[tuple[str, str]]:
    return named(path, urdf.repair(path, None, ["inertials"]))


@cache
def corrected_as_published(path: Path) -> set[str]:
    """The links that are corrected in the published file itself."""
    changes = urdf.repair(path, None, ["inertials"]).changes
    return {link for link in all_numbers(path) if any(f"link '{link}':" in change for change in changes)}


def beside(path: Path, folder: Path) -> Path:
    """Where a copy finds the meshes that the file names: folders of links to what is beside the published one.

    A new folder each time: a link of an earlier robot leads to the published files, where nothing may be written.
    """
    folder = Path(mkdtemp(dir=folder))
    root = path.parents[4] if "example-robot-data" in path.parts else path.parent
    inside = path.relative_to(root).parts[:-1]
    here = folder.joinpath("copy", *inside)
    here.mkdir(parents=True, exist_ok=True)
    for k in range(1, len(inside) + 1):
        for entry in root.joinpath(*inside[:k]).iterdir():
            place = folder.joinpath("copy", *inside[:k], entry.name)
            if not place.exists():
                place.symlink_to(entry)
    return here / "planted.urdf"


def shows(error: FileError) -> bool:
    given, twins = numbers(error.inertial), twins_of(error.path, error.link)
    return error.kind.startswith("mass") or not plausible(error, given) or bool(twins and not is_like(given, twins))


def is_unique(error: FileError) -> bool:
    """Nothing of the published inertial is used. Of two twins that differ, either may be wrong."""
    given, twins = numbers(error.inertial), twins_of(error.path, error.link)
    if plausible(error, given) and (len(twins) < 2 or is_like(given, twins)):
        return False
    found: list[Numbers] = []
    for new in map(numbers, undone(error.inertial)):
        fits = plausible(error, new, LOOSELY) and (not twins or is_like(new, twins))
        if fits and not any(is_same(new, one) for one in found):
            found.append(new)
    truth = moving(error.path)[error.link]
    return len(found) == 1 and is_same(found[0], truth) and plausible(error, truth)


def plausible(error: FileError, own: Numbers, loosely: float = 1.0) -> bool:
    """Possible, and like its shape."""
    shape = shapes(error.path).get(error.link)
    if shape is None or not is_possible(own[2]):
        return is_possible(own[2])
    factors = np.abs(np.log(eigh(own[2] / own[0], shape.tensor / shape.volume, eigvals_only=True)))
    masses = {link: each[0] for link, each in moving(error.path).items() if link != error.link}
    others = [mass / shapes(error.path)[link].volume for link, mass in masses.items() if link in shapes(error.path)]
    density = np.log(own[0] / shape.volume / (np.median(others) if others else 1000.0))
    return bool(
        factors.max() <= np.log(loosely * MAX_MOMENT_FACTOR) and abs(density) <= np.log(loosely * MAX_DENSITY_FACTOR)
    )
