"""Optimization of the information of a motion on the base parameters, within limits.

The method is sequential quadratic programming (SLSQP: Kraft, DFVLR-FB 88-28, 1988) from a random motion, with exact
gradients, on a coarse grid of time. Then the motion is checked on a fine grid. A limit that it violates there is
tightened by the violation, and the search goes on from there.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.excitation.bases import Basis
from graphdyn.excitation.constraints import DISTANCE_SCALE, signals
from graphdyn.excitation.information import Criterion, Information, log_det
from graphdyn.excitation.limits import MotionLimits, Sphere, frame_origins
from graphdyn.excitation.random_motions import random_trajectory
from graphdyn.excitation.trajectory import (
    FiniteMotion,
    JointMotion,
    Signal,
    Trajectory,
    Usage,
    sample_times,
    smooth_maximum,
    smooth_slope,
    usage,
)
from graphdyn.identification.algebra.least_squares import one_thread
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms.friction import positive
from graphdyn.layout import Array

log = logging.getLogger(__name__)

GRID_POINTS = 240
"""Number of instants of the search: 48 for the period of the fifth harmonic, 12 of its acceleration's square."""

CHECK_RATE = 1000.0
"""Rate at which limits are checked [Hz]."""

FRICTION_WIDTH = 0.05
"""Fraction of the velocity limit over which the sign of friction changes smoothly during the search."""

SHARPNESSES = (30.0, 200.0, 1000.0)
"""Sharpness ρ of the smooth maximum in consecutive searches: 1000 overestimates ten equal maxima by 0.2 %."""

MAX_SEARCH_ITERATIONS, MOTION_TOLERANCE = 200, 1e-5
"""Most iterations of one search; change of the logarithm of the criterion below which it ends."""

TIGHTENING_MARGIN = 1e-4
"""Additional tightening of a limit, beyond its violation, as a fraction of the limit."""

CLEARANCE_MARGIN = 0.1
"""Additional tightening of clearances, beyond their violation: a millimeter."""

MAX_LIMIT_VIOLATION = 1.3
"""Used part of a limit at the end of a search beyond which tightening will not help."""

MAX_CLEARANCE_VIOLATION = 3.0
"""Used part of a clearance beyond which tightening will not help: a violation by two centimeters."""

LIMIT_SLACK = 1e-3
"""Largest violation of a limit, relative, by a motion from which the next search goes on."""

MAX_TIGHTENINGS = 6
"""Most searches with tightened limits before a start is given up."""

MAX_STARTS = 2
"""Most random motions from which a seed searches, one after the other, until a motion is found."""

MIN_START_SHARE = 0.2
"""Fraction of its joints' own limits up to which a random motion is no start: the search would stay near it."""


@dataclass(frozen=True, eq=False)
@short_repr
class ExcitationProblem:
    """An optimization problem for a motion.

    torque_model: whose base parameters are to be determined
    limits: that the motion has to keep
    basis: of the trajectory
    noise: standard deviations of the measured torques      () or (n,)  [N m or N]
    rate: samples per second of the measurement, with independent errors   [Hz]
    criterion: of the information matrix
    known: information matrix of earlier recordings, zero if left out   (b, b)
    spheres: spheres that stay on the allowed side of the planes; the origins of all frames if left out

    Raises InvalidInput for a noise that is not above zero, or not of this robot, and for a robot with loops.
    """

    torque_model: TorqueModel
    limits: MotionLimits
    basis: Basis
    noise: Array
    rate: float
    criterion: Criterion = log_det
    known: Array | None = None
    spheres: tuple[Sphere, ...] | None = None

    def __post_init__(self) -> None:
        model = self.torque_model.model
        if model.chords:
            raise InvalidInput(f"robot '{model.name}' has loops, which no motion is planned for yet")
        object.__setattr__(self, "noise", positive("noise", self.noise, model.nv).copy())
        if not self.rate > 0:
            raise InvalidInput(f"rate is {self.rate:g} Hz; give one above zero")
        if self.spheres is None:
            object.__setattr__(self, "spheres", frame_origins(model) if self.limits.planes else ())

    @cached_property
    def information(self) -> Information:
        """Information with the sharp sign of friction."""
        return Information(self.torque_model, self.noise)

    def __getstate__(self) -> dict[str, object]:
        """The state without compiled code."""
        return {name: value for name, value in vars(self).items() if name != "information"}

    @property
    def samples(self) -> float:
        """Number of samples of a recording of the whole motion."""
        return self.rate * self.basis.duration

    def total_information(self, trajectory: FiniteMotion) -> Array:
        """F of a recording of a trajectory, with the known information added."""
        motion = trajectory.motion(sample_times(trajectory.duration, self.rate))
        return self.information.matrix(motion, self.rate * trajectory.duration) + (
            0.0 if self.known is None else self.known
        )

    def value(self, trajectory: FiniteMotion) -> float:
        """The criterion of a trajectory, friction with its sharp sign."""
        return self.criterion(self.total_information(trajectory))[0]

    def usages(self, motion: JointMotion) -> list[Usage]:
        """Use of every limit by a motion."""
        found = signals(self.torque_model.model, self.limits, self.checked_spheres, motion)
        return [usage(signal) for signal in found]

    @property
    def checked_spheres(self) -> tuple[Sphere, ...]:
        """The spheres that stay on the allowed side of the planes."""
        return self.spheres or ()


