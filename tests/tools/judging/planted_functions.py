"""How many faults in functions of every kind the judge names: python tests/tools planted_functions [--only WORDS].

Plain codes of every function of the table in docs/judge.md (tests/helpers/other_functions), in which mistakes of
people are planted, mistakes that show at special states alone (--special), and mistakes written without reading the
judge (--fresh), alone the second or the third set of these (--second, --third). A line per case: verdict, processor
seconds, what is said. "named": what is claimed is the planted fault, and nothing else; "candidates": the fault is
among those that fit as well; "equal": other words that were found to give the same numbers; "found": wrong at special
states, the message does not say which; "unknown": no claim; "missed": no deviation found; "WRONG": another claim. A
third of the cases is kept aside, and only counted (--aside shows them). --robot NAME plants all of them in one arm, as
far as they are for it and show there.
"""

import argparse
import time
import warnings
from collections import Counter
from dataclasses import replace

import numpy as np
from other_functions.fault import TEN_ARMS, path_of
from other_functions.planted import FAULTS, FRESH_FAULTS, SECOND_FAULTS, SPECIAL_FAULTS, THIRD_FAULTS, verdict

from crosscheck.judging.judge import judge

FRAMED = ("frame_placement", "frame_jacobian", "frame_jacobian_derivative", "frame_velocity", "frame_acceleration")
SETS = {"special": SPECIAL_FAULTS, "second": SECOND_FAULTS, "third": THIRD_FAULTS, "fresh": FRESH_FAULTS}
"""Sets by option; the first of the options that are given holds."""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--share", type=int, default=1, help="every N-th case")
    parser.add_argument("--only", default="", help="cases whose name has these words")
    parser.add_argument("--special", action="store_true", help="faults that show at special states alone")
    parser.add_argument("--fresh", action="store_true", help="faults written without reading the judge")
    parser.add_argument("--aside", action="store_true", help="show the third that is kept aside, too")
    parser.add_argument(
        "--second", action="store_true", help="the second set of these, which were written without reading the judge"
    )
    parser.add_argument(
        "--third", action="store_true", help="the third set of these, torques of whole formulations first"
    )
    parser.add_argument("--robot", choices=TEN_ARMS, help="the arm of all cases; else they take ten arms in turn")
    options = parser.parse_args()
    known = next((faults for name, faults in SETS.items() if getattr(options, name)), FAULTS)
    cases = [fault for fault in known if options.only in str(fault)][:: options.share]
    if options.robot:
        cases = [x for x in cases if options.robot in x.robots and x.planted_on(options.robot)]
        cases = [replace(x, robots=(options.robot,)) for x in cases]
    totals = {False: Counter(), True: Counter()}
    seconds = []
    for fault in cases:
        aside = fault.is_aside and not options.special
        robot, judgment, taken = judged(fault)
        said = verdict(fault, judgment)
        totals[aside][said] += 1
        seconds.append(taken)
        claims = " | ".join(f"{x.message} [{x.status}]{of_others(x)}" for x in judgment.diagnoses)
        if not aside or options.aside:
            print(f"{said:10} {taken:5.1f} s  {fault} [{robot}]  {claims[:400]}", flush=True)
    for aside, counts in totals.items():
        if counts:
            told = sum(counts[x] for x in ("named", "candidates")) / counts.total()
            shares = ", ".join(f"{count} {said}" for said, count in counts.most_common())
            which = "kept aside" if aside else "shown"
            print(f"{counts.total()} cases {which}: {shares}; named or candidates {told:.0%}")
    print(f"processor seconds per judgment: median {np.median(seconds):.2f}, largest {max(seconds):.1f}")
    return bool(sum((totals[aside][bad] for aside in totals for bad in ("WRONG", "missed")), 0))


def judged(fault):
    """Robot, judgment and processor seconds of a fault on one arm."""
    robot, _, frame, function = fault.planted()
    options = dict(fault.options)
    if fault.function in FRAMED:
        options["frame"] = frame
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        start = time.process_time()
        judgment = judge(path_of(robot), **{fault.function: function}, **options)
    return robot, judgment, time.process_time() - start


def of_others(diagnosis):
    return f" (or {'; '.join(diagnosis.also)[:120]})" if diagnosis.also else ""
