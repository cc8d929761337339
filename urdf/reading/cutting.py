"""The part of a robot that is read: an arm between two links, joints that are held still."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree

from urdf.document.elements import name_of
from urdf.document.source import Source
from urdf.document.tree import end, joint_into, joints_by, path_up, walk
from urdf.errors import InvalidChain, InvalidLock, URDFError, listed, shortened

Chain = tuple[str, str] | None


@dataclass(frozen=True)
class Cut:
    """The joints that are not on the path from the base link to the tip link.

    held: movable joints on links that move; they are to be locked, because the arm carries their links
    left_out: movable joints on the base link and on links fixed to it; removed with all that they carry
    before: joints from the root to the base link; removed
    """

    held: tuple[str, ...]
    left_out: tuple[str, ...]
    before: tuple[etree._Element, ...]


NO_CUT = Cut((), (), ())


def cut(source: Source, chain: Chain) -> Cut:
    """Remove all links and joints that the arm does not need; source: a valid tree, which is modified.

    chain: base link, which becomes the root, and tip link. Links fixed to the path stay. Links behind other movable
    joints stay where the path moves them: their mass is part of what the arm carries.

    Raises InvalidChain for anything but two names, unknown links, links that no path joins, the wrong direction, and
    a path without a movable joint.
    """
    if chain is None:
        return NO_CUT
    base, tip = _two_names(source, chain)
    into = joint_into(source)
    path = _path(source, into, base, tip)
    on_path = {end(joint, "child") for joint in path}
    carriers = joints_by(source, "parent")
    still, gone = {base}, set()
    kept, held, left_out = [], [], []
    for joint in walk(carriers, [base]):
        parent, child = end(joint, "parent") or "", end(joint, "child") or ""
        movable = joint.get("type") != "fixed"
        if parent in gone:
            gone.add(child)
        elif movable and child not in on_path and parent in still:
            left_out.append(name_of(joint))
            gone.add(child)
        else:
            kept.append(joint)
            if not movable and parent in still:
                still.add(child)
            elif movable and child not in on_path:
                held.append(name_of(joint))
    links, joints = {base, *(end(joint, "child") for joint in kept)}, set(kept)
    for element in (*source.links, *source.joints):
        if element not in joints and (element.tag == "joint" or name_of(element) not in links):
            source.robot.remove(element)
    return Cut(tuple(held), tuple(left_out), tuple(path_up(into, base)))


def _two_names(source: Source, chain: Chain) -> tuple[str, str]:
    sound = isinstance(chain, Sequence) and not isinstance(chain, str) and len(chain) == 2
    if not sound or not all(isinstance(name, str) for name in chain or ()):
        raise _error(source, f"chain is {chain!r}", "give two link names: (base_link, tip_link)")
    base, tip = chain  # type: ignore[misc]
    links = [name_of(link) for link in source.links]
    for name in (base, tip):
        if name not in links:
            close = difflib.get_close_matches(name, links) or links
            raise _error(source, f"there is no link '{shortened(name)}'", f"give one of {listed(close)}")
    return base, tip


def _path(source: Source, into: dict[str, etree._Element], base: str, tip: str) -> list[etree._Element]:
    """The joints from the base link to the tip link."""
    path = []
    for joint in path_up(into, tip):
        if end(joint, "child") == base:
            break
        path.append(joint)
    if base != tip and (not path or end(path[-1], "parent") != base):
        if tip in (end(joint, "parent") for joint in path_up(into, base)):
            problem = f"link '{tip}' comes before link '{base}'"
            remedy = f"exchange them: chain=('{tip}', '{base}') (--chain {tip} {base})"
            raise _error(source, problem, remedy)
        above = [end(joint, "parent") for joint in path_up(into, base)]
        common = next(name for name in (end(joint, "parent") for joint in path) if name in above)
        problem = f"no path leads from link '{base}' to link '{tip}': they are on different branches"
        remedy = f"both branch off at link '{common}'; chain=('{common}', '{tip}') (--chain {common} {tip}) is a path"
        raise _error(source, problem, remedy)
    if all(joint.get("type") == "fixed" for joint in path):
        raise _error(
            source, f"no movable joint lies between link '{base}' and link '{tip}'", "take links further apart"
        )
    return path


def _error(source: Source, problem: str, remedy: str) -> URDFError:
    return InvalidChain(f"chain: {problem}", remedy, code="invalid-chain", path=source.path)


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
