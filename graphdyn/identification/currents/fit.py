"""The fit of gains, links, friction and loads to currents, and its covariance.

Least squares on compressed equations. Each joint of each recording is weighted by the noise that its own linear fit has
left over in the sums of its time blocks, so that what is correlated in time counts less. The covariance of the data is
a jackknife over the time blocks of all recordings; what was stated beforehand (gains, links, loads) adds its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.currents.covariance import current_covariance
from graphdyn.identification.currents.equations import CurrentEquations, LoadedRecording
from graphdyn.identification.currents.gains import JointGains
from graphdyn.identification.currents.knowledge import knowledge
from graphdyn.identification.currents.loads import IdentifiedLoad, KnownLoad
from graphdyn.identification.currents.noise import current_noise
from graphdyn.identification.currents.projection import GainFit, Point, least_squares_solution
from graphdyn.identification.currents.trusted_gravity import TrustedGravity
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

MAX_RELATIVE_DEVIATION = 1.0
"""Relative standard deviation of a gain from which it counts as undetermined."""


@dataclass(frozen=True, eq=False)
@short_repr
class CurrentFit:
    """Gains, links and loads that fit recorded currents best.

    gains: of the joints
    reversed: whether the current of each joint runs against its torque   (n,)
    loads: by name
    links: base parameters of the structure that belong to links (r,)
    currents: linear parameters of every recording and joint, c_j = W_j u_j   (k, n, b)
    noise: of the currents, with its correlation in time; infinite for dead channels   (k, n)
    """

    gains: JointGains
    reversed: NDArray[np.bool_]
    loads: Mapping[str, IdentifiedLoad]
    links: Array
    currents: Array
    noise: Array


def fit_currents(
    torque_model: TorqueModel,
    recordings: Sequence[LoadedRecording],
    *,
    carrier: str | None = None,
    gains: JointGains | None = None,
    known_loads: Mapping[str, KnownLoad] | None = None,
    gravity: TrustedGravity | None = None,
) -> CurrentFit:
    """Fit gains, links and loads to the currents of recordings.

    carrier: link that carries the loads, the last one if None
    gains, known_loads, gravity: what is known; at least one of them, because gains, links and loads scale together

    Raises InvalidInput where nothing is known, for a load that no recording carries, for a recording without two time
    blocks, and where every channel is dead; EstimationFailed where the fit does not end.
    """
    equations = CurrentEquations(torque_model, recordings, carrier)
    known_loads = known_loads or {}
    if gains is None and gravity is None and not known_loads:
        raise InvalidInput(
            "currents alone determine no gain: gains, links and loads scale together; give a known load, gains, or "
            "links whose gravity is trusted"
        )
    if gains is not None and len(gains.values) != equations.n_joints:
        raise InvalidInput(f"there are {len(gains.values)} gains for {equations.n_joints} joints; give one per joint")
    missing = [load for load in known_loads if load not in equations.loads]
    if missing:
        raise InvalidInput(f"no recording carries the load '{missing[0]}'; those carried: {', '.join(equations.loads)}")
    if min(len(recording.blocks) for recording in recordings) < 2:
        raise InvalidInput("standard deviations need two time blocks or more of every recording; record longer")
    noise = current_noise(equations)
    if not np.any(np.isfinite(noise)):
        raise InvalidInput("no current changes in any recording; record a motion of all joints")
    known = knowledge(equations, gains, known_loads, gravity)
    fit = GainFit(equations, known, noise)
    point = fit.best()
    if np.any(point.signs < 0):
        equations = replace(equations, signs=point.signs)
    x = _unknowns(equations, point, fit.linear(point))
    covariance, own = current_covariance(equations, known, noise, x), equations.gain_columns
    return CurrentFit(
        _gains(x[own], covariance.measured[own, own], covariance.expected[own, own]),
        point.signs < 0,
        {
            load: IdentifiedLoad(x[columns], covariance.measured[columns, columns])
            for load in equations.loads
            for columns in [equations.load_columns(load)]
        },
        x[equations.link_columns],
        np.array([equations.currents(k, x) for k in range(len(recordings))]),
        noise,
    )


def _unknowns(equations: CurrentEquations, point: Point, torques: Array) -> Array:
    """All unknowns (size,), from gains, and links and loads; the friction is that which fits best."""
    x = np.zeros(equations.size)
    x[equations.gain_columns], x[equations.torque_columns] = point.logarithms, torques
    for k, total in enumerate(equations.totals):
        values = equations.currents(k, x)
        for joint, factor in enumerate(total.factors):
            own, places = equations.friction_columns(k, joint)
            x[places] = least_squares_solution(factor[:, own], factor[:, -1] - factor[:, :-1] @ values[joint])
    return x


def _gains(logarithms: Array, measured: Array, expected: Array) -> JointGains:
    """The gains; those that are hardly known, and their covariances, are undetermined.

    Their deviations are measured, their correlations those expected. Whoever uses gains weighs them against other
    recordings, and combinations that seem certain by chance would count most.
    """
    lost = ~(np.diagonal(measured) < MAX_RELATIVE_DEVIATION**2)
    known = np.where(lost, 1.0, np.diagonal(measured)), np.where(lost, 1.0, np.diagonal(expected))
    factor = np.sqrt(known[0] / known[1])
    covariance = np.where(lost | lost[:, None], 0.0, expected) * factor * factor[:, None]
    covariance[lost, lost] = np.inf
    return JointGains(np.where(lost, np.nan, np.exp(logarithms)), covariance)
