"""Nine MJCF files against MuJoCo itself: torques, accelerations, limits, constraints, notes."""

import builtins
import warnings

import mujoco
import numpy as np
import pytest
from robots.mjcf_files import FILES, Rigid, without_meshes, written

import graphdyn
import urdf

SHARE = 1e-12
"""Of the largest joint wrench; measured: 1.1e-15."""


def loaded(path, **reading):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.URDFWarning)
        return urdf.load(path, **reading)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("mjcf")


@pytest.mark.parametrize("name", FILES)
def test_torques_and_accelerations_are_those_of_mujoco(folder, name):
    path = written(folder, name)
    tree = loaded(path, repair=["geoms"]).opened.uncoupled
    rigid = Rigid(without_meshes(path), tree.joint_names)
    armature = np.array([joint.armature for joint in tree.joints])
    assert np.array_equal(armature, rigid.armature)
    rng = np.random.default_rng(0)
    q, v = tree.random_state(rng, 10)
    a = rng.standard_normal(q.shape)
    ours = graphdyn.inverse_dynamics(tree, q, v, a)
    scale = np.abs(ours.joint_wrenches).max()
    theirs = rigid.torques(q, v, a)
    assert np.abs(ours.tau + armature * a - theirs).max() <= SHARE * scale
    answered = rigid.accelerations(q, v, theirs)
    backward = graphdyn.inverse_dynamics(tree, q, v, answered).tau + armature * answered - theirs
    assert np.abs(backward).max() <= SHARE * scale


def test_frames_are_where_mujoco_has_them(folder):
    path = written(folder, "several_joints")
    model, native = loaded(path), mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(native)
    q, _ = model.random_state(np.random.default_rng(1))
    data.qpos[:] = q
    mujoco.mj_kinematics(native, data)
    for name in ("hand", "finger"):
        rotation, position = graphdyn.frame_placement(model, q, name)
        assert position == pytest.approx(data.body(name).xpos, abs=1e-14)
        assert rotation == pytest.approx(data.body(name).xmat.reshape(3, 3), abs=1e-14)


def test_joints_have_what_the_file_and_its_classes_say(folder):
    turn, slide, _ = loaded(written(folder, "forms")).joints
    assert (turn.damping, turn.friction, turn.armature) == (3, 0.4, 0.2)
    assert (turn.limits.lower, turn.limits.upper) == pytest.approx((-np.pi / 2, 2 * np.pi / 3))
    assert (turn.limits.effort, turn.limits.velocity, slide.kind) == (40, None, "prismatic")
    j1, j2, j3 = loaded(written(folder, "defaults")).joints
    assert (j1.armature, j1.friction, j1.damping, j1.limits.effort) == (0.5, 2, 1, 100)
    assert (j2.damping, j2.limits.lower) == (0.25, pytest.approx(-np.pi / 6))
    assert j3.armature == 0


def test_gravity_of_the_file_and_of_its_flag(folder):
    assert loaded(written(folder, "including")).gravity.tolist() == [1, 2, 3]
    assert loaded(written(folder, "welded")).gravity.tolist() == [0, 0, 0]


def test_equalities_couple_hold_and_close(folder):
    path = written(folder, "equalities")
    model = loaded(path)
    (coupling,) = model.couplings
    assert (coupling.joint, coupling.ratios) == ("right", {"left": 0.5})
    assert coupling.offset == pytest.approx(0.03 + 0.01 - 0.5 * 0.02)
    assert [chord.kind for chord in model.chords] == ["ball"]
    assert model.actuated == ("crank",)
    assert "brake" not in model.joint_names
    native = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(native)
    q, _ = model.random_state(np.random.default_rng(0))
    freedoms = model.degrees_of_freedom
    for name, value in zip(model.joint_names, freedoms.matrix @ q + freedoms.offset, strict=True):
        data.joint(name).qpos[:] = value
    data.joint("brake").qpos[:] = 0.4
    mujoco.mj_forward(native, data)
    held = data.efc_pos[: data.ne]
    assert len(held) == 5  # three of the ball, one each of two joints
    assert np.abs(held).max() < 1e-12


