"""How many slips in one place of a recursion the judge names: python tests/tools planted_slips [--share N].

Every slip of independent texts (tests/helpers/slips), at every joint and at one in turn, on ten arms: every N-th case,
or with --each-once every slip on one arm. A line per case: verdict, processor seconds, what is said. "named": the only
diagnosis is the planted slip; "candidates": it is among the first three that give the same numbers; "equal": other
words give the numbers at all states; "unknown": no claim; "missed": no deviation found though the slip shows; "WRONG":
a claim that does not hold at all states.
"""

import argparse
import re
import time
import warnings
from collections import Counter

import numpy as np
from shared_data import ARMS
from slips.planted import FORMS, PLANTED_SLIPS, right_function

import urdf
from crosscheck.judging.judge import judge

TEN_ARMS = (
    *("ur5", "kr500", "kinova", "z1", "panda", "xarm7", "ur3", "so100"),
    *(str(ARMS / name) for name in ("vx300s.urdf", "kr210_r2700_2.urdf")),
)
SHOWN = 1e-6
"""Relative difference from which on a slip shows in the torques of an arm."""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--share", type=int, default=10, help="every N-th case; 1 for all slips on all arms")
    parser.add_argument("--each-once", action="store_true", help="every slip on one arm, the arms in turn")
    parser.add_argument("--only", default="", help="cases whose name has these words")
    options = parser.parse_args()
    models = {name: urdf.load(name).uncoupled for name in TEN_ARMS}
    right = [
        judge(name, inverse_dynamics=right_function(form, model), samples=5).agrees
        for name, model in models.items()
        for form in FORMS
    ]
    print(f"right codes: {len(right) - sum(right)} of {len(right)} accused", flush=True)
    cases = [(slip, name) for slip in PLANTED_SLIPS for name in TEN_ARMS]
    if options.each_once:
        cases = [(slip, TEN_ARMS[k % len(TEN_ARMS)]) for k, slip in enumerate(PLANTED_SLIPS)]
    cases = [case for case in cases if options.only in str(case[0])][:: 1 if options.each_once else options.share]
    totals, seconds, entries = Counter(), [], []
    for number, (slip, name) in enumerate(cases):
        model = models[name]
        joint = None if number % 2 else 1 + number // 2 % (model.n_bodies - 1)
        if not shows(slip, model, joint):
            joint = None
        if not shows(slip, model, joint):
            totals["does not show"] += 1
            continue
        function = slip.function(model, joint)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            start = time.process_time()
            judgment = judge(name, inverse_dynamics=function)
        taken = time.process_time() - start
        said = verdict(slip, judgment)
        totals[said] += 1
        seconds.append(taken)
        entries.append(size_of(judgment, model))
        where = "all" if joint is None else model.joint_names[joint]
        claims = " | ".join(
            (*(x.message for x in judgment.diagnoses), *(y for x in judgment.diagnoses for y in x.also))
        )
        print(f"{said:10} {taken:5.1f} s  {slip} [{name.split('/')[-1]}, {where}]  {claims[:300]}", flush=True)
    print(f"{len(cases)} cases: " + ", ".join(f"{count} {said}" for said, count in totals.most_common()))
    print(f"processor seconds per judgment: median {np.median(seconds):.2f}, largest {max(seconds):.1f}")
    few = sum(count <= 2 for count in entries)
    print(f"smallest examples of at most two entries: {few} of {len(entries)}")
    return bool(totals["WRONG"] or totals["missed"] or not all(right))


def size_of(judgment, model):
    """Number of entries of the smallest example other than zero, but for positions whose limits leave out zero."""
    call = judgment.functions["inverse_dynamics"].smallest
    if call is None:
        return np.inf
    lower, upper = np.array([(x.limits.lower or -np.inf, x.limits.upper or np.inf) for x in model.joints]).T
    free = (lower <= 0) & (upper >= 0)
    return sum(np.count_nonzero(np.array(x)[free] if name == "q" else x) for name, x in call.arguments.items())


def shows(slip, model, joint):
    """Whether the slip changes the torques of this arm."""
    rng = np.random.default_rng(0)
    states = [rng.normal(size=(3, model.n_bodies)) for _ in range(3)]
    right, wrong = right_function(slip.form, model), slip.function(model, joint)
    return any(np.abs(right(*x) - wrong(*x)).max() > SHOWN * np.abs(right(*x)).max() for x in states)


def verdict(slip, judgment):
    if judgment.agrees:
        return "missed"
    claims = [x for x in judgment.diagnoses if x.status in ("confirmed", "candidate")]
    if not claims:
        return "unknown"
    if any(not x.explains <= 1e-9 for x in claims):
        return "WRONG"
    texts = [text for x in claims for text in (x.message, *x.also)]
    if any(re.search(slip.named, x.message) for x in claims) and len(claims) == 1:
        return "named"
    return "candidates" if any(re.search(slip.named, text) for text in texts[:3]) else "equal"
