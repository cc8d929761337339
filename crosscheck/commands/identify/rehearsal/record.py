"""The format `graphdyn rehearsal 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from crosscheck.identifying import Conditions, Rehearsal
from crosscheck.report.records.record import CommandRecord, Number, Numbers, Record, attribute, written


class ConditionsRecord(Record, of=Conditions):
    """What the virtual recordings are like."""


class LinkDeviationRecord(Record):
    """How well a link will be known: root mean square errors over the runs.

    name: of the link
    mass: [kg]
    center_of_mass: of the components, in link axes [m]; null where a run had no mass
    """

    name: str
    mass: float
    center_of_mass: Numbers


class RehearsedMethodRecord(Record):
    """What a method will find.

    name: of the method
    failure: why it has no result; null where it has
    strengths: of its prior, chosen by cross-validation in the first runs; empty without one
    deviations: root mean square errors of the base parameters, in the order of base_parameters; null where it failed
    stated: standard deviations that an identification will state, the median of the runs; null where it states none
    covered: share of the errors within twice the stated deviation
    consistent: whether all links were physically consistent in every run
    links: in the order of the file
    """

    name: str
    failure: str | None
    strengths: Sequence[float]
    deviations: Numbers | None
    stated: Numbers | None
    covered: Number
    consistent: bool
    links: Sequence[LinkDeviationRecord]


class RehearsedParameterRecord(Record):
    """A base parameter that the motion determines.

    name: in standard parameters
    symbol: in Khalil's notation
    unit: of the parameter
    file: value of the file; zero for drives
    file_deviation: root mean square error of this value over the runs
    """

    name: str
    symbol: str
    unit: str
    file: float
    file_deviation: float


class RehearsalRecord(CommandRecord, of=Rehearsal, only=("motion", "duration"), format="graphdyn rehearsal 1"):
    """What the identification of a planned motion will find, and how certainly.

    motion: name of its file
    complete: the motion determines all that any motion could
    robot: name
    rank: number of base parameters that the motion determines
    structural_rank: number that some motion could determine
    still_joints: joints that the motion does not move
    undetermined: base parameters that this motion does not determine individually
    best: method with the smallest deviations of base parameters; null without one
    best_of_links: method with the smallest deviations of masses; null where none has physically consistent links
    cutoff: of the low-pass [Hz], one or by channel; null for none, and where residual analysis chose
    cutoffs: those that residual analysis chose, run by run [Hz]
    conditions: what the virtual recordings are like
    base_parameters: those that the motion determines
    file_links: errors of the file itself
    methods: what each will find
    """

    robot: str = attribute("subject.name")
    conditions: ConditionsRecord
    cutoff: float | Mapping[str, float] | None
    cutoffs: Sequence[float] = attribute()
    rank: int = attribute("identifiability.rank")
    structural_rank: int = attribute("identifiability.structural_rank")
    complete: bool = attribute()
    still_joints: Sequence[str] = attribute()
    undetermined: Sequence[str] = attribute("identifiability.lost")
    best: str | None = attribute()
    best_of_links: str | None = attribute()
    base_parameters: Sequence[RehearsedParameterRecord]
    file_links: Sequence[LinkDeviationRecord]
    methods: Sequence[RehearsedMethodRecord]


def record(found: Rehearsal, command: Sequence[str]) -> dict[str, Any]:
    """Everything but the runs."""
    told, prior = found.identifiability, found.prior_base_values
    names = zip(told.base_names, told.base_symbols, told.base_units, prior, found.file.base_deviations, strict=True)
    keys = ("name", "symbol", "unit", "file", "file_deviation")
    return written(
        RehearsalRecord,
        found,
        command=command,
        cutoff=None if found.cutoffs else found.preparation.cutoff,
        base_parameters=[dict(zip(keys, row, strict=True)) for row in names],
        file_links=_links(found, found.file),
        methods=[
            *(_method(found, name) for name in found.outcomes),
            *(_failed(found, name) for name in found.failures),
        ],
    )


def _method(found: Rehearsal, name: str) -> dict[str, Any]:
    outcome = found.outcomes[name]
    return written(
        RehearsedMethodRecord,
        name=name,
        failure=None,
        strengths=found.strengths.get(name, ()),
        deviations=outcome.base_deviations,
        stated=outcome.stated,
        covered=outcome.covered,
        consistent=outcome.consistent,
        links=_links(found, outcome),
    )


def _failed(found: Rehearsal, name: str) -> dict[str, Any]:
    return written(
        RehearsedMethodRecord,
        name=name,
        failure=found.failures[name],
        strengths=(),
        deviations=None,
        stated=None,
        covered=np.nan,
        consistent=False,
        links=[],
    )


def _links(found: Rehearsal, outcome: Any) -> list[dict[str, Any]]:
    rows = zip(found.link_names, outcome.mass_deviations, outcome.center_deviations, strict=True)
    return [written(LinkDeviationRecord, name=name, mass=mass, center_of_mass=center) for name, mass, center in rows]
