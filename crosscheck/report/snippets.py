"""Python that reproduces a worst state: what a reader copies from the page and runs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from os import PathLike, fspath

import numpy as np

import urdf
from crosscheck.comparing.comparison import Comparison, QuantityResult, WorstState
from crosscheck.judging.functions.known_function import LOADS
from crosscheck.judging.judgment import UNCOUPLED, JudgedFunction, Judgment
from crosscheck.quantities.quantities import BY_NAME, COUPLED, LOOPED, QUANTITIES, RECURSIVE
from graphdyn import RobotModel
from graphdyn.layout import Array
from graphdyn.verbs import VERBS
from urdf import Reading

_REFERENCE = "reference = referee.evaluate(*(np.array([x]) for x in (q, v, a, tau, external_wrenches)))"
_MULTIPLIERS = "multipliers_of(model, reference.rotation, reference.{})[0]"

_URDF = re.compile(r"\b(?=(?:InertialsFromMeshes|Xacro)\()")
"""Before the names of classes that a user calls urdf.InertialsFromMeshes, urdf.Xacro."""

_SHOWN = "print(ours, theirs, np.abs(ours - theirs).max(), sep='\\n')"

_STATE = "graphdyn.maximal_state(model, q, v, a)"
_INVERSE = "graphdyn.inverse_dynamics(model, q, v, a)"
_INVERSE_LOADED = "graphdyn.inverse_dynamics(model, q, v, a, external_wrenches)"
_DENSE = ', method="dense"'
_FORWARD = f"graphdyn.forward_dynamics(model, q, v, tau{_DENSE})"
_FORWARD_LOADED = f"graphdyn.forward_dynamics(model, q, v, tau, external_wrenches{_DENSE})"
_PROJECTED = _FORWARD.replace("dense", "projected")
_PROJECTED_LOADED = _FORWARD_LOADED.replace("dense", "projected")
_SYSTEM = "graphdyn.kkt_system(model, q, v, tau)"


def _required(forward: str, *loads: str) -> tuple[tuple[str, str], ...]:
    """The torques that Pinocchio's rnea needs for our accelerations, and the given ones."""
    states = ", ".join(f"np.array([{x}])" for x in ("q", "v", f"{forward}.a", *loads))
    return ((f"referee.inverse_dynamics({states})[0][0]", "tau"),)


_ROWS = "*(np.array([x]) for x in (q, v, a, tau, external_wrenches))"
_DERIVED = {
    "dtau_dq": "inverse_dynamics_derivatives(model, q, v, a).dtau_dq",
    "dtau_dv": "inverse_dynamics_derivatives(model, q, v, a).dtau_dv",
    "coriolis_matrix": "coriolis_matrix(model, q, v)",
    "kinetic_energy": "kinetic_energy(model, q, v)",
    "potential_energy": "potential_energy(model, q)",
    "da_dq": "forward_dynamics_derivatives(model, q, v, tau).da_dq",
    "da_dv": "forward_dynamics_derivatives(model, q, v, tau).da_dv",
    "da_dtau": "forward_dynamics_derivatives(model, q, v, tau).da_dtau",
    "mass_matrix_inverse": "mass_matrix_inverse(model, q)",
    "da_dpi": "forward_dynamics_parameter_derivatives(model, q, v, tau)",
    "static_torque": "static_torque(model, q, external_wrenches)",
    "power": "power(model, q, v, a, external_wrenches)",
    "kinetic_energy_regressor": "energy_regressor(model, q, v).kinetic",
    "potential_energy_regressor": "energy_regressor(model, q, v).potential",
    "momentum_regressor": "momentum_regressor(model, q, v)",
    "center_of_mass": "center_of_mass(model, q)",
    "center_of_mass_velocity": "center_of_mass_velocity(model, q, v)",
    "center_of_mass_jacobian": "center_of_mass_jacobian(model, q)",
    "centroidal_momentum": "momentum(model, q, v).about_center_of_mass",
    "momentum_about_origin": "momentum(model, q, v).about_origin",
    "centroidal_map": "centroidal_map(model, q)",
    **{
        f"d{answer}_d{name}": f"reaction_derivatives(model, q, v, a).d{answer}_d{name}"
        for answer in ("wrenches", "multipliers")
        for name in "qva"
    },
}
_OF_FRAMES = {
    "frame_jacobian": "of_frames(model, graphdyn.frame_jacobian, q)",
    "frame_velocity": "of_frames(model, graphdyn.frame_velocity, q, v)",
    "frame_acceleration": "of_frames(model, graphdyn.frame_acceleration, q, v, a)",
    "frame_acceleration_spatial": "of_frames(model, graphdyn.frame_acceleration, q, v, a, classical=False)",
    "frame_jacobian_derivative": "of_frames(model, graphdyn.frame_jacobian_derivative, q, v)",
}
_SECOND = "inverse_dynamics_second_derivatives(model, q, v, a)"
_ROWS_OF_A = "*(np.array([x]) for x in (q, v, a))"
_TWICE = ("d2tau_dqdq", "d2tau_dqdv", "d2tau_dqda", "d2tau_dvdv")

