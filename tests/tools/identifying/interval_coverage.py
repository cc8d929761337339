"""How often twice the standard deviation covers the truth: python tests/tools interval_coverage [RUNS].

A simulated UR5 with friction is identified again and again, each time with new noise on the torques: an AR(1) process
of a given correlation time. What is right covers 95 of 100 parameters.
"""

import sys

import numpy as np
from identified.coverage_trials import CASES, SHORT, coverage, virtual_coverage

from graphdyn.identification.estimation.comparison import MIN_CORRELATION_TIMES


def main() -> None:
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    print(f"Part of the parameters within two standard deviations [%], {runs} runs each; right is 95.")
    print(f"{'recording':34} {'correlation times':>20} {'σ blocks':>26} {'σ white':>8}")
    print(f"{'':34} {'true':>10} {'found':>9} {' '.join(f'{name:>6}' for name in SHORT)} {'WLS':>8}")
    for case in CASES:
        found = coverage(case, runs)
        true = case.seconds / case.correlated if case.correlated else np.inf
        parts = " ".join(f"{100 * part:6.1f}" for part in found.block.values())
        low = "" if found.correlation_times >= MIN_CORRELATION_TIMES else "  lower bound"
        print(
            f"{case!s:34} {true:10.0f} {found.correlation_times:9.0f} {parts} {100 * found.white['WLS']:8.1f}{low}",
            flush=True,
        )
    block, white = virtual_coverage(20)
    print(f"graphdyn identify --robot ur5, seeds 0 to 19: σ blocks {100 * block:.1f}, σ white {100 * white:.1f}")
