"""What Pinocchio answers at the judged states, computed when a function first needs it."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from crosscheck.judging.judged_states import JudgedStates
from crosscheck.referee.pinocchio_model import PinocchioModel
from crosscheck.referee.reference_values import DerivedValues, RefereeValues
from graphdyn.layout import Array


class PinocchioAnswers:
    """Pinocchio's values at N states; with the external wrenches, where there are."""

    def __init__(self, states: JudgedStates):
        self.states = states
        self.referee = PinocchioModel.from_model(states.model)

    @cached_property
    def values(self) -> RefereeValues:
        states = self.states
        return self.referee.evaluate(states.q, states.v, states.a, states.tau, states.all_loads)

    @cached_property
    def _derived(self) -> DerivedValues:
        states = self.states
        return self.referee.derive(states.q, states.v, states.a, states.tau)

    def derived(self, name: str) -> Array:
        """A quantity that Pinocchio derives from the dynamics, without external wrenches."""
        found: Array = getattr(self._derived, name)
        return found

    def loaded(self, name: str) -> Array:
        """The field of `values` of this name, or the one with external wrenches where there are."""
        found: Array = getattr(self.values, name if self.states.loads is None else f"{name}_external")
        return found

    def torques(self, function: str, *rates: Array) -> Array:
        """τ (N, n) of one of Pinocchio's functions of q and the rates."""
        return self.referee.joint_torques(function, self.states.q, *rates)

    def frame_placement(self, name: str) -> tuple[Array, Array]:
        """Rotation (N, 3, 3) and position (N, 3) of a frame: oMi of its body, and from there as in the model."""
        frame = self.states.model.frame(name)
        if frame.body == 0:
            placed = self.states.model.base @ frame.placement
            count = len(self.states.q)
            return np.tile(placed.rotation, (count, 1, 1)), np.tile(placed.translation, (count, 1))
        rotation, origin = (x[:, frame.body - 1] for x in (self.values.rotation, self.values.position))
        return rotation @ frame.placement.rotation, origin + rotation @ frame.placement.translation

    def required(self, a: Array) -> Array:
        """rnea's τ (N, n) for other accelerations a (N, n), with the external wrenches."""
        states = self.states
        return self.referee.inverse_dynamics(states.q, states.v, a, states.loads)[0]

    def required_at_rest(self) -> Array:
        """rnea's τ (N, n) at rest, with the external wrenches."""
        zero = np.zeros_like(self.states.q)
        return self.referee.inverse_dynamics(self.states.q, zero, zero, self.states.all_loads)[0]
