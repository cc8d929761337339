"""From how many samples on compiling a verb pays: python tests/tools compiling_times [ROBOT ...] (ur5 by default)

Prints for every verb the processor time of the projected method for one state and for each further one, of recording
and compiling, and of a compiled call for one state. Then, in samples of the projected method, what compiling takes, and
what a call costs beside its samples: WORTH_COMPILING and SAMPLES_PER_CALL of graphdyn.compiler.running are rough means.
"""

import os
import sys
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from back_ends import no_programs

import graphdyn
import urdf
from graphdyn.compiler import CACHE_VARIABLE
from graphdyn.verbs import VERBS

REPEATS, SAMPLES = 7, 200


def seconds(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """The least processor time of some calls."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def row(model: graphdyn.RobotModel, name: str) -> str:
    verb, rng = VERBS[name], np.random.default_rng(0)
    of_frame = {"frame": model.body_names[-1], "reference": "world"} if verb.of_frame else {}

    def call(samples: int, method: str) -> object:
        arrays = [rng.normal(size=(samples, model.nv)) for _ in verb.inputs]
        return verb.function(model, *arrays, **of_frame, method=method)

    single, many = (seconds(partial(call, samples, "projected")) for samples in (1, SAMPLES))
    with no_programs():
        compiling = seconds(partial(call, 1, "recursive"), repeats=1)
        compiled = seconds(partial(call, 1, "recursive"))
    each = max(many - single, 1e-9) / (SAMPLES - 1)
    return (
        f"{name:40}{1e6 * single:8.0f}{1e6 * each:9.1f}{1e3 * compiling:9.0f}{1e6 * compiled:9.0f}"
        f"{compiling / each:10.0f}{single / each:8.0f}"
    )


def main() -> int:
    os.environ[CACHE_VARIABLE] = "off"
    for robot in sys.argv[1:] or ("ur5",):
        model = urdf.load(robot)
        graphdyn.joint_torques(model, *np.zeros((3, 1, model.nv)), method="recursive")  # imports llvmlite
        print(f"{robot}: {model.nv} joints")
        print(f"{'':40}   projected [µs]  compiling    then    worth compiling")
        print(f"{'':40}   one    further   [ms]      [µs]    samples   a call")
        for name in VERBS:
            print(row(model, name), flush=True)
    return 0
