"""Types of the fields of records that say more than their Python types."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from crosscheck.report.versions import REPORTED_LIBRARIES


class Keywords:
    """JSON Schema keywords of a type, for instance Annotated[int, Keywords(minimum=1)]."""

    def __init__(self, **keywords: Any):
        self.keywords = keywords


Number = float | None
"""A number that may not exist or not be finite: NaN and ±∞ are written as null."""

Numbers = Sequence[Number]

Count = Annotated[int, Keywords(minimum=0)]

Index = Annotated[int, Keywords(minimum=1)]

Versions = Annotated[
    Mapping[str, str],
    Keywords(
        description="Versions of graphdyn and of the libraries that took part, by name.",
        required=[*REPORTED_LIBRARIES, "pinocchio"],
    ),
]

Command = Annotated[Sequence[str], Keywords(description="The arguments as given.")]
