"""Which identification method fits a UR5 in its control loop: python tests/tools closed_loop [RUNS] [NOISE ...].

The settings of Leboutet et al. 2021 (BIRDy): 10 s at 1 kHz, controller at 5 kHz, low-pass of 50 Hz for positions,
torques and regressor, starts 15 % beside the truth; noise of positions and torques in five sizes. The controller sees
the noise of the positions. Rows slower than 0.05 rad/s are left out, because dry friction holds joints there.

"Parallel" is with the torque and all columns of the regressor through 20 Hz instead: with f the bandwidth of the loop,
the literature filters positions at 5 f and equations at 2 f (Gautier 1997; Janot, Gautier and Brunot 2019).

Printed for each noise: over RUNS recordings, how many base parameters have a smaller bias than with least squares (same
filter); iterations from 15 % off and how many of them diverge; error of the torque on another motion; processor time.
"""

import sys
import time
from dataclasses import dataclass, field, replace

import numpy as np
from identified import closed_loop_data
from identified.closed_loop_data import DEGREE

import graphdyn
from crosscheck.identifying import Preparation
from graphdyn import EstimationFailed
from graphdyn.identification import (
    ClosedLoopOutputError,
    DirectInverse,
    InstrumentalVariables,
    MaximumLikelihood,
    OrdinaryLeastSquares,
    Samples,
    TotalLeastSquares,
    WeightedLeastSquares,
)
from graphdyn.identification.algebra.least_squares import one_thread

NOISE = {
    "1e-4/.05": (1e-4, 0.05),
    "1e-3/.05": (1e-3, 0.05),
    "1e-3/.1": (1e-3, 0.1),
    "1e-2/.05": (1e-2, 0.05),
    "1e-2/.1": (1e-2, 0.1),
}
"""Standard deviations of positions [°] and torques [N m]."""

TACHOMETER = 1e-4
"""[rad/s] Of the velocities that the controller sees."""

SECONDS, CONTROL_PERIOD = 10.0, 2e-4
START = 0.85
PREPARATION = Preparation(cutoff=50.0, min_speed=0.05, torque_hold=CONTROL_PERIOD)
PARALLEL = replace(PREPARATION, cutoff={"q": 50.0, "tau": 20.0})

FEW = 3
"""Runs of the methods that take many seconds each."""
SLOW = ("CLOE", "CLIE", "ML")


@dataclass
class Found:
    """Of one method: base parameters, iterations and processor time of every run that did not diverge."""

    values: list = field(default_factory=list)
    iterations: list = field(default_factory=list)
    seconds: list = field(default_factory=list)
    diverged: list = field(default_factory=list)


def methods(loop, start):
    return {
        "OLS": OrdinaryLeastSquares(),
        "WLS": WeightedLeastSquares(),
        "TLS": TotalLeastSquares(),
        "TLS, unscaled": TotalLeastSquares(scaled=False),
        "ML": MaximumLikelihood(),
        "IDIM-IV": InstrumentalVariables(loop, start=start),
        "DIDIM": DirectInverse(loop, start=start),
        "CLOE": ClosedLoopOutputError("position", loop, start=start),
        "CLIE": ClosedLoopOutputError("torque", loop, start=start),
    }


def parallel_methods(loop, start):
    return {
        "OLS, parallel": OrdinaryLeastSquares(),
        "WLS, parallel": WeightedLeastSquares(),
        "ML, parallel": MaximumLikelihood(),
        "IDIM-IV, parallel": InstrumentalVariables(loop, start=start),
        "DIDIM, parallel": DirectInverse(loop, start=start),
    }


def run(position, torque, runs):
    """Of each method, by name; and the problem and the truth, which are the same for all."""
    plant, found = closed_loop_data.ur5(), {}
    for seed in range(runs):
        noise = {"position": position * DEGREE, "velocity": TACHOMETER, "torque": torque}
        recorded = plant.record(SECONDS, **noise, seed=seed, control_period=CONTROL_PERIOD)
        for preparation, chosen in ((PREPARATION, methods), (PARALLEL, parallel_methods)):
            problem, loop = recorded.prepared(preparation)
            assert problem.equations.n_columns  # read once, before any method is timed
            for name, method in chosen(loop, START * recorded.truth).items():
                if not name.startswith(SLOW) or seed < FEW:
                    identify(problem, method, found.setdefault(name, Found()))
    return found, problem, problem.base.values(recorded.truth)


def identify(problem, method, found):
    """By one method, on one thread like compare_methods."""
    begin = time.process_time()
    try:
        with one_thread():
            estimate = method.estimate(problem)
    except EstimationFailed as failure:
        found.diverged.append(str(failure))
        return
    found.seconds.append(time.process_time() - begin)
    found.values.append(problem.base.values(estimate.parameters))
    found.iterations.append(estimate.iterations)


def another_motion(problem):
    """The regressor of a motion that was not recorded (N n, r)."""
    plant = closed_loop_data.ur5(seed=7)
    motion = graphdyn.simulate_recording(plant.model, np.linspace(0, 10, 1001), plant.laws)
    samples = Samples(motion.q, motion.v, motion.a, motion.tau)
    return problem.torque_model.rows(samples, problem.base.independent).reshape(-1, problem.base.rank)


def main():
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 25
    for name in sys.argv[2:] or NOISE:
        found, problem, truth = run(*NOISE[name], runs)
        w = another_motion(problem)
        size = np.linalg.norm(w @ truth)
        bias = {method: np.abs(np.mean(own.values, axis=0) - truth) for method, own in found.items() if own.values}
        print(f"\nnoise {name} (° / N m), {runs} runs, {len(truth)} base parameters")
        print("method            bias below OLS   iterations   diverged  torque error [%]   processor time of each [s]")
        for method, own in found.items():
            if not own.values:
                print(f"{method:18} {'':30} {len(own.diverged)} of {len(own.diverged)}: {own.diverged[0]}")
                continue
            errors = [100 * np.linalg.norm(w @ (x - truth)) / size for x in own.values]
            unweighted = "OLS, parallel" if method.endswith("parallel") else "OLS"
            better = int(np.sum(bias[method] < bias[unweighted]))
            most, each = max(own.iterations), np.median(np.array(own.seconds) / own.iterations)
            print(
                f"{method:18} {better:8} of {len(truth)} {np.mean(own.iterations):7.1f} ≤ {most:2} "
                f"{len(own.diverged):6} of {len(own.diverged) + len(own.values)} {np.mean(errors):12.4f} {each:20.2f}",
                flush=True,
            )
