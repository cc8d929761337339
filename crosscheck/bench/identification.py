"""Identifications from the recording to the parameters, measured in fresh processes."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from crosscheck.bench.cold import in_fresh_process
from crosscheck.bench.machine.clocks import Clock, clock_of
from crosscheck.bench.machine.timing import Ratio, Times, ratio
from crosscheck.bench.states import States, random_states
from graphdyn import RobotModel, joint_torque_regressor
from graphdyn.layout import BODY_PARAMETERS, Array

GRAPHDYN_STREAMED, PINOCCHIO_LSTSQ = "graphdyn streamed", "pinocchio loop and lstsq"

MEMORY_COPIES = 3
"""Free memory for lstsq, as a multiple of the regressor's: the matrix, its copy for LAPACK, and a reserve."""

TEST_STATES = 1000
"""Number of other states at which the identified parameters predict torques."""


@dataclass(frozen=True)
class IdentificationRun:
    """One measured implementation of the identification.

    name: which implementation; threads: cores it is held to
    clock: what its times are: processor time on one core, wall time on several
    samples: that were worked on; if fewer than the recording has, the time of the whole is extrapolated in proportion
    times: per sample, so that runs with different numbers can be compared
    extra_bytes: peak memory besides the recording, None where the system has no figure [bytes]
    error: largest error of torques predicted at other states, relative to the largest torque
    """

    name: str
    threads: int
    clock: Clock
    samples: int
    times: Times
    extra_bytes: int | None
    error: float


@dataclass(frozen=True)
class Identifications:
    """All measured identifications.

    samples: length of the recording; entries: ours and Pinocchio's alternately, per number of threads
    """

    samples: int
    entries: tuple[IdentificationRun, ...]

    @property
    def comparisons(self) -> tuple[tuple[int, Ratio], ...]:
        """Pairs of a number of threads and the ratio."""
        pairs = zip(self.entries[0::2], self.entries[1::2], strict=True)
        return tuple((ours.threads, ratio(ours.times, theirs.times)) for ours, theirs in pairs)


def identifications(
    model: RobotModel,
    samples: int,
    seed: int,
    threads: Sequence[int],
    repeats: int,
    most_loop: int,
    done: Callable[[str], None],
) -> Identifications:
    """Measure both implementations in turns, on torques without noise.

    most_loop: largest number of samples for Pinocchio's loop; fewer where its regressor does not fit into free memory
    """
    test = random_states(model, TEST_STATES, seed + 1)
    with TemporaryDirectory(prefix="graphdyn-bench-") as name:
        whole, part = Path(name, "whole"), Path(name, "part")
        few = min(samples, most_loop, fitting_rows(model))
        states = random_states(model, samples, seed)
        _write(whole, states, samples)
        if few < samples:
            _write(part, states, few)
        else:
            part = whole
        del states
        entries = []
        for used in threads:
            records: dict[str, list[dict[str, Any]]] = {"identify_graphdyn": [], "identify_pinocchio": []}
            for _ in range(repeats):
                for task, folder in (("identify_graphdyn", whole), ("identify_pinocchio", part)):
                    done(f"{task.split('_')[1]}, {used} threads")
                    records[task].append(in_fresh_process(task, folder, used))
            entries.append(_entry(GRAPHDYN_STREAMED, used, samples, records["identify_graphdyn"], test))
            entries.append(_entry(PINOCCHIO_LSTSQ, used, few, records["identify_pinocchio"], test))
    return Identifications(samples, tuple(entries))


def fitting_rows(model: RobotModel) -> int:
    """Number of samples whose stacked regressor fits into free memory with its copies."""
    return max(1, free_memory() // (MEMORY_COPIES * 8 * BODY_PARAMETERS * model.n_bodies**2))


def free_memory() -> int:
    """Free memory [bytes]; 2 GB where the system has no figure."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return 2 * 1024**3
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))


def _write(folder: Path, states: States, samples: int) -> None:
    folder.mkdir()
    (folder / "model.pickle").write_bytes(pickle.dumps(states.model))
    for name, array in (("q", states.q), ("v", states.v), ("a", states.a), ("tau", states.torque)):
        np.save(folder / f"{name}.npy", array[:samples])


def _entry(name: str, threads: int, samples: int, records: list[dict[str, Any]], test: States) -> IdentificationRun:
    extra = [record["extra_bytes"] for record in records if record["extra_bytes"] is not None]
    clock = clock_of(threads)
    times = Times(tuple(record["seconds"][clock] / samples for record in records))
    error = _prediction_error(np.array(records[-1]["parameters"]), test)
    return IdentificationRun(name, threads, clock, samples, times, max(extra, default=None), error)


def _prediction_error(parameters: Array, test: States) -> float:
    predicted = joint_torque_regressor(test.model, test.q, test.v, test.a) @ parameters
    return float(np.abs(predicted - test.torque).max() / np.abs(test.torque).max())
