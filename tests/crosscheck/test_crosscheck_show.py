"""`graphdyn show`: the description, and the terminal, the file and the page made of it."""

import dataclasses
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from planting import mixed_tree
from typer.testing import CliRunner

import urdf
from crosscheck.cli import app, console
from crosscheck.report.commands.show import show_report
from crosscheck.report.describing import describe
from crosscheck.report.html import page
from crosscheck.report.json import plain
from crosscheck.report.pattern import BRAILLE, HALF_BLOCKS, picture
from crosscheck.report.plain_text import matrix_lines, vector_text
from crosscheck.report.text import renderables
from crosscheck.report.versions import versions
from graphdyn import kkt_system, kr500
from graphdyn._rotation import rotation_about

NARROW = 80


TREE, ARM = mixed_tree(), kr500()


@pytest.fixture(scope="module")
def tree():
    return describe(TREE, "tree", {})


@pytest.fixture(scope="module")
def arm():
    return describe(ARM, "kr500", {})


def show(*arguments):
    return CliRunner().invoke(app, ["show", *map(str, arguments)])


def shown(description, model, width, monkeypatch):
    """What the terminal shows at this width."""
    monkeypatch.setattr(console.out, "width", width)
    with console.out.capture() as captured:
        for part in renderables(show_report(description, model), width):
            console.out.print(part)
    return captured.get()


def page_of(description, model, robot="kr500"):
    return page(show_report(description, model), ["graphdyn", "show", robot], versions())


def bits(system):
    """The pattern of the equations as an array (11n, 11n)."""
    return np.array([[entry == "1" for entry in row] for row in system.pattern])


class TestDescription:
    def test_bodies(self, tree):
        for number, (record, body) in enumerate(zip(tree.bodies, TREE.bodies, strict=True), start=1):
            assert (record.number, record.name, record.mass) == (number, body.name, body.mass)
            assert np.array_equal(record.center_of_mass, body.center_of_mass)
            assert np.sum(record.principal_moments) == pytest.approx(np.trace(body.inertia))
            assert list(record.principal_moments) == sorted(record.principal_moments)
        assert tree.total_mass == pytest.approx(sum(body.mass for body in TREE.bodies))

    def test_joints(self, tree):
        names = (tree.base, *TREE.body_names)
        for j, (record, joint) in enumerate(zip(tree.joints, TREE.joints, strict=True), start=1):
            assert (record.number, record.name, record.kind) == (j, joint.name, joint.kind)
            assert (record.inside, record.body) == (names[joint.inside], names[j])
            assert (record.lower, record.upper) == (joint.limits.lower, joint.limits.upper)
            assert (record.velocity, record.effort) == (joint.limits.velocity, joint.limits.effort)
            assert (record.damping, record.friction) == (joint.damping, joint.friction)
            roll, pitch, yaw = np.deg2rad(record.rpy)
            x, y, z = np.eye(3)
            rotation = rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)
            assert np.allclose(rotation, joint.placement.rotation, rtol=0, atol=1e-12)
            assert np.array_equal(record.xyz, joint.placement.translation)

    def test_graph(self, tree):
        graph = tree.graph
        assert np.array_equal(-np.array(graph.incidence) @ graph.path, np.eye(3))
        assert np.array_equal(graph.force_element, graph.incidence)
        assert np.array_equal(graph.body_joint_vectors, TREE.body_joint_vectors())

    def test_system(self, arm):
        """The pattern is that of the matrix: nothing large is left out, rounding is."""
        system = arm.system
        q, pattern = np.array(system.q), bits(system)
        matrix = kkt_system(ARM, q, np.zeros(6), np.zeros(6)).matrix
        assert np.array_equal(q, ARM.random_state(np.random.default_rng(0))[0])
        assert system.size == 66
        assert pattern.shape == (66, 66)
        assert np.array_equal(pattern, pattern.T)
        assert np.abs(matrix[~pattern]).max() < 1e-14 * np.abs(matrix).max()
        assert not matrix[~pattern].all()  # structural zeros
        assert np.abs(matrix[pattern]).min() > 0
        assert (system.rank, system.condition_number) == (66, pytest.approx(np.linalg.cond(matrix)))

    def test_frames_and_locked(self, small_arm):
        description = describe(urdf.load(small_arm, lock={"y_elbow": 0.3}), "small", {"y_elbow": 0.3})
        names = {name for frame in description.frames for name in (frame.name, *frame.aliases)}
        assert {"tool", "flange", "fore", "y_elbow"} <= names
        assert description.locked == {"y_elbow": 0.3}
        assert len(description.bodies) == 2


