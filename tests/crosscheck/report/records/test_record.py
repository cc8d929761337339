"""Records: which fields of a result are written, and the schema that describes them."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from crosscheck.report.records.json_schema import schema_of
from crosscheck.report.records.record import (
    FURTHER_LIBRARIES,
    Count,
    Record,
    attribute,
    plain,
    taking_part,
    versions,
    written,
)


@dataclass(frozen=True)
class Wheel:
    """A part.

    radius: of the tire, NaN where it is unknown [m]
    """

    radius: float


@dataclass(frozen=True)
class Engine:
    """Another part. power: at most [W]"""

    power: float
    name: str


@dataclass(frozen=True, eq=False)
class Car:
    """A result.

    name: of the car
    doors: how many
    turn: of the body in the world   (3, 3)
    steered: whether the wheel is   (n,)
    engine: None where it is pushed
    """

    name: str
    doors: int
    turn: NDArray[np.float64]
    steered: NDArray[np.bool_]
    wheels: tuple[Wheel, ...]
    engine: Engine | None
    secret: object = None

    @property
    def heavy(self) -> bool:
        """Whether it needs a strong bridge."""
        return True

    @cached_property
    def size(self) -> tuple[float, float]:
        """Length and width (2,) [m]."""
        return 4.0, 2.0


class WheelRecord(Record, of=Wheel):
    """A wheel."""

    radius: float


class CarRecord(Record, of=Car, leave_out=("secret",), format="graphdyn drive 1"):
    """A car.

    owner: who drives
    spare: further wheels, by place
    """

    owner: str
    doors: Count
    heavy = attribute()
    size = attribute()
    power = attribute("engine.power")
    wheels: Sequence[WheelRecord]
    spare: Mapping[str, WheelRecord]


def car(engine):
    return Car("beetle", 2, np.eye(3), np.array([True, False]), (Wheel(0.3), Wheel(np.nan)), engine)


class TestWritten:
    def test_fields_of_the_result_properties_and_what_is_said(self):
        record = plain(written(CarRecord, car(Engine(60.0, "boxer")), owner="me", spare={"boot": Wheel(0.25)}))
        assert record == {
            "format": "graphdyn drive 1",
            "owner": "me",
            "heavy": True,
            "size": [4.0, 2.0],
            "power": 60.0,
            "spare": {"boot": {"radius": 0.25}},
            "name": "beetle",
            "doors": 2,
            "turn": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            "steered": [True, False],
            "wheels": [{"radius": 0.3}, {"radius": None}],
            "engine": {"power": 60.0, "name": "boxer"},
        }
        assert next(iter(record)) == "format"

    def test_an_attribute_of_nothing_is_null(self):
        record = written(CarRecord, car(None), owner="me", spare={})
        assert record["power"] is record["engine"] is None

    def test_records_that_are_written_already(self):
        record = written(CarRecord, car(None), owner="me", spare={}, wheels=[{"radius": 1}])
        assert record["wheels"] == [{"radius": 1}]

    def test_only_some_fields(self):
        class Short(Record, of=Car, only=("name",)):
            """Short."""

        assert written(Short, car(None)) == {"name": "beetle"}

    def test_an_unknown_field_is_refused(self):
        with pytest.raises(TypeError, match="has no field colour"):

            class Wrong(Record, of=Car, leave_out=("colour",)):
                """Wrong."""


class TestSchema:
    def properties(self):
        return schema_of(CarRecord)["properties"]

    def test_types(self):
        found = self.properties()
        assert found["format"]["const"] == "graphdyn drive 1"
        assert found["doors"] == {"minimum": 0, "type": "integer", "description": "How many."}
        assert found["heavy"]["type"] == "boolean"
        assert found["power"]["type"] == ["number", "null"]
        assert found["engine"]["anyOf"] == [{"$ref": "#/$defs/Engine"}, {"type": "null"}]
        assert found["wheels"]["items"] == {"$ref": "#/$defs/WheelRecord"}
        assert found["spare"]["additionalProperties"] == {"$ref": "#/$defs/WheelRecord"}
        assert "secret" not in found
        assert schema_of(CarRecord)["required"] == list(found)

    def test_sizes_of_arrays(self):
        found = self.properties()
        row = {"items": {"type": "number"}, "minItems": 3, "maxItems": 3, "type": "array"}
        assert found["turn"]["items"] == row
        assert (found["turn"]["minItems"], found["turn"]["maxItems"]) == (3, 3)
        assert found["steered"]["items"] == {"type": "boolean"}
        assert "minItems" not in found["steered"]
        assert found["size"]["maxItems"] == 2

    def test_descriptions_are_those_of_the_class_of_the_result(self):
        found = self.properties()
        assert found["name"]["description"] == "Of the car."
        assert found["owner"]["description"] == "Who drives."
        assert found["heavy"]["description"] == "Whether it needs a strong bridge."
        assert found["engine"]["description"] == "Null where it is pushed."
        assert found["turn"]["description"] == "Of the body in the world (3, 3)."

    def test_not_a_number_is_null(self):
        radius = schema_of(CarRecord)["$defs"]["WheelRecord"]["properties"]["radius"]
        assert radius == {"type": ["number", "null"], "description": "Of the tire, null where it is unknown [m]."}

    def test_one_of_several(self):
        class Painted(Record, format="graphdyn paint 1"):
            """Painted.

            color: of the paint
            """

            color: Literal["red", "blue"]

        assert schema_of(Painted)["properties"]["color"]["enum"] == ["red", "blue"]

    def test_a_field_that_the_result_lacks(self):
        class Wrong(Record, of=Car, only=(), format="graphdyn wrong 1"):
            """Wrong."""

            weight = attribute()

        with pytest.raises(AttributeError, match="has no field or property 'weight'"):
            schema_of(Wrong)

    def test_an_array_without_a_shape(self):
        @dataclass(frozen=True, eq=False)
        class Vague:
            """Vague.

            values: some numbers
            """

            values: NDArray[np.float64]

        class Shapeless(Record, of=Vague, format="graphdyn vague 1"):
            """Shapeless."""

        with pytest.raises(TypeError, match="the line of an array gives no shape"):
            schema_of(Shapeless)


def test_all_that_took_part_is_told(monkeypatch):
    """Python, compiler and platform in any case, references and solvers once they are imported."""
    for name in FURTHER_LIBRARIES:
        monkeypatch.delitem(sys.modules, name, raising=False)
    known = taking_part()
    assert {**versions(), **known} == known
    assert set(known) - set(versions()) == {"llvmlite", "python", "platform"}
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert taking_part() == {**known, "mujoco": version("mujoco")}
