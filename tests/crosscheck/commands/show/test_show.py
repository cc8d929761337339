"""`graphdyn show`: the description, and the terminal, the file and the page made of it."""

import dataclasses
import functools
import json
import re
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
from planting import mixed_tree
from typer.testing import CliRunner

import graphdyn
import urdf
from crosscheck.commands import app
from crosscheck.commands.program import console
from crosscheck.commands.show.description import describe
from crosscheck.commands.show.matrix_pattern import BRAILLE, HALF_BLOCKS, characters
from crosscheck.commands.show.record import record as record_of
from crosscheck.commands.show.report import show_report
from crosscheck.commands.show.state import describe_state
from crosscheck.reference.subject import tip
from crosscheck.report.html import page
from crosscheck.report.plain_text import matrix_lines, vector_text
from crosscheck.report.records.record import plain, versions
from crosscheck.report.text import renderables
from graphdyn import kkt_system, kr500
from graphdyn.model.spatial import rotation_about

NARROW = 80


TREE, ARM = mixed_tree(), kr500()

robot_called = functools.cache(urdf.load)


@pytest.fixture(scope="module")
def tree():
    return describe(TREE, "tree")


@pytest.fixture(scope="module")
def written(tree):
    """What the JSON file says of the tree."""
    return plain(record_of(tree))


@pytest.fixture(scope="module")
def arm():
    return describe(ARM, "kr500")


def show(*arguments):
    return CliRunner().invoke(app, ["show", *map(str, arguments)])


def shown(description, width, monkeypatch):
    """What the terminal shows at this width."""
    monkeypatch.setattr(console.out, "width", width)
    with console.out.capture() as captured:
        for part in renderables(show_report(description), width):
            console.out.print(part)
    return captured.get()


def page_of(description, robot="kr500"):
    return page(show_report(description), ["graphdyn", "show", robot], versions())


class TestDescription:
    def test_bodies(self, written):
        for number, (record, body) in enumerate(zip(written["bodies"], TREE.bodies, strict=True), start=1):
            assert (record["number"], record["name"], record["mass"]) == (number, body.name, body.mass)
            assert np.array_equal(record["center_of_mass"], body.center_of_mass)
            assert np.sum(record["principal_moments"]) == pytest.approx(np.trace(body.inertia))
            assert record["principal_moments"] == sorted(record["principal_moments"])
        assert written["total_mass"] == pytest.approx(sum(body.mass for body in TREE.bodies))

    def test_joints(self, written):
        names = (written["base"], *TREE.body_names)
        for j, (record, joint) in enumerate(zip(written["joints"], TREE.joints, strict=True), start=1):
            assert (record["number"], record["name"], record["kind"]) == (j, joint.name, joint.kind)
            assert (record["inside"], record["body"]) == (names[joint.inside], names[j])
            for limit in ("lower", "upper", "velocity", "effort"):
                assert record[limit] == getattr(joint.limits, limit)
            assert (record["damping"], record["friction"]) == (joint.damping, joint.friction)
            roll, pitch, yaw = np.deg2rad(record["rpy"])
            x, y, z = np.eye(3)
            rotation = rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)
            assert np.allclose(rotation, joint.placement.rotation, rtol=0, atol=1e-12)
            assert np.array_equal(record["xyz"], joint.placement.translation)

    def test_graph(self, written):
        graph = written["graph"]
        assert np.array_equal(-np.array(graph["incidence"]) @ graph["path"], np.eye(3))
        assert graph["force_element"] == graph["incidence"]
        assert np.array_equal(graph["body_joint_vectors"], TREE.body_joint_vectors())

    def test_system(self, arm):
        """The pattern is that of the matrix: nothing large is left out, rounding is."""
        system = arm.system
        q, pattern = system.q, system.pattern
        matrix = kkt_system(ARM, q, np.zeros(6), np.zeros(6)).matrix
        assert np.array_equal(q, ARM.random_state(np.random.default_rng(0))[0])
        assert system.size == 66
        assert pattern.shape == (66, 66)
        assert np.array_equal(pattern, pattern.T)
        assert np.abs(matrix[~pattern]).max() < 1e-14 * np.abs(matrix).max()
        assert not matrix[~pattern].all()  # structural zeros
        assert np.abs(matrix[pattern]).min() > 0
        assert (system.rank, system.condition_number) == (66, pytest.approx(np.linalg.cond(matrix)))

    @pytest.mark.parametrize("factor", [1e-18, 1e18])
    def test_pattern_in_other_units(self, factor):
        """Masses in exagrams or attograms: the same entries are none."""
        tree = mixed_tree()
        other = tree.with_inertial_parameters(factor * tree.inertial_parameters)
        one, same = (describe(model, "tree").system.pattern for model in (tree, other))
        assert np.array_equal(one, same)

    def test_frames_and_locked(self, small_arm):
        description = describe(
            urdf.load(small_arm, lock={"y_elbow": 0.3}), "small", urdf.Reading(lock={"y_elbow": 0.3})
        )
        found = plain(record_of(description))
        names = {name for frame in found["frames"] for name in (frame["name"], *frame["aliases"])}
        assert {"tool", "flange", "fore", "y_elbow"} <= names
        assert (found["locked"], found["chain"]) == ({"y_elbow": 0.3}, None)
        assert len(found["bodies"]) == 2


