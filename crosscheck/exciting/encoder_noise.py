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
from dataclasses import dataclass

import numpy as np

from crosscheck.recordings import Recording, differentiated, samples_of
from crosscheck.recordings.preparation.derivatives import Cutoff
from graphdyn.excitation import (
    ExcitationPlan,
    ExcitationProblem,
    FiniteMotion,
    expected_parameters,
    sample_times,
)
from graphdyn.identification import Problem, Samples, WeightedLeastSquares, one_thread
from graphdyn.layout import Array

log = logging.getLogger(__name__)

ENCODER_DRAWS, TRIAL_DRAWS = 200, 30
"""Virtual recordings of the plan, which know standard deviations within 5 %; the same of motions to choose from."""


@dataclass(frozen=True)
class EncoderNoise:
    """position: standard deviation of measured positions [rad or m]; cutoff: low-pass, as in differentiated

    others: recordings that are fitted together with the planned ones, with v and a
    """

    position: float
    cutoff: Cutoff
    others: tuple[Recording, ...] = ()


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
    """The plan of recordings of all motions, and of the others, together.

    The robot is that of the file; drives, of which it says nothing, have the size that is expected of them. Raises
    InvalidInput where the filter leaves no rows.
    """
    model, rng = problem.torque_model, np.random.default_rng([seed, 3])
    truth = plan.base.values(expected_parameters(model))
    exact = [*(without_noise(problem, course) for course in courses), *noise.others]
    torques = [_torque(plan, motion, truth) for motion in exact]
    found = list[Array]()
    with one_thread():
        for number in range(draws):
            log.info("virtual recording %d of %d", number + 1, draws)
            pieces = [
                sample
                for motion, tau in zip(exact, torques, strict=True)
                for sample in samples_of(_measured(problem, noise, motion, tau, rng))
            ]
            of_draw = Problem(model, pieces)  # whose weights come from the residual, as those of a recording do
            found.append(of_draw.structure.base.values(WeightedLeastSquares().estimate(of_draw).parameters))
    values = np.array(found)
    return EncoderPlan(np.std(values, axis=0, ddof=1), values.mean(axis=0) - truth)


def without_noise(problem: ExcitationProblem, course: FiniteMotion) -> Recording:
    """A recording of the motion itself, without torques."""
    times = sample_times(course.duration, problem.rate)
    motion = course.motion(times)
    return Recording(problem.torque_model.model.independent_joints, times, motion.q, motion.v, motion.a)


def _torque(plan: ExcitationPlan, motion: Recording, truth: Array) -> Array:
    q, v, a = (motion.channel(name) for name in "qva")
    samples = Samples(q, v, a, np.zeros_like(q))
    return np.asarray(plan.torque_model.rows(samples, plan.base.independent) @ truth)


def _measured(
    problem: ExcitationProblem, noise: EncoderNoise, motion: Recording, tau: Array, rng: np.random.Generator
) -> Recording:
    q = motion.q + noise.position * rng.standard_normal(motion.q.shape)
    noisy = tau + problem.noise * rng.standard_normal(tau.shape)
    return differentiated(Recording(motion.joint_names, motion.t, q, tau=noisy, block=motion.block), noise.cutoff)
