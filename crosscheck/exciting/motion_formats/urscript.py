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

PERIOD_ROUNDING = 1e-6
"""A period is a multiple of that of a controller if the quotient is so close to a whole number."""

LOOKAHEAD, GAIN = 0.1, 300
"""[s, -] Settings of servoj: the values of the manual's example."""

_HEAD = LineForm.of("def NAME():")
_PERIOD = LineForm.of("global period = …", 1)
_TAIL = (LineForm.of("stopj(…)", 1), LineForm.of("end"))


CONTROLLER_PERIODS = (0.002, 0.008)
"""Periods of the controllers: of the e-Series, and of the CB series before it [s]."""


def document(motion: TimedMotion, name: str) -> bytes:
    """name: of the program. Raises InvalidInput for steps of time that are not all equal."""
    period = motion.period
    lines = [f"def {name}():", f"  global period = {period!r}"]
    lines.append(f"  movej({motion.q[0].tolist()}, a=0.5, v=0.3)")
    servo = f"t=period, lookahead_time={LOOKAHEAD}, gain={GAIN})"
    lines += [f"  servoj({row}, 0, 0, {servo}" for row in motion.q.tolist()]
    return "\n".join([*lines, "  stopj(2.0)", "end", ""]).encode()


def strange_period(period: float) -> str:
    """That no controller has this period, and what to do; empty where one has it."""
    if any(abs(period / own - round(period / own)) < PERIOD_ROUNDING for own in CONTROLLER_PERIODS):
        return ""
    return (
        f"rows every {1000 * period:g} ms: controllers take them every 2 ms (e-Series) or 8 ms (CB), or a multiple; "
        "give a --duration that is one, such as whole seconds"
    )


def controller_rate(duration: float, rate: float) -> float | None:
    """The lowest rate from this one on whose period a controller has and divides the duration [Hz]; None without."""
    shortest = min(CONTROLLER_PERIODS)
    steps = round(duration / shortest)
    if abs(duration / shortest - steps) > PERIOD_ROUNDING * steps:
        return None
    fitting = [k for k in range(1, steps + 1) if steps % k == 0 and 1 / (k * shortest) >= rate * (1 - PERIOD_ROUNDING)]
    return 1 / (fitting[-1] * shortest) if fitting else None


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
