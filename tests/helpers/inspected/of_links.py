"""What urdf.inspect says of links and their inertias."""

from inspected.sample import FORE, FORE_INERTIAL, INERTIA, MASS, ORIGIN, TOOL, Case

LINKS = {
    "root-inertia": Case(
        (
            '<link name="base"/>',
            '<link name="base"><inertial><origin xyz="0 0 0"/><mass value="3"/><inertia ixx="0.1" ixy="0" ixz="0" '
            'iyy="0.11" iyz="0" izz="0.12"/></inertial></link>',
        ),
        "note", "<inertial> of link 'base'", 2,
        "a mass of 3 kg that never moves: load drops it, and no torque regressor contains it. Pinocchio keeps it "
        "apart, as inertia of the universe",
        "no action needed",
    ),
    "missing-inertial": Case(
        (FORE_INERTIAL, ""),
        "warning", "link 'fore'", 10,
        "the link moves and has no <inertial> (nor has any link fixed to it): its mass is zero. Pinocchio gives "
        "the link mass 0, yourdfpy none",
        "write an <inertial>",
    ),
    "fused-mass": Case(
        (
            TOOL,
            '<link name="tool"><inertial><origin xyz="0 0 0"/><mass value="0.5"/><inertia ixx="0.1" ixy="0" ixz="0" '
            'iyy="0.11" iyz="0" izz="0.12"/></inertial></link>',
        ),
        "note", "<inertial> of link 'tool'", 17,
        "the link is fixed: its 0.5 kg are added to the body of link 'fore'. Pinocchio does the same",
        "no action needed; urdf.fused_links gives the shares",
    ),
    "inertial-origin-missing": Case(
        (ORIGIN, ""),
        "note", "<inertial> of link 'upper'", 4,
        "without <origin>: the center of mass is the link origin",
        "write <origin>, if that is not meant",
    ),
    "inertial-rotated": Case(
        ('xyz="0 0 0.4" rpy="0 0 0"', 'xyz="0 0 0.4" rpy="0 0 0.3"'),
        "note", "<origin> of link 'fore'", 12,
        "the inertial frame is rotated: the tensor is turned into link axes",
        "no action needed",
    ),
    "off-diagonal-inertia": Case(
        ('ixy="0"', 'ixy="0.01"'),
        "note", "<inertia> of link 'upper'", 7,
        "the tensor has off-diagonal entries",
        "no action needed",
    ),
    "zero-mass": Case(
        (MASS, '<mass value="0"/>', INERTIA, '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'),
        "warning", "<mass> of link 'upper'", 6,
        "the mass is zero. Pinocchio and yourdfpy load it as it stands",
        "give the mass",
    ),
    "zero-inertia": Case(
        (FORE, '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'),
        "warning", "<inertia> of link 'fore'", 14,
        "1.5 kg with an inertia tensor of zero: a point mass. Pinocchio and yourdfpy load it as it stands",
        "give the tensor",
    ),
    "inertial-density": Case(
        (MASS, '<mass value="2500"/>'),
        "warning", "<inertial> of link 'upper'", 4,
        "a body of 2500 kg with this tensor has 4.23e+08 kg/m³ or more in some place, osmium has 22590",
        "give the mass in kg, and the tensor in kg m² about the center of mass",
    ),
    "tiny-mass": Case(
        ('"2.5"', '"1e-6"'),
        "warning", "<mass> of link 'upper'", 6,
        "the mass is 1e-06 kg",
        "give the mass in kg; it looks like a placeholder",
    ),
    "indefinite-inertia": Case(
        ('ixx="0.11"', 'ixx="-0.11"'),
        "warning", "<inertia> of link 'upper'", 7,
        "the tensor has a negative principal moment, -0.11 kg m²: no real body has one; with ixx without its sign it "
        "is possible. Pinocchio and yourdfpy load it as it stands",
        "correct the tensor; a sign may be wrong, or entries swapped",
    ),
    "singular-inertia": Case(
        (FORE, '<inertia ixx="0.06" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0"/>'),
        "warning", "<inertia> of link 'fore'", 14,
        "the tensor is singular: smallest principal moment 0 kg m². Pinocchio and yourdfpy load it as it stands",
        "give all moments",
    ),
    "triangle-inequality": Case(
        ('izz="0.17"', 'izz="0.5"'),
        "warning", "<inertia> of link 'upper'", 7,
        "principal moment 0.5 exceeds the sum 0.24 kg m² of the others. Pinocchio and yourdfpy load it as it stands",
        "correct the tensor: it must be about the center of mass, in kg m²",
    ),
    "isotropic-inertia": Case(
        (INERTIA, '<inertia ixx="0.11" ixy="0" ixz="0" iyy="0.11" iyz="0" izz="0.11"/>'),
        "note", "<inertia> of link 'upper'", 7,
        "the same moment about every axis, as of a sphere: probably a guess",
        "give the measured tensor, if forces matter",
    ),
    "gyration-radius": Case(
        (INERTIA, '<inertia ixx="11" ixy="0" ixz="0" iyy="13" iyz="0" izz="17"/>'),
        "warning", "<inertial> of link 'upper'", 4,
        "the radius of gyration is 2.61 m, the link reaches 0.374 m: tensor and mass do not fit",
        "give kg, m and kg m²; the tensor may be in kg mm² or g mm², or about another point",
    ),
    "far-center-of-mass": Case(
        ('xyz="0.1 0.2 0.3"', 'xyz="100 200 300"'),
        "warning", "<origin> of link 'upper'", 5,
        "the center of mass is 374 m from the origin of the link",
        "give it in meters, in the link frame; it may be in millimeters",
    ),
}  # fmt: skip
