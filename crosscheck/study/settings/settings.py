"""Tables of a TOML file, read key by key: every error names the file and the key, and says what to give."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from graphdyn import InvalidInput
from graphdyn.arguments import closest

T = TypeVar("T")

Numbers = float | tuple[float, ...]
"""One number for all joints, or one for each."""


class BadConfiguration(InvalidInput):
    """A configuration of a study that cannot be used; the message names the file, the key and the remedy."""


@dataclass(eq=False)
class Settings:
    """One table of the file; keys that were never asked for are refused by `refuse_others`."""

    file: str
    name: str
    values: Mapping[str, Any]
    _known: list[str] = field(default_factory=list)

    def take(self, key: str, default: T, read: Callable[[Any], T]) -> T:
        """What `read` makes of the value; it raises ValueError with what is needed. The default without the key."""
        self._known.append(key)
        if key not in self.values:
            return default
        try:
            return read(self.values[key])
        except ValueError as needed:
            raise self.error(key, f"is {self.values[key]!r}; {needed}") from None

    def error(self, key: str, message: str) -> BadConfiguration:
        return BadConfiguration(f"{self.file}: {key} in [{self.name}] {message}")

    def refuse_others(self) -> None:
        """Raises BadConfiguration for a key that nothing asked for."""
        for key in self.values:
            if key not in self._known:
                near = closest(key, self._known)
                meant = f"did you mean {near}?" if near else f"it has: {', '.join(self._known)}"
                raise self.error(key, f"is no setting of this table; {meant}")


def number(value: object, *, least: float = -math.inf, above: float = -math.inf) -> float:
    """A finite number from `least` on, and above `above`. Raises ValueError."""
    real = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    if real and least <= value and value > above:  # type: ignore[operator]
        return float(value)  # type: ignore[arg-type]
    bound = f" above {above:g}" if above > -math.inf else f" from {least:g} on" if least > -math.inf else ""
    raise ValueError(f"give a number{bound}")


def positive(value: object) -> float:
    return number(value, above=0.0)


def not_negative(value: object) -> float:
    return number(value, least=0.0)


def whole(least: int) -> Callable[[object], int]:
    """A reader of whole numbers from `least` on."""

    def read(value: object) -> int:
        if isinstance(value, int) and not isinstance(value, bool) and value >= least:
            return value
        raise ValueError(f"give a whole number from {least} on")

    return read


def one_or_each(read: Callable[[object], float]) -> Callable[[object], Numbers]:
    """A reader of one number, or of a list with one for each joint."""

    def several(value: object) -> Numbers:
        return tuple(read(x) for x in value) if isinstance(value, list) and value else read(value)

    return several


def words(value: object) -> str:
    if isinstance(value, str) and value:
        return value
    raise ValueError("give a text")


def one_of(choices: Sequence[str]) -> Callable[[object], str]:
    """A reader of one of these words."""

    def read(value: object) -> str:
        if isinstance(value, str) and value in choices:
            return value
        raise ValueError(f"use one of {', '.join(choices)}")

    return read


def texts(what: str) -> Callable[[object], tuple[str, ...]]:
    """A reader of lists of texts; what they are, for its error."""

    def read(value: object) -> tuple[str, ...]:
        if isinstance(value, list) and all(isinstance(one, str) for one in value):
            return tuple(value)
        raise ValueError(f"give a list of {what}")

    return read
