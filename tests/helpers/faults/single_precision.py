"""graphdyn's recursions in single precision, as functions under test: every operation rounded to 24 bits."""

import numpy as np

import graphdyn
from crosscheck.quantities import FUNCTIONS, LOADS
from graphdyn.arguments.choices import frame_choice
from graphdyn.compiler.interpreter import Interpreter
from graphdyn.compiler.programs import Request, trace
from graphdyn.recursions import ARRAY_SPECS, RECURSIONS

RECURSION = {
    "inverse_dynamics": ("inverse_dynamics", "tau"),
    "forward_dynamics": ("forward_dynamics", "a"),
    "joint_wrenches": ("inverse_dynamics", "joint_wrenches"),
    "multipliers": ("inverse_dynamics", "multipliers"),
    "joint_torque_regressor": ("joint_torque_regressor", "joint_torque_regressor"),
    "base_regressor": ("joint_torque_regressor", "joint_torque_regressor"),
    "momentum": ("momentum", "about_center_of_mass"),
    "kinetic_energy_regressor": ("energy_regressor", "kinetic"),
    "potential_energy_regressor": ("energy_regressor", "potential"),
    "dtau_dq": ("inverse_dynamics_derivatives", "dtau_dq"),
    "dtau_dv": ("inverse_dynamics_derivatives", "dtau_dv"),
    "da_dq": ("forward_dynamics_derivatives", "da_dq"),
    "da_dv": ("forward_dynamics_derivatives", "da_dv"),
    **{f"d{of}_d{x}": ("reaction_derivatives", f"d{of}_d{x}") for of in ("multipliers", "wrenches") for x in "qva"},
}
"""Recursion and output of the functions whose own name is not that of both."""


def single_precision(model: graphdyn.RobotModel, name: str, frame: str | None = None):
    """A function of the table, of states (N, n): the recursion in float32."""
    recursion, output = RECURSION.get(name, (name, name))
    known = FUNCTIONS[name]
    choice = frame_choice(model, frame, "local") if known.of_frame else None
    loaded = LOADS in known.arguments
    run = Interpreter(trace(model, Request(recursion, (output,), loaded, frame=choice)))
    shape = ARRAY_SPECS[output].shape_for(model)

    def function(*arguments):
        count = len(arguments[0])
        given = dict(zip(known.arguments, arguments, strict=True))
        given = {key: given.get(key, np.zeros_like(arguments[0])) for key in {*RECURSIONS[recursion].inputs, *given}}
        inputs = {key: x.reshape(count, -1).astype(np.float32) for key, x in given.items()}
        answer = np.empty((count, int(np.prod(shape))), dtype=np.float32)
        run.bind(inputs, {output: answer})(0, count)
        return answer.reshape(count, *shape)

    return function
