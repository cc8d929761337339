"""The choices that all files of an export share: names, and kinds of numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

Precision = Literal["double", "single"]
"""The kind of all numbers: of the arguments, the results and what is between."""

Sines = Literal["own", "libm"]
"""Sine and cosine: in vector instructions, for angles up to 1e6 rad; or those of the C library."""


@dataclass(frozen=True)
class Dialect:
    """name: with which all names begin."""

    name: str
    precision: Precision
    sines: Sines

    @property
    def upper(self) -> str:
        """What the names of constants begin with."""
        return self.name.upper()

    @property
    def real(self) -> str:
        """The type of the numbers."""
        return "double" if self.precision == "double" else "float"

    @property
    def lanes(self) -> int:
        """Rows that a batch computes at once: as many numbers as the widest vectors hold."""
        return 8 if self.precision == "double" else 16

    def literal(self, value: float) -> str:
        """A number in the shortest way that makes it the same number again."""
        if np.isnan(value):
            return "NAN"
        with np.errstate(over="ignore"):
            number = np.float64(value) if self.precision == "double" else np.float32(value)
        if np.isinf(number):
            return "-INFINITY" if number < 0 else "INFINITY"
        return f"{number!s}" if self.precision == "double" else f"{number!s}f"

    def filled(self, template: str, **places: object) -> str:
        """A text in C with NAME, NAME in capital letters, the type of numbers, and others in place of @words@."""
        for place, value in {"name": self.name, "NAME": self.upper, "real": self.real, **places}.items():
            template = template.replace(f"@{place}@", str(value))
        return template