class TestPicture:
    def test_every_entry_is_drawn_once(self, arm):
        """Half blocks hold two rows of one column."""
        lines = picture(bits(arm.system), 6, NARROW)
        drawn = "".join(lines)
        assert 2 * drawn.count("█") + drawn.count("▀") + drawn.count("▄") == bits(arm.system).sum()
        assert {len(line) for line in lines} == {len(lines[0])}
        assert len(lines[0]) <= NARROW

    def test_braille_has_every_entry_too(self, arm):
        lines = picture(bits(arm.system), 6, 60)
        dots = sum((ord(character) - 0x2800).bit_count() for character in "".join(lines) if character >= "\u2800")
        assert dots == bits(arm.system).sum()
        assert len(lines[0]) <= 60

    def test_no_room(self, arm):
        assert picture(bits(arm.system), 6, 40) == []

    def test_characters(self):
        cell = np.array([[1, 0], [0, 1], [0, 0], [1, 1]], dtype=bool)
        assert HALF_BLOCKS.lines(cell) == ["▀▄", "▄▄"]
        assert BRAILLE.lines(cell) == ["⣑"]
        assert HALF_BLOCKS.lines(cell[:3]) == ["▀▄", "  "]

    def test_labels(self, arm):
        lines = picture(bits(arm.system), 6, NARROW)
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
        lines = shown(describe(model, robot, {}), model, NARROW, monkeypatch).splitlines()
        assert max(map(len, lines)) <= NARROW
        assert any("┼" in line and "├───" in line for line in lines[-30:])

    def test_too_large_to_draw(self, monkeypatch):
        model = urdf.load("tiago")
        said = shown(describe(model, "tiago", {}), model, NARROW, monkeypatch)
        assert "incidence S: too wide for 80 characters; --json and --html have it" in said
        assert "too wide for 80 characters; --json and --html have it" in said

    def test_no_frames(self, tree, arm, monkeypatch):
        assert "No named frames" in shown(arm, ARM, NARROW, monkeypatch)


class TestCommand:
    def test_kr500(self):
        done = show("kr500")
        assert done.exit_code == 0
        assert done.stderr == ""
        for fact in ("kr500: 6 bodies on 6 joints", "11589.6 kg", "0 0 -9.807 m/s², world axes", "'B0', in the world"):
            assert fact in done.stdout
        assert "every body is physically consistent" in done.stdout
        assert "incidence S" in done.stdout
        assert re.search(r"\d+ of 4356 are not zero \(\d\.\d%\)\s+rank +66 of 66\s+condition number +\d", done.stdout)

    def test_locked(self):
        done = show("z1", "--lock", "jointGripper=0.1")
        assert done.exit_code == 0
        assert "z1: 6 bodies on 6 joints, locked: jointGripper = 0.1" in done.stdout

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
            ([], "Missing argument"),
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
        assert record == plain(describe(urdf.load("ur5"), "ur5", {}))


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
            assert name in words
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
        tags = self.Text(page_of(arm, ARM)).tags
        assert not [tag for tag, attributes in tags if tag in ("link", "img", "iframe") or "src" in attributes]

    def test_names_are_escaped(self, tree):
        strange = dataclasses.replace(tree, robot="<b>&.urdf")
        text = page_of(strange, TREE, "<b>&.urdf")
        assert "<b>&.urdf" not in text
        assert "&lt;b&gt;&amp;.urdf" in text

    def test_same_arguments_same_page(self, arm):
        assert page_of(arm, ARM) == page_of(arm, ARM)
