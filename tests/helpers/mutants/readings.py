"""What readers make of damaged files, against what a plain second reader finds in the same bytes.

A Reading reads a file, or refuses it in one line that names it; `fault` says what the second reader finds otherwise.
"""

from __future__ import annotations

import csv
import io
import json
import re
import time
import tomllib
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from subprocess import TimeoutExpired
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import numpy as np
import typer
import yaml
from lxml import etree
from mutants import warm_expander
from mutants.outcomes import Trial, Unexpected, quiet, tried
from planting import mixed_tree
from scipy.spatial import KDTree

import urdf
from crosscheck.commands.crosscheck.folder_file import taken_over
from crosscheck.commands.identify.models import models_of
from crosscheck.commands.program.output_files import refuse_folder
from crosscheck.commands.show.command import given_state
from crosscheck.exciting.motion_formats.krl import AxisSettings
from crosscheck.exciting.motion_formats.motion_file import read_motion
from crosscheck.exciting.srdf import disabled_pairs
from crosscheck.judging.exchange.answer_files import read_answers
from crosscheck.judging.exchange.program import ProgramFunction
from crosscheck.judging.exchange.protocols import PROTOCOLS_BY_NAME
from crosscheck.quantities.tested_function import Refusal
from crosscheck.recordings import Recording, load_mapping, load_recording
from crosscheck.study.settings.configuration import DEFAULT_RUNS, configuration_of
from crosscheck.study.store import opened
from crosscheck.study.tasks import Result, StudyOutcome
from graphdyn import GraphDynError
from graphdyn.layout import Array

REFUSALS = (GraphDynError, OSError, typer.BadParameter)

SECONDS = 5.0
"""Processor time of one small file; the first of a process, which imports readers, may take more [s]."""

GAVE_UP = 30.0
"""Time after which a program that writes a small file counts as hanging [s]."""

Numbers = Mapping[str, Array]


@dataclass(frozen=True)
class Reading:
    """A reader on trial.

    read: what the program makes of a file
    fault: what is wrong with that, by a second reading; None where nothing is
    """

    read: Callable[[Path], Any]
    fault: Callable[[Path, Any], str | None]

    def trial(self, path: Path) -> Trial:
        """Refused, or agrees with the second reader."""
        return tried(self._trial, path)

    def _trial(self, path: Path) -> Trial:
        begin = time.process_time()
        try:
            found = self.known(path)
        except REFUSALS as refusal:
            _check_message(refusal, path)
            return Trial("refused", (type(refusal).__name__,))
        finally:
            if (seconds := time.process_time() - begin) > SECONDS:
                raise Unexpected(f"reading it takes {seconds:.1f} s")
        try:
            fault = self.fault(path, found)
        except Exception as error:
            raise Unexpected(f"it is read, though the second reader says {type(error).__name__}: {error}") from error
        if fault is not None:
            raise Unexpected(fault)
        return Trial("agrees")

    def known(self, path: Path) -> Any:
        """What the program makes of a file, quietly but for warnings to the user."""
        with quiet("the reader"), warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            return self.read(path)


def _check_message(refusal: Exception, path: Path) -> None:
    problems = getattr(refusal, "problems", ()) or (getattr(refusal, "message", "") or str(refusal),)
    for text in problems:
        if path.name not in text:
            raise Unexpected(f"the refusal does not name the file: {text}")
        if "\n" in text or re.search(r"object at 0x|Traceback|<class", text):
            raise Unexpected(f"the refusal is no message for a user: {text[:1000]!r}")


def differs(what: str, here: Any, there: Any) -> str | None:
    """A line where two plain values are not the same; numbers up to rounding."""
    if isinstance(here, float | int | np.ndarray) and not isinstance(here, bool):
        one, other = np.asarray(here, dtype=float), np.asarray(there, dtype=float)
        same = one.shape == other.shape and np.allclose(one, other, rtol=1e-12, atol=0, equal_nan=True)
    else:
        same = here == there
    return None if same else f"{what} is {here!r:.300}, and by the second reader {there!r:.300}"