@dataclass(frozen=True, eq=False)
@short_repr
class OptimizedMotion:
    """The result of one seed.

    usages: of every limit, at CHECK_RATE; none above 1
    value: of the criterion: a natural logarithm
    iterations: of SLSQP, in all searches from the start that led to it
    """

    trajectory: Trajectory
    usages: tuple[Usage, ...]
    value: float
    seed: int
    iterations: int


class NoFeasibleMotion(InvalidInput):
    """No motion within all limits was found; the message names those that were violated."""


def optimized(
    problem: ExcitationProblem,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
    start: Trajectory | None = None,
) -> OptimizedMotion:
    """The best motion from the first start that leads to a better one.

    progress: called with the criterion after every iteration
    start: up to MAX_STARTS random motions of this seed if left out

    Raises NoFeasibleMotion if no motion within the limits is found.

    >>> import graphdyn
    >>> from graphdyn.excitation import ExcitationProblem, FourierBasis, MotionLimits, optimized
    >>> from graphdyn.identification import TorqueModel
    >>> from graphdyn.identification.terms import RigidBodies
    >>> robot = graphdyn.kr500()
    >>> limits = MotionLimits.of_model(robot, lower=-2.0, upper=2.0, velocity=1.5, acceleration=5.0)
    >>> basis = FourierBasis(duration=5.0, harmonics=2)
    >>> problem = ExcitationProblem(TorqueModel(robot, (RigidBodies(),)), limits, basis, noise=20.0, rate=20.0)
    >>> best = optimized(problem)
    >>> best.trajectory.duration, max(usage.used for usage in best.usages) <= 1.0
    (5.0, True)
    """
    rng = np.random.default_rng([seed, 1])
    best: OptimizedMotion | None = None
    with one_thread():
        for _ in range(1 if start else MAX_STARTS):
            trajectory = start or random_trajectory(
                problem.torque_model.model, problem.limits, problem.checked_spheres, problem.basis, rng, MIN_START_SHARE
            )
            found = _searched(problem, trajectory, seed, progress or (lambda value: None))
            if not isinstance(found, OptimizedMotion):
                worst = found
                continue
            if best is None or found.value < best.value:
                best = found
            if found.value < problem.value(trajectory):  # else SLSQP has failed at once
                break
    if best is not None:
        return best
    raise NoFeasibleMotion(f"no motion within all limits was found from seed {seed}: {_violation(worst)}")


def _searched(
    problem: ExcitationProblem, trajectory: Trajectory, seed: int, progress: Callable[[float], None]
) -> OptimizedMotion | Usage:
    """The motion found from one start, or the most violated limit of the last motion."""
    search = _Search(problem, progress)
    for number in range(len(SHARPNESSES) + MAX_TIGHTENINGS):
        trajectory = search.run(trajectory, SHARPNESSES[min(number, len(SHARPNESSES) - 1)])
        used = problem.usages(trajectory.motion(sample_times(trajectory.duration, CHECK_RATE)))
        worst = max(used, key=lambda one: one.used)
        if worst.used > (MAX_CLEARANCE_VIOLATION if worst.kind == "clearance" else MAX_LIMIT_VIOLATION):
            break
        if number >= len(SHARPNESSES) - 1:
            if worst.used <= 1:
                return OptimizedMotion(trajectory, tuple(used), problem.value(trajectory), seed, search.iterations)
            search.tighten(used)
    return worst


