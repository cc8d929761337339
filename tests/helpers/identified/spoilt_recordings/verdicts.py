"""What the program says of a spoilt recording, and whether that is what its exact undoing shows.

The oracle is the gain of the exact undoing: the fall of Σ_j log ‖e_j‖ of the program's own bounded fit, from the
spoilt recording to the clean one. ‖e_j‖ is relative to ‖τ_j‖, as in the program, except where a fault adds to the
torque. A kind with a gain of MIN_VISIBLE_GAIN or more is visible. Some faults leave the fit as good as it was, or make
it better, and are visible by construction: their Fault.shows says why.
"""

import tomllib
from dataclasses import dataclass
from functools import cache

import numpy as np
from identified.spoilt_recordings.case import Case
from identified.spoilt_recordings.faults.fault import Fault
from identified.spoilt_recordings.kinds import Kind
from identified.spoilt_recordings.materials import material
from identified.spoilt_recordings.remedied import Filed

import crosscheck
from crosscheck.identifying.data_quality.data_quality import data_quality
from crosscheck.recordings import BadMapping
from graphdyn import InvalidInput

MIN_VISIBLE_GAIN = 0.5
"""Gain from which a change of columns is a fault for the program, too."""

WITHOUT_CAUSE = ("unrelated",)
"""Codes of findings that state no cause."""

MAX_EQUIVALENT_GAIN = 0.1
"""What the exact undoing may still gain where another cause explains the recording as well: no wrong change gains more
on the clean recordings."""

VERDICTS = ("named", "equivalent", "named in part", "wrong cause", "refused without a cause", "usable")


@cache
def clean(name):
    return Case.of(name)


@cache
def clean_bases(name):
    """Clean cases by the base of a kind: a key is the set of recorded channels."""
    return {}


def base_of(name, kind):
    """The clean case of a kind; the same object for all kinds with the same channels."""
    base = kind.base(clean(name))
    key = tuple(base.recording.recorded(("q", "v", "a", "tau")))
    return clean_bases(name).setdefault(key, base)


@dataclass(frozen=True)
class Verdict:
    """What the program says of a spoilt recording.

    gain: of the exact undoing; NaN where the spoilt recording has no fit
    to_name: the faults that show even alone: of several at once, the others need not be named
    findings: of the data quality, in their order; refused: whether the recording may be used
    refusal: message of an error, empty without one
    left: what the exact undoing would still gain after the lines of all findings were pasted into the mapping, one
        after the other; None where a fault has no lines, or the lines are no mapping
    """

    kind: Kind
    gain: float
    to_name: tuple[Fault, ...]
    findings: tuple
    refused: bool
    refusal: str
    joint_names: tuple[str, ...]
    left: float | None = None

    @property
    def visible(self):
        return bool(self.kind.shows) or not self.gain < MIN_VISIBLE_GAIN

    @property
    def faults(self):
        return [finding for finding in self.findings if finding.severity == "fault"]

    @property
    def judgment(self):
        """One of VERDICTS.

        With remedies put to the test, another cause is equivalent if its remedy leaves nothing: the recording cannot
        tell them apart. A right cause whose remedy does not undo it is named in part.
        """
        if not self.refused:
            enough = self.kind.warned and self.gain < MIN_VISIBLE_GAIN
            return "named" if enough and self.hinted else "usable"
        right = [self._named(finding) for finding in self.faults]
        first = bool(right) and right[0]
        if self.left is not None and self.left < MAX_EQUIVALENT_GAIN and not (first and self._all_named):
            return "equivalent"
        if not any(right):
            causes = any(finding.code not in WITHOUT_CAUSE for finding in self.faults)
            return "wrong cause" if causes else "refused without a cause"
        undone = self.left is None or self.left < MIN_VISIBLE_GAIN
        return "named" if first and self._all_named and undone else "named in part"

    @property
    def _all_named(self):
        return all(any(fault.named_by(finding, self.joint_names) for finding in self.faults) for fault in self.to_name)

    @property
    def beside(self):
        """Whether a finding beside the right ones states a wrong cause."""
        stated = [finding for finding in self.faults if finding.code not in WITHOUT_CAUSE]
        return self.judgment == "named" and not all(map(self._named, stated))

    def _named(self, finding):
        return any(fault.named_by(finding, self.joint_names) for fault in self.kind.faults)

    @property
    def hinted(self):
        """Whether a finding that is no reason to refuse names a fault."""
        return any(self._named(finding) for finding in self.findings if finding.severity != "fault")

    @property
    def right(self):
        """Whether the verdict is as it must be: visible faults are named."""
        if not self.kind.judged:
            return self.judgment != "wrong cause"
        return not self.visible or self.judgment in ("named", "equivalent")

    @property
    def told(self):
        """Findings in short."""
        listed = [
            f"{finding.code} ({', '.join(finding.joints) if len(finding.joints) < 3 else 'all'})"
            + ("" if finding.severity == "fault" else f" [{finding.severity}]")
            for finding in self.findings
        ]
        return "; ".join(listed) or self.refusal or "–"


