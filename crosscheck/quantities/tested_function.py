"""What a user gives to be judged: a function of one state, or code that is given many states at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from numpy.typing import ArrayLike

from graphdyn.layout import Array


class LongDecimal(float):
    """A decimal with more digits than a double holds: the nearest double, which knows the text."""

    text: str

    def __new__(cls, text: str) -> LongDecimal:
        number = super().__new__(cls, text)
        number.text = text
        return number

    def __reduce__(self) -> tuple[type[LongDecimal], tuple[str]]:
        return LongDecimal, (self.text,)

    @property
    def digits(self) -> int:
        """Number of its significant digits."""
        return significant_digits(self.text)


def significant_digits(text: str) -> int:
    """Number of digits of a decimal from the first one that is not zero."""
    mantissa = text.lower().partition("e")[0]
    return len(mantissa.lstrip("+-").replace(".", "").lstrip("0"))


@dataclass(frozen=True)
class Refusal:
    """A stand-in for an answer, where user code says that it has none at a state."""

    reason: str


@runtime_checkable
class BatchFunction(Protocol):
    """User code that is given many states at once: a program, a file of answers."""

    def answers(
        self, function: str, states: Sequence[Mapping[str, Array]], shape: tuple[int | None, ...]
    ) -> Sequence[Array | Refusal]:
        """The answer (shape) at each state; arrays of objects where some are a LongDecimal. function: its name; states:
        arguments by name"""


TestedFunction = Callable[..., ArrayLike] | BatchFunction
"""A function of one state: arrays of shape (n,) in the order of joint_names; or user code that is given batches."""
