"""What becomes of many damaged files of every format that is read.

    python tests/tools damaged_files 10000 --seed 1                            so many of every format
    python tests/tools damaged_files 10000 --seed 1 --enough 5000              or until so many bring nothing new
    python tests/tools damaged_files 20000 --format urdf --seed 1              of one, or of several
    python tests/tools damaged_files 1 --format urdf --seed 1 --first 4711 --keep mutant.urdf      one of them again

The exit code is 1 if something unexpected happened.
"""

import argparse
import os
import re
from collections.abc import Sequence
from pathlib import Path

from mutants.formats import FORMATS
from mutants.mutant import mutant
from mutants.outcomes import Result, Trial
from mutants.processes import run, table, unexpected
from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress

FIRST_LOOK = 250
"""Mutants that have the usual outcomes among them."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("--format", choices=list(FORMATS), action="append", help="of this format alone; repeatable")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first mutant")
    parser.add_argument("--enough", type=int, help="of a format, once so many in a row had outcomes that others had")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--keep", type=Path, help="write the first mutant to this file")
    given = parser.parse_args()
    formats = given.format or list(FORMATS)
    if given.keep:
        given.keep.write_bytes(mutant(formats[0], given.seed, given.first).content)
    numbers = range(given.first, given.first + given.count)
    results = [result for format in formats for result in of_format(format, numbers, given)]
    wrong = unexpected(results)
    print(table(results), *wrong, sep="\n")
    for format in formats:
        found = [result.trial for result in results if result.format == format]
        print(f"{format}: {len(found)} mutants, the last {since_new(found)} of them with outcomes that others had")
    return int(bool(wrong))


def of_format(format: str, numbers: range, given: argparse.Namespace) -> list[Result]:
    results: list[Result] = []
    with Progress(*Progress.get_default_columns(), MofNCompleteColumn(), console=Console(stderr=True)) as bar:
        task = bar.add_task(format, total=len(numbers))
        wanted = FIRST_LOOK if given.enough else len(numbers)
        while wanted > 0 and (left := numbers[len(results) :]):

            def show(done: int, before: int = len(results)) -> None:
                bar.update(task, completed=before + done)

            results += run([format], given.seed, left[:wanted], given.processes, show)
            wanted = (given.enough or 0) - since_new([result.trial for result in results])
    return results


def since_new(trials: Sequence[Trial]) -> int:
    """How many came after the last whose outcome and codes, or whose fault, no other had before."""
    first: dict[tuple[str, ...], int] = {}
    for number, trial in enumerate(trials):
        first.setdefault((trial.outcome, *trial.codes, re.sub(r"[^A-Za-z ]+", "", trial.detail)[:60]), number)
    return len(trials) - 1 - max(first.values(), default=-1)
