"""crosscheck.identifying.identify_payload: a load, and gains of the motors, from two recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Unpack

import numpy as np

from crosscheck.identifying.methods.torque_terms import STANDARD_TERM_NAMES, friction_terms
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from crosscheck.reference.subject import IDENTIFY_CLOSED, Robot, Subject, refuse_chords, subject
from graphdyn import InvalidInput
from graphdyn.identification import (
    MIN_CORRELATION_TIMES,
    Problem,
    ResidualStatistics,
    TorqueModel,
    residual_statistics,
    structure,
)
from graphdyn.identification.currents import (
    CurrentFit,
    IdentifiedLoad,
    JointGains,
    KnownLoad,
    LoadedRecording,
    TrustedGravity,
    fit_currents,
)
from graphdyn.identification.terms import RigidBodies, Term
from graphdyn.layout import Array
from urdf import Reading, ReadingKeywords

STATED_ERROR = 0.05
"""Relative standard deviation of gains that come without one: what data sheets of drives state is good to that."""

CONTRADICTION = 3.0
"""Stated standard deviations by which a found gain may differ from the stated one."""

LOAD, CALIBRATION = "load", "calibration"
"""Names of the load and of one that is known, in the fit."""


@dataclass(frozen=True, eq=False)
class FittedCurrents:
    """Gains found from recordings of currents, the load if one was carried, and how well they fit.

    subject: the robot
    known: what determined the size of torques, in words
    fit: gains, links, load
    recordings: as read; problems: their equations
    """

    subject: Subject
    known: str
    fit: CurrentFit
    recordings: tuple[Recording, ...]
    problems: tuple[Problem, ...]

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


@dataclass(frozen=True, eq=False)
class IdentifiedPayload(FittedCurrents):
    """A load and the gains.

    link: that carries the load; the parameters of the load are in its frame
    mass_given: whether the mass of the load was known, so that only gains were wanted
    stated: gains that were known beforehand, None if none were
    """

    link: str
    mass_given: bool
    stated: JointGains | None

    @property
    def load(self) -> IdentifiedLoad:
        """The load."""
        return self.fit.loads[LOAD]

    @property
    def rejection_reasons(self) -> tuple[str, ...]:
        """Why the result is of no use; empty where it is."""
        if self._contradicted:
            sizes = ", ".join(f"{name} ({ratio:.3g} times)" for name, ratio in self._contradicted.items())
            return (
                f"the gains found are not those that were stated: {sizes}; the columns may be currents, or of other "
                "gears: give a load of known mass, or the gains",
            )
        if self.mass_given:
            lost = [name for name, known in zip(self.joints, self.gains.determined, strict=True) if not known]
            return (f"no gain of {', '.join(lost)} is determined",) if len(lost) == len(self.joints) else ()
        if self.load.determined:
            return ()
        return (
            f"the mass, {self.load.mass:.3g} ± {self.load.mass_deviation:.2g} kg, is not above twice its deviation",
        )

    @cached_property
    def _contradicted(self) -> dict[str, float]:
        """Found over stated gains, of the joints where they are too far apart."""
        if self.stated is None:
            return {}
        both = self.stated.determined & self.gains.determined
        with np.errstate(invalid="ignore"):
            ratios = self.gains.values / self.stated.values
            far = np.abs(np.log(ratios)) > CONTRADICTION * self.stated.relative_deviations
        return {name: float(ratio) for name, ratio, one in zip(self.joints, ratios, both & far, strict=True) if one}


def identify_payload(
    robot: Robot,
    empty: Recording,
    loaded: Recording,
    *,
    known_load: KnownLoad | None = None,
    calibration: Recording | None = None,
    gains: JointGains | None = None,
    trusted: TrustedGravity | None = None,
    link: str | None = None,
    terms: Sequence[Term] | None = None,
    preparation: Preparation | None = None,
    **reading: Unpack[ReadingKeywords],
) -> IdentifiedPayload:
    """Identify a load from a recording without and one with it, or gains of the motors from a load that is known.

    The torques of the recordings may be currents: any signal that is proportional to the torque of its joint.

    empty, loaded: recordings of the same arm; their motions may differ
    known_load: the load of `calibration`; without one, that of `loaded`
    calibration: a recording with the known load; that of `loaded` is then found by the gains
    gains, trusted: what is known besides; without any of the three, the torques as recorded, right to STATED_ERROR
    link: that carries the load, the last one if left out
    terms: friction, with parameters of its own in each recording; viscous, Coulomb and offset if left out
    preparation: filter, decimation, smallest speed

    Raises InvalidInput for recordings of other joints or without torque, for an unknown link, and for a robot without
    mass or with loops; EstimationFailed where the fit does not settle; urdf's errors.
    """
    compared = subject(robot, Reading.of(identify_payload, reading))
    known = _in_words(known_load, gains, trusted)
    if known_load is None and gains is None and trusted is None:
        gains = JointGains.stated(np.ones(compared.model.nv), STATED_ERROR)
    if calibration is not None and known_load is None:
        raise InvalidInput("a recording with a known load is given, but not the mass of this load; give both")
    recordings = (empty, loaded) if calibration is None else (empty, loaded, calibration)
    problems = _problems(compared, recordings, terms, preparation)
    weighed = LOAD if calibration is None else CALIBRATION
    fit = fit_currents(
        problems[0].torque_model,
        [
            LoadedRecording(problem.recorded, load)
            for problem, load in zip(problems, (None, LOAD, CALIBRATION), strict=False)
        ],
        carrier=link,
        gains=gains,
        known_loads={weighed: known_load} if known_load is not None else None,
        gravity=trusted,
    )
    carrying = compared.model.body_names[-1] if link is None else link
    given = known_load is not None and calibration is None
    return IdentifiedPayload(compared, known, fit, recordings, problems, carrying, given, gains)


def identify_gains(
    robot: Robot,
    recordings: Sequence[Recording],
    trusted: TrustedGravity,
    *,
    terms: Sequence[Term] | None = None,
    preparation: Preparation | None = None,
    **reading: Unpack[ReadingKeywords],
) -> FittedCurrents:
    """Identify the gains of the motors from the gravity of links that are trusted.

    recordings, terms, preparation: as in identify_payload. Raises likewise.
    """
    compared = subject(robot, Reading.of(identify_gains, reading))
    problems = _problems(compared, recordings, terms, preparation)
    blocks = [LoadedRecording(problem.recorded) for problem in problems]
    fit = fit_currents(problems[0].torque_model, blocks, gravity=trusted)
    return FittedCurrents(compared, _in_words(None, None, trusted), fit, tuple(recordings), problems)


def _problems(
    compared: Subject, recordings: Sequence[Recording], terms: Sequence[Term] | None, preparation: Preparation | None
) -> tuple[Problem, ...]:
    """The equations of every recording, with one torque model."""
    refuse_chords(compared.model, IDENTIFY_CLOSED)
    preparation = preparation or Preparation()
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


def _in_words(known_load: KnownLoad | None, gains: JointGains | None, gravity: TrustedGravity | None) -> str:
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
