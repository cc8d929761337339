"""Rehearsal of a planned motion: what an identification will find, and how certainly, before the robot moves.

A robot whose links differ from those of the file follows the motion again and again, with friction and noise of stated
sizes. Each of these virtual recordings is identified like a real one. The errors of the results against the truth of
each are counted, so that the deviations hold for short motions, correlated noise and biased methods too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Unpack, cast

import numpy as np
from numpy.typing import NDArray

from crosscheck.identifying.methods.methods import Labeled, method_named
from crosscheck.identifying.methods.torque_terms import STANDARD_TERM_NAMES, friction_terms
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.identifying.virtual import ENCODER_NOISE, ROWS_PER_PIECE, VIRTUAL_RATE, true_parameters
from crosscheck.recordings import Provenance, Recording, chosen_cutoff
from crosscheck.reference.subject import IDENTIFY_CLOSED, Robot, Subject, refuse_chords, subject
from graphdyn import InvalidInput, RobotModel
from graphdyn.display import short_repr
from graphdyn.excitation import FiniteMotion, sample_times
from graphdyn.identification import (
    MIN_MOVING_SPEED,
    BaseParameters,
    Estimator,
    MethodComparison,
    OrdinaryLeastSquares,
    Problem,
    Samples,
    TorqueModel,
    Tunable,
    compare_methods,
)
from graphdyn.identification.terms import RigidBodies, Term
from graphdyn.layout import BODY_PARAMETERS, Array
from urdf import Reading, ReadingKeywords

REHEARSED_METHODS = ("wls", "consistent", "entropic")
"""Default methods: the data alone, physically consistent links, and those near the file."""

CHOOSING_RUNS = 5
"""Runs in which the strengths of priors are chosen. One choice for all would not do: it differs from run to run."""

UNLOADED_SHARE = 1e-6
"""Torque, relative to that of the most loaded joint, below which a joint carries none; it has the noise of the least
loaded of the others."""

LEARNED_SHARE = 0.5
"""Deviation, relative to that of the file, from which a recording counts as telling little beyond the file."""


@dataclass(frozen=True)
class Conditions:
    """What the virtual recordings are like.

    torque_noise: standard deviation of the residual of each joint, as a part of the root mean square of its torque
    noise_time: time in which its autocorrelation falls to 1/e; zero for white noise [s]
    position_noise: standard deviation of the positions [rad or m]
    friction: root mean square torque of each drive parameter, as a part of that of its joint, ± 50 %
    cad_error: largest relative error of the masses of the file; of the components of its centers of mass, relative to
        the size of the link; of the distribution of mass about them
    rate: of the recordings [Hz]; runs: their number, two or more; seed: of their random numbers

    A residual of 5 %, correlated over 0.1 s, is what the models of industrial arms leave (docs/industrial_arms.md): not
    the noise of the sensors, but what no torque model explains. Raises InvalidInput for sizes below zero.
    """

    torque_noise: float = 0.05
    noise_time: float = 0.1
    position_noise: float = ENCODER_NOISE
    friction: float = 0.05
    cad_error: float = 0.2
    rate: float = VIRTUAL_RATE
    runs: int = 20
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("torque_noise", "noise_time", "position_noise", "friction"):
            if not 0 <= getattr(self, name) < np.inf:
                raise InvalidInput(f"{name} is {getattr(self, name):g}; give a number that is not below zero")
        if not 0 < self.cad_error < 1:
            raise InvalidInput(f"cad_error is {self.cad_error:g}; give a relative error between 0 and 1")
        if not 0 < self.rate < np.inf:
            raise InvalidInput(f"rate is {self.rate:g}; give Hz above zero")
        if self.runs < 2:
            raise InvalidInput(f"runs is {self.runs}; deviations need two or more")


@dataclass(frozen=True, eq=False)
@short_repr
class Outcome:
    """Errors of one method, or of the file, against the truth of every run, K runs in all.

    base: of the base parameters (K, r); masses: of the links (K, n) [kg]; centers: of mass (K, n, 3) [m]
    consistent: whether all links were physically consistent in every run; masses and centers mean little otherwise
    stated: standard deviations that an identification states, from time blocks, the median of the runs (r,); NaN where
        it states none
    covered: share of base parameters and runs in which twice the stated deviation contains the truth; NaN likewise
    """

    base: Array
    masses: Array
    centers: Array
    consistent: bool = True
    stated: Array | None = None
    covered: float = float("nan")

    @property
    def base_deviations(self) -> Array:
        """Root mean square errors of the base parameters (r,)."""
        return _size(self.base)

    @property
    def mass_deviations(self) -> Array:
        """Root mean square errors of the masses (n,) [kg]."""
        return _size(self.masses)

    @property
    def center_deviations(self) -> Array:
        """Root mean square errors of the centers of mass, component by component (n, 3) [m]."""
        return _size(self.centers)


def _size(errors: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(errors**2, axis=0)))


@dataclass(frozen=True, eq=False)
@short_repr
class Rehearsal:
    """What a planned motion will tell.

    subject: the robot of the file; torque_model: with its bodies as the prior; conditions, preparation: of the runs
    motion: name; duration: of it [s]
    cutoffs: of the low-pass, where residual analysis chose them, run by run [Hz]
    strengths: of the priors, chosen by cross-validation in the first CHOOSING_RUNS runs, by name of the method
    top_speeds: of the joints (n,) [rad/s or m/s]
    identifiability: of the exact motion, without noise: what it determines, and what it does not
    base: the parameters that it determines; file: errors of the file
    outcomes: of the methods, by name; failures: why a method has no outcome, by name
    """

    subject: Subject
    torque_model: TorqueModel
    conditions: Conditions
    preparation: Preparation
    motion: str
    duration: float
    top_speeds: Array
    identifiability: MethodComparison
    base: BaseParameters
    file: Outcome
    outcomes: Mapping[str, Outcome]
    failures: Mapping[str, str]
    cutoffs: tuple[float, ...]
    strengths: Mapping[str, tuple[float, ...]]

    @property
    def complete(self) -> bool:
        """Whether the motion determines all that any motion could, and some method has an outcome."""
        found = self.identifiability
        return bool(self.outcomes) and found.rank == found.structural_rank

    @cached_property
    def best(self) -> str | None:
        """The method with the smallest deviations relative to those of the file, geometric mean; None without one."""
        known = self.file.base_deviations > 0
        sizes = {
            name: float(np.mean(np.log(outcome.base_deviations[known] / self.file.base_deviations[known])))
            for name, outcome in self.outcomes.items()
        }
        return min(sizes, key=lambda name: sizes[name]) if sizes else None

    @cached_property
    def best_of_links(self) -> str | None:
        """The method with the smallest deviations of the masses, among those with physically consistent links."""
        real = {name: outcome for name, outcome in self.outcomes.items() if outcome.consistent}
        return min(real, key=lambda name: float(np.sum(real[name].mass_deviations ** 2))) if real else None

    def hardly_told(self, outcome: Outcome) -> NDArray[np.bool_]:
        """Base parameters that the file tells about as well (r,)."""
        return np.asarray(outcome.base_deviations > LEARNED_SHARE * self.file.base_deviations)

    def learned(self, after: float, before: float) -> bool:
        """Whether a deviation after the recording is clearly smaller than that of the file."""
        return after <= LEARNED_SHARE * before

    def share(self, name: str) -> float:
        """Deviation of a method relative to that of the file, the median of the base parameters."""
        known = self.file.base_deviations > 0
        return float(np.median(self.outcomes[name].base_deviations[known] / self.file.base_deviations[known]))

    @property
    def still_joints(self) -> tuple[str, ...]:
        """Joints that never move faster than MIN_MOVING_SPEED."""
        names = self.torque_model.model.independent_joints
        return tuple(name for name, speed in zip(names, self.top_speeds, strict=True) if speed <= MIN_MOVING_SPEED)

    @property
    def link_names(self) -> tuple[str, ...]:
        """Names of the links (n,)."""
        return self.torque_model.model.body_names

    @property
    def masses(self) -> Array:
        """Masses of the file (n,) [kg]."""
        return np.array([body.mass for body in self.torque_model.model.bodies])

    @property
    def prior_base_values(self) -> Array:
        """Base parameters of the file; zero for those of the drives (r,)."""
        return self.base.values(self.torque_model.prior())


def rehearse(
    robot: Robot,
    motion: FiniteMotion,
    *,
    name: str = "the motion",
    terms: Sequence[Term] | None = None,
    methods: Sequence[str | Estimator] = REHEARSED_METHODS,
    preparation: Preparation | None = None,
    conditions: Conditions | None = None,
    progress: Callable[[str, int], None] | None = None,
    **reading: Unpack[ReadingKeywords],
) -> Rehearsal:
    """Rehearse the identification of a planned motion.

    motion: of the joints that no others drive; name: of it, for the report
    terms: of the drives; if left out, viscous and Coulomb friction, and offset
    methods: names (METHODS) or estimators
    progress: called with the name of every run and 1

    In the first CHOOSING_RUNS runs cross-validation chooses the strengths of priors. The others take these in turn: the
    choice costs ten times as much as the fit.

    Raises InvalidInput for robots with loops or couplings, and for motions too short for the filter; urdf's errors.
    """
    conditions, preparation = conditions or Conditions(), preparation or Preparation()
    given = subject(robot, Reading.of(rehearse, reading))
    refuse_chords(given.model, IDENTIFY_CLOSED)
    if given.model.couplings:
        raise InvalidInput(f"robot '{given.name}' has couplings: rehearse RobotModel.uncoupled, or give recordings")
    terms = friction_terms(STANDARD_TERM_NAMES) if terms is None else terms
    torque_model = TorqueModel(given.model, (RigidBodies(), *terms))
    if torque_model.has_memory or any(isinstance(term, Tunable) for term in terms):
        raise InvalidInput(
            "friction with memory, and settings that are to be found, cannot be rehearsed; leave them out, or give "
            "numbers"
        )
    t = sample_times(motion.duration, conditions.rate)
    still = Samples(*motion.motion(t)[:3], np.zeros((len(t), given.model.nv)), time=t)
    exact = replace(still, tau=_torque(torque_model, still, torque_model.prior()))
    rehearsed = _Rehearsed(torque_model, exact, Problem(torque_model, exact), conditions)
    estimators = [method_named(method) if isinstance(method, str) else method for method in methods]
    runs, prepared, chosen = [], list[Preparation](), list[list[Estimator]]()
    for number in range(conditions.runs):
        if progress is not None:
            progress(f"run {number + 1}", 1)
        truth, recording = rehearsed.recorded(np.random.default_rng([conditions.seed, number]))
        own = _with_cutoff(preparation, recording)
        prepared.append(own)
        problem = own.problem(torque_model, own.differentiated(recording))
        if number < CHOOSING_RUNS:
            found = compare_methods(problem, estimators, poses=1)
            chosen.append(_with_strengths(estimators, found))
        else:
            found = compare_methods(problem, chosen[number % CHOOSING_RUNS], poses=1)
        runs.append((truth, problem, found))
    failed = {result.name: result.failure for _, _, found in runs for result in found.results if result.failure}
    return Rehearsal(
        subject=given,
        torque_model=torque_model,
        conditions=conditions,
        preparation=preparation,
        motion=name,
        duration=motion.duration,
        top_speeds=np.abs(exact.v).max(axis=0),
        identifiability=compare_methods(rehearsed.reference, [OrdinaryLeastSquares()], poses=1),
        base=rehearsed.reference.base,
        file=rehearsed.outcome([(truth, torque_model.prior()) for truth, *_ in runs]),
        outcomes={
            estimator.name: rehearsed.outcome_of(estimator.name, runs)
            for estimator in estimators
            if estimator.name not in failed
        },
        failures=failed,
        cutoffs=tuple(float(own.cutoff) for own in prepared if preparation.cutoff == "residual"),  # type: ignore[arg-type]
        strengths=_strengths(chosen),
    )


def _with_cutoff(preparation: Preparation, recording: Recording) -> Preparation:
    """The preparation, with the cutoff that residual analysis chooses where it is to."""
    return replace(preparation, cutoff=chosen_cutoff(recording)) if preparation.cutoff == "residual" else preparation


def _with_strengths(estimators: Sequence[Estimator], found: MethodComparison) -> list[Estimator]:
    """The estimators, with the strengths of priors that cross-validation chose."""
    settled: list[Estimator] = []
    for estimator in estimators:
        result: Any = found.of(estimator.name).estimate
        chosen = None if result is None else result.settings.get("strength")
        if chosen is not None and getattr(estimator, "strength", chosen) is None:
            estimator = Labeled(replace(cast(Any, estimator), strength=chosen), estimator.name)
        settled.append(estimator)
    return settled


def _strengths(chosen: Sequence[Sequence[Estimator]]) -> dict[str, tuple[float, ...]]:
    """The strengths that were chosen, by name of the method."""
    found: dict[str, tuple[float, ...]] = {}
    for estimators in chosen:
        for estimator in estimators:
            if isinstance(estimator, Labeled):
                strength = cast(Any, estimator.estimator).strength
                found[estimator.name] = (*found.get(estimator.name, ()), float(strength))
    return found


@dataclass(frozen=True, eq=False)
class _Rehearsed:
    """The exact motion with the torques of the file, and its equations."""

    torque_model: TorqueModel
    exact: Samples
    reference: Problem
    conditions: Conditions

    def recorded(self, rng: np.random.Generator) -> tuple[Array, Recording]:
        """True parameters of a robot, and its recording: positions and torques, with noise."""
        model, exact, conditions = self.torque_model.model, self.exact, self.conditions
        true_model = TorqueModel(_another(model, rng, conditions.cad_error), self.torque_model.terms)
        truth = true_parameters(true_model, exact, rng, conditions.friction)
        tau = _torque(self.torque_model, exact, truth)
        size = np.sqrt(np.mean(tau**2, axis=0))
        loaded = size > UNLOADED_SHARE * size.max()
        size = np.where(loaded, size, size[loaded].min())
        noise = conditions.torque_noise * size * _correlated(tau.shape, conditions, rng)
        assert exact.time is not None
        return truth, Recording(
            model.independent_joints,
            exact.time,
            exact.q + conditions.position_noise * rng.normal(size=exact.q.shape),
            tau=tau + noise,
            prismatic=tuple(model.joints[k].is_prismatic for k in model.degrees_of_freedom.independent),
            provenance=Provenance(("rehearsal",), "rehearsal"),
        )

    def outcome_of(self, name: str, runs: Sequence[tuple[Array, Problem, MethodComparison]]) -> Outcome:
        """Errors of a method that has a result in every run."""
        results = [found.of(name) for _, _, found in runs]
        estimates = [result.estimate.parameters for result in results if result.estimate is not None]
        outcome = self.outcome([(truth, x) for (truth, *_), x in zip(runs, estimates, strict=True)])
        real = all(result.plausibility is not None and result.plausibility.consistent for result in results)
        stated = np.array([
            self._stated(result.block_deviations, problem)
            for result, (_, problem, _) in zip(results, runs, strict=True)
        ])  # fmt: skip
        known = np.isfinite(stated)
        covered = float(np.mean(np.abs(outcome.base)[known] <= 2 * stated[known])) if known.any() else float("nan")
        middle = np.median(stated, axis=0) if known.all() else None
        return replace(outcome, consistent=real, stated=middle, covered=covered)

    def outcome(self, pairs: Sequence[tuple[Array, Array]]) -> Outcome:
        """Errors of parameters against the truth. pairs: truth and parameters (p,) of every run"""
        truth, found = (np.array(side) for side in zip(*pairs, strict=True))
        base = np.array([self.reference.base.values(x - y) for x, y in zip(found, truth, strict=True)])
        (true_mass, true_center), (mass, center) = self._links(truth), self._links(found)
        return Outcome(base, mass - true_mass, center - true_center)

    def _links(self, parameters: Array) -> tuple[Array, Array]:
        """Masses (K, n) [kg] and centers of mass (K, n, 3) [m]; NaN for a link without mass."""
        bodies = np.array([self.torque_model.inertial_parameters(x).reshape(-1, BODY_PARAMETERS) for x in parameters])
        mass = bodies[..., 0]
        return mass, bodies[..., 1:4] / np.where(mass > 0, mass, np.nan)[..., None]

    def _stated(self, deviations: Array | None, problem: Problem) -> Array:
        """Deviations of the base parameters of the exact motion; NaN where those of the recording are others (r,)."""
        base = self.reference.base
        if deviations is None or not np.array_equal(problem.base.independent, base.independent):
            return np.full(base.rank, np.nan)
        return deviations


def _another(model: RobotModel, rng: np.random.Generator, error: float) -> RobotModel:
    """A robot like that of the file, with other physically consistent links.

    Masses differ by `error` at most, each component of a center of mass by as much of the size of the link, and the
    distribution of mass about it is stretched and sheared by as much.
    """
    bodies = []
    for body, size in zip(model.bodies, _link_sizes(model), strict=True):
        factor = 1 + error * rng.uniform(-1, 1)
        center = body.center_of_mass + error * size * rng.uniform(-1, 1, 3)
        change = np.eye(3) + error * rng.uniform(-1, 1, (3, 3))
        spread = change @ (np.trace(body.inertia) / 2 * np.eye(3) - body.inertia) @ change.T
        tensor = factor * (np.trace(spread) * np.eye(3) - spread)
        bodies.append(replace(body, mass=factor * body.mass, center_of_mass=center, inertia=tensor))
    return replace(model, bodies=tuple(bodies))


def _link_sizes(model: RobotModel) -> Array:
    """Largest distance of a link's joint from its center of mass, or from a joint that it carries (n,) [m].

    For a link with both at its joint, the smallest size of another link.
    """
    sizes = np.array([np.linalg.norm(body.center_of_mass) for body in model.bodies])
    for joint in model.joints:
        if joint.inside > 0:
            sizes[joint.inside - 1] = max(sizes[joint.inside - 1], np.linalg.norm(joint.placement.translation))
    known = sizes[sizes > 0]
    return np.where(sizes > 0, sizes, known.min() if known.size else 0.0)


def _torque(torque_model: TorqueModel, samples: Samples, x: Array) -> Array:
    """Torque (N, n) of parameters (p,)."""
    return np.concatenate([torque_model.torque(piece, x) for piece in samples.pieces(ROWS_PER_PIECE)])


def _correlated(shape: tuple[int, ...], conditions: Conditions, rng: np.random.Generator) -> Array:
    """Noise of deviation 1 whose autocorrelation falls to 1/e in noise_time, of first order (N, n)."""
    from scipy.signal import lfilter

    kept = float(np.exp(-1 / (conditions.rate * conditions.noise_time))) if conditions.noise_time else 0.0
    white = rng.normal(size=shape) * np.sqrt(1 - kept**2)
    white[0] /= np.sqrt(1 - kept**2)
    return np.asarray(lfilter([1.0], [1.0, -kept], white, axis=0))
