"""urdf2casadi: get_inverse_dynamics_rnea and get_inertia_matrix_crba from the root of the file to the last joint."""

import numpy as np
from robot_file import FILE_CAUSES, edited, root_link
from urdf2casadi.urdfparser import URDFparser

PACKAGE = "urdf2casadi"
CAUSES = FILE_CAUSES


def load(file, gravity, undone=()):
    """joint_names and functions for crosscheck.judge; the tip is the link with the longest chain of joints."""
    parser = URDFparser()
    parser.from_file(edited(file, undone))
    root, links = root_link(file), parser.robot_desc.link_map
    tip = max(links, key=lambda link: len(parser.robot_desc.get_chain(root, link)))
    torques = parser.get_inverse_dynamics_rnea(root, tip, gravity=list(gravity))
    matrix = parser.get_inertia_matrix_crba(root, tip)
    return {
        "joint_names": parser.get_joint_info(root, tip)[1],
        "inverse_dynamics": lambda q, v, a: np.asarray(torques(q, v, a)).ravel(),
        "mass_matrix": lambda q: np.asarray(matrix(q)),
    }