def _violation(worst: Usage) -> str:
    """Message on the violated limit and the remedy."""
    if worst.kind == "clearance":
        nearer = 1000 * DISTANCE_SCALE * (worst.used - 1)
        return (
            f"the spheres around {worst.name} come {nearer:.2g} mm nearer to each other than they may; give limits of "
            "position that keep them apart"
        )
    return (
        f"the {worst.kind} of {worst.name} needs {worst.used:.4g} times its limit; relax it, or give a longer duration"
    )


class _Search:
    """SLSQP on one problem, with the tightened limits."""

    def __init__(self, problem: ExcitationProblem, progress: Callable[[float], None]) -> None:
        self._problem, self._progress = problem, progress
        basis, limits = problem.basis, problem.limits
        self._times = np.linspace(0.0, basis.duration, GRID_POINTS)
        self._phi = [basis.rows(self._times, order) for order in range(4)]
        speed = float(np.min(limits.velocity[np.isfinite(limits.velocity)]))
        self._information = Information(problem.torque_model, problem.noise, FRICTION_WIDTH * speed)
        self._known = np.zeros((len(self._information.independent),) * 2) if problem.known is None else problem.known
        self._allowed: Array | None = None
        self.iterations = self._evaluations = 0

    def tighten(self, used: list[Usage]) -> None:
        """Allow less of every limit that was violated."""
        over = np.array([max(one.used, 1.0) for one in used])
        margin = np.array([CLEARANCE_MARGIN if one.kind == "clearance" else TIGHTENING_MARGIN for one in used])
        allowed = np.ones(len(used)) if self._allowed is None else self._allowed
        self._allowed = np.where(over > 1, allowed - (over - 1) - margin, allowed)

    def run(self, start: Trajectory, sharpness: float) -> Trajectory:
        """The end of SLSQP; if that violates limits, the best of the least violating motions on the way."""
        from scipy.optimize import minimize  # imported where first used: import graphdyn stays light

        problem, shape = self._problem, start.coefficients.shape
        kept: tuple[tuple[float, float], Array] = (np.inf, np.inf), start.coefficients
        found: dict[bytes, list[Signal]] = {}

        def signals_at(x: Array) -> list[Signal]:
            key = x.tobytes()
            if key not in found:
                found.clear()
                motion = self._motion(x.reshape(shape))
                found[key] = [*signals(problem.torque_model.model, problem.limits, problem.checked_spheres, motion)]
            return found[key]

        def room(x: Array) -> Array:
            """Margin to every limit."""
            maxima = np.array([smooth_maximum(signal, sharpness) for signal in signals_at(x)])
            return (1.0 if self._allowed is None else self._allowed) - maxima

        def violation(x: Array) -> float:
            return max(-float(room(x).min()) - LIMIT_SLACK, 0.0)

        def slopes(x: Array) -> Array:
            return -np.array([smooth_slope(signal, self._phi, sharpness).ravel() for signal in signals_at(x)])

        def objective(x: Array) -> tuple[float, Array]:
            nonlocal kept
            value, gradient = self._objective(x.reshape(shape))
            rank = violation(x), value
            if rank < kept[0]:
                kept = rank, x.copy()
            return value, gradient

        answer = minimize(
            objective,
            start.coefficients.ravel(),
            jac=True,
            method="SLSQP",
            constraints={"type": "ineq", "fun": room, "jac": slopes},
            options={"maxiter": MAX_SEARCH_ITERATIONS, "ftol": MOTION_TOLERANCE},
        )
        self.iterations += int(answer.nit)
        best = answer.x if violation(answer.x) == 0 else kept[1]
        return replace(start, coefficients=np.asarray(best).reshape(shape))

    def _motion(self, coefficients: Array) -> JointMotion:
        return JointMotion(*(rows @ coefficients.T for rows in self._phi))

    def _objective(self, coefficients: Array) -> tuple[float, Array]:
        problem = self._problem
        self._evaluations += 1
        log.info("motion %d of a search", self._evaluations)
        value, slopes = self._information.value_and_slopes(
            self._motion(coefficients), problem.samples, self._known, problem.criterion
        )
        gradient = sum(slope.T @ rows for slope, rows in zip(slopes, self._phi[:3], strict=True))
        self._progress(value)
        return value, np.asarray(gradient).ravel()
