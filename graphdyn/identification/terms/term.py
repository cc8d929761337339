"""The interface of a part of the torque: columns with names and units, and their rows in the regressor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from graphdyn.identification.data.samples import Samples
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel


@dataclass(frozen=True)
class TermParameter:
    """One parameter of the torque.

    name: such as "forearm I_xx" or "elbow viscous friction"
    symbol: in the notation of Khalil and Gautier, with the number of body or joint: XX_3, FV_3
    unit: of the parameter
    """

    name: str
    symbol: str
    unit: str


class Term(Protocol):
    """A part of the torque with unknown parameters: any class with these two methods.

    A term whose rows depend on earlier samples has an attribute has_memory = True; it receives whole runs.
    """

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        """The k parameters of this part."""
        ...

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        """Regressor W (N, n, k): the torque of the term is W x. Reading samples.tau raises InvalidInput."""
        ...


class KnownTerm(Protocol):
    """A part of the torque without unknowns; it is subtracted from the measured torque."""

    def torque(self, model: RobotModel, samples: Samples) -> Array:
        """Torque (N, n) [N m or N]. Reading samples.tau raises InvalidInput."""
        ...


@runtime_checkable
class CarriesBodies(Protocol):
    """A term whose parameters x belong to the inertia of the bodies."""

    def inertial_parameters(self, model: RobotModel, x: Array) -> Array:
        """Contribution to the ten parameters of every body (10 n,)."""
        ...


@runtime_checkable
class CarriesKnownBodies(Protocol):
    """A known term that belongs to the inertia of the bodies."""

    def known_inertial_parameters(self, model: RobotModel) -> Array:
        """Contribution to the ten parameters of every body (10 n,)."""
        ...


def per_joint_columns(
    model: RobotModel, what: str, symbol: str, unit: str, slide_unit: str
) -> tuple[TermParameter, ...]:
    """One column for each independent joint; the second unit is that of a prismatic joint."""
    joints = [(k + 1, model.joints[k]) for k in model.degrees_of_freedom.independent]
    return tuple(
        TermParameter(f"{joint.name} {what}", f"{symbol}_{j}", slide_unit if joint.is_prismatic else unit)
        for j, joint in joints
    )


def per_joint_rows(*values: Array) -> Array:
    """Diagonal regressors (N, n, n) of values (N, n), side by side: column j of each acts on joint j alone."""
    joints = np.arange(values[0].shape[1])
    rows = np.zeros((*values[0].shape, len(values), len(joints)))
    for k, part in enumerate(values):
        rows[:, joints, k, joints] = part
    return rows.reshape(*values[0].shape, -1)