def gain_of_undoing(base, spoilt, adds=False):
    """The oracle. NaN where the spoilt recording cannot be fitted.

    adds: whether the fault adds to the torque: ‖e_j‖ is then not to be measured by the ‖τ_j‖ that it changes
    """
    try:
        sizes = [case.errors * (np.linalg.norm(case.fit[1], axis=0) if adds else 1.0) for case in (base, spoilt)]
    except (InvalidInput, np.linalg.LinAlgError):
        return float("nan")
    return float(np.sum(np.log(sizes[1] / sizes[0])))


def examined(case):
    """Findings of the data quality alone, whether they refuse the recording, and the message of an error."""
    try:
        found = data_quality(case.torque_model, [case.recording], case.preparation)
    except InvalidInput as error:
        return (), True, str(error)
    if found is None:
        return (), True, "too short"
    return found.findings, bool(found.faults), ""


def identified(name, case):
    """Findings of the whole command, whether it refuses the recording, and the message of an error."""
    options = material(name).options | {"terms": case.terms, "known": case.known, "preparation": case.preparation}
    try:
        found = crosscheck.identify(case.model, case.recording, poses=5, **options)
    except InvalidInput as error:
        return (), True, str(error)
    return found.data_quality.findings if found.data_quality else (), not found.usable, ""


def verdict(name, kind, *, fitted=True, remedies=False):
    """The verdict on one kind of a material.

    fitted: with an identification, not the data quality alone
    remedies: whether the recording goes through a file, so that the lines of its findings can be put to the test
    """
    base = base_of(name, kind)
    spoilt = kind.spoilt(base)
    gain, left = gain_of_undoing(base, spoilt, kind.adds), None
    to_name = kind.faults
    if len(to_name) > 1:
        to_name = tuple(
            fault for fault in to_name if fault.shows or not gain_of_undoing(base, fault.spoil(base)) < MIN_VISIBLE_GAIN
        )
    try:
        filed = Filed.of(spoilt) if remedies else None
        told = (
            identified(name, filed.case if filed else spoilt) if fitted else examined(filed.case if filed else spoilt)
        )
        if filed:
            left = left_by_remedies(base, filed, told[0])
    except InvalidInput as error:  # by checks of the file
        told = (), True, str(error)
    return Verdict(kind, gain, to_name, *told, base.model.independent_joints, left)


def left_by_remedies(base, filed, findings):
    """What the exact undoing would still gain; None where the lines of the findings do not tell."""
    lines = [finding.lines for finding in findings if finding.severity == "fault"]
    if not lines or not all(lines):
        return None
    try:
        return gain_of_undoing(base, filed.remedied(lines).case)
    except (BadMapping, tomllib.TOMLDecodeError):
        return None
