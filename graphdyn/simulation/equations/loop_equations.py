"""The equations of motion of robots with loops, in all joints of the tree, and how their states are kept closed.

M a + h = τ + Jᵀ λ and J a = γ. The rank of J is that of a regular pose, at every state: a rank decided anew would set
motions free near singular poses, which the linkage passes in an instant.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.errors import IntegrationFailed, InvalidInput
from graphdyn.layout import Array
from graphdyn.model.loops import loop_spaces
from graphdyn.simulation.equations.equations import Contact, Equations, Rates
from graphdyn.simulation.plant import PlantConstants

MAX_PROJECTION_STEPS = 6
"""Of a projection; two close what a step of integration leaves open."""

LAST_STEP_GAP = 1e-8
"""Gap [m, rad] whose square is rounding: the Newton step from there is the last."""

MIN_START_SINGULAR_VALUE = 1e-6
"""A simulation does not start where the smallest singular value of J is below this part of the largest."""

SINGULAR_DIRECTION_SHARE = 1e-7
"""Singular values of J below this part of the largest are rounding: nothing is done along them."""


class LoopEquations(Equations):
    """Accelerations and closed states of a plant with loops.

    distance: smallest by largest singular value of J at the state seen last, those of redundant rows left out; zero in
        a singular pose
    usual_distance: the same in a regular pose
    """

    def __init__(self, plant: PlantConstants) -> None:
        super().__init__(replace(plant, model=plant.model.opened))
        self._loops = loops = plant.model.loops
        spaces = loop_spaces(loops.jacobian(loops.links(plant.model.regular_pose)))
        self._rank = int(spaces.rank)
        self.usual_distance = float(spaces.distance)
        self.distance = self.usual_distance

    def rates(self, t: float, q: Array, v: Array, tau: Array, contact: Contact) -> Rates:
        """At the torque of the actuators."""
        passive = self._passive(q, v, contact.sign)
        links = self._loops.links(q, v)
        inverse, motions = self._spaces(self._loops.jacobian(links))
        start = inverse @ self._loops.bias(links)
        mass = self._verbs.mass_matrix(q) + self._rotor
        driving = tau + passive - self._bias(t, q, v) - mass @ start
        a = start + motions @ np.linalg.solve(motions.T @ mass @ motions, motions.T @ driving)
        return Rates(a, passive, np.zeros(len(q)))

    def started(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The state closed to rounding. Raises InvalidInput in a singular pose, where the motion is not determined."""
        q, v = self.closed(q, v)
        if self.distance < MIN_START_SINGULAR_VALUE:
            raise InvalidInput(
                f"robot '{self.plant.model.name}' starts in a singular pose of its loops, where more motions are free "
                "than elsewhere and torques do not determine which it takes; start beside it"
            )
        return q, v

    def closed(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The nearest position and velocity, in the norm of all joints, that keep the loops closed.

        Raises IntegrationFailed where Newton steps do not close them.
        """
        for _ in range(MAX_PROJECTION_STEPS):
            gaps = self._loops.gaps(q)
            inverse, _ = self._spaces(self._loops.jacobian(self._loops.links(q)))
            q = q - inverse @ gaps
            if np.abs(gaps).max() < LAST_STEP_GAP:
                break
        else:
            raise IntegrationFailed(
                f"the loops are open by {np.abs(gaps).max():.2g} m or rad after a step, and do not close; "
                "take smaller steps, or smaller torques"
            )
        jacobian = self._loops.jacobian(self._loops.links(q))
        inverse, _ = self._spaces(jacobian)
        return q, v - inverse @ (jacobian @ v)

    def _spaces(self, jacobian: Array) -> tuple[Array, Array]:
        """J⁺ (n, m) of the usual rank, and the motions that keep the loops closed (n, n - rank)."""
        left, values, right = np.linalg.svd(jacobian)
        rank = self._rank
        self.distance = float(values[rank - 1] / values[0]) if rank else 1.0
        kept = values[:rank] > SINGULAR_DIRECTION_SHARE * values[:1]
        inverse = np.where(kept, 1.0 / np.where(kept, values[:rank], 1.0), 0.0)
        return (right[:rank].T * inverse) @ left[:, :rank].T, right[rank:].T


def equations_of(plant: PlantConstants) -> Equations:
    """Of a tree, or of a robot with loops."""
    return LoopEquations(plant) if plant.model.chords else Equations(plant)


def refuse_dry_friction(plant: PlantConstants) -> None:
    """Raises InvalidInput where dry friction acts in loops: which of their joints it holds is not decided."""
    if plant.model.chords and plant.sticks:
        raise InvalidInput(
            f"robot '{plant.model.name}' has loops, in which dry friction is not simulated: forces that hold joints at "
            "rest are not unique; give Friction(viscous=…) alone"
        )
