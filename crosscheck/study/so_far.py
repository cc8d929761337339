"""What a study has found so far, also while another process goes on with it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pyarrow.parquet as parquet

from crosscheck.study.folder import CONFIGURATION, DATABASE
from crosscheck.study.settings.configuration import shown_name
from crosscheck.study.settings.design import StudyDesign, study_design
from crosscheck.study.settings.recordings import recording_labels
from crosscheck.study.settings.settings import Settings, words
from crosscheck.study.statistics.outcomes import StudyOutcomes, outcomes
from crosscheck.study.store import copied
from crosscheck.study.tables import SCENARIOS, Rows, result_rows
from graphdyn import InvalidInput
from graphdyn.errors import counted
from urdf.document import toml_document


@dataclass(frozen=True, eq=False)
class StudySoFar:
    """outcomes: of whole records; facts: names and words of what all scenarios share; design: of the study

    recordings: labels of the real ones, done or not
    """

    outcomes: StudyOutcomes
    facts: tuple[tuple[str, str], ...]
    design: StudyDesign
    recordings: tuple[str, ...]


def read_so_far(folder: Path) -> StudySoFar:
    """What is in a folder. Raises InvalidInput where there is no study, or no finished run; OSError."""
    with copied(folder / DATABASE) as store:
        rows, times = result_rows(store.outcomes())
    document = toml_document((folder / CONFIGURATION).read_bytes())
    study = Settings(str(folder / CONFIGURATION), "study", document.get("study", {}))
    given = document.get("robot", [])
    robots = given if isinstance(given, list) else [given]
    if robots and not rows:
        raise InvalidInput(f"{folder} has no finished run yet; wait for one")
    waiting = _waiting(rows)
    records = {(row["scenario"], row["run"]) for row in rows}
    scenarios = parquet.read_table(folder / SCENARIOS).to_pylist()
    simulated = [
        ("robot", ", ".join(robot["name"] for robot in robots)),
        ("seed", str(study.values.get("seed", 0))),
        ("so far", f"{counted(len(records), 'record')} of {counted(len(scenarios), 'scenario')}"),
        *([("not yet everywhere", ", ".join(waiting))] if waiting else []),
    ]
    facts = [("folder", str(folder)), *(simulated if robots else [])]
    found = outcomes([row for row in rows if row["method"] not in waiting], scenarios, times)
    design = study_design(study, lambda name: shown_name(words(name)))
    return StudySoFar(found, tuple(facts), design, tuple(recording_labels(document)))


def _waiting(rows: Rows) -> Sequence[str]:
    """Methods that some record of others of their class does not have yet, as while a study is extended."""
    records: dict[str, set[tuple[str, int]]] = defaultdict(set)
    done: dict[tuple[str, str], set[tuple[str, int]]] = defaultdict(set)
    for row in rows:
        record = row["scenario"], row["run"]
        records[row["measures"]].add(record)
        done[row["measures"], row["method"]].add(record)
    return sorted(method for (measures, method), of in done.items() if of != records[measures])
