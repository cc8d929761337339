"""Recordings of any length, summed up part by part: in this process, in others, or on the workers of a scheduler."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from os import PathLike
from typing import Any, TypeVar, cast

from crosscheck.distributing import Lost, NoWorkers, Workers
from crosscheck.recordings.mapping.mapping import ColumnMapping, given_mapping
from crosscheck.recordings.parts.free_memory import give_back_free_memory
from crosscheck.recordings.parts.partitions import Partition, ReadableLog, log_of, partitions
from crosscheck.recordings.preparation.derivatives import chosen_cutoff
from graphdyn import GraphDynError, InvalidInput
from graphdyn.display import short_repr
from graphdyn.identification import Problem, Samples, TorqueModel

T = TypeVar("T")

PROBLEM_SETTINGS = ("min_speed", "compression", "rank_tolerance")
"""Fields of a problem that its parts share."""

CHECKED_ROWS = 65_536
"""Number of rows that are checked at once, and from which a cutoff is chosen: two to ten minutes of a log, at rates at
which long logs are recorded."""

ROWS_PER_PART = 250_000
"""Default number of rows of a part: a second of work, some 50 MB of memory for a six-axis arm."""


@dataclass(frozen=True)
@short_repr
class PartitionedRecording:
    """Long logs in Parquet or CSV files for graphdyn.identification.Problem(data=…), processed part by part.

    paths: files, each a log of its own; CSV is converted to temporary Parquet files, which workers on other machines do
        not see; or folders, each one log in consecutive parts, in the order of the
        numbers in their names. Parts of one log overlap by the borders of the filter; different logs do not
    mapping, joints, rate: as in load_recording, for all logs; joints in the order of the robot
    cutoff: as in differentiated, [Hz] of all channels or per channel; None: no filter
    between: part of every log, from 0 to 1; a quarter of a second is left out before an end within the log
    rows: largest number of rows of a part
    workers: of crosscheck.distributing: processes, or those of a Dask scheduler; None: this process

    The files, `rows`, the filter and the number of time blocks alone determine the parts, and their results are
    merged in a fixed order: the result is the same to the last bit for any number and kind of workers, on processors of
    one type. There is no list of findings: rows that load_recording would drop or resample raise InvalidInput, with
    the row. Raises BadRecordingFile, BadMapping, OSError likewise; NoWorkers.
    """

    paths: Sequence[str | PathLike[str]]
    mapping: ColumnMapping | str | PathLike[str] | None = None
    joints: Sequence[str] | None = None
    rate: float | None = None
    cutoff: float | Mapping[str, float] | None = None
    between: tuple[float, float] = (0.0, 1.0)
    rows: int = ROWS_PER_PART
    workers: Workers | None = None

    @cached_property
    def logs(self) -> list[ReadableLog]:
        """The logs in the order given. Raises InvalidInput if there is none, or if one is given twice."""
        mapping = given_mapping(self.mapping, self.rate)
        logs = [log_of(path, mapping) for path in self.paths]
        files = [log.told(file).resolve() for log in logs for file in log.files]
        twice = next((file for file, count in Counter(files).items() if count > 1), None)
        if not logs or twice:
            what = f"{twice} is given twice; rows that count twice look more certain than they are"
            raise InvalidInput(what if logs else "there is no log; give at least one")
        if isinstance(self.cutoff, str):
            raise InvalidInput(f"cutoff is '{self.cutoff}'; give it in Hz, or per channel, or None")
        joints = None if self.joints is None else tuple(self.joints)
        if not 0 <= self.between[0] < self.between[1] <= 1:
            raise InvalidInput(f"between is {self.between}; give two numbers from 0 to 1, the smaller one first")
        return [ReadableLog.of(log, mapping, joints, self.rate, self.cutoff, self.between) for log in logs]

    @property
    def n_rows(self) -> int:
        """Number of rows of all logs, as recorded."""
        return sum(source.n_rows for source in self.logs)

    def check(self) -> None:
        """Read all rows. Raises InvalidInput and BadRecordingFile for logs that cannot be read in parts."""
        for source in self.logs:
            for first in range(source.begin, source.end, CHECKED_ROWS):
                source.read(max(first - 1, source.begin), min(first + CHECKED_ROWS, source.end))

    def residual_cutoff(self) -> float:
        """The largest cutoff [Hz] that residual analysis chooses at the beginning of a log, as in chosen_cutoff."""
        return max(
            chosen_cutoff(source.read(source.begin, min(source.begin + CHECKED_ROWS, source.end)))
            for source in self.logs
        )

    def parts(self, blocks: int) -> list[Partition]:
        """The parts for this number of time blocks."""
        return partitions(self.logs, self.rows, blocks)

    def __iter__(self) -> Iterator[Samples]:
        """The samples in order, for methods that look at each: one part after the other, in this process."""
        for part in self.parts(1):
            samples, own = part.samples(0)
            yield samples[own]

    def each_part(self, problem: Problem, function: Callable[[Problem, slice], T]) -> list[tuple[int, T]]:
        """Results of every part, as in graphdyn.identification.data.samples.Partitioned."""
        in_block = problem.block_samples
        parts = self.parts(problem.n_blocks if in_block is None else -(-self.n_rows // in_block))
        torque_model = problem.torque_model
        settings = {name: getattr(problem, name) for name in PROBLEM_SETTINGS}
        base = problem.structure.base.independent.tobytes()
        work = partial(_work, _pickled(torque_model), base, settings, pickle.dumps(function))
        answers = enumerate(map(work, parts)) if self.workers is None else self.workers.each(work, parts)
        found: dict[int, T] = {}
        for k, answer in answers:
            if isinstance(answer, Lost):
                raise NoWorkers(f"{parts[k].name}: {answer.reason}")
            if isinstance(answer, Exception):
                raise answer
            found[k] = cast(T, answer)
            if problem.progress is not None:
                problem.progress(parts[k].last - parts[k].first)
        return [(parts[k].block, found[k]) for k in range(len(parts))]


@lru_cache(maxsize=8)
def _pickled(torque_model: TorqueModel) -> bytes:
    """The pickled model, the same for every reading, by which a worker recognizes a model that it has compiled already.

    Raises InvalidInput.
    """
    try:
        return pickle.dumps(torque_model)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise InvalidInput(
            f"the torque model cannot be sent to other processes: {error}; define its terms and known torques by class "
            "or def at the top of a file, not by lambda or in a function"
        ) from error


@lru_cache(maxsize=8)
def _unpickled(torque_model: bytes) -> TorqueModel:
    found: TorqueModel = pickle.loads(torque_model)
    return found


def _work(torque_model: bytes, base: bytes, settings: Mapping[str, Any], function: bytes, part: Partition) -> object:
    """The result for one part, or the error. base: numbers of the base parameters; settings: of the problem."""
    try:
        samples, own = part.samples(part.source.memory)
        problem = Problem(
            _unpickled(torque_model), samples, block_samples=len(samples) or 1, cached_bytes=0.0, **settings
        )
        if problem.structure.base.independent.tobytes() != base:
            raise NoWorkers("a worker finds other base parameters; use workers with processors of one type")
        return pickle.loads(function)(problem, own)
    except ImportError as error:
        return NoWorkers(f"a worker cannot import a part of the torque model ({error}); install it there")
    except (GraphDynError, OSError) as error:
        return error
    finally:
        give_back_free_memory()
