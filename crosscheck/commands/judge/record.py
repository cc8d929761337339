"""The format `graphdyn judge 2`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np

from crosscheck.judging.exact_errors import ExactErrors
from crosscheck.judging.judgment import (
    Diagnosis,
    FittedNumber,
    JudgedFunction,
    Judgment,
    WorstCall,
    infinite_where_nan,
)
from crosscheck.report.records.record import CommandRecord, Keywords, Number, Record, attribute, written
from graphdyn.layout import Array

LEVELS = {
    "0.5": "Half of the states have no larger error.",
    "0.9": "Nine of ten states have no larger error.",
    "1": "The largest error.",
}

Quantiles = Annotated[
    Mapping[str, Number],
    Keywords(
        description="Quantiles 0.5, 0.9 and 1 (the largest) of the relative error over the states, no unit; "
        "null where infinite.",
        properties={level: {"description": text, "type": ["number", "null"]} for level, text in LEVELS.items()},
        required=list(LEVELS),
    ),
]


class JudgeWorstRecord(Record, of=WorstCall):
    """A state at which the function deviates, to be reproduced: of the largest error, or the smallest example."""

    arguments: Mapping[str, Annotated[Sequence[Number], Keywords(description="One array (n,).")]]
    expected: Sequence[Number]
    answer: Sequence[Number]


class ExactErrorsRecord(Record, of=ExactErrors):
    """The errors of a function against exact values.

    wrong: whether they are proven to be larger than rounding of the inputs explains
    digits: decimal digits of the scale to which the function is right at all these states
    """

    truth: Literal["file", "model"]
    states: Sequence[int]
    least: Quantiles
    most: Quantiles
    caused: Quantiles
    references: Mapping[str, Quantiles]
    ulps: Number
    wrong = attribute()
    digits = attribute()


class FunctionRecord(Record, of=JudgedFunction, leave_out=("name", "code")):
    """One function."""

    agrees = attribute()
    errors: Mapping[str, Quantiles]
    references_differ: Mapping[str, Quantiles]
    backward_errors: Mapping[str, Quantiles]
    references_differ_backward: Mapping[str, Quantiles]
    repeated: Quantiles
    worst: JudgeWorstRecord
    smallest: JudgeWorstRecord | None
    exact: ExactErrorsRecord | None


class FittedNumberRecord(Record, of=FittedNumber):
    """A number of the robot as the user code must have it."""

    theirs: Number
    ours: Number
    difference: Number = attribute()


class DiagnosisRecord(Record, of=Diagnosis):
    """One fault."""

    explains: Number
    numbers: Sequence[FittedNumberRecord]


class JudgeRecord(CommandRecord, of=Judgment, leave_out=("file", "model", "reading"), format="graphdyn judge 2"):
    """Dynamics functions under test against graphdyn, Pinocchio and MuJoCo, and what is wrong with them.

    verdict: undecided: the references differ among themselves
    """

    verdict: Literal["agrees", "disagrees", "undecided"]
    agrees = attribute()
    decided = attribute()
    chain = attribute()
    locked = attribute()
    precision: Literal["double", "single"]
    functions: Mapping[str, FunctionRecord]
    diagnoses: Sequence[DiagnosisRecord]


def record(judgment: Judgment, command: Sequence[str]) -> dict[str, Any]:
    """A judgment but for the model."""
    return written(
        JudgeRecord,
        judgment,
        command=command,
        verdict=judgment.verdict.lower(),
        functions={name: _function(function) for name, function in judgment.functions.items()},
    )


def _function(function: JudgedFunction) -> dict[str, Any]:
    by_reference = ("errors", "references_differ", "backward_errors", "references_differ_backward")
    return written(
        FunctionRecord,
        function,
        repeated=_quantiles(function.repeated),
        exact=None if function.exact is None else _exact(function.exact),
        **{
            name: {reference: _quantiles(error) for reference, error in getattr(function, name).items()}
            for name in by_reference
        },
    )


def _exact(errors: ExactErrors) -> dict[str, Any]:
    return written(
        ExactErrorsRecord,
        errors,
        **{name: _quantiles(getattr(errors, name)) for name in ("least", "most", "caused")},
        references={name: _quantiles(error) for name, error in errors.references.items()},
    )


def _quantiles(errors: Array) -> dict[str, float]:
    """Errors that occurred; those that are no numbers are larger than all others."""
    ordered = np.sort(infinite_where_nan(errors))
    return {level: float(ordered[math.ceil(float(level) * (len(ordered) - 1))]) for level in LEVELS}
