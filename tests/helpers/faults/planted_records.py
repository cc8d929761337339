"""Records in which every number that may be null is NaN or infinite."""

from collections.abc import Mapping
from typing import Any

from crosscheck.report.records.record import plain


def planted(record: Any, schema: Mapping[str, Any], number: float) -> Any:
    """The same record with a number in place of everything that is a number or null by the schema."""
    return _planted(plain(record), schema, schema.get("$defs", {}), number)


def _planted(value: Any, schema: Mapping[str, Any], definitions: Mapping[str, Any], number: float) -> Any:
    if schema.get("type") == ["number", "null"]:
        return number
    if "$ref" in schema:
        return _planted(value, definitions[schema["$ref"].split("/")[-1]], definitions, number)
    if "anyOf" in schema:
        return value if value is None else _planted(value, schema["anyOf"][0], definitions, number)
    if isinstance(value, list):
        return [_planted(item, schema["items"], definitions, number) for item in value]
    if isinstance(value, Mapping):
        inner, others = schema.get("properties", {}), schema.get("additionalProperties", {})
        return {key: _planted(item, inner.get(key, others), definitions, number) for key, item in value.items()}
    return value
