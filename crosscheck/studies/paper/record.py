"""A reproduction as plain data: `graphdyn paper --json`, described in docs/schemas/paper-1.schema.json."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from crosscheck.studies.errata import ERRATA
from crosscheck.studies.paper.identification import WHY_TABLE_3, PaperIdentification, PaperTrial
from crosscheck.studies.paper.multipliers import KINDS, WHY_PRINTED, printed_ratios
from crosscheck.studies.paper.printed import PARAMETERS, TABLE_3, TABLE_4, Printed
from crosscheck.studies.paper.reproduction import Reproduction
from crosscheck.studies.paper.tables import WHY_TABLE_2
from crosscheck.studies.paper.why import WHY_CORRECTED
from graphdyn.layout import Array

PAPER_FORMAT = "graphdyn paper 1"


def as_json(found: Reproduction) -> dict[str, Any]:
    """Everything but the pictures' curves; NaN is left to crosscheck.report.comparisons.finite."""
    return {
        "agrees": found.agrees,
        "checks": [vars(check) | {"agrees": check.agrees} for check in found.checks],
        "table_2": {
            "why": WHY_TABLE_2,
            "rows": [
                {"name": name, "printed": [number.text for number in printed], "ours": ours.tolist()}
                for name, printed, ours in zip(
                    found.geometry.rows, found.geometry.printed, found.geometry.ours, strict=True
                )
            ],
        },
        "identification": _identification(found.identification),
        "as_printed": {
            "why": WHY_PRINTED,
            "rank": found.printed.rank,
            "n_rows": found.printed.n_rows,
            "multipliers": [
                {
                    "name": number.name,
                    **_number(number.printed),
                    "ours": number.ours,
                    "kind": number.kind,
                    "meaning": KINDS[number.kind],
                    "digits": number.digits,
                }
                for number in found.numbers
            ],
            "ratios": [
                {"joint": joint, "printed": printed, "null_vector": found.printed.ratios.get(joint)}
                for joint, printed in printed_ratios().items()
            ],
        },
        "corrected": {
            "why": WHY_CORRECTED,
            "difference": found.corrected.difference,
            **{
                name: getattr(found.corrected, name).tolist()
                for name in ("multipliers", "rnea", "tau", "forces", "moments")
            },
            "reading": list(found.corrected.reading),
        },
        "over_time": {
            "samples": len(found.over_time.recording.time),
            "difference": found.over_time.difference,
            "ranks": [{"time": time, "rank": rank} for time, rank in found.over_time.ranks.items()],
        },
        "errata": {
            "samples": found.samples,
            "seed": found.seed,
            "sentences": dict(ERRATA),
            "effects": [effect.record for effect in found.effects],
        },
    }


def _identification(found: PaperIdentification) -> dict[str, Any]:
    return {
        "why": WHY_TABLE_3,
        "true": _by_parameter(found.true),
        "table_3": {name: [_number(number) for number in row] for name, row in TABLE_3.rows.items()},
        "table_4": {name: [_number(number) for number in row] for name, row in TABLE_4.rows.items()},
        "printed_largest": found.printed_largest,
        "printed_rms": found.printed_rms,
        "compared": int(found.compared.sum()),
        "implied_moment": found.implied,
        "trials": [_trial(trial, found) for trial in (found.exact, found.together, *found.rounded)],
    }


def _trial(trial: PaperTrial, found: PaperIdentification) -> dict[str, Any]:
    return {
        "data": trial.data,
        "values": _by_parameter(trial.values),
        "errors": _by_parameter(trial.errors),
        "standard_deviations": _by_parameter(trial.standard_deviations),
        "undetermined": list(trial.undetermined),
        "rank": trial.rank,
        "condition_number": trial.condition_number,
        "largest": trial.largest(found.compared),
        "rms": trial.rms(found.compared),
    }


def _by_parameter(values: Array) -> Mapping[str, list[float]]:
    return {name: row.tolist() for name, row in zip(PARAMETERS, np.asarray(values), strict=True)}


def _number(number: Printed) -> dict[str, str | None]:
    return {"printed": number.text, "reading": number.reading, "erratum": number.erratum or None}
