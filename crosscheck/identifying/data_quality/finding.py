"""A finding about a recording, and that of a fault that was corrected on trial."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from crosscheck.identifying.data_quality.causes import cause_in_words, code_of
from graphdyn.identification.data_quality import DataFault, RecordingQuality


@dataclass(frozen=True)
class QualityFinding:
    """One fault or oddity of a recording.

    code: stable name of its kind
    severity: "fault": no model is recommended until it is corrected; "warning": suspicious; "hint": a number that may
        mean something, and that refuses nothing
    joints: whose columns; message: what was found; remedy: what to do
    lines: of the mapping file, to be pasted over the existing ones; empty where no mapping helps
    """

    code: str
    severity: Literal["fault", "warning", "hint"]
    joints: tuple[str, ...]
    message: str
    remedy: str
    lines: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Message and remedy in one line."""
        return f"{self.message}; {self.remedy} [{self.code}]"


def finding_of(
    found: RecordingQuality,
    fault: DataFault,
    severity: Literal["fault", "hint"],
    words: str,
    remedy: str,
    lines: tuple[str, ...] = (),
) -> QualityFinding:
    """The finding of a fault. words: with {what} in place of the fault, before what its correction gains"""
    names = tuple(found.joint_names[j] for j in fault.change.joints)
    what = cause_in_words(fault, found.joint_names, found.gravity)
    message = f"{words.format(what=what)}, the equations of motion fit with {errors_in_words(fault)}"
    return QualityFinding(code_of(fault.change), severity, names, message, remedy, lines)


def errors_in_words(fault: DataFault) -> str:
    """The residuals after the correction, and before."""
    before, after = (100 * np.exp(np.mean(np.log(errors))) for errors in (fault.before, fault.after))
    worst = int(np.argmax(fault.before / fault.after))
    return (
        f"{after:.3g} % instead of {before:.3g} % (geometric mean over the joints; joint {worst + 1}: "
        f"{100 * fault.after[worst]:.3g} % instead of {100 * fault.before[worst]:.3g} %)"
    )
