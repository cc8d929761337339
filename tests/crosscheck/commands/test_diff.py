"""`graphdyn diff`: the words of the terminal, the JSON file, the page, a file with other inertials, and bad input."""

import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from lxml import etree
from robots.disguised import planted
from robots.ur5e_like import MASSES, NAMES, OTHER_MASSES, SHIFTS, ur5e_like
from shared_data import ARMS, DATA, REPOSITORY, existing

import urdf
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from graphdyn import Body, Joint, JointLimits, Placement, RobotModel
from graphdyn.model import rotation_about

SCHEMA = json.loads((REPOSITORY / "docs/schemas/diff-1.schema.json").read_text(encoding="utf-8"))

BODY = '<body name="x"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """An arm as URDF; the same heavier; an MJCF file of another one with a base that is turned by 90°."""
    place = tmp_path_factory.mktemp("robots")
    arm = ur5e_like()
    urdf.save(arm, place / "arm.urdf")
    urdf.save(ur5e_like(OTHER_MASSES), place / "other.urdf")
    measured = ur5e_like(OTHER_MASSES, SHIFTS)
    turned = Placement(rotation_about([0, 0, 1], np.pi / 2), np.zeros(3))
    first = replace(measured.joints[0], placement=turned @ measured.joints[0].placement)
    urdf.save_mjcf(replace(measured, joints=(first, *measured.joints[1:])), place / "arm.xml")
    return place


@pytest.fixture
def run(program, folder, monkeypatch):
    monkeypatch.chdir(folder)
    return lambda *arguments: program("diff", *arguments)


def test_a_robot_and_itself(run):
    done = run("arm.urdf", "arm.urdf", "--samples", 10)
    assert done.code == AGREED, done.err
    assert "same model" in done.out
    assert "nothing had to be changed but link frames" in done.out


def test_another_gravity_is_told(run, tmp_path):
    urdf.save_mjcf(replace(ur5e_like(), gravity=np.array([0, 0, -9.8])), tmp_path / "light.xml")
    done = run("arm.urdf", tmp_path / "light.xml", "--samples", 10)
    assert "B's gravity is (0, 0, -9.8) m/s² in A's world; torques of both are under A's" in " ".join(done.out.split())


def test_a_limit_that_a_format_cannot_state_does_not_count(run, tmp_path):
    urdf.save_mjcf(ur5e_like(), tmp_path / "same.xml")
    done = run("arm.urdf", tmp_path / "same.xml", "--samples", 10)
    assert "only A states limits of velocity (all joints): not counted" in done.out
    assert done.code == AGREED


@pytest.mark.usefixtures("unpictured")
def test_an_mjcf_file_with_a_turned_base_displaced_axes_and_other_masses(run, tmp_path):
    done = run("arm.urdf", "arm.xml", "--samples", 20, "--json", tmp_path / "d.json", "--html", tmp_path / "d.html")
    assert done.code == DISAGREED, done.err
    assert "B's base is turned by -90° about z" in done.out
    data = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(data)
    assert data["verdict"] == "different robots"
    assert data["map"]["zeros"] == pytest.approx([0] * 6, abs=5e-3)  # displaced axes trade with zeros, 1 mm in 0.4 m
    assert {each["joint"] for each in data["joints"]} <= {f"{name}_joint" for name in NAMES}
    assert max(each["value"] for each in data["joints"] if each["kind"] == "length") == pytest.approx(1.1e-3, rel=0.2)
    masses = {each["link"]: each["value"] for each in data["links"] if each["kind"] == "mass"}
    gains = {name: other - mass for name, mass, other in zip(NAMES, MASSES, OTHER_MASSES, strict=True)}
    expected = {f"{name}_link": gain for name, gain in gains.items() if gain}
    assert masses == pytest.approx(expected)
    assert "one over the other" in (tmp_path / "d.html").read_text(encoding="utf-8")


def test_all_that_may_be_the_cause_is_told(run, tmp_path):
    """Without inertia, a first axis that is tilted is as well a base and all that follows."""
    arm = ur5e_like()
    light = replace(arm, bodies=tuple(Body(one.name, 0.0, np.zeros(3), np.zeros((3, 3))) for one in arm.bodies))
    urdf.save(light, tmp_path / "light.urdf")
    urdf.save(planted(light, np.random.default_rng(0), "axis", 1), tmp_path / "tilted.urdf")
    files = tmp_path / "light.urdf", tmp_path / "tilted.urdf"
    done = run(*files, "--samples", 10, "--json", tmp_path / "d.json")
    said = " ".join(done.out.split())
    assert "its axis differs by 0.1° in link 'base', or the angle of 'lift_joint'" in said
    assert "│ pan_joint │ axis │ base │ 0.1° │ the angle of 'lift_joint' │" in said
    (joint,) = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))["joints"]
    assert joint["or_else"] == [{"element": "lift_joint", "kind": "angle"}]