def first(faults: Iterable[str | None]) -> str | None:
    return next((fault for fault in faults if fault), None)


JOINTS = ("joint_1", "joint_2")


@cache
def arm() -> Any:
    """Three joints, the second of which slides."""
    return mixed_tree()


def plain_table(path: Path) -> dict[str, list[str]]:
    """Cells of a table, by the name of their column without blanks; those of blank lines, and missing ones, are "".

    Comments above are left out.
    """
    text = re.sub("\r\n|\r", "\n", path.read_bytes().decode("utf-8-sig")).strip("\n")
    above = re.match(r"(?:[ \t]*[#%][^\n]*\n|[ \t]*\n)*", text)
    text = text[above.end() :] if above else text
    if above and re.match(r"\s*[-+.\d]", text):  # the names stand in the last comment
        text = above[0].strip().rpartition("\n")[2].lstrip("#% ") + "\n" + text
    first_line = text.partition("\n")[0]
    mark = max(
        ",;\t", key=lambda mark: min(first_line.count(mark), text.partition("\n")[2].partition("\n")[0].count(mark))
    )
    mark = mark if mark in first_line else " "
    head, *rows = csv.reader(io.StringIO(text, newline=""), delimiter=mark, skipinitialspace=True)
    rows = [[*row, *[""] * (len(head) - len(row))] for row in rows]
    if mark != ",":
        rows = [[cell.replace(",", ".") for cell in row] for row in rows]
    return {re.sub(r"\s", "", name): [row[k].strip() for row in rows] for k, name in enumerate(head)}


# Motions


def motion(path: Path) -> tuple[Array, Array]:
    course = read_motion(path, arm(), AxisSettings())
    return course.times, course.positions


def motion_fault(second: Callable[[Path], tuple[Array, Array]]) -> Callable[[Path, Any], str | None]:
    def fault(path: Path, found: tuple[Array, Array]) -> str | None:
        times, positions = second(path)
        late = np.abs(found[0] - (times - times[0])).max() if len(times) == len(found[0]) else np.inf
        if late > 1e-9 * max(1.0, np.abs(times).max()):
            return f"times {found[0]!r:.200}, and by the second reader {times!r:.200}"
        return differs("positions", found[1], positions)

    return fault


SI = {"rad": 1.0, "m": 1.0, "mm": 1e-3, "s": 1.0}
"""Units that a garbled letter makes of others."""


def csv_motion(path: Path) -> tuple[Array, Array]:
    table, names = plain_table(path), ["time", *(f"{joint}.q" for joint in arm().independent_joints)]
    of = {re.sub("(?i)^times?$", "time", name.partition("[")[0]): name for name in table}
    factors = np.array([SI[of[name].rstrip("]").partition("[")[2]] for name in names])
    rows = [row for row in zip(*(table[of[name]] for name in names), strict=True) if any(row)]
    with path.open(encoding="utf-8-sig", newline="") as opened:
        head = [cell.strip() for cell in next(csv.reader(opened), [])]
    if "joint3.a [rad/s^2]" not in head and not all(rows[-1]):
        rows.pop()  # of a recording, which is cut off, with a warning
    columns = (np.array(rows, dtype=float) * factors).T
    return columns[0], columns[1:].T


def yaml_motion(path: Path) -> tuple[Array, Array]:
    message = yaml.load(path.read_bytes(), yaml.CSafeLoader)
    points = message["points"]
    times = [point["time_from_start"]["sec"] + point["time_from_start"]["nanosec"] * 1e-9 for point in points]
    order = [message["joint_names"].index(name) for name in arm().independent_joints]
    rows = [[float(x) for x in point["positions"]] for point in points]
    return np.array(times), np.array(rows)[:, order]


