"""The KR300 from its published figures (kr300.json): standard Denavit-Hartenberg, bodies, drives, counterbalance."""

import json

import numpy as np

from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn.identification.terms import KnownTorque


class Kr300:
    """robot: in the measured angles; rotor_inertia (6,): at the joints; payload_center (3,): in the frame of body 6."""

    def __init__(self, path):
        self._figures = json.loads(path.read_text(encoding="utf-8"))
        self._zero = np.deg2rad(self._figures["zero_of_measured_angles_deg"])
        links = self._figures["links"]
        bodies, joints, end = [], [], Placement()
        for j, link in enumerate(links):
            turn = _about_z(self._zero[j] + np.deg2rad(link["offset_deg"]))
            joints.append(Joint(f"A{j + 1}", "revolute", j, Placement(end.rotation @ turn, end.translation), [0, 0, 1]))
            end = _link_end(link)
            xx, yy, zz, xy, yz, xz = link["I"]
            inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            center = end.rotation @ link["r"] + end.translation
            bodies.append(Body(f"L{j + 1}", link["m"], center, end.rotation @ inertia @ end.rotation.T))
        self.robot = RobotModel("kr300", tuple(bodies), tuple(joints), gravity=np.array([0.0, 0.0, 9.81]))
        self.rotor_inertia = np.array([link["Jm"] * link["G"] ** 2 for link in links])
        self.payload_center = end.rotation @ [0, 0, self._figures["payload"]["centre_z"]] + end.translation

    @property
    def known(self):
        """Counterbalance and rotors."""
        on_axis_2 = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
        return (
            KnownTorque(lambda q, v, a: self.counterbalance(q[:, 1])[:, None] * on_axis_2),
            KnownTorque(lambda q, v, a: self.rotor_inertia * a),
        )

    def counterbalance(self, angle):
        """Torque on axis 2 [N m]: the model written out in the file."""
        c = self._figures["counterbalance"]
        far, crank = c["anchor_distance_D"], c["crank_k"]
        delta = angle + self._zero[1] + np.deg2rad(c["angle_offset_deg"])
        length = np.sqrt(far**2 + crank**2 - 2 * far * crank * np.cos(delta))
        area = np.pi * (c["piston_diameter"] ** 2 - c["rod_diameter"] ** 2) / 4
        gas = c["compressibility"] * c["gas_constant"] * c["temperature_K"] * c["gas_mass_kg"]
        pressure = gas / (c["gas_volume_m3"] - (length - (far - crank)) * area)
        return pressure * area * far * crank * np.sin(delta) / length


def _about_z(angle):
    return np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])


def _link_end(link):
    """Frame of the link in the frame of its joint: d along z, a along x, alpha about x."""
    c, s = np.cos(np.deg2rad(link["alpha_deg"])), np.sin(np.deg2rad(link["alpha_deg"]))
    return Placement(np.array([[1, 0, 0], [0, c, -s], [0, s, c]]), np.array([link["a"], 0.0, link["d"]]))
