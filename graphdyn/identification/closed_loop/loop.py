"""The control loop of a recording, and the part of a torque model that its simulation needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import Coulomb, Offset, RotorInertia, Viscous
from graphdyn.identification.terms.term import CarriesBodies, CarriesKnownBodies
from graphdyn.layout import Array
from graphdyn.simulation import ComputedTorqueControl, Friction, PDControl

Differentiation = Callable[[Array, Array, float], tuple[Array, Array, Array]]
"""Function from q, v (N, n) and the sampling rate [Hz] to the q, v and a of samples (N, n)."""

ControlLaw = Callable[[float, Array, Array], ArrayLike]

MAX_SIMULATION_STEP = 1e-3
"""Default step of the simulation [s]: a tenth of the time constant of a stiff position loop, 10 ms."""


@dataclass(frozen=True, eq=False)
@short_repr
class ClosedLoop:
    """The controller of a recording, with the reference that it followed.

    controller: PDControl or ComputedTorqueControl, whose targets are motion laws over the time of the recording and
        whose period is that of the controller; or a function of t, q and v that returns τ (n,), slow because in Python
    period: of a controller that is a function; it holds its torque in between. None: a new torque every step   [s]
    step: largest width of a step of the simulation, rk4   [s]
    torque_hold: hold time of the recorded torques; those of the samples are taken at the middle of the hold
        (held_torque). 0: torques as commanded at the instant of the sample   [s]
    differentiation: low-pass and differences by which q, v and a of the samples were computed from measurements;
        simulated motions go through it too, so that only the noise differs. None: they stay as they are

    Raises InvalidInput for negative times, and for a period in addition to a controller that has its own.
    """

    controller: PDControl | ComputedTorqueControl | ControlLaw
    period: float | None = None
    step: float = MAX_SIMULATION_STEP
    torque_hold: float = 0.0
    differentiation: Differentiation | None = None

    def __post_init__(self) -> None:
        if self.period is not None and not self.is_function:
            raise InvalidInput("the controller has a period of its own; give period for a function only")
        for name, least in (("period", True), ("step", True), ("torque_hold", False)):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and (value > 0 or (value == 0 and not least))):
                raise InvalidInput(f"{name} of the closed loop is {value!r}; give seconds above zero")

    @property
    def is_function(self) -> bool:
        """Whether the controller is a function, which cannot run in compiled steps."""
        return not isinstance(self.controller, PDControl | ComputedTorqueControl)

    @property
    def control_period(self) -> float | None:
        """Hold time of a torque [s]; None if it is new at every step."""
        if isinstance(self.controller, PDControl | ComputedTorqueControl):
            return self.controller.period
        return self.period

    def seen(self, exact: Samples) -> Samples:
        """A simulated motion, evenly spaced in time, with q, v and a computed as from measurements."""
        if self.differentiation is None or exact.time is None:
            return exact
        q, v, a = self.differentiation(exact.q, exact.v, float((len(exact) - 1) / (exact.time[-1] - exact.time[0])))
        return replace(exact, q=q, v=v, a=a)


def held_torque(tau: Array, period: float, hold: float) -> Array:
    """Torques (N, n), each held for some time from its sample on, at the middle of the holds that meet at the sample.

    period: between two samples; hold: how long a torque is held   [s]

    Accelerations from differences of positions lie between the torques before and after the sample. A held torque
    acts half its hold later than it was commanded: τ(t - hold / 2), interpolated linearly between samples.
    """
    rows = np.arange(len(tau), dtype=float)
    wanted = np.maximum(rows - hold / period / 2, 0.0)
    before = np.floor(wanted).astype(int)
    after, share = np.minimum(before + 1, len(tau) - 1), (wanted - before)[:, None]
    return np.asarray((1 - share) * tau[before] + share * tau[after])


@dataclass(frozen=True, eq=False)
@short_repr
class DrivenRobot:
    """R robots with their drives.

    bodies: inertial parameters                             (R, 10 n)
    friction: per joint and robot                           (R, n) each
    rotors: inertia of the rotors                           (R, n)
    """

    bodies: Array
    friction: Friction
    rotors: Array

    @classmethod
    def of(cls, torque_model: TorqueModel, parameters: Array) -> DrivenRobot:
        """The robots of parameters (R, p). Friction and rotors that would drive the joints count as zero."""
        shape = (len(parameters), torque_model.model.nv)

        def drive(kind: type) -> Array:
            columns = torque_model.slice_of(kind)
            return np.zeros(shape) if columns is None else parameters[:, columns]

        bodies = np.array([torque_model.inertial_parameters(x) for x in parameters])
        viscous, dry, rotors = (np.maximum(drive(kind), 0.0) for kind in (Viscous, Coulomb, RotorInertia))
        return cls(bodies, Friction(viscous, dry, drive(Offset)), rotors)


def not_simulated(torque_model: TorqueModel) -> list[str]:
    """Names of the terms that the simulation lacks or only approximates (a smooth sign of v)."""
    exact = [
        type(term) in (Viscous, Offset)
        or (isinstance(term, RotorInertia) and term.gears is None)
        or (isinstance(term, Coulomb) and term.width is None)
        or isinstance(term, CarriesBodies)
        for term in torque_model.terms
    ]
    rough = [type(term).__name__ for term, known in zip(torque_model.terms, exact, strict=True) if not known]
    return rough + [type(term).__name__ for term in torque_model.known if not isinstance(term, CarriesKnownBodies)]
