"""Universal Robots: a program that moves to the start and then sends one servoj for each step of time.

The times of the rows are whole multiples of the period, which the program states in its first line.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crosscheck.exciting.motion_formats.timed_motion import TimedMotion
from crosscheck.recordings.errors import BadRecordingFile
from graphdyn.errors import counted
from graphdyn.excitation import TabulatedCourse

LOOKAHEAD, GAIN = 0.1, 300
"""[s, -] Settings of servoj: the values of the manual's example."""

_PERIOD = re.compile(r"^\s*global\s+period\s*=\s*([-+.\deE]+)", re.MULTILINE)
_SERVO = re.compile(r"^\s*servoj\(\s*\[([^\]]*)\]", re.MULTILINE)


def document(motion: TimedMotion) -> bytes:
    period = float(motion.time[1])
    lines = ["def excitation():", f"  global period = {period!r}"]
    lines.append(f"  movej({motion.q[0].tolist()}, a=0.5, v=0.3)")
    servo = f"t=period, lookahead_time={LOOKAHEAD}, gain={GAIN})"
    lines += [f"  servoj({row}, 0, 0, {servo}" for row in motion.q.tolist()]
    return "\n".join([*lines, "  stopj(2.0)", "end", ""]).encode()


def read(path: Path, joints: Sequence[str]) -> TabulatedCourse:
    """Read programs in this form. Raises BadRecordingFile for others."""
    text = path.read_text(encoding="utf-8", errors="replace")
    period, rows = _PERIOD.search(text), _SERVO.findall(text)
    if period is None or not rows:
        raise BadRecordingFile(f"{path}: has no line 'global period = …' and servoj([…]) for each step of time")
    try:
        positions = np.array([[float(x) for x in row.split(",")] for row in rows], dtype=float)
        step = float(period[1])
    except ValueError:
        raise BadRecordingFile(f"{path}: a servoj holds something else than as many numbers as the others") from None
    if positions.shape[1] != len(joints):
        raise BadRecordingFile(f"{path}: servoj has {counted(positions.shape[1], 'joint')}, the robot {len(joints)}")
    return TabulatedCourse(np.arange(len(positions)) * np.float64(step), positions)
