"""chain=: an arm cut out of a larger robot."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from urdf_text import joint, link, robot_text

import graphdyn
import urdf
from urdf.document.numbers import rotation_from_rpy

LINKS = [link(name, 1.0 + k, xyz=f"0.1 0.0{k} 0.2") for k, name in enumerate(
    ("ground", "torso", "mount", "head", "camera", "upper", "fore", "hand", "finger", "nail", "other")
)]  # fmt: skip
JOINTS = [
    joint("lift", "ground", "torso", "prismatic", '<origin xyz="0 0 1" rpy="0 0 0.3"/><axis xyz="0 0 1"/>'),
    joint("bolts", "torso", "mount", "fixed", '<origin xyz="0 0.2 0" rpy="0 0 0.1"/>'),
    joint("nod", "mount", "head", more='<origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>'),
    joint("eye", "head", "camera", "fixed"),
    joint("shoulder", "mount", "upper", more='<origin xyz="0.1 0 0" rpy="0.2 0 0"/><axis xyz="0 0 1"/>'),
    joint("elbow", "upper", "fore", more='<origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>'),
    joint("wrist", "fore", "hand", "fixed", '<origin xyz="0.1 0 0.2" rpy="0.1 0.2 0.3"/>'),
    joint("grip", "hand", "finger", "prismatic", '<origin xyz="0 0.03 0"/><axis xyz="0 1 0"/>'),
    joint("tip", "finger", "nail", "continuous", '<origin xyz="0.02 0 0"/><axis xyz="1 0 0"/>'),
    joint("leg", "ground", "other", more='<axis xyz="0 1 0"/>'),
]
HELD = (
    "movable joints beside the chain are locked at 0: 'grip', 'tip'; the chain carries their links; lock= (--lock) "
    "locks them at other values"
)
LEFT_OUT = (
    "movable joints on the base of the chain are left out: 'nod'; the base link supports what they carry, not the chain"
)


@pytest.fixture
def whole(robot):
    return robot(*LINKS, *JOINTS)


def told(path, **options):
    """The model, and the messages of the warnings without the path."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model = urdf.load(path, **options)
    assert {warning.category for warning in caught} <= {urdf.ChainWarning}
    assert {warning.filename for warning in caught} <= {__file__}
    return model, [str(warning.message).removeprefix(f"{path}: ") for warning in caught]


def same_dynamics(one, other):
    q = np.linspace(-0.7, 0.9, one.n_bodies)
    v = np.linspace(1.3, -0.4, one.n_bodies)
    for quantity in (graphdyn.mass_matrix(one, q) - graphdyn.mass_matrix(other, q),
                     graphdyn.bias_torque(one, q, v) - graphdyn.bias_torque(other, q, v)):  # fmt: skip
        assert_allclose(quantity, 0, atol=2e-14)


def test_the_arm(whole):
    model, said = told(whole, chain=("mount", "hand"))
    assert model.base_name == "mount"
    assert_array_equal(model.base.translation, np.zeros(3))
    assert_array_equal(model.base.rotation, np.eye(3))
    assert (model.joint_names, model.body_names) == (("shoulder", "elbow"), ("upper", "fore"))
    assert {frame.name: frame.body for frame in model.frames} == {"hand": 2, "finger": 2, "nail": 2}
    assert model.bodies[1].mass == sum(1.0 + k for k in (6, 7, 8, 9))
    assert said == [HELD, LEFT_OUT]


def test_the_same_as_a_file_cut_by_hand(whole, tmp_path):
    model, _ = told(whole, chain=("mount", "hand"), lock={"grip": 0.05, "tip": -0.4})
    by_hand = tmp_path / "hand.urdf"
    names = ("mount", "upper", "fore", "hand", "finger", "nail")
    links = [text for text in LINKS if any(f'name="{name}"' in text for name in names)]
    by_hand.write_text(robot_text("cut", *links, *JOINTS[4:9]), encoding="utf-8")
    same_dynamics(model, urdf.load(by_hand, lock={"grip": 0.05, "tip": -0.4}))


def test_the_same_as_the_whole_robot_held_still(whole):
    """Every other joint locked at zero; the base link stands upright there."""
    others = ["lift", "nod", "grip", "tip", "leg"]
    same_dynamics(told(whole, chain=("mount", "hand"))[0], urdf.load(whole, lock=others))


def test_values_for_what_is_carried_along(whole):
    model, said = told(whole, chain=("mount", "hand"), lock={"grip": 0.05, "tip": 0.0})
    assert said == [LEFT_OUT]
    finger, hand = model.frame("finger").placement, model.frame("hand").placement
    assert_allclose((hand.inverse() @ finger).translation, [0, 0.08, 0], atol=1e-15)


def test_a_joint_of_the_path_may_be_locked_too(whole):
    model, _ = told(whole, chain=("mount", "hand"), lock={"shoulder": 0.3, "grip": 0})
    assert model.joint_names == ("elbow",)


def test_the_tip_may_end_the_path_early(whole):
    model, said = told(whole, chain=("mount", "upper"))
    assert model.joint_names == ("shoulder",)
    assert said[0].startswith("movable joints beside the chain are locked at 0: 'elbow', 'grip', 'tip'")


def test_from_the_root(whole):
    model, said = told(whole, chain=["ground", "camera"])
    assert model.joint_names == ("lift", "nod")
    assert said == [
        HELD.replace("'grip'", "'shoulder', 'elbow', 'grip'"),
        LEFT_OUT.replace("'nod'", "'leg'"),
    ]


def test_a_whole_serial_arm_says_nothing(arm):
    path = arm()
    model, said = told(path, chain=("base", "tool"))
    assert said == []
    same_dynamics(model, urdf.load(path))