def urscript_motion(path: Path) -> tuple[Array, Array]:
    text = path.read_text("utf-8-sig")
    rows = re.findall(r"servoj\(\[([^]]*)\]", text)
    (period,) = re.findall(r"period\s*=\s*(\S+)", text)
    return float(period) * np.arange(len(rows)), np.array([row.split(",") for row in rows], dtype=float)


def krl_motion(path: Path) -> tuple[Array, Array]:
    text = path.read_text("utf-8-sig")
    rows = re.findall(r"PTP \{A1 ([^,]*),E1 ([^,]*),A2 ([^}]*)\}", text)
    (duration,) = re.findall(r"TIME_BLOCK END = (\S+)", text)
    units = np.radians(1.0), 1e-3, np.radians(1.0)
    return np.linspace(0, float(duration), len(rows)), np.array(rows, dtype=float) * units


# Recordings

FACTORS = (1.0, np.pi / 180, 1e-3, 1e-6, 1e-9)
"""SI values of units that names of columns may state."""


TIMES = {"t", "time", "time[s]"}


def recording(path: Path) -> Recording:
    return load_recording(path, joints=JOINTS)


def recording_fault(second: Callable[[Path], Numbers]) -> Callable[[Path, Any], str | None]:
    """Each column that is read is one of the file: that of its name, or where the name is damaged any."""

    def fault(path: Path, found: Recording) -> str | None:
        columns, said = second(path), " ".join(finding.text for finding in found.findings)
        n = max(len(column) for name, column in columns.items() if name in TIMES or not TIMES & set(columns))
        if len(found.t) < n and not re.search("dropped|left out", " ".join((*found.provenance.steps, said))):
            return f"{len(found.t)} of {n} rows, and no word of it: {said}"

        def one(what: str, values: Array, names: Sequence[str]) -> str | None:
            known = [columns[name] for name in names if name in columns] or list(columns.values())
            rows = [column[found.rows] for column in known if len(column) > found.rows.max()]
            if what == "t":
                rows = [row - row[0] for row in rows]
                values = values - values[0]
            for row in rows:
                for factor in FACTORS:
                    if np.allclose(values, factor * row, rtol=1e-9, atol=1e-9 if what == "t" else 0, equal_nan=True):
                        return None
            return f"{what} is {values!r:.200}, which is no column of the file; of its name {rows[:1]!r:.200}"

        channels = [("t", found.t, tuple(TIMES))]
        for name in ("q", "v", "tau"):
            values = getattr(found, name)
            if values is not None:
                channels += [(name, values[:, k], (f"{name}_{k + 1}",)) for k in range(len(JOINTS))]
        return first(one(*channel) for channel in channels)

    return fault


def csv_columns(path: Path) -> Numbers:
    return {name: np.array([_number(cell) for cell in cells]) for name, cells in plain_table(path).items()}


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan


def by_joint(arrays: Mapping[str, Any]) -> Numbers:
    """Columns of arrays (N, n) and (N,) of numbers, name_1, name_2 and so on."""
    columns: dict[str, Array] = {}
    for name, values in arrays.items():
        x = np.asarray(values)
        if x.dtype.kind not in "fiu":
            continue
        if x.ndim == 2:
            rows = x.T if x.shape[0] > x.shape[1] or x.shape[1] > 2 * len(JOINTS) else x
            rows = x.T if x.shape[0] >= x.shape[1] else x
            if len(rows) == 1:
                columns[name] = rows[0].astype(float)
            columns |= {f"{name}_{k + 1}": row.astype(float) for k, row in enumerate(rows)}
        elif x.ndim == 1:
            columns[name] = x.astype(float)
    return columns


def npz_columns(path: Path) -> Numbers:
    with np.load(path) as archive:
        return by_joint(dict(archive))


def mat_columns(path: Path) -> Numbers:
    from scipy.io import loadmat

    return by_joint({k: np.squeeze(x) for k, x in loadmat(path).items() if not k.startswith("__")})


