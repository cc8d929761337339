"""How many planted faults are named: python tests/helpers/diagnosis_run.py [--single] [--only WORDS] [--samples N].

One line per case: verdict, processor seconds of the judgment, diagnoses. "named": the diagnoses that hold are the
planted faults; "candidates": they are among those that fit as well; "located": the term, body or joint is right;
"unknown": no claim; "WRONG": a claim that is not the planted fault; "missed": no deviation found.
"""

import argparse
import re
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from diagnosis_case import ROBOTS, Case, path_of
from diagnosis_cases import CASES
from textbook import TextbookArm

import urdf
from crosscheck.judging.judge import judge


def judged(case: Case, samples: int, *, single: bool = False):
    """The judgment of the code that has the fault, and the processor seconds that it took."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = ROBOTS[case.robot]
        if case.from_file:
            robot, arm = case.plant(path_of(case.robot), Path(folder))
            function = (arm.in_single_precision() if single else arm).inverse_dynamics
        else:
            model = urdf.load(robot)
            arm = TextbookArm.of(model)
            function = case.plant(arm.in_single_precision() if single else arm, model)
        if single:
            function = in_single_precision(function)
        start = time.process_time()
        judgment = judge(robot, **{case.function: function}, samples=samples)
        return judgment, time.process_time() - start


def in_single_precision(function):
    """Arguments and answers rounded to 24 bits."""

    def rounded(*arguments):
        return np.asarray(function(*(x.astype(np.float32) for x in arguments))).astype(np.float32)

    return rounded


def verdict(case: Case, judgment) -> str:
    if judgment.agrees:
        return "missed"
    claims = [x for x in judgment.diagnoses if x.standing in ("holds", "candidate", "part")]
    strange = [x for x in claims if not matches(case.named, x.message)]
    if not strange and all(
        any(re.search(words, x.message) and x.standing == "holds" for x in claims) for words in case.named
    ):
        return "named"
    fitting = [text for x in claims if x.standing != "part" for text in (x.message, *x.also)]
    if all(any(re.search(words, text) for text in fitting) for words in case.named):
        return "candidates"
    if any(not re.search(case.located or "$^", x.message) for x in strange):
        return "WRONG"
    return (
        "located" if claims or matches((case.located or "$^",), *(x.message for x in judgment.diagnoses)) else "unknown"
    )


def matches(expressions, *texts) -> bool:
    return any(re.search(words, text) for words in expressions for text in texts)


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
        claims = [f"{x.message[:150]} [{x.kind}, {x.standing}, {x.explains:.0e}]" for x in judgment.diagnoses]
        print(f"{case!s:58} {said:10} {taken:5.1f} s  {' + '.join(claims)}", flush=True)
    print(f"{len(cases)} cases: " + ", ".join(f"{count} {said}" for said, count in totals.most_common()))
    print(f"processor seconds per judgment: median {np.median(seconds):.1f}, largest {max(seconds):.1f}")
    return bool(totals["WRONG"] or totals["RAISED"])


if __name__ == "__main__":
    sys.exit(main())
