"""What becomes of many damaged URDF files, each read in a process of its own.

The long run: `python tests/tools damaged_files 20000 --seed 1`; exit code 1 if something unexpected happened. One
mutant again, as a file: `python tests/tools damaged_files 1 --seed 1 --first 4711 --keep mutant.urdf`.
"""

import argparse
import os
from pathlib import Path

from mutants.mutant import mutant
from mutants.processes import run, table, unexpected
from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress


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
