"""Many mutants in processes of their own, and a table of what became of them.

The long run: `python tests/helpers/mutant_run.py 20000 --seed 1`; exit code 1 if something unexpected happened. One
mutant again, as a file: `python tests/helpers/mutant_run.py 1 --seed 1 --first 4711 --keep mutant.urdf`.
"""

from __future__ import annotations

import argparse
import faulthandler
import multiprocessing
import os
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path

from mutant_trial import OUTCOMES, Trial, trial
from mutants import mutant
from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress

SECONDS = 120
"""One mutant takes some 10 milliseconds, the first of a process seconds; a process that works on one for so long is
stopped."""


@dataclass(frozen=True)
class Result:
    """Mutant number of a seed, what was done to the file, and what became of it."""

    number: int
    kinds: tuple[str, ...]
    trial: Trial


def run(
    seed: int, numbers: Sequence[int], processes: int, progress: Callable[[int], None] = lambda done: None
) -> list[Result]:
    """The mutants of these numbers; one that takes its process with it is unexpected, and the rest goes on."""
    context = multiprocessing.get_context("spawn")
    waiting = {k: list(numbers[k::processes]) for k in range(processes)}
    found: list[Result] = []
    workers: dict[Connection, int] = {}

    def start(k: int) -> None:
        if waiting[k]:
            ours, theirs = context.Pipe(duplex=False)
            context.Process(target=_work, args=(seed, tuple(waiting[k]), theirs), daemon=True).start()
            theirs.close()
            workers[ours] = k

    for k in range(processes):
        start(k)
    while workers:
        for connection in wait(list(workers)):
            k = workers[connection]
            try:
                found.append(connection.recv())
                waiting[k].pop(0)
            except EOFError:
                del workers[connection]
                if waiting[k]:
                    number = waiting[k].pop(0)
                    detail = f"its process ended, or it took longer than {SECONDS} s"
                    found.append(Result(number, mutant(seed, number).kinds, Trial("unexpected", detail=detail)))
                start(k)
            progress(len(found))
    return sorted(found, key=lambda result: result.number)


def _work(seed: int, numbers: Sequence[int], connection: Connection) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mutant.urdf"
        for number in numbers:
            made = mutant(seed, number)
            path.write_bytes(made.content)
            faulthandler.dump_traceback_later(SECONDS, exit=True)
            connection.send(Result(number, made.kinds, trial(path)))
            faulthandler.cancel_dump_traceback_later()


def table(results: Sequence[Result]) -> str:
    """Per kind of fault (a mutant with two counts twice): what became of the mutants; then the codes."""
    rows = {"all mutants": Counter(result.trial.outcome for result in results)}
    for kind in sorted({kind for result in results for kind in result.kinds}):
        rows[kind] = Counter(result.trial.outcome for result in results if kind in result.kinds)
    lines = [f"{'':28}" + "".join(f"{outcome:>17}" for outcome in OUTCOMES)]
    lines += [f"{kind:28}" + "".join(f"{row[outcome]:17}" for outcome in OUTCOMES) for kind, row in rows.items()]
    for outcome in ("refused", "explained"):
        codes = Counter(code for result in results if result.trial.outcome == outcome for code in result.trial.codes)
        lines.append(f"{outcome}: " + ", ".join(f"{code} {number}" for code, number in codes.most_common()))
    return "\n".join(lines)


def unexpected(results: Sequence[Result]) -> list[str]:
    """A line per mutant."""
    return [
        f"mutant {result.number} ({', '.join(result.kinds)}): {result.trial.detail}"
        for result in results
        if result.trial.outcome == "unexpected"
    ]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first mutant")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--keep", type=Path, help="write the first mutant to this file")
    given = parser.parse_args()
    if given.keep:
        given.keep.write_bytes(mutant(given.seed, given.first).content)
    numbers = range(given.first, given.first + given.count)
    with Progress(*Progress.get_default_columns(), MofNCompleteColumn(), console=Console(stderr=True)) as bar:
        task = bar.add_task("mutants", total=given.count)
        results = run(given.seed, numbers, given.processes, lambda done: bar.update(task, completed=done))
    wrong = unexpected(results)
    print(table(results), *wrong, sep="\n")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
