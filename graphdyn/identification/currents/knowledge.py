"""What is known beside the currents, as equations in units of its deviations: gains, loads, links."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.compressed import EPS
from graphdyn.identification.currents.equations import CurrentEquations
from graphdyn.identification.currents.gains import JointGains
from graphdyn.identification.currents.loads import KnownLoad
from graphdyn.identification.currents.trusted_gravity import TrustedGravity
from graphdyn.layout import Array


def knowledge(
    equations: CurrentEquations,
    gains: JointGains | None,
    loads: Mapping[str, KnownLoad],
    gravity: TrustedGravity | None,
) -> tuple[Array, Array]:
    """Rows (m, size) and right side (m,) for all unknowns."""
    rows, right = equations.known_loads({name: load.equations() for name, load in loads.items()})
    if gains is not None:
        some = np.flatnonzero(gains.determined)
        variances, axes = np.linalg.eigh(gains.covariance[np.ix_(some, some)])
        floor = max(float(variances.max(initial=0.0)) * RANK_TOLERANCE, EPS)
        whiten = np.zeros((len(some), equations.size))
        whiten[:, some] = axes.T / np.sqrt(np.maximum(variances, floor))[:, None]
        rows = np.concatenate([rows, whiten])
        right = np.concatenate([right, whiten[:, some] @ np.log(gains.values[some])])
    if gravity is not None:
        a, b = gravity.equations(equations.torque_model)
        spread = np.zeros((len(b), equations.size))
        spread[:, equations.link_columns] = a[:, equations.links]
        rows, right = np.concatenate([rows, spread]), np.concatenate([right, b])
    return rows, right
