"""What each step of the recursions brings: python tests/tools recursion_steps [ROBOT ...] (ur5 and kr500 by default)

Prints the operations of torques and accelerations with one step after the other; the time of 100,000 samples without a
step over that with it, medians and quartiles of pairs that took turns, each of the fastest of several builds.
A minute; on a busy machine the quartiles are far apart.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from unittest import mock

import numpy as np
from back_ends import no_programs

import graphdyn
import urdf
from graphdyn.compiler import CACHE_VARIABLE, programs, running
from graphdyn.compiler.gram.gram import torque_gram
from graphdyn.compiler.llvm import emitter, vector_code
from graphdyn.compiler.llvm.memory import aligned
from graphdyn.compiler.programs import Request, trace
from graphdyn.compiler.rolled import rolled_code
from graphdyn.recursions import forward
from graphdyn.recursions.mechanism.reductions import regrouped, slid, turned

SAMPLES, PAIRS, BUILDS = 100_000, 31, 4

REQUESTS = {
    "torques": Request("inverse_dynamics", ("tau",)),
    "accelerations": Request("forward_dynamics", ("a",)),
    "all 108 numbers": Request("forward_dynamics", ("a", "body_accelerations", "multipliers", "joint_wrenches")),
}
REDUCTIONS = {"recursions": (), "slid, turned": (slid, turned), "regrouped": (slid, turned, regrouped)}

Replaced = tuple[tuple[object, str, object], ...]

STEPS: dict[str, Replaced] = {
    "all reductions": ((programs, "REDUCTIONS", ()),),
    "short_chains": ((forward, "is_short", lambda links: False),),
    "watching": ((programs, "sufficient", lambda recorder, inputs, outputs: inputs),),
    "sincos_pipelining": ((emitter, "sincos_pipelining", lambda program, lanes: ({}, None)),),
    "ALIGNED_STACK": ((vector_code, "ALIGNED_STACK", ""), (rolled_code, "ALIGNED_STACK", "")),
}
"""What replaces a step."""

NOT_FETCHED: Replaced = ((vector_code.VectorCode, "fetch_ahead", lambda self, block, width, **_: None),)


@contextmanager
def without(replaced: Replaced) -> Iterator[None]:
    with ExitStack() as stack:
        for module, name, other in replaced:
            stack.enter_context(mock.patch.object(module, name, other))
        yield


def operations(model: graphdyn.RobotModel) -> None:
    for name, reductions in REDUCTIONS.items():
        for short in (False, True) if name == "regrouped" else (False,):
            replaced = (
                (programs, "REDUCTIONS", reductions),
                (forward, "is_short", lambda links, short=short: short),
            )
            with without(replaced):
                counts = [arithmetic(trace(model, REQUESTS[what])) for what in ("torques", "accelerations")]
            print(f"  {name + (', short_chains' if short else ''):<26}{counts[0]:>6}{counts[1]:>6}")


def arithmetic(program: object) -> int:
    """Additions, multiplications and divisions."""
    return sum(kind in ("+", "-", "*", "/") for kind, *_ in program.operations)


def pair(name: str, make: Callable[[], Callable[[], object]], replaced: Replaced) -> None:
    """The time without over that with: of the fastest build, as places of code and memory matter by chance."""
    ours, others = [], []
    for _ in range(BUILDS):
        ours.append(make())
        with without(replaced):
            others.append(make())
    ratios = [min(map(seconds, others)) / min(map(seconds, ours)) for _ in range(PAIRS)]
    low, median, high = np.quantile(ratios, (0.25, 0.5, 0.75))
    print(f"  {name:<44}{median:6.2f} × ({low:.2f} … {high:.2f})", flush=True)


def seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def runner(model: graphdyn.RobotModel, request: Request, samples: int) -> Callable[[], object]:
    """A call on memory of its own, compiled here."""
    with no_programs():
        ready = running.prepared(model, request)
    rng = np.random.default_rng(0)
    inputs = {name: aligned((samples, width)) for name, width in ready.program.inputs.items()}
    for array in inputs.values():
        array[:] = rng.normal(size=array.shape)
    outputs = {name: aligned((samples, len(numbers))) for name, numbers in ready.program.outputs.items()}
    bound = ready.backend.bind(inputs, outputs)
    return lambda: bound(0, samples)


def times(model: graphdyn.RobotModel) -> None:
    for step, replaced in STEPS.items():
        for what in ("torques", "accelerations", "all 108 numbers"):
            if step == "short_chains" and what != "accelerations":
                continue
            if what == "all 108 numbers" and step in ("all reductions", "watching"):
                continue
            pair(f"{step}: {what}", lambda what=what: runner(model, REQUESTS[what], SAMPLES), replaced)
    pair("fetch_ahead: sums of products", lambda: sums(model), NOT_FETCHED)


def sums(model: graphdyn.RobotModel) -> Callable[[], object]:
    gram, rng = torque_gram(model, range(10 * model.n_bodies)), np.random.default_rng(0)
    arrays = [rng.normal(size=(SAMPLES, model.nv)) for _ in range(4)]
    extra = np.empty((SAMPLES, model.nv, 0))
    return lambda: gram(*arrays, extra, threads=1)


def main() -> int:
    os.environ[CACHE_VARIABLE] = "off"
    for name in sys.argv[1:] or ("ur5", "kr500"):
        model = urdf.load(name)
        print(f"{name}: operations of torques and accelerations")
        operations(model)
        print(f"{name}: time without a step over time with it")
        times(model)
    return 0
