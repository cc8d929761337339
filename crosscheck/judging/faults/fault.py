"""A fault of a dynamics code."""

from __future__ import annotations

from dataclasses import dataclass

from crosscheck.judging.experiments import Function


@dataclass(frozen=True, eq=False)
class Fault:
    """One fault: its kind, message and remedy, and the torques of a code that has it."""

    kind: str
    message: str
    remedy: str
    torque: Function