_FRAMES = "[frame.name for frame in model.frames]"


def _of_verb(verb: str, against: str) -> tuple[tuple[str, str], ...]:
    """Both sides of a quantity that names its verb."""
    names = VERBS[verb].inputs
    rows = ", ".join(f"np.array([{name}])" for name in names)
    return ((f"graphdyn.{verb}(model, {', '.join(names)})", f"referee.joint_torques({against!r}, {rows})[0]"),)


_BASE_CALLS: Mapping[str, tuple[tuple[str, str], ...]] = {
    **{quantity.name: _of_verb(quantity.verb, quantity.against) for quantity in QUANTITIES if quantity.verb},
    "link_placement": (
        (f"{_STATE}.rotation", "reference.rotation[0]"),
        (f"link_origins({_STATE})", "reference.position[0]"),
    ),
    "frame_placement": tuple(
        (
            f"np.array([graphdyn.frame_placement(model, q, name)[{part}] for name in {_FRAMES}])",
            f"referee.frame_placements(np.array([q]), {_FRAMES})[{part}][0]",
        )
        for part in (0, 1)
    ),
    "link_twist": ((f"{_STATE}.velocity", "reference.velocity[0]"),),
    "body_acceleration": ((f"{_STATE}.acceleration", "reference.acceleration[0]"),),
    "torque": ((f"{_INVERSE}.tau", "reference.tau[0]"),),
    "joint_wrench": ((f"{_INVERSE}.joint_wrenches", "reference.joint_wrenches[0]"),),
    "multipliers": ((f"{_INVERSE}.multipliers", _MULTIPLIERS.format("joint_wrenches")),),
    "torque_external": ((f"{_INVERSE_LOADED}.tau", "reference.tau_external[0]"),),
    "joint_wrench_external": ((f"{_INVERSE_LOADED}.joint_wrenches", "reference.joint_wrenches_external[0]"),),
    "mass_matrix": (("graphdyn.mass_matrix(model, q)", "reference.mass_matrix[0]"),),
    "torque_regressor": (("graphdyn.joint_torque_regressor(model, q, v, a)", "reference.torque_regressor[0]"),),
    "body_regressor": (("graphdyn.body_regressor(model, q, v, a)", "reference.body_regressor[0]"),),
    "acceleration": ((f"{_FORWARD}.a", "reference.a[0]"),),
    "acceleration_projected": ((f"{_PROJECTED}.a", "reference.a[0]"),),
    "acceleration_external": ((f"{_FORWARD_LOADED}.a", "reference.a_external[0]"),),
    "backward_error": _required(_FORWARD),
    "backward_error_projected": _required(_PROJECTED),
    "backward_error_external": _required(_FORWARD_LOADED, "external_wrenches"),
    "backward_error_projected_external": _required(_PROJECTED_LOADED, "external_wrenches"),
    "forward_body_acceleration": ((f"{_FORWARD}.body_accelerations", "reference.a_body_accelerations[0]"),),
    "forward_joint_wrench": ((f"{_FORWARD}.joint_wrenches", "reference.a_wrenches[0]"),),
    "forward_joint_wrench_external": ((f"{_FORWARD_LOADED}.joint_wrenches", "reference.a_wrenches_external[0]"),),
    "forward_multipliers": ((f"{_FORWARD}.multipliers", _MULTIPLIERS.format("a_wrenches")),),
    **{name: ((f"graphdyn.{call}", f"referee.derive({_ROWS})[{name!r}][0]"),) for name, call in _DERIVED.items()},
    **{name: ((call, f"referee.derive({_ROWS})[{name!r}][0]"),) for name, call in _OF_FRAMES.items()},
    **{name: ((f"graphdyn.{_SECOND}.{name}", f"referee.derive_twice({_ROWS_OF_A})[{name!r}][0]"),) for name in _TWICE},
    "dynamics_residual": ((f"{_SYSTEM}.solve().dynamics_residual()", "0.0"),),
    "constraint_residual": ((f"{_SYSTEM}.solve().constraint_residual()", "0.0"),),
    "constraint_rank": ((f"{_SYSTEM}.constraint_rank()", "5 * model.n_bodies"),),
    "kkt_rank": ((f"{_SYSTEM}.rank()", "11 * model.n_bodies"),),
}


