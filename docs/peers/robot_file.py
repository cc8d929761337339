"""Robot files for the peers: shapes taken out, since no peer needs meshes for dynamics; single causes taken out."""

import tempfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

import urdf

NO_MASS = """<inertial><origin xyz="0 0 0" rpy="0 0 0"/><mass value="0"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>"""
SHAPES = ("visual", "collision")


def edited(file, undone=()):
    """Path of a copy of the URDF without shapes and transmissions; undone: those of FILE_CAUSES count."""
    robot = ElementTree.parse(file).getroot()
    for link in robot.findall("link"):
        for shape in [part for part in link if part.tag in SHAPES]:
            link.remove(shape)
    for part in [part for part in robot if part.tag not in ("link", "joint")]:
        robot.remove(part)
    for cause in undone:
        if cause in FILE_CAUSES:
            FILE_CAUSES[cause](robot)
    copy = Path(tempfile.mkdtemp(prefix="peer-")) / Path(file).name
    ElementTree.ElementTree(robot).write(copy)
    return str(copy)


def joint_above(file):
    """{link: the joint that it is the child of}, by name."""
    joints = ElementTree.parse(file).getroot().findall("joint")
    return {joint.find("child").get("link"): joint.get("name") for joint in joints}


def without_friction(robot):
    """Damping and friction of joints taken out: the judge asks for rigid bodies alone."""
    for joint in robot.findall("joint"):
        for dynamics in joint.findall("dynamics"):
            joint.remove(dynamics)


def root_link(file):
    """Name of the link that is no joint's child."""
    links = [link.get("name") for link in ElementTree.parse(file).getroot().findall("link")]
    (root,) = set(links) - set(joint_above(file))
    return root


def with_other_names_of_fixed_joints(robot):
    """Names of fixed joints that no link has."""
    links = {link.get("name") for link in robot.findall("link")}
    for joint in robot.findall("joint"):
        if joint.get("type") == "fixed" and joint.get("name") in links:
            joint.set("name", joint.get("name") + "_joint")


def with_fused_links(robot):
    """Every fixed link, as one body with the link that it is fixed to."""
    path = Path(tempfile.mkdtemp(prefix="peer-")) / "fused.urdf"
    urdf.save(urdf.load(ElementTree.tostring(robot)), path)
    robot[:] = ElementTree.parse(path).getroot()


def with_zero_inertials(robot):
    """<inertial> of zero mass in every link that has none."""
    for link in robot.findall("link"):
        if link.find("inertial") is None:
            link.append(ElementTree.fromstring(NO_MASS))


def with_origins(robot):
    """<origin xyz rpy> in every <inertial> and <joint>, zero where it is left out."""
    for placed in [*robot.iter("inertial"), *robot.findall("joint")]:
        origin = placed.find("origin")
        if origin is None:
            origin = ElementTree.SubElement(placed, "origin")
        for key in {"xyz", "rpy"} - set(origin.keys()):
            origin.set(key, "0 0 0")


def with_inertials_in_link_axes(robot):
    """Tensors turned into link axes, rpy of inertial frames zero."""
    for inertial in robot.iter("inertial"):
        origin = inertial.find("origin")
        if origin is None or origin.get("rpy") is None:
            continue
        turn = Rotation.from_euler("xyz", [float(x) for x in origin.get("rpy").split()]).as_matrix()
        entries = inertial.find("inertia")
        tensor = np.array([[float(entries.get(f"i{min(x, y)}{max(x, y)}")) for x in "xyz"] for y in "xyz"])
        turned = turn @ tensor @ turn.T
        for row, x in enumerate("xyz"):
            for column in range(row, 3):
                entries.set(f"i{x}{'xyz'[column]}", repr(float(turned[row, column])))
        origin.set("rpy", "0 0 0")


FILE_CAUSES = {
    "damping and friction of joints": without_friction,
    "rpy of inertial frames": with_inertials_in_link_axes,
    "<origin>, xyz or rpy left out": with_origins,
    "links without <inertial>": with_zero_inertials,
    "fixed joints named like links": with_other_names_of_fixed_joints,
    "fixed links": with_fused_links,
}
"""What a library may read differently, and the edit of the file that takes it away. Fusing also writes one <inertial>
per body in link axes, so that it takes away the ones before it: it is tried last.
"""


def causes_in(file):
    """Those of FILE_CAUSES that the file has: its edit changes it."""
    before = Path(edited(file)).read_bytes()
    return [cause for cause in FILE_CAUSES if Path(edited(file, [cause])).read_bytes() != before]
