"""What the specification of a verb is given, and the maximal states that its equations start from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from graphdyn.arguments.base_motion import BaseMotion, Ground, ground, rooted_ground
from graphdyn.arguments.choices import FrameChoice
from graphdyn.equations.kinematics import MaximalState, state_on
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel


@dataclass(frozen=True, eq=False)
class Arguments:
    """A robot, and arrays of one common leading shape (graphdyn.arguments.arrays.joint_arrays).

    arrays: those of q, v, a, tau that the verb takes, and external_wrenches; x[name] is one of them
    base: prescribed motion of the base, None at rest; its leading dimensions broadcast
    dense: whether Eq. (111) is solved as it stands, where there is something to solve
    frame: which one, for verbs that speak of a frame
    """

    model: RobotModel
    arrays: Mapping[str, Array]
    base: BaseMotion | None = None
    dense: bool = False
    frame: FrameChoice | None = None

    def __getitem__(self, name: str) -> Array:
        return self.arrays[name]

    def but(self, **arrays: Array) -> Arguments:
        """The same with other arrays, or further ones."""
        return replace(self, arrays={**self.arrays, **arrays})

    def state(self) -> MaximalState:
        """The maximal state at q, v (or at rest) and a, if given."""
        return self._state(self.model, ground(self.model, self.base, self["q"].shape[:-1]))

    def rooted_state(self) -> MaximalState:
        """The same, shifted so that joint 1 is at the world's origin (RobotModel.rooted)."""
        return self._state(self.model.rooted, rooted_ground(self.model, self.base, self["q"].shape[:-1]))

    def skeleton_state(self) -> MaximalState:
        """The motion of the link frames, shifted in the same way (RobotModel.skeleton)."""
        return self._state(self.model.skeleton, rooted_ground(self.model, self.base, self["q"].shape[:-1]))

    def _state(self, model: RobotModel, vertex_0: Ground) -> MaximalState:
        q = self["q"]
        return state_on(vertex_0, model, q, self.arrays.get("v", np.zeros(q.shape)), self.arrays.get("a"))


Specification = Callable[[Arguments], dict[str, Array]]
"""A verb as the equations read: all arrays that its recursion answers, by name."""
