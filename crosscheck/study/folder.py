"""The folder of a study: whether one can begin, go on or grow there, and with which inputs."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from crosscheck.distributing import MISSING
from crosscheck.study.settings.configuration import Configuration, shown_name
from crosscheck.study.store import Store
from crosscheck.study.tasks import LIBRARIES, taking_part
from graphdyn import InvalidInput
from urdf.document import toml_document, write_whole

CONFIGURATION, DATABASE = "study.toml", "study.sqlite"

CONFIGURATION_TEXT, CONFIGURATION_ORIGIN = "configuration", "configuration file"
"""Inputs of a study that are neither a file nor a version: the text of its configuration, and where that came from."""


def is_new(folder: Path, resume: bool, extend: bool = False) -> bool:
    """Whether the folder is new or empty. Raises InvalidInput where no study can begin, go on or grow in it."""
    there = {path.name for path in folder.iterdir()} if folder.is_dir() else set[str]()
    if folder.exists() and not folder.is_dir():
        raise InvalidInput(f"{folder} is no folder; name a new one")
    if there and CONFIGURATION not in there:
        raise InvalidInput(f"{folder} holds other files, such as {min(there)}; name a new folder")
    if extend and not there:
        raise InvalidInput(f"{folder} holds no study that could be extended; omit --extend to begin one")
    if there and not (resume or extend):
        raise InvalidInput(
            f"{folder} holds a study already; go on with it by --resume, add to it by --extend, or name a new folder"
        )
    return not there


def begin(study: Configuration, folder: Path) -> None:
    """The folder, with the configuration in it."""
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / CONFIGURATION, study.text.encode())


GROWING_TABLES, GROWING_KEYS = ("scenario", "grid", "recordings"), ("runs", "methods")
"""Tables of a configuration that a larger study changes, and keys of its table [study]."""


def begin_or_go_on(
    study: Configuration, folder: Path, store: Store, inputs: Mapping[str, str], *, extend: bool = False
) -> None:
    """Keep what the study is begun with. Raises InvalidInput where it was begun with other inputs.

    extend: runs, methods and scenarios may be more
    """
    begun = store.inputs()
    before = begun or {**inputs, CONFIGURATION_TEXT: _copy(folder) or study.text}
    old, new = (tomllib.loads(text) for text in (before[CONFIGURATION_TEXT], study.text))
    if extend:
        old, new = _without_growing(old), _without_growing(new)
    changes = _changes(old, new, "")
    for name in sorted({*before, *inputs} - {CONFIGURATION_TEXT, CONFIGURATION_ORIGIN}):
        if before.get(name) == MISSING and name in LIBRARIES:
            continue  # no result has needed it
        if extend and Path(name).is_absolute() and (name not in before or name not in inputs):
            continue  # of a method or recording that is new, or of a recording that is left out
        if before.get(name) != inputs.get(name):
            what = "has changed" if Path(name).is_absolute() else f"was {before.get(name)}, is {inputs.get(name)}"
            changes.append(f"{name} {what}")
    if changes:
        raise InvalidInput(
            f"{folder} holds a study with another configuration than {study.file}: {'; '.join(changes)}; give the one "
            f"that it was begun with (a copy is in {folder / CONFIGURATION}), or name a new folder"
        )
    if extend:
        _refuse_less(study, folder, store)
    if not begun or extend:
        begin(study, folder)
        store.begin(inputs)


def _without_growing(document: dict[str, Any]) -> dict[str, Any]:
    kept = {name: table for name, table in document.items() if name not in GROWING_TABLES}
    study = {key: value for key, value in kept.get("study", {}).items() if key not in GROWING_KEYS}
    return kept | {"study": study}


def _refuse_less(study: Configuration, folder: Path, store: Store) -> None:
    """Raise InvalidInput where the study lacks something that is done."""
    parts = {one.name: {*map(shown_name, taking_part(study.methods, one))} for one in study.scenarios}
    for (scenario, run), methods in store.done().items():
        missing = sorted(methods - parts.get(scenario, set()))
        what = f"scenario {scenario}" if scenario not in parts else f"run {run}" if run >= study.runs else ""
        if what or missing:
            raise InvalidInput(
                f"{folder} has results of {what or missing[0]}, which {study.file} has not; --extend only adds: give "
                "everything that is done, or name a new folder"
            )


def _copy(folder: Path) -> str | None:
    """The configuration in a folder whose store has lost it; None where it cannot be read either."""
    content = (folder / CONFIGURATION).read_bytes()
    try:
        toml_document(content)
    except ValueError:
        return None
    return content.decode()


def _changes(before: Any, now: Any, where: str) -> list[str]:
    """What differs between two documents."""
    if isinstance(before, dict) and isinstance(now, dict):
        keys = [*before, *(key for key in now if key not in before)]
        inside = [(f"{where}.{key}" if where else key, before.get(key), now.get(key)) for key in keys]
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        inside = [(f"{where} {k}", *pair) for k, pair in enumerate(zip(before, now, strict=True), start=1)]
    else:
        said = ["missing" if value is None else json.dumps(value) for value in (before, now)]
        return [] if before == now else [f"{where} was {said[0]}, is {said[1]}"]
    return [change for name, old, new in inside for change in _changes(old, new, name)]
