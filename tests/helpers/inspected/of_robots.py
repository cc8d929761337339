"""What urdf.inspect says of a whole robot: its loops, its lengths and masses, its mass matrix."""

from inspected.sample import (
    ELBOW,
    ELBOW_LIMIT,
    FAR,
    FORE,
    FORE_INERTIAL,
    LOOP,
    MOTOR,
    PARALLEL,
    Case,
    link_behind,
    mesh_file,
)

ROBOTS = {
    "loop-cannot-close": Case(
        ("</robot>", f"{LOOP.format('spherical')}{FAR}</loop></robot>"),
        "warning", None, None,
        "robot 'arm': the loop of chord 'l' is open by 7.2 m or rad; closed is 1e-08. None of 100 poses "
        "leads to a closed one: check where the chord stands on its bodies",
        "correct the loop, or the links on its way",
    ),
    "infinitesimal-mobility": Case(
        ("</robot>", '<loop name="l" type="distance"><predecessor link="base"><origin xyz="0 0 0.5"/></predecessor>'
         '<successor link="fore"><origin xyz="0.2 0 0"/></successor><length value="0.5"/></loop></robot>'),
        "warning", None, None,
        "robot 'arm': its loops close only stretched or folded: motions of elbow keep them closed to first order only "
        "(infinitesimal mobility 1), so that torques determine no accelerations and reactions; change lengths, or lock "
        "these joints",
        "correct the lengths, or lock these joints (lock=, --lock)",
    ),
    "unbound-joints": Case(
        (ELBOW, ELBOW.replace(">", ' independent="false">')),
        "warning", None, None,
        "joints marked independent=\"false\" that move by themselves: 'elbow'",
        "state the loops, couplings or mimic joints that they would follow from: in the file, in the YAML file of its "
        "name beside it, or as loops= (--loops)",
    ),
    "loop-rows": Case(
        ("</robot>", f"{PARALLEL}</robot>"),
        "note", None, None,
        "3 rows close loops: they hold 1 of 2 degrees of freedom and leave 1; redundant rows: 2, so that not all "
        "reactions are determined",
        "no action needed; graphdyn.assemble closes states",
    ),
    "idle-degrees-of-freedom": Case(
        ("</robot>", f"{PARALLEL}{MOTOR}</robot>"),
        "warning", None, None,
        "degrees of freedom that no motor drives: 1; with all motors held, joints 'elbow' can move",
        "lock one joint of each (lock=, --lock), or state more motors",
    ),
    "independent-contradiction": Case(
        (ELBOW, ELBOW.replace(">", ' independent="false">'), "</robot>", f"{PARALLEL}</robot>"),
        "warning", None, None,
        "the loops leave 1 degree of freedom, but the motions of the 1 joint that is not marked independent=\"false\" "
        "determine 0 of them: 'shoulder'",
        "mark as independent as many joints as there are degrees of freedom, so that they determine all others",
    ),
    "massless-closing-link": Case(
        (FORE_INERTIAL, "", "</robot>", f"{PARALLEL}</robot>"),
        "note", None, None,
        "loops close at bodies without mass: 'fore'. Pinocchio's constrained dynamics are NaN there",
        "no action needed, if other bodies of the loop have mass",
    ),
    "loops-not-examined": Case(
        ("</robot>", "".join(PARALLEL.replace('"l"', f'"l{k}"') for k in range(34)) + "</robot>"),
        "note", None, None,
        "the loops have 102 rows: more than 100 are not examined",
        "no action needed",
    ),
    "inconsistent-body": Case(
        ('izz="0.17"', 'izz="0.5"'),
        "warning", "link 'upper'", 3,
        "together with all links fixed to it, no physically possible body: the pseudo-inertia matrix has eigenvalue "
        "-0.12. Pinocchio and yourdfpy load it as it stands",
        "correct mass, center of mass and tensor",
    ),
    "suspicious-lengths": Case(
        ('xyz="0 0 0.5"', 'xyz="0 0 500"'),
        "warning", None, None,
        "the joints span 500 m along the longest branch",
        "give lengths in meters; they may be in millimeters",
    ),
    "suspicious-masses": Case(
        ('"2.5"', '"25000"'),
        "warning", None, None,
        "2.5e+04 kg on a reach of 1 m",
        "give masses in kg; they may be in grams or tonnes",
    ),
    "effort-below-gravity": Case(
        (ELBOW_LIMIT, ELBOW_LIMIT.replace('"30"', '"2"')),
        "warning", "<limit> of joint 'elbow'", 30,
        "gravity takes up to 5.88 N m within the limits of position, the effort is 2 N m",
        "give masses in kg, and the effort in N m or N at the joint, behind the gear",
    ),
    "effort-below-inertia": Case(
        (ELBOW_LIMIT, ELBOW_LIMIT.replace('"30"', '"0.2"')),
        "warning", "<limit> of joint 'elbow'", 30,
        "an effort of 0.2 N m accelerates the joint by 0.67 rad/s² in some poses",
        "give masses in kg, and the effort in N m or N at the joint, behind the gear",
    ),
    "heavy-link": Case(
        ("</robot>", f"{link_behind('fore', 'wrist', '32')}{link_behind('wrist', 'hand', '2')}</robot>"),
        "warning", "link 'wrist'", 37,
        "32 kg, 16 times the heavier of its neighbors (1.5 and 2 kg)",
        "compare its mass with the data sheet, and with a link of another robot of this family",
    ),
    "heaviest-link": Case(
        ("</robot>", f"{link_behind('fore', 'wrist', '1')}{link_behind('wrist', 'hand', '9')}</robot>"),
        "note", "link 'hand'", 37,
        "9 kg, more than all other moving links together (5 kg)",
        "compare its mass with the data sheet",
    ),
    "equal-inertials": Case(
        (
            "</robot>",
            f"{link_behind('fore', 'wrist', '1', mesh_file('wrist.stl'))}"
            f"{link_behind('wrist', 'hand', '1', mesh_file('hand.stl'))}</robot>",
        ),
        "note", "<inertial> of link 'wrist'", 37,
        "the inertial of 'hand', too, with other meshes",
        "give each link its own, if forces matter",
    ),
    "unlike-twin": Case(
        ("</robot>", f"{link_behind('fore', 'left_hand', '1')}{link_behind('fore', 'right_hand', '1.1')}</robot>"),
        "note", "<inertial> of link 'left_hand'", 37,
        "1 kg, where 'right_hand' has 1.1 kg",
        "give both the same, if they are mirror images",
    ),
    "mass-matrix-indefinite": Case(
        ('izz="0.17"', 'izz="-5"'),
        "warning", None, None,
        "the mass matrix has negative eigenvalues over 5 random states (seed 0): some motion has a negative "
        "kinetic energy",
        "correct the inertials that no real body can have",
    ),
    "mass-matrix-singular": Case(
        (FORE_INERTIAL, ""),
        "warning", None, None,
        "the mass matrix has rank 1 of 2 over 5 random states (seed 0): torques do not determine accelerations "
        "(bodies without mass or inertia: 'fore')",
        "give all moving links mass and inertia",
    ),
    "mass-matrix": Case(
        (),
        "note", None, None,
        "the mass matrix has rank 2 and condition number 1.12 to 3.56 over 5 random states (seed 0)",
        "no action needed",
    ),
    "mass-matrix-ill-conditioned": Case(
        (FORE_INERTIAL, f'<inertial><mass value="1e-9"/>{FORE.replace("0.0", "0.00000000005")}</inertial>'),
        "warning", None, None,
        "the condition number of the mass matrix reaches 5.27e+09: accelerations lose digits",
        "look for inertials that are far too small or too large",
    ),
}  # fmt: skip
