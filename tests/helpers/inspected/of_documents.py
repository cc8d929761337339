"""What urdf.inspect says of the document: its text, its names, what is not read, and what other readers do."""

from inspected.sample import MASS, TOOL, Case

DOCUMENTS = {
    "unread-dynamics": Case(
        ("</robot>", '<gazebo reference="fore"><turnGravityOff>true</turnGravityOff></gazebo></robot>'),
        "warning", "<turnGravityOff> of robot 'arm'", 37,
        "<turnGravityOff> in <gazebo> turns gravity off for a link: not read. Pinocchio and yourdfpy do not read it "
        "either",
        "change the model after loading it, if that matters",
    ),
    "unknown-element": Case(
        (TOOL, f'<link name="tool"><innertial>{MASS}</innertial></link>'),
        "warning", "<innertial> of link 'tool'", 17,
        "URDF knows no <innertial> in <link>: not read. Pinocchio and yourdfpy do not read it either",
        "correct its name, or remove it",
    ),
    "unknown-attribute": Case(
        ('xyz="0.3 0 0" rpy', 'xzy="0.3 0 0" rpy'),
        "warning", "<origin> of joint 'elbow'", 26,
        "URDF knows no attribute 'xzy' of <origin>: not read. Pinocchio and yourdfpy do not read it either",
        "correct its name, or remove it",
    ),
    "default-namespace": Case(
        ("<robot ", '<robot xmlns="http://www.ros.org" '),
        "note", None, 1,
        "the root element has the default namespace http://www.ros.org. Pinocchio ignores it, yourdfpy finds no "
        "link at all",
        "remove xmlns=… from <robot>",
    ),
    "extra-namespaces": Case(
        ("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" xmlns:controller="x" '),
        "note", None, None,
        "declared namespaces that URDF does not need: 'xacro', 'controller'",
        "remove them",
    ),
    "xacro-tags": Case(
        ("</robot>", '<xacro:arm_macro xmlns:xacro="http://www.ros.org/wiki/xacro"/></robot>'),
        "warning", None, 37,
        "xacro elements that are left in and ignored: 1 ('xacro:arm_macro')",
        "expand the file with xacro: what they stand for is missing",
    ),
    "mesh-files": Case(
        (
            TOOL,
            '<link name="tool"><visual><geometry><mesh '
            'filename="package://a/b.stl"/></geometry></visual><collision><geometry><mesh '
            'filename="c.stl"/></geometry></collision></link>',
        ),
        "note", None, 17,
        "mesh files, not opened because dynamics need none: 2, of which 1 at package:// paths",
        "no action needed",
    ),
    "unexpanded-text": Case(
        ('name="flange"', 'name="${prefix}flange"'),
        "warning", None, 32,
        "attributes with ${…} or $(…) that are not expanded: 1",
        "expand the file with xacro",
    ),
    "duplicate-material": Case(
        ("</robot>", '<material name="gray"/>\n<material name="gray"/></robot>'),
        "warning", None, 38,
        "material 'gray' is defined 2 times, first in line 37. Pinocchio refuses the file, yourdfpy loads it",
        "keep one of them",
    ),
    "non-ascii": Case(
        ('"tool"', '"Werkzeug ä"', '"tool"', '"Werkzeug ä"'),
        "note", None, 17,
        "the text is not all ASCII",
        "make sure that other tools read it",
    ),
    "shared-name": Case(
        ('name="flange"', 'name="tool"'),
        "note", "joint 'tool'", 32,
        "the link in line 17 has this name too: the frame of this name is the link's",
        "give one of them another name",
    ),
    "slash-in-name": Case(
        ('name="flange"', 'name="a/flange"'),
        "note", "joint 'a/flange'", 32,
        "a slash in the name",
        "some tools take it for a namespace or a folder",
    ),
    "urdf-version": Case(
        ('<robot name="arm">', '<robot name="arm" version="1.3">'),
        "warning", "robot 'arm'", 1,
        'version="1.3" is none of 1.0, 1.1, 1.2. Pinocchio refuses the file, yourdfpy loads it',
        "remove it",
    ),
    "processing-instruction": Case(
        (TOOL, f"{TOOL}<?hint x?>"),
        "warning", None, 17,
        "processing instructions <?…?> within the document: 1. Pinocchio refuses the file, yourdfpy loads it",
        "remove them",
    ),
    "name-spacing": Case(
        ('<child link="tool"/>', '<child link="\ntool"/>', 'name="tool"', 'name=" tool"'),
        "warning", "<child> of joint 'flange'", 35,
        "tabs or line breaks in link: an XML parser reads blanks. Pinocchio reads another name",
        "write blanks, or none",
    ),
    "number-spacing": Case(
        ('value="2.5"', 'value="2.5 "'),
        "warning", "<mass> of link 'upper'", 6,
        "blanks, tabs or line breaks in value that not every reader accepts. Pinocchio gives the link mass 0",
        "separate numbers by blanks, and put none after a single number",
    ),
    "incomplete-joint-part": Case(
        ('type="fixed">', 'type="fixed"><limit lower="0"/>'),
        "warning", "<limit> of joint 'flange'", 32,
        "without effort, velocity; dynamics do not need it. Pinocchio refuses the file",
        "correct it",
    ),
    "reserved-name": Case(
        ('name="shoulder"', 'name="universe"'),
        "warning", "joint 'universe'", 18,
        "the ground has this name in Pinocchio. Pinocchio loads the file and confuses the two, yourdfpy "
        "loads it",
        "rename it",
    ),
    "other-encoding": Case(
        ("<robot", '<?xml version="1.0" encoding="ISO-8859-1"?><robot', '"tool"', '"töol"', '"tool"', '"töol"'),
        "warning", None, 1,
        "the text is encoded in ISO-8859-1. Pinocchio reads it as UTF-8, with other names or numbers",
        "save it in UTF-8",
    ),
}  # fmt: skip
