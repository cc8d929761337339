"""What the judge says of functions that are no formula: python tests/tools planted_calls [--only WORDS] [--share N].

Difference quotients, solvers stopped early, numbers that are clipped, refusals beyond limits, mixed batches, delays,
degrees per second, and torques of one joint alone: tests/helpers/calls. A line per case: verdict, processor seconds,
what is said; cases that nothing was tuned on have a star. "named": what holds is the planted fault; "candidates": so
do others; "located": it is told without a claim; "unknown"; "missed"; "WRONG": another claim.
"""

import argparse
import sys
import time
import warnings
from collections import Counter

import numpy as np
from calls import batches, cut_off, joint_torques, quotients, solvers
from calls.planted import PLANTED, frame_of

import urdf
from crosscheck.judging.judge import judge
from crosscheck.quantities import FUNCTIONS

ROBOTS = ("ur5", "kinova", "z1")
ROBOTS_ASIDE = ("ur10", "xarm7", "panda")
KINDS = (quotients, solvers, cut_off, batches, joint_torques)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="cases whose name has these words")
    parser.add_argument("--share", type=int, default=1, help="every N-th case")
    parser.add_argument("--samples", type=int, default=100)
    parser.add_argument("--robots", default="", help="names, in place of those of each case in turn")
    parser.add_argument("--aside", action="store_true", help="on robots, and cases, that nothing was tuned on")
    options = parser.parse_args()
    robots = options.robots.split(",") if options.robots else ROBOTS_ASIDE if options.aside else ROBOTS
    models = {name: urdf.load(name).uncoupled for name in robots}
    cases = [(x, robots[k % len(robots)]) for k, x in enumerate(PLANTED)]
    cases = [x for x in cases if options.only in f"{x[0].judged_as} {x[0].name}" and (x[0].aside or not options.aside)]
    totals, seconds = {False: Counter(), True: Counter()}, []
    for case, robot in cases[:: options.share]:
        outcome, taken, said = told(case, robot, models[robot], options.samples)
        totals[case.aside][outcome] += 1
        seconds.append(taken)
        title = f"{case.name}, {case.judged_as}"
        print(f"{'*' if case.aside else ' '} {title:66} {robot:7} {outcome:10} {taken:5.1f} s  {said}", flush=True)
    for aside, counts in totals.items():
        said = ", ".join(f"{count} {outcome}" for outcome, count in counts.most_common())
        print(f"{sum(counts.values())} cases{' aside' if aside else ''}: {said}")
    print(f"processor seconds per judgment: median {np.median(seconds):.1f}, largest {max(seconds):.1f}")
    return int(any(counts["WRONG"] or counts["RAISED"] for counts in totals.values()))


def told(case, robot, model, samples):
    """The outcome, the processor seconds, and what was said."""
    frame = {"frame": frame_of(model)} if FUNCTIONS[case.judged_as].of_frame else {}
    start = time.process_time()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            judgment = judge(robot, samples=samples, **{case.judged_as: case.build(model)}, **frame, **case.options)
        except Exception as error:
            return "RAISED", time.process_time() - start, f"{type(error).__name__}: {error}"[:200]
    taken = time.process_time() - start
    said = " + ".join(f"{x.message[:200]} [{x.kind}, {x.status}]" for x in judgment.diagnoses)
    return case.outcome(judgment), taken, said


if __name__ == "__main__":
    sys.exit(main())
