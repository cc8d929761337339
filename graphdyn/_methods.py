"""Which method a verb uses; graphdyn._dynamics says what each one is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from graphdyn._errors import InvalidInput
from graphdyn.layout import Array

Method = Literal["auto", "recursive", "projected", "dense"]
WORTH_COMPILING = 1000
"""Samples from which "auto" is "recursive": the others take longer for them than compiling, a tenth of a second."""

METHODS: tuple[Method, ...] = ("auto", "recursive", "projected", "dense")


def is_recursive(method: str, x: Mapping[str, Array], out: object = None) -> bool:
    """Whether this method, on these arguments, is the recursive one.

    Raises InvalidInput for an unknown method, and for out with a method that cannot write there.
    """
    if method not in METHODS:
        raise InvalidInput(f"method is '{method}'; use one of {', '.join(METHODS)}")
    if out is not None and method in ("projected", "dense"):
        raise InvalidInput(f"the {method} method makes arrays of its own; leave out away, or use method='recursive'")
    return method == "recursive" or (method == "auto" and (x["q"][..., 0].size >= WORTH_COMPILING or out is not None))
