"""The equations of motion of one run, with friction that sticks: M a + h = τ + (torque of friction and stops).

Written with the verbs of the dynamics, one state at a time: the specification of the compiled steps.

Those of robots with loops are M a + h = τ + Jᵀ λ and J a = γ in all joints of the tree, and their states are kept
closed. The rank of J is that of a regular pose, at every state: a rank decided anew would set motions free near
singular poses, which the linkage passes in an instant.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.compiler.stepping.layout import HOLDING_SHARE
from graphdyn.errors import IntegrationFailed, InvalidInput
from graphdyn.experiments.experiment import base_motion
from graphdyn.layout import BODY_DOF, Array
from graphdyn.model.assembly import refuse_infinitesimal
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import apply
from graphdyn.simulation.loop_rows import LoopRows, loop_rows
from graphdyn.simulation.plant import PlantConstants
from graphdyn.verbs.compiled import compile as compiled
from graphdyn.verbs.dynamics import joint_torques


class Contact(NamedTuple):
    """How the dry friction of every joint acts: sign of its sliding (n,), and which joints are free to move (n,)."""

    sign: Array
    free: NDArray[np.bool_]


class Rates(NamedTuple):
    """a (n,), and the torque of friction and stops on the joints (n,); held: what holds a joint at rest (n,)."""

    a: Array
    passive: Array
    held: Array


class Equations:
    """Accelerations and torques of a plant."""

    def __init__(self, plant: PlantConstants) -> None:
        self.plant, self._constants = plant, plant.constants
        self._verbs = compiled(plant.model)
        self._rotor = np.diag(plant.rotor)

    def clamped(self, tau: Array) -> Array:
        """The torque that the actuators can give."""
        if not self.plant.is_clamped:
            return tau
        clipped: Array = np.clip(tau, self._constants["least_torque"], self._constants["largest_torque"])
        return clipped

    def rates(self, t: float, q: Array, v: Array, tau: Array, contact: Contact) -> Rates:
        """Rates at the torque of the actuators. Joints that are not free keep their velocity of zero."""
        passive = self._passive(q, v, contact.sign)
        mass = self._verbs.mass_matrix(q) + self._rotor
        bias = self._bias(t, q, v)
        applied, free = tau + passive, contact.free
        a, held = np.zeros(len(q)), np.zeros(len(q))
        if free.all():
            a[:] = np.linalg.solve(mass, applied - bias)
            return Rates(a, passive, held)
        a[free] = np.linalg.solve(mass[np.ix_(free, free)], (applied - bias)[free])
        held[~free] = (mass @ a + bias - applied)[~free]
        return Rates(a, passive + held, held)

    def contact(self, t: float, q: Array, v: Array, tau: Array, passes: int = 1, loose: int | None = None) -> Contact:
        """Which joints slide. A joint at rest is held, and begins to slide where that takes more than F_c,
        beyond rounding.

        passes: how often what slides is decided again, given what the other joints do
        loose: a joint that has just reached F_c, and slides whatever the rounding of its torque
        """
        sign = np.sign(v)
        if not self.plant.sticks:
            return Contact(sign, np.ones(len(q), dtype=bool))
        dry = self._constants["coulomb"]
        resting = (v == 0) & (dry > 0)
        free = ~resting
        decided = np.arange(len(q)) == loose
        for _ in range(passes if resting.any() else 0):
            rates = self.rates(t, q, v, tau, Contact(sign, free))
            slips = resting & ~free & ((np.abs(rates.held) > HOLDING_SHARE * dry) | decided)
            driven_back = resting & free & (rates.a * sign < 0) & ~decided
            if not slips.any() and not driven_back.any():
                break
            sign = np.where(slips, -np.sign(rates.held), np.where(driven_back, 0.0, sign))
            free = (free | slips) & ~driven_back
        return Contact(sign, free)

    def _passive(self, q: Array, v: Array, sign: Array) -> Array:
        """Torque of friction and stops on the joints, but for what holds them at rest."""
        passive, x = np.zeros(len(q)), self._constants
        if self.plant.has_friction:
            passive -= x["viscous"] * v + x["coulomb"] * sign + x["offset"]
        if self.plant.has_stops:
            for limit, side in ((x["lower"], -1.0), (x["upper"], 1.0)):
                beyond = side * (q - limit) > 0
                push = np.zeros(len(q))
                push[beyond] = -(x["stiffness"] * (q - limit) + x["damping"] * v)[beyond]
                passive += np.where(side * push < 0, push, 0.0)
        return passive

    def _bias(self, t: float, q: Array, v: Array) -> Array:
        """The torque at a = 0: velocity, gravity, motion of the base, external wrenches."""
        plant = self.plant
        if not plant.base and not plant.is_loaded:
            return self._verbs.bias_torque(q, v).copy()
        wrenches = self.wrenches(t, q, v) if plant.is_loaded else None
        base = base_motion(plant.base, np.array([t])).at((1,), (np.array(0),)) if plant.base else None
        return joint_torques(plant.model, q, v, np.zeros(len(q)), wrenches, base=base, method="recursive")

    def wrenches(self, t: float, q: Array, v: Array) -> Array:
        """The external wrenches (n, 6). Raises InvalidInput where a function answers anything else."""
        shape = (self.plant.model.n_bodies, BODY_DOF)
        if self.plant.wrenches is None:
            return self._constants["external_wrenches"].reshape(shape)
        return answer("external_wrenches", self.plant.wrenches(t, q.copy(), v.copy()), shape, t)


def answer(name: str, value: object, shape: tuple[int, ...], t: float) -> Array:
    """What a function of the caller answers at a time. Raises InvalidInput for another shape, NaN and infinity."""
    array = as_floats(f"what the function {name} answers", value)  # type: ignore[arg-type]
    if array.shape != shape or not np.all(np.isfinite(array)):
        what = f"shape {array.shape}" if array.shape != shape else "NaN or infinity"
        raise InvalidInput(f"the function {name} answers {what} at {t:g} s; finite numbers of shape {shape} are needed")
    return array


MAX_PROJECTION_STEPS = 6
"""Largest number of steps of a projection; two close what a step of integration leaves open."""

LAST_STEP_GAP = 1e-8
"""Gap [rad, m in the unit of its loop] whose square is rounding: the Newton step from there is the last."""

MIN_START_SINGULAR_VALUE = 1e-6
"""A simulation does not start where the smallest singular value of J is below this part of the largest."""

SINGULAR_DIRECTION_SHARE = 1e-7
"""Singular values of J below this part of the largest are rounding: nothing is done along them."""


class LoopEquations(Equations):
    """Accelerations and closed states of a plant with loops.

    distance: smallest by largest singular value of J, in the units of the loops, at the state seen last, those of
        redundant rows left out; zero in a singular pose
    usual_distance: the same in a regular pose
    """

    def __init__(self, plant: PlantConstants, geometry: RobotModel | None = None) -> None:
        """geometry: the same robot, of other masses, whose regular pose may be known already."""
        super().__init__(replace(plant, model=plant.model.opened))
        of_loops = geometry or plant.model
        self._loops = of_loops.loops
        self._rank, self.usual_distance = _usual(of_loops)
        self.distance, self._geometry = self.usual_distance, of_loops
        self._plain = False

    @cached_property
    def _compiled_rows(self) -> LoopRows:
        return loop_rows(self._geometry)

    @property
    def _rows(self) -> LoopRows:
        return LoopRows(self._loops) if self._plain else self._compiled_rows

    @contextmanager
    def plain(self) -> Iterator[None]:
        """Inside, rows are computed as the equations read: in singular poses rounding errors choose the branch, and
        these cancel in symmetric linkages, whose branches meet there."""
        self._plain = True
        try:
            yield
        finally:
            self._plain = False

    def rates(self, t: float, q: Array, v: Array, tau: Array, contact: Contact) -> Rates:
        """Rates at the torque of the actuators."""
        passive = self._passive(q, v, contact.sign)
        rows = self._rows.at(q, v)
        inverse, motions = self._spaces(rows.jacobian)
        start = inverse @ rows.bias
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
        """The nearest position and velocity (…, n), in the norm of all joints, that keep the loops closed.

        Raises IntegrationFailed where Newton steps do not close them.
        """
        q, v, gap = self._projected(q, v)
        if not np.all(gap < LAST_STEP_GAP):
            raise IntegrationFailed(
                f"the loops are open by {np.max(gap) * self._loops.length_unit:.2g} m or rad after a step, and do not "
                "close; take smaller steps, or smaller torques"
            )
        return q, v

    def nearly_closed(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The same of states (…, n) between steps; those that Newton steps do not close are left as they are."""
        closed_q, closed_v, gap = self._projected(q, v)
        is_closed = (gap < LAST_STEP_GAP)[..., None]
        return np.where(is_closed, closed_q, q), np.where(is_closed, closed_v, v)

    def _projected(self, q: Array, v: Array) -> tuple[Array, Array, Array]:
        """The states (…, n) after Newton steps, and by how much, in units, they were open before the last (…)."""
        for _ in range(MAX_PROJECTION_STEPS):
            rows = self._rows.at(q, v)
            inverse, _ = self._spaces(rows.jacobian)
            q = q - apply(inverse, rows.gaps)
            gap = np.abs(rows.gaps).max(axis=-1, initial=0.0)
            if np.all(gap < LAST_STEP_GAP):
                break
        jacobian = self._rows.at(q, v).jacobian
        inverse, _ = self._spaces(jacobian)
        return q, v - apply(inverse, apply(jacobian, v)), gap

    def _spaces(self, jacobian: Array) -> tuple[Array, Array]:
        """J⁺ (…, n, k) of the usual rank, and the motions that keep the loops closed (…, n, n - rank).

        jacobian: J (…, k, n), rows in their units
        """
        of_columns = self._loops.column_units[:, None]
        left, values, right = np.linalg.svd(jacobian * of_columns.T)
        rank = self._rank
        self.distance = _distance(values, rank)
        kept = values[..., :rank] > SINGULAR_DIRECTION_SHARE * values[..., :1]
        factors = np.where(kept, 1.0 / np.where(kept, values[..., :rank], 1.0), 0.0)
        along, motions = np.swapaxes(right, -1, -2)[..., :rank], np.swapaxes(right, -1, -2)[..., rank:]
        inverse = (along * factors[..., None, :]) @ np.swapaxes(left[..., :rank], -1, -2)
        return of_columns * inverse, of_columns * motions


