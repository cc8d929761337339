"""Batches in single precision, against the same ones in double precision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

import graphdyn
from crosscheck.bench.contender import Contender
from crosscheck.bench.forms.graphdyn_forms import RESULTS_WRITTEN_NOTE, our_name
from crosscheck.bench.states import States
from graphdyn.compiler import aligned
from graphdyn.layout import Array

SINGLE_PRECISION_WORKS = {"inverse_dynamics_single": False, "forward_dynamics_single": True}
"""Works, and whether they are forward dynamics."""

SINGLE_PRECISION_BOUND = 1e-6
"""Sixteen units in the last place of single precision: measured 4e-7 on six arms."""


def title(forward: bool) -> str:
    return f"{'forward' if forward else 'inverse'} dynamics in single precision"


def contenders(states: States, forward: bool, threads: Sequence[int]) -> list[Contender]:
    """The verb with arguments and results of each type, which are made before."""
    inputs, errors = states.dynamics(forward)
    verb = graphdyn.joint_accelerations if forward else graphdyn.joint_torques

    def form(dtype: np.dtype[np.floating]) -> Callable[..., Array]:
        given = [aligned(x.shape, dtype) for x in inputs]
        for memory, x in zip(given, inputs, strict=True):
            memory[:] = x
        out = aligned(states.q.shape, dtype)

        def run(count: int, used: int) -> Array:
            q, v, x = (array[:count] for array in given)
            return verb(states.model, q, v, x, method="recursive", dtype=dtype, threads=used, out=out[:count])

        return run

    return [
        Contender(f"{our_name()}, {dtype}", used, partial(run, used=used), errors, RESULTS_WRITTEN_NOTE, ours)
        for dtype, ours in ((np.dtype(np.float32), True), (np.dtype(np.float64), False))
        for run in [form(dtype)]
        for used in threads
    ]