def _of_recursive(calls: tuple[tuple[str, str], ...]) -> tuple[tuple[str, str], ...]:
    """The same calls of graphdyn, by the recursive method."""
    recursive = ', method="recursive"'
    return tuple(
        (ours.replace(_DENSE, recursive) if _DENSE in ours else ours.replace(")", f"{recursive})", 1), theirs)
        for ours, theirs in calls
    )


CALLS = {
    **_BASE_CALLS,
    **{name: _of_recursive(_BASE_CALLS[name.removesuffix(RECURSIVE)]) for name in BY_NAME if name.endswith(RECURSIVE)},
}
"""Per quantity, pairs of expressions: what graphdyn computes, and what it must be equal to."""


def worst_state(comparison: Comparison, result: QuantityResult) -> str | None:
    """Both sides of a quantity at its worst state; None for a quantity that belongs to all states together.

    Where a RobotModel was compared, the reader must put it into `model` first.
    """
    worst, calls = result.worst, CALLS.get(result.quantity.name)
    if worst is None or calls is None:
        return None
    text = "\n".join(expression for pair in calls for expression in pair)
    text += f"\n{_REFERENCE}" if "reference" in text else ""
    referee, coupled = "refer" in text, not COUPLED.keys().isdisjoint(comparison.quantities)
    looped = not LOOPED.keys().isdisjoint(comparison.quantities)
    lines = ["import numpy as np", "", "import graphdyn"]
    lines += ["import urdf"] if comparison.file else []
    lines += ["from crosscheck.reference.pinocchio_model import PinocchioModel"] if referee else []
    lines += ["from crosscheck.reference.reference_values import multipliers_of"] if "multipliers_of" in text else []
    lines += ["from crosscheck.reference.frame_choices import of_frames"] if "of_frames" in text else []
    lines += ["from graphdyn.equations.kinematics import link_origins"] if "link_origins" in text else []
    lines += ["from urdf.document.catalog import locate"] if referee and worst.route == "urdf" else []
    lines += [
        "",
        *_robot(
            _origin(comparison),
            comparison.reading,
            comparison.model,
            only=".uncoupled" * coupled + ".opened" * looped,
        ),
    ]
    lines += [f"referee = PinocchioModel.{_referee(comparison, worst.route)}"] if referee else []
    lines += _surroundings(worst, comparison.model, referee)
    lines += _numbers(worst, result.quantity.forward, text)
    lines += [_REFERENCE] if "reference" in text else []
    for ours, theirs in calls:
        lines += ["", f"ours = {ours}", f"theirs = {theirs}", _SHOWN]
    return "\n".join(lines) + "\n"


