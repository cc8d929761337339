"""Simulated recordings identified again and again: how often twice the standard deviation covers the truth."""

import functools
from dataclasses import dataclass

import numpy as np

import graphdyn
import urdf
from crosscheck.identifying import Preparation, friction_terms, virtual_robot
from graphdyn.identification import (
    GeneralizedLeastSquares,
    OrdinaryLeastSquares,
    Problem,
    ReweightedLeastSquares,
    Samples,
    TorqueModel,
    WeightedLeastSquares,
)
from graphdyn.identification.statistics.residual_statistics import residual_statistics
from graphdyn.identification.terms import Coulomb, Offset, RigidBodies, Viscous
from graphdyn.motion_laws import FourierSeries

RATE = 50.0
"""[Hz]"""

METHODS = (
    OrdinaryLeastSquares(),
    WeightedLeastSquares(),
    GeneralizedLeastSquares(),
    ReweightedLeastSquares("huber"),
)


SHORT = ("OLS", "WLS", "GLS", "Huber")


@dataclass(frozen=True)
class Case:
    """Length of the recording, correlation time of its noise [s], cutoff of the low-pass [Hz], part that is white."""

    seconds: float
    correlated: float
    cutoff: float | None = None
    white: float = 0.0

    def __str__(self):
        low = f", {self.cutoff:g} Hz" if self.cutoff else ""
        white = f", {self.white:g} white" if self.white else ""
        return f"{self.seconds:g} s / {self.correlated:g} s{white}{low}"


CASES = (
    Case(10, 0.0),
    Case(10, 0.1),
    Case(20, 0.1),
    Case(40, 0.5),
    Case(40, 0.1),
    Case(80, 0.1),
    Case(40, 0.4, white=1.5),
    Case(20, 0.0, cutoff=4.0),
    Case(20, 0.1, cutoff=4.0),
    Case(10, 0.2),
    Case(10, 0.5),
    Case(20, 1.0),
)


@dataclass(frozen=True)
class LowPass:
    """Butterworth of order 4, forward and backward."""

    cutoff: float
    factor: int = 1
    memory: int = 400

    def __call__(self, columns):
        from scipy.signal import butter, sosfiltfilt

        return sosfiltfilt(butter(4, self.cutoff, fs=RATE, output="sos"), columns, axis=0)


@dataclass(frozen=True)
class Coverage:
    """Parts of the parameters within two standard deviations, by method; median of the correlation times found."""

    block: dict[str, float]
    white: dict[str, float]
    correlation_times: float


@functools.cache
def robot():
    """The arm of all trials, compiled once."""
    return urdf.load("ur5")


def coverage(case: Case, runs: int, methods=METHODS, seed: int = 0) -> Coverage:
    rng = np.random.default_rng(seed)
    laws = [FourierSeries(0.1, *0.3 * rng.normal(size=(2, 5))) for _ in robot().joints]
    motion = graphdyn.simulate_recording(robot(), np.arange(0, case.seconds, 1 / RATE), laws)
    model = TorqueModel(robot(), (RigidBodies(), Viscous(), Coulomb(), Offset()))
    truth = model.prior()
    truth[60:] = rng.uniform(1.0, 5.0, len(truth) - 60)
    exact = Samples(motion.q, motion.v, motion.a, motion.tau)
    tau, size = model.torque(exact, truth), rng.uniform(0.5, 2.0, 6)
    covered = {kind: {method.name: [] for method in methods} for kind in ("block", "white")}
    lengths = []
    for _ in range(runs):
        noise = size * (correlated_noise(rng, tau.shape, case.correlated) + case.white * rng.normal(size=tau.shape))
        row_filter = None if case.cutoff is None else LowPass(case.cutoff)
        problem = Problem(model, Samples(motion.q, motion.v, motion.a, tau + noise, row_filter=row_filter))
        true = problem.base.values(truth)
        for method in methods:
            estimate = method.estimate(problem)
            error = np.abs(problem.base.values(estimate.parameters) - true)
            for kind, covariance in (("block", estimate.block_covariance), ("white", estimate.covariance)):
                covered[kind][method.name].append(np.mean(error <= 2 * np.sqrt(np.diag(covariance))))
        lengths.append(residual_statistics(problem, estimate.parameters[None])[0].correlation_times)
    means = {kind: {name: float(np.mean(parts)) for name, parts in found.items()} for kind, found in covered.items()}
    return Coverage(means["block"], means["white"], float(np.median(lengths)))


def virtual_coverage(seeds: int, seconds: float = 20.0) -> tuple[float, float]:
    """Of the robot that `graphdyn identify --robot ur5` simulates, by WLS: σ blocks, σ white."""
    covered = []
    for seed in range(seeds):
        arm = virtual_robot("ur5", friction_terms(["viscous", "coulomb", "offset"]), seconds=seconds, seed=seed)
        preparation = Preparation()
        problem = preparation.problem(arm.torque_model, preparation.differentiated(arm.fitted))
        estimate = WeightedLeastSquares().estimate(problem)
        error = np.abs(problem.base.values(estimate.parameters) - problem.base.values(arm.truth))
        both = (estimate.block_covariance, estimate.covariance)
        covered.append([np.mean(error <= 2 * np.sqrt(np.diag(covariance))) for covariance in both])
    block, white = np.mean(covered, axis=0)
    return float(block), float(white)


def correlated_noise(rng, shape, time: float):
    """AR(1) of unit variance, stationary from the first row on; white for a time of zero."""
    noise = rng.normal(size=shape)
    if time == 0:
        return noise
    decay = np.exp(-1 / (RATE * time))
    noise[1:] *= np.sqrt(1 - decay**2)
    from scipy.signal import lfilter

    return lfilter([1.0], [1.0, -decay], noise, axis=0)