class TestPicture:
    def test_every_entry_is_drawn_once(self, arm):
        """Half blocks hold two rows of one column."""
        lines = characters(arm.system.pattern, 6, NARROW)
        drawn = "".join(lines)
        assert 2 * drawn.count("█") + drawn.count("▀") + drawn.count("▄") == arm.system.pattern.sum()
        assert {len(line) for line in lines} == {len(lines[0])}
        assert len(lines[0]) <= NARROW

    def test_braille_has_every_entry_too(self, arm):
        lines = characters(arm.system.pattern, 6, 60)
        dots = sum((ord(character) - 0x2800).bit_count() for character in "".join(lines) if character >= "\u2800")
        assert dots == arm.system.pattern.sum()
        assert len(lines[0]) <= 60

    def test_no_room(self, arm):
        assert characters(arm.system.pattern, 6, 40) == []

    def test_characters(self):
        cell = np.array([[1, 0], [0, 1], [0, 0], [1, 1]], dtype=bool)
        assert HALF_BLOCKS.lines(cell) == ["▀▄", "▄▄"]
        assert BRAILLE.lines(cell) == ["⣑"]
        assert HALF_BLOCKS.lines(cell[:3]) == ["▀▄", "  "]

    def test_labels(self, arm):
        lines = characters(arm.system.pattern, 6, NARROW)
        assert [line.split("│")[0].strip() for line in lines if "│" in line and line[0] != " "] == [
            *(f"body {i}" for i in range(1, 7)),
            *(f"joint {j}" for j in range(1, 7)),
        ]
        assert lines[0].split() == [*"123456"] * 2


class TestText:
    def test_vector(self):
        assert vector_text(np.array([-0.0, 1.23456, 1e-17])) == "0 1.235 0"

    def test_matrix(self):
        assert matrix_lines(np.array([[-1, 1], [0, -1]])) == ["     1  2", "  1 −1  1", "  2  · −1"]

    @pytest.mark.parametrize("robot", ["kr500", "ur5", "z1"])
    def test_fits_into_80_characters(self, robot, monkeypatch):
        model = urdf.load(robot)
        lines = shown(describe(model, robot), NARROW, monkeypatch).splitlines()
        assert max(map(len, lines)) <= NARROW
        assert any("┼" in line and "├───" in line for line in lines[-30:])

    def test_too_large_to_draw(self, monkeypatch):
        said = shown(describe(robot_called("tiago"), "tiago"), NARROW, monkeypatch)
        assert "incidence S: too wide for 80 characters; --json and --html have it" in said
        assert "too wide for 80 characters; --json and --html have it" in said

    def test_no_frames(self, tree, arm, monkeypatch):
        assert "No named frames" in shown(arm, NARROW, monkeypatch)