def test_welds_of_bodies_and_sites(folder):
    model = loaded(written(folder, "welded"))
    by_bodies, by_sites = model.chords
    assert (by_bodies.kind, by_sites.kind) == ("weld", "weld")
    assert by_sites.placement_i.translation.tolist() == [0, 0, 0.5]
    left, bar = (graphdyn.frame_placement(model.opened, np.zeros(4), name)[0] for name in ("left", "bar"))
    there = bar @ by_bodies.placement_j.rotation
    assert left @ by_bodies.placement_i.rotation == pytest.approx(there, abs=1e-14)


def test_geoms_give_inertia_only_when_asked(folder):
    path = written(folder, "geoms")
    with pytest.warns(urdf.UnreadWarning, match=r"body 'a' has no <inertial>; .*repair=\"geoms\""):  # noqa: SIM117
        with pytest.warns(urdf.MissingInertialWarning):
            assert urdf.load(path).bodies[0].mass == 0
    with pytest.warns(urdf.RepairWarning, match="body 'b': inertial computed from its geoms"):
        asked = urdf.load(path, repair=["geoms"])
    native = mujoco.MjModel.from_xml_path(str(path))
    assert [body.mass for body in asked.bodies] == native.body_mass[1:].tolist()
    with pytest.raises(urdf.InvalidRepair, match="'geoms' is for MJCF files"):
        urdf.load("ur5", repair=["geoms"])


ONE = (
    '<mujoco><worldbody><body name="b"{body}><inertial pos="0 0 1" mass="1" diaginertia="1 1 1"/>{joint}</body>'
    "</worldbody>{after}</mujoco>"
)
HINGE = '<joint name="j"/>'


def one(joint=HINGE, after="", body=""):
    return ONE.format(joint=joint, after=after, body=body)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (one('<joint name="j" stiffness="3"/>'), "line 1: joint 'j' has a spring of 3, which is no part of the model"),
        (one(body=' gravcomp="1"'), "body 'b' is lifted by gravcomp"),
        (
            one(after='<tendon><fixed name="t" stiffness="2"><joint joint="j" coef="1"/></fixed></tendon>'),
            "tendon 't' acts by its stiffness",
        ),
        (one(after='<option density="1.2"/>'), "the bodies move in a fluid"),
    ],
)
def test_what_is_no_part_of_the_model_is_noted_by_name(text, said):
    with pytest.warns(urdf.UnreadWarning, match=said):
        urdf.load(text)


TWO = (
    '<mujoco><worldbody><body name="b"><inertial pos="0 0 1" mass="1" diaginertia="1 1 1"/><joint name="j"/></body>'
    '<body name="c"><inertial pos="0 0 1" mass="1" diaginertia="1 1 1"/><joint name="k"/></body></worldbody>{}</mujoco>'
)


