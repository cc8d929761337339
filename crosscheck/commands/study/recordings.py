"""Real recordings of a study: methods compared by `graphdyn identify` on rows that they have not seen."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crosscheck.commands.program.console import Advance, say
from crosscheck.commands.study.words import listed
from crosscheck.report.report import Column, Note, Notes, Row, Section, Table, Verdict
from crosscheck.study.settings.configuration import Configuration, shown_name
from crosscheck.study.settings.recordings import StudyRecording
from graphdyn import InvalidInput
from graphdyn.errors import counted
from urdf.document import write_whole

FOLDER = "recordings"
"""Folder, in that of a study, with a JSON file for every recording: what was asked, and what `identify` answered."""


@dataclass(frozen=True)
class RecordedResult:
    """One method on one recording.

    method: as in the other tables; or the links of CAD with fitted drives, as `graphdyn identify` calls them
    torque_error: mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows; None where the method has failed
    real: whether all links and mass matrices can be; failure: why it has failed; None where it has not
    """

    method: str
    torque_error: float | None
    real: bool | None
    failure: str | None


RecordedResults = Mapping[str, Sequence[RecordedResult]]
"""Results of all methods by the label of the recording."""


def identify_recordings(study: Configuration, folder: Path, advance: Advance, *, allow_code: bool) -> None:
    """Compare the methods on every recording that is not done. Raises InvalidInput where the command fails."""
    for recording in study.recordings:
        file, command = _file(folder, recording.label), _command(study, recording, allow_code)
        done = _done(file)
        if done is None or done["asked"] != command:
            advance(recording.label, 0)
            found = _found(study, recording.label, command, folder, advance)
            names = list(map(shown_name, study.methods))
            write_whole(file, json.dumps({"asked": command, "methods": names, "found": found}).encode())
        advance(recording.label, 1)


def _file(folder: Path, label: str) -> Path:
    return folder / FOLDER / f"{label}.json"


def _command(study: Configuration, recording: StudyRecording, allow_code: bool) -> list[str]:
    further = ["--allow-code"] if allow_code and "--models" in recording.arguments else []
    return ["identify", *recording.arguments, "--methods", ",".join(study.methods), *further]


def _found(study: Configuration, label: str, command: Sequence[str], folder: Path, advance: Advance) -> dict[str, Any]:
    """The JSON file of the command, whose progress is shown. Raises InvalidInput where it fails."""
    part = (folder / FOLDER / f".{label}.json").resolve()
    part.parent.mkdir(exist_ok=True)
    called = [sys.executable, "-m", "crosscheck", *command, "--json", str(part)]
    said = list[str]()
    streams: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(called, cwd=study.folder, **streams) as process:
        assert process.stderr is not None
        for line in process.stderr:
            said.append(line.strip())
            advance(f"{label}: {line.strip()}", 0)
    try:
        if process.returncode not in (0, 1):
            errors = [line.removeprefix("error: ") for line in said if line.startswith("error: ")]
            reason = "; ".join(errors) or f"graphdyn identify ended with code {process.returncode}"
            raise InvalidInput(f"{study.file}: recording '{label}': {reason}")
        for line in said:
            if line.startswith("warning: "):
                say(f"recording '{label}': {line}", "yellow")
        found: dict[str, Any] = json.loads(part.read_text(encoding="utf-8"))
    finally:
        part.unlink(missing_ok=True)
    return found


def _done(file: Path) -> dict[str, Any] | None:
    """What is in the file of a recording; None where there is none, or a damaged one."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    whole = isinstance(found, dict) and found.keys() == {"asked", "methods", "found"}
    return found if whole else None


def read_recordings(folder: Path, labels: Sequence[str]) -> RecordedResults:
    """What is done of them, in this order."""
    found = {label: _done(_file(folder, label)) for label in labels}
    return {label: list(_results(one["methods"], one["found"])) for label, one in found.items() if one is not None}


def _results(names: Sequence[str], record: Mapping[str, Any]) -> Iterator[RecordedResult]:
    for name, one in zip(names, record["methods"], strict=True):
        real = None if one["failure"] else one["consistent"] and one["positive_definite"] == one["poses"]
        yield RecordedResult(name, one["mean_error"], real, one["failure"])
    for one in record["comparison"]:
        if one["cad_links"]:
            yield RecordedResult(one["name"], one["mean_error"], True, None)


def recordings_headline(found: RecordedResults) -> Verdict:
    """On how many recordings methods were compared, which ranks nothing."""
    words = counted(len(found), "real recording")
    sentence = f"Methods were compared on {words}: one split of one recording does not rank them."
    return Verdict("plain", words, sentence=sentence)


def recordings_section(found: RecordedResults) -> Iterator[Section]:
    """Methods by rows, recordings by columns, and why methods have failed."""
    if not found:
        return
    results = {label: {one.method: one for one in of} for label, of in found.items()}
    methods = dict.fromkeys(method for of in results.values() for method in of)
    rows = tuple(Row((method, *(_cell(of.get(method)) for of in results.values()))) for method in methods)
    table = Table(
        (Column("method", "name"), *(Column(label, "number", "%") for label in found)),
        rows,
        caption="Mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows. In brackets: some link or mass "
        "matrix cannot be real. One split of one recording does not rank methods.",
        failures_first=False,
    )
    reasons: dict[str, dict[str, None]] = defaultdict(dict)
    for of in found.values():
        for one in of:
            if one.failure is not None:
                reasons[one.failure][one.method] = None
    notes = tuple(Note(f"{listed(failed)}: {reason}") for reason, failed in reasons.items())
    yield Section("recordings", "Recordings", (table, *([Notes(notes)] if notes else [])))


def _cell(found: RecordedResult | None) -> str | None:
    if found is None or found.torque_error is None:
        return None
    text = f"{100 * found.torque_error:.1f}"
    return text if found.real else f"({text})"
