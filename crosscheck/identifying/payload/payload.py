"""crosscheck.identifying.identify_payload: a load, and gains of the motors, from two recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Unpack

import numpy as np

from crosscheck.identifying.payload.fitted_currents import STATED_ERROR, FittedCurrents, in_words, problems_of
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from crosscheck.reference.subject import Robot, subject
from graphdyn import InvalidInput
from graphdyn.display import Displayed
from graphdyn.identification.currents import (
    IdentifiedLoad,
    JointGains,
    KnownLoad,
    LoadedRecording,
    TrustedGravity,
    fit_currents,
)
from graphdyn.identification.terms import Term
from urdf import Reading, ReadingKeywords

LOAD, CALIBRATION = "load", "calibration"
"""Names of the load and of one that is known, in the fit."""


@dataclass(frozen=True, eq=False, repr=False)
class IdentifiedPayload(FittedCurrents, Displayed):
    """A load and the gains.

    link: that carries the load; the parameters of the load are in its frame
    mass_given: whether the mass of the load was known, so that only gains were wanted
    """

    link: str
    mass_given: bool

    def summary(self) -> str:
        """The load and the gains, or why they are of no use."""
        load, known = self.load, int(self.gains.determined.sum())
        mass = f"{load.mass:.4g} ± {load.mass_deviation:.2g} kg on {self.link} of {self.subject.name}"
        gains = f"{known} of {len(self.joints)} gains determined"
        return "\n".join([f"load: {mass}; {gains}", *self.rejection_reasons])

    @property
    def load(self) -> IdentifiedLoad:
        """The load."""
        return self.fit.loads[LOAD]

    @cached_property
    def rejection_reasons(self) -> tuple[str, ...]:
        """Why the result is of no use; empty where it is."""
        return self.faults or self._undetermined()

    def _undetermined(self) -> tuple[str, ...]:
        """What was asked for and is not determined."""
        if self.mass_given:
            lost = [name for name, known in zip(self.joints, self.gains.determined, strict=True) if not known]
            return (f"no gain of {', '.join(lost)} is determined",) if len(lost) == len(self.joints) else ()
        mass, deviation = self.load.mass, self.load.mass_deviation
        if not np.isfinite(deviation):
            return ("nothing determines the mass: record a motion in which gravity and load change",)
        if self.load.below_zero:
            return (
                f"the mass is {mass:.3g} ± {deviation:.2g} kg, below zero: the recordings with and without the load "
                "may be exchanged",
            )
        if self.load.determined:
            return ()
        return (f"the mass, {mass:.3g} ± {deviation:.2g} kg, is not above three times its deviation",)


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
    known = in_words(known_load, gains, trusted)
    if known_load is None and gains is None and trusted is None:
        gains = JointGains.stated(np.ones(compared.model.nv), STATED_ERROR)
    if calibration is not None and known_load is None:
        raise InvalidInput("a recording with a known load is given, but not the mass of this load; give both")
    recordings = (empty, loaded) if calibration is None else (empty, loaded, calibration)
    preparation = preparation or Preparation()
    problems = problems_of(compared, recordings, terms, preparation)
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
    return IdentifiedPayload(compared, known, fit, recordings, problems, gains, preparation, carrying, given)
