"""The table of recursions: what each takes, what it answers, and how it is computed from scalars."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from graphdyn.layout import BODY_FREEDOMS, BODY_PARAMETERS, JOINT_CONSTRAINTS
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions import derivatives, frames, momentum
from graphdyn.recursions.forward import forward_dynamics
from graphdyn.recursions.inertia import is_short, joint_accelerations, mass_matrix, mass_matrix_inverse
from graphdyn.recursions.inverse import inverse_dynamics, power
from graphdyn.recursions.loops import couplings, loops
from graphdyn.recursions.momentum import energy_regressor, kinetic_energy, potential_energy
from graphdyn.recursions.motion import maximal_state
from graphdyn.recursions.regressors import body_regressors, joint_torque_regressor, momentum_regressor


@dataclass(frozen=True)
class ArraySpec:
    """An array of the dynamics.

    shape: for one sample; "n" is the number of joints that no others drive, "bodies" that of all, "10 bodies" that of
        their inertial parameters
    unit: the second one, after "or", is that of prismatic joints
    """

    shape: tuple[int | str, ...]
    unit: str

    def shape_for(self, model: RobotModel) -> tuple[int, ...]:
        return tuple([size if isinstance(size, int) else SIZES[size](model) for size in self.shape])


SIZES: dict[str, Callable[[RobotModel], int]] = {
    "n": lambda model: model.n_freedoms,
    "bodies": lambda model: model.n_bodies,
    "10 bodies": lambda model: BODY_PARAMETERS * model.n_bodies,
    "couplings": lambda model: len(model.couplings),
    "chord rows": lambda model: model.n_chord_rows,
}
"""Of a robot, by the words in which shapes speak of them."""

ARRAYS = {
    "q": ArraySpec(("n",), "rad or m"),
    "v": ArraySpec(("n",), "rad/s or m/s"),
    "a": ArraySpec(("n",), "rad/s² or m/s²"),
    "tau": ArraySpec(("n",), "N m or N"),
    "body_accelerations": ArraySpec(("bodies", BODY_FREEDOMS), "m/s², rad/s²"),
    "multipliers": ArraySpec(("bodies", JOINT_CONSTRAINTS), "N, N m"),
    "coupling_multipliers": ArraySpec(("couplings",), "N m or N"),
    "chord_multipliers": ArraySpec(("chord rows",), "N, N m"),
    "joint_wrenches": ArraySpec(("bodies", BODY_FREEDOMS), "N, N m"),
    "mass_matrix": ArraySpec(("n", "n"), "kg m², kg m, kg"),
    "mass_matrix_inverse": ArraySpec(("n", "n"), "1/(kg m²), 1/(kg m), 1/kg"),
    "coriolis_matrix": ArraySpec(("n", "n"), "N m s, N s, kg/s"),
    "kinetic_energy": ArraySpec((), "J"),
    "potential_energy": ArraySpec((), "J"),
    "power": ArraySpec(("n",), "W"),
    "center_of_mass": ArraySpec((3,), "m"),
    "center_of_mass_velocity": ArraySpec((3,), "m/s"),
    "center_of_mass_jacobian": ArraySpec((3, "n"), "m or 1"),
    "about_center_of_mass": ArraySpec((BODY_FREEDOMS,), "kg m/s, kg m²/s"),
    "about_origin": ArraySpec((BODY_FREEDOMS,), "kg m/s, kg m²/s"),
    "centroidal_map": ArraySpec((BODY_FREEDOMS, "n"), "kg m, kg m² or kg, kg m"),
    "dtau_dq": ArraySpec(("n", "n"), "N m, N, N/m"),
    "dtau_dv": ArraySpec(("n", "n"), "N m s, N s, N s/m"),
    "dtau_da": ArraySpec(("n", "n"), "kg m², kg m, kg"),
    "d2tau_dqdq": ArraySpec(("n", "n", "n"), "N m, N, N/m, N/m²"),
    "d2tau_dqdv": ArraySpec(("n", "n", "n"), "N m s, N s, N s/m, N s/m²"),
    "d2tau_dqda": ArraySpec(("n", "n", "n"), "kg m², kg m, kg, kg/m"),
    "d2tau_dvdv": ArraySpec(("n", "n", "n"), "kg m², kg m, kg"),
    "da_dq": ArraySpec(("n", "n"), "1/s², 1/(m s²), m/s²"),
    "da_dv": ArraySpec(("n", "n"), "1/s, 1/(m s), m/s"),
    "da_dtau": ArraySpec(("n", "n"), "1/(kg m²), 1/(kg m), 1/kg"),
    **{f"dmultipliers_d{x}": ArraySpec(("bodies", JOINT_CONSTRAINTS, "n"), f"N, N m per {x}") for x in "qva"},
    **{f"dwrenches_d{x}": ArraySpec(("bodies", BODY_FREEDOMS, "n"), f"N, N m per {x}") for x in "qva"},
    "frame_jacobian": ArraySpec((BODY_FREEDOMS, "n"), "m, 1 or 1, 0"),
    "frame_jacobian_derivative": ArraySpec((BODY_FREEDOMS, "n"), "m/s, 1/s"),
    "frame_velocity": ArraySpec((BODY_FREEDOMS,), "m/s, rad/s"),
    "frame_acceleration": ArraySpec((BODY_FREEDOMS,), "m/s², rad/s²"),
    "bias_torque": ArraySpec(("n",), "N m or N"),
    "gravity_torque": ArraySpec(("n",), "N m or N"),
    "static_torque": ArraySpec(("n",), "N m or N"),
    "joint_torque_regressor": ArraySpec(("n", "10 bodies"), "N m or N per parameter"),
    "body_regressor": ArraySpec(("bodies", BODY_FREEDOMS, BODY_PARAMETERS), "N, N m per parameter"),
    "momentum_regressor": ArraySpec(("n", "10 bodies"), "kg m²/s or kg m/s per parameter"),
    "kinetic": ArraySpec(("10 bodies",), "J per parameter"),
    "potential": ArraySpec(("10 bodies",), "J per parameter"),
    "forward_dynamics_parameter_derivatives": ArraySpec(("n", "10 bodies"), "rad/s² or m/s² per parameter"),
    "position": ArraySpec(("bodies", 3), "m"),
    "rotation": ArraySpec(("bodies", 3, 3), "1"),
    "velocity": ArraySpec(("bodies", BODY_FREEDOMS), "m/s, rad/s"),
}


@dataclass(frozen=True)
class Recursion:
    """inputs: names of its joint arrays, q first; outputs: of what it answers.

    compute(sample, *inputs) answers scalars: the one output, of any shape, or a dictionary of flat outputs; the sample
        (graphdyn.compiler.programs) has the links of the robot, its root, total mass, external wrenches, zeros for an
        input, and joints_only: whether nothing but answers for the joints is asked for
    on_moving_base: whether the motion of the base matters
    of_frame: whether it speaks of a frame, which the sample has
    coupled: compute for robots with couplings, where it is not the projection of what compute answers for all joints
    closed: compute for robots with chords and without couplings, where the chords matter
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    compute: Callable[..., Any]
    on_moving_base: bool = True
    of_frame: bool = False
    coupled: Callable[..., Any] | None = None
    closed: Callable[..., Any] | None = None


