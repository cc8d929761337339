"""A robot from the JSON file of `graphdyn export`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from crosscheck.commands.export.record import ExportRecord
from crosscheck.report.records.record import has_form
from graphdyn import Body, Frame, InvalidInput, InvalidModel, Joint, Placement, RobotModel


def exported_robot(source: str) -> RobotModel:
    """The model of a file in the format `graphdyn export 1`, which has neither limits nor drives.

    Raises InvalidInput, naming the file, for one that is not in this format, InvalidModel for what no robot has, and
    OSError.
    """
    remedy = "give a file that `graphdyn export --to FILE.json` wrote"
    try:
        data = json.loads(Path(source).read_bytes())
    except ValueError as error:
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
        str(data["robot"]),
        tuple(Body(one["name"], one["mass"], one["center_of_mass"], one["inertia"]) for one in parts),
        tuple(Joint(one["joint"], one["kind"], one["parent"], _placement(one), one["axis"]) for one in parts),
        gravity=data["gravity"],
        base=Placement(data["base_rotation"], data["base_translation"]),
        frames=tuple(Frame(one["name"], one["body"], _placement(one)) for one in data["frames"]),
    )


def _placement(one: dict[str, Any]) -> Placement:
    return Placement(one["rotation"], one["translation"])
