"""What each step of the recursions brings: python tests/tools recursion_steps [ROBOT ...] (ur5 and kr500 by default)

Prints the operations of torques and accelerations with one step after the other; the time of 100,000 samples without a
step over that with it, medians and quartiles of pairs that took turns, each of the fastest of several builds; and a
chain of 60 bodies, as code for one body after the other and as straight-line code. A minute; on a busy machine the
quartiles are far apart.
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
from random_trees import random_tree

import graphdyn
import urdf
from graphdyn.compiler import CACHE_VARIABLE, programs, running
from graphdyn.compiler.gram.gram import torque_gram
from graphdyn.compiler.llvm import emitter, vector_code
from graphdyn.compiler.llvm.memory import aligned
from graphdyn.compiler.programs import Request, trace
from graphdyn.compiler.rolled import rolled_code as body_by_body_code
from graphdyn.compiler.rolled import rolling as body_by_body
from graphdyn.recursions import forward
from graphdyn.recursions.mechanism.reductions import regrouped, slid, turned

SAMPLES, PAIRS, BUILDS, CHAIN = 100_000, 31, 4, 60

REQUESTS = {
    "torques": Request("inverse_dynamics", ("tau",)),
    "accelerations": Request("forward_dynamics", ("a",)),
    "all 108 numbers": Request("forward_dynamics", ("a", "body_accelerations", "multipliers", "joint_wrenches")),
    "multipliers": Request("forward_dynamics", ("body_accelerations", "multipliers")),
}
REDUCTIONS = {"recursions": (), "slid, turned": (slid, turned), "regrouped": (slid, turned, regrouped)}

Replaced = tuple[tuple[object, str, object], ...]

STEPS: dict[str, Replaced] = {
    "all reductions": ((programs, "REDUCTIONS", ()),),
    "short_chains": ((forward, "is_short", lambda links: False),),
    "watching": ((programs, "sufficient", lambda recorder, inputs, outputs: inputs),),
    "sincos_pipelining": ((emitter, "sincos_pipelining", lambda program, lanes: ({}, None)),),
    "ALIGNED_STACK": ((vector_code, "ALIGNED_STACK", ""), (body_by_body_code, "ALIGNED_STACK", "")),
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


def long_robots() -> None:
    chain = random_tree(1, list(range(CHAIN)), ["revolute"] * CHAIN)
    for unrolled in (body_by_body.MAX_UNROLLED_BODIES, CHAIN):
        with without(((body_by_body, "MAX_UNROLLED_BODIES", unrolled), (running, "MAX_COMPILED_LENGTH", 10**9))):
            for what in ("torques", "accelerations", "multipliers"):
                if unrolled == CHAIN and what == "multipliers":
                    continue
                start = time.perf_counter()
                with no_programs():
                    running.prepared(chain, REQUESTS[what])
                made = time.perf_counter() - start
                form = "straight-line" if unrolled == CHAIN else "body by body"
                text = f"  {form}, {what}: made in {made:.2f} s; ns a sample and body:"
                for samples in (1000, 10_000, 100_000):
                    run = runner(chain, REQUESTS[what], samples)
                    best = min(seconds(run) for _ in range(max(7, SAMPLES // samples))) / samples / CHAIN
                    text += f" {best * 1e9:.1f}"
                print(text, flush=True)


def main() -> int:
    os.environ[CACHE_VARIABLE] = "off"
    for name in sys.argv[1:] or ("ur5", "kr500"):
        model = urdf.load(name)
        print(f"{name}: operations of torques and accelerations")
        operations(model)
        print(f"{name}: time without a step over time with it")
        times(model)
    print(f"a chain of {CHAIN} bodies; 1000, 10,000 and 100,000 samples")
    long_robots()
    return 0
