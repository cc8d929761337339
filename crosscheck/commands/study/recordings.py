"""Real recordings of a study: methods compared by `graphdyn identify` on rows that they have not seen."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from crosscheck.report.report import Column, Row, Section, Table
from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.settings.recordings import StudyRecording
from graphdyn import InvalidInput
from urdf.document import write_whole

FOLDER = "recordings"
"""Folder, in that of a study, with a JSON file of `graphdyn identify` for every recording."""

RecordedErrors = Mapping[str, Mapping[str, tuple[float, bool] | None]]
"""Mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows, and whether all links and mass matrices can be real,
by label and method; None where the method has failed."""


def identify_recordings(study: Configuration, folder: Path, *, allow_code: bool) -> None:
    """Compare the methods on every recording that is not done. Raises InvalidInput where the command fails."""
    for recording in study.recordings:
        (folder / FOLDER).mkdir(exist_ok=True)
        file = folder / FOLDER / f"{recording.label}.json"
        command = _command(study, recording, allow_code)
        done = _done(file)
        if done is not None and done["asked"] == command:
            continue
        part = folder / FOLDER / f".{recording.label}.json"
        called = [sys.executable, "-m", "crosscheck", *command, "--json", str(part.resolve())]
        ended = subprocess.run(called, cwd=study.folder, check=False, capture_output=True, text=True)
        if ended.returncode not in (0, 1):
            said = (ended.stderr.strip().splitlines() or ["it ended without a word"])[-1]
            raise InvalidInput(f"{study.file}: recording '{recording.label}': {said}")
        write_whole(file, json.dumps({"asked": command, "found": json.loads(part.read_text())}).encode())
        part.unlink()


def _command(study: Configuration, recording: StudyRecording, allow_code: bool) -> list[str]:
    further = ["--allow-code"] if allow_code and "--models" in recording.arguments else []
    return ["identify", *recording.arguments, "--methods", ",".join(study.methods), *further]


def _done(file: Path) -> dict[str, Any] | None:
    if not file.is_file():
        return None
    try:
        found: dict[str, Any] = json.loads(file.read_text())
    except ValueError:
        return None
    return found


def read_recordings(folder: Path) -> RecordedErrors:
    """What is done of them."""
    found = dict[str, Mapping[str, tuple[float, bool] | None]]()
    for file in sorted((folder / FOLDER).glob("[!.]*.json")):
        record = json.loads(file.read_text())["found"]
        means = {(row["method"], row["cad_links"]): row["mean_error"] for row in record["comparison"]}
        found[file.stem] = {
            one["name"]: None
            if one["failure"]
            else (means[one["name"], False], one["consistent"] and one["positive_definite"] == one["poses"])
            for one in record["methods"]
        }
    return found


def recordings_section(found: RecordedErrors) -> Iterator[Section]:
    """Methods by rows, recordings by columns."""
    if not found:
        return
    methods = list(dict.fromkeys(method for errors in found.values() for method in errors))
    rows = tuple(Row((method, *(_cell(errors.get(method)) for errors in found.values()))) for method in methods)
    table = Table(
        (Column("method", "name"), *(Column(label, "number", "%") for label in found)),
        rows,
        caption="Mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows. In brackets: some link or mass "
        "matrix cannot be real. One split of one recording does not rank methods.",
    )
    yield Section("recordings", "Recordings", (table,))


def _cell(found: tuple[float, bool] | None) -> str:
    if found is None:
        return "–"
    error, real = found
    return f"{100 * error:.1f}" if real else f"({100 * error:.1f})"
