"""Findings about recordings in which something changed, and hints of delays."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.identifying.data_quality.finding import QualityFinding, finding_of
from crosscheck.identifying.data_quality.remedies import change_in_words
from graphdyn.identification.data_quality import Change, RecordingQuality

HALVES = ("first", "second")


def findings_of_halves(found: RecordingQuality) -> Iterator[QualityFinding]:
    """What changed in between, the faults of one half, and what is doubtful."""
    for j in np.flatnonzero(found.contradictions.any(axis=0)).tolist():
        name = found.joint_names[j]
        common, own = found.halves[:, 0, j], found.halves[:, 1, j]
        half = int(np.argmax(common / own))
        message = (
            f"the two halves of the recording contradict each other at {name}: {100 * common[half]:.3g} % in the "
            f"{HALVES[half]} half by the common fit, {100 * own[half]:.3g} % by its own"
        )
        remedy = "something changed in between (load, sign, controller, slipping belt): use one part, by --split"
        yield QualityFinding("halves", "fault", (name,), message, remedy)
    for which, faults in zip(HALVES, found.half_faults, strict=True):
        for fault in faults:
            remedy = "correct it in that part of the file, or use the other part, by --split"
            yield finding_of(found, fault, "fault", f"in the {which} half alone {{what}}: undone there", remedy)
    for fault in found.doubtful:
        yield finding_of(found, fault, "hint", "perhaps {what}: undone", "look first what changed in between")


def hints_of_delays(found: RecordingQuality) -> Iterator[QualityFinding]:
    """Hints of delays that are left and are no faults; none where something changed in between, or a filter delays."""
    if found.contradictions.any() or any(fault.change.kind == "filtered torque" for fault in found.faults):
        return
    late, n = found.lag_left, len(found.joint_names)
    every = tuple(range(n))
    delays = [(every, late.common, late.deviation, late.held_out)]
    delays += [((j,), late.joints[j], late.deviations[j], late.joints_held_out[j]) for j in every]
    for joints, seconds, deviation, held_out in delays:
        if not np.isfinite(held_out.gained):
            continue
        what = change_in_words(Change("late torque", joints, factor=float(seconds)), found.joint_names, deviation)
        change, spread = (100 * value / n for value in held_out)
        message = (
            f"perhaps {what}: undone, the error of blocks predicted by the others {'falls' if change > 0 else 'rises'} "
            f"by {abs(change):.2g} ± {spread:.2g} % (mean over the joints)"
        )
        names = tuple(found.joint_names[j] for j in joints)
        yield QualityFinding("late-torque", "hint", names, message, "compare with delay in [tau] of the mapping")