_usually: WeakKeyDictionary[RobotModel, tuple[int, float]] = WeakKeyDictionary()
"""What _usual has found, by the robot."""


def _usual(model: RobotModel) -> tuple[int, float]:
    """Rank and distance in a regular pose. Raises InconsistentState for loops of infinitesimal mobility."""
    if model not in _usually:
        loops, pose = model.loops, model.regular_pose
        refuse_infinitesimal(f"robot '{model.name}'", loops, pose)
        jacobian = loops.jacobian(loops.links(pose))
        rank = int(loops.spaces(jacobian).rank)
        _usually[model] = rank, _distance(np.linalg.svd(loops.in_units(jacobian), compute_uv=False), rank)
    return _usually[model]


def _distance(values: NDArray[np.floating[Any]], rank: int) -> float:
    """The last of the singular values (…, k) that count by the largest, where it is smallest."""
    return float(np.min(values[..., rank - 1] / values[..., 0])) if rank else 1.0


def equations_of(plant: PlantConstants) -> Equations:
    """Equations of a tree, or of a robot with loops."""
    return LoopEquations(plant) if plant.model.chords else Equations(plant)


def refuse_dry_friction(plant: PlantConstants) -> None:
    """Raises InvalidInput where dry friction acts in loops: which of their joints it holds is not decided."""
    if plant.model.chords and plant.sticks:
        raise InvalidInput(
            f"robot '{plant.model.name}' has loops, in which dry friction is not simulated: forces that hold joints at "
            "rest are not unique; give Friction(viscous=…) alone"
        )
