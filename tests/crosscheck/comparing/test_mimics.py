"""Robot files with joints that drive others: against Pinocchio's mimic joints, and K of the uncoupled robot."""

import re

import numpy as np
import pinocchio as pin
import pytest
from shared_data import DATA, existing
from witnesses import relative_error

import graphdyn
import urdf
from crosscheck.reference.pinocchio_model import PinocchioModel
from urdf import Reading
from urdf.document.catalog import locate

ROUNDING = 1e-13
"""Relative to the largest entry: measured 6e-16, of accelerations 6e-14."""

SAMPLES = 20


@pytest.mark.filterwarnings("ignore")  # of what else the files lack
@pytest.mark.parametrize("name", ["vx300s", "talos_full_v2"])
def test_pinocchio_with_mimic(name):
    """rnea and crba, which are right with mimic=True; its Coriolis matrix is not."""
    if name == "vx300s":
        text = existing(DATA / "urdf" / "arms" / "vx300s.urdf").read_text()
    else:  # Pinocchio wants joints that drive before those that follow, and sorts by name
        text = re.sub('"(gripper_(left|right)_joint)"', r'"a_\1"', locate("talos_full_v2")[0].read_text())
    model, native = urdf.load(text), pin.buildModelFromXML(text, mimic=True)
    assert model.couplings
    assert native.nv == model.nv
    data, rng = native.createData(), np.random.default_rng(0)
    joints = [native.joints[native.getJointId(joint)] for joint in model.independent_joints]
    columns = np.array([joint.idx_v for joint in joints])
    q, v = model.random_state(rng, SAMPLES)
    a = rng.normal(size=q.shape)
    tau, mass = np.empty_like(q), np.empty((SAMPLES, model.nv, model.nv))
    for k in range(SAMPLES):
        there = np.zeros((3, native.nv))
        there[:, columns] = q[k], v[k], a[k]
        configuration = pin.neutral(native)
        for joint, value in zip(joints, q[k], strict=True):
            configuration[joint.idx_q : joint.idx_q + joint.nq] = (
                value if joint.nq == 1 else (np.cos(value), np.sin(value))
            )
        tau[k] = pin.rnea(native, data, configuration, there[1], there[2])[columns]
        upper = np.triu(pin.crba(native, data, configuration))
        mass[k] = (upper + np.triu(upper, 1).T)[np.ix_(columns, columns)]
    assert relative_error(graphdyn.joint_torques(model, q, v, a), tau) < ROUNDING
    assert relative_error(graphdyn.mass_matrix(model, q), mass) < ROUNDING


@pytest.mark.parametrize(
    ("driver", "mimic", "reading"),
    [
        ("fixed", '<mimic joint="j1" offset="0.3"/>', Reading()),
        ("revolute", '<mimic joint="j1" multiplier="0" offset="0.3"/>', Reading()),
        ("revolute", '<mimic joint="j1" multiplier="2" offset="-0.5"/>', Reading(lock={"j1": 0.4})),
    ],
)
def test_what_stands_still_with_what_it_mimics_stands_still_in_pinocchio(driver, mimic, reading, tmp_path):
    """Pinocchio takes a mimic joint for a free one; here it is held where the joint that it mimics holds it."""
    path = tmp_path / "held.urdf"
    limit = '<limit effort="1" velocity="1" lower="-1" upper="1"/>'
    joints = "".join(
        f'<joint name="j{k}" type="{kind}"><parent link="l{k - 1}"/><child link="l{k}"/><origin xyz="0.1 0.2 0.3"/>'
        f'<axis xyz="0 {k % 2} {1 - k % 2}"/>{limit}{text}</joint>'
        for k, kind, text in ((1, driver, ""), (2, "revolute", mimic), (3, "revolute", ""), (4, "revolute", ""))
    )
    inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/>'
    body = f'<inertial><origin xyz="0.1 0 0.2"/><mass value="1"/>{inertia}</inertial>'
    links = "".join(f'<link name="l{k}">{body if k else ""}</link>' for k in range(5))
    path.write_text(f'<robot name="held">{links}{joints}</robot>')
    model = urdf.load(path, reading=reading)
    assert "j2" not in model.joint_names
    pinocchio = PinocchioModel.from_urdf(path, model, reading)
    rng = np.random.default_rng(0)
    q, v, a = rng.normal(size=(3, 4, model.nv))
    assert relative_error(pinocchio.rnea(q, v, a), graphdyn.joint_torques(model, q, v, a)) < ROUNDING


def test_loop_size4():
    """Couplings of sums of joints, as URDF+ writes them, which a mimic cannot say."""
    model = urdf.load(existing(DATA / "loops" / "urdfplus" / "loop_size4.urdf"))
    free, k = model.uncoupled, np.zeros((10, 9))
    names = [name for name in model.joint_names if name != "joint_2_2"]
    for column, name in enumerate(names):
        k[model.joint_names.index(name), column] = 1.0
    for name, ratio in (("joint_1_1", 1.0), ("joint_1_2", 1.0), ("joint_2_1", -1.0)):
        k[model.joint_names.index("joint_2_2"), names.index(name)] = ratio
    assert list(model.independent_joints) == names
    q, v, a = np.random.default_rng(0).normal(size=(3, SAMPLES, 9))
    mass = k.T @ graphdyn.mass_matrix(free, q @ k.T) @ k
    tau = graphdyn.joint_torques(free, q @ k.T, v @ k.T, a @ k.T) @ k
    assert relative_error(graphdyn.mass_matrix(model, q), mass) < ROUNDING
    for method in ("dense", "projected", "recursive"):
        assert relative_error(graphdyn.joint_torques(model, q, v, a, method=method), tau) < ROUNDING
        assert relative_error(graphdyn.joint_accelerations(model, q, v, tau, method=method), a) < ROUNDING
