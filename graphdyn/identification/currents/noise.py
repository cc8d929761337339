"""Noise of recorded currents, with its correlation in time, from the linear fit of every joint alone."""

from __future__ import annotations

import numpy as np

from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.currents.equations import CurrentEquations
from graphdyn.layout import Array

LEAST_NOISE = 1e-5
"""Noise of a current, relative to its root mean square, that every recording is taken to have: that of 16 bits. Exact,
simulated recordings would else outweigh all that is known, to the last digit."""

DEAD_SHARE = 1e-9
"""Share of a current that its friction and offset leave unexplained below which its channel is dead: rounding of a
constant column."""


def current_noise(equations: CurrentEquations) -> Array:
    """Noise of the currents of every recording and joint (k, n); infinite for a dead channel.

    The scores s_b = W_bᵀ e_b of the time blocks of a linear fit have the covariance W_bᵀ W_b σ² for white noise; what
    is correlated makes them larger.
    """
    found = np.full((len(equations.recordings), equations.n_joints), np.inf)
    for k, (recording, total) in enumerate(zip(equations.recordings, equations.totals, strict=True)):
        for joint, factor in enumerate(total.factors):
            size = np.linalg.norm(factor[:, -1])
            if np.linalg.norm(equations.without_friction[k][joint][:, -1]) <= DEAD_SHARE * size:
                continue
            length = np.linalg.norm(factor[:, :-1], axis=0)
            used = length > RANK_TOLERANCE * length.max(initial=0.0)
            unit = factor[:, :-1][:, used] / length[used]
            u, s, v_t = np.linalg.svd(unit, full_matrices=False)
            kept = s > RANK_TOLERANCE * s.max(initial=0.0)
            inverse = v_t[kept].T / s[kept]  # of the factor, so that scores of white noise have unit size
            solution = inverse @ (u[:, kept].T @ factor[:, -1])
            squares = 0.0
            for block in recording.blocks:
                w = block.factors[joint][:, :-1][:, used] / length[used]
                squares += float(np.sum((inverse.T @ (w.T @ (block.factors[joint][:, -1] - w @ solution))) ** 2))
            least = LEAST_NOISE * size / np.sqrt(max(int(total.counts[joint]), 1))
            found[k, joint] = max(np.sqrt(squares / max(int(kept.sum()), 1)), least)
    return found