def cell(arm):
    """The arm on a rail, with a gripper, and names without `_joint`."""
    x, y, z = np.eye(3)
    joints = [Joint("rail", "prismatic", 0, Placement(), y, JointLimits(-1, 1))]
    joints += [replace(one, name=one.name.removesuffix("_joint"), inside=one.inside + 1) for one in arm.joints]
    hand = arm.n_bodies + 1
    joints += [Joint(f"finger_{k}", "prismatic", hand, Placement(translation=0.1 * z), k * x) for k in (-1, 1)]
    bodies = [Body(name, 1.0, np.zeros(3), np.eye(3)) for name in ("sled", "left", "right")]
    return RobotModel("cell", (bodies[0], *arm.bodies, *bodies[1:]), tuple(joints))


def test_joints_that_only_one_robot_has_by_name_are_held(run, tmp_path):
    urdf.save_mjcf(cell(ur5e_like()), tmp_path / "cell.xml")
    done = run("arm.urdf", tmp_path / "cell.xml", "--samples", 10, "--json", tmp_path / "d.json")
    said = " ".join(done.out.split())
    assert "B's joints 'rail', 'finger_-1', 'finger_1' are held at 0: A has none of these names" in said
    data = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    assert data["held"] == [[], ["rail", "finger_-1", "finger_1"]]
    assert {each["link"] for each in data["links"]} == {"wrist_3_link"}  # which the fingers are now part of
    turned = run(tmp_path / "cell.xml", "arm.urdf", "--samples", 10)
    assert "A's joints 'rail', 'finger_-1', 'finger_1' are held at 0" in " ".join(turned.out.split())


def test_a_makers_arm_in_a_cell(run, tmp_path):
    file = existing(ARMS / "ur5e.urdf")
    urdf.save_mjcf(cell(urdf.load(file)), tmp_path / "cell.xml")
    done = run(file, tmp_path / "cell.xml", "--samples", 10)
    assert "'shoulder_pan_joint' = 'shoulder_pan'" in " ".join(done.out.split())
    assert "Kinematics" not in done.out


def test_the_table_of_an_arm_and_its_urdf_file_differ_as_the_guide_says(program, tmp_path, monkeypatch):
    shutil.copy(existing(DATA / "data/tx40/tx40.urdf"), tmp_path)
    shutil.copy(REPOSITORY / "crosscheck/study/configurations/tx40.toml", tmp_path)
    monkeypatch.chdir(tmp_path)
    shown = (REPOSITORY / "docs/dh.md").read_text(encoding="utf-8").split("$ graphdyn diff tx40.toml tx40.urdf\n")[1]
    said = program("diff", "tx40.toml", "tx40.urdf").out.splitlines()
    rounded = re.compile("parts by .*? m at")  # of lengths that are equal
    missing = {rounded.sub("", line).strip() for line in shown.split("```")[0].splitlines()}
    assert not missing - {rounded.sub("", line).strip() for line in said}


def test_names_that_contradict_the_chain_are_told(run, tmp_path):
    arm = ur5e_like()
    order = [0, 2, 1, 3, 4, 5]
    joints = tuple(replace(one, name=arm.joint_names[k]) for one, k in zip(arm.joints, order, strict=True))
    urdf.save(replace(arm, joints=joints), tmp_path / "exchanged.urdf")
    said = " ".join(run("arm.urdf", tmp_path / "exchanged.urdf", "--samples", 10).out.split())
    assert "; joints of the same name are at other places" in said
    assert "'lift_joint' at 2 in A and at 3 in B, 'elbow_joint' at 3 in A and at 2 in B" in said


def test_the_order_of_the_elements_of_a_file_does_not_matter(run, folder, tmp_path):
    root = etree.parse(folder / "arm.urdf").getroot()
    root[:] = reversed(root)
    (tmp_path / "reversed.urdf").write_bytes(etree.tostring(root))
    done = run("arm.urdf", tmp_path / "reversed.urdf", "--samples", 10)
    assert done.code == AGREED
    assert "nothing had to be changed but link frames" in done.out


