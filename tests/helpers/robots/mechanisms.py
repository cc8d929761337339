"""Mechanisms with loops: made here, or read from the test data."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from graphdyn import Body, Chord, Joint, Placement, RobotModel


def at(x: float, y: float = 0.0, z: float = 0.0) -> Placement:
    return Placement(np.eye(3), np.array((x, y, z)))


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


def palletizer(data: Path) -> tuple[RobotModel, np.ndarray]:
    """The palletizing arm of the test data, and K with all joint angles K u."""
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
        "palletizer",
        tuple(bodies),
        tuple(joints),
        np.array(given["gravity"]),
        chords=tuple(chords),
        actuated=("axis1", "axis2", "axis3", "axis4"),
    )
    return model, np.array(given["K"], dtype=float)


def andrews(data: Path) -> tuple[RobotModel, dict]:
    """Andrews' squeezer mechanism, without its spring and its motor; and its reference numbers."""
    given = json.loads((data / "loops" / "references.json").read_text())["andrews"]
    constants = given["parameters"]
    values = {name: value for name, value in constants.items() if isinstance(value, (int, float))}

    def point(texts: Sequence[str]) -> tuple[float, float, float]:
        x, y = (float(eval(text, {"__builtins__": {}}, values)) for text in texts)  # such as "-(e-ea)"
        return x, y, 0.0

    rows = given["mechanism"]["bodies"]
    names = ["ground", *(row[0] for row in rows)]
    bodies, joints = [], []
    for name, inside, where, angle, center in rows:
        k = int(name[1]) - 1
        inertia = np.diag([constants["I"][k]] * 3)
        bodies.append(Body(name, constants["m"][k], np.array(point(center)), inertia))
        joints.append(hinge(angle, names.index(inside), point(where)))
    chords = [
        Chord(name, "hinge", names.index(i), at(*point(on_i)), names.index(j), at(*point(on_j)))
        for name, i, on_i, j, on_j in given["mechanism"]["chords"]
    ]
    return RobotModel("andrews", tuple(bodies), tuple(joints), np.zeros(3), chords=tuple(chords)), given


def bricard() -> RobotModel:
    """IFToMM A04: five rods of 1 m and 1 kg with square sections of 0.1 m; axes y z x y z x at the start."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], dtype=float)
    axes = np.eye(3)[[1, 2, 0, 1, 2, 0]]
    bodies, joints = [], []
    for k in range(5):
        along = corners[k + 1] - corners[k]
        across = 0.1**2 / 6 * np.outer(along, along) + (1 + 0.1**2) / 12 * (np.eye(3) - np.outer(along, along))
        bodies.append(Body(f"rod {k + 1}", 1.0, along / 2, across))
        joints.append(hinge(f"hinge {k}", k, corners[k] - corners[k - 1] if k else corners[0], axes[k]))
    closing = Chord("hinge 5", "hinge", 0, at(*corners[5]), 5, at(*(corners[5] - corners[4])), axes[5])
    return RobotModel("bricard", tuple(bodies), tuple(joints), np.array([0, -9.81, 0]), chords=(closing,))


def n_four_bar(n: int) -> RobotModel:
    """IFToMM A02: n + 1 cranks and n couplers of 1 m and 1 kg in a plane; singular where all lie in one line."""
    bodies, joints, chords = [], [], []
    for k in range(n + 1):
        bodies.append(rod(f"crank {k}"))
        joints.append(hinge(f"a{k}", 0, (k, 0, 0)))
    for k in range(n):
        bodies.append(rod(f"coupler {k}"))
        joints.append(hinge(f"b{k}", k + 1, (1, 0, 0)))
        chords.append(Chord(f"c{k}", "hinge", n + 2 + k, at(1, 0, 0), k + 2, at(1, 0, 0)))
    return RobotModel("n-four-bar", tuple(bodies), tuple(joints), np.array([0, -9.81, 0]), chords=tuple(chords))
