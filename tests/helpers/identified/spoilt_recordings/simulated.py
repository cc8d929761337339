"""Simulated recordings of other arms: known by name or from makers' files, on walls, with loads, gears and drives."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from identified.spoilt_recordings.materials import ARMS, Material
from planting import mixed_tree
from scipy.spatial.transform import Rotation

import urdf
from crosscheck.identifying import Folds, Preparation, friction_terms, virtual_robot
from crosscheck.recordings import load_mapping, load_recording
from graphdyn import Body
from graphdyn.identification.terms import RigidBodies

PLAIN = ("viscous", "coulomb")
"""Terms of the torque that the user takes."""

ROUGH = (*PLAIN, "stribeck", "slip", "asymmetric-viscous")
"""Terms of a torque that holds more than the user takes: the fit then leaves some percent, as on real arms."""

LOCKED = {"panda": {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}}
"""Joints of grippers that are no part of an arm, and their positions."""

SPHERE = 0.1
"""Radius of the load, a homogeneous sphere [m]."""


def simulated(robot, seed=0, *, rough=True, turn=(0.0, 0.0, 0.0), load=0.0, terms=PLAIN):
    """A robot of the catalog, or a file of makers' arms, on 10 s of motion.

    rough: whether the friction holds more than the terms of the fit
    turn: of gravity in the frame of the base, in the recording and in the model, as a rotation vector [rad]
    load: mass on the last body that CAD does not know [kg]
    """
    path = ARMS / f"{robot}.urdf"
    model = urdf.load(str(path) if path.exists() else robot, lock=LOCKED.get(robot, {}))
    return _material(model, seed, rough=rough, turn=turn, load=load, terms=terms)


def _material(model, seed, *, rough=True, turn=(0.0, 0.0, 0.0), load=0.0, terms=PLAIN):
    gravity = Rotation.from_rotvec(turn).as_matrix() @ model.gravity
    given = model.with_gravity(gravity)
    true_terms = friction_terms([*terms, *ROUGH[len(PLAIN) :]] if rough else terms, width=0.05)
    arm = virtual_robot(_loaded(given, load), true_terms, seconds=10.0, seed=seed)
    cad = arm.subject.model if not load else given
    options = {"terms": (RigidBodies(), *friction_terms(terms, width=0.05)), "preparation": Preparation(10.0)}
    options |= {"methods": ["wls", "consistent"], "held_out": Folds(3)}
    return Material(cad, None, lambda _: arm.fitted, options)


def _loaded(model, mass):
    if not mass:
        return model
    last = model.bodies[-1]
    load = Body("load", mass, last.center_of_mass + np.array([0, 0, SPHERE]), 0.4 * mass * SPHERE**2 * np.eye(3))
    return replace(
        model, bodies=(*model.bodies[:-1], Body.from_parameters(last.name, last.parameters + load.parameters))
    )


GEARS = (100.0, -101.0, 80.0, -50.0, 60.0, 60.0)
"""Ratios of the geared arm, and of its last motor for joint 5."""


def geared(robot, seed=0):
    """The angles and torques of the motors in a file, with a mapping of gears, signs, zeros and a coupled wrist."""
    plain = simulated(robot, seed)
    recording, n = plain.load(None), plain.model.nv
    matrix = np.diag(GEARS)
    matrix[n - 1, n - 2] = GEARS[-1]
    zero = np.deg2rad([0, -90, 90, 0, 45, 0])
    motors = (recording.q - zero) @ matrix.T
    torques = recording.tau @ np.linalg.inv(matrix)
    names = ["t", *(f"{what}_{k}" for what in ("q", "tau") for k in range(1, n + 1))]
    with tempfile.TemporaryDirectory() as folder:
        log, mapping = Path(folder, "motors.csv"), Path(folder, "motors.toml")
        rows = np.column_stack([recording.t, motors, torques])
        np.savetxt(log, rows, delimiter=",", header=",".join(names), comments="", fmt="%.12g")
        joints = ", ".join(f'"{name}"' for name in plain.model.joint_names)
        rows = ",\n".join(f"    {row.tolist()}" for row in matrix)
        mapping.write_text(
            f'joints = [{joints}]\n[time]\ncolumn = "t"\nunit = "s"\n'
            '[q]\ncolumns = "q_{number}"\nunit = "rad"\nside = "motor"\n'
            f'offset = {np.rad2deg(zero).tolist()}\noffset_unit = "deg"\n'
            '[tau]\ncolumns = "tau_{number}"\nunit = "N m"\nside = "motor"\n'
            f"[transmission]\nmatrix = [\n{rows},\n]\n"
        )
        read = load_recording(log, load_mapping(mapping), joints=plain.model.joint_names)
    return replace(plain, load=lambda _: read)


CLEAN = {
    "ur10e on a wall": lambda: simulated("ur10e", 1, turn=(np.pi / 2, 0.0, 0.0)),
    "m1013 tilted by 45°": lambda: simulated("m1013", 2, turn=(0.0, np.pi / 4, 0.0)),
    "ur3 upside down": lambda: simulated("ur3", 3, turn=(np.pi, 0.0, 0.0)),
    "panda, seven axes": lambda: simulated("panda", 4),
    "xarm7 on a wall, seven axes": lambda: simulated("xarm7", 5, turn=(0.0, -np.pi / 2, 0.0)),
    "branch with a slide": lambda: _material(mixed_tree(), 6),
    "ur5e, motors in the file": lambda: geared("ur5e", 7),
    "crx10ia_l with a load": lambda: simulated("crx10ia_l", 8, load=1.5),
    "kr210_r2700_2 with rotors": lambda: simulated("kr210_r2700_2", 9, terms=(*PLAIN, "rotor", "offset")),
    "ur10 with a load": lambda: simulated("ur10", 10, load=8.0),
    "z1": lambda: simulated("z1", 11),
    "ur5, another seed": lambda: simulated("ur5", 12, rough=False),
}
"""Simulated recordings without a fault, by what is odd about them."""
