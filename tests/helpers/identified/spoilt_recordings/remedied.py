"""Remedies put to the test: a spoilt recording in a file, read again with the lines of its findings in the mapping."""

import tempfile
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from identified.spoilt_recordings.case import Case

from crosscheck.recordings import load_recording, mapping_of
from crosscheck.recordings.mapping.mapping import ColumnMapping

DIGITS = "%.12g"
"""Numbers of the file: rounding then stays below every noise."""


@dataclass(frozen=True, eq=False)
class Filed:
    """A case whose recording was read from a file by a mapping.

    document: the mapping as a TOML document; text: the file
    """

    case: Case
    document: dict
    text: str

    @classmethod
    def of(cls, case):
        """The recording of a case written to a file as its columns were: in front of gears and zeros."""
        columns, recording = case.file_columns, case.recording
        back, torque = np.linalg.inv(columns.position).T, np.linalg.inv(columns.torque).T
        channels = {"q": (recording.q - columns.zero) @ back, "tau": recording.tau @ torque}
        if recording.v is not None:
            channels["v"] = recording.v @ back
        units = {"q": "rad", "v": "rad/s", "tau": "N m"}
        document = {"joints": [*recording.joint_names], "time": {"column": "t", "unit": "s"}}
        for name in channels:
            listed = [f"{name}_{k}" for k in range(1, case.n + 1)]
            document[name] = {"columns": listed, "unit": units[name]}
        document["q"] |= {"offset": np.rad2deg(columns.zero).tolist(), "offset_unit": "deg"}
        if not (_is_identity(columns.position) and _is_identity(columns.torque)):
            matrices = {"matrix": np.linalg.inv(columns.position), "torque_matrix": columns.torque}
            document["transmission"] = {name: matrix.tolist() for name, matrix in matrices.items()}
            for name in channels:
                document[name]["side"] = "motor"
        header = ",".join(["t", *(column for name in channels for column in document[name]["columns"])])
        values = np.column_stack([recording.t, *channels.values()])
        rows = "\n".join(",".join(DIGITS % number for number in row) for row in values)
        return cls(case, document, f"{header}\n{rows}\n")._read()

    def remedied(self, lines):
        """The case after lines of the mapping were pasted over those that were there.

        lines: of one finding after the other. Raises BadMapping for lines that are no mapping
        """
        document = {key: dict(value) if isinstance(value, dict) else value for key, value in self.document.items()}
        for finding in lines:
            for key, value in tomllib.loads("\n".join(finding)).items():
                document[key] = document.get(key, {}) | value if isinstance(value, dict) else value
        return replace(self, document=document)._read()

    def _read(self):
        mapping: ColumnMapping = mapping_of(self.document, "the mapping")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "log.csv")
            path.write_text(self.text, encoding="utf-8")
            read = load_recording(path, mapping, joints=self.case.model.joint_names)
        return replace(self, case=replace(self.case, recording=read))


def _is_identity(matrix):
    return bool(np.array_equal(matrix, np.eye(len(matrix))))
