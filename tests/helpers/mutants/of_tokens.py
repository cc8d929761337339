"""Faults of the numbers, names, marks and lines of any text. Each function returns the new bytes."""

from __future__ import annotations

import random
import re

from mutants.material import NAMES, NUMBERS
from mutants.of_bytes import names

NUMBER = re.compile(rb"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_]\w*")
MARK = re.compile(rb"[][{}(),;:=\"'#<>/|&*!%@-]")

DEEP = 20_000
"""Lists within each other."""


def _some(rng: random.Random, content: bytes, pattern: re.Pattern[bytes]) -> re.Match[bytes] | None:
    found = list(pattern.finditer(content))
    return rng.choice(found) if found else None


def _with(content: bytes, place: re.Match[bytes] | None, new: bytes) -> bytes:
    return content if place is None else content[: place.start()] + new + content[place.end() :]


def odd_number(rng: random.Random, content: bytes) -> bytes:
    return _with(content, _some(rng, content, NUMBER), rng.choice(NUMBERS).encode())


def other_number(rng: random.Random, content: bytes) -> bytes:
    place = _some(rng, content, NUMBER)
    factor = rng.choice([-1.0, 1e3, 1e-3, 1e12, 1e-12, 10 ** rng.uniform(-20, 20), rng.uniform(-2, 2)])
    return content if place is None else _with(content, place, repr(float(place[0]) * factor).encode())


def garbled_number(rng: random.Random, content: bytes) -> bytes:
    place = _some(rng, content, NUMBER)
    if place is None:
        return content
    k, text = rng.randint(0, len(place[0])), place[0]
    return _with(content, place, text[:k] + rng.choice("0123456789.,eE+- _x").encode() + text[k + rng.randint(0, 2) :])


def decimal_comma(rng: random.Random, content: bytes) -> bytes:
    """In one number, or in all."""
    if rng.random() < 0.5:
        return NUMBER.sub(lambda found: found[0].replace(b".", b","), content)
    place = _some(rng, content, NUMBER)
    return content if place is None else _with(content, place, place[0].replace(b".", b","))


def odd_word(rng: random.Random, content: bytes) -> bytes:
    return _with(content, _some(rng, content, WORD), rng.choice(NAMES).encode())


def other_word(rng: random.Random, content: bytes) -> bytes:
    """One that stands elsewhere."""
    other = _some(rng, content, WORD)
    return content if other is None else _with(content, _some(rng, content, WORD), other[0])


def garbled_word(rng: random.Random, content: bytes) -> bytes:
    place = _some(rng, content, WORD)
    if place is None:
        return content
    text, k = place[0], rng.randrange(len(place[0]))
    changed = [text[:k] + text[k + 1 :], text[:k] + text[k : k + 1] + text[k:], text.swapcase(), text + b"s"]
    return _with(content, place, rng.choice(changed))


def delete_token(rng: random.Random, content: bytes) -> bytes:
    return _with(content, _some(rng, content, rng.choice([NUMBER, WORD])), b"")


def repeat_token(rng: random.Random, content: bytes) -> bytes:
    place = _some(rng, content, rng.choice([NUMBER, WORD]))
    between = rng.choice([b" ", b",", b", ", b";", b"\t", b"\n"])
    return content if place is None else _with(content, place, place[0] + between + place[0])


def exchange_tokens(rng: random.Random, content: bytes) -> bytes:
    kind = rng.choice([NUMBER, WORD])
    one, other = sorted([_some(rng, content, kind), _some(rng, content, kind)], key=lambda x: x.start() if x else 0)
    if one is None or other is None or one.end() > other.start():
        return content
    between = content[one.end() : other.start()]
    return content[: one.start()] + other[0] + between + one[0] + content[other.end() :]


def other_mark(rng: random.Random, content: bytes) -> bytes:
    new = rng.choice([b"", b",", b";", b":", b'"', b"'", b"#", b"[", b"]", b"{", b"}", b"(", b"&a ", b"*a", b"!!int "])
    return _with(content, _some(rng, content, MARK), new)


def repeat_mark(rng: random.Random, content: bytes) -> bytes:
    place = _some(rng, content, MARK)
    return content if place is None else _with(content, place, place[0] * rng.choice([2, 3]))


def other_indent(rng: random.Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    k = rng.randrange(len(lines))
    lines[k] = rng.choice([b" " + lines[k], b"\t" + lines[k], b"    " + lines[k], lines[k].lstrip(), lines[k] + b"  "])
    return b"\n".join(lines)


def move_line(rng: random.Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    lines.insert(rng.randint(0, len(lines) - 1), lines.pop(rng.randrange(len(lines))))
    return b"\n".join(lines)


def comment_line(rng: random.Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    k = rng.randrange(len(lines))
    lines[k] = rng.choice([b"# ", b"; ", b"% ", b"// ", b"-- "]) + lines[k]
    return b"\n".join(lines)


def nest(rng: random.Random, content: bytes) -> bytes:
    """A number or a word within many lists."""
    deep, place = rng.choice([1, 2, 60, DEEP]), _some(rng, content, rng.choice([NUMBER, WORD]))
    left, right = rng.choice([(b"[", b"]"), (b"{a: ", b"}"), (b'{"a":', b"}"), (b"(", b")"), (b"{a = ", b"}")])
    return content if place is None else _with(content, place, left * deep + place[0] + right * deep)


def grow(rng: random.Random, content: bytes) -> bytes:
    """A line or a token very often."""
    many = rng.choice([100, 10_000])
    if rng.random() < 0.5:
        place = _some(rng, content, rng.choice([NUMBER, WORD]))
        return content if place is None else _with(content, place, place[0] * many)
    lines = content.split(b"\n")
    k = rng.randrange(len(lines))
    return b"\n".join([*lines[:k], *[lines[k]] * many, *lines[k:]])


def two_columns_less(rng: random.Random, content: bytes) -> bytes:
    """Every line without its last part, or without its first."""
    mark: bytes = rng.choice([b",", b" ", b";"])
    if rng.random() < 0.5:
        return b"\n".join(line.rpartition(mark)[0] if mark in line else line for line in content.split(b"\n"))
    return b"\n".join(line.partition(mark)[2] or line for line in content.split(b"\n"))


def other_delimiter(rng: random.Random, content: bytes) -> bytes:
    return content.replace(*rng.choice([(b",", b";"), (b",", b"\t"), (b",", b" "), (b" ", b""), (b" ", b"\t")]))


ON_TOKENS = names(
    odd_number, other_number, garbled_number, decimal_comma, odd_word, other_word, garbled_word, delete_token,
    repeat_token, exchange_tokens, other_mark, repeat_mark, other_indent, move_line, comment_line, nest, grow,
    two_columns_less, other_delimiter,
)  # fmt: skip
