"""The searches for what is no formula, one after the other, the cheap and certain ones first."""

from __future__ import annotations

from crosscheck.judging.calls.answered import Answered
from crosscheck.judging.calls.clipping import clipped
from crosscheck.judging.calls.quotients import difference_quotients, scattered_differences
from crosscheck.judging.calls.solvers import residual_said, stopped_early
from crosscheck.judging.calls.velocity_units import velocity_unit
from crosscheck.judging.searching.found_fault import FoundFault


def found_in_calls(given: Answered, tolerance: float) -> FoundFault | None:
    """The first that gives the answers. tolerance: the relative error that counts as agreement"""
    return (
        velocity_unit(given)
        or scattered_differences(given, tolerance)
        or difference_quotients(given)
        or stopped_early(given)
        or clipped(given)
    )


def told_of_calls(given: Answered) -> FoundFault | None:
    """What is said where nothing else explains the answers."""
    return residual_said(given)
