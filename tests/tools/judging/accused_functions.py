"""How many right functions the judge accuses: python tests/tools accused_functions [--share N] [--only WORDS].

All functions of the table in docs/judge.md in plain codes (tests/helpers/other_functions), on ten arms: as they stand,
by other conventions and methods, in single precision, and by central difference quotients. Of the last two the judge
may say that they round, but no fault of physics. A line for each function that does not agree: "ACCUSED", or "rounds".
"""

import argparse
import time
import warnings
from collections import Counter

import numpy as np
from other_functions.fault import TEN_ARMS, model_of, path_of
from other_functions.planted import CLAIMS
from other_functions.right_functions import EVERY, OTHERS, QUOTIENTS, single_precision
from textbook_codes.arm import PlainArm
from textbook_codes.code import FRAMES, right_code

from crosscheck.judging.judge import judge

ROUNDING = ("precision", "difference_quotient")
"""Kinds of diagnoses that are no fault of physics."""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--share", type=int, default=1, help="every N-th judgment")
    parser.add_argument("--only", default="", help="those whose name has these words")
    parser.add_argument("--samples", type=int, default=20)
    options = parser.parse_args()
    totals, seconds = Counter(), []
    chosen = [case for case in cases() if options.only in str(case[:3])][:: options.share]
    for robot, name, way, make in chosen:
        arm = PlainArm.of(model_of(robot), FRAMES[robot])
        more = {"frame": FRAMES[robot]} if name.startswith("frame_") else {}
        if way == "single precision":
            more["precision"] = "single"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            start = time.process_time()
            judgment = judge(path_of(robot), samples=options.samples, **{name: make(arm)}, **more)
        seconds.append(time.process_time() - start)
        said = verdict(judgment, way)
        totals[way, said] += 1
        if said != "agrees":
            claims = " | ".join(f"{x.message} [{x.kind}, {x.status}]" for x in judgment.diagnoses)
            error = max(x.max() for x in judgment.functions[name].errors.values())
            print(f"{said:8} {name}: {way} [{robot}] off by {error:.1e}  {claims[:300]}", flush=True)
    for way in dict.fromkeys(way for way, _ in totals):
        print(
            f"{way}: " + ", ".join(f"{totals[way, x]} {x}" for x in ("agrees", "rounds", "ACCUSED") if totals[way, x])
        )
    accused = sum(count for (_, said), count in totals.items() if said == "ACCUSED")
    print(f"{len(chosen)} judgments of right functions: {accused} accused")
    print(f"processor seconds per judgment: median {np.median(seconds):.2f}, largest {max(seconds):.1f}")
    return bool(accused)


def cases():
    """Robot, function, way, (arm) → function: all functions on all arms, the others on some arms in turn."""
    for robot in TEN_ARMS:
        for name in EVERY:
            yield robot, name, "as it stands", lambda arm, name=name: right_code(name, arm)
    for k, (name, way, make) in enumerate(OTHERS):
        for turn in range(2):
            yield TEN_ARMS[(k + 5 * turn) % len(TEN_ARMS)], name, way, make
    for k, name in enumerate(EVERY):
        for turn in range(2):
            robot = TEN_ARMS[(k + 3 * turn) % len(TEN_ARMS)]
            yield robot, name, "single precision", lambda arm, name=name: single_precision(name, arm)
    for k, (name, make) in enumerate(QUOTIENTS):
        for turn in range(2):
            yield TEN_ARMS[(k + 3 * turn) % len(TEN_ARMS)], name, "difference quotients", make


def verdict(judgment, way):
    if judgment.agrees:
        return "agrees"
    claims = [x for x in judgment.diagnoses if x.status in CLAIMS]
    exact = way not in ("single precision", "difference quotients")
    physics = [x for x in claims if x.kind not in ROUNDING and "difference quotient" not in x.message]
    return "ACCUSED" if exact or physics else "rounds"
