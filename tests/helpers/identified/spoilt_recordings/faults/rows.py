"""Faults of rows: repeated and missing ones, dead channels, clipped values."""

import numpy as np
from identified.spoilt_recordings.case import with_velocity, without_velocity
from identified.spoilt_recordings.faults.fault import Fault

REPEATED = "rows that repeat are no further measurements, and every deviation is too small"
DEAD = "the channel holds no measurement there"
CLIPPED = "values at the end of the range are bounds, not measurements"


def _rows(case, index, t):
    """The rows of an index, at other times."""
    return case.changed(
        t=t,
        q=case.recording.q[index],
        v=None if case.recording.v is None else case.recording.v[index],
        a=None,
        tau=case.recording.tau[index],
        joint_wrenches=None,
        temperature=None,
        block=None,
        rows=None,
        file=None,
        torque_cutoff=None,
    )


def _even(case, count):
    """Times of so many rows at the period of the recording."""
    t = case.recording.t
    return t[0] + np.median(np.diff(t)) * np.arange(count)


def doubled_rows(times=2):
    """Every row several times, between the right times."""

    def spoil(case):
        t, count = case.recording.t, len(case.recording.t)
        finer = np.interp(np.arange(times * count) / times, np.arange(count), t)
        finer[(count - 1) * times :] = t[-1] + np.median(np.diff(t)) * np.arange(times) / times
        return _rows(case, np.repeat(np.arange(count), times), finer)

    why = "the log runs faster than the controller"
    return Fault("repeated rows", f"every row {times} times", why, spoil, shows=REPEATED, warned=True)


def repeated_block(first, last):
    """A part of the recording, in shares of it, written twice in a row."""

    def spoil(case):
        count = len(case.recording.t)
        part = np.arange(int(first * count), int(last * count))
        index = np.concatenate([np.arange(part[-1] + 1), part, np.arange(part[-1] + 1, count)])
        return _rows(case, index, _even(case, len(index)))

    why = "a buffer was written twice, and the rows numbered again"
    label = f"rows from {100 * first:.0f} to {100 * last:.0f} % twice"
    return Fault("repeated rows", label, why, spoil, shows=REPEATED, warned=True)


def missing_rows(pieces, share):
    """Pieces of a recording are lost, and the gaps closed."""

    def spoil(case):
        count = len(case.recording.t)
        starts = np.random.default_rng(pieces).uniform(0.05, 0.95, pieces)
        lost = [np.arange(int(s * count), int((s + share / pieces) * count)) for s in starts]
        index = np.setdiff1d(np.arange(count), np.concatenate(lost))
        return _rows(case, index, _even(case, len(index)))

    why = "packets were lost, and the rows numbered again"
    label = f"{100 * share:g} % of the rows lost in {pieces} pieces"
    return Fault("missing rows", label, why, spoil)


def _part(case, first, last):
    count = len(case.recording.t)
    return slice(int(first * count), int(last * count))


def dead_torque(j, first, last, *, zero=False):
    def spoil(case):
        tau, rows = np.array(case.recording.tau), _part(case, first, last)
        tau[rows, j] = 0.0 if zero else tau[rows.start, j]
        return case.changed(tau=tau)

    label = f"tau{j + 1} {'zero' if zero else 'frozen'} from {100 * first:.0f} to {100 * last:.0f} %"
    return Fault("dead torque", label, "the drive stopped writing", spoil, None, (j,), shows=DEAD, warned=True)


def dead_position(j, first, last, *, velocity):
    """velocity: whether the file holds one, which goes on."""

    def spoil(case):
        q, rows = np.array(case.recording.q), _part(case, first, last)
        q[rows, j] = q[rows.start, j]
        return case.changed(q=q)

    label = f"q{j + 1} frozen from {100 * first:.0f} to {100 * last:.0f} %" + (", v right" if velocity else "")
    base = with_velocity if velocity else without_velocity
    return Fault("dead position", label, "the encoder stopped writing", spoil, None, (j,), base, DEAD, warned=True)


def hung_log(first, last):
    """All channels hold their last value for a part."""

    def spoil(case):
        rows = _part(case, first, last)
        index = np.arange(len(case.recording.t))
        index[rows] = rows.start
        names = [name for name in ("q", "v", "tau") if getattr(case.recording, name) is not None]
        return case.changed(**{name: getattr(case.recording, name)[index] for name in names})

    label = f"all channels frozen from {100 * first:.0f} to {100 * last:.0f} %"
    return Fault(
        "repeated rows", label, "the log held the last message while none came", spoil, shows=REPEATED, warned=True
    )


def _clipped(values, j, share, j_range):
    low, high = np.quantile(values[:, j], [share * j_range[0], 1 - share * j_range[1]])
    clipped = np.array(values)
    clipped[:, j] = np.clip(values[:, j], low, high)
    return clipped


def clipped_position(j, share, *, velocity, sides=(1, 1)):
    """share: of the rows beyond each end."""

    def spoil(case):
        return case.changed(q=_clipped(case.recording.q, j, share, sides))

    label = f"q{j + 1} clipped in {100 * share * sum(sides):.0f} %" + (", v right" if velocity else "")
    base = with_velocity if velocity else without_velocity
    why = "the range of the encoder, or of its number in the file, is smaller than the motion"
    return Fault("clipped position", label, why, spoil, None, (j,), base, CLIPPED, warned=True)


def clipped_torque(j, share, sides=(1, 1)):
    def spoil(case):
        return case.changed(tau=_clipped(case.recording.tau, j, share, sides))

    label = f"tau{j + 1} clipped in {100 * share * sum(sides):.0f} %"
    return Fault("clipped torque", label, "the current sensor saturates", spoil, None, (j,), shows=CLIPPED, warned=True)
