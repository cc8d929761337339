"""Faults of columns: signs, exchanges, gear ratios, zeros, degrees, velocities, and a coupled wrist."""

import numpy as np
from identified.spoilt_recordings.case import with_velocity
from identified.spoilt_recordings.faults.fault import Fault


def multiplied(case, position=None, torque=None, velocity=None):
    """The case with its columns multiplied by matrices (n, n). velocity: None as position"""
    columns, recording, arrays = case.file_columns, case.recording, {}
    velocity = position if velocity is None else velocity

    def conjugated(change, to_joints):
        return (to_joints @ change @ np.linalg.inv(to_joints)).T

    if position is not None:
        turned = (recording.q - columns.zero) @ conjugated(position, columns.position)
        arrays["q"] = turned + columns.zero
    if velocity is not None and recording.v is not None:
        arrays["v"] = recording.v @ conjugated(velocity, columns.position)
    if torque is not None:
        arrays["tau"] = recording.tau @ conjugated(torque, columns.torque)
    return case.changed(**arrays)


def scaling(n, j, factor):
    matrix = np.eye(n)
    matrix[j, j] = factor
    return matrix


def exchange(n, i, j):
    order = np.arange(n)
    order[[i, j]] = j, i
    return np.eye(n)[order]


def _columns(of, label, why, joints, matrices, **more):
    """matrices: names of `multiplied` with functions of n."""

    def spoil(case):
        return multiplied(case, **{name: matrix(case.n) for name, matrix in matrices.items()})

    def undo(case):
        return multiplied(case, **{name: np.linalg.inv(matrix(case.n)) for name, matrix in matrices.items()})

    return Fault(of, label, why, spoil, undo, joints, **more)


def reversed_torque(j):
    why = "the motor counts the other way than its current"
    matrices = {"torque": lambda n: scaling(n, j, -1.0)}
    return _columns("sign of a torque", f"tau{j + 1} reversed", why, (j,), matrices)


def reversed_position(j):
    why = "the encoder counts the other way than the axis of the model"
    matrices = {"position": lambda n: scaling(n, j, -1.0)}
    return _columns("sign of a position", f"q{j + 1} reversed", why, (j,), matrices)


def reversed_joint(j):
    why = "the axis of the model points the other way"
    matrices = dict.fromkeys(("position", "torque"), lambda n: scaling(n, j, -1.0))
    return _columns("sign of a joint", f"joint {j + 1} reversed", why, (j,), matrices)


def exchanged(i, j, what):
    why = "the columns are in another order than the joints"
    names = {"q": ("position",), "tau": ("torque",), "joints": ("position", "torque")}[what]
    matrices = dict.fromkeys(names, lambda n: exchange(n, i, j))
    return _columns("exchange", f"{what} {i + 1}, {j + 1} exchanged", why, (i, j), matrices)


def gear(j, factor):
    """Ratio of a gear too small by a factor: the joint seems to move further, with less torque."""
    why = "another ratio of the gear than that in the drive, in position and torque"
    matrices = {"position": lambda n: scaling(n, j, factor), "torque": lambda n: scaling(n, j, 1 / factor)}
    return _columns("gear ratio", f"gear {j + 1} wrong by {factor:.4g}", why, (j,), matrices)


def position_gear(j, factor):
    why = "another ratio of the gear for the encoder; the torque is measured at the joint"
    matrices = {"position": lambda n: scaling(n, j, factor)}
    return _columns("gear ratio", f"q{j + 1} times {factor:.4g}", why, (j,), matrices)


def torque_gear(j, factor):
    why = "another ratio of the gear, or torque constant, for the torque alone"
    matrices = {"torque": lambda n: scaling(n, j, factor)}
    return _columns("torque scale", f"tau{j + 1} times {factor:.4g}", why, (j,), matrices)


def degrees(j):
    why = "one controller writes degrees, the others radians"
    matrices = {"position": lambda n: scaling(n, j, 180 / np.pi)}
    return _columns("degrees", f"q{j + 1} in degrees", why, (j,), matrices)


def zero(j, angle):
    """angle: of the joint of the model where the recording says 0 [°], wrong by this much."""

    def moved(by):
        def change(case):
            q = np.array(case.recording.q)
            q[:, j] += np.deg2rad(by)
            return case.changed(q=q)

        return change

    why = "the encoder was set to zero in another pose than that of the model"
    return Fault("zero", f"zero of q{j + 1} off by {angle:.4g}°", why, moved(angle), moved(-angle), (j,))


def coupled_wrist(factor=1.0, *, torque=False):
    """The last motor turns with the joint before it, and the file holds motor angles divided by the ratio."""

    def positions(n):
        matrix = np.eye(n)
        matrix[n - 1, n - 2] = factor
        return matrix

    why = "joint 5 also turns motor 6, and nobody has subtracted it"
    matrices = {"position": positions}
    if torque:
        matrices["torque"] = lambda n: np.linalg.inv(positions(n)).T
    label = f"q6 plus {factor:g} q5" + (", torques likewise" if torque else "")
    return _columns("coupled wrist", label, why, (4, 5), matrices)


def scaled_velocity(j, factor):
    why = "the velocity is in another unit or filtered by a wrong gain, the position is right"
    matrices = {"velocity": lambda n: scaling(n, j, factor)}
    return _columns("velocity", f"v{j + 1} times {factor:.4g}", why, (j,), matrices, base=with_velocity)


def exchanged_velocities(i, j):
    why = "the velocities are in another order than the positions"
    matrices = {"velocity": lambda n: exchange(n, i, j)}
    return _columns("velocity", f"v {i + 1}, {j + 1} exchanged", why, (i, j), matrices, base=with_velocity)


def copied_velocity(i, onto):
    def spoil(case):
        v = np.array(case.recording.v)
        v[:, onto] = v[:, i]
        return case.changed(v=v)

    why = "one velocity column was named twice"
    return Fault("velocity", f"v{i + 1} given for v{onto + 1}", why, spoil, None, (onto,), with_velocity)