class TestCommand:
    def test_kr500(self):
        done = show("kr500")
        assert done.exit_code == 0
        assert done.stderr == ""
        for fact in ("kr500: 6 bodies, 6 joints", "11589.6 kg", "0 0 -9.807 m/s², world axes", "'B0', in the world"):
            assert fact in done.stdout
        assert "every body is physically consistent" in done.stdout
        assert "incidence S" in done.stdout
        assert re.search(r"\d+ of 4356 are not zero \(\d\.\d%\)\s+rank +66 of 66\s+condition number +\d", done.stdout)

    def test_locked(self):
        done = show("z1", "--lock", "jointGripper=0.1")
        assert done.exit_code == 0
        assert "z1: 6 bodies, 6 joints, locked: jointGripper = 0.1" in done.stdout

    def test_impossible_bodies_and_a_singular_matrix(self, small_arm):
        massless = re.sub(
            r'(<link name="slider">.*?)<inertial>.*?</inertial>', r"\1", small_arm.read_text(), flags=re.S
        )
        small_arm.write_text(massless)
        file, page = small_arm.with_name("r.json"), small_arm.with_name("r.html")
        done = show(small_arm, "--json", file, "--html", page)
        assert done.exit_code == 0
        assert re.search(r"body 'slider': not physically consistent: mass is zero", done.stdout)
        assert re.fullmatch(r"warning: .*without <inertial>: 'slider'.*\n", done.stderr)
        record = json.loads(file.read_text(encoding="utf-8"))
        assert [body["consistent"] for body in record["bodies"]].count(False) == 1
        assert record["system"]["condition_number"] is None
        assert record["system"]["rank"] < record["system"]["size"]
        assert "<strong>body &#39;slider&#39;</strong>" in page.read_text(encoding="utf-8")

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (["ur55"], "'ur55' is neither a file nor a robot"),
            (["kr500", "--lock", "O9"], "cannot lock 'O9'"),
            (["kr500", "--lock", "O1=soft"], "'soft' is not a number"),
            ([], "missing argument"),
            (["kr500", "ur5"], "unexpected extra argument"),
        ],
    )
    def test_bad_input(self, arguments, message):
        done = show(*arguments)
        assert done.exit_code == 2
        assert message in done.stderr
        assert done.stdout == ""

    def test_json_holds_everything_shown(self, tmp_path):
        path = tmp_path / "r.json"
        assert show("ur5", "--json", path).exit_code == 0
        record = json.loads(path.read_text(encoding="utf-8"))
        assert record["format"] == "graphdyn show 1"
        assert record == plain(record_of(describe(urdf.load("ur5"), "ur5")))


