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
        bodies.append(
            graphdyn.Body(f"B{k + 1}", rng.uniform(5, 50), rng.normal(size=3) * 0.2, root @ root.T + np.eye(3))
        )
    plain = graphdyn.kr500()
    return graphdyn.RobotModel("arm", tuple(bodies), plain.joints)


@functools.cache
def torque_model():
    return TorqueModel(robot(), (RigidBodies(), *DRIVES))


@functools.cache
def true_parameters():
    x = torque_model().prior()
    x[60:] = np.random.default_rng(1).uniform(1.0, 5.0, PARAMETERS - 60)
    return x


@functools.cache
def exact_samples(size=600, seed=2):
    """An exciting motion, derivatives exact, torques without noise."""
    rng = np.random.default_rng(seed)
    laws = [FourierSeries(frequency=0.1, a=rng.normal(size=5) * 0.3, b=rng.normal(size=5) * 0.3) for _ in range(6)]
    motion = graphdyn.record(robot(), np.linspace(0.0, 10.0, size), laws)
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
