"""A robot from the JSON file of `graphdyn export`."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

from crosscheck.commands.export.record import ExportRecord
from crosscheck.report.records.record import has_form
from graphdyn import Body, Frame, InvalidInput, InvalidModel, Joint, JointLimits, Placement, RobotModel


def exported_robot(source: str) -> RobotModel:
    """The model of a file in the format `graphdyn export 1`.

    Raises InvalidInput, naming the file, for one that is not in this format, InvalidModel for what no robot has, and
    OSError.
    """
    remedy = "give a file that `graphdyn export --to FILE.json` wrote"
    try:
        data = json.loads(Path(source).read_bytes())
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"{source}: not a JSON file ({error}); {remedy}") from None
    if not has_form(ExportRecord, data) or data.get("format") != ExportRecord.format:
        raise InvalidInput(f"{source}: not in the format '{ExportRecord.format}'; {remedy}")
    try:
        return _model(data)
    except InvalidModel as error:
        raise InvalidModel(f"{source}: {error}") from None
    except (TypeError, KeyError) as error:
        raise InvalidInput(f"{source}: a value has the wrong type ({error}); {remedy}") from None


def _model(data: dict[str, Any]) -> RobotModel:
    parts = data["bodies"]
    return RobotModel(
        _text(data["robot"]),
        tuple(Body(_text(one["name"]), one["mass"], one["center_of_mass"], one["inertia"]) for one in parts),
        tuple(_joint(one) for one in parts),
        gravity=data["gravity"],
        base=Placement(data["base_rotation"], data["base_translation"]),
        frames=tuple(Frame(_text(one["name"]), one["body"], _placement(one)) for one in data["frames"]),
    )


def _joint(one: dict[str, Any]) -> Joint:
    limits = JointLimits(**{field.name: one[field.name] for field in fields(JointLimits)})
    drive = {name: one[name] for name in ("damping", "friction", "armature")}
    return Joint(_text(one["joint"]), one["kind"], one["parent"], _placement(one), one["axis"], limits, **drive)


def _text(name: object) -> str:
    if not isinstance(name, str):
        raise TypeError(f"{name!r} is no name")
    return name


def _placement(one: dict[str, Any]) -> Placement:
    return Placement(one["rotation"], one["translation"])
