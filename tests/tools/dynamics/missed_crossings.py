"""How many limits and events simulations miss that random motions graze, pass twice or just miss, by every method.

    python tests/tools missed_crossings 10000        so many simulations, some minutes
    python tests/tools missed_crossings 1000 --seed 7 --kinds loop,arm --methods dop853

The exit code is 1 if any is missed, found where there is none, or leaves a row beyond its limit.
"""

import argparse
import itertools
import sys

from grazed_limits import KINDS, METHODS, problems


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--methods", default=",".join(METHODS))
    given = parser.parse_args()
    kinds, methods = given.kinds.split(","), given.methods.split(",")
    asked = dict.fromkeys(itertools.product(kinds, methods), 0)
    wrong = 0
    for number in itertools.count(1_000_000 * given.seed):
        for kind, method in asked:
            count, found = problems(kind, method, number)
            asked[kind, method] += count
            wrong += len(found)
            print(*found, sep="\n", end="\n" if found else "", flush=True)
        print(f"{sum(asked.values())} simulations, {wrong} wrong", file=sys.stderr)
        if sum(asked.values()) >= given.count:
            break
    print("| motion | " + " | ".join(methods) + " |\n|---|" + "---|" * len(methods))
    for kind in kinds:
        print(f"| {kind} | " + " | ".join(str(asked[kind, method]) for method in methods) + " |")
    print(f"{sum(asked.values())} simulations, {wrong} wrong")
    return int(bool(wrong))
