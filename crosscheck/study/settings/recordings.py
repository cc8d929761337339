"""Real recordings of a study, each a table [[recordings]]: files, robot, what is fitted, and what is predicted.

Their other keys are options of `graphdyn identify`, by which the methods are compared on them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crosscheck.study.settings.settings import Settings, texts, words, yes_or_no
from crosscheck.user_code import imported_files
from urdf.document import toml_document

SINGLE_OPTIONS = (
    "robot", "mapping", "rate", "cutoff", "decimate", "min_speed", "torque_hold", "terms", "width",
    "stribeck_velocity", "stribeck_exponent", "models", "payload", "payload_on", "controller", "control_rate",
)  # fmt: skip
"""Options of `graphdyn identify` with one value; a list is joined by commas."""

REPEATED_OPTIONS = ("term", "known_torque", "scaled_torque", "lock", "repair")
"""Options that can be given several times."""

TUPLE_OPTIONS = {"chain": 2, "gravity": 3, "split": 2, "split_rows": 2}
"""Options with so many values."""

FLAG_OPTIONS = ("derive_velocity", "known_bodies")

CODE_OPTIONS = ("term", "known_torque", "scaled_torque", "controller")
"""Options whose values are FILE.py:NAME."""

SPLIT_OPTIONS = ("split", "split_rows")
"""Options that say what is fitted and what is predicted; one is needed."""

SPLIT_REMEDY = 'say what is fitted and what is predicted, such as split = ["0:6", "6:9"]'


@dataclass(frozen=True)
class StudyRecording:
    """label: in tables; arguments: of `graphdyn identify`, methods aside; files: whole paths of what it reads"""

    label: str
    arguments: tuple[str, ...]
    files: tuple[str, ...]

    @property
    def code(self) -> tuple[str, ...]:
        """FILE.py:NAME among the arguments."""
        return tuple(filter(_code_file, self.arguments))


def recording_labels(document: Mapping[str, Any]) -> list[str]:
    """Labels of the recordings of a configuration that has been read before, in its order."""
    return [_label(table) for table in document.get("recordings", [])]


def _label(table: Mapping[str, Any]) -> str:
    return str(table.get("label", Path(table["files"][0]).stem))


def recordings(tables: Sequence[Settings], folder: Path) -> tuple[StudyRecording, ...]:
    """folder: in which paths begin. Raises BadConfiguration."""
    found = tuple(_recording(table, folder) for table in tables)
    for k, recording in enumerate(found):
        if recording.label in [other.label for other in found[:k]]:
            raise tables[k].error("label", f"is '{recording.label}', as that of another; give a label of its own")
    return found


def _recording(table: Settings, folder: Path) -> StudyRecording:
    for key in ("files", "robot"):
        if key not in table.values:
            raise table.error(key, f"is missing; give {'a list of files' if key == 'files' else 'a name or a file'}")
    files = table.take("files", tuple[str, ...](), _files)
    table.take("label", "", words)
    label = _label(table.values)
    if Path(label).name != label:
        raise table.error("label", f"is '{label}', which is a path; give a name")
    arguments = [*files, *_options(table)]
    table.refuse_others()
    splits = [key for key in SPLIT_OPTIONS if key in table.values]
    if not splits:
        raise table.error("split", f"is missing; {SPLIT_REMEDY}")
    if len(splits) > 1:
        raise table.error("split", "stands beside split_rows; give one of them")
    for key in ("files", "mapping", "models", *CODE_OPTIONS):
        for text in _values(table.values.get(key, [])):
            file = _code_file(text) if key in CODE_OPTIONS else text
            if file and not (folder / file).is_file():
                raise table.error(key, f"has {file}, which is no file in {folder}")
    for text in _values(table.values.get("models", [])):
        _refuse_several(table, folder / text)
    read = [folder / text for text in arguments if (folder / text).is_file()]
    read += [one for file in filter(None, map(_code_file, arguments)) for one in imported_files(folder / file)]
    return StudyRecording(label, tuple(arguments), tuple(dict.fromkeys(str(file.resolve()) for file in read)))


def _code_file(argument: str) -> str:
    """The file of FILE.py:NAME; empty for another text."""
    file = argument.rpartition(":")[0]
    return file if file.endswith(".py") else ""


def _refuse_several(table: Settings, file: Path) -> None:
    """Raise BadConfiguration for a file of torque models that gives another table than one row for each method."""
    try:
        models = toml_document(file.read_bytes())
    except ValueError as error:
        raise table.error("models", f"has {file.name}, which cannot be read: {error}") from None
    if len(models) != 1:
        raise table.error("models", f"has {file.name} with {len(models)} torque models; give a file with one")
    if any("methods" in model for model in models.values()):
        raise table.error("models", f"has {file.name} with methods of its own; name them in [study]")


def _options(table: Settings) -> Iterator[str]:
    """The arguments of all options of the table, by their kinds."""
    for option in (*SINGLE_OPTIONS, *REPEATED_OPTIONS, *TUPLE_OPTIONS):
        values = table.take(option, list[str](), _values)
        name = f"--{option.replace('_', '-')}"
        if option in TUPLE_OPTIONS:
            needed = TUPLE_OPTIONS[option]
            if values and len(values) != needed:
                remedy = SPLIT_REMEDY if option in SPLIT_OPTIONS else f"give a list of {needed}"
                raise table.error(option, f"is {table.values[option]!r}; {remedy}")
            yield from [name, *values] if values else []
        elif option in REPEATED_OPTIONS:
            for value in values:
                yield from (name, value)
        elif values:
            yield from (name, ",".join(values))
    for flag in FLAG_OPTIONS:
        if table.take(flag, False, yes_or_no):
            yield f"--{flag.replace('_', '-')}"


def _files(value: object) -> tuple[str, ...]:
    found = texts("files")(value)
    if not found:
        raise ValueError("give a list of files")
    return found


def _values(value: object) -> list[str]:
    parts = value if isinstance(value, list) else [value]
    if all(isinstance(part, str | int | float) and not isinstance(part, bool) and part != "" for part in parts):
        return [str(part) for part in parts]
    raise ValueError("give a text, a number, or a list of them")
