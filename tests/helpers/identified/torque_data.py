"""Simulated torques of a six-axis arm with friction, offset, rotor inertia and a coupled wrist."""

import functools

import numpy as np

import graphdyn
from graphdyn.identification import Problem, Samples, TorqueModel
from graphdyn.identification.terms import Coulomb, CoupledWrist, Offset, RigidBodies, RotorInertia, Viscous
from graphdyn.motion_laws import FourierSeries

DRIVES = (Viscous(), Coulomb(), Offset(), RotorInertia(), CoupledWrist())
PARAMETERS = 87
RANK = 61
"""36 rigid, 27 of the drives, of which the rotor inertias of axes 1 and 2 fold into the bodies."""

NOISE = np.array([3.0, 8.0, 4.0, 1.0, 2.0, 0.5])
"""[N m], a different one per joint."""


@functools.cache
def robot():
    """The geometry of the KR500 with random bodies: no parameter is zero by accident."""
    rng = np.random.default_rng(0)
    bodies = []
    for k in range(6):
        root = rng.normal(size=(3, 3))
        moments = root @ root.T + np.eye(3)  # second moments of mass: any positive matrix is that of a real body
        center, inertia = rng.normal(size=3) * 0.2, np.trace(moments) * np.eye(3) - moments
        bodies.append(graphdyn.Body(f"B{k + 1}", rng.uniform(5, 50), center, inertia))
    plain = graphdyn.kr500()
    return graphdyn.RobotModel("arm", tuple(bodies), plain.joints)


@functools.cache
def torque_model():
    return TorqueModel(robot(), (RigidBodies(), *DRIVES))


@functools.cache
def true_parameters():
    """Bodies up to 30 % heavier or lighter than the model's, drives of some N m."""
    rng = np.random.default_rng(1)
    x = torque_model().prior()
    x[:60] *= np.repeat(rng.uniform(0.7, 1.3, 6), 10)
    x[60:] = rng.uniform(1.0, 5.0, PARAMETERS - 60)
    return x


@functools.cache
def exact_samples(size=600, seed=2):
    """An exciting motion, derivatives exact, torques without noise."""
    rng = np.random.default_rng(seed)
    laws = [FourierSeries(frequency=0.1, a=rng.normal(size=5) * 0.3, b=rng.normal(size=5) * 0.3) for _ in range(6)]
    motion = graphdyn.simulate_recording(robot(), np.linspace(0.0, 10.0, size), laws)
    samples = Samples(motion.q, motion.v, motion.a, motion.tau)
    return Samples(motion.q, motion.v, motion.a, torque_model().torque(samples, true_parameters()))


def noisy_samples(seed=3, size=600):
    exact = exact_samples(size)
    noise = np.random.default_rng(seed).normal(size=exact.tau.shape) * NOISE
    return Samples(exact.q, exact.v, exact.a, exact.tau + noise)


def exact_problem(**options):
    return Problem(torque_model(), exact_samples(), **options)


def noisy_problem(seed=3, **options):
    return Problem(torque_model(), noisy_samples(seed), **options)


@functools.cache
def small_arm():
    """The first two axes, with friction: 12 base parameters."""
    arm = robot()
    return TorqueModel(
        graphdyn.RobotModel("small", arm.bodies[:2], arm.joints[:2]), (RigidBodies(), Viscous(), Coulomb())
    )


@functools.cache
def small_samples(size=120):
    """Exact torques of the small arm."""
    model, rng = small_arm(), np.random.default_rng(4)
    laws = [FourierSeries(frequency=0.2, a=rng.normal(size=4) * 0.3, b=rng.normal(size=4) * 0.3) for _ in range(2)]
    motion = graphdyn.simulate_recording(model.model, np.linspace(0.0, 5.0, size), laws)
    samples = Samples(motion.q, motion.v, motion.a, motion.tau)
    return Samples(motion.q, motion.v, motion.a, model.torque(samples, small_parameters()))


@functools.cache
def small_parameters():
    x = small_arm().prior()
    x[20:] = [20.0, 15.0, 30.0, 25.0]
    return x


def small_problem(noise, **options):
    exact = small_samples()
    return Problem(small_arm(), Samples(exact.q, exact.v, exact.a, exact.tau + noise), **options)
