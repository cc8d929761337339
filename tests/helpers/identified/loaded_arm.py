"""A simulated arm whose currents are recorded with and without loads, its gains planted."""

import csv
import functools
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

import graphdyn
import urdf
from crosscheck.recordings import Recording
from graphdyn.identification import Problem, Samples, TorqueModel
from graphdyn.identification.currents import LoadedRecording
from graphdyn.identification.terms import Coulomb, Offset, RigidBodies, Viscous
from graphdyn.layout import BODY_PARAMETERS
from graphdyn.model import parameters_from_inertia
from graphdyn.motion_laws import FourierSeries

RATE = 50.0
"""[Hz]"""

FREQUENCY, AMPLITUDE = 0.1, 0.3
"""Fundamental frequency [Hz] and amplitudes of speeds of the motions [rad/s]."""

RESIDUAL, DECAY = 0.05, 0.7
"""Residual of the currents relative to their root mean square, and its correlation from row to row."""

WANTED = parameters_from_inertia(2.8, np.array([0.02, -0.01, 0.08]), np.diag([0.01, 0.012, 0.008]))
"""The load to be found, in the frame of the last link (10,)."""

WEIGHED = parameters_from_inertia(4.0, np.array([-0.01, 0.01, 0.1]), np.diag([0.02, 0.02, 0.01]))
"""The load whose mass is known (10,)."""


@dataclass(frozen=True)
class LoadedArm:
    """An arm with friction, and its motions.

    links: true inertial parameters (10 n,)
    """

    torque_model: TorqueModel
    truth: np.ndarray

    @classmethod
    def of(cls, model, rng, cad_error=0.0):
        """The links of the model, each wrong by this relative error; friction of some N m."""
        torque_model = torque_model_of(model)
        truth = torque_model.prior()
        links = BODY_PARAMETERS * model.n_bodies
        truth[:links] = np.concatenate([_other_body(body, rng, cad_error) for body in model.bodies])
        truth[links:] = rng.uniform(1.0, 5.0, len(truth) - links)
        return cls(torque_model, truth)

    def motion(self, rng, seconds, load=None, *, amplitude=AMPLITUDE):
        """A random motion, with exact torques: samples."""
        model = self.torque_model.model
        laws = [
            FourierSeries(FREQUENCY, *amplitude * rng.normal(size=(2, 5)), rng.uniform(-1.0, 1.0)) for _ in model.joints
        ]
        moved = graphdyn.simulate_recording(model, np.arange(0, seconds, 1 / RATE), laws)
        samples = Samples(moved.q, moved.v, moved.a, moved.tau)
        x = self.truth.copy()
        if load is not None:
            x[BODY_PARAMETERS * (model.n_bodies - 1) : BODY_PARAMETERS * model.n_bodies] += load
        return Samples(moved.q, moved.v, moved.a, self.torque_model.torque(samples, x))

    def recorded(self, samples, gains, rng, name=None, residual=RESIDUAL):
        """Currents with noise, as compressed equations."""
        noisy = currents(samples, gains, rng, residual)
        return LoadedRecording(Problem(self.torque_model, noisy).recorded, name)


def currents(samples, gains, rng, residual=RESIDUAL):
    """The samples with currents in place of torques, with a residual that is correlated in time."""
    size = residual * np.sqrt(np.mean(samples.tau**2, axis=0))
    noise = rng.normal(size=samples.tau.shape)
    noise[1:] *= np.sqrt(1 - DECAY**2)
    tau = samples.tau + size * lfilter([1.0], [1.0, -DECAY], noise, axis=0)
    return Samples(samples.q, samples.v, samples.a, tau / gains)


def recording(samples, joints, name):
    """The samples as a recording."""
    from crosscheck.recordings import Provenance

    t = np.arange(len(samples.q)) / RATE
    return Recording(joints, t, samples.q, samples.v, samples.a, samples.tau, provenance=Provenance((name,)))


def write_log(path, samples, joints, torque="tau_{} [N m]"):
    """The samples as a CSV file, without velocities. torque: name of a column, with {} for the joint"""
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(["t [s]", *(f"q_{joint} [rad]" for joint in joints), *map(torque.format, joints)])
        for k, (q, tau) in enumerate(zip(samples.q.tolist(), samples.tau.tolist(), strict=True)):
            rows.writerow([k / RATE, *q, *tau])


@functools.cache
def torque_model_of(model):
    """Links and friction; one for each model, because its structure is cached."""
    return TorqueModel(model, (RigidBodies(), Viscous(), Coulomb(), Offset()))


@functools.cache
def robot(name="ur5"):
    return urdf.load(name)


def random_gains(rng, n):
    """Gains between 4 and 27."""
    return 10.0 * np.exp(rng.uniform(-1.0, 1.0, n))


def _other_body(body, rng, error):
    """Ten parameters: mass and center of mass with independent errors, as TrustedGravity assumes them."""
    center = body.center_of_mass
    center = center + error * np.linalg.norm(center) / np.sqrt(3) * rng.normal(size=3)
    factor = 1 + error * rng.normal()
    return parameters_from_inertia(factor * body.mass, center, factor * body.inertia)
