"""Many mutants in processes of their own, and a table of what became of them."""

from __future__ import annotations

import faulthandler
import multiprocessing
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path

from mutants.mutant import mutant
from mutants.trial import OUTCOMES, Trial, trial

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
