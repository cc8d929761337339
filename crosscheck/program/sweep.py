"""Inspects many files in parallel processes. No file stops the others, whatever it does to its process."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context

from urdf import Finding, Report, inspect

FEW = 16
"""So many files take less time than starting processes, a second each."""

Examine = Callable[[str], Report]


def sweep(robots: Sequence[str], done: Callable[[str, int], None], examine: Examine = inspect) -> list[Report]:
    """One report per robot, in their order. done: called with what was just inspected, and 1."""
    if len(robots) > FEW:
        return _in_processes(robots, done, examine)
    reports = []
    for robot in robots:
        reports.append(examine(robot))
        done(robot, 1)
    return reports


def _in_processes(robots: Sequence[str], done: Callable[[str, int], None], examine: Examine) -> list[Report]:
    """Where a process dies, the files without a report are halved, until the one that kills it is alone."""
    reports: dict[int, Report] = {}
    pool = ProcessPoolExecutor(min(_processors(), len(robots)), get_context("spawn"), _ignore_interrupts)
    try:
        futures = {pool.submit(examine, robot): k for k, robot in enumerate(robots)}
        for future in as_completed(futures):
            k = futures[future]
            try:
                reports[k] = future.result()
            except BrokenProcessPool:
                continue
            except Exception as error:
                reports[k] = _failed(robots[k], f"the inspection failed: {type(error).__name__}: {error}")
            done(robots[k], 1)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
    left = [k for k in range(len(robots)) if k not in reports]
    if left and len(robots) == 1:
        reports[0] = _failed(robots[0], "the process that read the file died")
        done(robots[0], 1)
    elif left:
        half = (len(left) + 1) // 2
        for part in (left[:half], left[half:]):
            if part:
                found = _in_processes([robots[k] for k in part], done, examine)
                reports.update(zip(part, found, strict=True))
    return [reports[k] for k in range(len(robots))]


def _processors() -> int:
    """Processors that this program may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _ignore_interrupts() -> None:
    """Ctrl-C is for the program, which then ends its processes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _failed(robot: str, message: str) -> Report:
    finding = Finding("inspection-failed", "error", None, None, message, "report it, with the file")
    return Report(robot, robot, (finding,))
