"""Robots recorded in a control loop, in simulation: the controller sees the noise that is in the recording."""

import functools
from dataclasses import dataclass, replace

import numpy as np
from identified import torque_data

import graphdyn
from crosscheck.recordings import Recording
from graphdyn.identification import ClosedLoop, Samples, TorqueModel
from graphdyn.identification.terms import Coulomb, RigidBodies, RotorInertia, Viscous
from graphdyn.motion_laws import FourierSeries

DEGREE = np.pi / 180


@dataclass(frozen=True, eq=False)
class LoopRun:
    """A torque model with the true parameters (p,), the loop, and the recording: time, q and τ as measured (N, n).

    exact: without noise, q, v, a, τ at the same instants
    """

    torque_model: TorqueModel
    truth: np.ndarray
    loop: ClosedLoop
    time: np.ndarray
    q: np.ndarray
    tau: np.ndarray
    exact: Samples

    def prepared(self, preparation):
        """The problem of the measured recording, and the loop with all that was done to it."""
        names = self.torque_model.model.joint_names
        recording = Recording(names, self.time, self.q, tau=self.tau)
        problem = preparation.problem(self.torque_model, preparation.differentiated(recording))
        differentiation = preparation.differentiation(recording)
        loop = replace(self.loop, torque_hold=preparation.torque_hold, differentiation=differentiation)
        return problem, loop


@dataclass(frozen=True, eq=False)
class Plant:
    """A robot with drives, its controller and its reference.

    start: time of the recording at the beginning [s]
    """

    model: graphdyn.RobotModel
    friction: graphdyn.Friction
    rotors: np.ndarray
    position_gain: np.ndarray
    velocity_gain: np.ndarray
    laws: tuple
    start: float = 0.0

    @property
    def torque_model(self):
        return TorqueModel(self.model, (RigidBodies(), Viscous(), Coulomb(), RotorInertia()))

    @property
    def truth(self):
        drives = (self.friction.viscous, self.friction.coulomb, self.rotors)
        return np.concatenate([self.model.inertial_parameters, *drives])

    def controller(self, control_period, later=0.0):
        def shifted(law):
            return lambda times: law(times - later)

        return graphdyn.PDControl(
            self.position_gain, self.velocity_gain, [shifted(law) for law in self.laws], period=control_period
        )

    def record(self, seconds, *, position=0.0, velocity=0.0, torque=0.0, seed=0, period=1e-3, control_period=1e-3):
        """position, velocity, torque: standard deviations of the noise [rad, rad/s, N m]."""
        n = self.model.n_bodies
        q, v = (np.array([law(np.zeros(1))[k][0] for law in self.laws]) for k in range(2))
        every = round(period / control_period)
        run = graphdyn.rollout(
            self.model,
            q,
            v,
            self.controller(control_period),
            step=control_period,
            duration=seconds,
            friction=self.friction,
            rotor_inertia=self.rotors,
            noise=graphdyn.MeasurementNoise(position, velocity),
            seed=seed,
            every=every,
        )
        seen = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(0,)))
        ticks = round(seconds / control_period) + 1
        measured = run.q[0] + position * seen.standard_normal((ticks, 2 * n))[::every, :n]
        tau = run.tau[0] + torque * np.random.default_rng(seed + 1).normal(size=run.tau[0].shape)
        exact = Samples(run.q[0], run.v[0], run.a[0], run.tau[0], time=run.time + self.start)
        loop = ClosedLoop(self.controller(control_period, self.start))
        return LoopRun(self.torque_model, self.truth, loop, run.time + self.start, measured, tau, exact)


def ur5(seed=0):
    """The arm of Leboutet et al. 2021 with friction of its size and rotors; its motion is new for every seed."""
    import urdf

    return Plant(
        urdf.load("ur5"),
        graphdyn.Friction([14.0, 14.0, 8.0, 3.0, 2.5, 2.0], [9.0, 9.0, 6.0, 2.0, 2.0, 1.8]),
        np.array([1.2, 1.2, 0.6, 0.2, 0.2, 0.15]),
        np.array([4000.0, 4000.0, 2000.0, 600.0, 600.0, 400.0]),
        np.array([300.0, 300.0, 150.0, 40.0, 40.0, 25.0]),
        tuple(_laws(np.random.default_rng(seed), 6, 0.1, 5, 2.2, 2.0, [0.0, -1.2, 0.0, 0.0, 0.0, 0.0])),
    )


@functools.cache
def two_axes():
    """The first two axes of a big arm, recorded from second 3 on."""
    model = torque_data.small_arm().model
    return Plant(
        model,
        graphdyn.Friction([20.0, 15.0], [30.0, 25.0]),
        np.array([5.0, 4.0]),
        np.array([2e4, 2e4]),
        np.array([2e3, 2e3]),
        tuple(_laws(np.random.default_rng(4), 2, 0.25, 4, 1.5, 3.0, [0.0, 0.0])),
        start=3.0,
    )


def _laws(rng, joints, frequency, harmonics, reach, speed, middle):
    """Fourier series within a reach [rad] and a speed [rad/s]."""
    times = np.linspace(0, 1 / frequency, 2001)
    for j in range(joints):
        a, b = rng.normal(size=(2, harmonics))
        q, v, _ = FourierSeries(frequency, a, b)(times)
        scale = min(reach / np.ptp(q), speed / np.abs(v).max())
        offset = middle[j] - scale * (q.max() + q.min()) / 2
        yield FourierSeries(frequency, scale * a, scale * b, offset)
