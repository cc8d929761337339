"""Velocities in degrees per second, of functions of any kind: positions and accelerations are in radians."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.judging.calls.answered import Answered
from crosscheck.judging.faults.fault import FaultDescription, joints_said
from crosscheck.judging.searching.found_fault import FIRST_TRIAL_STATES, FoundFault
from graphdyn.layout import Array

VELOCITY_UNIT_REMEDY = "convert to rad/s when they are read"

WAYS = {
    np.pi / 180: "are taken as degrees per second",
    180 / np.pi: "are in rad/s and converted to degrees per second",
}
"""What a code does to the velocities, in words, by its factor."""


def velocity_unit(given: Answered) -> FoundFault | None:
    """Velocities of all turning joints, or of one, that are multiplied by a factor of degrees."""
    if "v" not in given.function.arguments:
        return None
    few = given.at(np.arange(min(FIRST_TRIAL_STATES, len(given.states.q))))
    for scale, message, alone in _scales(given):
        for chosen in [given.chosen] if alone else given.known.readings(given.declared):
            here = given.known.of_graphdyn(few.states.but(v=scale * few.states.v), chosen)
            if few.errors(here, chosen).max() <= given.bound:
                changed = given.states.but(v=scale * given.states.v)
                left = float(given.errors(given.known.of_graphdyn(changed, chosen), chosen=chosen).max())
                if left <= given.bound:
                    return FoundFault(FaultDescription("unit", message, VELOCITY_UNIT_REMEDY), left, chosen)
    return None


def _scales(given: Answered) -> Iterator[tuple[Array, str, bool]]:
    """Factors on the velocities (n,), a message, and whether it is of one joint."""
    model = given.states.model
    turning = [k for k, joint in enumerate(model.joints) if not joint.is_prismatic]
    every = "joint velocities" if len(turning) == model.n_bodies else "velocities of turning joints"
    for joints in [turning, *([k] for k in turning if len(turning) > 1)]:
        for factor, said in WAYS.items():
            scale = np.where(np.isin(np.arange(model.n_bodies), joints), factor, 1.0)
            who = every if joints is turning else f"velocities of {joints_said(model, joints)}"
            yield scale, f"{who} {said}", joints is not turning
