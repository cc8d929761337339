"""Robot files with faults in them: what editors, converters, careless people and broken disks leave behind.

A mutant is known by a seed and a number: the same two give the same bytes.
"""

from __future__ import annotations

import copy
import random
from dataclasses import dataclass
from functools import cache

from inspected.sample import CLEAN
from lxml import etree
from mutants.material import RICH
from mutants.of_bytes import ON_BYTES
from mutants.of_trees import ON_TREES

import urdf

ROBOTS = ("kr500", "clean", "rich", "rich", "rich", "ur5")


@dataclass(frozen=True)
class Mutant:
    """A robot's file with one to three faults; kinds: what was done to it, in order."""

    robot: str
    kinds: tuple[str, ...]
    content: bytes


@cache
def original(robot: str) -> bytes:
    """The sound file that mutants are made of."""
    if robot in ("clean", "rich"):
        return {"clean": CLEAN, "rich": RICH}[robot].encode()
    return next(entry.path for entry in urdf.robots() if entry.name == robot).read_bytes()


def mutant(seed: int, number: int) -> Mutant:
    """Three in four mutants have faults in their elements and attributes, the others (too) in their bytes."""
    rng = random.Random(f"{seed}/{number}")
    robot = rng.choice(ROBOTS)
    kinds, content = [], original(robot)
    in_tree, in_bytes = rng.choice(((1, 0), (1, 0), (1, 0), (2, 0), (3, 0), (0, 1), (0, 2), (1, 1)))
    if in_tree:
        tree = copy.deepcopy(_tree(robot))
        for _ in range(in_tree):
            kinds.append(rng.choice(list(ON_TREES)))
            ON_TREES[kinds[-1]](rng, tree)
        content = etree.tostring(tree.getroottree(), encoding="UTF-8")
    for _ in range(in_bytes):
        kinds.append(rng.choice(list(ON_BYTES)))
        content = ON_BYTES[kinds[-1]](rng, content)
    return Mutant(robot, tuple(kinds), content)


@cache
def _tree(robot: str) -> etree._Element:
    return etree.fromstring(original(robot))
