"""CSV with a header, one row for each time: time [s], JOINT.q [rad], JOINT.v [rad/s], JOINT.a [rad/s^2].

The columns of recordings, so that whatever reads these reads it. Numbers lose no digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crosscheck.exciting.motion_formats.timed_motion import TimedMotion, TimedPositions
from crosscheck.recordings import load_recording

COLUMN_UNITS = {"q": ("rad", "m"), "v": ("rad/s", "m/s"), "a": ("rad/s^2", "m/s^2")}


def document(motion: TimedMotion) -> bytes:
    joints = list(zip(motion.joint_names, motion.prismatic, strict=True))
    header = ["time [s]"]
    for symbol, units in COLUMN_UNITS.items():
        header += [f"{name}.{symbol} [{units[slides]}]" for name, slides in joints]
    rows = np.column_stack([motion.time, motion.q, motion.v, motion.a]).tolist()
    return "\n".join([",".join(header), *(",".join(map(repr, row)) for row in rows), ""]).encode()


def read(path: Path, joints: Sequence[str]) -> TimedPositions:
    """Any recording will do, one of torques too. Raises as crosscheck.load_recording."""
    recording = load_recording(path, joints=joints)
    return TimedPositions(recording.t, recording.q)
