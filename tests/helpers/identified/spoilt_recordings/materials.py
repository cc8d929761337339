"""The recordings that are spoilt: three real arms and a simulated UR5, with the arguments of `identify` for each."""

import functools
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import urdf
from crosscheck.identifying import ByRows, ByTime, Folds, Preparation, friction_terms, virtual_robot
from crosscheck.recordings import load_mapping, load_recording
from graphdyn import RobotModel
from graphdyn.identification import ConsistentWithPrior
from graphdyn.identification.terms import KnownTorque, RigidBodies

REPOSITORY = Path(__file__).parents[4]
SHARED = (REPOSITORY / os.environ.get("GRAPHDYN_TEST_DATA", "../shared")).resolve()
DATA, ARMS = SHARED / "data", SHARED / "urdf" / "arms"
MAPPINGS = REPOSITORY / "docs" / "recordings"


@dataclass(frozen=True, eq=False)
class Material:
    """A robot, its recording as a function of the mapping (None: it has none), and the arguments of identify."""

    model: RobotModel
    mapping: object
    load: Callable
    options: dict


@functools.cache
def material(name):
    """A recording of RECORDINGS, of simulated.CLEAN, or of a simulated robot: its name, or name:seed."""
    own = {"ur10": _ur10, "tx40": _tx40, "kr300": _kr300, "ur5": _ur5}
    if name in own:
        return own[name]()
    from identified.spoilt_recordings import simulated  # which builds materials itself

    if name in simulated.CLEAN:
        return simulated.CLEAN[name]()
    robot, _, seed = name.partition(":")
    return simulated.simulated(robot, int(seed or 0))


def _ur10():
    model, mapping = urdf.load("ur10"), load_mapping(MAPPINGS / "ur10.toml")
    terms = friction_terms(["viscous", "coulomb", "stribeck", "offset"], width=0.05)
    options = {"terms": (RigidBodies(), *terms), "preparation": Preparation(8.0), "methods": ["wls", "consistent"]}
    path = DATA / "ur10" / "ur10_free_motion.csv"
    options["held_out"] = ByRows((60, 1700), (1750, np.inf))
    return Material(model, mapping, lambda m: load_recording(path, m, joints=model.joint_names), options)


def _tx40():
    folder = DATA / "tx40"
    model, mapping = urdf.load(str(folder / "tx40.urdf")), load_mapping(MAPPINGS / "tx40.toml")
    terms = friction_terms(["viscous", "coulomb", "offset", "rotor", "coupled-wrist"], width=0.05)
    options = {"terms": (RigidBodies(), *terms), "preparation": Preparation(20.0, decimate=(10, 10))}
    options |= {"methods": ["wls", "consistent"], "held_out": ByTime((0, 6), (6, 9))}
    paths = [folder / "pos_read_data.csv", folder / "curr_data.csv"]
    return Material(model, mapping, lambda m: load_recording(paths, m, joints=model.joint_names), options)


def _kr300():
    sys.path.insert(0, str(MAPPINGS))
    os.environ["KR300_JSON"] = str(DATA / "kr300" / "kr300.json")
    import kr300

    model, mapping = kr300.Kr300(os.environ["KR300_JSON"], 150.0).robot, load_mapping(MAPPINGS / "kr300.toml")
    options = {
        "terms": (RigidBodies(), *friction_terms(["viscous", "coulomb", "offset", "rotor"])),
        "held_out": Folds(3),
    }
    options |= {"known": (KnownTorque(kr300.counterbalance),)}
    options |= {"preparation": Preparation(8.0, min_speed=0.02)}
    options |= {"methods": ["wls", ConsistentWithPrior("pullback", strength=1000.0)]}
    path = DATA / "kr300" / "kr300_A.csv"
    return Material(model, mapping, lambda m: load_recording(path, m, joints=model.joint_names), options)


def _ur5():
    arm = virtual_robot("ur5", friction_terms(["viscous", "coulomb"], width=0.05), seconds=10.0)
    options = {"terms": arm.torque_model.terms, "preparation": Preparation(10.0), "methods": ["wls", "consistent"]}
    return Material(arm.subject.model, None, lambda m: arm.fitted, options)