def worst_call(judgment: Judgment, function: JudgedFunction) -> str:
    """graphdyn's answer at the worst call, beside the recorded answer of the foreign function.

    Where a RobotModel was judged, the reader must put it into `model` first.
    """
    origin, model = _origin(judgment), judgment.model
    lines = ["import numpy as np", "", "import graphdyn", *(["import urdf"] if origin else []), ""]
    lines += _robot(origin, judgment.reading, model, only=".uncoupled" * (UNCOUPLED in judgment.notes))
    reordered = judgment.joint_names != model.joint_names
    if reordered:
        lines += [
            f"names = {list(judgment.joint_names)!r}  # the order of the foreign function",
            "order = [names.index(name) for name in model.joint_names]",
        ]
    for name, values in function.worst.arguments.items():
        shaped = f".reshape({model.n_bodies}, 6)" if name == LOADS else ""
        lines.append(f"{name} = {_array(values)}{shaped}{'[order]' if reordered else ''}")
    code = function.code or f"{_array(function.worst.expected)}  # of graphdyn, by the conventions of the function"
    if LOADS in code and LOADS not in function.worst.arguments:
        lines.append(f"{LOADS} = None")
    lines += [
        f"answer = {_array(function.worst.answer)}  # of the foreign function, in the order of the model",
        "",
        f"expected = np.ravel({code})" if function.code else f"expected = {code}",
        "print(expected, answer, np.abs(expected - answer).max(), sep='\\n')",
    ]
    return "\n".join(lines) + "\n"


def _origin(record: Comparison | Judgment) -> str | None:
    """What urdf.load takes: the name in the catalog, or the whole path. None where a RobotModel was given."""
    if record.file is None:
        return None
    named = (entry.path for entry in urdf.robots() if entry.name == record.robot)
    return record.robot if record.file in (str(path.resolve()) for path in named) else record.file


def _robot(
    origin: str | None,
    reading: Reading,
    model: RobotModel,
    *,
    only: str = "",
) -> list[str]:
    if origin is None:
        return ["# model is the RobotModel that was given"]
    options = ", ".join([repr(origin), *_reading(reading), f"gravity={model.gravity.tolist()}"])
    return [f"model = urdf.load({options}){only}"]


def _reading(reading: Reading) -> list[str]:
    """What one types for each option that is stated; gravity apart, which the model has."""
    values = {name: getattr(reading, name) for name in reading.stated if name != "gravity"}
    values |= {"lock": reading.locked} if reading.lock else {}
    values |= {"loops": fspath(reading.loops)} if isinstance(reading.loops, PathLike) else {}
    return [f"{name}={_URDF.sub('urdf.', repr(value))}" for name, value in values.items()]


def _referee(comparison: Comparison, route: str) -> str:
    if route == "model":
        return "from_model(model)"
    options = ", ".join(_reading(comparison.reading))
    reading = f", urdf.Reading({options})" if options else ""
    return f"from_urdf(locate({_origin(comparison)!r})[0], model{reading})"


def _surroundings(worst: WorstState, model: RobotModel, referee: bool) -> list[str]:
    """Base and gravity of the case, where they are not the robot's own."""
    if np.array_equal(worst.turn, np.eye(3)) and np.array_equal(worst.gravity, model.gravity):
        return []
    return [
        f"turn = graphdyn.Placement({_rows(worst.turn)})",
        f"model = model.with_base(turn @ model.base).with_gravity({list(worst.gravity)})",
        *(["referee = referee.turned(turn, model.gravity)"] if referee else []),
    ]


def _numbers(worst: WorstState, forward: bool, text: str) -> list[str]:
    """q, v, a, and of torques and external wrenches what the text mentions; zeros where their values do not matter."""
    lines = [f"{name} = {_array(getattr(worst, name))}" for name in ("q", "v", "a")]
    if "tau" in text:
        given = _array(worst.tau) if worst.tau is not None else f"{_INVERSE}.tau"
        lines.append(f"tau = {given if forward else 'np.zeros_like(q)'}")
    if "external_wrenches" in text:
        loaded = "external_wrenches" in text.replace(_REFERENCE, "").replace(_ROWS, "")
        given = f"np.array({_rows(worst.external_wrenches)})" if loaded else "np.zeros((model.n_bodies, 6))"
        lines.append(f"external_wrenches = {given}")
    return lines


def _array(values: Sequence[float] | Array) -> str:
    return f"np.array({np.asarray(values).tolist()})"


def _rows(matrix: Sequence[Sequence[float]]) -> str:
    """A list of lists, one row per line."""
    return "[\n" + "".join(f"    {list(row)},\n" for row in matrix) + "]"
