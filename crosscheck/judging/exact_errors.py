"""A function under test beside exact values: what it is wrong by for certain, and when that counts as wrong."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.exact import Truth
from graphdyn.layout import Array

VECTOR_FACTOR, MATRIX_FACTOR = 2.0, 3.0
"""A function is wrong where its error exceeds this times what half an ulp of its inputs causes (docs/judge.md). Entries
of matrices have fewer inputs each, and there are more of them."""


@dataclass(frozen=True, eq=False)
class ExactErrors:
    """The errors of a function under test against exact values, at M states.

    truth: what counts as exact: the decimals of the "file", or the doubles of the "model" that was read from it
    everywhere: whether these are all states with an answer, or a few
    states: their numbers, from 0                           (M,)
    least, most: proven bounds of the largest error at each state, relative to the scale   (M,)
    caused: what half an ulp of all inputs causes there, each moved so that it does most, on the same scale   (M,)
    references: the largest error of each reference implementation there, at most   (M,)
    scale: what errors are relative to, in words
    rounded: part of all numbers at these states that are the doubles nearest to the exact ones
    ulps: distance of the number with the largest error at the worst state, in ulps of the exact one
    factor: times what is caused from which on an error counts
    given_digits: of the numbers as text, where they have more than a double holds
    """

    truth: Truth
    everywhere: bool
    states: NDArray[np.intp]
    least: Array
    most: Array
    caused: Array
    references: Mapping[str, Array]
    scale: str
    rounded: float
    ulps: float
    factor: float
    given_digits: int | None = None

    @property
    def excess(self) -> Array:
        """The proven error over what counts as wrong (M,); above 1 the function is wrong."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.least == 0, 0.0, self.least / (self.factor * self.caused))

    @property
    def worst(self) -> int:
        """The row of the state where most is proven; where nothing is, of the largest error."""
        excess = self.excess
        return int(excess.argmax() if excess.any() else self.most.argmax())

    @property
    def wrong(self) -> bool:
        """Whether the errors are proven to be larger than rounding of the inputs explains."""
        return bool((self.excess > 1).any())

    @property
    def digits(self) -> int:
        """Decimal digits of the scale to which the function is right at all these states."""
        largest = float(self.most.max())
        return int(max(0.0, -np.log10(largest))) if largest > 0 else 0
