"""What is judged, and how: the options of crosscheck.judge as one object, and the functions by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypedDict

from numpy.typing import ArrayLike

from crosscheck.judging.observing.function_under_test import BatchFunction
from crosscheck.quantities.tolerances import FOREIGN, FOREIGN_SINGLE, Tolerance
from crosscheck.reference.subject import Robot
from urdf import Reading, ReadingKeywords
from urdf.reading import AS_IT_STANDS

Foreign = Callable[..., ArrayLike] | BatchFunction
"""A function of one state: arrays of shape (n,) in the order of joint_names; or foreign code that is given batches."""

Precision = Literal["double", "single"]
TOLERANCES: Mapping[Precision, Tolerance] = {"double": FOREIGN, "single": FOREIGN_SINGLE}


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A judgment without its functions; the fields are explained at crosscheck.judge."""

    robot: Robot
    reading: Reading = AS_IT_STANDS
    joint_names: Sequence[str] | None = None
    samples: int = 100
    seed: int = 0
    precision: Precision = "double"
    tolerance: float | None = None
    beyond_limits: bool = False
    frame: str | None = None
    conventions: Mapping[str, str] = field(default_factory=dict)
    external_wrenches: bool = False
    batched: bool = False

    @property
    def bound(self) -> float:
        """Largest relative error that counts as agreement."""
        return TOLERANCES[self.precision].bound if self.tolerance is None else self.tolerance


class FunctionsUnderTest(TypedDict, total=False):
    """The functions that crosscheck.judge takes as keywords; docs/judge.md lists arguments and answers."""

    inverse_dynamics: Foreign | None
    forward_dynamics: Foreign | None
    bias_torque: Foreign | None
    gravity_torque: Foreign | None
    static_torque: Foreign | None
    power: Foreign | None
    joint_wrenches: Foreign | None
    multipliers: Foreign | None
    mass_matrix: Foreign | None
    mass_matrix_inverse: Foreign | None
    coriolis_matrix: Foreign | None
    frame_placement: Foreign | None
    frame_jacobian: Foreign | None
    frame_jacobian_derivative: Foreign | None
    frame_velocity: Foreign | None
    frame_acceleration: Foreign | None
    center_of_mass: Foreign | None
    center_of_mass_velocity: Foreign | None
    center_of_mass_jacobian: Foreign | None
    momentum: Foreign | None
    centroidal_map: Foreign | None
    kinetic_energy: Foreign | None
    potential_energy: Foreign | None
    dtau_dq: Foreign | None
    dtau_dv: Foreign | None
    da_dq: Foreign | None
    da_dv: Foreign | None
    dmultipliers_dq: Foreign | None
    dmultipliers_dv: Foreign | None
    dmultipliers_da: Foreign | None
    dwrenches_dq: Foreign | None
    dwrenches_dv: Foreign | None
    dwrenches_da: Foreign | None
    joint_torque_regressor: Foreign | None
    base_regressor: Foreign | None
    momentum_regressor: Foreign | None
    kinetic_energy_regressor: Foreign | None
    potential_energy_regressor: Foreign | None
    forward_dynamics_parameter_derivatives: Foreign | None
    body_regressor: Foreign | None


class JudgedKeywords(FunctionsUnderTest, ReadingKeywords, total=False):
    """What crosscheck.judge takes besides the parameters of its signature: functions, and how the robot is read."""
