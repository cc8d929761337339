"""graphdyn against Pinocchio, number by number. Needs `pin`; the only package that does.

The names below are imported when they are first used: the command line and the pytest fixture start without Pinocchio.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crosscheck.comparing import Disagreement, assert_agrees, compare
    from crosscheck.identifying import Identified, identify
    from crosscheck.judgement import Diagnosis, JudgedFunction, Judgement
    from crosscheck.judging.judge import WrongDynamics, assert_correct, judge
    from crosscheck.records import (
        DirtyRecording,
        Record,
        StreamedRecording,
        concatenated,
        decimated,
        differentiated,
        inspect_record,
        load_mapping,
        load_record,
        load_recording,
        record_of,
        save_recording,
        split_by_file,
        split_by_rows,
        split_by_time,
        time_folds,
    )
    from crosscheck.result import Comparison, QuantityResult

_HOMES = {
    "crosscheck.comparing": ("Disagreement", "assert_agrees", "compare"),
    "crosscheck.identifying": ("Identified", "identify"),
    "crosscheck.judgement": ("Diagnosis", "JudgedFunction", "Judgement"),
    "crosscheck.judging.judge": ("WrongDynamics", "assert_correct", "judge"),
    "crosscheck.records": (
        "DirtyRecording",
        "Record",
        "StreamedRecording",
        "concatenated",
        "decimated",
        "differentiated",
        "inspect_record",
        "load_mapping",
        "load_record",
        "load_recording",
        "record_of",
        "save_recording",
        "split_by_file",
        "split_by_rows",
        "split_by_time",
        "time_folds",
    ),
    "crosscheck.result": ("Comparison", "QuantityResult"),
}

__all__ = [
    "Comparison",
    "Diagnosis",
    "DirtyRecording",
    "Disagreement",
    "Identified",
    "JudgedFunction",
    "Judgement",
    "QuantityResult",
    "Record",
    "StreamedRecording",
    "WrongDynamics",
    "assert_agrees",
    "assert_correct",
    "compare",
    "concatenated",
    "decimated",
    "differentiated",
    "identify",
    "inspect_record",
    "judge",
    "load_mapping",
    "load_record",
    "load_recording",
    "record_of",
    "save_recording",
    "split_by_file",
    "split_by_rows",
    "split_by_time",
    "time_folds",
]


def __getattr__(name: str) -> object:
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(module), name)
    raise AttributeError(f"module 'crosscheck' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