def mat73_columns(path: Path) -> Numbers:
    import h5py

    found: dict[str, Any] = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()]}) if hasattr(item, "shape") else None)
    return by_joint({name: np.squeeze(x) for name, x in found.items()})


def parquet_columns(path: Path) -> Numbers:
    from pyarrow import parquet

    table = parquet.read_table(path)
    found = {}
    for name in table.column_names:
        values = table[name].to_pylist()
        try:
            found[name] = np.array([np.nan if x is None else x for x in values], dtype=float)
        except (TypeError, ValueError):
            continue
    return by_joint(found)


def bag_columns(path: Path) -> Numbers:
    """The messages of the topic, as rosbags gives them."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    rows: dict[str, list[Any]] = {}
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        for connection, received, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            if not set(JOINTS) <= set(message.name):
                continue
            order = [list(message.name).index(name) for name in JOINTS]
            rows.setdefault("time", []).append(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec)
            rows.setdefault("received", []).append(received)
            for name, values in (("q", message.position), ("v", message.velocity), ("tau", message.effort)):
                for k, place in enumerate(order):
                    if len(values):
                        rows.setdefault(f"{name}_{k + 1}", []).append(float(values[place]))
    stamps = rows["time"] if any(rows["time"]) else rows["received"]
    rows["time"] = [(stamp - stamps[0]) * 1e-9 for stamp in stamps]
    return {name: np.array(values, dtype=float) for name, values in rows.items()}


# Answers


def answers(path: Path) -> dict[int, Array]:
    return {number: answer.numbers for number, answer in read_answers([path]).items()}


def answers_fault(second: Callable[[Path], Iterable[tuple[Any, Any]]]) -> Callable[[Path, Any], str | None]:
    def fault(path: Path, found: dict[int, Array]) -> str | None:
        there = {int(number): np.asarray(numbers, dtype=float).ravel() for number, numbers in second(path)}
        return differs("ids", sorted(found), sorted(there)) or first(
            differs(f"answer {number}", found[number], there[number]) for number in found
        )

    return fault


def csv_answers(path: Path) -> Iterable[tuple[Any, Any]]:
    first_line, *lines = re.split("\r\n|\n|\r", path.read_bytes().decode("utf-8-sig", "replace"))
    for line in [first_line, *lines] if re.match(r"\s*[-+.\d]", first_line) else lines:
        cells = [cell for cell in re.split(r"[\s,;]+", line.strip()) if cell]
        if cells:
            yield float(cells[0]), [float(cell) for cell in cells[1:]]


def flat(x: Any) -> list[Any]:
    return [one for y in x for one in flat(y)] if isinstance(x, list) else [np.nan if x is None else x]


def json_answers(path: Path) -> Iterable[tuple[Any, Any]]:
    return [(row["id"], flat(row["answer"])) for row in json.loads(path.read_bytes())]


def npz_answers(path: Path) -> Iterable[tuple[Any, Any]]:
    with np.load(path) as archive:
        pairs = [(name, f"{name[:-2]}answer") for name in archive if name == "id" or name.endswith(".id")]
        return [pair for one, other in pairs for pair in zip(archive[one], archive[other], strict=True)]


def parquet_answers(path: Path) -> Iterable[tuple[Any, Any]]:
    from pyarrow import parquet

    table = parquet.read_table(path)
    return [(i, flat(x)) for i, x in zip(table["id"].to_pylist(), table["answer"].to_pylist(), strict=True)]


ASKED = 3
"""Questions that a program answers, a line for each."""


def spoken(protocol: str) -> Callable[[Path], list[Any]]:
    """What is taken from a program that writes the file."""

    def read(path: Path) -> list[Any]:
        states = [dict.fromkeys("qva", np.zeros(2))] * ASKED
        with ProgramFunction(["cat", str(path)], f"cat {path}", PROTOCOLS_BY_NAME[protocol], GAVE_UP) as program:
            return program.answers("inverse_dynamics", states, (2,))

    return read


def spoken_fault(second: Callable[[str], Any]) -> Callable[[Path, Any], str | None]:
    """An answer is numbers, or a text where the program says that it has none."""

    def fault(path: Path, found: list[Any]) -> str | None:
        lines = [line.strip() for line in path.read_bytes().decode(errors="replace").split("\n")]
        there = [second(line) for line in lines if line]
        return differs("number of answers", len(found), len(there)) or first(
            f"answer {k} is {one!r}, and by the second reader {other!r}"
            if isinstance(one, Refusal) != isinstance(other, str)
            else None
            if isinstance(one, Refusal)
            else differs(f"answer {k}", one, np.array(other, dtype=float))
            for k, (one, other) in enumerate(zip(found, there, strict=True))
        )

    return fault


def spoken_numbers(line: str) -> Any:
    return line if line.startswith("error") else [float(cell) for cell in re.split(r"[\s,;]+", line) if cell]


def spoken_json(line: str) -> Any:
    found = json.loads(line)
    return str(found["error"]) if "error" in found else flat(found["answer"])


def written_folder(path: Path) -> list[str]:
    """The files of a folder, which may be written anew, as the table in it lists all of them."""
    folder = path.with_name(f"{path.name} and others")
    folder.mkdir(exist_ok=True)
    for name in FILES_OF_FOLDER:
        (folder / name).write_bytes(b"")
    (folder / "vectors.json").write_bytes(path.read_bytes())
    refuse_folder("--out", folder, "vectors.json")
    return [*FILES_OF_FOLDER]


FILES_OF_FOLDER = ("model.json", "inverse_dynamics.csv")


def written_folder_fault(path: Path, found: list[str]) -> str | None:
    left_out = set(found) - set(json.loads(path.read_bytes())["files"])
    return f"{left_out} would be lost" if left_out else None


# Settings in TOML and JSON


def mapping(path: Path) -> Any:
    return load_mapping(path)


def mapping_fault(path: Path, found: Any) -> str | None:
    there = tomllib.loads(path.read_text("utf-8"))

    def columns(name: str) -> list[Any]:
        given = there[name]["columns"]
        if isinstance(given, str):
            numbered = enumerate(there["joints"], start=1)
            return [given.replace("{number}", str(k)).replace("{joint}", joint) for k, joint in numbered]
        return list(given)

    gain = there["tau"].get("gain", 1.0) if "tau" in there else 1.0
    return first(
        [
            differs("joints", list(found.joints), there["joints"]),
            differs("channels", sorted(found.channels), sorted({"q", "v", "a", "tau", "temperature"} & set(there))),
            *(differs(f"columns of {n}", list(channel.columns), columns(n)) for n, channel in found.channels.items()),
            *(differs(key, getattr(found, key), there.get(key)) for key in ("rate", "decimal", "delimiter", "topic")),
            differs("time", found.time and found.time.column, there.get("time", {}).get("column")),
            differs(
                "size of the gain of tau",
                np.abs(found.channels["tau"].factor) if "tau" in found.channels else 0.0,
                np.abs(np.broadcast_to(np.asarray(gain, float), len(found.joints))) if "tau" in found.channels else 0.0,
            ),
        ]
    )


def study(path: Path) -> Any:
    return configuration_of(path.read_bytes(), path.name, path.parent)


def study_fault(path: Path, found: Any) -> str | None:
    there = tomllib.loads(path.read_text("utf-8"))

    def plain(value: Any) -> Any:
        if isinstance(value, list | tuple):
            return [plain(one) for one in value]
        return float(value) if isinstance(value, int) and not isinstance(value, bool) else value

    faults = [differs(key, getattr(found, key), there["study"].get(key, default)) for key, default in (("seed", 0),)]
    faults.append(differs("runs", found.runs, there["study"].get("runs", DEFAULT_RUNS)))
    robots = there.get("robot", [])
    of_robots = zip(robots if isinstance(robots, list) else [robots], found.robots, strict=False)
    for table, settings in (*of_robots, (there.get("errors", {}), found.errors)):
        known = {field.name for field in fields(settings)}
        for key, value in table.items():
            if key not in known:
                continue
            faults.append(differs(key, plain(getattr(settings, key)), plain(value)))
    grids = there.get("grid", [{}])
    points = sum(
        int(np.prod([len(x) if isinstance(x, list) else 1 for x in {**there.get("scenario", {}), **grid}.values()]))
        for grid in grids
    )
    faults.append(differs("at most so many scenarios", min(points, len(found.scenarios)), len(found.scenarios)))
    for key, value in there.get("scenario", {}).items():
        allowed = value if isinstance(value, list) else [value]
        grid = [x for one in grids for x in (one.get(key, []) if isinstance(one.get(key), list) else [one.get(key)])]
        given = {str(float(x)) if isinstance(x, int) and key != "motion_seed" else str(x) for x in [*allowed, *grid]}
        odd = [x for point in found.scenarios if str(x := getattr(point, key)) not in given]
        faults.append(f"{key} of a scenario is {odd[0]!r}, not of {given}" if odd else None)
    return first(faults)


def models(path: Path) -> Any:
    return models_of(path, ["wls"], (), (), known_bodies=False, allow_code=False)


def models_fault(path: Path, found: Any) -> str | None:
    there = tomllib.loads(path.read_text("utf-8"))
    return first(
        [
            differs("names", [model.name for model in found], list(there)),
            *(
                differs(
                    f"number of terms of {model.name}", len(model.terms), 1 + len(there[model.name].get("terms", ()))
                )
                for model in found
            ),
        ]
    )


def state(path: Path) -> Any:
    return given_state(str(path), arm())


def state_fault(path: Path, found: Any) -> str | None:
    there = json.loads(path.read_bytes())
    q, v = found
    return differs("q", np.asarray(q, float), there["q"]) or differs("v", np.asarray(v, float), there.get("v", 0 * q))


@cache
def stored() -> dict[tuple[str, int], StudyOutcome]:
    """Outcomes of a study."""
    found = StudyOutcome(
        (Result("wls", "torques", None, 3, base=(1.5, -2.0, 0.25), sigma=(0.1, 0.2, 0.3)),), (0.5,), 1.0
    )
    lost = StudyOutcome((Result("wls", "torques", "no base"),), (None,), 0.25)
    return {(f"{k:016x}", run): found if run else lost for k in range(4) for run in range(3)}


INPUTS = {"configuration": "[study]\nseed = 3\n", "versions": "{}"}


def study_store(path: Path) -> tuple[dict[str, str], dict[tuple[str, int], StudyOutcome], list[str]]:
    """Of a copy, which reading may mend; what a study was begun with, what is done, and what is said."""
    told: list[str] = []
    copied = path.with_name(f"copy_{path.name}")
    copied.write_bytes(path.read_bytes())
    try:
        with opened(copied, told.append) as store:
            return store.inputs(), dict(store.outcomes()), told
    finally:
        for file in path.parent.glob(f"{copied.name}*"):
            file.unlink()


HEADER_BYTES = 100
"""Of a database of SQLite, which takes less for an empty one [bytes]."""


def study_store_fault(path: Path, found: Any) -> str | None:
    """Whatever is there is what was written; what is lost is said, or the whole file is empty."""
    inputs, outcomes, told = found
    odd = [key for key, outcome in outcomes.items() if stored().get(key) != outcome]
    if odd:
        return f"the outcome of {odd[0]} is another than was written"
    if not inputs and not outcomes and path.stat().st_size < HEADER_BYTES:
        return None
    if inputs != INPUTS:
        return f"what it was begun with is {inputs}, another than was written"
    return None if told or len(outcomes) == len(stored()) else "tasks are lost, and no word of it"


def sweep(path: Path) -> dict[str, Any]:
    return taken_over(path, [str(urdf_file())], 1, 0)


def urdf_file() -> Path:
    return next(entry.path for entry in urdf.robots() if entry.name == "kr500")


def sweep_fault(path: Path, found: dict[str, Any]) -> str | None:
    there = json.loads(path.read_bytes())
    records = {record["robot"]: record for record in there["robots"] if isinstance(record, dict) and "robot" in record}
    return first(differs(robot, record, records[robot]) for robot, record in found.items())


# Documents beside a robot's


LINKS = ("base", "upper", "fore", "hand", "tool")


def srdf(path: Path) -> set[frozenset[str]]:
    off = disabled_pairs(path, LINKS)
    return {frozenset((one, other)) for one in LINKS for other in LINKS if one < other and off(one, other)}


def srdf_fault(path: Path, found: set[frozenset[str]]) -> str | None:
    root = etree.fromstring(path.read_bytes())
    assert root.tag == "robot"

    def pairs(tag: str) -> set[frozenset[str]]:
        return {frozenset((e.attrib["link1"], e.attrib["link2"])) for e in root.findall(tag)}

    off, on = pairs("disable_collisions"), pairs("enable_collisions")
    by_default = {element.attrib["link"] for element in root.findall("disable_default_collisions")}
    for one in LINKS:
        for other in LINKS:
            pair = frozenset((one, other))
            if one < other and by_default & pair and pair not in on:
                off.add(pair)
    known = {frozenset((one, other)) for one in LINKS for other in LINKS if one < other}
    return differs("pairs", sorted(map(sorted, found)), sorted(map(sorted, off & known)))


def loop_yaml(path: Path) -> Any:
    from urdf.document.connections.loop_yaml import read_yaml

    return read_yaml(path)


def loop_yaml_fault(path: Path, found: Any) -> str | None:
    there = yaml.load(path.read_bytes(), yaml.BaseLoader)
    kinds = {"6": "weld", "3": "ball"}
    loops = [(pair[0], pair[1], kinds[kind[0]]) for pair, kind in zip(there["closed_loop"], there["type"], strict=True)]
    return differs("loops", [(loop.link_i, loop.link_j, loop.kind) for loop, _ in found.loops], loops) or differs(
        "motors", [motor.joint for motor in found.motors], list(there.get("name_mot") or [])
    )


HEAVIER = 1.5


def updated(path: Path) -> tuple[Any, Any]:
    """The robot, and the one of a copy of the file into which heavier bodies are written."""
    copied = path.with_name(f"heavier_{path.name}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = urdf.load(path)
        urdf.update(path, copied, HEAVIER * model.inertial_parameters, inconsistent=True)
        return model, urdf.load(copied)


def updated_fault(path: Path, found: tuple[Any, Any]) -> str | None:
    """All bodies are heavier, and nothing else has changed."""
    model, again = found
    wanted, written = (x.reshape(-1, 10) for x in (HEAVIER * model.inertial_parameters, again.inertial_parameters))
    off = np.abs(written - wanted) > 1e-9 * np.abs(wanted).max(axis=1, keepdims=True)
    if off.any():
        return f"the parameters are {written[off]!r:.200}, not {wanted[off]!r:.200}"

    def others(document: Path) -> bytes:
        root = etree.fromstring(document.read_bytes())
        for inertial in root.findall("{*}link/{*}inertial"):
            inertial.getparent().remove(inertial)
        for element in root.iter():
            element.tail = None
            element.text = None if len(element) or not (element.text or "").strip() else element.text
        return etree.tostring(root, method="c14n")

    return differs("the rest of the file", others(path.with_name(f"heavier_{path.name}")), others(path))


def xacro(path: Path) -> Any:
    from urdf.document.xacro import files

    with patch.object(files, "subprocess", SimpleNamespace(run=warm_expander.run, TimeoutExpired=TimeoutExpired)):
        return urdf.load(path, mimic="independent")


def xacro_fault(path: Path, found: Any) -> str | None:
    """The robot is that of the document that the package xacro makes of the file."""
    import xacro as package

    with quiet("xacro"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        package.init_stacks(str(path))
        document = package.parse(io.BytesIO(path.read_bytes()))
        package.process_doc(document, mappings={})
        there = urdf.load(document.toxml(), mimic="independent")
    return first(
        [
            differs("bodies", found.body_names, there.body_names),
            differs("joints", found.joint_names, there.joint_names),
            differs("parameters", found.inertial_parameters, there.inertial_parameters),
            differs("axes", np.array([j.axis for j in found.joints]), np.array([j.axis for j in there.joints])),
        ]
    )


# Meshes


def mesh(path: Path) -> Array:
    from urdf.geometry.meshes.mesh_files import read_mesh
    from urdf.geometry.shape import UnreadableMesh

    try:
        parts = read_mesh(path)
    except UnreadableMesh as error:
        raise urdf.URDFError(f"{path}: {error}", "") from None  # as the list of what is not drawn has it
    return np.concatenate([part.vertices[part.faces].reshape(-1, 3) for part in parts])


def mesh_fault(second: Callable[[Path], Array]) -> Callable[[Path, Any], str | None]:
    """The triangles are those of the file; of those without area, or there twice, none may be left."""

    def fault(path: Path, found: Array) -> str | None:
        there = second(path)
        size = max(float(np.abs(there).max(initial=0.0)), 1e-30)
        (one, _), (other, area) = (_triangles(x / size) for x in (found, there))
        if not len(one) or KDTree(other).query(one)[0].max() > 1e-5:
            return "a triangle is none of those of the second reader"
        lost = area[KDTree(one).query(other)[0] > 1e-5]
        return f"{len(lost)} triangles are lost that the second reader has" if lost.max(initial=0.0) > 1e-5 else None

    return fault


def _triangles(corners: Array) -> tuple[Array, Array]:
    """Where each lies, in whatever order its corners are: middle, ends and spread along the axes; and its area."""
    x = np.asarray(corners, dtype=float).reshape(-1, 3, 3)
    area = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
    middle = x.mean(axis=1)
    spread = np.abs(x - middle[:, None]).sum(axis=1)
    return np.hstack([middle, x.min(axis=1), x.max(axis=1), spread]), area


def binary_stl(path: Path) -> Array:
    content = path.read_bytes()
    number = int.from_bytes(content[80:84], "little")
    triangle = np.dtype([("n", "<f4", 3), ("x", "<f4", 9), ("a", "<u2")])
    rows = np.frombuffer(content[84 : 84 + 50 * number], dtype=triangle)
    return rows["x"].astype(float)


def ascii_stl(path: Path) -> Array:
    found = re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", path.read_bytes(), re.IGNORECASE)
    return np.array(found, dtype=float)


def obj(path: Path) -> Array:
    vertices, triangles = [], []
    for line in path.read_bytes().decode(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        if words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [k - 1 if k > 0 else len(vertices) + k for k in corners]
            triangles += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
    return np.array(vertices)[np.array(triangles)].reshape(-1, 3)


def collada(path: Path) -> Array:
    """The one geometry of the file, in whatever namespace; its counts are those that it states."""
    root = etree.fromstring(path.read_bytes(), etree.XMLParser(huge_tree=True))
    unit, floats, faces = map(root.find, ("./{*}asset/{*}unit", ".//{*}float_array", ".//{*}triangles"))
    corners = root.find(".//{*}triangles/{*}p")
    meter = float(unit.get("meter", "1")) if unit is not None else 1.0
    numbers, places = floats.text.split(), corners.text.split()
    assert floats.get("count") in (None, str(len(numbers)))
    assert faces.get("count") in (None, str(len(places) // 6))
    return np.array(numbers, dtype=float).reshape(-1, 3)[np.array(places[::2], dtype=float).astype(int)] * meter
