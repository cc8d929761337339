"""What urdf.inspect says of a whole robot: its loops, its lengths and masses, its mass matrix."""

from inspected.sample import ELBOW, FAR, FORE, FORE_INERTIAL, LOOP, MOTOR, PARALLEL, Case

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
