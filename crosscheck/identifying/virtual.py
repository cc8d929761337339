"""Virtual recordings of a robot with known parameters: excitation, friction, noise, and wrong CAD values.

They have everything that real recordings have, and true parameters to compare with.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np

from crosscheck.recordings import Provenance, Recording, recording_of, samples_of
from crosscheck.reference.subject import IDENTIFY_CLOSED, Robot, Subject, refuse_chords, subject
from graphdyn import InvalidInput, RobotModel
from graphdyn import simulate_recording as virtual_experiment
from graphdyn.display import short_repr
from graphdyn.identification import Samples, TorqueModel
from graphdyn.identification.terms import RigidBodies, Term
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.motion_laws import FourierSeries
from urdf import Reading, ReadingKeywords

FREQUENCY, HARMONICS = 0.1, 5
"""Fundamental frequency of the excitation [Hz], and number of its harmonics."""

LIMIT_SHARE = 0.9
"""Fraction of the limits of position and speed that the motion uses."""

MAX_SPEED = 3.0
"""Speed limit if the robot's is missing or higher [rad/s or m/s]: torques are then those of an arm."""

VIRTUAL_RATE = 250.0
"""Sampling rate of the virtual recordings [Hz]."""

ENCODER_NOISE, TORQUE_NOISE = 2e-5, 0.01
"""Standard deviation of positions [rad or m], and of torques and wrenches as a part of their root mean square."""

DRIVE_TORQUE_SHARE = 0.05
"""Root mean square of the torque of each drive parameter, relative to that of the joint's torque."""

SCALE_ROWS, ROWS_PER_PIECE = 2000, 512
"""Number of rows from which the size of torques is found; number of rows whose regressor is in memory at once."""

CAD_ERROR = 0.2
"""Largest relative error of the masses of the CAD model, and of its centers of mass relative to their distance."""


@dataclass(frozen=True, eq=False)
@short_repr
class VirtualRobot:
    """A virtual robot with known parameters, and its recordings.

    subject: the robot with wrong inertial parameters, as from CAD
    truth: parameters of the torque model, bodies first     (p,)
    fitted, held_out: recordings with different motions
    torque_model: the terms with the wrong bodies as the prior
    """

    subject: Subject
    torque_model: TorqueModel
    truth: Array
    fitted: Recording
    held_out: Recording


def virtual_robot(
    robot: Robot,
    terms: Sequence[Term],
    *,
    seconds: float = 20.0,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
    **reading: Unpack[ReadingKeywords],
) -> VirtualRobot:
    """Record a robot of known parameters twice; the second recording is half as long.

    terms: torque of its drives, added to that of the rigid bodies
    progress: called with the name of the next step, twice
    Raises InvalidInput for a robot without mass or with couplings, and for less than one period of the motion.
    """
    given = subject(robot, Reading.of(virtual_robot, reading))
    refuse_chords(given.model, IDENTIFY_CLOSED)
    if not seconds >= 1 / FREQUENCY:
        raise InvalidInput(f"{seconds:g} s are less than one period of the excitation; give {1 / FREQUENCY:g} or more")
    if not any(body.mass > 0 for body in given.model.bodies):
        raise InvalidInput(f"robot '{given.name}' has no mass: there is nothing to identify")
    if given.model.couplings:
        raise InvalidInput(f"robot '{given.name}' has couplings: give recordings, or RobotModel.uncoupled")
    rng = np.random.default_rng(seed)
    true_model = TorqueModel(given.model, (RigidBodies(), *terms))
    say = progress or (lambda what: None)
    motions = []
    for number, time in enumerate((seconds, seconds / 2), start=1):
        say(f"motion {number}")
        motions.append(_motion(given.model, rng, time))
    (samples,) = samples_of(motions[0])
    truth = true_parameters(true_model, samples, rng)
    recordings = [
        _measured(true_model, truth, motion, rng, f"simulated motion {number} of {given.model.name}")
        for number, motion in enumerate(motions, start=1)
    ]
    wrong = replace(given, model=as_in_cad(given.model, rng))
    return VirtualRobot(wrong, TorqueModel(wrong.model, true_model.terms), truth, *recordings)


