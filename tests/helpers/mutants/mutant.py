"""Files with faults in them: what editors, converters, careless people and broken disks leave behind.

A mutant is known by a format, a seed and a number: the same three give the same bytes.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

from mutants.formats import FORMATS


@dataclass(frozen=True)
class Mutant:
    """A file of a format with one to three faults; kinds: what was done to it, in order."""

    format: str
    kinds: tuple[str, ...]
    content: bytes


def mutant(format: str, seed: int, number: int) -> Mutant:
    return Mutant(format, *FORMATS[format].damaged(random.Random(f"{seed}/{number}")))
