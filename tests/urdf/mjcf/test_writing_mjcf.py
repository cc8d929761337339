"""MJCF files that are written: torques of MuJoCo, all digits, and patches that change no other byte."""

import dataclasses
import re
import warnings

import mujoco
import numpy as np
import pytest
from robots.mjcf_files import FILES, Rigid, written
from shared_data import ARMS, existing

import graphdyn
import urdf

SHARE = 1e-12
"""Of the largest joint wrench, and of the largest parameter; measured: 1.1e-15."""


def loaded(path, **reading):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.URDFWarning)
        return urdf.load(path, **reading)


def check_torques(model, path):
    """MuJoCo computes from this file what graphdyn does from the model."""
    tree = model.opened.uncoupled
    rigid = Rigid(mujoco.MjModel.from_xml_path(str(path)), tree.joint_names)
    armature = np.array([joint.armature for joint in tree.joints])
    rng = np.random.default_rng(0)
    q, v = tree.random_state(rng, 5)
    a = rng.standard_normal(q.shape)
    ours = graphdyn.inverse_dynamics(tree, q, v, a)
    error = np.abs(ours.tau + armature * a - rigid.torques(q, v, a)).max()
    assert error <= SHARE * np.abs(ours.joint_wrenches).max()


@pytest.mark.parametrize("name", FILES)
def test_mujoco_computes_the_same_from_what_is_written(tmp_path, name):
    model = loaded(written(tmp_path, name), repair=["geoms"])
    urdf.save_mjcf(model, tmp_path / "out.xml")
    check_torques(model, tmp_path / "out.xml")
    again = loaded(tmp_path / "out.xml")
    for before, after in zip(model.joints, again.joints, strict=True):
        assert (before.name, before.limits, before.damping) == (after.name, after.limits, after.damping)
        assert (before.friction, before.armature) == (after.friction, after.armature)
    assert again.couplings == model.couplings
    assert [(chord.name, chord.kind) for chord in again.chords] == [(chord.name, chord.kind) for chord in model.chords]
    assert {frame.name for frame in model.frames} <= {frame.name for frame in again.frames} | set(again.body_names)


def test_makers_arms(tmp_path):
    path = tmp_path / "arm.xml"
    for arm in sorted(existing(ARMS).glob("*.urdf"))[::4]:
        model = loaded(arm)
        if all(one.consistent for one in model.physical_consistency()):
            urdf.save_mjcf(model, path)
            check_torques(model, path)
        else:
            with pytest.raises(urdf.CannotSave, match="MuJoCo refuses bodies with these inertials"):
                urdf.save_mjcf(model, path)


def test_massless_and_impossible_bodies_are_told_before(tmp_path):
    model = urdf.load("ur5")
    first, second, *others = model.bodies
    bad = (
        dataclasses.replace(first, inertia=np.diag([1.0, 1.0, 3.0])),
        dataclasses.replace(second, mass=0.0, inertia=np.zeros((3, 3))),
        *others[:-1],
        dataclasses.replace(others[-1], mass=0.0, inertia=np.zeros((3, 3))),
    )
    said = (
        r"MuJoCo refuses bodies with these inertials: 'shoulder_link' \(triangle inequality .*\), "
        r"'wrist_3_link' \(mass is zero\); give them real inertials, or lock their joints"
    )
    with pytest.raises(urdf.CannotSave, match=said):
        urdf.save_mjcf(dataclasses.replace(model, bodies=bad), tmp_path / "x.xml")
    assert not (tmp_path / "x.xml").exists()


def test_what_mujoco_has_no_place_for(tmp_path):
    model = urdf.load("ur5")
    one, two, three = model.joint_names[:3]
    coupled = dataclasses.replace(model, couplings=(graphdyn.Coupling(three, {one: 1.0, two: 2.0}),))
    with pytest.raises(urdf.CannotSave, match=r"is driven by 2 joints, and MuJoCo couples two; save model.uncoupled"):
        urdf.save_mjcf(coupled, tmp_path / "x.xml")
    rail = graphdyn.Chord("rail", "slide", 0, graphdyn.Placement(), 3, graphdyn.Placement())
    with pytest.raises(urdf.CannotSave, match="chord 'rail' is a slide, which MuJoCo has no equality for"):
        urdf.save_mjcf(dataclasses.replace(model, chords=(rail,)), tmp_path / "x.xml")
    named = dataclasses.replace(model, name="a\0b")
    with pytest.raises(urdf.CannotSave, match="a name cannot stand in XML"):
        urdf.save_mjcf(named, tmp_path / "x.xml")


