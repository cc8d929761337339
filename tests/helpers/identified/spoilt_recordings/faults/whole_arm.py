"""Faults of the whole arm: mounting and size of gravity, and the time scale."""

from dataclasses import replace

import numpy as np
from identified.spoilt_recordings.case import with_velocity, without_velocity
from identified.spoilt_recordings.faults.fault import Fault
from scipy.spatial.transform import Rotation


def _gravity(label, why, change, back):
    def turned(how):
        return lambda case: replace(case, model=case.model.with_gravity(how(case.model.gravity)))

    return Fault("gravity", label, why, turned(change), turned(back))


def tilted(angle, azimuth):
    """The arm is mounted upright, and the model tilted by an angle about a horizontal axis at an azimuth [°]."""
    axis = np.array([np.cos(np.deg2rad(azimuth)), np.sin(np.deg2rad(azimuth)), 0.0])
    turn = Rotation.from_rotvec(np.deg2rad(angle) * axis)
    why = "the base of the model is mounted otherwise than the arm"
    label = f"base tilted by {angle:.4g}° about {azimuth:.4g}°"
    return _gravity(label, why, lambda g: turn.as_matrix() @ g, lambda g: turn.as_matrix().T @ g)


def scaled_gravity(factor, unit):
    """The model's gravity is in another unit."""
    why = f"gravity of the model is in {unit}"
    label = f"gravity in {unit}"
    return _gravity(label, why, lambda g: g * factor, lambda g: g / factor)


def stretched(factor):
    """The time runs slower or faster in the file; velocities come from positions."""

    def times(by):
        return lambda case: case.changed(t=case.recording.t[0] + by * (case.recording.t - case.recording.t[0]))

    why = "the rate of the log is not that which the user states"
    label = f"time times {factor:.4g}"
    return Fault("time scale", label, why, times(factor), times(1 / factor), base=without_velocity)


def stretched_beside_velocities(factor):
    fault = stretched(factor)
    why = "the rate of the log is not that which the user states; velocities come from the drive"
    label = f"{fault.label}, v right"
    return replace(fault, of="time scale beside velocities", label=label, why=why, base=with_velocity)
