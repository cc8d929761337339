"""Regressors read as functions of another robot, whose faults are known: wrenches of bodies, momenta, energies.

Any inertial parameters serve; random ones leave no column unseen.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from crosscheck.judging.verdicts.verdicts import Judged
from crosscheck.quantities import FUNCTIONS, Quantity
from crosscheck.quantities.measures import Chosen, relative_to
from crosscheck.quantities.quantity import Ours
from crosscheck.quantities.scaled_states import ScaledStates
from graphdyn.arguments import Method
from graphdyn.layout import BODY_DOF, BODY_PARAMETERS, Array


def _times(regressor: Array, parameters: Array) -> Array:
    """What a regressor gives with parameters: one of all bodies (N, …, 10 n), or one of each (N, n, 6, 10)."""
    if regressor.shape[-1] == len(parameters):
        return regressor @ parameters
    found: Array = np.einsum("...bij,bj->...bi", regressor, parameters.reshape(-1, BODY_PARAMETERS))
    return found


def _given_by(regressor: str, name: str, shape: tuple[int | str, ...]) -> Quantity:
    known = FUNCTIONS[regressor]

    def compute(states: ScaledStates, chosen: Chosen, method: Method) -> Array:
        return _times(known.of_graphdyn(states, chosen, method), states.model.inertial_parameters)

    ours = Ours(known.arguments, shape, known.ours.unit, compute, known.ours.code)
    return replace(known, name=name, ours=ours, errors=relative_to())


GIVEN_BY: Mapping[str, Quantity] = {
    "kinetic_energy_regressor": FUNCTIONS["kinetic_energy"],
    "potential_energy_regressor": FUNCTIONS["potential_energy"],
    "body_regressor": _given_by("body_regressor", "body_wrenches", ("n", BODY_DOF)),
    "momentum_regressor": _given_by("momentum_regressor", "momenta", ("n",)),
}
"""What regressors give with inertial parameters."""


def read_with_parameters(found: Judged) -> Judged:
    """What a regressor gives for a robot with other bodies, in the usual conventions."""
    known, states = GIVEN_BY[found.function.name], found.states
    own = states.model.inertial_parameters
    rng = np.random.default_rng(0)
    size = np.tile(np.abs(own.reshape(-1, BODY_PARAMETERS)).max(axis=0), states.model.n_bodies)
    parameters = np.where(size > 0, size, 1.0) * rng.uniform(0.5, 1.5, own.shape)
    states = replace(states, model=states.model.with_inertial_parameters(parameters))
    usual = {name: ways[0] for name, ways in known.conventions.items()}
    function, answer = replace(found.function, known=known), _times(found.answer, states.model.inertial_parameters)
    return replace(found, function=function, states=states, answer=answer, declared=usual)