class TestState:
    Q, V = [0.3, -1.2, 1.5, 0.1, 0.7, -0.2], [1.0, 0.0, 0.5, 0.0, -2.0, 0.25]

    @pytest.fixture
    def state(self, tmp_path):
        """What the JSON file holds of the state that was given."""

        def run(*arguments):
            path = tmp_path / "r.json"
            done = show("ur5", *arguments, "--json", path)
            assert (done.exit_code, done.stderr) == (0, "")
            return json.loads(path.read_text(encoding="utf-8"))["state"]

        return run

    @staticmethod
    def text(*parts):
        return ";".join(",".join(map(str, part)) for part in parts)

    def test_numbers(self, state):
        model = urdf.load("ur5")
        found = state("--state", self.text(self.Q, self.V), "--frame", "forearm_link", "--reference", "local")
        q, v = np.array(self.Q), np.array(self.V)
        assert (found["q"], found["v"]) == (self.Q, self.V)
        assert found["mass_matrix"] == graphdyn.mass_matrix(model, q).tolist()
        assert found["kinetic_energy"] == pytest.approx(v @ found["mass_matrix"] @ v / 2)
        weights = -model.gravity[2] * np.array([body.mass for body in model.bodies])
        heights = graphdyn.maximal_state(model, q).position[:, 2]
        assert found["potential_energy"] == pytest.approx(weights @ heights)
        motion = found["motion"]
        masses, there = np.array([body.mass for body in model.bodies]), graphdyn.maximal_state(model, q, v)
        assert motion["center_of_mass"] == pytest.approx(masses @ there.position / masses.sum())
        linear = masses @ there.velocity[:, :3]
        assert motion["center_of_mass_velocity"] == pytest.approx(linear / masses.sum())
        assert motion["momentum"][:3] == motion["momentum_about_origin"][:3] == pytest.approx(linear)
        shift = np.cross(motion["center_of_mass"], linear)
        assert np.subtract(motion["momentum_about_origin"], motion["momentum"])[3:] == pytest.approx(shift)
        assert found["gravity_torque"] == graphdyn.gravity_torque(model, q).tolist()
        assert found["bias_torque"] == graphdyn.bias_torque(model, q, v).tolist()
        assert found["mass_matrix_condition"] == pytest.approx(np.linalg.cond(found["mass_matrix"]))
        assert [body["name"] for body in found["bodies"]] == list(model.body_names)
        frame = found["frame"]
        assert (frame["name"], frame["reference"]) == ("forearm_link", "local")
        assert frame["xyz"] == found["bodies"][2]["xyz"]
        assert frame["rpy"] == found["bodies"][2]["rpy"]
        assert frame["xyz"] == graphdyn.frame_placement(model, q, "forearm_link")[1].tolist()
        jacobian = graphdyn.frame_jacobian(model, q, "forearm_link", reference="local")
        assert frame["jacobian"] == jacobian.tolist()
        assert frame["velocity"] == pytest.approx(jacobian @ v)

    def test_spellings(self, state, tmp_path):
        """One row, two parts, a file; what else a file holds does not matter."""
        file = tmp_path / "state.json"
        file.write_text(json.dumps({"q": self.Q, "v": self.V, "tau": [1]}), encoding="utf-8")
        two = state("--state", self.text(self.Q, self.V))
        assert two == state("--state", self.text(self.Q + self.V)) == state("--state", file)

    def test_positions_alone(self, state, tmp_path):
        file = tmp_path / "state.json"
        file.write_text(json.dumps({"q": self.Q}), encoding="utf-8")
        for given in (self.text(self.Q), file):
            found = state("--state", given)
            assert (found["q"], found["v"], found["kinetic_energy"]) == (self.Q, [0] * 6, 0)
            assert found["bias_torque"] == pytest.approx(found["gravity_torque"])
        assert state("--state", self.text([-x for x in self.Q]))["q"] == [-x for x in self.Q]  # begins with a sign

    def test_random(self, state):
        model = urdf.load("ur5")
        for text, seed in (("random", 0), ("random:7", 7)):
            q, v = model.random_state(np.random.default_rng(seed))
            found = state("--state", text)
            assert (found["q"], found["v"]) == (q.tolist(), v.tolist())

    @pytest.mark.parametrize(("robot", "frame"), [("ur5", "tool0"), ("kr500", "B6"), ("z1", "gripperMover")])
    def test_frame_that_is_meant(self, robot, frame):
        """The last one on the last body; others are on the ground (ur5) or on bodies before (z1)."""
        assert tip(urdf.load(robot)) == frame
        done = show(robot, "--state", "random")
        assert f"Frame '{frame}'" in done.stdout
        assert "Jacobian, local_world_aligned" in done.stdout

    def test_none(self, tmp_path):
        path = tmp_path / "r.json"
        done = show("ur5", "--json", path)
        assert json.loads(path.read_text(encoding="utf-8"))["state"] is None
        assert "kinetic energy" not in done.stdout

    @pytest.mark.parametrize("robot", ["ur5", "tiago"])
    def test_fits_into_80_characters(self, robot, monkeypatch):
        model = robot_called(robot)
        q, v = model.random_state(np.random.default_rng(0))
        state = describe_state(model, q, v, tip(model), "world")
        lines = shown(describe(model, robot, state=state), NARROW, monkeypatch).splitlines()
        assert max(map(len, lines)) <= NARROW
        assert any(f"{state.kinetic_energy:.6g} J" in line for line in lines)

    def test_text(self, monkeypatch):
        """Rounding is written as 0, as -30.6896 and not as -30.689618 what is no rounding."""
        model = urdf.load("ur5")
        q = np.array([0, -1.2, 1.5, 0, 0.3, 0])
        state = describe_state(model, q, 0 * q, "tool0", "local_world_aligned")
        text = shown(describe(model, "ur5", state=state), 120, monkeypatch)
        torques = graphdyn.gravity_torque(model, q)
        assert np.abs(torques[[0, 4, 5]]).max() < 1e-12
        assert re.search(rf"shoulder_lift_joint │ +-1.2 │ 0 │ +{torques[1]:.6g} │", text)
        for joint in ("shoulder_pan_joint", "wrist_3_joint"):
            assert re.search(rf"{joint} +│ +0 │ 0 │ +0 │ +0 │", text)
        height = state.frame.jacobian[2][1]
        assert re.search(rf"^v_z +0 +{height:.4g} ", text, re.MULTILINE)

    def test_robot_without_mass(self, small_arm):
        small_arm.write_text(re.sub(r"<inertial>.*?</inertial>", "", small_arm.read_text(), flags=re.S))
        done = show(small_arm, "--state", "random")
        assert done.exit_code == 0
        assert "Mass matrix, condition number ∞" in done.stdout
        assert "angular momentum" not in done.stdout

    def test_page(self, tmp_path):
        path = tmp_path / "r.html"
        assert show("ur5", "--state", "random", "--html", path).exit_code == 0
        words = " ".join(" ".join(TestPage.Text(path.read_text(encoding="utf-8")).words).split())
        for fact in (
            "At the given state. ○",
            "Link frames in the world",
            "Mass matrix, condition number",
            "Frame 'tool0'",
        ):
            assert fact in words
        assert "Zero pose" not in words

    @pytest.mark.parametrize(
        ("given", "message"),
        [
            ("1,2", "--state has 2 numbers; the robot needs 6 for q, or 12 for q and v"),
            ("1,2,3,4,5,6;1", "v has shape (1,), expected (…, 6) for the 6 joints of robot 'ur5'"),
            ("1,2;1", "q has shape (2,), expected (…, 6) for the 6 joints of robot 'ur5'"),
            ("0,0,nan,0,0,0", "q contains nan at joint 'elbow_joint'"),
            ("0,0,0,0,0,0;0,inf,0,0,0,0", "v contains inf at joint 'shoulder_lift_joint'"),
            ("home", "--state home: 'home' is not a row of numbers; give numbers with commas, a JSON file"),
            ("random:x", "--state random:x: 'x' is not a seed, a whole number from 0 on"),
            ("missing.json", "error: missing.json: no such file or directory; check the name and the folder"),
            ("empty.json", "--state empty.json: is no JSON: Expecting value"),
            ("nested.json", "--state nested.json: is nested too deeply; give lists of numbers"),
            ("list.json", '--state list.json: has no field q; write {"q": […], "v": […]}'),
            ("text.json", "q is not an array of real numbers"),
            ("long.json", "q is not an array of real numbers"),
            ("1_0,0,0,0,0,0", "--state 1_0,0,0,0,0,0: '1_0,0,0,0,0,0' is not a row of numbers; give numbers with"),
            ("1e400", "--state 1e400: '1e400' is not a row of numbers; give numbers with"),
            ("many.json", "one state expected, got leading dimensions (2,)"),
        ],
    )
    def test_bad_input(self, tmp_path, monkeypatch, given, message):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "empty.json").touch()
        (tmp_path / "nested.json").write_text("[" * 100_000, encoding="utf-8")
        (tmp_path / "list.json").write_text("[1, 2]", encoding="utf-8")
        (tmp_path / "text.json").write_text('{"q": "home"}', encoding="utf-8")
        (tmp_path / "long.json").write_text('{"q": [9007199254740993]}', encoding="utf-8")
        (tmp_path / "many.json").write_text(json.dumps({"q": [self.Q, self.Q]}), encoding="utf-8")
        self.refused(["--state", given], message)

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (["--frame", "tool0"], "--frame and --reference say whose Jacobian is shown; it takes a --state"),
            (["--reference", "local"], "--frame and --reference say whose Jacobian is shown; it takes a --state"),
            (
                ["--state", "random", "--frame", "tool9"],
                "robot 'ur5' has no frame 'tool9'; known: world, shoulder_link",
            ),
            (
                ["--state", "random", "--reference", "base"],
                "'base' is not one of 'world', 'local', 'local_world_aligned'",
            ),
        ],
    )
    def test_bad_options(self, options, message):
        self.refused(options, message)

    def refused(self, options, message):
        done = show("ur5", *options)
        assert (done.exit_code, done.stdout) == (2, "")
        assert message in " ".join(done.stderr.split())


