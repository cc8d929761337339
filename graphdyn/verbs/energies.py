"""The public verbs that answer energies and power.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinity.
"""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from graphdyn.arguments.choices import VerbKeywords
from graphdyn.equations import projected, regressors
from graphdyn.equations.loops import dynamics as loops
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.answers import EnergyRegressor
from graphdyn.verbs.single_state import OfMotion, OfPositions, OfState, SingleState
from graphdyn.verbs.verb import computed, verb

__all__ = [
    "energy_regressor",
    "kinetic_energy",
    "potential_energy",
    "power",
]


@verb(projected.kinetic_energy)
def kinetic_energy(model: RobotModel, q: ArrayLike, v: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """T = Σ ½ (m ṙ² + ωᵀ J ω) of all bodies (…) [J], in the world also where the base moves.

    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> energy = graphdyn.kinetic_energy(model, q, v)
    >>> bool(np.isclose(energy, v @ graphdyn.mass_matrix(model, q) @ v / 2))
    True
    """
    return computed(kinetic_energy, model, (q, v), keywords)


@verb(projected.potential_energy)
def potential_energy(model: RobotModel, q: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """U = -Σ m g·r of all bodies (…) [J]; zero where the centers of mass are at the height of the world's origin.

    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q = graphdyn.kr500(), np.full(6, 0.3)
    >>> mass = sum(body.mass for body in model.bodies)
    >>> height = graphdyn.center_of_mass(model, q)[2]
    >>> bool(np.isclose(graphdyn.potential_energy(model, q), mass * 9.80665 * height))
    True
    """
    return computed(potential_energy, model, (q,), keywords)


@verb(projected.power, closed=loops.power)
def power(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    **keywords: Unpack[VerbKeywords[Array]],
) -> Array:
    """P_j = τ_j v_j (…, n) [W]: what each actuator supplies, with the torques of inverse_dynamics.

    On a base at rest and without external wrenches, they add up to the rate of kinetic_energy + potential_energy.
    q, v, a: joint state and accelerations                  (…, n)     [rad or m, …/s, …/s²]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> watts = graphdyn.power(model, q, v, a=np.zeros(6))
    >>> bool(np.allclose(watts, graphdyn.joint_torques(model, q, v, np.zeros(6)) * v))
    True
    """
    return computed(power, model, (q, v, a), keywords, external_wrenches)


@verb(regressors.energy_regressor, answer=EnergyRegressor)
def energy_regressor(
    model: RobotModel, q: ArrayLike, v: ArrayLike, **keywords: Unpack[VerbKeywords[EnergyRegressor]]
) -> EnergyRegressor:
    """T = kinetic @ π and U = potential @ π, π = model.inertial_parameters: (…, 10n) each.

    With τ·v = d(T + U)/dt, an identification without accelerations (Gautier and Khalil, "On the identification of the
    inertial parameters of robots", IEEE Conference on Decision and Control, 1988). The zero of U is that of
    potential_energy. The method "dense" is "projected" here.
    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> found = graphdyn.energy_regressor(model, q, v)
    >>> bool(np.isclose(found.kinetic @ model.inertial_parameters, graphdyn.kinetic_energy(model, q, v)))
    True
    """
    return computed(energy_regressor, model, (q, v), keywords)


class EnergyCalls:
    """The calls of a CompiledModel that answer energies and power."""

    kinetic_energy: SingleState[OfState]
    """T () [J]"""

    potential_energy: SingleState[OfPositions]
    """U () [J]"""

    power: SingleState[OfMotion]
    """P_j = τ_j v_j (n,) [W]"""
