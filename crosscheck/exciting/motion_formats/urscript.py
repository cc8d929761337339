"""Universal Robots: a program that moves to the start and then sends one servoj for each step of time.

The times of the rows are whole multiples of the period, which the program states in its first line.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crosscheck.exciting.motion_formats.program_lines import LineForm, ProgramLines
from crosscheck.exciting.motion_formats.timed_motion import GivenMotion, TimedMotion
from crosscheck.recordings.errors import BadRecordingFile

LOOKAHEAD, GAIN = 0.1, 300
"""[s, -] Settings of servoj: the values of the manual's example."""

_HEAD = LineForm.of("def NAME():")
_PERIOD = LineForm.of("global period = …", 1)
_TAIL = (LineForm.of("stopj(…)", 1), LineForm.of("end"))


def document(motion: TimedMotion) -> bytes:
    """Raises InvalidInput for steps of time that are not all equal."""
    period = motion.period
    lines = ["def excitation():", f"  global period = {period!r}"]
    lines.append(f"  movej({motion.q[0].tolist()}, a=0.5, v=0.3)")
    servo = f"t=period, lookahead_time={LOOKAHEAD}, gain={GAIN})"
    lines += [f"  servoj({row}, 0, 0, {servo}" for row in motion.q.tolist()]
    return "\n".join([*lines, "  stopj(2.0)", "end", ""]).encode()


def read(path: Path, joints: Sequence[str]) -> GivenMotion:
    """Read a program in this form. Raises BadRecordingFile for others."""
    row = "[" + ", ".join("…" for _ in joints) + "]"
    start = LineForm.of(f"movej({row}, a=…, v=…)", len(joints) + 2)
    servo = LineForm.of(f"servoj({row}, 0, 0, t=period, lookahead_time=…, gain=…)", len(joints) + 2)
    lines = ProgramLines(path)
    lines.take(_HEAD)
    (period,) = lines.take(_PERIOD)
    first = lines.take(start)[:-2]
    rows = [lines.take(servo)[:-2]]
    while lines.follows(servo):
        rows.append(lines.take(servo)[:-2])
    if rows[0] != first:
        raise BadRecordingFile(f"{path}: the first servoj is not where movej ends; begin the motion at its first row")
    lines.take_all(_TAIL)
    lines.end()
    return GivenMotion(np.arange(len(rows)) * np.float64(period), np.array(rows))
