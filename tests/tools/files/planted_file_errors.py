"""Whether errors in the inertials of published robots are named, and corrected to the numbers that were there.

    python tests/tools planted_file_errors 300 --seed 1                 so many errors, drawn from all robots
    python tests/tools planted_file_errors 300 --seed 1 --robots even   every second robot, by name; or odd
    python tests/tools planted_file_errors 300 --seed 1 --kind "mass × 10" --show
    python tests/tools planted_file_errors 240 --seed 1 --second        errors of a second set, counted apart

Errors: masses times 10, 1000 or 7.85, the tensor with them or not; exchanged entries, wrong signs, rotations, tensors
of a twin that were not reflected. The second set has other units, tensors about another point, numbers of other links.
tests/helpers/file_errors/outcomes.py says what counts. The exit code is 1 if a correction is false; of the first set
also if too few errors that show are named, or too few that have a unique correction are corrected.
"""

import argparse
import tempfile
from collections import Counter
from pathlib import Path

from file_errors.outcomes import FileErrorOutcome, outcome_of
from file_errors.planting import KINDS, SECOND, planted
from file_errors.robots import robot_files
from rich.console import Console
from rich.progress import track

LEAST_NAMED, LEAST_RIGHT = 0.85, 0.80

HALVES = {"all": slice(None), "even": slice(0, None, 2), "odd": slice(1, None, 2)}

COLUMNS = ("planted", "named", "show", "named", "unique", "right", "others right", "false")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--robots", choices=list(HALVES), default="all")
    parser.add_argument("--kind", choices=[*KINDS, *SECOND], action="append", help="of this kind alone; repeatable")
    parser.add_argument("--second", action="store_true", help="of the second set, of which most have no correction")
    parser.add_argument("--show", action="store_true", help="a line for every error")
    given = parser.parse_args()
    errors = planted(
        robot_files()[HALVES[given.robots]],
        given.count,
        given.seed,
        given.kind or list(SECOND if given.second else KINDS),
    )
    outcomes: list[FileErrorOutcome] = []
    with tempfile.TemporaryDirectory() as folder:
        for error in track(errors, console=Console(stderr=True)):
            outcomes.append(outcome_of(error, Path(folder)))
            if given.show:
                print(outcomes[-1].line, flush=True)
    return told(outcomes, *((0.0, 0.0) if given.second else (LEAST_NAMED, LEAST_RIGHT)))


def told(outcomes: list[FileErrorOutcome], least_named: float, least_right: float) -> int:
    print(f"{'error':24}", *(f"{column:>12}" for column in COLUMNS))
    for kind in Counter(outcome.error.kind for outcome in outcomes):
        print_row(kind, counts([outcome for outcome in outcomes if outcome.error.kind == kind]))
    total = counts(outcomes)
    print_row("all", total)
    shown, right = total[3] / max(total[2], 1), total[5] / max(total[4], 1)
    print(f"of those that show, named {shown:.0%}; of those with a unique correction, right {right:.0%}")
    return int(total[-1] > 0 or shown < least_named or right < least_right)


def counts(outcomes: list[FileErrorOutcome]) -> tuple[int, ...]:
    """In the order of COLUMNS."""
    return (
        len(outcomes),
        sum(one.named for one in outcomes),
        sum(one.shows for one in outcomes),
        sum(one.shows and one.named for one in outcomes),
        sum(one.unique for one in outcomes),
        sum(one.unique and one.right for one in outcomes),
        sum(one.right and not one.unique for one in outcomes),
        sum(one.false for one in outcomes),
    )


def print_row(kind: str, numbers: tuple[int, ...]) -> None:
    print(f"{kind:24}", *(f"{number:12}" for number in numbers))
