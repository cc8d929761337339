"""Faults in reading a URDF file, planted by changing the file that the user code is built from."""

from faults.textbook import TextbookArm
from lxml import etree
from scipy.spatial.transform import Rotation
from urdf_text import inertial

import urdf

TOOLS = (
    f'<link name="gripper">{inertial(4.0, "0.05 0.02 0.1", tensor="0.02 0.001 0 0.03 0 0.01")}</link>'
    f'<link name="camera">{inertial(0.7, "0 0.01 0.02", tensor="0.002 0 0 0.001 0 0.001")}</link>'
    '<link name="marker"/>'
    '<joint name="screws" type="fixed"><origin xyz="0 0.01 0.05" rpy="0.2 0 0.4"/>'
    '<parent link="{last}"/><child link="gripper"/></joint>'
    '<joint name="bracket" type="fixed"><origin xyz="0.03 0 0.02" rpy="0 0.5 0"/>'
    '<parent link="{last}"/><child link="camera"/></joint>'
    '<joint name="point" type="fixed"><origin xyz="0 0.02 0.1"/>'
    '<parent link="gripper"/><child link="marker"/></joint></robot>'
)
"""Two sibling links on the last one, and a frame without mass on the first of them."""


def with_tools(path, folder):
    """The file with tools; its inertial frames turned, where the maker's are not."""
    text = path.read_text(encoding="utf-8")
    last = urdf.load(path).body_names[-1]
    robot = etree.fromstring(text.replace("</robot>", TOOLS.format(last=last)).encode())
    for number, origin in enumerate(robot.iterfind("link/inertial/origin")):
        if origin.get("rpy", "0 0 0").split() in (["0", "0", "0"], ["0.0", "0.0", "0.0"]) and number % 2:
            origin.set("rpy", f"0.3 {0.1 * number:.1f} -0.2")
    tooled = folder / f"{path.stem}_tools.urdf"
    tooled.write_bytes(etree.tostring(robot))
    return tooled


def plant(change):
    """The tooled file, and the arm of a code that reads it with this change of its elements."""

    def planted(path, folder):
        tooled = with_tools(path, folder)
        robot = etree.fromstring(tooled.read_bytes())
        change(robot)
        misread = folder / f"{path.stem}_misread.urdf"
        misread.write_bytes(etree.tostring(robot))
        return tooled, TextbookArm.of(urdf.load(misread))

    return planted


def rotations_ignored(robot):
    for origin in robot.iterfind("link/inertial/origin"):
        origin.set("rpy", "0 0 0")


def rotations_transposed(robot):
    for origin in robot.iterfind("link/inertial/origin"):
        angles = [float(x) for x in origin.get("rpy", "0 0 0").split()]
        back = Rotation.from_euler("xyz", angles).inv().as_euler("xyz")
        origin.set("rpy", " ".join(repr(float(x)) for x in back))


def massless_weigh_one(robot):
    for link in robot.iterfind("link"):
        if link.find("inertial") is None:
            link.append(etree.fromstring(inertial(1.0, "0 0 0", tensor="1 0 0 1 0 1")))


def dropped(*names):
    def change(robot):
        for link in robot.iterfind("link"):
            if link.get("name") in names:
                link.remove(link.find("inertial"))

    return change


def siblings_chained(robot):
    (joint,) = (joint for joint in robot.iterfind("joint") if joint.get("name") == "bracket")
    joint.find("parent").set("link", "gripper")


def inertial_origins_ignored(robot):
    for origin in robot.iterfind("link/inertial/origin"):
        origin.set("xyz", "0 0 0")
        origin.set("rpy", "0 0 0")


def rounded(robot):
    for inertial_ in robot.iterfind("link/inertial"):
        origin, tensor = inertial_.find("origin"), inertial_.find("inertia")
        origin.set("xyz", " ".join(f"{float(x):.3f}" for x in origin.get("xyz").split()))
        for name in tensor.attrib:
            tensor.set(name, f"{float(tensor.get(name)):.4f}")


FILE_PLANTS = [
    ("inertial rpy ignored", "ur5", plant(rotations_ignored), ("rpy.*(ignored|left out)",), "tensor|inertial"),
    ("inertial rpy ignored", "vx300s", plant(rotations_ignored), ("rpy.*(ignored|left out)",), "tensor|inertial"),
    (
        "inertial rpy transposed",
        "vx300s",
        plant(rotations_transposed),
        ("inertial frame.*transposed",),
        "tensor|inertial",
    ),
    ("massless links weigh 1 kg", "ur5", plant(massless_weigh_one), ("without <inertial>|massless",), "parameters"),
    ("massless links weigh 1 kg", "kinova", plant(massless_weigh_one), ("without <inertial>|massless",), "parameters"),
    ("gripper dropped", "kr500", plant(dropped("gripper")), ("gripper",), "parameters"),
    ("camera dropped", "z1", plant(dropped("camera")), ("camera",), "parameters"),
    ("both tools dropped", "kinova", plant(dropped("gripper", "camera")), ("gripper.*camera",), "link_6"),
    ("siblings chained", "kr210", plant(siblings_chained), ("bracket|camera",), "link_6"),
    ("rounded constants", "z1", plant(rounded), ("centers.*rounded to 3", "tensors.*rounded to 4"), "rounded"),
    ("inertial origins ignored", "z1", plant(inertial_origins_ignored), ("origin",), "parameters"),
]
"""Name, robot, plant, words that name the fault, words that locate it."""
