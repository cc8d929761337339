"""Signatures that name the types of arrays, instead of spelling out what these stand for."""

from __future__ import annotations

import re
from typing import Literal

from numpy.typing import ArrayLike
from sphinx.util.typing import stringify_annotation

from graphdyn.layout import Array

_ALIASES = {"ArrayLike": ArrayLike, "Array": Array}
_MODES: tuple[Literal["smart", "fully-qualified-except-typing"], ...] = ("smart", "fully-qualified-except-typing")


def readable(signature: str | None) -> str | None:
    """The text of a signature, or of what is returned, with the names of the aliases."""
    if signature is None:
        return None
    for name, alias in _ALIASES.items():
        for mode in _MODES:
            signature = signature.replace(stringify_annotation(alias, mode), name)
    return re.sub(r"TypeAliasForwardRef\('(\w+)'\)", r"\1", signature)
