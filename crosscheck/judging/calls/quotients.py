"""Derivatives by difference quotients: which ones, with which step, and where their rounding dominates.

The error of forward differences is h/2 f'', that of central ones h²/6 f''': one least squares gives the step.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.calls.answered import Answered
from crosscheck.judging.calls.difference_forms import Differences, Form, forms
from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.searching.found_fault import FoundFault
from graphdyn.layout import Array

N_TRIED_STATES = 8
"""Number of states at which the step is fitted."""

TRIAL_STEPS = {False: 1e-4, True: 2e-3}
"""Steps of forward and central differences that show the slope of their error, by whether they are central."""

MIN_CORRELATION = 0.9
"""Smallest correlation of the deviation and the error of differences: rounding may make up the rest."""

MAX_ERROR = 0.05
"""Median relative error beyond which no difference quotients are looked for: nobody takes such steps."""

MAX_STEP = 0.1
"""Largest step [rad, …/s] of difference quotients. Those of a trigonometric function are the right derivatives times
sin h / h: any factor below 1 would be a large step."""

MAX_LEFT_SHARE = 0.1
"""Part of the largest error that may be left."""

MAX_ROUNDING_SHARE = 0.5
"""Part of it that may be rounding of the differences."""

MAX_LEFT_NOISE = 10.0
"""What is left may be so many times the noise of the function."""

SHOWN_NOISE_SHARE = 1e-2
"""Part of the largest error from which on the scatter is told."""

MIN_USUAL_SHARE = 0.9
"""Part of the states at which the differences must explain the deviation; at the others they leave no more than it."""

N_REFINEMENTS = 6
"""Number of times that a large step is refined with the differences themselves."""

BEST_STEP = float(np.finfo(float).eps ** (1 / 3))
"""The step of central differences at which rounding and truncation are alike, for arguments and values near 1."""

STEP_DIGITS = 1e-2
"""Relative distance from a round step within which it is that one."""

DIFFERENTIATED = {
    "coriolis_matrix",
    "frame_jacobian",
    "frame_velocity",
    "frame_jacobian_derivative",
    "frame_acceleration",
}
"""Functions whose scatter is told as that of differences, besides the derivatives."""


def difference_quotients(given: Answered) -> FoundFault | None:
    """The differences whose errors are the deviation."""
    ways = list(forms(given.name))
    if not ways or not np.isfinite(given.answer).all():
        return None
    sizes = given.errors(given.ours)
    if not np.median(sizes) < MAX_ERROR:
        return None
    rows = np.flatnonzero(given.states.ordinary)
    rows = rows[: 2 if "parameter" in given.name else N_TRIED_STATES]
    best: FoundFault | None = None
    for form in ways:
        for by in _fitted(given, form, rows):
            found = _checked(given, form, by, float(sizes.max()))
            if found is not None and (best is None or found.left < best.left):
                best = found
        if best is not None and best.left <= given.bound:
            break
    return best


def _fitted(given: Answered, form: Form, rows: NDArray[np.intp]) -> Iterator[Differences]:
    """Differences that may be those of the function, by their errors at some states."""
    states, ours = given.states.rows(rows), given.ours[rows]
    weight = 1 / np.maximum(np.abs(ours.reshape(len(ours), -1)).max(axis=1), np.finfo(float).tiny)
    weight = weight.reshape(-1, *[1] * (ours.ndim - 1))
    deviation = (weight * (given.answer[rows] - ours)).ravel()
    for central in (True, False):
        for relative in (False, True):
            by = Differences(TRIAL_STEPS[central], central, relative)
            slope = (weight * (form(states, given.chosen, by) - ours)).ravel()
            size = float(slope @ slope)
            if not (np.isfinite(size) and size > 0 and deviation.any()):
                continue
            factor = float(slope @ deviation) / size
            correlation = factor * np.sqrt(size) / np.linalg.norm(deviation)
            if abs(correlation) < MIN_CORRELATION or (central and factor < 0):
                continue
            step = by.step * (np.sqrt(factor) if central else factor)
            step = _refined(given, form, replace(by, step=float(step)), rows, deviation, weight)
            if abs(step) <= MAX_STEP:
                yield replace(by, step=step)


def _refined(
    given: Answered, form: Form, by: Differences, rows: NDArray[np.intp], deviation: Array, weight: Array
) -> float:
    """The step, from the differences with it; small ones stay as they are, for rounding would dominate."""
    step = by.step
    states = given.states.rows(rows)
    for _ in range(N_REFINEMENTS):
        if not TRIAL_STEPS[by.central] <= abs(step) < 1:
            break
        error = (weight * (form(states, given.chosen, replace(by, step=step)) - given.ours[rows])).ravel()
        factor = float(error @ deviation) / float(error @ error)
        if factor <= 0:
            break
        step *= np.sqrt(factor) if by.central else factor
    return float(step)


def _checked(given: Answered, form: Form, by: Differences, largest: float) -> FoundFault | None:
    """The fault, if the errors of these differences are the deviation at all states."""
    states = given.states
    small = abs(by.step) < TRIAL_STEPS[by.central]
    used = replace(by, step=np.sign(by.step) * TRIAL_STEPS[by.central]) if small else by
    error = form(states, given.chosen, used) - given.ours
    expected = given.ours + (by.step / used.step) ** (2 if by.central else 1) * error
    corrected = replace(given, answer=given.answer - expected + given.ours)
    errors, before = corrected.errors(given.ours), given.errors(given.ours)
    rounding = min(MAX_LEFT_NOISE * given.noise, MAX_ROUNDING_SHARE * largest)
    room = max(given.bound, MAX_LEFT_SHARE * largest, rounding)
    usual = errors[errors <= room]  # others may be states at rest, where rounding has no size to compare with
    if len(usual) < MIN_USUAL_SHARE * len(errors) or (errors > np.maximum(room, before)).any():
        return None
    left = float(usual.max())
    kind = "central" if by.central else "forward" if by.step > 0 else "backward"
    step = _round(abs(by.step))
    said = f"the answers are {kind} differences with a step of {step:.3g}"
    said += " times the size of the argument" if by.relative else ""
    if small and given.noise > SHOWN_NOISE_SHARE * largest:
        said += f", whose rounding scatters by {given.noise:.1e}"
    best = f"{BEST_STEP:.0e}"
    advice = (
        f": too {'large' if step > BEST_STEP else 'small'}; a step near {best} fits"
        if by.central
        else f"; central differences with a step near {best} fit"
    )
    remedy = f"it is no fault of physics: take central differences with a step near {best}, or exact derivatives"
    return FoundFault(FaultDescription("difference_quotients", said + advice, remedy), left, given.chosen)


def _round(step: float) -> float:
    """The step with one digit, where it is that within the accuracy of a fit."""
    short = float(f"{step:.0e}")
    return short if abs(step - short) <= STEP_DIGITS * step else step


def scattered_differences(given: Answered, tolerance: float) -> FoundFault | None:
    """Answers of a derivative that deviate by no more than they scatter, in double precision."""
    derived = given.name in DIFFERENTIATED or given.name.startswith("d") or "jacobian" in given.name
    derived = (
        derived or given.name in ("gravity_torque", "mass_matrix", "mass_matrix_inverse") or "derivatives" in given.name
    )
    errors = given.errors(given.ours)
    single = np.array_equal(given.answer, given.answer.astype(np.float32))
    if not derived or single or given.noise <= tolerance / 10 or np.median(errors) > 10 * given.noise:
        return None
    step = np.finfo(float).eps / given.noise
    message = (
        f"the answers scatter by {given.noise:.1e} from one state to the next, as difference quotients with a step of "
        f"about {step:.0e} do: too small, rounding divided by the step dominates; central differences with a step near "
        f"{BEST_STEP:.0e} fit"
    )
    remedy = "it is no fault of physics: take a larger step, or exact derivatives"
    return FoundFault(FaultDescription("difference_quotients", message, remedy), float(errors.max()), given.chosen)
