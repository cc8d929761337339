"""Energies, momenta and the center of mass as steps of one body, and where the bodies are."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphdyn.compiler.rolled.program import ColumnPasses, Pass
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.compiler.rolled.steps.world import BODIES, ground, moving, per_rate
from graphdyn.recursions.momentum import of_parameters
from graphdyn.scalars.vectors import cross


def _no_energy(x: BodyStep) -> None:
    ground(x)
    x.sum("energy", 0.0)


def _kinetic(x: BodyStep) -> None:
    moving(x)
    u, omega, moment = x.kept("velocity"), x.kept("omega"), x.kept("moment")
    twice = u @ (u * x.kept("mass") + cross(omega, moment) * 2.0) + omega @ (x.kept("tensor") @ omega)
    x.add_at_ground("energy", twice * 0.5)


def _potential(x: BodyStep) -> None:
    moving(x)
    x.add_at_ground("energy", -(x.root.gravity @ (x.kept("origin") * x.kept("mass") + x.kept("moment"))))


def _energy(array: str) -> Pass:
    return Pass("ground", lambda x: x.answer(array, x.kept("energy")))


def _per_parameter(x: BodyStep) -> None:
    """Energies of the body per inertial parameter, in link axes."""
    moving(x)
    to_link = x.link.link_axes @ x.kept("rotation").T
    gravity = x.root.gravity
    kinetic, potential = of_parameters(
        to_link @ x.kept("velocity"), to_link @ x.kept("omega"), -(gravity @ x.kept("origin")), -(to_link @ gravity)
    )
    x.answer("kinetic", kinetic)
    x.answer("potential", potential)


def _center(x: BodyStep) -> None:
    x.answer("center_of_mass", x.kept("origin") + x.kept("moment") / x.mass)


def _center_velocity(x: BodyStep) -> None:
    x.answer("center_of_mass_velocity", x.kept("velocity") + x.kept("impulse") / x.mass)


def _center_column(x: BodyStep) -> None:
    x.answer("center_of_mass_jacobian", per_rate(x)[0] / x.mass)


def _momentum(x: BodyStep) -> None:
    flow, moment, velocity = x.kept("flow"), x.kept("moment"), x.kept("velocity")
    linear = x.kept("impulse") + velocity * x.mass
    # ∫ c × ċ dm about joint 1, of ∫ ċ cᵀ dm
    turning = np.array([flow[2, 1] - flow[1, 2], flow[0, 2] - flow[2, 0], flow[1, 0] - flow[0, 1]], dtype=object)
    spin = turning + cross(moment, velocity)
    x.answer("about_center_of_mass", [*linear, *(spin - cross(moment / x.mass, linear))])
    x.answer("about_origin", [*linear, *(spin + cross(x.kept("origin"), linear))])


def _momentum_column(x: BodyStep) -> None:
    linear, angular = per_rate(x)
    arm = x.kept("reach") - x.at_ground("moment") / x.mass
    x.answer("centroidal_map", [*linear, *(angular + cross(arm, linear))])


def _state(x: BodyStep) -> None:
    moving(x)
    to_world, omega, link = x.kept("rotation"), x.kept("omega"), x.link
    center = to_world @ link.center_of_mass
    x.answer("position", x.kept("origin") + center)
    x.answer("rotation", to_world @ link.link_axes.T)
    x.answer("velocity", [*(x.kept("velocity") + cross(omega, center)), *(link.link_axes @ (to_world.T @ omega))])


def _of_bodies(step: Any) -> tuple[Pass, ...]:
    return Pass("ground", ground), Pass("outwards", step)


PASSES: dict[str, tuple[Pass | ColumnPasses, ...]] = {
    "kinetic_energy": (Pass("ground", _no_energy), Pass("outwards", _kinetic), _energy("kinetic_energy")),
    "potential_energy": (Pass("ground", _no_energy), Pass("outwards", _potential), _energy("potential_energy")),
    "energy_regressor": _of_bodies(_per_parameter),
    "center_of_mass": (*BODIES, Pass("ground", _center)),
    "center_of_mass_velocity": (*BODIES, Pass("ground", _center_velocity)),
    "center_of_mass_jacobian": (*BODIES, Pass("outwards", _center_column)),
    "momentum": (*BODIES, Pass("ground", _momentum)),
    "centroidal_map": (*BODIES, Pass("outwards", _momentum_column)),
    "maximal_state": _of_bodies(_state),
}
"""Passes by recursion."""