class TestPage:
    class Text(HTMLParser):
        def __init__(self, html):
            super().__init__()
            self.tags, self.words = [], []
            self.feed(html)

        def handle_starttag(self, tag, attributes):
            self.tags.append((tag, dict(attributes)))

        def handle_data(self, data):
            self.words.append(data)

    def test_content(self, tmp_path):
        path = tmp_path / "r.html"
        assert show("ur5", "--html", path).exit_code == 0
        shown = self.Text(path.read_text(encoding="utf-8"))
        words = " ".join(" ".join(shown.words).split())
        model = urdf.load("ur5")
        for name in (*model.body_names, *model.joint_names, *(frame.name for frame in model.frames)):
            assert name in "".join(shown.words)  # a long name has two parts, between which it may be cut
        for fact in (
            "16.9939 kg",
            "incidence S",
            "path matrix T",
            "force elements S^e",
            "rank 66 of 66",
            "Eq. (111): 66 equations",
        ):
            assert fact in words
        assert "RobotModel(" not in words
        labels = [attributes["aria-label"] for tag, attributes in shown.tags if tag == "svg"]
        assert [label.split(" ")[0] for label in labels] == ["Stick", "Pattern"]

    def test_needs_nothing_else(self, arm):
        """One file: no address is loaded."""
        tags = self.Text(page_of(arm)).tags
        assert not [tag for tag, attributes in tags if tag in ("link", "img", "iframe") or "src" in attributes]

    def test_names_are_escaped(self, tree):
        strange = dataclasses.replace(tree, robot="<b>&.urdf")
        text = page_of(strange, "<b>&.urdf")
        assert "<b>&.urdf" not in text
        assert "&lt;b&gt;&amp;.urdf" in text

    def test_same_arguments_same_page(self, arm):
        assert page_of(arm) == page_of(arm)


