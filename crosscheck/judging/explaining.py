"""What is wrong with a foreign function whose answers deviate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from crosscheck.judging.columns import column_fault
from crosscheck.judging.diagnosis import diagnose
from crosscheck.judging.foreign import ForeignFunction
from crosscheck.judging.judgement import Diagnosis
from crosscheck.judging.observing import observe
from crosscheck.judging.verdicts import Judged
from graphdyn.layout import Array


def diagnoses_of(function: ForeignFunction, found: Judged, links: Mapping[str, tuple[int, Array]]) -> list[Diagnosis]:
    """links: fixed links by name, as crosscheck.judging.faults.all_faults takes them."""
    name, states, verdict = function.name, found.states, found.verdict
    wrong = verdict.largest_errors > verdict.bound
    count = f"{int(wrong.sum())} of {len(wrong)} states deviate"
    if name == "regressor" and (fault := column_fault(found.answer, found.ours)):
        return [
            Diagnosis(
                name, fault.kind, fault.message, f"columns compared one by one; {count}", fault.remedy, fault.left
            )
        ]
    torque = np.maximum(np.sqrt(np.mean(states.inverse.tau**2, axis=0)), np.finfo(float).tiny)
    try:
        observed = observe(function, states.model, states.trial, torque)
    except np.linalg.LinAlgError:
        message = "the accelerations do not determine a mass matrix: M⁻¹ from unit torques is singular"
        return [Diagnosis(name, "unknown", message, count, "ask it for accelerations at unit torques", np.inf)]
    if observed is None:
        return [Diagnosis(name, "unknown", "the answers deviate", count, "look at the worst state", np.inf)]
    found_faults = diagnose(name, observed, states.model, states.trial, links)
    if found_faults:
        return [replace(diagnosis, evidence=f"{diagnosis.evidence}; {count}") for diagnosis in found_faults]
    message = "gravity, mass matrix and velocity terms are right separately; only certain states or their sum deviate"
    return [Diagnosis(name, "unknown", message, count, "look at the worst state", np.inf)]
