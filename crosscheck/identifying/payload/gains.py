"""crosscheck.identifying.identify_gains: gains of the motors from recordings, and recordings converted by them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

from crosscheck.identifying.payload.fitted_currents import FittedCurrents, in_words, problems_of
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from crosscheck.reference.subject import Robot, subject
from graphdyn import InvalidInput
from graphdyn.identification.currents import JointGains, KnownLoad, LoadedRecording, TrustedGravity, fit_currents
from graphdyn.identification.terms import Term
from urdf import Reading, ReadingKeywords

KNOWN_LOAD = "known"
"""Name of the known load in the fit."""


def identify_gains(
    robot: Robot,
    recordings: Sequence[Recording],
    trusted: TrustedGravity | None = None,
    *,
    gains: JointGains | None = None,
    known_load: KnownLoad | None = None,
    loaded: Recording | None = None,
    link: str | None = None,
    terms: Sequence[Term] | None = None,
    preparation: Preparation | None = None,
    **reading: Unpack[ReadingKeywords],
) -> FittedCurrents:
    """Identify the gains of the motors from recordings of currents and from what is known.

    recordings: of the arm as it is
    trusted: gravity of its links; gains: known beforehand
    known_load, loaded: a load, and a recording of the same arm with it
    link: that carries the load, the last one if left out
    terms, preparation: as in identify_payload. Raises likewise; InvalidInput where nothing is known.
    """
    compared = subject(robot, Reading.of(identify_gains, reading))
    if (known_load is None) != (loaded is None):
        raise InvalidInput("a known load and a recording with it belong together; give both")
    every = [*recordings, *([loaded] if loaded is not None else [])]
    preparation = preparation or Preparation()
    problems = problems_of(compared, every, terms, preparation)
    carried = [*[None] * len(recordings), KNOWN_LOAD]
    fit = fit_currents(
        problems[0].torque_model,
        [LoadedRecording(problem.recorded, load) for problem, load in zip(problems, carried, strict=False)],
        carrier=link,
        gains=gains,
        known_loads={KNOWN_LOAD: known_load} if known_load is not None else None,
        gravity=trusted,
    )
    return FittedCurrents(
        compared, in_words(known_load, gains, trusted), fit, tuple(every), problems, gains, preparation
    )


def as_torques(recording: Recording, found: FittedCurrents) -> Recording:
    """The recording with torques in place of currents.

    Raises InvalidInput where a gain is not determined, or something speaks against the gains.
    """
    if found.faults:
        raise InvalidInput("; ".join(found.faults))
    lost = [name for name, known in zip(found.joints, found.gains.determined, strict=True) if not known]
    if lost:
        names = ", ".join(lost)
        listed = ", ".join(f'"{name}"' for name in lost)
        raise InvalidInput(
            f"nothing fixes the gain of {names}: not {found.known}; the gain scales together with the parameters of "
            "all links that the joint moves. Give it too, for instance from its data sheet, in a file with "
            f"joints = [{listed}]"
        )
    values = found.gains.values
    step = f"torques from currents, by gains of {', '.join(f'{value:.4g}' for value in values)} from {found.known}"
    return recording.take(slice(None), step, tau=recording.channel("tau") * values)
