"""An arm of real bodies, a wrong prior of it, and torques with friction and rotors; the noise is white."""

import functools

import numpy as np
from identified import torque_data

import graphdyn
from graphdyn.identification import Problem, Samples, TorqueModel
from graphdyn.identification.algebra.compressed import joint_noise
from graphdyn.identification.bodies.inequalities import inequalities
from graphdyn.identification.bodies.limits import PhysicalLimits
from graphdyn.identification.bodies.unknown_bodies import unknown_bodies
from graphdyn.identification.consistent.coordinates import prior_coordinates
from graphdyn.identification.terms import Coulomb, RigidBodies, RotorInertia, Viscous
from graphdyn.motion_laws import FourierSeries

RANK = 36 + 12 + 4
"""Bodies, friction, and the rotors but for axes 1 and 2, whose rotors fold into the bodies."""


@functools.cache
def torque_model():
    """The robot as its CAD sees it: masses wrong by up to 40 %, frames right."""
    robot, rng = torque_data.robot(), np.random.default_rng(5)
    wrong = robot.inertial_parameters.reshape(-1, 10) * rng.uniform(0.6, 1.4, (6, 1))
    return TorqueModel(
        robot.with_inertial_parameters(wrong.ravel()), (RigidBodies(), Viscous(), Coulomb(), RotorInertia())
    )


@functools.cache
def true_parameters():
    drives = np.random.default_rng(6).uniform(1.0, 5.0, 18)
    return np.concatenate([torque_data.robot().inertial_parameters, drives])


@functools.cache
def exact(size, seed, reach=0.3):
    """Samples of another motion for every seed; a small reach excites little."""
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 6, 5)) * reach
    laws = [FourierSeries(frequency=0.1, a=a[j], b=b[j]) for j in range(6)]
    motion = graphdyn.simulate_recording(torque_data.robot(), np.linspace(0.0, 10.0, size), laws)
    samples = Samples(motion.q, motion.v, motion.a, motion.tau)
    return Samples(motion.q, motion.v, motion.a, torque_model().torque(samples, true_parameters()))


def noisy(size, seed, noise, reach=0.3):
    samples = exact(size, seed, reach)
    error = np.random.default_rng(seed + 1000).normal(size=samples.tau.shape) * noise
    return Samples(samples.q, samples.v, samples.a, samples.tau + error)


@functools.cache
def exact_problem():
    return Problem(torque_model(), exact(400, 0), n_blocks=4)


@functools.cache
def poor_problem(seed=0):
    """Few samples, little motion, much noise: the best fit is no real robot."""
    return Problem(torque_model(), noisy(100, seed, 20.0, 0.15), n_blocks=4)


UNLIMITED = PhysicalLimits(cad_factor=np.inf, in_boxes=False)
"""Bodies need only be real."""


def coordinates(problem, limits=UNLIMITED):
    """The problem in the coordinates of the prior, and its inequalities."""
    bodies = unknown_bodies(problem.torque_model, None)
    reduced, right = problem.equations.weighted(joint_noise(problem.equations))
    names = [column.name for column in problem.torque_model.columns]
    return (
        prior_coordinates(problem.base, reduced, right, bodies.prior, bodies.columns),
        inequalities(limits.of(bodies), bodies, names),
    )


def prediction_error(parameters, seed=77):
    """RMS error on another, larger motion, without noise [N m]."""
    ahead = exact(200, seed)
    return np.sqrt(np.mean((torque_model().torque(ahead, parameters) - ahead.tau) ** 2))
