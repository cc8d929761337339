"""The functions of a robot for CasADi: optimal control, estimation, and code of its own.

    rnea = graphdyn.export.casadi.function(model, "joint_torques")  # python -m pip install 'graphdyn[casadi]'
    tau = rnea(q, v, a)

The operations are those of the recorded recursion, on CasADi's SX scalars. CasADi differentiates them itself.
"""

from __future__ import annotations

from collections.abc import Callable
from math import prod
from typing import Any

from graphdyn.errors import InvalidInput, not_installed
from graphdyn.export.functions import AS_THEY_ARE, ExportChoices
from graphdyn.export.recorded import ARITHMETIC, recorded_function
from graphdyn.model.robot_model import RobotModel

__all__ = ["function"]


def function(model: RobotModel, name: str, choices: ExportChoices = AS_THEY_ARE) -> Any:
    """A verb of this robot as a casadi.Function of its name.

    Inputs and outputs have the names, order and units of the verb. CasADi knows columns and matrices: an array (k,) is
    a column, and of an array of three dimensions (i, j, k) the rows stand one after the other, (i j, k). Outputs
    without entries are left out.
    model: of a robot with loops, states have to be closed; what its loops leave undetermined is NaN
    name: of a verb, such as "joint_torques"
    choices: whether wrenches act on the bodies and the base moves, and of which frame it speaks

    Raises InvalidInput for a name that is none, for a verb that has no compiled form for this robot, and where CasADi
    is not installed; UnknownFrame; SingularMassMatrix where torques do not determine the accelerations. In single
    states, as in a singular pose of loops, accelerations come out as infinity or NaN.
    """
    try:
        import casadi
    except ImportError:
        raise InvalidInput(not_installed("casadi", "casadi")) from None
    recorded = recorded_function(model, name, choices)
    shapes = {array: _matrix(recorded.shape(array)) for array in (*recorded.inputs, *recorded.outputs)}
    inputs = {array: casadi.SX.sym(array, *shapes[array]) for array in recorded.inputs}
    columns = {array: casadi.vec(matrix.T) for array, matrix in inputs.items()}  # row after row
    operations: dict[str, Callable[..., Any]] = {**ARITHMETIC, "sine": casadi.sin, "cosine": casadi.cos}
    values: list[Any] = []
    for kind, *operands in recorded.program.operations:
        if kind == "input":
            array, column = operands
            values.append(columns[array][column])
        elif kind == "constant":
            values.append(casadi.SX(operands[0]))
        else:
            values.append(operations[kind](*(values[k] for k in operands)))
    outputs = {}
    for array, numbers in recorded.program.outputs.items():
        rows, width = shapes[array]
        outputs[array] = casadi.reshape(casadi.vertcat(*(values[k] for k in numbers)), width, rows).T
    return casadi.Function(name, list(inputs.values()), list(outputs.values()), list(inputs), list(outputs))


def _matrix(shape: tuple[int, ...]) -> tuple[int, int]:
    """Rows and columns of an array of this shape."""
    return (prod(shape), 1) if len(shape) < 2 else (prod(shape[:-1]), shape[-1])
