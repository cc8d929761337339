"""One state after the other, in memory that is reused: for control loops."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from graphdyn._errors import InvalidInput
from graphdyn._model import RobotModel
from graphdyn.kernels.programs import Request, output_shapes
from graphdyn.kernels.running import prepared
from graphdyn.layout import Array

VERBS = ("joint_torques", "joint_accelerations", "mass_matrix", "bias_torque", "joint_torque_regressor")


class SingleState:
    """A verb for one state at a time. Call it with new arguments (n,), or change `arguments` and call it without.

    arguments: its memory, by name                          (n,) each
    result: what each call returns, and the next overwrites: copy what is to stay

    Raises InvalidInput for wrong shapes, and another number of arguments.
    """

    def __init__(self, model: RobotModel, request: Request, names: tuple[str, ...]) -> None:
        n, (output,) = model.n_bodies, request.outputs
        shape = output_shapes(n)[output]
        backend = prepared(model, request).backend
        memory = {name: np.zeros((backend.lanes, n)) for name in names}
        answer = np.zeros((backend.lanes, int(np.prod(shape))))
        self.arguments: dict[str, Array] = {name: rows[0] for name, rows in memory.items()}
        self.result: Array = answer[0].reshape(shape)
        self._places = tuple(self.arguments.values())
        self._n = n
        self._run = backend.bind_row(memory, {output: answer})

    def __call__(self, *arguments: ArrayLike) -> Array:
        if arguments:
            try:
                for place, argument in zip(self._places, arguments, strict=True):
                    if len(argument) != self._n:  # type: ignore[arg-type]  # a third of the time that shape takes
                        raise ValueError
                    place[...] = argument  # half of the time that [:] takes
            except (TypeError, ValueError):
                self._refuse_shapes(arguments)
                raise
        self._run()
        return self.result

    def _refuse_shapes(self, arguments: tuple[ArrayLike, ...]) -> None:
        if len(arguments) != len(self._places):
            names = ", ".join(self.arguments)
            raise InvalidInput(f"{len(arguments)} arguments given; give {names}, or none where their memory is filled")
        for name, argument in zip(self.arguments, arguments, strict=True):
            if np.shape(argument) != (self._n,):
                raise InvalidInput(f"{name} has shape {np.shape(argument)}, expected {(self._n,)}")


class CompiledModel:
    """The verbs of graphdyn for single states of one robot, each compiled when first used.

    NaN, infinity and singular mass matrices are not looked for. Angles are accurate up to 1e6 rad. One object per
    thread. On the NumPy back end the calls work, slowly.
    """

    def __init__(self, model: RobotModel) -> None:
        self.model = model

    @cached_property
    def joint_torques(self) -> SingleState:
        """joint_torques(q, v, a) → τ (n,)"""
        return self._single("inverse_dynamics", "tau", ("q", "v", "a"))

    @cached_property
    def joint_accelerations(self) -> SingleState:
        """joint_accelerations(q, v, tau) → a (n,)"""
        return self._single("forward_dynamics", "a", ("q", "v", "tau"))

    @cached_property
    def mass_matrix(self) -> SingleState:
        """mass_matrix(q) → M (n, n)"""
        return self._single("mass_matrix", "mass_matrix", ("q",))

    @cached_property
    def bias_torque(self) -> SingleState:
        """bias_torque(q, v) → h (n,)"""
        return self._single("bias_torque", "bias_torque", ("q", "v"))

    @cached_property
    def joint_torque_regressor(self) -> SingleState:
        """joint_torque_regressor(q, v, a) → W (n, 10 n)"""
        return self._single("joint_torque_regressor", "joint_torque_regressor", ("q", "v", "a"))

    def _single(self, program: str, output: str, names: tuple[str, ...]) -> SingleState:
        return SingleState(self.model, Request(program, (output,)), names)


def compile(model: RobotModel, *verbs: str) -> CompiledModel:
    """The robot's verbs for single states; those named are compiled now, so that the first call is as fast as the rest.

    Raises InvalidInput for a verb that CompiledModel does not have.
    """
    compiled = CompiledModel(model)
    for verb in verbs:
        if verb not in VERBS:
            raise InvalidInput(f"there is no single-state call '{verb}'; use some of {', '.join(VERBS)}")
        getattr(compiled, verb)
    return compiled
