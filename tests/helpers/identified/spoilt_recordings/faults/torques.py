"""Faults of the torque: subtracted parts, outputs of models, drifts, loads, filters, delays and noise."""

from dataclasses import replace

import numpy as np
from identified.spoilt_recordings.faults.fault import Fault

from graphdyn.identification.terms import Offset, PayloadMass

LOAD_ARM = 0.1
"""Distance of the load from the axis of the last joint, and along it [m]."""

BY_CONSTRUCTION = "a torque without any error of measurement is no measurement"


def _added(of, label, why, torque, joints=(), **more):
    """torque: of the right case, added to that of the recording."""

    def spoil(case):
        return case.changed(tau=case.recording.tau + torque(case))

    return Fault(of, label, why, spoil, None, joints, adds=True, **more)


def _ramp(case):
    """From 0 at the first row to 1 at the last (N, 1)."""
    return np.linspace(0.0, 1.0, len(case.recording.t))[:, None]


def _of_joint(case, torque, j):
    return torque if j is None else torque * np.eye(case.n)[j]


def _drives(case):
    """Columns of the drives without their offsets."""
    offset = case.torque_model.slice_of(Offset)
    own = case.columns_of(bodies=False)
    return own if offset is None else np.setdiff1d(own, np.arange(offset.start, offset.stop))


def gravity_subtracted(whose):
    """whose: "CAD" or "fit", the parameters of the bodies whose gravity is missing."""

    def gravity(case):
        x = case.torque_model.prior() if whose == "CAD" else case.parameters
        return -case.torque_of(x, case.columns_of(bodies=True), at_rest=True)

    why = "the controller writes the torque beyond that of gravity"
    return _added("gravity subtracted", f"gravity by {whose} subtracted", why, gravity)


def friction_subtracted(share, j=None):
    def friction(case):
        return -share * _of_joint(case, case.torque_of(case.parameters, _drives(case)), j)

    who = "" if j is None else f" of joint {j + 1}"
    why = "the controller compensates friction behind the measurement"
    label = f"{100 * share:.0f} % of the friction{who} subtracted"
    return _added("friction subtracted", label, why, friction, () if j is None else (j,))


def model_torque(whose, j=None):
    """whose: "CAD", "CAD with friction" or "fit"; j: of one joint alone."""

    def spoil(case):
        x = case.torque_model.prior() if whose.startswith("CAD") else np.array(case.parameters)
        if whose == "CAD with friction":
            drives = case.columns_of(bodies=False)
            x[drives] = case.parameters[drives]
        output = case.torque_of(x) + case.known_torque()
        t, moved = case.recording.t, case.motion[0]
        known = ((t >= moved[0]) & (t <= moved[-1]))[:, None]  # the preparation cuts both ends off
        tau = np.where(known & ((j is None) | (np.arange(case.n) == j)), output, case.recording.tau)
        return case.changed(tau=tau)

    who = "" if j is None else f" of joint {j + 1}"
    why = "the column holds what a model says, as a feedforward or a simulation does"
    return Fault(
        "model's torque",
        f"torque{who} is the output of {whose}",
        why,
        spoil,
        None,
        () if j is None else (j,),
        shows=BY_CONSTRUCTION,
    )


def friction_drift(share, j=None):
    """Friction that grows, or falls, by this share from the first row to the last."""

    def friction(case):
        return share * _ramp(case) * _of_joint(case, case.torque_of(case.parameters, _drives(case)), j)

    who = "" if j is None else f" of joint {j + 1}"
    why = "the gears warm up or cool down"
    return _added("drift", f"friction{who} drifts by {100 * share:+.0f} %", why, friction, () if j is None else (j,))


def gain_drift(share, j=None):
    def factor(case):
        return 1 + share * _of_joint(case, _ramp(case) * np.ones(case.n), j)

    def spoil(case):
        return case.changed(tau=case.recording.tau * factor(case))

    def undo(case):
        return case.changed(tau=case.recording.tau / factor(case))

    who = "all torques" if j is None else f"tau{j + 1}"
    why = "magnets and amplifiers change with their temperature"
    label = f"gain of {who} drifts by {100 * share:+.0f} %"
    return Fault("drift", label, why, spoil, undo, () if j is None else (j,))


