"""What a motion will determine where positions have noise too, as `graphdyn identify` sees it: σ and bias.

Weighted least squares takes q, v and a for exact. After low-pass and differences they are not: with E the errors of the
regressor, least squares minimizes the residual n - E x with the regressor W + E, and finds x - F⁻¹ (Eᵀ S⁻¹ E) x in the
mean, however long the recording is. The errors of neighboring rows are alike, and products of errors scatter. All this
is measured on virtual recordings of the planned motion: noise is drawn, the recording goes through the same
low-pass, differences and fit, and mean and standard deviation over the draws are told.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.recordings import Recording, differentiated, samples_of
from crosscheck.recordings.preparation.derivatives import Cutoff
from graphdyn.excitation import ExcitationPlan, ExcitationProblem, FiniteMotion, JointMotion, sample_times
from graphdyn.identification import Problem, Samples, WeightedLeastSquares, one_thread
from graphdyn.layout import Array

log = logging.getLogger(__name__)

ENCODER_DRAWS, TRIAL_DRAWS = 200, 30
"""Virtual recordings of the plan, which know standard deviations within 5 %; the same of motions to choose from."""


@dataclass(frozen=True)
class EncoderNoise:
    """position: standard deviation of measured positions [rad or m]; cutoff: low-pass, as in differentiated"""

    position: float
    cutoff: Cutoff


@dataclass(frozen=True, eq=False)
class EncoderPlan:
    """Scatter and bias of the base parameters over the draws (b,), in their units."""

    sigma: Array
    bias: Array

    def mean_error(self, spread: Array) -> float:
        """Mean logarithm of the root mean square errors, in units of the prior spreads (b,)."""
        return float(np.log(np.hypot(self.sigma, self.bias) / spread).mean())


def encoder_plan(
    problem: ExcitationProblem,
    courses: Sequence[FiniteMotion],
    plan: ExcitationPlan,
    noise: EncoderNoise,
    draws: int = ENCODER_DRAWS,
    seed: int = 0,
) -> EncoderPlan:
    """The plan of recordings of all motions together.

    The robot is that of the file; drives, of which it says nothing, have the size that is expected of them. Raises
    InvalidInput where the filter leaves no rows.
    """
    model, rng = problem.torque_model, np.random.default_rng([seed, 3])
    truth = np.where(plan.prior != 0, plan.prior, plan.spread * _is_drive(plan))
    exact = [course.motion(sample_times(course.duration, problem.rate)) for course in courses]
    torques = [_torque(plan, motion, truth) for motion in exact]
    found = list[Array]()
    with one_thread():
        for number in range(draws):
            log.info("virtual recording %d of %d", number + 1, draws)
            pieces = [
                sample
                for motion, tau in zip(exact, torques, strict=True)
                for sample in samples_of(_recorded(problem, noise, motion, tau, rng))
            ]
            of_draw = Problem(replace(model, noise=problem.noise), pieces)
            found.append(of_draw.structure.base.values(WeightedLeastSquares().estimate(of_draw).parameters))
    values = np.array(found)
    return EncoderPlan(np.std(values, axis=0, ddof=1), values.mean(axis=0) - truth)


def _is_drive(plan: ExcitationPlan) -> Array:
    """1 for base parameters that are a drive's alone (b,)."""
    units = np.array(plan.units)
    return np.where(np.isin(units, ("kg m", "kg m²", "kg")), 0.0, 1.0)


def _torque(plan: ExcitationPlan, motion: JointMotion, truth: Array) -> Array:
    samples = Samples(motion.q, motion.v, motion.a, np.zeros_like(motion.q))
    return np.asarray(plan.torque_model.rows(samples, plan.base.independent) @ truth)


def _recorded(
    problem: ExcitationProblem,
    noise: EncoderNoise,
    motion: JointMotion,
    tau: Array,
    rng: np.random.Generator,
) -> Recording:
    names = problem.torque_model.model.independent_joints
    q = motion.q + noise.position * rng.standard_normal(motion.q.shape)
    noisy = tau + problem.noise * rng.standard_normal(tau.shape)
    times = np.arange(len(q)) / problem.rate
    return differentiated(Recording(names, times, q, tau=noisy), noise.cutoff)
