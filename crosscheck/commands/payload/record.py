"""The format `graphdyn payload 1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from crosscheck.commands.identify.gains_record import GainsRecord
from crosscheck.identifying import IdentifiedPayload
from crosscheck.report.records.record import CommandRecord, Number, Numbers, Record, attribute, written
from graphdyn.identification.currents import IdentifiedLoad


class LoadRecord(Record, of=IdentifiedLoad):
    """A load, in the frame of the link that carries it."""

    mass: float = attribute()
    mass_deviation: Number = attribute()
    center_of_mass: Numbers = attribute()
    center_deviations: Numbers = attribute()
    inertia: Sequence[Numbers] = attribute()
    inertia_deviations: Sequence[Numbers] = attribute()
    determined: bool = attribute()
    consistent: bool = attribute()


class PayloadRecord(CommandRecord, of=IdentifiedPayload, only=("known", "link"), format="graphdyn payload 1"):
    """A load and gains of the motors.

    robot: name
    recordings: files, the empty one first
    rejection_reasons: why the result is of no use; empty where it is
    warnings: currents that say nothing, and joints that do not move
    """

    robot: str = attribute("subject.name")
    recordings: Sequence[str] = attribute("names")
    joints: Sequence[str] = attribute()
    load: LoadRecord = attribute()
    gains: GainsRecord = attribute()
    relative_residuals: Sequence[Numbers] = attribute()
    lower_bound: bool = attribute()
    rejection_reasons: Sequence[str] = attribute()
    warnings: Sequence[str] = attribute()


def record(found: IdentifiedPayload, command: Sequence[str]) -> dict[str, Any]:
    return written(PayloadRecord, found, command=command)