_REACTIONS = ("body_accelerations", "multipliers", "joint_wrenches", "coupling_multipliers", "chord_multipliers")


def _torques(name: str, inputs: tuple[str, ...], compute: Callable[..., Any]) -> Recursion:
    """Torques, or torques per parameter, of all joints; with chords those of the motors."""

    def closed(x: Any, q: Any, v: Any = None, *rest: Any) -> Any:
        arrays = (q, v, *rest)[: len(inputs)]
        held = x.zeros if v is None else v
        return loops.at_motors(x.model, x.links, q, held, name, compute(x, *arrays), *rest[:1])

    return Recursion(inputs, (name,), compute, closed=closed)


def _needed(x: Any, q: Any, v: Any, external: Any = None) -> Any:
    """The torques at a = 0."""
    return inverse_dynamics(x.links, x.root, q, v, x.zeros, external)["tau"]


RECURSIONS = {
    "forward_dynamics": Recursion(
        ("q", "v", "tau"),
        ("a", *_REACTIONS),
        lambda x, q, v, tau: (joint_accelerations if x.joints_only and is_short(x.links) else forward_dynamics)(
            x.links, x.root, q, v, tau, x.external
        ),
        coupled=lambda x, q, v, tau: couplings.forward_dynamics(x.links, x.root, x.freedoms, q, v, tau, x.external),
        closed=lambda x, q, v, tau: loops.forward_dynamics(x.model, x.links, x.root, q, v, tau, x.external),
    ),
    "inverse_dynamics": Recursion(
        ("q", "v", "a"),
        ("tau", *_REACTIONS),
        lambda x, q, v, a: inverse_dynamics(x.links, x.root, q, v, a, x.external),
        closed=lambda x, q, v, a: loops.inverse_dynamics_at_motors(x.model, x.links, x.root, q, v, a, x.external),
    ),
    "mass_matrix": Recursion(("q",), ("mass_matrix",), lambda x, q: mass_matrix(x.links, q), on_moving_base=False),
    "mass_matrix_inverse": Recursion(
        ("q",),
        ("mass_matrix_inverse",),
        lambda x, q: mass_matrix_inverse(x.links, q),
        on_moving_base=False,
        coupled=lambda x, q: couplings.mass_matrix_inverse(x.links, x.freedoms, q),
    ),
    "coriolis_matrix": Recursion(
        ("q", "v"),
        ("coriolis_matrix",),
        lambda x, q, v: derivatives.coriolis_matrix(x.links, q, v),
        on_moving_base=False,
    ),
    "kinetic_energy": Recursion(
        ("q", "v"), ("kinetic_energy",), lambda x, q, v: {"kinetic_energy": kinetic_energy(x.links, x.root, q, v)}
    ),
    "potential_energy": Recursion(
        ("q",), ("potential_energy",), lambda x, q: {"potential_energy": potential_energy(x.links, x.root, q)}
    ),
    "power": Recursion(
        ("q", "v", "a"),
        ("power",),
        lambda x, q, v, a: power(x.links, x.root, q, v, a, x.external),
        coupled=lambda x, q, v, a: couplings.power(x.links, x.root, x.freedoms, q, v, a, x.external),
    ),
    "center_of_mass": Recursion(
        ("q",), ("center_of_mass",), lambda x, q: momentum.center_of_mass(x.links, x.root, x.mass, q)
    ),
    "center_of_mass_velocity": Recursion(
        ("q", "v"),
        ("center_of_mass_velocity",),
        lambda x, q, v: momentum.center_of_mass_velocity(x.links, x.root, x.mass, q, v),
    ),
    "center_of_mass_jacobian": Recursion(
        ("q",), ("center_of_mass_jacobian",), lambda x, q: momentum.center_of_mass_jacobian(x.links, x.root, x.mass, q)
    ),
    "momentum": Recursion(
        ("q", "v"),
        ("about_center_of_mass", "about_origin"),
        lambda x, q, v: momentum.momentum(x.links, x.root, x.mass, q, v),
    ),
    "centroidal_map": Recursion(
        ("q",), ("centroidal_map",), lambda x, q: momentum.centroidal_map(x.links, x.root, x.mass, q)
    ),
    "inverse_dynamics_derivatives": Recursion(
        ("q", "v", "a"),
        ("dtau_dq", "dtau_dv", "dtau_da"),
        lambda x, q, v, a: derivatives.inverse_dynamics_derivatives(x.links, x.root, q, v, a, x.external),
    ),
    "inverse_dynamics_second_derivatives": Recursion(
        ("q", "v", "a"),
        ("d2tau_dqdq", "d2tau_dqdv", "d2tau_dqda", "d2tau_dvdv"),
        lambda x, q, v, a: derivatives.inverse_dynamics_second_derivatives(x.links, x.root, q, v, a, x.external),
    ),
    "forward_dynamics_derivatives": Recursion(
        ("q", "v", "tau"),
        ("da_dq", "da_dv", "da_dtau"),
        lambda x, q, v, tau: derivatives.forward_dynamics_derivatives(x.links, x.root, q, v, tau, x.external),
        coupled=lambda x, q, v, tau: derivatives.forward_dynamics_derivatives(
            x.links, x.root, q, v, tau, x.external, x.freedoms
        ),
    ),
    "forward_dynamics_parameter_derivatives": Recursion(
        ("q", "v", "tau"),
        ("forward_dynamics_parameter_derivatives",),
        lambda x, q, v, tau: derivatives.forward_dynamics_parameter_derivatives(x.links, x.root, q, v, tau, x.external),
        coupled=lambda x, q, v, tau: derivatives.forward_dynamics_parameter_derivatives(
            x.links, x.root, q, v, tau, x.external, x.freedoms
        ),
    ),
    "reaction_derivatives": Recursion(
        ("q", "v", "a"),
        tuple(f"d{answer}_d{name}" for answer in ("multipliers", "wrenches") for name in "qva"),
        lambda x, q, v, a: derivatives.reaction_derivatives(x.links, x.root, q, v, a, x.external),
    ),
    "frame_jacobian": Recursion(
        ("q",),
        ("frame_jacobian",),
        lambda x, q: frames.frame_jacobian(x.links, x.root, q, x.frame),
        of_frame=True,
    ),
    "frame_jacobian_derivative": Recursion(
        ("q", "v"),
        ("frame_jacobian_derivative",),
        lambda x, q, v: frames.frame_jacobian_derivative(x.links, x.root, q, v, x.frame),
        of_frame=True,
    ),
    "frame_velocity": Recursion(
        ("q", "v"),
        ("frame_velocity",),
        lambda x, q, v: frames.frame_velocity(x.links, x.root, q, v, x.frame),
        of_frame=True,
    ),
    "frame_acceleration": Recursion(
        ("q", "v", "a"),
        ("frame_acceleration",),
        lambda x, q, v, a: frames.frame_acceleration(x.links, x.root, q, v, a, x.frame),
        of_frame=True,
    ),
    "bias_torque": _torques("bias_torque", ("q", "v"), lambda x, q, v: _needed(x, q, v)),
    "gravity_torque": _torques("gravity_torque", ("q",), lambda x, q: _needed(x, q, x.zeros)),
    "static_torque": _torques("static_torque", ("q",), lambda x, q: _needed(x, q, x.zeros, x.external)),
    "joint_torque_regressor": _torques(
        "joint_torque_regressor",
        ("q", "v", "a"),
        lambda x, *arrays: joint_torque_regressor(x.links, x.root, *arrays),
    ),
    "body_regressor": Recursion(
        ("q", "v", "a"), ("body_regressor",), lambda x, *arrays: body_regressors(x.links, x.root, *arrays)
    ),
    "momentum_regressor": Recursion(
        ("q", "v"),
        ("momentum_regressor",),
        lambda x, q, v: momentum_regressor(x.links, q, v),
        on_moving_base=False,
    ),
    "energy_regressor": Recursion(
        ("q", "v"), ("kinetic", "potential"), lambda x, q, v: energy_regressor(x.links, x.root, q, v)
    ),
    "maximal_state": Recursion(
        ("q", "v"), ("position", "rotation", "velocity"), lambda x, q, v: maximal_state(x.links, x.root, q, v)
    ),
}
