"""The format `graphdyn judge 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np

from crosscheck.judging.judgment import Diagnosis, JudgedFunction, Judgment
from crosscheck.report.record_fields import FORMAT, Command, Keywords, Number, Versions, taken
from crosscheck.report.versions import versions
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


@dataclass(frozen=True, kw_only=True)
class JudgeWorstRecord:
    """The state of the largest error, to be reproduced."""

    arguments: Mapping[str, Annotated[Sequence[Number], Keywords(description="One array (n,).")]]
    """What the function was called with, by name, in its own joint order [rad or m, rad/s or m/s, rad/s² or m/s², N m
    or N].
    """

    expected: Sequence[Number]
    """graphdyn's answer, flattened, in the order of urdf.load."""

    answer: Sequence[Number]
    """The function's answer, flattened, in the order of urdf.load."""


@dataclass(frozen=True, kw_only=True)
class FailedStateRecord:
    """A state at which the function gave no answer."""

    number: int
    """Of the state, from 0."""

    message: str
    """What the function did, and its arguments."""


@dataclass(frozen=True, kw_only=True)
class FunctionRecord:
    """One function."""

    agrees: bool
    """With every referee, at every state."""

    bound: float
    """Largest relative error that is agreement."""

    scale: str
    """What the errors are relative to."""

    backward_scale: str
    """What the backward errors are relative to; empty for other functions."""

    errors: Mapping[str, Quantiles]
    """Against each referee, by its name."""

    referees_differ: Mapping[str, Quantiles]
    """Of each other referee against graphdyn."""

    backward_errors: Mapping[str, Quantiles]
    """Of accelerations, by the torques that each referee computes for them; empty for other functions."""

    referees_differ_backward: Mapping[str, Quantiles]
    """Of each other referee's accelerations, by the torques that graphdyn computes for them."""

    repeated: Quantiles
    """Of the second answer to every question, asked in the reverse order, against the first: 0 for a function that
    keeps nothing between calls.
    """

    conventions: Mapping[str, str]
    """Those that the answers follow, where codes differ rightly, such as the reference of a Jacobian; empty where
    there are none, or none is found.
    """

    failures: Sequence[FailedStateRecord]
    """The states without an answer, which are in none of the errors."""

    worst: JudgeWorstRecord
    """The state of the largest error, to be reproduced."""


@dataclass(frozen=True, kw_only=True)
class FittedNumberRecord:
    """A number of the robot as the foreign code must have it."""

    name: str
    """Such as m, c_x, I_xx (about the center of mass), or the joint that it belongs to."""

    theirs: Number
    """What the function must have."""

    ours: Number
    """What the robot has; null where there is none, such as a limit."""

    difference: Number
    """theirs less ours."""

    unit: str
    """Of all three."""


@dataclass(frozen=True, kw_only=True)
class DiagnosisRecord:
    """One fault."""

    function: str
    """The functions that show it."""

    kind: str
    """Its kind: docs/judge.md lists them."""

    message: str
    """What is wrong."""

    evidence: str
    """The experiments, and how many states deviate."""

    remedy: str
    """What to do about it."""

    explains: Number
    """Largest relative error, over all judged states and experiments, that is left after putting the fault and those
    named with it into graphdyn; null where there is no explanation.
    """

    standing: Literal["holds", "candidate", "part", "located", "unknown"]
    """holds: put into graphdyn, the fault gives the function's numbers at all judged states, up to the function's own
    precision; candidate: it does, and so do others that are as simple; part: it explains some of the deviation;
    located: where the deviation is, not why; unknown: no explanation.
    """

    also: Sequence[str]
    """Other faults that give the same numbers at all states tried."""

    apart: str
    """What would tell them apart; empty where there are none."""

    numbers: Sequence[FittedNumberRecord]
    """The numbers that were fitted."""


@dataclass(frozen=True, kw_only=True)
class JudgeRecord:
    """Foreign dynamics functions against graphdyn, Pinocchio and MuJoCo, and what is wrong with them."""

    format: Annotated[Literal["graphdyn judge 1"], FORMAT] = "graphdyn judge 1"

    versions: Versions = field(default_factory=versions)

    command: Command

    robot: str
    """As given."""

    verdict: Literal["agrees", "disagrees", "undecided"]
    """undecided: the referees differ among themselves."""

    agrees: bool
    """Every function agrees with every referee."""

    decided: bool
    """The referees agree among themselves."""

    joint_names: Sequence[str]
    """The order of the functions' joints."""

    chain: tuple[str, str] | None
    """Base link and tip link of the arm that was cut out; null for the whole robot."""

    frame: str | None
    """Of the functions that belong to one frame; null where none does."""

    precision: Literal["double", "single"]
    """In which the functions are said to compute."""

    external_wrenches: bool
    """Whether the functions that can take external wrenches were called with them."""

    beyond_limits: bool
    """Whether states outside the limits were added."""

    samples: int
    """Random states; special ones come on top."""

    seed: int
    """Of the random states."""

    locked: Mapping[str, float]
    """Value of each joint that is held still [rad or m]."""

    referees: Sequence[str]
    """Who took part."""

    functions: Mapping[str, FunctionRecord]
    """The judged functions, by name."""

    diagnoses: Sequence[DiagnosisRecord]
    """What is wrong; empty where nothing is."""

    notes: Sequence[str]
    """What a reader must know, for instance why a referee took no part."""


def record(judgment: Judgment, command: Sequence[str]) -> JudgeRecord:
    """A judgment but for the model."""
    return taken(
        JudgeRecord,
        judgment,
        command=command,
        verdict=judgment.verdict.lower(),
        functions={name: _function(function) for name, function in judgment.functions.items()},
        diagnoses=[_diagnosis(diagnosis) for diagnosis in judgment.diagnoses],
    )


def _diagnosis(diagnosis: Diagnosis) -> DiagnosisRecord:
    numbers = [taken(FittedNumberRecord, number, difference=number.difference) for number in diagnosis.numbers]
    return taken(DiagnosisRecord, diagnosis, numbers=numbers)


def _function(function: JudgedFunction) -> FunctionRecord:
    return taken(
        FunctionRecord,
        function,
        **{
            name: {referee: _quantiles(error) for referee, error in getattr(function, name).items()}
            for name in ("errors", "referees_differ", "backward_errors", "referees_differ_backward")
        },
        repeated=_quantiles(function.repeated),
        failures=[taken(FailedStateRecord, failure) for failure in function.failures],
        worst=taken(JudgeWorstRecord, function.worst),
    )


def _quantiles(errors: Array) -> dict[str, float]:
    return {level: float(np.quantile(errors, float(level), method="higher")) for level in LEVELS}
