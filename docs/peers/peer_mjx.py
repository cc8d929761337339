"""MuJoCo XLA (mjx): inverse of the file as MuJoCo reads it, in single precision as JAX has it."""

import jax
import mujoco
import numpy as np
from mujoco import mjx
from peer_mujoco import CAUSES as MUJOCO_CAUSES
from robot_file import edited

PACKAGE = "mujoco-mjx"
CAUSES = ("single precision", *MUJOCO_CAUSES)


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge."""
    host = mujoco.MjModel.from_xml_path(edited(file))
    host.opt.gravity = gravity
    jax.config.update("jax_enable_x64", "single precision" in undone)
    for cause in set(undone) & set(MUJOCO_CAUSES):
        host.opt.disableflags |= MUJOCO_CAUSES[cause]
    model = mjx.put_model(host)
    start = mjx.make_data(model)

    @jax.jit
    def torques(q, v, a):
        return mjx.inverse(model, start.replace(qpos=q, qvel=v, qacc=a)).qfrc_inverse

    return {
        "joint_names": [host.joint(k).name for k in range(host.njnt)],
        "inverse_dynamics": lambda q, v, a: np.array(torques(q, v, a), dtype=float),
    }