def gain_step(share, j):
    """The gain changes in the middle."""

    def factor(case):
        return 1 + share * (_ramp(case) > 0.5) * np.eye(case.n)[j]

    why = "the drive was exchanged, or its current limit reset"
    label = f"gain of tau{j + 1} jumps by {100 * share:+.0f} %"
    return Fault(
        "step",
        label,
        why,
        lambda case: case.changed(tau=case.recording.tau * factor(case)),
        lambda case: case.changed(tau=case.recording.tau / factor(case)),
        (j,),
    )


def offset_step(share, j):
    """share: of the range of the torque."""

    def step(case):
        return share * np.ptp(case.recording.tau, axis=0)[j] * (_ramp(case) > 0.5) * np.eye(case.n)[j]

    why = "the zero of the current sensor was set again"
    return _added("step", f"offset of tau{j + 1} jumps by {100 * share:.0f} % of its range", why, step, (j,))


def payload(share, start=0.5):
    """A load of a share of the mass of the arm, held from a share of the recording on."""

    def torque(case):
        center = np.cross(case.model.joints[-1].axis, [0.6, 0.8, 0.3])
        center = LOAD_ARM * (center / np.linalg.norm(center) + np.asarray(case.model.joints[-1].axis))
        loaded = replace(case, terms=(PayloadMass(center),), known=())
        mass = share * sum(body.mass for body in case.model.bodies)
        return loaded.torque_of(np.array([mass])) * (_ramp(case) > start)

    why = "a part was gripped while the log ran"
    label = f"load of {100 * share:.3g} % of the arm from {100 * start:.0f} % on"
    return _added("payload change", label, why, torque)


def lowpassed(cutoff):
    """A first-order filter, forward in time [Hz]."""

    def spoil(case):
        t, tau = case.recording.t, case.recording.tau
        share = 1 - np.exp(-2 * np.pi * cutoff * np.gradient(t))
        filtered = np.array(tau)
        for k in range(1, len(t)):
            filtered[k] = filtered[k - 1] + share[k] * (tau[k] - filtered[k - 1])
        return case.changed(tau=filtered)

    why = "the drive filters the current that it shows"
    return Fault("filtered torque", f"torque through a low-pass of {cutoff:g} Hz", why, spoil)


def delayed(seconds, j=None):
    def spoil(case):
        t = case.recording.t
        late = np.column_stack([np.interp(t - seconds, t, column) for column in case.recording.tau.T])
        return case.changed(tau=late if j is None else np.where(np.arange(case.n) == j, late, case.recording.tau))

    who = "tau" if j is None else f"tau{j + 1}"
    why = "the torque comes over another bus than the position"
    return Fault("delay", f"{who} {1e3 * seconds:.0f} ms late", why, spoil, None, () if j is None else (j,))


def noise(factor):
    """White noise, in multiples of the residual of the bounded fit."""

    def added(case):
        size = factor * case.errors * np.sqrt(np.mean(case.recording.tau**2, axis=0))
        return size * np.random.default_rng(7).normal(size=case.recording.tau.shape)

    why = "a bad sensor or cable; results are right and less certain"
    return _added("noise", f"noise of {factor:g} residuals", why, added, judged=False)


def quantized(share, j=None):
    """Torques in steps of a share of their range."""

    def spoil(case):
        tau = case.recording.tau
        step = share * np.ptp(tau, axis=0)
        rounded = step * np.round(tau / step)
        return case.changed(tau=rounded if j is None else np.where(np.arange(case.n) == j, rounded, tau))

    who = "tau" if j is None else f"tau{j + 1}"
    why = "few bits of a converter, or few digits in the file"
    label = f"{who} in steps of {100 * share:g} % of its range"
    return Fault("quantized torque", label, why, spoil, None, () if j is None else (j,), judged=False)
