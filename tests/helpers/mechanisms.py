"""Mechanisms with loops: made here, or read from the test data."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from graphdyn import Body, Chord, Joint, Placement, RobotModel


def at(*translation: float) -> Placement:
    return Placement(np.eye(3), np.array(translation))


def hinge(name: str, inside: int, translation: Sequence[float], axis: Sequence[float] = (0, 0, 1)) -> Joint:
    return Joint(name, "revolute", inside, at(*translation), np.array(axis, dtype=float))


def rod(name: str, length: float = 1.0, mass: float = 1.0) -> Body:
    """A uniform slender rod along x."""
    inertia = mass * length**2 / 12 * np.diag([1e-3, 1.0, 1.0])
    return Body(name, mass, np.array([length / 2, 0, 0]), inertia)


def four_bar(crank: float = 1.0, coupler: float = 2.0, rocker: float = 1.5, ground: float = 2.2) -> RobotModel:
    """Planar, about z, gravity along -y; the coupler's end is hinged to the rocker's."""
    return RobotModel(
        "four-bar",
        (rod("crank", crank), rod("coupler", coupler), rod("rocker", rocker)),
        (hinge("a", 0, (0, 0, 0)), hinge("b", 1, (crank, 0, 0)), hinge("c", 0, (ground, 0, 0))),
        gravity=np.array([0, -9.81, 0]),
        chords=(Chord("closing", "hinge", 2, at(coupler, 0, 0), 3, at(rocker, 0, 0)),),
        actuated=("a",),
    )


def palletiser(data: Path) -> tuple[RobotModel, np.ndarray]:
    """The palletising arm of the test data, and K with all joint angles K u."""
    given = json.loads((data / "loops" / "palletiser.json").read_text())
    bodies = [
        Body(b["name"], b["mass"], np.array(b["center_of_mass"]), np.array(b["inertia"])) for b in given["bodies"]
    ]
    joints = [hinge(j["name"], j["inside"], j["translation"], j["axis"]) for j in given["joints"]]
    chords = [
        Chord(c["name"], "hinge", c["body_i"], at(*c["point_i"]), c["body_j"], at(*c["point_j"]), np.array([0, 1.0, 0]))
        for c in given["cuts"]
    ]
    model = RobotModel(
        "palletiser",
        tuple(bodies),
        tuple(joints),
        np.array(given["gravity"]),
        chords=tuple(chords),
        actuated=("axis1", "axis2", "axis3", "axis4"),
    )
    return model, np.array(given["K"], dtype=float)