def test_a_hinge_that_closes_a_loop_is_two_connects(tmp_path):
    path = written(tmp_path, "equalities")
    model = loaded(path)
    (ball,) = model.chords
    hinged = dataclasses.replace(model, chords=(dataclasses.replace(ball, kind="hinge"),))
    urdf.save_mjcf(hinged, tmp_path / "out.xml")
    native = mujoco.MjModel.from_xml_path(str(tmp_path / "out.xml"))
    names = [native.equality(k).name for k in range(native.neq)]
    assert names[-2:] == ["pin", "pin_axis"]
    assert [native.actuator(k).name for k in range(native.nu)] == ["crank"]


def changed(model):
    """Other inertials, armature, damping and friction everywhere."""
    bodies = [
        graphdyn.Body(body.name, 1.1 * body.mass, body.center_of_mass + 0.01, 1.2 * body.inertia) if body.mass else body
        for body in model.bodies
    ]
    joints = [
        dataclasses.replace(joint, armature=joint.armature + 0.3, damping=2 * joint.damping + 0.1, friction=0.7)
        for joint in model.joints
    ]
    return dataclasses.replace(model, bodies=tuple(bodies), joints=tuple(joints))


PATCHED = [name for name in FILES if name not in ("including", "attaching")]


@pytest.mark.parametrize("name", PATCHED)
def test_a_patch_changes_these_numbers_and_no_other_byte(tmp_path, name):
    path = written(tmp_path, name)
    data = path.read_bytes().replace(b"\n", b"\r\n")
    path.write_bytes(data)
    model = changed(loaded(path, repair=["geoms"]))
    done = urdf.patch_mjcf(model, path, tmp_path / "new.xml")
    assert done.joints == model.joint_names
    new = (tmp_path / "new.xml").read_bytes()
    assert _without_numbers(new) == _without_numbers(data)
    again = loaded(tmp_path / "new.xml")
    for wanted, found in zip(model.bodies, again.bodies, strict=True):
        assert np.abs(found.parameters - wanted.parameters).max() <= SHARE * max(1e-9, np.abs(wanted.parameters).max())
    for wanted, found in zip(model.joints, again.joints, strict=True):
        assert (found.armature, found.damping, found.friction) == (wanted.armature, wanted.damping, wanted.friction)


def _without_numbers(data):
    """The file without <inertial> elements, and without these attributes of <joint> in bodies."""
    head, body, rest = data.partition(b"<worldbody>")
    body = re.sub(rb"\s*<inertial [^>]*/>", b"", body + rest)
    return head + re.sub(rb' (damping|frictionloss|armature)="[^"]*"', b"", body)


ODD = """\
<?xml version='1.0' encoding='utf-8'?>\r
<!-- Größe: <inertial mass="9"/> --><mujoco\tmodel='été "x"'>\r
<worldbody><body name='Arm &lt;1&gt;'\tpos="0 0 .1"><!-- <joint name="a"/> -->\r
\t<inertial\r
\t\tmass = "2" pos='0 0 .1'\r
\t\tdiaginertia='.02 .02 .01'\r
\t/>\r
\t<joint\tname = 'a &amp; b'\r
axis='0 0 1' damping = '1'\r
armature='.1'></joint>\r
\t<body name='ü'><joint name="c" axis="1 0 0"/><inertial pos="0 0 0" mass=".3" diaginertia="1 1 1"></inertial>\
<body name="d"><joint name="d"/><site/><inertial pos="0 0 0" mass=".3" diaginertia="1 1 1"/></body></body></body>\r
</worldbody></mujoco>\r
<!-- end -->"""
"""Written by hand: other line ends, tabs, quotes, entities, several elements in one line."""


SECOND = '<inertial pos="0.0 0.0 0.0" mass="0.6" diaginertia="2.0 2.0 2.0"/>'
REPLACED = {
    """<inertial\r
\t\tmass = "2" pos='0 0 .1'\r
\t\tdiaginertia='.02 .02 .01'\r
\t/>""": '<inertial pos="0.0 0.0 0.1" mass="4.0" diaginertia="0.04 0.04 0.02"/>',
    '<inertial pos="0 0 0" mass=".3" diaginertia="1 1 1"></inertial>': SECOND,
    '<inertial pos="0 0 0" mass=".3" diaginertia="1 1 1"/>': SECOND,
    "armature='.1'": "armature='0.5'",
    '<joint name="c"': '<joint armature="0.5" name="c"',
    '<joint name="d"': '<joint armature="0.5" name="d"',
}


