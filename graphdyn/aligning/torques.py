"""What differs between two robots in the torques of their joints, and in the parameters that these determine."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from graphdyn.aligning.axes import JointAxes
from graphdyn.display import short_repr
from graphdyn.identification.algebra.base_parameters import base_parameters
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.inertia import PARAMETER_NAMES
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.dynamics import bias_torque, gravity_torque, inverse_dynamics
from graphdyn.verbs.matrices import joint_torque_regressor, mass_matrix

Term = Literal["gravity", "inertia", "velocity"]
"""A part of M(q) a + h(q, v): gravity is h(q, 0), velocity h(q, v) - h(q, 0), inertia M(q) a."""

REGRESSOR_STATES = 60
"""States from which base parameters are found: more than ten rows per column for any robot that is aligned."""


@dataclass(frozen=True, eq=False)
@short_repr
class TorqueDifference:
    """The largest difference of one term of the torque of one joint.

    term: "gravity", "inertia" or "velocity"
    joint: its name in A
    difference: torque of B minus that of A where it is largest           [N m or N]
    first: torque of A there; largest: of A or B over all states          [N m or N]
    q, v, a: the state                                                    (n,)
    counts: whether it is more than the tolerance, as a part of the force or moment that the joints bear in this term
    """

    term: Term
    joint: str
    difference: float
    first: float
    largest: float
    q: Array
    v: Array
    a: Array
    counts: bool

    @property
    def relative(self) -> float:
        """The difference as a part of the largest torque of this term and joint; zero where there is none."""
        return abs(self.difference) / self.largest if self.largest else 0.0


@dataclass(frozen=True)
@short_repr
class BaseParameterDifference:
    """A combination of inertial parameters that the joint torques depend on, with other values.

    name: the combination, in terms of A's links
    first, second: its values, of A and B                   [kg, kg m, kg m²]
    """

    name: str
    first: float
    second: float


def torque_differences(
    first: RobotModel, model: RobotModel, q: Array, v: Array, tolerance: float
) -> tuple[TorqueDifference, ...]:
    """Each term and joint of two robots of one kinematic form; accelerations are v in one second."""
    terms = _terms(first, q, v), _terms(model, q, v)
    scales = _scales(first, q, v)
    found = []
    for term in terms[0]:
        one, other = terms[0][term], terms[1][term]
        largest = np.maximum(np.abs(one), np.abs(other)).max(axis=0)
        for j, joint in enumerate(first.joints):
            gaps = other[:, j] - one[:, j]
            k = int(np.abs(gaps).argmax())
            force, moment = scales["weight" if term == "gravity" else "motion"]
            still = np.zeros_like(q[k])
            found.append(
                TorqueDifference(
                    term,
                    joint.name,
                    float(gaps[k]),
                    float(one[k, j]),
                    float(largest[j]),
                    q[k],
                    v[k] if term == "velocity" else still,
                    v[k] if term == "inertia" else still,
                    bool(abs(gaps[k]) > tolerance * (force if joint.is_prismatic else moment)),
                )
            )
    return tuple(found)


def base_differences(
    first: RobotModel, model: RobotModel, q: Array, v: Array, tolerance: float
) -> tuple[BaseParameterDifference, ...]:
    """Base parameters that differ, each judged by the largest of its kind: mass, first moment, second moment."""
    rows = slice(REGRESSOR_STATES)
    regressor = joint_torque_regressor(first, q[rows], v[rows], v[rows])
    base = base_parameters(regressor.reshape(-1, regressor.shape[-1]))
    names = [f"{body} {name}" for body in first.body_names for name in PARAMETER_NAMES]
    one, other = (base.values(each.inertial_parameters) for each in (first, model))
    kinds = np.array(["m" if k % 10 == 0 else "mc" if k % 10 < 4 else "I" for k in base.independent])
    scales = {
        kind: float(np.abs(np.concatenate([one[kinds == kind], other[kinds == kind]])).max()) for kind in set(kinds)
    }
    return tuple(
        BaseParameterDifference(name, float(a), float(b))
        for name, a, b, kind in zip(base.names(names), one, other, kinds, strict=True)
        if abs(a - b) > tolerance * scales[kind]
    )


def _terms(model: RobotModel, q: Array, v: Array) -> dict[Term, Array]:
    """(N, n) by term."""
    at_rest = gravity_torque(model, q)
    inertia: Array = (mass_matrix(model, q) @ v[..., None])[..., 0]
    return {"gravity": at_rest, "inertia": inertia, "velocity": bias_torque(model, q, v) - at_rest}


def _scales(model: RobotModel, q: Array, v: Array) -> dict[str, tuple[float, float]]:
    """Largest force [N] and moment [N m] of a joint by weight, and by motion.

    Unlike torques, these do not vanish where all axes are vertical, or where no velocity shows at any joint. A moment
    counts with the force at the end of the reach.
    """
    still, weightless = np.zeros_like(v), replace(model, gravity=np.zeros(3))
    found = {
        "weight": inverse_dynamics(model, q, still, still).joint_wrenches,
        "motion": inverse_dynamics(weightless, q, v, v).joint_wrenches,
    }
    reach = JointAxes.of(model).reach
    scales = {}
    for name, wrenches in found.items():
        force, moment = (float(np.linalg.norm(wrenches[..., part], axis=-1).max()) for part in (LINEAR, ANGULAR))
        scales[name] = force, moment + force * reach
    return scales
