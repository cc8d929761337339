"""The verbs of one robot for one state after the other: for control loops."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from graphdyn.arguments.keywords import closest
from graphdyn.errors import InvalidInput
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.verbs.derivatives import DerivativeCalls
from graphdyn.verbs.dynamics import DynamicsCalls
from graphdyn.verbs.energies import EnergyCalls
from graphdyn.verbs.matrices import MatrixCalls
from graphdyn.verbs.momenta import MomentumCalls
from graphdyn.verbs.single_state import SingleState
from graphdyn.verbs.verb import VERBS

__all__ = ["CompiledModel", "compile"]


class CompiledModel(DynamicsCalls, MatrixCalls, EnergyCalls, MomentumCalls, DerivativeCalls):
    """The verbs of graphdyn that answer one array, for single states of one robot, each compiled when first used.

    NaN, infinity, singular mass matrices and open loops are not looked for. Angles are accurate up to 1e6 rad. Threads
    may share it: each has arguments and results of its own. On the NumPy back end the calls work, slowly. Its
    attributes, each a SingleState:
    """

    def __init__(self, model: RobotModel) -> None:
        check_model(model)
        self.model = model

    if not TYPE_CHECKING:  # the declared attributes are all that there are

        def __getattr__(self, name: str) -> SingleState[Any]:
            if name not in ARRAY_VERBS:
                raise AttributeError(_unknown(name))
            return self.__dict__.setdefault(name, SingleState(self.model, name))  # found there from now on

    def __reduce__(self) -> tuple[Callable[..., CompiledModel], tuple[RobotModel | str, ...]]:
        return compile, (self.model, *(name for name in self.__dict__ if name in ARRAY_VERBS))

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *ARRAY_VERBS})


ARRAY_VERBS = {name: VERBS[name] for calls in CompiledModel.__bases__ for name in calls.__annotations__}
"""The verbs that answer one array, and need no choice of a frame."""

if CompiledModel.__doc__:  # python -OO strips docstrings
    CompiledModel.__doc__ += "\n".join(["", *(f"    {verb}" for verb in ARRAY_VERBS.values())])


def compile(model: RobotModel, *verbs: str) -> CompiledModel:
    """The robot's verbs for single states; those named are compiled now, so that the first call is as fast as the rest.

    The array that a call returns is overwritten by the next call of the same verb in the same thread: copy what is to
    stay. Other threads do not touch it. Copies and pickles have memory of their own.

    Raises InvalidInput for a verb that CompiledModel does not have.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> compiled = graphdyn.compile(model)
    >>> compiled.joint_torques(q, v, np.zeros(6)).shape
    (6,)
    """
    compiled = CompiledModel(model)
    for verb in verbs:
        if verb not in ARRAY_VERBS:
            raise InvalidInput(_unknown(verb))
        getattr(compiled, verb)
    return compiled


def _unknown(name: str) -> str:
    near = closest(name, ARRAY_VERBS)
    return f"there is no single-state call '{name}'; use {repr(near) if near else 'some of ' + ', '.join(ARRAY_VERBS)}"
