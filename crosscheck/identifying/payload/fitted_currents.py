"""Gains found from recordings of currents: how well they fit, and what speaks against them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from crosscheck.identifying.data_quality.data_quality import data_quality
from crosscheck.identifying.methods.torque_terms import STANDARD_TERM_NAMES, friction_terms
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from crosscheck.reference.subject import IDENTIFY_CLOSED, Subject, refuse_chords
from graphdyn import InvalidInput
from graphdyn.display import short_repr
from graphdyn.identification import (
    MIN_CORRELATION_TIMES,
    MIN_MOVING_SPEED,
    Problem,
    ResidualStatistics,
    Samples,
    TorqueModel,
    residual_statistics,
    structure,
)
from graphdyn.identification.currents import CurrentFit, JointGains, KnownLoad, TrustedGravity
from graphdyn.identification.terms import RigidBodies, Term
from graphdyn.layout import Array

STATED_ERROR = 0.05
"""Relative standard deviation of gains that come without one: what data sheets of drives state is good to that."""

CONTRADICTION = 3.0
"""Stated standard deviations by which a found gain may differ from the stated one."""

OF_GAINS = ("scaled-torque", "torque-unit", "reversed-torque", "all-torques-reversed")
"""Findings of data quality that the gains say themselves."""

MIN_UNRELATED_RESIDUAL = 0.9
"""Residual of a current, relative to its deviation from its mean, from which the motion explains nothing of it."""


@dataclass(frozen=True, eq=False)
@short_repr
class FittedCurrents:
    """Gains found from recordings of currents, the load if one was carried, and how well they fit.

    subject: the robot
    known: what determined the size of torques, in words
    fit: gains, links, load
    recordings: as read; problems: their equations
    stated: gains that were known beforehand, None if none were
    preparation: of the recordings
    """

    subject: Subject
    known: str
    fit: CurrentFit
    recordings: tuple[Recording, ...]
    problems: tuple[Problem, ...]
    stated: JointGains | None
    preparation: Preparation

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints (n,)."""
        return self.subject.model.independent_joints

    @property
    def names(self) -> tuple[str, ...]:
        """Files of the recordings."""
        return tuple(", ".join(recording.provenance.files) for recording in self.recordings)

    @property
    def gains(self) -> JointGains:
        """Torque per unit of the recorded column."""
        return self.fit.gains

    @cached_property
    def relative_residuals(self) -> Array:
        """‖e‖ / ‖c‖ over the moving rows of every recording and joint (k, n); NaN without such rows."""
        return np.array(
            [[of_joint.moving.relative[j] for j, of_joint in enumerate(statistics)] for statistics in self._statistics]
        )

    @cached_property
    def correlation_times(self) -> float:
        """Length of the shortest recording in correlation times of its slowest residual."""
        return min(
            float(of_joint.everything.count[j] / of_joint.correlation_length[j])
            if of_joint.correlation_length[j] > 0
            else np.inf
            for statistics in self._statistics
            for j, of_joint in enumerate(statistics)
        )

    @property
    def lower_bound(self) -> bool:
        """Whether the recordings are too short for standard deviations from time blocks."""
        return self.correlation_times < MIN_CORRELATION_TIMES

    @cached_property
    def _statistics(self) -> list[list[ResidualStatistics]]:
        """Residuals of every recording, with the parameters of each joint applied to all."""
        found = []
        for problem, currents in zip(self.problems, self.fit.currents, strict=True):
            parameters = np.zeros((len(currents), len(problem.torque_model.columns)))
            parameters[:, problem.structure.base.independent] = currents
            found.append(residual_statistics(problem, parameters))
        return found

    @cached_property
    def faults(self) -> tuple[str, ...]:
        """What makes the gains useless, each with its remedy; empty if nothing does."""
        if still := [name for name, joints in zip(self.names, self._still, strict=True) if joints.all()]:
            return (f"no joint moves in {', '.join(still)}: record a motion of all joints",)
        against, others = self._reversed(), (*self._contradicted(), *self._unrelated())
        causes = tuple(self._causes()) if others else ()
        return (*against, *(causes or others))

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Currents that say nothing, and joints that do not move."""
        found = []
        for name, recording, at_rest in zip(self.names, self.recordings, self._still, strict=True):
            tau = recording.channel("tau")
            dead = np.ptp(tau, axis=0) == 0
            for j, joint in enumerate(self.joints):
                if dead[j]:
                    found.append(f"the current of {joint} does not change in {name}: the joint is left out there")
            still = [joint for joint, one in zip(self.joints, at_rest, strict=True) if one]
            if still:
                found.append(
                    f"{', '.join(still)} does not move in {name}: what it carries there cannot be told from its "
                    "friction and offset; record a motion of all joints"
                )
        return tuple(found)

    def _reversed(self) -> tuple[str, ...]:
        """Currents that run against their torques."""
        seen = self.gains.determined & np.any(np.isfinite(self.fit.noise) & ~self._still, axis=0)
        against = self.fit.reversed & seen
        names = [name for name, one in zip(self.joints, against, strict=True) if one]
        if not names:
            return ()
        if np.array_equal(against, seen):
            return (
                "every current runs against its torque: the recordings with and without the load are exchanged, or all "
                "columns have the other sign",
            )
        return (f"the current of {', '.join(names)} runs against the torque: reverse its sign in the mapping",)

    def _contradicted(self) -> tuple[str, ...]:
        """Gains that are too far from those that were stated."""
        if self.stated is None:
            return ()
        both = self.stated.determined & self.gains.determined
        with np.errstate(invalid="ignore"):
            ratios = self.gains.values / self.stated.values
            far = both & (np.abs(np.log(ratios)) > CONTRADICTION * self.stated.relative_deviations)
        triples = zip(self.joints, ratios, far, strict=True)
        sizes = [f"{name} ({ratio:.3g} times)" for name, ratio, one in triples if one]
        if not sizes:
            return ()
        return (
            f"the gains found are not those that were stated: {', '.join(sizes)}; the columns may be currents, or of "
            "other gears: give a load of known mass, or the gains",
        )

    def _unrelated(self) -> tuple[str, ...]:
        """Currents that no motion explains."""
        found = []
        for name, problem, residual in zip(self.names, self.problems, self._residual_sizes, strict=True):
            size = np.concatenate([_filtered(piece) for piece in _pieces(problem)]).std(axis=0)
            for j, joint in enumerate(self.joints):
                if residual[j] > MIN_UNRELATED_RESIDUAL * size[j] > 0:
                    found.append(
                        f"the motion explains less than {100 * (1 - MIN_UNRELATED_RESIDUAL):.0f} % of the current of "
                        f"{joint} in {name}: check its column; `graphdyn identify` looks for exchanged ones"
                    )
        return tuple(found)

    def _causes(self) -> Iterator[str]:
        """Faults of the columns that the equations of motion show, in torques by the gains that were stated."""
        if self.stated is None or not self.stated.determined.all():
            return
        for name, recording, problem in zip(self.names, self.recordings, self.problems, strict=True):
            torques = recording.take(slice(None), tau=recording.channel("tau") * self.stated.values)
            found = data_quality(problem.torque_model, [torques], self.preparation)
            for finding in found.faults if found is not None else ():
                if finding.code not in OF_GAINS:
                    yield f"{name}: {finding.message}"

    @cached_property
    def _still(self) -> NDArray[np.bool_]:
        """Whether a joint stands still in a recording (k, n)."""
        speeds = [
            np.max([np.abs(piece.v).max(axis=0) for piece in _pieces(problem)], axis=0) for problem in self.problems
        ]
        return np.array(speeds) <= MIN_MOVING_SPEED

    @cached_property
    def _residual_sizes(self) -> Array:
        """Root mean squares of the residuals of every recording and joint (k, n)."""
        return np.array([[one.everything.rms[j] for j, one in enumerate(of)] for of in self._statistics])


def _pieces(problem: Problem) -> list[Samples]:
    """The samples of a problem of Preparation."""
    return cast(list[Samples], problem.data)


def _filtered(samples: Samples) -> Array:
    """The currents as they are fitted."""
    return np.asarray(samples.tau if samples.row_filter is None else samples.row_filter(samples.tau))


def problems_of(
    compared: Subject, recordings: Sequence[Recording], terms: Sequence[Term] | None, preparation: Preparation
) -> tuple[Problem, ...]:
    """The equations of every recording, with one torque model. Raises InvalidInput for recordings of other joints."""
    refuse_chords(compared.model, IDENTIFY_CLOSED)
    for recording in recordings:
        if recording.joint_names != compared.model.independent_joints:
            raise InvalidInput(
                f"{', '.join(recording.provenance.files)} has the joints {', '.join(recording.joint_names)}, the robot "
                f"has {', '.join(compared.model.independent_joints)}; load it with joints=model.independent_joints"
            )
    terms = friction_terms(STANDARD_TERM_NAMES) if terms is None else terms
    torque_model = TorqueModel(compared.model, (RigidBodies(), *terms))
    structure(torque_model)
    prepared = map(preparation.differentiated, recordings)
    return tuple(preparation.problem(torque_model, recording) for recording in prepared)


def in_words(known_load: KnownLoad | None, gains: JointGains | None, gravity: TrustedGravity | None) -> str:
    """What determines the size of torques."""
    parts = []
    if known_load is not None:
        parts.append(f"a load of {known_load.mass:g} kg")
    if gains is not None:
        known = gains.relative_deviations[gains.determined]
        ends = dict.fromkeys(f"{100 * end:.2g}" for end in (known.min(), known.max())) if known.size else {}
        parts.append(f"gains within {' to '.join(ends)} %" if ends else "no gain")
    if gravity is not None:
        parts.append(f"gravity of the links of the file, within {100 * gravity.error:g} %")
    return " and ".join(parts) or f"torques as recorded, right to {100 * STATED_ERROR:g} %"
