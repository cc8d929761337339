"""What `graphdyn paper 1` says of Tables 3 and 4: the identified parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from crosscheck.report.records._fields import Count, Keywords, Number, taken
from crosscheck.report.records.paper_printed import SIX, PrintedNumberRecord, printed_number_record
from crosscheck.studies.paper.identification import WHY_TABLE_3, PaperIdentification, PaperTrial
from crosscheck.studies.paper.printed import PARAMETERS, TABLE_3, TABLE_4
from graphdyn.layout import Array

NAMES = Keywords(required=list(PARAMETERS))
ByParameter = Annotated[Mapping[str, Annotated[Sequence[Number], SIX]], NAMES]
PrintedByParameter = Annotated[Mapping[str, Annotated[Sequence[PrintedNumberRecord], SIX]], NAMES]


@dataclass(frozen=True, kw_only=True)
class TrialRecord:
    """One identification."""

    data: str
    """Which data."""

    values: ByParameter
    """Identified [kg, kg m²]; null where the data do not determine it."""

    errors: ByParameter
    """Values minus true ones [kg, kg m²]."""

    standard_deviations: ByParameter
    """As the residual shows them [kg, kg m²]; null where nothing does."""

    undetermined: Sequence[str]
    """Names of the parameters that the data do not determine."""

    rank: Count
    """Of 36 columns."""

    condition_number: float
    """The worst of the systems, on what they determine."""

    largest: float
    """Largest absolute error over the compared entries [kg, kg m²]."""

    rms: float
    """Root mean square of these errors [kg, kg m²]."""


@dataclass(frozen=True, kw_only=True)
class PaperIdentificationRecord:
    """Tables 3 and 4."""

    why: str
    """Why numbers differ."""

    true: ByParameter
    """From density and geometry [kg, kg m²]."""

    table_3: PrintedByParameter
    """Table 3 as printed [kg, kg m²]."""

    table_4: PrintedByParameter
    """Table 4 as printed [kg, kg m²]."""

    printed_largest: float
    """Largest absolute error of Table 4 over the compared entries [kg, kg m²]."""

    printed_rms: float
    """Root mean square of these errors [kg, kg m²]."""

    compared: Count
    """Entries that the data determine and the paper prints."""

    implied_moment: float
    """J_22 and J_33 of B_1 by the cylinder formula with the mean of its printed masses [kg m²]."""

    trials: Sequence[TrialRecord]
    """Identifications: exact data, then data of seven digits."""


def paper_identification_record(found: PaperIdentification) -> PaperIdentificationRecord:
    return taken(
        PaperIdentificationRecord,
        found,
        why=WHY_TABLE_3,
        true=_by_parameter(found.true),
        table_3={name: [printed_number_record(number) for number in row] for name, row in TABLE_3.rows.items()},
        table_4={name: [printed_number_record(number) for number in row] for name, row in TABLE_4.rows.items()},
        compared=int(found.compared.sum()),
        implied_moment=found.implied,
        trials=[_trial(trial, found) for trial in (found.exact, found.together, *found.rounded)],
    )


def _trial(trial: PaperTrial, found: PaperIdentification) -> TrialRecord:
    return taken(
        TrialRecord,
        trial,
        values=_by_parameter(trial.values),
        errors=_by_parameter(trial.errors),
        standard_deviations=_by_parameter(trial.standard_deviations),
        largest=trial.largest(found.compared),
        rms=trial.rms(found.compared),
    )


def _by_parameter(values: Array) -> Mapping[str, list[float]]:
    return {name: row.tolist() for name, row in zip(PARAMETERS, np.asarray(values), strict=True)}
