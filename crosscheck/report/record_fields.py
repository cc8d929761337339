"""What the fields of all records are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from typing import Annotated, Any, TypeVar

from crosscheck.report.versions import REPORTED_LIBRARIES

Record = TypeVar("Record")


class Keywords:
    """JSON Schema keywords of a type, for instance Annotated[int, Keywords(minimum=1)].

    They take effect where pydantic generates the schema: crosscheck.commands.schemas.
    """

    def __init__(self, **keywords: Any):
        self.keywords = keywords

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {**handler(schema), **self.keywords}


Number = float | None
"""A number that may not exist or not be finite: NaN and ±∞ are written as null."""

Count = Annotated[int, Keywords(minimum=0)]

Index = Annotated[int, Keywords(minimum=1)]

Vector3 = Annotated[Sequence[float], Keywords(minItems=3, maxItems=3)]

FORMAT = Keywords(
    description="What this file is; the number grows when a field changes its meaning or disappears. "
    "New fields may appear."
)

Versions = Annotated[
    Mapping[str, str],
    Keywords(
        description="Versions of graphdyn and of the libraries that took part, by name.",
        required=[*REPORTED_LIBRARIES, "pinocchio"],
    ),
]

Command = Annotated[Sequence[str], Keywords(description="The arguments as given.")]


def taken(record: type[Record], source: object, **said: Any) -> Record:
    """A record whose fields are the attributes of the same name, but for those that are said or have a default."""
    names = [
        field.name
        for field in fields(record)  # type: ignore[arg-type]
        if field.name not in said and field.default is field.default_factory is MISSING
    ]
    return record(**{name: getattr(source, name) for name in names}, **said)
