"""What becomes of many damaged files of every format that is read.

    python tests/tools damaged_files 10000 --seed 1                            so many of every format
    python tests/tools damaged_files 20000 --format urdf --seed 1              of one, or of several
    python tests/tools damaged_files 1 --format urdf --seed 1 --first 4711 --keep mutant.urdf      one of them again

The exit code is 1 if something unexpected happened.
"""

import argparse
import os
from pathlib import Path

from mutants.formats import FORMATS
from mutants.mutant import mutant
from mutants.processes import run, table, unexpected
from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("--format", choices=list(FORMATS), action="append", help="of this format alone; repeatable")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first mutant")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--keep", type=Path, help="write the first mutant to this file")
    given = parser.parse_args()
    formats = given.format or list(FORMATS)
    if given.keep:
        given.keep.write_bytes(mutant(formats[0], given.seed, given.first).content)
    numbers = range(given.first, given.first + given.count)
    with Progress(*Progress.get_default_columns(), MofNCompleteColumn(), console=Console(stderr=True)) as bar:
        task = bar.add_task("mutants", total=given.count * len(formats))
        results = run(formats, given.seed, numbers, given.processes, lambda done: bar.update(task, completed=done))
    wrong = unexpected(results)
    print(table(results), *wrong, sep="\n")
    return int(bool(wrong))