def test_the_inertials_of_the_other_robot(run, tmp_path):
    out = tmp_path / "better.urdf"
    done = run("arm.urdf", "other.urdf", "--samples", 10, "--use-inertials-of", "B", "--out", out)
    assert done.code == DISAGREED, done.err
    assert "new inertials of pan_link, lift_link, elbow_link, wrist_3_link" in " ".join(done.out.split())
    assert [body.mass for body in urdf.load(out).bodies] == pytest.approx(OTHER_MASSES)
    assert run(out, "other.urdf", "--samples", 10).code == AGREED
    back = tmp_path / "back.urdf"
    run("arm.urdf", "other.urdf", "--samples", 10, "--use-inertials-of", "A", "--out", back)
    assert run(back, "arm.urdf", "--samples", 10).code == AGREED


def test_a_model_of_export_and_the_arm_before_a_gripper(run, program, tmp_path):
    exported = tmp_path / "arm.json"
    program("export", "arm.urdf", "--to", exported)
    done = run("arm.urdf", exported, "--samples", 10)
    assert done.code == AGREED, done.out
    shortened = run("arm.urdf", "other.urdf", "--tip", "lift_link", "--samples", 10, "--json", tmp_path / "d.json")
    assert shortened.code == DISAGREED
    data = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    assert data["joint_names"] == [["pan_joint", "lift_joint"]] * 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("arm.urdf", "nowhere.urdf"), "nowhere.urdf"),
        (("arm.urdf", "cut.urdf"), "cut.urdf"),
        (("arm.urdf", "wrong.json"), "not in the format 'graphdyn export 1'; give a file that"),
        (("arm.urdf", "text.json"), "not a JSON file"),
        (("arm.urdf", "deep.json"), "deep.json: not a JSON file (maximum recursion depth exceeded"),
        (("arm.urdf", "heavy.json"), "heavy.json: a value has the wrong type"),
        (("arm.urdf", "unnamed.json"), "unnamed.json: a value has the wrong type (7 is no name)"),
        (("arm.urdf", "light.json"), "light.json: body 'b': mass -1.0 kg is negative"),
        (("arm.urdf", "ball.xml"), "ball.xml"),
        (("arm.urdf", "arm.urdf", "--tip", "nothing"), "nothing"),
        (("arm.urdf", "TwoDofs"), "robot 'ur5e_like' has 6 joints"),
        (("arm.urdf", "arm.urdf", *("--tip", "-") * 3), "--tip is given 3 times; give it once, or for A and for B"),
        (("light.json", "arm.urdf", "--tip", "b"), "--tip b: light.json is a model that is cut already"),
        (("arm.urdf", "arm.urdf", "--tolerance", "0"), "tolerance is 0; give a number above zero"),
        (("arm.urdf", "arm.urdf", "--samples", "0"), "--samples"),
        (("arm.urdf", "arm.urdf", "--out", "c.urdf"), "--use-inertials-of and --out belong together"),
        (("arm.xml", "arm.urdf", "--use-inertials-of", "B", "--out", "c.urdf"), "arm.xml is no URDF file"),
        (("arm.urdf",), "takes 2 values"),
    ],
)
def test_bad_input(run, folder, words, arguments, message):
    body = {"number": 1, "name": "b", "joint": "j", "kind": "revolute", "parent": 0, "axis": [0, 0, 1], "mass": -1}
    body |= dict.fromkeys(("lower", "upper", "velocity", "effort")) | {"damping": 0, "friction": 0, "armature": 0}
    body |= {"rotation": np.eye(3).tolist(), "translation": [0] * 3, "center_of_mass": [0] * 3}
    model = {"format": "graphdyn export 1", "robot": "r", "versions": {}, "warnings": [], "locked": {}, "chain": None}
    model |= {"n": 1, "gravity": [0, 0, -9.81], "base_rotation": np.eye(3).tolist(), "base_translation": [0] * 3}
    light = model | {"bodies": [body | {"inertia": np.eye(3).tolist()}], "frames": []}
    heavy = light | {"robot": "h", "bodies": [light["bodies"][0] | {"mass": 1}]}
    (folder / "unnamed.json").write_text(json.dumps(heavy | {"robot": 7}), encoding="utf-8")
    (folder / "light.json").write_text(json.dumps(light), encoding="utf-8")
    (folder / "heavy.json").write_text(json.dumps(heavy | {"bodies": None}), encoding="utf-8")
    (folder / "wrong.json").write_text("{}", encoding="utf-8")
    (folder / "text.json").write_text("{", encoding="utf-8")
    (folder / "deep.json").write_text("[" * 100_000, encoding="utf-8")
    (folder / "cut.urdf").write_text((folder / "arm.urdf").read_text(encoding="utf-8")[:900], encoding="utf-8")
    ball = f'<mujoco><worldbody>{BODY}<joint type="ball"/></body></worldbody></mujoco>'
    (folder / "ball.xml").write_text(ball, encoding="utf-8")
    done = run(*arguments)
    assert done.code == BAD_INPUT
    assert message in words(done.err)
