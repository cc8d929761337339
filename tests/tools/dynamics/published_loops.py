"""How far published mechanisms with loops in motion are from reference numbers.

A long check: prints method, settings, rows, processor time and errors for

- Andrews' squeezer, spring and motor, 0.03 s: q of seven joints against 80-bit extrapolation;
- IFToMM A02, the N-four-bar of two loops, 10 s through some forty singular poses: the angle of its cranks against the
  pendulum that it is, 3 θ̈ = -3.5 g cos θ, and the balance of energy;
- IFToMM A04, Bricard's mechanism, 1 s: the point P3;
- the palletizing arm under control, 10 s: all its joints from the four that they follow.

Then the processor time of a compiled step of that arm, fastest of five runs, and of one in a rollout of 64.

tests/graphdyn/simulation/test_loops.py holds shorter ones.
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np
from robots.loop_motions import CASES, held_pose, squeezed

from graphdyn import rollout, simulate

STEPS = 10_000


def main() -> None:
    for name, case, settings in CASES:
        began = time.process_time()
        motion, error = case(**settings)
        took = time.process_time() - began
        balance = "" if case is squeezed else f", energy {motion.energy.drift:.1e}"
        told = ", ".join(f"{key} {value}" for key, value in settings.items())
        print(
            f"{name}: {told}: {len(motion.time) - 1} steps, {took:.2f} s; error {error:.1e}{balance}, "
            f"closed to {motion.closure_error().max():.1e}",
            flush=True,
        )
    model, q, v, control, _ = held_pose()
    for method in ("rk4", "rk8"):
        run = partial(simulate, model, q, v, 1e-3 * STEPS, torque=control, method=method, step=1e-3)
        print(f"palletizer, {method}: {fastest(run) / STEPS * 1e6:.1f} µs a step")
    run = partial(rollout, model, np.tile(q, (64, 1)), v, control, step=1e-3, duration=0.2, threads=1)
    print(f"palletizer, rk4, 64 at once: {fastest(run) / (200 * 64) * 1e6:.2f} µs a step of each")


def fastest(run: Callable[[], object]) -> float:
    """Processor time of the fastest of five runs [s]."""
    times = []
    for _ in range(5):
        began = time.process_time()
        run()
        times.append(time.process_time() - began)
    return min(times)
