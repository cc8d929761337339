"""Real recordings of a study, each a table [[recordings]]: files, robot, what is fitted, and what is predicted.

Their other keys are options of `graphdyn identify`, by which the methods are compared on them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crosscheck.study.settings.settings import Settings, texts, words

RECORDING_OPTIONS = (
    "robot", "mapping", "rate", "cutoff", "decimate", "derive_velocity", "min_speed", "torque_hold", "terms", "width",
    "stribeck_velocity", "stribeck_exponent", "models", "term", "known_torque", "scaled_torque", "known_bodies",
    "payload", "payload_on", "controller", "control_rate", "lock", "chain", "gravity", "repair",
)  # fmt: skip
"""Options of `graphdyn identify` that a recording may have."""

SPLITS = ("split", "split_rows")
"""Options that say what is fitted and what is predicted; one is needed."""


@dataclass(frozen=True)
class StudyRecording:
    """label: in tables; arguments: of `graphdyn identify`, methods aside; files: that it reads, beside its code"""

    label: str
    arguments: tuple[str, ...]
    files: tuple[str, ...]

    @property
    def code(self) -> tuple[str, ...]:
        """FILE.py:NAME among the arguments."""
        return tuple(text for text in self.arguments if text.rpartition(":")[0].endswith(".py"))


def recordings(tables: Sequence[Settings], folder: Path) -> tuple[StudyRecording, ...]:
    """Raises BadConfiguration."""
    found = tuple(_recording(table, folder) for table in tables)
    for k, recording in enumerate(found):
        if recording.label in [other.label for other in found[:k]]:
            raise tables[k].error("label", f"is '{recording.label}', as that of another; give a label of its own")
    return found


def _recording(table: Settings, folder: Path) -> StudyRecording:
    for key in ("files", "robot"):
        if key not in table.values:
            raise table.error(key, f"is missing; give {'a list of files' if key == 'files' else 'a name or a file'}")
    files = table.take("files", tuple[str, ...](), texts("files"))
    label = table.take("label", Path(files[0]).stem if files else "", words)
    if Path(label).name != label:
        raise table.error("label", f"is '{label}', which is a path; give a name")
    arguments = list(files)
    for option in (*RECORDING_OPTIONS, *SPLITS):
        arguments += _arguments(option, table.take(option, None, _value))
    table.refuse_others()
    if not set(SPLITS) & set(table.values):
        raise table.error("split", 'is missing; say what is fitted and what is predicted: ["0:6", "6:9"]')
    for file in files:
        if not (folder / file).is_file():
            raise table.error("files", f"has {file}, which is no file in {folder}")
    named = [text for text in arguments if (folder / text).is_file()]
    return StudyRecording(label, tuple(arguments), tuple(str((folder / text).resolve()) for text in named))


def _value(value: object) -> list[str] | bool:
    if isinstance(value, bool):
        return value
    parts = value if isinstance(value, list) else [value]
    if parts and all(isinstance(part, str | int | float) and not isinstance(part, bool) for part in parts):
        return [str(part) for part in parts]
    raise ValueError("give a text, a number, true, or a list of texts and numbers")


def _arguments(option: str, value: Any) -> list[str]:
    if value is None or value is False:
        return []
    name = f"--{option.replace('_', '-')}"
    return [name] if value is True else [name, *value]