@pytest.mark.parametrize(
    ("text", "kind", "said"),
    [
        (one("<freejoint/>"), urdf.UnsupportedJoint, "joint '.*' of body 'b': is free; remove it"),
        (
            one('<joint type="ball"/>'),
            urdf.UnsupportedJoint,
            "of body 'b': is a ball joint; replace it by three",
        ),
        (one("<bdy/>"), urdf.InvalidMJCF, r"<text>:1: MuJoCo refuses the file: .*unrecognized element.*'bdy'"),
        (one('<joint name="j" axis="0 0 0"/>'), urdf.InvalidMJCF, "axis too small"),
        (one('<joint name="j" axis="0 0 nan"/>'), urdf.InvalidMJCF, "<joint>: attribute 'axis' is not a number"),
        (one('<joint name="j" axis="0 0"/>'), urdf.InvalidMJCF, "MuJoCo refuses the file: .*'axis'"),
        (one('<joint name="j" kind="x"/>'), urdf.InvalidMJCF, "MuJoCo refuses the file: .*unrecognized attribute"),
        (one('<joint name="j" class="gone"/>'), urdf.InvalidMJCF, "MuJoCo refuses the file: .*gone"),
        (one(HINGE * 2), urdf.InvalidMJCF, "MuJoCo refuses the file: .*repeated name"),
        (one(HINGE, "<include file='x.xml'/>"), urdf.InvalidMJCF, "includes 'x.xml', which text alone does not find"),
        (one("<composite/>"), urdf.UnsupportedJoint, "<composite>: its bodies deform"),
        (one('<replicate count="90000"/>'), urdf.TooLarge, "<replicate>: makes more than 2000 copies"),
        (one("<inertial mass='1'/>"), urdf.InvalidMJCF, "MuJoCo refuses the file"),
        (one(""), urdf.InvalidRobot, "no moving body"),
        (one()[:-20], urdf.MalformedXML, "not well-formed XML"),
        ("<mujoco/>", urdf.InvalidRobot, "no moving body"),
        (one().replace("1 1 1", "1 1 3"), urdf.InvalidMJCF, "inertia must satisfy A \\+ B >= C"),
        (one().replace("1 1 1", "-1 1 1"), urdf.InvalidMJCF, "MuJoCo refuses the file"),
        (one().replace('mass="1"', 'mass="-1"'), urdf.InvalidMJCF, "MuJoCo refuses the file"),
        (one().replace("1 1 1", "1 1 x"), urdf.InvalidMJCF, "bad format in attribute"),
        (one(after="<!DOCTYPE a>"), urdf.MalformedXML, "not well-formed XML"),
        (
            TWO.format('<equality><joint joint1="j" joint2="k" polycoef="0 1 1 0 0"/></equality>'),
            urdf.UnsupportedConstraint,
            "equality '.*': drives joint 'j' by a polynomial that is not linear",
        ),
        (
            TWO.format('<equality><joint joint1="j" joint2="k"/><joint joint1="j"/></equality>'),
            urdf.UnsupportedConstraint,
            "drives joint 'j', which another drives already",
        ),
        (
            TWO.format(
                '<tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>'
                '<equality><tendon name="e" tendon1="t"/></equality>'
            ),
            urdf.UnsupportedConstraint,
            "equality 'e': is neither of joints nor a connect or weld",
        ),
        (TWO.format('<equality><weld body1="b" body2="gone"/></equality>'), urdf.InvalidMJCF, "gone"),
        (TWO.format('<equality><connect body1="b" body2="c"/></equality>'), urdf.InvalidMJCF, "MuJoCo refuses"),
    ],
)
def test_bad_files_are_refused_with_place_and_remedy(text, kind, said):
    with pytest.raises(kind, match=said):
        loaded(text)


def test_included_files_are_looked_for_beside_the_file(tmp_path):
    path = tmp_path / "robot.xml"
    path.write_text(one(after='\n<include file="gone.xml"/>'))
    with pytest.raises(urdf.InvalidMJCF, match=r"robot.xml:2: <include>: there is no file 'gone.xml'; correct"):
        loaded(path)
    path.write_text(one(after='<include file="robot.xml"/>'))
    with pytest.raises(urdf.InvalidMJCF, match=r"'robot.xml' is included twice; include it once"):
        loaded(path)
    (tmp_path / "part.xml").write_text("<mujoco>\n\n<worldbody><body><freejoint name='f'/></body></worldbody></mujoco>")
    path.write_text(one(after='<include file="part.xml"/>'))
    with pytest.raises(urdf.UnsupportedJoint, match=r"joint 'f' of body 'body_2': is free"):
        loaded(path)


def test_without_mujoco_the_line_that_installs_it_is_said(monkeypatch):
    original = builtins.__import__

    def without(name, *arguments, **keywords):
        if name == "mujoco":
            raise ImportError
        return original(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(urdf.MujocoNotInstalled, match=r"read by MuJoCo, .*; pip install 'graphdyn\[mujoco\]'"):
        urdf.load(one())


def test_findings_have_the_lines_of_the_file(folder):
    findings = urdf.inspect(written(folder, "geoms")).findings
    assert {(finding.code, finding.line) for finding in findings} >= {("unread-dynamics", 4), ("missing-inertial", 8)}
