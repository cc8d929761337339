"""Mappings with several faults at once, and the lines that `identify` prints, pasted in their order."""

import tomllib
from dataclasses import dataclass

import numpy as np
from identified.spoilt_recordings.materials import MAPPINGS, material

from crosscheck.identifying.data_quality.data_quality import data_quality
from crosscheck.recordings import mapping_of
from graphdyn.identification import TorqueModel

LATE = 0.03
"""[s] Delay of planted late torques."""


def written(name):
    """The mapping of a recording as tables, with a list in place of every text or number for all joints."""
    document = tomllib.loads((MAPPINGS / f"{name}.toml").read_text(encoding="utf-8"))
    return whole(document)


def whole(document):
    """The tables with the lists of columns, signs, offsets in degrees and delays written out."""
    mapping = mapping_of(document, "mapping.toml")
    tables = dict(document)
    for name, channel in mapping.channels.items():
        keys = {"columns": [*channel.columns], "sign": channel.signs.tolist()}
        if name == "q":
            keys |= {"offset": np.rad2deg(channel.offset).tolist(), "offset_unit": "deg"}
        if name == "tau":
            keys |= {"delay": channel.delays.tolist()}
        tables[name] = document[name] | keys
    return tables


def changed(document, names, key, change):
    """The tables with the list of a key changed in place."""
    tables = dict(document)
    for name in names:
        if name in tables:
            values = [*tables[name][key]]
            change(values)
            tables[name] = tables[name] | {key: values}
    return tables


def reversed_sign(*names, joint):
    def change(values):
        values[joint] *= -1

    return lambda document: changed(document, names, "sign", change)


def exchanged(*names, joints):
    def change(values):
        i, j = joints
        values[i], values[j] = values[j], values[i]

    return lambda document: changed(document, names, "columns", change)


def zero(degrees, joint):
    def change(values):
        values[joint] += degrees

    return lambda document: changed(document, ("q",), "offset", change)


def late(seconds=LATE, joints=None):
    def change(values):
        for j in range(len(values)) if joints is None else joints:
            values[j] -= seconds

    return lambda document: changed(document, ("tau",), "delay", change)


def degrees_for_radians(document):
    """Angles that are in rad are taken for degrees."""
    units = {"q": "deg", "v": "deg/s"}
    return document | {name: document[name] | {"unit": unit} for name, unit in units.items() if name in document}


PLANTED = {
    "torque 3 reversed, positions 2 and 3 exchanged": (
        reversed_sign("tau", joint=2), exchanged("q", "v", joints=(1, 2)),
    ),
    "torques 2 and 3 exchanged, torque 2 reversed": (
        exchanged("tau", joints=(1, 2)), reversed_sign("tau", joint=1),
    ),
    "torques 2 and 4 exchanged, torque 4 reversed": (
        exchanged("tau", joints=(1, 3)), reversed_sign("tau", joint=3),
    ),
    "position 3 reversed, late": (reversed_sign("q", "v", joint=2), late()),
    "torque 2 reversed, torques 2 and 3 exchanged, torque 3 late": (
        reversed_sign("tau", joint=1), exchanged("tau", joints=(1, 2)), late(joints=(2,)),
    ),
    "zero of 2, torques 3 and 4 exchanged, torque 3 reversed": (
        zero(90, 1), exchanged("tau", joints=(2, 3)), reversed_sign("tau", joint=2),
    ),
    "zero of 3, position 3 reversed": (zero(90, 2), reversed_sign("q", "v", joint=2)),
    "in degrees, torques 2 and 3 exchanged, late": (
        degrees_for_radians, exchanged("tau", joints=(1, 2)), late(),
    ),
    "torques 2 and 3 reversed, late": (
        reversed_sign("tau", joint=1), reversed_sign("tau", joint=2), late(),
    ),
    "torques 1, 2 and 3 in a circle": (exchanged("tau", joints=(0, 1)), exchanged("tau", joints=(1, 2))),
}  # fmt: skip
"""Faults to plant, in the order in which they are put into a right mapping."""


@dataclass(frozen=True)
class Pasted:
    """clean, mended: recordings; found: the findings; left: those after the lines were pasted; document: then"""

    clean: object
    mended: object
    found: tuple
    left: tuple
    document: dict


def pasted(clean, planted, load, torque_model, preparation):
    """The faults planted in the clean tables, and the lines of what is found pasted. load: the recording of tables"""
    document = clean
    for plant in planted:
        document = plant(document)

    def found(tables):
        recording = load(tables)
        return recording, data_quality(torque_model, [recording], preparation).findings

    _, findings = found(document)
    for finding in findings:
        lines = tomllib.loads("\n".join(finding.lines))
        document = document | {name: document[name] | keys for name, keys in lines.items()}
    mended, left = found(document)
    return Pasted(load(clean), mended, findings, left, document)


def pasted_in(name, planted):
    """The same for a recording with a mapping: ur10, tx40 or kr300."""
    given = material(name)
    model = TorqueModel(given.model, given.options["terms"], given.options.get("known", ()))

    def load(tables):
        return given.load(mapping_of(tables, "mapping.toml"))

    return pasted(written(name), planted, load, model, given.options["preparation"])


def same_motion(one, other):
    """Largest differences of position [rad], and of torque relative to its largest, at the instants of both."""
    _, rows, others = np.intersect1d(np.round(one.t, 9), np.round(other.t, 9), return_indices=True)
    q = np.abs(np.angle(np.exp(1j * (one.q[rows] - other.q[others])))).max()
    size = np.abs(one.tau).max(axis=0)
    return q, (np.abs(one.tau[rows] - other.tau[others]) / size).max()