def _motion(model: RobotModel, rng: np.random.Generator, seconds: float) -> Recording:
    """Exact motion, torques and wrenches of the rigid bodies."""
    dense = np.linspace(0, 1 / FREQUENCY, 1000)
    corner = model.random_state(rng, 1000)
    laws = []
    for j in range(model.n_bodies):
        lower, upper = corner[0][:, j].min(), corner[0][:, j].max()
        speed = min(float(np.abs(corner[1][:, j]).max()), MAX_SPEED)
        a, b = rng.normal(size=(2, HARMONICS))
        q, v, _ = FourierSeries(FREQUENCY, a, b)(dense)
        scale = LIMIT_SHARE * min((upper - lower) / np.ptp(q), speed / np.abs(v).max())
        middle = (upper + lower) / 2 - scale * (q.max() + q.min()) / 2
        laws.append(FourierSeries(FREQUENCY, scale * a, scale * b, middle))
    times = np.arange(round(seconds * VIRTUAL_RATE)) / VIRTUAL_RATE
    return recording_of(virtual_experiment(model, times, laws))


def true_parameters(
    torque_model: TorqueModel, motion: Samples, rng: np.random.Generator, share: float = DRIVE_TORQUE_SHARE
) -> Array:
    """The bodies of the model, and drive parameters whose torques are this share of their joint's, randomly ±50 %."""
    samples = motion[:: -(-len(motion) // SCALE_ROWS)]
    size = np.sqrt(np.mean(samples.tau**2, axis=0))
    columns = np.sqrt(np.mean(torque_model.rows(samples) ** 2, axis=0))
    x = torque_model.prior()
    for k in range(BODY_PARAMETERS * torque_model.model.n_bodies, len(x)):
        joint = int(np.argmax(columns[:, k] / np.where(size > 0, size, np.inf)))
        part = rng.uniform(0.5, 1.5)
        if columns[joint, k] > 0:  # else its joint does not move, or carries nothing
            x[k] = share * part * size[joint] / columns[joint, k]
    return x


def _measured(
    torque_model: TorqueModel, truth: Array, motion: Recording, rng: np.random.Generator, name: str
) -> Recording:
    """The motion as measured: with friction and noise, without velocities and accelerations."""
    (exact,) = samples_of(motion)
    length = len(exact) if torque_model.has_memory else ROWS_PER_PIECE
    tau = np.concatenate([torque_model.torque(piece, truth) for piece in exact.pieces(length)])
    wrenches = motion.channel("joint_wrenches")

    def noisy(values: Array) -> Array:
        size = np.sqrt(np.mean(values**2, axis=0))
        return np.asarray(values + TORQUE_NOISE * size * rng.normal(size=values.shape))

    return replace(
        motion,
        q=exact.q + ENCODER_NOISE * rng.normal(size=exact.q.shape),
        v=None,
        a=None,
        tau=noisy(tau),
        joint_wrenches=noisy(wrenches),
        body_accelerations=None,
        provenance=Provenance((name,), "virtual experiment"),
    )


def as_in_cad(model: RobotModel, rng: np.random.Generator, error: float = CAD_ERROR) -> RobotModel:
    """The model with wrong but physically consistent bodies: other masses, centers of mass moved.

    error: largest relative one, below 1, of the masses, and of the centers of mass relative to their distance
    """
    bodies = []
    for body in model.bodies:
        factor = rng.uniform(1 - error, 1 + error)
        shift = error * np.linalg.norm(body.center_of_mass) * rng.uniform(-1, 1, 3) / np.sqrt(3)
        center = body.center_of_mass + shift
        bodies.append(replace(body, mass=factor * body.mass, center_of_mass=center, inertia=factor * body.inertia))
    return replace(model, bodies=tuple(bodies))
