"""The answer of crosscheck.judge: plain data, and whether the functions agree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from crosscheck.judging.exact_errors import ExactErrors
from crosscheck.reference.subject import OfReading
from graphdyn import RobotModel
from graphdyn.display import Displayed, short_repr
from graphdyn.layout import Array
from graphdyn.tables import data_frame
from urdf import Reading

if TYPE_CHECKING:
    import pandas

UNCOUPLED = "joints that others drive are judged as if they were independent"
"""A note about a robot with couplings: other codes see it so."""


@dataclass(frozen=True)
class WorstCall:
    """A state at which a function under test deviates from graphdyn, the worst or the smallest one, with both answers.

    arguments: what the function was called with, by name, in its own joint order
    expected, answer: flattened values of graphdyn and of the function under test, both in the model's joint order
    """

    arguments: Mapping[str, tuple[float, ...]]
    expected: tuple[float, ...]
    answer: tuple[float, ...]


def infinite_where_nan(errors: Array) -> Array:
    """Errors that are no numbers count as infinite."""
    return np.where(np.isnan(errors), np.inf, errors)


def largest_errors(errors: Mapping[str, Array], backward_errors: Mapping[str, Array]) -> Array:
    """Against graphdyn, the larger one of error and backward error of each state (N,)."""
    ours = errors["graphdyn"]
    return np.maximum(ours, backward_errors.get("graphdyn", ours))


@dataclass(frozen=True)
class FailedState:
    """A state at which a function under test gave no answer.

    number: of the state, from 0; message: what the function did, with the arguments
    """

    number: int
    message: str


@dataclass(frozen=True, eq=False)
@short_repr
class JudgedFunction:
    """One function under test against every reference implementation ("reference").

    name: one of those in docs/judge.md
    errors: relative error per answered state (N,) against each reference: "graphdyn", "pinocchio", "mujoco"
    references_differ: relative error per state (N,) of each other reference against graphdyn
    bound: of all errors; scale: what they are relative to, in words
    backward_errors: of accelerations, per reference: its torques at the answered accelerations against the given
        torques
        (N,); empty for other functions
    references_differ_backward: the same of the accelerations of each other reference, by graphdyn's torques
    backward_scale: what backward errors are relative to, in words
    repeated: relative difference per answered state (N,) of a second answer to the same question, asked in the reverse
        order; a function that keeps nothing between calls has zeros
    conventions: those that the answers follow, where several are right: {"reference": "local"}
    failures: the states without an answer, which are in none of the errors
    code: Python that computes graphdyn's answer at one state by the same conventions; None where there is none
    smallest: the call with the fewest numbers other than zero at which it deviates; None where no single call does
    exact: the errors against exact values, where these were asked for or were needed to decide
    """

    name: str
    errors: Mapping[str, Array]
    references_differ: Mapping[str, Array]
    bound: float
    scale: str
    worst: WorstCall
    backward_errors: Mapping[str, Array] = field(default_factory=dict)
    references_differ_backward: Mapping[str, Array] = field(default_factory=dict)
    backward_scale: str = ""
    repeated: Array = field(default_factory=lambda: np.zeros(1))
    conventions: Mapping[str, str] = field(default_factory=dict)
    failures: tuple[FailedState, ...] = ()
    code: str | None = None
    smallest: WorstCall | None = None
    exact: ExactErrors | None = None

    @property
    def agrees(self) -> bool:
        """Whether its answers are right, and the same when asked again.

        NaN is not agreement, nor is a missing answer.
        """
        return self.right_where_answered and self.repeats and not self.failures

    @property
    def right_where_answered(self) -> bool:
        """Whether the answers that there are agree with every reference, forward and backward; or with exact values,
        where these decide."""
        if self.exact is not None and self.decided_by_proof:
            return not self.exact.wrong and all(bool(np.isfinite(error).all()) for error in self.errors.values())
        return self.within(self.errors) and self.within(self.backward_errors)

    @property
    def decided_by_proof(self) -> bool:
        """Whether exact values decide: they were asked for, or the references disagree with one another."""
        return self.exact is not None and (self.exact.everywhere or not self.references_agree)

    @property
    def decided(self) -> bool:
        """Whether there is a verdict."""
        return self.references_agree or self.exact is not None

    @property
    def wrong_by_proof_alone(self) -> bool:
        """Whether nothing but exact values tells that it is wrong: faults are then too small to be looked for."""
        others = self.within(self.errors) and self.within(self.backward_errors) and self.repeats and not self.failures
        return not self.agrees and self.references_agree and others

    @property
    def repeats(self) -> bool:
        """Whether it agrees with itself when asked again."""
        return self.within({"again": self.repeated})

    @property
    def references_agree(self) -> bool:
        """Whether the references agree with one another."""
        return self.within(self.references_differ) and self.within(self.references_differ_backward)

    @property
    def largest_errors(self) -> Array:
        """Against graphdyn, the larger one of error and backward error of each state (N,)."""
        return largest_errors(self.errors, self.backward_errors)

    def within(self, errors: Mapping[str, Array]) -> bool:
        """Whether errors per reference are within the bound at all states."""
        return all(bool((error <= self.bound).all()) for error in errors.values())


DiagnosisStatus = Literal["confirmed", "candidate", "part", "located", "unknown"]


@dataclass(frozen=True)
class FittedNumber:
    """A number of the robot as the user code must have it.

    name: such as m, c_x, I_xx (about the center of mass), or the joint that it belongs to
    theirs: what the function must have; ours: what the robot has, NaN where there is none, such as a limit
    unit: of both
    """

    name: str
    theirs: float
    ours: float
    unit: str

    @property
    def difference(self) -> float:
        """Theirs less ours."""
        return self.theirs - self.ours


@dataclass(frozen=True)
@short_repr
class Diagnosis:
    """What is wrong with a function under test, and the experiment that shows it.

    function: the functions that show it
    kind: one of the table in docs/judge.md, or unknown
    message: one sentence that names the joint, the body, the term
    evidence: the experiment and its numbers
    remedy: what to do about it
    explains: largest relative error that is left, at all judged states and in all experiments, after putting this fault
        and those named with it into graphdyn; NaN where there is no explanation
    status: confirmed: put into graphdyn, the fault gives the function's numbers at all judged states, up to its own
        precision; candidate: it does, and so do others that are as simple; part: it explains some of the deviation;
        located: where the deviation is, not why; unknown: no explanation
    also: other faults that give the same numbers at all states tried
    apart: what would tell them apart; empty where there are none
    numbers: those that were fitted, theirs and ours
    """

    function: str
    kind: str
    message: str
    evidence: str
    remedy: str
    explains: float
    status: DiagnosisStatus = "confirmed"
    also: tuple[str, ...] = ()
    apart: str = ""
    numbers: tuple[FittedNumber, ...] = ()


@dataclass(frozen=True, eq=False, repr=False)
class Judgment(OfReading, Displayed):
    """The verdict on functions under test for one robot.

    robot: as given; file: whole path of its URDF, None where a RobotModel was given; model: the robot that was loaded
    joint_names: the order in which the functions take and return joint quantities
    samples: random states; special ones come on top
    seed: of the random states
    functions: the judged ones, by name
    diagnoses: what is wrong; empty where nothing is
    reading: how the file was read; frame: of the functions that belong to one
    precision: in which the functions are said to compute; external_wrenches: whether they were called with them
    beyond_limits: whether states outside the limits were added
    references: "graphdyn", "pinocchio", and "mujoco" where it is installed and can represent the robot
    notes: what the reader must know (a reference that cannot represent the robot, …)
    """

    robot: str
    file: str | None
    model: RobotModel
    joint_names: tuple[str, ...]
    samples: int
    seed: int
    reading: Reading
    references: tuple[str, ...]
    functions: Mapping[str, JudgedFunction]
    diagnoses: tuple[Diagnosis, ...]
    notes: tuple[str, ...]
    frame: str | None = None
    precision: str = "double"
    external_wrenches: bool = False
    beyond_limits: bool = False

    def summary(self) -> str:
        """The verdict, the largest error of every function, and the diagnoses."""
        head = f"{', '.join(self.functions)} on {self.robot}: {self.verdict} with {', '.join(self.references)}"
        errors = [
            f"{name}: largest error {max(map(np.max, function.errors.values())):.1e}, bound {function.bound:.1e}"
            for name, function in self.functions.items()
        ]
        return "\n".join([head, *errors, *(f"{one.status}: {one.message}" for one in self.diagnoses), *self.notes])

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every function and reference: verdict, largest error, bound.

        Raises ImportError where pandas is missing.
        """
        rows = [(function, name) for function in self.functions.values() for name in function.errors]
        columns = {
            "reference": [name for _, name in rows],
            "agrees": [bool((function.errors[name] <= function.bound).all()) for function, name in rows],
            "largest error": [float(function.errors[name].max()) for function, name in rows],
            "bound": [function.bound for function, _ in rows],
        }
        return data_frame(columns, [function.name for function, _ in rows], "function")

    @property
    def agrees(self) -> bool:
        """Whether every function is right."""
        return all(function.agrees for function in self.functions.values())

    @property
    def decided(self) -> bool:
        """Whether there is a verdict on every function."""
        return all(function.decided for function in self.functions.values())

    @property
    def verdict(self) -> Literal["agrees", "DISAGREES", "UNDECIDED"]:
        """UNDECIDED where the reference implementations differ among themselves, and no exact values decide."""
        if not self.decided:
            return "UNDECIDED"
        return "agrees" if self.agrees else "DISAGREES"
