"""Energies, momenta and the center of mass as steps of one body, and where the bodies are.

What is summed up once, and not for every column anew, is summed in joint axes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from graphdyn.compiler.rolled.program import ColumnPasses, Pass
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.compiler.rolled.steps.world import BODIES, ground, moving, per_rate
from graphdyn.recursions.inverse import inwards
from graphdyn.recursions.momentum import of_motion, of_parameters
from graphdyn.recursions.motion import places, resting_root, twists
from graphdyn.scalars.vectors import E_Z, Scalars, cross, zeros


def _ground(x: BodyStep) -> None:
    """The motion of the ground frame, and sums of all bodies."""
    x.keep("twist", (x.root.velocity, x.root.omega))
    for name, shape in SUMS.items():
        x.sum(name, zeros(*shape))


SUMS: dict[str, tuple[int, ...]] = {"energy": (), "mass": (), "moment": (3,), "flow": (3,), "momentum": (2, 3)}
"""Shapes of sums: kinetic energy, m, m c, the velocity of m c, and linear and angular momentum, about the origin of the
body; all but the energy of the body and those outside."""


def _twist(x: BodyStep) -> tuple[Scalars, Scalars]:
    """Velocity of the origin and ω."""
    velocity, omega = x.inside("twist")
    place, root = places([x.link], [x.joint("q")]), replace(resting_root(), velocity=velocity, omega=omega)
    (twist,) = twists([x.link], place, root, [x.joint("v")])
    x.keep("twist", twist)
    return twist


def _kinetic(x: BodyStep) -> None:
    u, omega = _twist(x)
    twice = u @ (u * x.link.mass + cross(omega, x.link.first_moment) * 2.0) + omega @ (x.link.tensor @ omega)
    x.add_at_ground("energy", twice * 0.5)


def _own(x: BodyStep) -> None:
    """What the body itself adds to the sums."""
    x.sum("mass", x.link.mass)
    x.sum("moment", x.link.first_moment)
    x.sum("flow", zeros(3))
    x.sum("momentum", of_motion(x.link, *_twist(x)))


def _gathered(x: BodyStep) -> None:
    """The sums are complete, and are added to those of the inside body."""
    (place,) = places([x.link], [x.joint("q")])
    mass, moment = x.kept("mass"), x.kept("moment")
    linear = np.array([0.0, 0.0, mass], dtype=object) if x.prismatic else cross(E_Z, moment)
    x.add("mass", mass)
    x.add("moment", place.inwards(moment) + place.translation * mass)
    x.add("flow", place.inwards(x.kept("flow") + linear * x.joint("v")))
    force, torque = x.kept("momentum")
    x.add("momentum", inwards(place, (force, torque)))


WHOLE = Pass("ground", _ground), Pass("outwards", _own), Pass("inwards", _gathered)
"""Sums of all bodies at the ground. What nobody reads is not computed."""


def _no_energy(x: BodyStep) -> None:
    ground(x)
    x.sum("energy", 0.0)


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
    x.answer("center_of_mass", x.root.position + x.root.rotation @ (x.kept("moment") / x.mass))


def _center_velocity(x: BodyStep) -> None:
    root, center = x.root, x.kept("moment") / x.mass
    in_ground = root.velocity + cross(root.omega, center) + x.kept("flow") / x.mass
    x.answer("center_of_mass_velocity", root.rotation @ in_ground)


def _center_column(x: BodyStep) -> None:
    x.answer("center_of_mass_jacobian", per_rate(x)[0] / x.mass)


def _momentum(x: BodyStep) -> None:
    root, center = x.root, x.kept("moment") / x.mass
    in_ground, about_joint = x.kept("momentum")
    linear = root.rotation @ in_ground
    x.answer("about_center_of_mass", [*linear, *(root.rotation @ (about_joint - cross(center, in_ground)))])
    x.answer("about_origin", [*linear, *(root.rotation @ about_joint + cross(root.position, linear))])


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
    "kinetic_energy": (Pass("ground", _ground), Pass("outwards", _kinetic), _energy("kinetic_energy")),
    "potential_energy": (Pass("ground", _no_energy), Pass("outwards", _potential), _energy("potential_energy")),
    "energy_regressor": _of_bodies(_per_parameter),
    "center_of_mass": (*WHOLE, Pass("ground", _center)),
    "center_of_mass_velocity": (*WHOLE, Pass("ground", _center_velocity)),
    "center_of_mass_jacobian": (*BODIES, Pass("outwards", _center_column)),
    "momentum": (*WHOLE, Pass("ground", _momentum)),
    "centroidal_map": (*BODIES, Pass("outwards", _momentum_column)),
    "maximal_state": _of_bodies(_state),
}
"""Passes by recursion."""
