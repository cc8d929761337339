"""How the uncertainty of gains shows in base parameters that were identified from converted torques."""

from __future__ import annotations

import numpy as np

from graphdyn.identification.algebra.compressed import CompressedEquations, weighted_solution
from graphdyn.identification.currents.gains import JointGains
from graphdyn.layout import Array


def gain_deviations(equations: CompressedEquations, gains: JointGains) -> Array:
    """Standard deviations of the base parameters from those of the gains alone (b,).

    equations: of torques that are gains times currents, one group per joint

    A gain that is larger by dk of itself changes the weighted solution by C W_jᵀ τ_j / σ_j² dk. All together, by dk,
    they change every parameter by dk of itself. Raises EstimationFailed as weighted_solution, and where a gain is
    undetermined the deviations are infinite.
    """
    solution, noise = weighted_solution(equations)
    if not gains.determined.all():
        return np.full(equations.n_columns, np.inf)
    w, tau = equations.factors[..., :-1], equations.factors[..., -1]
    slope = solution.inverse @ (np.einsum("jrb,jr->jb", w, tau) / noise[:, None] ** 2).T
    found: Array = np.sqrt(np.einsum("bj,jk,bk->b", slope, gains.covariance, slope))
    return found
