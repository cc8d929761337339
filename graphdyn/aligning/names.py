"""Which joints of two robots have the same name, written in two ways."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence

Words = tuple[str, ...]

JOINT_WORDS = {"joint", "jnt"}
"""Words that say nothing of which joint it is."""


def same_names(first: Sequence[str], second: Sequence[str]) -> dict[str, str]:
    """Joints of A, each with that of B that has its name.

    first, second: names of the joints of A and B

    A name is the same if it is letter for letter; or but for capitals, separators and the word joint ("shoulder_pan",
    "Shoulder-Pan_joint"); or but for words that all joints of its robot share ("panda_joint1", "joint1"). Taken is the
    strictest of these by which most joints are found. Names that two joints of one robot have then count for none.

    >>> from graphdyn.aligning import same_names
    >>> same_names(["pan_joint", "lift_joint"], ["arm/lift", "arm/pan"])
    {'pan_joint': 'arm/pan', 'lift_joint': 'arm/lift'}
    """
    ways: tuple[Callable[[Sequence[str]], list[Words]], ...] = (_letters, _words, _own_words)
    found = [_matched(first, second, way(first), way(second)) for way in ways]
    return max(found, key=len)  # the first of the longest


def _matched(first: Sequence[str], second: Sequence[str], one: list[Words], other: list[Words]) -> dict[str, str]:
    counts = Counter(one), Counter(other)
    named = dict(zip(other, second, strict=True))
    return {
        name: named[words]
        for name, words in zip(first, one, strict=True)
        if words and counts[0][words] == counts[1][words] == 1
    }


def _letters(names: Sequence[str]) -> list[Words]:
    return [(name,) for name in names]


def _words(names: Sequence[str]) -> list[Words]:
    """Words and numbers of each name, in small letters."""
    split = (re.findall(r"[^\W\d_]+|\d+", name.lower()) for name in names)
    return [
        tuple(str(int(word)) if word.isdigit() else word for word in each if word not in JOINT_WORDS) for each in split
    ]


def _own_words(names: Sequence[str]) -> list[Words]:
    """Without the words that all share."""
    every = _words(names)
    shared = set(every[0]).intersection(*every[1:]) if len(every) > 1 else set()
    return [tuple(word for word in each if word not in shared) for each in every]
