"""KUKA: a spline block of points in degrees, each taking the same part of the time of the whole block.

Makers count axes from zeros and in directions of their own: A_j = sign_j q_j + zero_j, with q_j in degrees. Sliding
joints are external axes E1, … in millimeters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crosscheck.exciting.motion_formats.program_lines import LineForm, ProgramLines
from crosscheck.exciting.motion_formats.timed_motion import GivenMotion, TimedMotion
from graphdyn import InvalidInput
from graphdyn.errors import counted
from graphdyn.layout import Array

MILLIMETERS_PER_METER = 1000.0
KRL_DECIMALS = 6
"""Decimals of a degree or millimeter."""

_HEAD = (LineForm.of("DEF NAME()"), LineForm.of("BAS(#INITMOV,0)"))
_START = (LineForm.of("PTP_SPLINE"), LineForm.of("TIME_BLOCK START"))
_PART = LineForm.of("TIME_BLOCK PART = 1")
_END = LineForm.of("TIME_BLOCK END = …", 1)
_TAIL = (LineForm.of("ENDSPLINE"), LineForm.of("END"))


@dataclass(frozen=True)
class AxisSettings:
    """signs: 1 or -1 of each axis, zeros: [° or mm] of each axis; one for all, or n. Raises InvalidInput for others."""

    signs: tuple[float, ...] = (1.0,)
    zeros: tuple[float, ...] = (0.0,)

    def __post_init__(self) -> None:
        if any(abs(sign) != 1 for sign in self.signs):
            raise InvalidInput(f"axis signs are {', '.join(f'{sign:g}' for sign in self.signs)}; each is 1 or -1")

    def of(self, n: int) -> tuple[Array, Array]:
        """Signs and zeros (n,)."""
        for what, values in (("signs", self.signs), ("zeros", self.zeros)):
            if len(values) not in (1, n):
                raise InvalidInput(f"{len(values)} axis {what} for {counted(n, 'joint')}; give one, or one for each")
        return np.broadcast_to(self.signs, n), np.broadcast_to(self.zeros, n)


def document(motion: TimedMotion, settings: AxisSettings, name: str) -> bytes:
    """name: of the program. Raises InvalidInput for steps of time that are not all equal."""
    signs, zeros = settings.of(len(motion.joint_names))
    units = np.where(motion.prismatic, MILLIMETERS_PER_METER, np.degrees(1.0))
    axes = np.round(signs * units * motion.q + zeros, KRL_DECIMALS) + 0.0
    names = _axis_names(motion.prismatic)
    points = [
        "{" + ",".join(f"{name} {x:.{KRL_DECIMALS}f}" for name, x in zip(names, row, strict=True)) + "}" for row in axes
    ]
    lines = [f"DEF {name}()", "BAS(#INITMOV,0)", f"PTP {points[0]}", "PTP_SPLINE", "TIME_BLOCK START"]
    lines.append(f"SPTP {points[1]}")
    for point in points[2:]:
        lines += ["TIME_BLOCK PART = 1", f"SPTP {point}"]
    lines += [f"TIME_BLOCK END = {motion.period * (len(points) - 1):.6f}", "ENDSPLINE", "END", ""]
    return "\n".join(lines).encode()


def read(path: Path, prismatic: Sequence[bool], settings: AxisSettings) -> GivenMotion:
    """Read a program in this form. Raises BadRecordingFile for others, and InvalidInput."""
    signs, zeros = settings.of(len(prismatic))
    axes = "{" + ",".join(f"{name} …" for name in _axis_names(prismatic)) + "}"
    point, way_point = (LineForm.of(f"{word} {axes}", len(prismatic)) for word in ("PTP", "SPTP"))
    lines = ProgramLines(path)
    lines.take_all(_HEAD)
    rows = [lines.take(point)]
    lines.take_all(_START)
    rows.append(lines.take(way_point))
    while lines.follows(_PART):
        lines.take(_PART)
        rows.append(lines.take(way_point))
    (duration,) = lines.take(_END)
    lines.take_all(_TAIL)
    lines.end()
    units = np.where(np.asarray(prismatic), MILLIMETERS_PER_METER, np.degrees(1.0))
    return GivenMotion(np.linspace(0.0, duration, len(rows)), signs * (np.array(rows) - zeros) / units)


def _axis_names(prismatic: Sequence[bool]) -> list[str]:
    turning, sliding, names = 0, 0, []
    for slides in prismatic:
        turning, sliding = turning + (not slides), sliding + slides
        names.append(f"E{sliding}" if slides else f"A{turning}")
    return names
