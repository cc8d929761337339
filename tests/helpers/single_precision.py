"""graphdyn's recursions in single precision, as foreign functions: every operation rounded to 24 bits."""

import numpy as np

import graphdyn
from crosscheck.judging.functions.table import FUNCTIONS
from graphdyn._frame_choice import frame_choice
from graphdyn.kernels.interpreter import Interpreter
from graphdyn.kernels.programs import Request, record
from graphdyn.kernels.recursions import ARRAYS

RECURSION = {
    "inverse_dynamics": ("inverse_dynamics", "tau"),
    "forward_dynamics": ("forward_dynamics", "a"),
    "joint_wrenches": ("inverse_dynamics", "joint_wrenches"),
    "multipliers": ("inverse_dynamics", "multipliers"),
    "regressor": ("joint_torque_regressor", "joint_torque_regressor"),
    "base_regressor": ("joint_torque_regressor", "joint_torque_regressor"),
    "dtau_dq": ("inverse_dynamics_derivatives", "dtau_dq"),
    "dtau_dv": ("inverse_dynamics_derivatives", "dtau_dv"),
    "da_dq": ("forward_dynamics_derivatives", "da_dq"),
    "da_dv": ("forward_dynamics_derivatives", "da_dv"),
    **{f"dwrenches_d{x}": ("reaction_derivatives", f"dwrenches_d{x}") for x in "qva"},
}
"""Recursion and output of the functions whose own name is not that of both."""


def single_precision(model: graphdyn.RobotModel, name: str, frame: str | None = None):
    """A function of the table, of states (N, n): the recursion in float32."""
    recursion, output = RECURSION.get(name, (name, name))
    known = FUNCTIONS[name]
    choice = frame_choice(model, frame, "local") if known.needs_frame else None
    program = record(model, Request(recursion, (output,), frame=choice))
    run = Interpreter(program)
    shape = ARRAYS[output].shape_for(model.n_bodies)

    def function(*arguments):
        given = zip(known.arguments, arguments, strict=True)
        inputs = {key: x.astype(np.float32) for key, x in given}
        count = len(arguments[0])
        answer = np.empty((count, int(np.prod(shape))), dtype=np.float32)
        run.bind(inputs, {output: answer})(0, count)
        return answer.reshape(count, *shape)

    return function
