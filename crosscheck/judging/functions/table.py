"""The functions of the judge that can be computed for many codes at once, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from crosscheck.judging.functions.articulated import articulated_bodies
from crosscheck.judging.functions.bodies import BodySums
from crosscheck.judging.functions.derivatives import AccelerationDerivative, Derivative, TorqueRecursion, power
from crosscheck.judging.functions.frames import FrameFormulations
from crosscheck.judging.functions.reactions import JointWrenches, Multipliers
from crosscheck.judging.functions.regressed import BodyWrenches, Momenta
from crosscheck.judging.slips.operations import Formulation
from crosscheck.quantities.measures import Chosen
from graphdyn import RobotModel

FRAMES: Mapping[str, Callable[[FrameFormulations], Formulation]] = {
    "frame_placement": lambda x: x.placement,
    "frame_jacobian": lambda x: x.jacobian,
    "frame_jacobian_derivative": lambda x: x.rates,
    "frame_velocity": lambda x: x.velocity,
    "frame_acceleration": lambda x: x.acceleration,
}

BODIES: Mapping[str, Callable[[BodySums], Formulation]] = {
    "center_of_mass": lambda x: x.center,
    "center_of_mass_velocity": lambda x: x.velocity,
    "center_of_mass_jacobian": lambda x: x.jacobian,
    "momentum": lambda x: x.momentum,
    "centroidal_map": lambda x: x.centroidal_map,
    "kinetic_energy": lambda x: x.kinetic_energy,
    "potential_energy": lambda x: x.potential_energy,
}

TORQUES: Mapping[str, Formulation] = {
    "power": power,
    "dtau_dq": Derivative(TorqueRecursion(), "q"),
    "dtau_dv": Derivative(TorqueRecursion(), "v"),
    "da_dq": AccelerationDerivative("q"),
    "da_dv": AccelerationDerivative("v"),
}


def formulation_of(name: str, model: RobotModel, frame: str | None, chosen: Chosen) -> Formulation | None:
    """The way to write a function; None for functions that are not known here."""
    if name in FRAMES and frame is not None and model.frame(frame).body > 0:
        return FRAMES[name](FrameFormulations(model.frame(frame), model.base, chosen))
    if name in BODIES:
        return BODIES[name](BodySums(model.base, chosen))
    wrenches = JointWrenches(model.base, chosen)
    if name == "joint_wrenches":
        return wrenches
    if name == "body_wrenches":
        return BodyWrenches(model.base)
    if name == "momenta":
        return Momenta()
    if name == "forward_dynamics":
        return articulated_bodies
    if name == "multipliers":
        return Multipliers(model.base)
    by: Any = name[-1]
    if name.startswith("dwrenches_d"):
        return Derivative(wrenches, by)
    if name.startswith("dmultipliers_d"):
        return Derivative(Multipliers(model.base), by)
    return TORQUES.get(name)
