"""The part of a torque model that a simulation needs: bodies, friction and rotors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import Coulomb, Offset, RotorInertia, Viscous
from graphdyn.identification.terms.term import CarriesBodies, CarriesKnownBodies
from graphdyn.layout import Array
from graphdyn.simulation import Friction


@dataclass(frozen=True, eq=False)
class DrivenRobot:
    """R robots with their drives.

    bodies: inertial parameters                             (R, 10 n)
    friction: per joint and robot                           (R, n) each
    rotors: inertia of the rotors                           (R, n)
    """

    bodies: Array
    friction: Friction
    rotors: Array

    @classmethod
    def of(cls, torque_model: TorqueModel, parameters: Array) -> DrivenRobot:
        """The robots of parameters (R, p). Negative friction and rotor inertia count as zero: they would drive the
        joints.
        """
        shape = (len(parameters), torque_model.model.n_freedoms)

        def drive(kind: type) -> Array:
            columns = torque_model.slice_of(kind)
            return np.zeros(shape) if columns is None else parameters[:, columns]

        bodies = np.array([torque_model.inertial_parameters(x) for x in parameters])
        viscous, dry, rotors = (np.maximum(drive(kind), 0.0) for kind in (Viscous, Coulomb, RotorInertia))
        return cls(bodies, Friction(viscous, dry, drive(Offset)), rotors)


def not_simulated(torque_model: TorqueModel) -> list[str]:
    """Names of the terms that the simulation lacks or only approximates (a smooth sign of v)."""
    exact = [
        type(term) in (Viscous, Offset)
        or (isinstance(term, RotorInertia) and term.gears is None)
        or (isinstance(term, Coulomb) and term.width is None)
        or isinstance(term, CarriesBodies)
        for term in torque_model.terms
    ]
    rough = [type(term).__name__ for term, known in zip(torque_model.terms, exact, strict=True) if not known]
    return rough + [type(term).__name__ for term in torque_model.known if not isinstance(term, CarriesKnownBodies)]