class TestTilt:
    """The base link of the chain is upright; where it was not, gravity must be given or is reported."""

    @pytest.fixture
    def tilted(self, robot):
        bolts = JOINTS[1].replace('rpy="0 0 0.1"', 'rpy="0.4 -0.7 0.2"')
        return robot(*LINKS, JOINTS[0], bolts, *JOINTS[2:])

    def test_reported(self, tilted):
        _, said = told(tilted, chain=("mount", "hand"), lock=["grip", "tip"])
        rotation = rotation_from_rpy(0, 0, 0.3) @ rotation_from_rpy(0.4, -0.7, 0.2)
        gravity = ", ".join(f"{x:.9g}" for x in rotation.T @ [0, 0, -9.81])
        assert said[1:] == [
            "base link 'mount' is tilted in the whole robot, but upright as the root of the chain; "
            f"gravity=({gravity}) restores the direction that gravity has in the whole robot with all joints at 0"
        ]

    def test_the_gravity_that_is_told_is_right(self, tilted):
        _, said = told(tilted, chain=("mount", "hand"), lock=["grip", "tip"])
        gravity = [float(x) for x in said[1].split("gravity=(")[1].split(")")[0].split(", ")]
        model, said = told(tilted, chain=("mount", "hand"), lock=["grip", "tip"], gravity=gravity)
        assert said == [LEFT_OUT]
        whole = urdf.load(tilted, lock=["lift", "nod", "grip", "tip", "leg"])
        q, v = [0.3, -0.5], [0.0, 0.0]
        # nine digits in the message
        assert_allclose(graphdyn.bias_torque(model, q, v), graphdyn.bias_torque(whole, q, v), rtol=1e-8)


def test_shares_of_fused_links(whole):
    shares = urdf.fused_links(whole, chain=("mount", "hand"))
    assert {name: number for name, (number, _) in shares.items()} == {"hand": 2, "finger": 2, "nail": 2}


def test_new_parameters_for_an_arm_of_the_robot(whole, tmp_path):
    """urdf.update counts the bodies as load does; what is carried along keeps its own <inertial>."""
    out, chain = tmp_path / "out.urdf", ("mount", "hand")
    model, _ = told(whole, chain=chain)
    parameters = np.array([body.parameters for body in model.bodies]) * 1.1
    with pytest.warns(urdf.ChainWarning):
        done = urdf.update(whole, out, parameters, chain=chain)
    assert done.changed == ("upper", "fore")
    again, _ = told(out, chain=chain)
    assert_allclose([body.parameters for body in again.bodies], parameters, rtol=1e-14, atol=1e-14)
    assert again.bodies[1].mass - urdf.load(whole).bodies[4].mass > 20  # fore has the rest, hand and fingers their own


def test_what_mimics_a_joint_that_the_chain_leaves_out(robot):
    mimic = [text.replace("<axis", '<mimic joint="nod"/><axis') if '"grip"' in text else text for text in JOINTS]
    path = robot(*LINKS, *mimic)
    with pytest.raises(
        urdf.InvalidMimic, match="joint 'grip': it mimics joint 'nod', which the robot lacks or the chain"
    ):
        urdf.load(path, chain=("mount", "hand"))
    model, _ = told(path, chain=("mount", "hand"), lock=["grip"])
    assert (model.n_bodies, model.couplings) == (2, ())


REFUSED = {
    "unknown link": (
        ("mount", "hnad"),
        r"robot.urdf: chain: there is no link 'hnad'; give one of 'head', 'hand'",
    ),
    "unknown and like nothing": (("zzz", "hand"), r"there is no link 'zzz'; give one of 'ground', 'torso', 'mount'"),
    "other branch": (
        ("head", "hand"),
        r"chain: no path leads from link 'head' to link 'hand': they are on different branches; both branch off at "
        r"link 'mount'; chain=\('mount', 'hand'\) \(--chain mount hand\) is a path",
    ),
    "wrong direction": (
        ("hand", "mount"),
        r"chain: link 'mount' comes before link 'hand'; exchange them: chain=\('mount', 'hand'\)",
    ),
    "the root as tip": (("hand", "ground"), r"link 'ground' comes before link 'hand'"),
    "no movable joint": (
        ("torso", "mount"),
        r"chain: no movable joint lies between link 'torso' and link 'mount'; take links further apart",
    ),
    "the same link twice": (("upper", "upper"), r"no movable joint lies between link 'upper' and link 'upper'"),
    "one name": ("upper", r"chain is 'upper'; give two link names: \(base_link, tip_link\)"),
    "two letters": ("ab", r"chain is 'ab'; give two link names"),
    "three names": (("a", "b", "c"), r"chain is \('a', 'b', 'c'\); give two link names"),
    "no names": ((1, 2), r"chain is \(1, 2\); give two link names"),
    "no sequence": (5, r"chain is 5; give two link names"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refusal(whole, case):
    chain, message = REFUSED[case]
    with pytest.raises(urdf.InvalidChain, match=message) as caught:
        urdf.load(whole, chain=chain)
    assert (caught.value.code, caught.value.path) == ("invalid-chain", whole)


def test_locks_of_joints_that_are_gone(whole):
    with pytest.raises(urdf.InvalidLock, match=r"cannot lock 'nod': .*; known: shoulder, elbow, grip, tip"):
        urdf.load(whole, chain=("mount", "hand"), lock=["nod"])


def test_everything_locked(whole):
    with pytest.raises(urdf.InvalidRobot, match="no moving body"):
        urdf.load(whole, chain=("mount", "hand"), lock=["shoulder", "elbow"])


def test_faults_of_the_whole_file_come_first(robot):
    with pytest.raises(urdf.NotATree, match="several root links"):
        urdf.load(robot(*LINKS, link("shelf"), *JOINTS), chain=("mount", "hand"))
