"""How far published mechanisms with loops in motion are from reference numbers.

A long check: prints method, settings, rows, processor time and errors for

- Andrews' squeezer, spring and motor, 0.03 s: q of seven joints against 80-bit extrapolation;
- IFToMM A02, the N-four-bar of two loops, 10 s through some forty singular poses: the angle of its cranks against the
  pendulum that it is, 3 θ̈ = -3.5 g cos θ, and the balance of energy;
- IFToMM A04, Bricard's mechanism, 1 s: the point P3;
- the palletizing arm under control, 10 s: all its joints from the four that they follow.

tests/graphdyn/simulation/test_loops.py holds shorter ones.
"""

import time

from robots.loop_motions import CASES, squeezed


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
