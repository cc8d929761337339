"""The methods of a study, by name or as FILE.py:NAME, given what they need of a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from crosscheck.identifying import method_named
from crosscheck.identifying.methods.loop_methods import in_loop
from crosscheck.study.settings.method_names import takes_wrenches
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.simulated.runs import Record
from crosscheck.user_code import module_of_file
from graphdyn.identification import Estimator

TORQUES, WRENCHES = "torques", "wrenches"
"""What a method takes for measured."""


def estimator_of(method: str) -> Estimator:
    """A new one. Raises whatever a file of one's own raises."""
    where, colon, name = method.rpartition(":")
    if not colon:
        return method_named(method)
    made: Estimator = getattr(_module(where), name)()
    return made


def taking_part(methods: Sequence[str], scenario: Scenario) -> tuple[str, ...]:
    """All, or, where the scenario has no wrenches, those that need none."""
    measured = scenario.force_noise is not None
    return tuple(method for method in methods if measured or not takes_wrenches(estimator_of(method)))


def measures(estimator: Estimator) -> str:
    """What the method measures, in one of these words."""
    return WRENCHES if takes_wrenches(estimator) else TORQUES


def ready(estimator: Estimator, record: Record, scenario: Scenario) -> Estimator:
    """The estimator with the loop, the start of its iteration, and the recording, as far as it has a use for them."""
    (known,) = in_loop([estimator], record.loop)
    given: dict[str, Any] = {}
    if hasattr(known, "start"):
        error = scenario.start_error
        given["start"] = scenario.start if error is None else (1 - error) * record.truth
    if takes_wrenches(known):
        given["recording"] = record.recording
    fitted: Estimator = replace(known, **given) if given else known  # type: ignore[type-var]
    return fitted


@cache
def _module(path: str) -> ModuleType:
    return module_of_file(Path(path))
