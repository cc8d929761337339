"""What the first call and each state cost over the number of bodies: python tests/tools long_robots [VERB ...] [N ...]

For every verb that has a compiled form (all by default) and chains of N bodies (7 to 200 by default): processor time of
recording, compiling and computing eight states, no machine code of earlier processes used, and of a state of 1000
states on one thread (of fewer where answers are large), the fastest of five calls. A letter says what runs: s
straight-line code, r rolled code, i interpreted. Ten minutes for all of them.
"""

from __future__ import annotations

import os
import sys
import time

import numpy as np
from back_ends import no_programs

from crosscheck.bench.curves import chain
from graphdyn import RobotModel
from graphdyn.arguments.choices import FrameChoice
from graphdyn.compiler import CACHE_VARIABLE, running
from graphdyn.compiler.interpreter import Interpreter
from graphdyn.compiler.llvm.memory import aligned
from graphdyn.compiler.programs import Request
from graphdyn.scalars import Program
from graphdyn.verbs.verb import VERBS, Verb

LENGTHS = (7, 12, 24, 25, 60, 100, 200)
FEW, MANY, REPEATS = 8, 1000, 5

MAX_NUMBERS = 20_000_000
"""Numbers of an answer beyond which fewer states are computed."""

LEFT_OUT = ("inverse_dynamics_second_derivatives",)
"""n³ numbers for each state; measured where it is asked for."""


def measured(verb: Verb, model: RobotModel) -> str:
    """First call [ms], what runs, and a state [µs]."""
    frame = FrameChoice(model.bodies[-1].name, "world") if verb.of_frame else None
    request, rng = Request(verb.recursion, verb.outputs, frame=frame), np.random.default_rng(0)
    x = {name: rng.uniform(-1, 1, (MANY, model.nv)) for name in verb.inputs}

    def call(count: int) -> float:
        start = time.process_time()
        given = {name: array[:count] for name, array in x.items()}
        ready = running.prepared(model, request)
        answer = {name: aligned((count, len(columns))) for name, columns in ready.program.outputs.items()}
        running.run(model, request, given, answer, threads=1)
        return time.process_time() - start

    first, ready = call(FEW), running.prepared(model, request)
    if isinstance(ready.backend, Interpreter):
        return f"{first * 1e3:7.0f} i {call(FEW) / FEW * 1e6:8.2f}"
    form = "s" if isinstance(ready.program, Program) else "r"
    many = min(MANY, MAX_NUMBERS // sum(map(len, ready.program.outputs.values())) + FEW)
    return f"{first * 1e3:7.0f} {form} {min(call(many) for _ in range(REPEATS)) / many * 1e6:8.2f}"


def main() -> int:
    os.environ[CACHE_VARIABLE] = "off"
    lengths = [int(word) for word in sys.argv[1:] if word.isdigit()] or LENGTHS
    verbs = [word for word in sys.argv[1:] if not word.isdigit()] or [name for name in VERBS if name not in LEFT_OUT]
    print("first call [ms], code, a state [µs]; bodies: " + ", ".join(map(str, lengths)))
    for name in verbs:
        row = []
        for n in lengths:
            with no_programs():
                row.append(measured(VERBS[name], chain(n)))
        print(f"{name:40}", " | ".join(row), flush=True)
    return 0
