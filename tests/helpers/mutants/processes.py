"""Many mutants in processes of their own, and a table of what became of them."""

from __future__ import annotations

import faulthandler
import multiprocessing
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection, wait
from pathlib import Path

from mutants.formats import FORMATS
from mutants.mutant import mutant
from mutants.outcomes import OUTCOMES, Result, Trial

SECONDS = 120
"""One mutant takes some 10 milliseconds, the first of a process seconds; a process that works on one for so long is
stopped."""


def run(
    formats: Sequence[str],
    seed: int,
    numbers: Sequence[int],
    processes: int,
    progress: Callable[[int], None] = lambda done: None,
) -> list[Result]:
    """The mutants of these numbers of each format; one that takes its process with it is unexpected, and the rest
    goes on."""
    context = multiprocessing.get_context("spawn")
    cases = [(format, number) for number in numbers for format in formats]
    waiting = {k: cases[k::processes] for k in range(processes)}
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
                    format, number = waiting[k].pop(0)
                    detail = f"its process ended, or it took longer than {SECONDS} s"
                    kinds = mutant(format, seed, number).kinds
                    found.append(Result(format, number, kinds, Trial("unexpected", detail=detail)))
                start(k)
            progress(len(found))
    return sorted(found, key=lambda result: (result.format, result.number))


def _work(seed: int, cases: Sequence[tuple[str, int]], connection: Connection) -> None:
    with tempfile.TemporaryDirectory() as folder:
        for format, number in cases:
            made, of = mutant(format, seed, number), FORMATS[format]
            path = Path(folder, f"mutant{of.suffix}")
            path.write_bytes(made.content)
            faulthandler.dump_traceback_later(SECONDS, exit=True)
            connection.send(Result(format, number, made.kinds, of.trial(path)))
            faulthandler.cancel_dump_traceback_later()


def table(results: Sequence[Result]) -> str:
    """Per kind of fault (a mutant with two counts twice): what became of the mutants; then the codes."""
    rows = {"all mutants": Counter(result.trial.outcome for result in results)}
    for format in dict.fromkeys(result.format for result in results):
        rows[format] = Counter(result.trial.outcome for result in results if result.format == format)
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
        f"{result.format} {result.number} ({', '.join(result.kinds)}): {result.trial.detail}"
        for result in results
        if result.trial.outcome == "unexpected"
    ]
