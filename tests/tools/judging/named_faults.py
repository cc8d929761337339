"""How many planted faults the judge names: python tests/tools named_faults [--single] [--only WORDS] [--samples N].

One line per case: verdict, processor seconds of the judgment, diagnoses. "named": the diagnoses that hold are the
planted faults; "candidates": they are among those that fit as well; "located": the term, body or joint is right;
"unknown": no claim; "WRONG": a claim that is not the planted fault; "missed": no deviation found.
"""

import argparse
from collections import Counter

import numpy as np
from faults.cases import CASES
from faults.verdicts import judged, verdict


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--single", action="store_true", help="every code in single precision")
    parser.add_argument("--only", default="", help="cases whose name has these words")
    parser.add_argument("--samples", type=int, default=100)
    options = parser.parse_args()
    cases = [case for case in CASES if options.only in str(case)]
    totals, seconds = Counter(), []
    for case in cases:
        try:
            judgment, taken = judged(case, options.samples, single=options.single)
        except Exception as error:
            print(f"{case!s:58} RAISED {type(error).__name__}: {error}", flush=True)
            totals["RAISED"] += 1
            continue
        said = verdict(case, judgment)
        totals[said] += 1
        seconds.append(taken)
        claims = [f"{x.message[:150]} [{x.kind}, {x.status}, {x.explains:.0e}]" for x in judgment.diagnoses]
        print(f"{case!s:58} {said:10} {taken:5.1f} s  {' + '.join(claims)}", flush=True)
    print(f"{len(cases)} cases: " + ", ".join(f"{count} {said}" for said, count in totals.most_common()))
    print(f"processor seconds per judgment: median {np.median(seconds):.1f}, largest {max(seconds):.1f}")
    return bool(totals["WRONG"] or totals["RAISED"])
