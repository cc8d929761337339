"""The operations of a recursion, each of which can be done wrong: many codes at once, one slip in each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from crosscheck.judging.faults.fault import factor_said
from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, State, turned, turned_back
from graphdyn.layout import Array

FACTORS = (0.0, -1.0, 2.0, 0.5)
"""What the result of an operation is multiplied by."""

NOT_TURNED = "not turned"
WRONG_WAY = "turned the wrong way"
HELD = "not differentiated"

Product = tuple[Callable[[Array, Array], Array], Mapping[str, Array]]
"""An operation with two factors, and these by their names."""

Way = float | str
"""A factor, or what else is done, in words that follow a noun."""


@dataclass(frozen=True)
class Slip:
    """One operation done wrong: the same way at one joint, or at every joint.

    operation: a noun, such as "ω̇ × r in the acceleration of the link origin"
    joint: number of the joint, or of the body outside of it, None for every one, ONCE for what is done once
    of: "joint", or "body" for operations with bodies
    """

    operation: str
    way: Way
    joint: int | None
    of: Literal["joint", "body"] = "joint"

    def message(self, joint_names: Sequence[str], body_names: Sequence[str] = ()) -> str:
        """The slip as a sentence."""
        names = body_names if self.of == "body" else joint_names
        at = f" at every {self.of}" if self.joint is None else f" at {self.of} '{names[self.joint]}'"
        at = "" if self.joint == ONCE else at
        if isinstance(self.way, str):
            return f"{self.operation}{at} is {self.way}"
        return factor_said(f"{self.operation}{at}", self.way)


ONCE = -1
"""What stands in place of a joint: an operation that is done once, such as one with the chosen frame."""


class Operations:
    """Puts slips into the results of operations at R states, the k-th of K slips into the k-th code.

    ways: what can be done wrong in each operation at each joint, of those that were done so far
    """

    def __init__(self, slips: Sequence[Slip], rows: int) -> None:
        self.ways: dict[tuple[str, int], tuple[Way, ...]] = {}
        self._of: dict[str, Literal["joint", "body"]] = {}
        self._at: dict[str, dict[int | None, dict[Way, list[int]]]] = {}
        self._shape: tuple[int, int] = len(slips), rows
        self._type: type = float
        self._held: Callable[[Array], Array] | None = None
        for k, slip in enumerate(slips):
            self._at.setdefault(slip.operation, {}).setdefault(slip.joint, {}).setdefault(slip.way, []).append(k)

    def see(self, rows: int, numbers: type, held: Callable[[Array], Array] | None = None) -> None:
        """Set the number of states that operations see from here on, and the type of their numbers.

        held: where they are differentiated, gives a number at the states whose derivatives are taken
        """
        self._shape, self._type, self._held = (self._shape[0], rows), numbers, held

    def result(
        self,
        operation: str,
        joint: int,
        right: Array,
        others: Mapping[str, Callable[[], Array]] | None = None,
        of: Literal["joint", "body"] = "joint",
        product: Product | None = None,
    ) -> Array:
        """The result (…, K, R) of an operation at a joint, where K is 1 before the first slip.

        others: what else a code may compute there, by the words for it; of: what the joint's number stands for;
        product: the factors of the operation, each of which may be forgotten by the product rule
        """
        others = {**(others or {}), **self._undifferentiated(right, product)}
        self.ways[operation, joint] = (*FACTORS, *others)
        self._of[operation] = of
        if not (slips := self._at.get(operation)):
            return right
        found: Array | None = None
        for place in (joint, None):
            for way, which in slips.get(place, {}).items():
                wrong = others[way]() if isinstance(way, str) else way * right
                if found is None:
                    found = np.array(np.broadcast_to(right, (*right.shape[:-2], *self._shape)), dtype=self._type)
                found[..., which, :] = wrong if wrong.shape[-2] == 1 else wrong[..., which, :]
        return right if found is None else found

    def _undifferentiated(self, right: Array, product: Product | None) -> dict[str, Callable[[], Array]]:
        """The result, or one of its factors, taken as constant in a derivative."""
        held = self._held
        if held is None:
            return {}
        found: dict[str, Callable[[], Array]] = {HELD: lambda: held(right)}
        if product is not None:
            times, factors = product
            for name in factors:
                some = {x: held(y) if x == name else y for x, y in factors.items()}
                found[f"taken with {name} {HELD}"] = partial(times, *some.values())
        return found

    def outward(self, operation: str, joint: int, turn: Array, x: Array) -> Array:
        """A vector x of the inside link turned into the link."""
        others = {NOT_TURNED: lambda: 1.0 * x, WRONG_WAY: lambda: turned(turn, x)}
        return self.result(operation, joint, turned_back(turn, x), others, product=turn_product(turned_back, turn, x))

    def inward(self, operation: str, joint: int, turn: Array, x: Array) -> Array:
        """A vector x of the link turned into the inside link."""
        others = {NOT_TURNED: lambda: 1.0 * x, WRONG_WAY: lambda: turned_back(turn, x)}
        return self.result(operation, joint, turned(turn, x), others, product=turn_product(turned, turn, x))

    def slips(self) -> Iterator[Slip]:
        """All slips of the operations that were done: at every joint, and at each of them."""
        places = Counter(operation for operation, _ in self.ways)
        everywhere = dict.fromkeys(
            (operation, way) for (operation, _), ways in self.ways.items() for way in ways if places[operation] > 1
        )
        yield from (Slip(operation, way, None, self._of[operation]) for operation, way in everywhere)
        for (operation, joint), ways in self.ways.items():
            yield from (Slip(operation, way, joint, self._of[operation]) for way in ways)


def turn_product(way: Callable[[Array, Array], Array], turn: Array, x: Array) -> Product:
    """A vector turned by a rotation, as a product."""
    return way, {"the rotation": turn, "the vector": x}


Formulation = Callable[[DynamicsCode, Numbers, State, Operations], Array]
"""(code, numbers (…, 1, 1), q, v, a (n, 1, R), operations) → torques (n, K, R)."""
