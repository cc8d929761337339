"""Whether threads may share the calls of one compiled robot: python tests/tools shared_calls [CALLS]

Every thread calls joint_torques and mass_matrix CALLS times (a million by default) on states of its own, and compares
each result with that of the batch, bit for bit. Prints the wrong ones; exit code 1 if there are any. Minutes.
"""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import graphdyn

THREADS = 8
STATES = 1000
"""States of each thread, called in turn."""


def wrong_results(loop: graphdyn.CompiledModel, seed: int, calls: int) -> int:
    model = loop.model
    q, v = model.random_state(np.random.default_rng(seed), STATES)
    torques = graphdyn.joint_torques(model, q, v, v, method="recursive")
    masses = graphdyn.mass_matrix(model, q, method="recursive")
    wrong = 0
    for k in range(calls):
        row = k % STATES
        torque, mass = loop.joint_torques(q[row], v[row], v[row]), loop.mass_matrix(q[row])
        wrong += not (np.array_equal(torque, torques[row]) and np.array_equal(mass, masses[row]))
    return wrong


def main() -> int:
    calls = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    loop = graphdyn.compile(graphdyn.kr500())
    sys.setswitchinterval(1e-5)  # seconds: threads take turns five hundred times as often as usual
    with ThreadPoolExecutor(THREADS) as pool:
        wrong = sum(pool.map(lambda seed: wrong_results(loop, seed, calls), range(THREADS)))
    print(f"{THREADS} threads, {calls} calls of two verbs each, one shared object: {wrong} wrong")
    return int(wrong > 0)
