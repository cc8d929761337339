"""What Pinocchio answers at the judged states, computed when a function first needs it."""

from __future__ import annotations

import dataclasses
from functools import cached_property

import numpy as np

from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.reference.frame_choices import FRAME_REFERENCES, compared_frames
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.reference_values import RefereeValues
from graphdyn.layout import Array


class PinocchioAnswers:
    """Pinocchio's values at N states; with the external wrenches, where there are."""

    def __init__(self, states: JudgedStates):
        self.states = states
        model, self._frame = states.model, ""
        if states.frame is not None:  # as a frame of its own, also where it is a body
            chosen = model.frame(states.frame)
            self._frame = f"{chosen.name}, judged"
            model = dataclasses.replace(model, frames=(dataclasses.replace(chosen, name=self._frame, aliases=()),))
        self.referee = PinocchioModel.from_model(model)
        self._compared = compared_frames(model)

    @cached_property
    def values(self) -> RefereeValues:
        states = self.states
        return self.referee.evaluate(states.q, states.v, states.a, states.tau, states.all_loads)

    @cached_property
    def _derived(self) -> dict[str, Array]:
        states = self.states
        return self.referee.derive(states.q, states.v, states.a, states.tau, states.all_loads)

    def derived(self, name: str) -> Array:
        """A quantity that Pinocchio derives from the dynamics."""
        return self._derived[name]

    def of_frame(self, name: str, reference: str) -> Array | None:
        """A quantity of the judged frame by one reference; None for one that is fixed in the ground."""
        if self._frame not in self._compared:
            return None
        by_reference = np.moveaxis(self._derived[name], (1, 2), (0, 1))
        found: Array = by_reference[[*map(str, FRAME_REFERENCES)].index(reference)][self._compared.index(self._frame)]
        return found

    def frame_placement(self) -> tuple[Array, Array]:
        """Rotation (N, 3, 3) and position (N, 3) of the judged frame."""
        rotation, position = self.referee.frame_placements(self.states.q, [self._frame])
        return rotation[:, 0], position[:, 0]

    def loaded(self, name: str) -> Array:
        """The field of `values` of this name, or the one with external wrenches where there are."""
        found: Array = getattr(self.values, name if self.states.loads is None else f"{name}_external")
        return found

    def torques(self, function: str, *rates: Array) -> Array:
        """τ (N, n) of one of Pinocchio's functions of q and the rates."""
        return self.referee.joint_torques(function, self.states.q, *rates)

    def required(self, a: Array) -> Array:
        """rnea's τ (N, n) for other accelerations a (N, n), with the external wrenches."""
        states = self.states
        return self.referee.inverse_dynamics(states.q, states.v, a, states.loads)[0]
