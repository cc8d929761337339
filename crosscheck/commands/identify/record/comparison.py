"""What `graphdyn identify 2` says in comparison: a row for every method of every torque model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.commands.identify.record.methods import SizesRecord
from crosscheck.identifying.results.identified_model import Candidate, HeldOutPrediction
from crosscheck.identifying.results.recommending import joint_errors, mean_error
from crosscheck.report.record_fields import Number, taken


@dataclass(frozen=True, kw_only=True)
class TrialRecord:
    """Errors of one result on some of the predicted rows."""

    name: str
    """Of the rows: a fold, a file, or an interval."""

    mean_error: Number
    """Mean over the joints of ‖e‖ / ‖τ‖ over moving rows."""

    everything: SizesRecord
    """Over all rows."""

    moving: SizesRecord
    """Per joint over its rows with |v| > 0.02 rad/s or m/s."""


@dataclass(frozen=True, kw_only=True)
class CandidateRecord:
    """A row of the tables: a torque model and a method."""

    name: str
    """As in the tables, and in recommended, best and shown."""

    model: str
    """Name of the torque model; empty for the only one."""

    method: str
    """Name of the method, as in methods of the model."""

    cad_links: bool
    """The links are those of CAD, only the drives are fitted."""

    mean_error: Number
    """Mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows; null where there is no answer."""

    trials: Sequence[TrialRecord]
    """Rows that were predicted and choose: fold by fold, file by file."""

    aside: Sequence[TrialRecord]
    """Rows that were predicted and choose nothing."""


def candidate_record(candidate: Candidate) -> CandidateRecord:
    model, result = candidate.model, candidate.result

    def errors(predictions: Sequence[HeldOutPrediction]) -> list[TrialRecord]:
        return [
            TrialRecord(
                name=prediction.name,
                mean_error=float(np.nanmean(joint_errors(statistics))),
                everything=taken(SizesRecord, statistics.everything),
                moving=taken(SizesRecord, statistics.moving),
            )
            for prediction in predictions
            if (statistics := prediction.statistics.get(result.name)) is not None
        ]

    return CandidateRecord(
        name=candidate.name,
        model=model.name,
        method=result.name,
        cad_links=model.cad_of is not None,
        mean_error=None if result.failure is not None else mean_error(result),
        trials=errors(model.trials),
        aside=errors(model.aside),
    )
