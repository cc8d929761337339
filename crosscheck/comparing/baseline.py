"""The baseline identification: the same least squares with Pinocchio's regressor and with ours.

PinocchioBodies puts Pinocchio's regressor into a torque model, so that every estimator runs on it unchanged.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.quantities.scales import term_sizes
from crosscheck.quantities.states import ACCELERATION_RANGE
from crosscheck.quantities.tolerances import EPS
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import InvalidInput, RobotModel, joint_torque_regressor, maximal_state
from graphdyn.equations import link_origins
from graphdyn.identification import Samples, base_parameters, ordinary_least_squares
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import BODY_PARAMETERS, Array

STATES_PER_PARAMETER = 4
"""Number of random states per standard parameter: each gives n equations, so far more than the at most 10n unknowns."""


MAX_JOINT_SPEED = 10.0
"""Largest joint speed [rad/s or m/s]: beyond, the rounding of centrifugal torques hides the other torques."""


@dataclass(frozen=True, eq=False)
class PinocchioBodies(RigidBodies):
    """RigidBodies with computeJointTorqueRegressor in place of our regressor.

    pinocchio: Pinocchio's reading of the robot of the torque model
    Raises InvalidInput for samples with a moving base, because Pinocchio's regressor has a fixed base.
    """

    pinocchio: PinocchioModel

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        if samples.base is not None:
            raise InvalidInput("Pinocchio's regressor has a fixed base, and the base of these samples moves")
        return self.pinocchio.torque_regressor(*(np.asarray(x, dtype=float) for x in (samples.q, samples.v, samples.a)))


@dataclass(frozen=True)
class BaselineIdentification:
    """Base parameters from simulated torques, by both regressors.

    rank, rank_there: number of base parameters according to our regressor and to Pinocchio's
    condition_number: of our regressor's independent columns, scaled to unit length
    gap: smallest accepted and largest rejected pivot
    difference: between the two estimates, as torques, relative to cond ‖x‖∞ max(1, rounding of a column)
    error: of our estimate against the model's own base parameters, on that scale plus cond × rounding of the torques
    """

    rank: int
    rank_there: int
    condition_number: float
    gap: tuple[float, float]
    difference: float
    error: float


def compare_identification(model: RobotModel, pinocchio: PinocchioModel, seed: int) -> BaselineIdentification:
    """Simulate torques with Pinocchio, identify the base parameters with both regressors, compare."""
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng, STATES_PER_PARAMETER * BODY_PARAMETERS)
    v = np.clip(v, -MAX_JOINT_SPEED, MAX_JOINT_SPEED)
    a = rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape)
    torque = pinocchio.rnea(q, v, a).reshape(-1)
    here = joint_torque_regressor(model, q, v, a).reshape(torque.size, -1)
    there = pinocchio.torque_regressor(q, v, a).reshape(torque.size, -1)
    base, base_there = base_parameters(here), base_parameters(there)
    pi = model.inertial_parameters
    left_out = base.dependent[~base.regrouping.any(axis=0)]  # too short to be columns (DROPPED_COLUMN), yet not zero
    rnea, torque = torque, torque - there[:, left_out] @ pi[left_out]
    ours = ordinary_least_squares(here[:, base.independent], torque)
    try:
        theirs = ordinary_least_squares(there[:, base.independent], torque).parameters
    except InvalidInput:  # columns independent by our regressor are dependent by Pinocchio's
        theirs = np.full(base.rank, np.inf)
    true = base.values(pi)
    column_terms, torque_terms = _terms(model, q, v, a)
    used = base.independent
    columns = _rounding(here - there, column_terms)[used] / np.linalg.norm(here[:, used], axis=0)
    scale = ours.condition_number * np.abs(ours.column_scale * true).max(initial=0.0)
    scale *= columns.max(initial=1.0)
    of_torques = ours.condition_number * float(_rounding(rnea - here @ pi, torque_terms))

    def on_scale(difference: Array, scale: float) -> float:
        largest = np.abs(ours.column_scale * difference).max(initial=0.0)
        return float(largest / scale) if largest > 0 else 0.0

    return BaselineIdentification(
        rank=base.rank,
        rank_there=base_there.rank,
        condition_number=ours.condition_number,
        gap=base.gap,
        difference=on_scale(ours.parameters - theirs, scale),
        error=on_scale(ours.parameters - true, scale + of_torques),
    )


def _rounding(difference: Array, terms: Array) -> Array:
    """The number of eps two correct computations may differ: their difference, at most that of the summed terms.

    Where terms cancel, as for a center of mass whose acceleration nearly equals gravity, columns or torques are short;
    scaled to unit length, they carry a large relative rounding into the parameters.
    """
    rounding: Array = np.minimum(np.linalg.norm(difference, axis=0) / EPS, terms)
    return rounding


def _terms(model: RobotModel, q: Array, v: Array, a: Array) -> tuple[Array, Array]:
    """Length of the terms that are summed to get each column of the regressor (10n,), and to get the torques ()."""
    state = maximal_state(model, q, v, a)
    assert state.acceleration is not None
    size = term_sizes(model, v, a, link_origins(state), state.velocity, state.acceleration)
    mass, first_moment, tensor = size.regressor_columns
    of_body = np.stack([mass, *3 * [first_moment], *6 * [tensor]], axis=-1)
    rows = np.sqrt(model.n_bodies)
    columns = rows * np.linalg.norm(np.tile(of_body, model.n_bodies), axis=0)
    return columns, rows * np.linalg.norm(np.maximum(size.force, size.moment))