def test_couplings():
    driven = {TREE.joint_names[2]: 1.5, TREE.joint_names[0]: -2.0}
    model = dataclasses.replace(TREE, couplings=(graphdyn.Coupling(TREE.joint_names[1], driven, 0.25),))
    described = describe(model, "tree")
    assert plain(record_of(described))["couplings"] == [
        {"joint": TREE.joint_names[1], "ratios": driven, "offset": 0.25}
    ]
    assert described.system.size == 11 * model.n_bodies + 1
    text = page(show_report(described), ["graphdyn", "show"], versions())
    assert f"1.5 {TREE.joint_names[2]} + -2 {TREE.joint_names[0]}" in re.sub("<[^>]*>", "", text)
    assert "Couplings" not in page(show_report(describe(TREE, "tree")), ["graphdyn", "show"], versions())


class TestProofs:
    """Of the second link a principal moment exceeds the sum of the others by 1e-30."""

    @pytest.fixture
    def path(self, tmp_path):
        pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")
        inertia = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.300000000000000000000000000001"/>'
        link = f'<link name="plate"><inertial><mass value="1.5"/>{inertia}</inertial></link>'
        joint = '<joint name="turn" type="continuous"><parent link="ground"/><child link="plate"/></joint>'
        path = tmp_path / "plate.urdf"
        path.write_text(f'<robot name="arm"><link name="ground"/>{link}{joint}</robot>')
        return path

    def test_told_and_written(self, path, tmp_path):
        result = show(path, "--proofs", "--json", tmp_path / "shown.json")
        assert result.exit_code == 0
        assert "Of the decimals of the file, without tolerances" in result.output
        proofs = json.loads((tmp_path / "shown.json").read_text())["proofs"]
        assert proofs[0] == {
            "statement": "a real body can have this inertia",
            "of": "plate",
            "result": "disproven",
            "reason": "a principal moment exceeds the sum of the others by 1.00e-30 kg m²",
            "truth": "file",
        }
        assert [proof["result"] for proof in proofs[1:]] == ["proven"] * 4
        show(path, "--json", tmp_path / "without.json")
        assert json.loads((tmp_path / "without.json").read_text())["proofs"] is None

    def test_without_python_flint(self, path, monkeypatch):
        monkeypatch.setitem(sys.modules, "flint", None)
        result = show(path, "--proofs")
        assert result.exit_code == 2
        (said,) = result.stderr.splitlines()
        assert said.startswith("error: exact values: the package python-flint is not installed; run: python -m pip")