@pytest.mark.parametrize("encoding", ["utf-8", "iso-8859-1", "utf-8-sig"])
def test_a_patch_of_a_file_that_is_written_by_hand(tmp_path, encoding):
    data = ODD.replace("utf-8", encoding.removesuffix("-sig")).encode(encoding)
    (tmp_path / "odd.xml").write_bytes(data)
    model = loaded(tmp_path / "odd.xml")
    heavier = [graphdyn.Body(one.name, 2 * one.mass, one.center_of_mass, 2 * one.inertia) for one in model.bodies]
    armed = [dataclasses.replace(joint, armature=0.5) for joint in model.joints]
    new = dataclasses.replace(model, bodies=tuple(heavier), joints=tuple(armed))
    urdf.patch_mjcf(new, tmp_path / "odd.xml", tmp_path / "new.xml")
    wanted = ODD.replace("utf-8", encoding.removesuffix("-sig"))
    for old, numbers in REPLACED.items():
        wanted = wanted.replace(old, numbers)
    assert (tmp_path / "new.xml").read_bytes() == wanted.encode(encoding)


def test_utf_16_is_read_and_not_patched(tmp_path):
    (tmp_path / "odd.xml").write_bytes(ODD.replace("utf-8", "utf-16").encode("utf-16"))
    model = loaded(tmp_path / "odd.xml")
    assert model.joint_names == ("a & b", "c", "d")
    with pytest.raises(urdf.CannotUpdate, match=r"the file is in UTF-16 .*; save it as UTF-8 first"):
        urdf.patch_mjcf(model, tmp_path / "odd.xml", tmp_path / "new.xml")


@pytest.mark.parametrize(
    ("content", "message"),
    [(ODD[:200], "not well-formed XML"), ("", "the file is empty"), ("a = 1", "the file has no XML element")],
)
def test_a_patch_of_a_file_that_is_no_xml(tmp_path, content, message):
    (tmp_path / "bad.xml").write_text(content)
    with pytest.raises(urdf.MalformedXML, match=message):
        urdf.patch_mjcf(urdf.load("ur5"), tmp_path / "bad.xml", tmp_path / "new.xml")


def test_numbers_that_are_the_same_stay_as_they_are_written(tmp_path):
    for name in ("forms", "several_joints", "including"):
        path = written(tmp_path, name)
        done = urdf.patch_mjcf(loaded(path), path, tmp_path / "new.xml")
        assert (done.bodies, done.joints) == ((), ())
        assert (tmp_path / "new.xml").read_bytes() == path.read_bytes()


def test_bodies_that_are_fixed_keep_theirs_and_it_is_said(tmp_path):
    path = written(tmp_path, "forms")
    done = urdf.patch_mjcf(changed(loaded(path)), path, tmp_path / "new.xml")
    assert done.notes == ("body 'three' gets 0.79 kg: 'flange' (0.2 kg), fixed to it, keep their own <inertial>",)


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("forms", lambda m: urdf.load("ur5"), "only the robot has 'elbow_joint', .*; only the file has 'slide'"),
        ("including", changed, "joint 'joint_1': is not written in the file itself, but included, copied or without"),
        (
            "forms",
            lambda m: m.with_base(graphdyn.Placement(translation=np.array([0.1, 0, 0]))),
            r"joint 'turn': is placed otherwise than in robot 'forms' \(by 0.1\); inertials belong to link frames",
        ),
        (
            "forms",
            lambda m: m.with_inertial_parameters(m.inertial_parameters * 0.01),
            "body 'three': would get a mass of -0.191 kg; bodies fixed to it weigh as much or more by themselves",
        ),
        (
            "several_joints",
            lambda m: dataclasses.replace(m, bodies=(dataclasses.replace(m.bodies[0], mass=1.0), *m.bodies[1:])),
            "has mass, but stands between two joints of one body of the file; give it none",
        ),
    ],
)
def test_patches_that_cannot_be(tmp_path, name, change, said):
    path = written(tmp_path, name)
    with pytest.raises(urdf.CannotUpdate, match=said):
        urdf.patch_mjcf(change(loaded(path)), path, tmp_path / "new.xml")
    assert not (tmp_path / "new.xml").exists()


def test_settings_that_change_inertials_and_other_files(tmp_path):
    path = written(tmp_path, "defaults")
    path.write_text(path.read_text().replace('autolimits="true"', 'boundmass="0.001"'))
    with pytest.raises(urdf.CannotUpdate, match=r"settings of <compiler> change the inertials .*: boundmass; remove"):
        urdf.patch_mjcf(changed(loaded(path)), path, tmp_path / "new.xml")
    arm = tmp_path / "arm.urdf"
    urdf.save(urdf.load("ur5"), arm)
    with pytest.raises(urdf.CannotUpdate, match="the file is not MJCF; give a file whose root element is <mujoco>"):
        urdf.patch_mjcf(urdf.load("ur5"), arm, tmp_path / "new.xml")
    with pytest.raises(urdf.CannotUpdate, match=r"the file is MJCF, not URDF; urdf.patch_mjcf \(graphdyn export"):
        urdf.update(path, tmp_path / "new.xml", np.ones(30))
