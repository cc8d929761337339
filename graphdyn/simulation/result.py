"""What a simulation answers."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.display import Displayed, short_repr
from graphdyn.equations.kinematics import MaximalState, maximal_state
from graphdyn.errors import InvalidInput
from graphdyn.experiments.experiment import base_motion, observed
from graphdyn.experiments.virtual_recording import VirtualRecording
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.simulation.integration.events import Occurrence
from graphdyn.simulation.plant import PlantConstants, refuse_loops
from graphdyn.tables import data_frame, joint_columns
from graphdyn.verbs.answers import InverseDynamics
from graphdyn.verbs.dynamics import forward_dynamics, inverse_dynamics
from graphdyn.verbs.energies import kinetic_energy, potential_energy

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False)
@short_repr
class EnergyBalance:
    """Energies at the times of a simulation (N,) each [J].

    kinetic: of bodies and rotors; potential: as graphdyn.potential_energy
    work: that the actuators have done; loss: what friction and stops have done, a negative number
    """

    kinetic: Array
    potential: Array
    work: Array
    loss: Array

    @property
    def error(self) -> Array:
        """What the energy has changed beyond work and loss (N,) [J]: zero but for the errors of the integration."""
        total: Array = self.kinetic + self.potential - self.work - self.loss
        return np.asarray(total - total[0])

    @property
    def drift(self) -> float:
        """Largest error as a part of the largest kinetic energy."""
        largest = float(self.kinetic.max())
        return float(np.abs(self.error).max()) / largest if largest else 0.0


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Displayed):
    """A motion from simulate, at N times; joints in the order of the model.

    time                                                    (N,)    [s]
    q, v, a: joint positions, velocities, accelerations     (N, n)  [rad or m, …/s, …/s²]
    tau: of the actuators, within their limits              (N, n)  [N m or N]
    passive: torque of friction and stops on the joints     (N, n)  [N m or N]
    occurrences: the events that happened, in their order
    ended: name of the event that ended it; "" where it lasted as long as asked for
    """

    model: RobotModel
    time: Array
    q: Array
    v: Array
    a: Array
    tau: Array
    passive: Array
    occurrences: tuple[Occurrence, ...]
    ended: str
    _plant: PlantConstants = field(repr=False)
    _work: Array = field(repr=False)
    _loss: Array = field(repr=False)
    _bodies: MaximalState | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        check_model(self.model)

    def summary(self) -> str:
        """How long it lasted, and how far the joints went."""
        lasted = f"{self.time[-1] - self.time[0]:g} s, {len(self.time)} rows"
        reach = [
            f"{name}: {low:.4g} to {high:.4g}"
            for name, low, high in zip(self.joint_names, self.q.min(axis=0), self.q.max(axis=0), strict=True)
        ]
        ended = f", ended by {self.ended}" if self.ended else ""
        return f"motion of {self.model.name}: {lasted}{ended}; q from … to …: {'; '.join(reach)}"

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every time, with q, v, a and tau of every joint, in columns such as "q shoulder".

        Raises ImportError where pandas is missing.
        """
        channels = {"q": self.q, "v": self.v, "a": self.a, "tau": self.tau}
        return data_frame(joint_columns(channels, self.joint_names), self.time, "time")

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Joint names of the columns of q, v, a and tau."""
        return self.model.independent_joints

    @cached_property
    def reactions(self) -> InverseDynamics:
        """Multipliers (N, n, 5) and joint wrenches (N, n, 6), as graphdyn.inverse_dynamics states them.

        Its tau is what the rigid bodies take: that of the actuators less friction, stops and rotors. With loops,
        reactions that nothing determines are NaN.
        """
        if self.model.chords:
            return self._with_loops()
        return inverse_dynamics(
            self.model, self.q, self.v, self.a, self._wrenches(), base=self._base(), method="reproducible"
        )

    @cached_property
    def energy(self) -> EnergyBalance:
        """The balance of energy. Raises InvalidInput where the base moves or external wrenches act: their work is not
        integrated.
        """
        if self._plant.base or self._plant.is_loaded:
            raise InvalidInput(
                "the work of a moving base and of external wrenches is not integrated: no energy balance"
            )
        of_bodies = kinetic_energy(self.model, self.q, self.v, method="reproducible")
        kinetic = of_bodies + (self._plant.rotor * self.v**2).sum(axis=-1) / 2
        potential = potential_energy(self.model, self.q, method="reproducible")
        return EnergyBalance(kinetic, potential, self._work, self._loss)

    @cached_property
    def bodies(self) -> MaximalState:
        """Placements of the bodies: as integrated in maximal coordinates, otherwise as q and v say."""
        return self._bodies or maximal_state(self.model, self.q, self.v, base=self._base(), method="reproducible")

    def closure_error(self) -> Array:
        """Largest |φ| at each time (N,): how far joints and loops are open [m, -; angles of loops in rad]."""
        largest: Array = np.abs(self.bodies.constraint_residual()).max(axis=(-2, -1))
        return np.maximum(largest, np.abs(self.model.loops.gaps(self.q)).max(axis=-1)) if self.model.chords else largest

    def recording(self) -> VirtualRecording:
        """All channels of graphdyn.simulate_recording; tau is that of the actuators.

        Raises InvalidInput for a robot with loops: the recording has no place for joint forces that are undetermined.
        """
        refuse_loops("a recording", self.model, "take time, q, v, a, tau and reactions of the simulation")
        motion = (self.q, self.v, self.a)
        return observed(self.model, self.time, motion, self.reactions, self._base() or BaseMotion(), self.tau)

    def _with_loops(self) -> InverseDynamics:
        taken = self.tau + self.passive - self._plant.rotor * self.a
        found = forward_dynamics(
            self.model, self.q, self.v, taken, self._wrenches(), base=self._base(), method="reproducible"
        )
        return InverseDynamics(tau=taken, **{name: value for name, value in vars(found).items() if name != "a"})

    def _base(self) -> BaseMotion | None:
        return base_motion(self._plant.base, self.time) if self._plant.base else None

    def _wrenches(self) -> Array | None:
        if not self._plant.is_loaded:
            return None
        if self._plant.wrenches is None:
            return self._plant.constants["external_wrenches"].reshape(-1, 6)
        found = [self._plant.wrenches(t, q, v) for t, q, v in zip(self.time.tolist(), self.q, self.v, strict=True)]
        return np.array(found, dtype=float)
