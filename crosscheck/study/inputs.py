"""What the results of a study depend on, and their tables: versions, and SHA-256 of all files."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path

from crosscheck.study.folder import CONFIGURATION, CONFIGURATION_ORIGIN, CONFIGURATION_TEXT, DATABASE
from crosscheck.study.settings.configuration import hash_of
from crosscheck.study.store import copied
from crosscheck.study.tables import RESULTS, SCENARIOS


@dataclass(frozen=True)
class StudyInputs:
    """software: versions with which it was computed; files: SHA-256 of what it has read and of its tables, by name

    origin: of the configuration: its whole path, or the name of one of the package
    """

    software: dict[str, str] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    origin: str = ""

    @property
    def has_code(self) -> bool:
        """Whether it has run code of one's own."""
        return any(name.endswith(".py") for name in self.files)


NO_INPUTS = StudyInputs()


def read_inputs(folder: Path) -> StudyInputs:
    """Raises InvalidInput where there is no study, OSError."""
    with copied(folder / DATABASE) as store:
        inputs = store.inputs()
    text, origin = inputs.pop(CONFIGURATION_TEXT, ""), inputs.pop(CONFIGURATION_ORIGIN, str(folder / CONFIGURATION))
    files = {name: value for name, value in inputs.items() if Path(name).is_absolute()}
    tables = {name: hash_of(folder / name) for name in (RESULTS, SCENARIOS) if (folder / name).is_file()}
    software = {name: value for name, value in inputs.items() if name not in files}
    own = {CONFIGURATION: hashlib.sha256(text.encode()).hexdigest()}
    return StudyInputs(software, {**own, **files, **tables}, origin)
