"""What is judged, and how: the options of crosscheck.judge as one object, and the functions by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypedDict

from numpy.typing import ArrayLike

from crosscheck.judging.observing.function_under_test import BatchFunction
from crosscheck.quantities.tolerances import FUNCTION_UNDER_TEST, FUNCTION_UNDER_TEST_SINGLE, Tolerance
from crosscheck.reference.subject import Robot
from urdf import Reading, ReadingKeywords
from urdf.reading import AS_IT_STANDS

TestedFunction = Callable[..., ArrayLike] | BatchFunction
"""A function of one state: arrays of shape (n,) in the order of joint_names; or user code that is given batches."""

Precision = Literal["double", "single"]
TOLERANCES: Mapping[Precision, Tolerance] = {"double": FUNCTION_UNDER_TEST, "single": FUNCTION_UNDER_TEST_SINGLE}


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

    inverse_dynamics: TestedFunction | None
    forward_dynamics: TestedFunction | None
    bias_torque: TestedFunction | None
    gravity_torque: TestedFunction | None
    static_torque: TestedFunction | None
    power: TestedFunction | None
    joint_wrenches: TestedFunction | None
    multipliers: TestedFunction | None
    mass_matrix: TestedFunction | None
    mass_matrix_inverse: TestedFunction | None
    coriolis_matrix: TestedFunction | None
    frame_placement: TestedFunction | None
    frame_jacobian: TestedFunction | None
    frame_jacobian_derivative: TestedFunction | None
    frame_velocity: TestedFunction | None
    frame_acceleration: TestedFunction | None
    center_of_mass: TestedFunction | None
    center_of_mass_velocity: TestedFunction | None
    center_of_mass_jacobian: TestedFunction | None
    momentum: TestedFunction | None
    centroidal_map: TestedFunction | None
    kinetic_energy: TestedFunction | None
    potential_energy: TestedFunction | None
    dtau_dq: TestedFunction | None
    dtau_dv: TestedFunction | None
    da_dq: TestedFunction | None
    da_dv: TestedFunction | None
    dmultipliers_dq: TestedFunction | None
    dmultipliers_dv: TestedFunction | None
    dmultipliers_da: TestedFunction | None
    dwrenches_dq: TestedFunction | None
    dwrenches_dv: TestedFunction | None
    dwrenches_da: TestedFunction | None
    joint_torque_regressor: TestedFunction | None
    base_regressor: TestedFunction | None
    momentum_regressor: TestedFunction | None
    kinetic_energy_regressor: TestedFunction | None
    potential_energy_regressor: TestedFunction | None
    forward_dynamics_parameter_derivatives: TestedFunction | None
    body_regressor: TestedFunction | None


class JudgedKeywords(FunctionsUnderTest, ReadingKeywords, total=False):
    """What crosscheck.judge takes besides the parameters of its signature: functions, and how the robot is read."""
