"""Published mechanisms with loops in motion, and their errors against reference numbers."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from robots.mechanisms import andrews, bricard, n_four_bar, palletizer
from scipy.integrate import solve_ivp
from shared_data import DATA

import graphdyn
from graphdyn import PDControl, RobotModel, Simulation, simulate

G = 9.81


def squeezed(duration: float = 0.03, **settings: Any) -> tuple[Simulation, float]:
    """Andrews' squeezer from its start, and the largest error of q at 0.03 s."""
    model, given = andrews(DATA)
    names, c = given["order"].split(";")[0].split(), given["parameters"]
    order = [names.index(name) for name in model.joint_names]
    gamma, body = model.joint_names.index("gamma"), model.body_names.index("K3")
    hook, stand, far = (np.array(x) for x in ((c["sd"], -c["sc"]), (c["xb"], c["yb"]), (c["xc"], c["yc"])))

    def spring(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        cosine, sine = np.cos(q[gamma]), np.sin(q[gamma])
        rotation = np.array([[cosine, -sine], [sine, cosine]])
        line = far - (stand + rotation @ hook)
        length = np.linalg.norm(line)
        force = rotation.T @ line / length * c["c0"] * (length - c["l0"])
        wrenches = np.zeros((7, 6))
        wrenches[body, :2], wrenches[body, 5] = force, hook[0] * force[1] - hook[1] * force[0]
        return wrenches

    q = np.array([float(given["q0"][k]) for k in order])
    motor = c["mom"] * (np.array(model.joint_names) == "beta")
    motion = simulate(model, q, 0 * q, duration, torque=motor, external_wrenches=spring, **settings)
    return motion, float(np.abs(motion.q[-1] - np.array(given["ours_at_0.03"]["q"])[order]).max())


def four_bars(duration: float, **settings: Any) -> tuple[Simulation, float]:
    """The N-four-bar of two loops, and the largest error of its crank angles [rad]."""
    model = n_four_bar(2)
    signs = np.array([1.0, 1, 1, -1, -1])  # of the angles of cranks and couplers, which stay horizontal
    motion = simulate(model, np.pi / 2 * signs, -signs, duration, **settings)
    exact = solve_ivp(
        lambda t, y: (y[1], -3.5 * G * np.cos(y[0]) / 3),
        (0, duration),
        (np.pi / 2, -1.0),
        "DOP853",
        t_eval=motion.time,
        rtol=1e-13,
        atol=1e-13,
    ).y[0]
    return motion, float(np.abs(motion.q * signs - exact[:, None]).max())


def space_linkage(**settings: Any) -> tuple[Simulation, float]:
    """Bricard's mechanism after 1 s, and the largest error of the point P3 [m]."""
    given = json.loads((DATA / "loops" / "references.json").read_text(encoding="utf-8"))["bricard_A04"]
    motion = simulate(bricard(), np.zeros(5), np.zeros(5), 1.0, **settings)
    rotation, origin = graphdyn.frame_placement(motion.model, motion.q[-1], "rod 3")
    return motion, float(np.abs(origin + rotation @ [0, 0, 1.0] - given["P3"]["1"]).max())


def held_pose() -> tuple[RobotModel, np.ndarray, np.ndarray, PDControl, np.ndarray]:
    """The palletizing arm, q and v at the start, motors that hold this pose, and K with all joint angles K u."""
    model, k = palletizer(DATA)
    q, gains = k @ [0.3, 0.2, -0.1, 0.5], np.zeros(10)
    gains[[model.joint_names.index(name) for name in model.actuated or ()]] = [5e4, 5e4, 5e4, 500]
    return model, q, k @ [0.5, -0.4, 0.3, 1.0], PDControl(gains, gains / 10, q, period=2e-3), k


def held_palletizer(duration: float, **settings: Any) -> tuple[Simulation, float]:
    """The motion from there, and how far its joints are from those that follow from four angles."""
    model, q, v, control, k = held_pose()
    motion = simulate(model, q, v, duration, torque=control, **settings)
    followed = np.linalg.lstsq(k, motion.q.T, rcond=None)[0].T @ k.T
    return motion, float(np.abs(motion.q - followed).max())


CASES = (
    ("Andrews 0.03 s", squeezed, {"method": "rk8", "step": 1e-4}),
    ("Andrews 0.03 s", squeezed, {"method": "rk8", "step": 2e-4}),
    ("Andrews 0.03 s", squeezed, {"method": "rk4", "step": 2e-5}),
    ("Andrews 0.03 s", squeezed, {"rtol": 1e-12, "atol": 1e-12}),
    ("Bricard 1 s", space_linkage, {"method": "rk8", "step": 0.02}),
    ("Bricard 1 s", space_linkage, {"method": "rk4", "step": 1e-3}),
    ("Bricard 1 s", space_linkage, {"rtol": 1e-12, "atol": 1e-12}),
    ("N-four-bar 10 s", four_bars, {"duration": 10.0, "method": "rk8", "step": 5e-3}),
    ("N-four-bar 10 s", four_bars, {"duration": 10.0, "method": "rk8", "step": 1e-2}),
    ("N-four-bar 10 s", four_bars, {"duration": 10.0, "method": "rk4", "step": 1e-3}),
    ("N-four-bar 10 s", four_bars, {"duration": 10.0, "rtol": 1e-10, "atol": 1e-10}),
    ("N-four-bar 10 s", four_bars, {"duration": 10.0, "rtol": 1e-12, "atol": 1e-12}),
    ("palletizer 10 s", held_palletizer, {"duration": 10.0, "method": "rk4", "step": 1e-3}),
    ("palletizer 10 s", held_palletizer, {"duration": 10.0, "method": "rk8", "step": 1e-3}),
    ("palletizer 10 s", held_palletizer, {"duration": 10.0}),
)
