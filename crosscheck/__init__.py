"""graphdyn against Pinocchio, number by number. Needs `pin`; the only package that does.

The names below are imported when they are first used: the command line and the pytest fixture start without Pinocchio.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crosscheck.comparing import Disagreement, assert_agrees, compare
    from crosscheck.judgement import Diagnosis, JudgedFunction, Judgement
    from crosscheck.judging.judge import WrongDynamics, assert_correct, judge
    from crosscheck.records import load_recording, save_recording
    from crosscheck.result import Comparison, QuantityResult

_HOMES = {
    "crosscheck.comparing": ("Disagreement", "assert_agrees", "compare"),
    "crosscheck.judgement": ("Diagnosis", "JudgedFunction", "Judgement"),
    "crosscheck.judging.judge": ("WrongDynamics", "assert_correct", "judge"),
    "crosscheck.records": ("load_recording", "save_recording"),
    "crosscheck.result": ("Comparison", "QuantityResult"),
}

__all__ = [
    "Comparison",
    "Diagnosis",
    "Disagreement",
    "JudgedFunction",
    "Judgement",
    "QuantityResult",
    "WrongDynamics",
    "assert_agrees",
    "assert_correct",
    "compare",
    "judge",
    "load_recording",
    "save_recording",
]


def __getattr__(name: str) -> object:
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(module), name)
    raise AttributeError(f"module 'crosscheck' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
