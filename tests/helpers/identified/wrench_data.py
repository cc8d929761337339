"""Motions and joint wrenches as sensors would record them, from graphdyn's inverse dynamics."""

import numpy as np

from graphdyn.experiments.experiment import simulate_recording
from graphdyn.experiments.virtual_recording import VirtualRecording

PAPER_TIMES = (0.3, 0.6, 0.9, 1.2, 1.5)
"""The five samples of section 3.1 [s]."""


def recorded(model, q, v, a) -> VirtualRecording:
    """Exact data of any states (N, n): they need not follow each other."""
    laws = [lambda times, k=k: (q[:, k], v[:, k], a[:, k]) for k in range(model.n_bodies)]
    return simulate_recording(model, np.arange(float(len(q))), laws)


def random_recording(model, seed, size):
    """States within the limits of the robot, accelerations up to 10."""
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng, size)
    return recorded(model, q, v, rng.uniform(-10, 10, q.shape))
