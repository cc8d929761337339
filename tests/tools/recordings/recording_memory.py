"""How much memory `graphdyn identify` takes for recordings of a million rows, child processes included.

    python tests/tools recording_memory [ROWS] [--format csv|parquet] [IDENTIFY ARGUMENTS …]

A simulated UR5 in a Fourier motion with friction and noise at 1 kHz: t, q and tau of six joints, ROWS of them, a
million unless given. Prints the peak of the resident memory of the command and its children, added up every
hundredth of a second from /proc, so that pages that they share count several times; the same for a command that only
imports; and the memory by which a row exceeds it. Further arguments go to `graphdyn identify`, such as --folds 10.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import csv, parquet

import graphdyn
import urdf

RATE = 1000.0
"""Of the log [Hz]."""

CHUNK_ROWS = 50_000
"""Rows that are simulated at once."""

INTERVAL = 0.01
"""Time between two looks at the memory [s]."""

IMPORTS = "import crosscheck.commands.identify.reports.report, crosscheck.identifying, pyarrow, scipy.signal, clarabel"
"""What every identification imports."""


def write_log(path: Path, rows: int) -> None:
    """The log, chunk by chunk."""
    robot, rng = urdf.load("ur5"), np.random.default_rng(0)
    names = ["time_s", *(f"{name}_{k}_{unit}" for name, unit in (("q", "rad"), ("tau", "Nm")) for k in range(1, 7))]
    amplitude, phase = rng.normal(size=(2, 5, 6)) * np.array([0.25, 3.0])[:, None, None]
    speed = 2 * np.pi * 0.1 * np.arange(1, 6)[:, None, None]
    schema = pa.schema([(name, pa.float64()) for name in names])
    kind = csv.CSVWriter if path.suffix == ".csv" else parquet.ParquetWriter
    with kind(str(path), schema) as writer:
        for first in range(0, rows, CHUNK_ROWS):
            t = np.arange(first, min(first + CHUNK_ROWS, rows)) / RATE
            angle = speed * t[:, None] + phase[:, None]
            q, v, a = (
                np.sum(amplitude[:, None] * part, axis=0)
                for part in (np.sin(angle), speed * np.cos(angle), -(speed**2) * np.sin(angle))
            )
            tau = graphdyn.inverse_dynamics(robot, q, v, a).tau + 2 * v + 3 * np.sign(v)
            tau += 0.3 * rng.normal(size=tau.shape)
            q += 2e-5 * rng.normal(size=q.shape)
            writer.write_table(pa.table([t, *q.T, *tau.T], schema=schema))


def peak_memory(command: list[str]) -> tuple[float, float, int]:
    """Peak of the resident memory of a command and its children [MB], its time [s], and its exit code."""
    environment = {**os.environ, "COLUMNS": "120"}
    begun, most = time.perf_counter(), 0
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, env=environment)
        while process.poll() is None:
            most = max(most, resident(process.pid))
            time.sleep(INTERVAL)
        output.seek(0)
        if process.returncode not in (0, 1):
            print(output.read().decode()[-2000:], file=sys.stderr)
    return most / 1e6, time.perf_counter() - begun, process.returncode


def resident(process: int) -> int:
    """Resident memory of a process and all below it [bytes]; nothing for one that has ended."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
        children = [child for task in Path(f"/proc/{process}/task").iterdir()
                    for child in (task / "children").read_text().split()]  # fmt: skip
    except (FileNotFoundError, ProcessLookupError):
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE") + sum(resident(int(child)) for child in children)


def main() -> int:
    """Exit code: whether a command failed."""
    asked = argparse.ArgumentParser(prog="recording_memory")
    asked.add_argument("rows", nargs="?", default="1e6")
    asked.add_argument("--format", choices=("csv", "parquet"), action="append")
    options, more = asked.parse_known_args()
    rows = int(float(options.rows))
    imports, seconds, _ = peak_memory([sys.executable, "-c", IMPORTS])
    print(f"imports alone: {imports:.0f} MB, {seconds:.1f} s", flush=True)
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        for kind in options.format or ["csv", "parquet"]:
            log = Path(folder, f"log.{kind}")
            write_log(log, rows)
            command = [sys.executable, "-m", "crosscheck", "identify", str(log), "--robot", "ur5", *more]
            most, seconds, code = peak_memory(command)
            print(
                f"{kind}, {rows} rows, {log.stat().st_size / 1e6:.0f} MB: peak {most:.0f} MB, "
                f"{1e6 * (most - imports) / rows:.0f} bytes a row beyond the imports, {seconds:.0f} s, "
                f"exit code {code}",
                flush=True,
            )
            failed |= code not in (0, 1)
    return int(failed)
