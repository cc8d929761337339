"""Columns and torques corrupted in the ways in which users corrupt them: signs, exchanges, units, delays."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

import urdf
from graphdyn import RobotModel


@dataclass(frozen=True, eq=False)
class Variant:
    """codes: of findings, one of which must be told first, () for a recording that is to be usable

    columns: changes a mapping; arrays: changes the recording; model: the robot that the user takes it for
    undetectable: told in words that this cannot be seen; usable or not is not judged
    """

    name: str
    codes: tuple[str, ...]
    columns: Callable = lambda mapping: mapping
    arrays: Callable = lambda recording: recording
    model: Callable = lambda model: model
    undetectable: bool = False


def changed(*names, **what):
    """A function that changes these channels of a mapping."""
    return lambda mapping: replace(
        mapping,
        channels={
            name: replace(channel, **{key: value(channel) for key, value in what.items()}) if name in names else channel
            for name, channel in mapping.channels.items()
        },
    )


def reversed_columns(j):
    def signs(channel):
        return np.where(np.arange(len(channel.columns)) == j, -1.0, 1.0)

    return {"factor": lambda channel: channel.factor * signs(channel)}


def exchanged_columns(i, j):
    def columns(channel):
        names = list(channel.columns)
        names[i], names[j] = names[j], names[i]
        return tuple(names)

    return {"columns": columns}


def shifted(seconds):
    """Torques that are recorded so much later."""

    def late(recording):
        t = recording.t
        tau = np.column_stack([np.interp(t - seconds, t, column) for column in recording.tau.T])
        return replace(recording, tau=tau)

    return late


def noise(recording):
    rng, tau = np.random.default_rng(0), recording.tau
    return replace(recording, tau=tau.mean(axis=0) + tau.std(axis=0) * rng.normal(size=tau.shape))


def scaled(factor):
    return lambda recording: replace(recording, tau=recording.tau * factor)


def multiplied(name, j, factor, rows=slice(None)):
    def change(recording):
        values = np.array(getattr(recording, name))
        values[rows, j] *= factor
        return replace(recording, **{name: values})

    return change


def half_reversed(j):
    return lambda recording: multiplied("tau", j, -1.0, slice(len(recording.t) // 2, None))(recording)


def copied(j, onto):
    def change(recording):
        tau = np.array(recording.tau)
        tau[:, onto] = tau[:, j]
        return replace(recording, tau=tau)

    return change


def exchanged_arrays(i, j, *names):
    def change(recording):
        order = np.arange(recording.n_joints)
        order[[i, j]] = j, i
        given = {name: getattr(recording, name) for name in names}
        return replace(recording, **{name: array[:, order] for name, array in given.items() if array is not None})

    return change


def in_degrees(recording):
    v = None if recording.v is None else np.rad2deg(recording.v)
    return replace(recording, q=np.rad2deg(recording.q), v=v)


COMMON = [
    Variant("clean", ()),
    Variant("tau 20 ms early", ("late-torque",), arrays=shifted(-0.02)),
    Variant("tau 20 ms late", ("late-torque",), arrays=shifted(0.02)),
    Variant("tau 100 ms late", ("late-torque",), arrays=shifted(0.1)),
    Variant("noise around a mean", ("unrelated",), arrays=noise),
    Variant("tau in mA", ("torque-unit", "scaled-torque"), arrays=scaled(1000 / 0.11)),
    Variant("tau at the motor", ("torque-unit", "scaled-torque"), arrays=scaled(1 / 100)),
    Variant("tau2 copied onto tau3", ("duplicated",), arrays=copied(1, 2)),
    Variant("tau2 reversed from the middle on", ("halves", "reversed-torque"), arrays=half_reversed(1)),
    Variant("tau4 zero", ("constant-torque",), arrays=multiplied("tau", 3, 0.0)),
    Variant("tau3 in N mm", ("scaled-torque",), arrays=multiplied("tau", 2, 1000.0)),
]


def mapped_variants(n, gears, recorded_velocity):
    """Of a recording with a mapping. gears: on which joints the mapping has one for q and tau"""
    for j in range(n):
        yield Variant(
            f"tau{j + 1} reversed", ("reversed-torque", "reversed-position"), changed("tau", **reversed_columns(j))
        )
    for j in range(n):
        codes = ("reversed-position", "reversed-torque")
        yield Variant(f"q{j + 1} reversed", codes, changed("q", "v", **reversed_columns(j)))
        if recorded_velocity:
            yield Variant(f"q{j + 1} reversed, v right", (*codes, "velocity"), changed("q", **reversed_columns(j)))
    for what, names, code in (
        ("q2, q3", ("q", "v"), "exchanged-positions"),
        ("tau2, tau3", ("tau",), "exchanged-torques"),
        ("joints 2, 3", ("q", "v", "tau"), "exchanged-joints"),
        ("tau1, tau4", ("tau",), "exchanged-torques"),
    ):
        pair = (0, 3) if "1" in what else (1, 2)
        yield Variant(f"{what} exchanged", (code,), changed(*names, **exchanged_columns(*pair)))
    degrees = {"factor": lambda channel: channel.factor * 180 / np.pi}
    yield Variant("q in degrees", ("degrees",), changed("q", "v", **degrees))
    if recorded_velocity:
        yield Variant("q in degrees, v right", ("degrees",), changed("q", **degrees))
    for j in gears:
        yield Variant(
            f"gear {j + 1} reversed",
            ("reversed-joint",),
            changed("q", "v", "tau", **reversed_columns(j)),
            undetectable=True,
        )
    quarter = {"offset": lambda channel: channel.offset + np.deg2rad([0, 90, 0, 0, 0, 0])}
    yield Variant("zero of q2 off by 90°", ("zero",), changed("q", **quarter))


def virtual_variants(n):
    for j in range(n):
        yield Variant(
            f"tau{j + 1} reversed", ("reversed-torque", "reversed-position"), arrays=multiplied("tau", j, -1.0)
        )
        codes = ("reversed-position", "reversed-torque")
        yield Variant(f"q{j + 1} reversed", codes, arrays=multiplied("q", j, -1.0))
    yield Variant("q2, q3 exchanged", ("exchanged-positions",), arrays=exchanged_arrays(1, 2, "q", "v"))
    yield Variant("tau2, tau3 exchanged", ("exchanged-torques",), arrays=exchanged_arrays(1, 2, "tau"))
    yield Variant("joints 2, 3 exchanged", ("exchanged-joints",), arrays=exchanged_arrays(1, 2, "q", "v", "tau"))
    yield Variant("q in degrees", ("degrees",), arrays=in_degrees)


def as_ur5(model):
    other = urdf.load("ur5")
    return RobotModel(
        "ur5",
        other.bodies,
        tuple(replace(joint, name=name) for joint, name in zip(other.joints, model.joint_names, strict=True)),
        base=other.base,
    )


def variants(name):
    if name == "ur5":
        return [*COMMON, *virtual_variants(6)]
    found = [*COMMON, *mapped_variants(6, range(6) if name == "tx40" else (), name != "tx40")]
    if name == "ur10":
        found.append(Variant("taken for a ur5", (), model=as_ur5, undetectable=True))
    return found
