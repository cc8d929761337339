"""Whether two Dask workers, one of them killed half way, sum up ten million rows like one process.

    python tests/tools distributed_rows [ROWS] [none|q|all] [FOLDER]

The filter is none, a low-pass of 10 Hz on the positions, or on the torque and every column of the regressor as well.
Prints whether the factors agree to the last bit, rows per second, and the processor time of a row, from which follows
what two workers do that have a processor each. The log is written to FOLDER unless it is there, 1 GB for ten million
rows.
"""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
from distributed import LocalCluster
from pyarrow import parquet

import graphdyn
from crosscheck.distributing import DaskWorkers
from crosscheck.recordings import PartitionedRecording
from graphdyn.identification import Problem, TorqueModel

RATE = 1000.0
"""Of the log [Hz]."""

IN_FILE = 1_000_000
"""Rows of a file."""

CUTOFFS = {"none": None, "q": {"q": 10.0}, "all": 10.0}


def write_log(folder: Path, rows: int) -> None:
    """One log in several files: a KR500 in a Fourier motion with friction and noise."""
    robot, rng = graphdyn.kr500(), np.random.default_rng(0)
    amplitude, phase = rng.normal(size=(2, 5, 6)) * 0.2
    speed = 2 * np.pi * 0.1 * np.arange(1, 6)[:, None, None]
    begun = folder.with_name(f"{folder.name}.begun")
    begun.mkdir(parents=True, exist_ok=True)
    for k, first in enumerate(range(0, rows, IN_FILE)):
        t = np.arange(first, min(first + IN_FILE, rows)) / RATE
        angle = speed * t[:, None] + phase[:, None]
        q, v, a = (
            np.sum(amplitude[:, None] * part, axis=0)
            for part in (np.sin(angle), speed * np.cos(angle), -(speed**2) * np.sin(angle))
        )
        tau = graphdyn.joint_torques(robot, q, v, a) + 20 * v + 50 * np.sign(v) + rng.normal(size=q.shape)
        q += 1e-6 * rng.normal(size=q.shape)
        columns = {f"{name}_{j + 1}": of[:, j] for name, of in (("q", q), ("tau", tau)) for j in range(6)}
        parquet.write_table(pa.table({"time_s": t, **columns}), begun / f"part.{k}.parquet")
    begun.rename(folder)


def summed(problem: Problem) -> tuple[bytes, float]:
    """The factors, and the time that they took [s]."""
    start = time.perf_counter()
    return b"".join(part.factors.tobytes() for part in problem.recorded), time.perf_counter() - start


def main() -> int:
    """Exit code: whether the factors differ."""
    given = dict(enumerate(sys.argv[1:]))
    rows, cutoff = int(float(given.get(0, "1e7"))), given.get(1, "q")
    folder = Path(given.get(2, Path(tempfile.gettempdir()) / "graphdyn_distributed_rows"))
    log = folder / f"log_{rows}"
    if not log.exists():
        write_log(log, rows)
    torque_model = TorqueModel(graphdyn.kr500())
    data = PartitionedRecording([log], cutoff=CUTOFFS[cutoff])
    _ = Problem(torque_model, data).structure
    before = time.process_time()
    here, seconds = summed(Problem(torque_model, data))
    spent = time.process_time() - before
    print(f"filter {cutoff}, {rows} rows in {len(data.parts(20))} parts")
    print(f"one process:           {rows / seconds:9.0f} rows/s; {1e6 * spent / rows:.2f} µs of processor time a row")
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        there = PartitionedRecording([log], cutoff=CUTOFFS[cutoff], workers=DaskWorkers(cluster.scheduler_address))
        client = cluster.get_client()
        summed(
            Problem(torque_model, PartitionedRecording([log], between=(0.0, 0.1), workers=there.workers))
        )  # compiles
        before = sum(client.run(time.process_time).values())
        two, seconds = summed(Problem(torque_model, there))
        spent = sum(client.run(time.process_time).values()) - before
        print(
            f"two workers:           {rows / seconds:9.0f} rows/s; {1e6 * spent / rows:.2f} µs, so that two processors "
            f"do {2 * rows / spent:.0f} rows/s; {'the same bits' if two == here else 'OTHER BITS'}"
        )
        victim = next(iter(client.run(os.getpid).values()))
        done = [0]

        def kill_half_way(more: int) -> None:
            done[0] += more
            if done[0] - more < rows / 2 <= done[0]:
                os.kill(victim, signal.SIGKILL)

        again, seconds = summed(Problem(torque_model, there, progress=kill_half_way))
        print(
            f"one of the two killed: {rows / seconds:9.0f} rows/s; {'the same bits' if again == here else 'OTHER BITS'}"
        )
        client.close()
    return int(not two == again == here)
