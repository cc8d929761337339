"""KUKA KR300 R2500 ultra from its published figures (kr300.json): URDF file and counterbalance torque.

    python kr300.py kr300.json kr300.urdf        bodies as published
    python kr300.py kr300.json kr300.urdf 150    with a load of 150 kg in link_6

    graphdyn identify … --robot kr300.urdf --known-torque kr300.py:counterbalance --terms viscous,coulomb,offset,rotor

counterbalance reads kr300.json in the working folder, or the file that the environment variable KR300_JSON names.
The published rotor inertias do not fit the recording and are not used: fit them.
Joint angles follow the standard Denavit-Hartenberg kinematics; kr300.toml converts the measured angles to them.
Data and figures: JonasWeigand/Robot_Identification on GitHub (MIT).
"""

import functools
import json
import os
import sys
from pathlib import Path

import numpy as np

import urdf
from graphdyn import Body, Joint, Placement, RobotModel

SPHERE_RADIUS = 0.1
"""[m] Radius of a homogeneous sphere whose tensor replaces that of axis 6, which is published as zero."""


class Kr300:
    """The robot of a file of figures.

    robot: its rigid-body model
    zero: angles to add to measured ones          (6,)    [rad]
    payload_center: center of the load in link_6  (3,)    [m]
    """

    def __init__(self, path, payload=0.0):
        self._figures = json.loads(Path(path).read_text(encoding="utf-8"))
        self.zero = np.deg2rad(self._figures["zero_of_measured_angles_deg"])
        links = self._figures["links"]
        ends = [_link_end(link) for link in links]
        load_center = [0, 0, self._figures["payload"]["centre_z"]]
        self.payload_center = ends[-1].rotation @ load_center + ends[-1].translation
        bodies = [_body(f"link_{k}", link, end) for k, (link, end) in enumerate(zip(links, ends, strict=True), start=1)]
        if payload:
            load = Body("load", payload, self.payload_center, _sphere(payload))
            bodies[-1] = Body.from_parameters("link_6", bodies[-1].parameters + load.parameters)
        joints, inside = [], Placement()
        for j, (link, end) in enumerate(zip(links, ends, strict=True), start=1):
            turn = _about_z(np.deg2rad(link["offset_deg"]))
            placement = Placement(inside.rotation @ turn, inside.translation)
            joints.append(Joint(f"joint_{j}", "revolute", j - 1, placement, [0, 0, 1]))
            inside = end
        upside_down = Placement(np.diag([1.0, -1.0, -1.0]))
        self.robot = RobotModel("kr300", tuple(bodies), tuple(joints), base=upside_down)

    def counterbalance(self, angle):
        """Torque on axis 2 [N m] by the model in the file, at angles of joint_2 (N,) [rad]."""
        c = self._figures["counterbalance"]
        far, crank = c["anchor_distance_D"], c["crank_k"]
        delta = angle + np.deg2rad(c["angle_offset_deg"])
        length = np.sqrt(far**2 + crank**2 - 2 * far * crank * np.cos(delta))
        area = np.pi * (c["piston_diameter"] ** 2 - c["rod_diameter"] ** 2) / 4
        gas = c["compressibility"] * c["gas_constant"] * c["temperature_K"] * c["gas_mass_kg"]
        pressure = gas / (c["gas_volume_m3"] - (length - (far - crank)) * area)
        return pressure * area * far * crank * np.sin(delta) / length


@functools.cache
def published():
    return Kr300(os.environ.get("KR300_JSON", "kr300.json"))


def counterbalance(q, v, a):
    """Torque of the counterbalance on all joints (N, 6) [N m]."""
    return published().counterbalance(q[:, 1])[:, None] * np.eye(6)[1]


def _body(name, link, end):
    xx, yy, zz, xy, yz, xz = link["I"]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    inertia = inertia if inertia.any() else _sphere(link["m"])
    return Body(name, link["m"], end.rotation @ link["r"] + end.translation, end.rotation @ inertia @ end.rotation.T)


def _sphere(mass):
    return 0.4 * mass * SPHERE_RADIUS**2 * np.eye(3)


def _about_z(angle):
    return np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])


def _link_end(link):
    """Frame of the link in the frame of its joint: d along z, a along x, alpha about x."""
    c, s = np.cos(np.deg2rad(link["alpha_deg"])), np.sin(np.deg2rad(link["alpha_deg"]))
    return Placement(np.array([[1, 0, 0], [0, c, -s], [0, s, c]]), np.array([link["a"], 0.0, link["d"]]))


if __name__ == "__main__":
    figures, destination, *load = sys.argv[1:]
    urdf.save(Kr300(figures, *map(float, load)).robot, destination)
