"""MuJoCo: mj_inverse, mj_forward, mj_fullM of the file as MjModel.from_xml_path reads it."""

import mujoco
import numpy as np
from robot_file import edited

PACKAGE = "mujoco"
CAUSES = {
    "damping": mujoco.mjtDisableBit.mjDSBL_DAMPER,
    "dry friction": mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS,
    "joint limits": mujoco.mjtDisableBit.mjDSBL_LIMIT,
}


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge."""
    model = mujoco.MjModel.from_xml_path(edited(file))
    model.opt.gravity = gravity
    for cause in undone:
        model.opt.disableflags |= CAUSES[cause]
    data = mujoco.MjData(model)

    def inverse_dynamics(q, v, a):
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data)
        return data.qfrc_inverse.copy()

    def forward_dynamics(q, v, tau):
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, v, tau
        mujoco.mj_forward(model, data)
        return data.qacc.copy()

    def mass_matrix(q):
        data.qpos[:], data.qvel[:] = q, 0.0
        mujoco.mj_forward(model, data)
        columns = np.empty((model.nv, model.nv))
        for column, unit in zip(columns, np.eye(model.nv), strict=True):
            mujoco.mj_mulM(model, data, column, unit)
        return columns

    return {
        "joint_names": [model.joint(k).name for k in range(model.njnt)],
        "inverse_dynamics": inverse_dynamics,
        "forward_dynamics": forward_dynamics,
        "mass_matrix": mass_matrix,
    }
