"""Every number on the page and in the JSON file of `graphdyn show`, computed again from the text of the file."""

import json
import re
from dataclasses import dataclass

import numpy as np
import pytest
from lxml import etree
from matplotlib.figure import Figure
from robots.mechanisms import four_bar
from scipy.spatial.transform import Rotation
from shown import pages
from shown.approved import approve, approve_record, page_text
from shown.blocks import blocks, cells, tables, texts
from typer.testing import CliRunner

import graphdyn
import urdf
from crosscheck.commands import app
from crosscheck.commands.show.description import describe
from crosscheck.commands.show.report import show_report
from crosscheck.report.pictures import stick_figure
from crosscheck.report.report import Facts, Picture

Q, V = np.array([0.7, -0.4, 0.15]), np.array([1.5, -2.0, 0.8])
GRAVITY = np.array([0.0, 0.0, -9.81])
FOUR_DIGITS = 6e-4
"""Relative: vectors and matrices of a page have four digits."""

STEP = 1e-5
SLOPES = 1e-6
"""Step, and relative error, of derivatives by central differences."""


def numbers(element, name, default="0 0 0"):
    return np.array((element.get(name) if element is not None and element.get(name) else default).split(), float)


@dataclass
class Link:
    """As in the file: center of mass, and tensor about it in link axes; joint to it."""

    name: str
    mass: float
    center: np.ndarray
    tensor: np.ndarray


@dataclass
class ByHand:
    """The robot from its XML, with homogeneous matrices: three joints, and a tool on the second link."""

    links: dict
    joints: list

    @classmethod
    def of(cls, text):
        root = etree.fromstring(text.encode())
        links = {}
        for link in root.iter("link"):
            inertial = link.find("inertial")
            if inertial is None:
                continue
            origin, entries = inertial.find("origin"), inertial.find("inertia").attrib
            xx, xy, xz, yy, yz, zz = (float(entries["i" + name]) for name in ("xx", "xy", "xz", "yy", "yz", "zz"))
            turn = Rotation.from_euler("xyz", numbers(origin, "rpy")).as_matrix()
            tensor = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
            mass = float(inertial.find("mass").get("value"))
            links[link.get("name")] = Link(link.get("name"), mass, numbers(origin, "xyz"), tensor)
        joints = list(root.iter("joint"))
        return cls(links, joints)

    def placement(self, joint):
        origin, found = joint.find("origin"), np.eye(4)
        found[:3, :3] = Rotation.from_euler("xyz", numbers(origin, "rpy")).as_matrix()
        found[:3, 3] = numbers(origin, "xyz")
        return found

    def frames(self, q):
        """Matrices of all links in the world."""
        found = {"base": np.eye(4)}
        moved = iter(q)
        for joint in self.joints:
            inside, name = joint.find("parent").get("link"), joint.find("child").get("link")
            motion = np.eye(4)
            if joint.get("type") != "fixed":
                axis, position = numbers(joint.find("axis"), "xyz"), next(moved)
                if joint.get("type") == "prismatic":
                    motion[:3, 3] = position * axis
                else:
                    motion[:3, :3] = Rotation.from_rotvec(position * axis).as_matrix()
            found[name] = found[inside] @ self.placement(joint) @ motion
        return found

    def jacobian(self, q, link, point):
        """Of a point (3,) in link axes: linear, then angular, in world axes (6, 3)."""
        frames = self.frames(q)
        at = (frames[link] @ [*point, 1])[:3]
        carried, name = set(), link
        while name != "base":
            carried.add(name)
            name = next(j.find("parent").get("link") for j in self.joints if j.find("child").get("link") == name)
        columns = []
        for joint in (j for j in self.joints if j.get("type") != "fixed"):
            child = joint.find("child").get("link")
            axis = frames[child][:3, :3] @ numbers(joint.find("axis"), "xyz")
            if child not in carried:
                columns.append(np.zeros(6))
            elif joint.get("type") == "prismatic":
                columns.append([*axis, 0, 0, 0])
            else:
                columns.append([*np.cross(axis, at - frames[child][:3, 3]), *axis])
        return np.transpose(columns)

    def masses(self, q):
        """Links with mass: mass, center in the world, Jacobian there, tensor in world axes."""
        for name, link in self.links.items():
            frame = self.frames(q)[name]
            turn = frame[:3, :3]
            at = (frame @ [*link.center, 1])[:3]
            yield link.mass, at, self.jacobian(q, name, link.center), turn @ link.tensor @ turn.T

    def mass_matrix(self, q):
        return sum(m * j[:3].T @ j[:3] + j[3:].T @ tensor @ j[3:] for m, _, j, tensor in self.masses(q))

    def gravity_torque(self, q):
        return -sum(m * j[:3].T @ GRAVITY for m, _, j, _ in self.masses(q))

    def bias_torque(self, q, v):
        """By the symbols of Christoffel, from differences of M."""
        slopes = [(self.mass_matrix(q + step) - self.mass_matrix(q - step)) / (2 * STEP) for step in STEP * np.eye(3)]
        slopes = np.array(slopes)
        quadratic = np.einsum("kij,k,j->i", slopes, v, v) - np.einsum("ijk,j,k->i", slopes, v, v) / 2
        return quadratic + self.gravity_torque(q)

    def body(self, name):
        """A link with what is fixed to it: mass, center, tensor about that, in its link axes."""
        frames = self.frames(np.zeros(3))
        parts = [name] + [j.find("child").get("link") for j in self.joints
                          if j.get("type") == "fixed" and j.find("parent").get("link") == name]  # fmt: skip
        placed = []
        for part in parts:
            link, to_body = self.links[part], np.linalg.inv(frames[name]) @ frames[part]
            turn = to_body[:3, :3]
            placed.append((link.mass, (to_body @ [*link.center, 1])[:3], turn @ link.tensor @ turn.T))
        mass = sum(m for m, _, _ in placed)
        center = sum(m * c for m, c, _ in placed) / mass
        tensor = sum(t + m * ((c - center) @ (c - center) * np.eye(3) - np.outer(c - center, c - center))
                     for m, c, t in placed)  # fmt: skip
        return mass, center, tensor


@pytest.fixture(scope="module")
def arm(small_arm_text):
    return ByHand.of(small_arm_text)


@pytest.fixture(scope="module")
def shown(tmp_path_factory, small_arm_text):
    """Page and record of a state of the small arm."""
    folder = tmp_path_factory.mktemp("show")
    robot, page, file = (folder / name for name in ("small.urdf", "r.html", "r.json"))
    robot.write_text(small_arm_text, encoding="utf-8")
    state = ",".join(map(str, [*Q, *V]))
    options = ("--state", state, "--frame", "tool", "--html", page, "--json", file)
    done = CliRunner().invoke(app, ["show", str(robot), *map(str, options)])
    assert done.exit_code == 0, done.output
    return page.read_text(encoding="utf-8"), json.loads(file.read_text(encoding="utf-8"))


def read(text):
    """A vector as the page writes it."""
    return [float(x) for x in text.replace("−", "-").split()]


def close(found, wanted, digits=FOUR_DIGITS):
    size = np.abs(wanted).max()
    np.testing.assert_allclose(found, wanted, rtol=0, atol=digits * size)


def rpy(matrix):
    return np.degrees(Rotation.from_matrix(matrix).as_euler("xyz"))


LIMITS, DYNAMICS = ("lower", "upper", "velocity", "effort"), ("damping", "friction")
BODIES, JOINTS = ("upper", "fore", "slider"), ("z_shoulder", "y_elbow", "a_slide")


class TestRobot:
    def test_bodies(self, shown, arm):
        page, record = shown
        table = pages.table(page, "Bodies")
        total = 0.0
        for k, name in enumerate(BODIES):
            mass, center, tensor = arm.body(name)
            total += mass
            moments = np.linalg.eigvalsh(tensor)
            found = record["bodies"][k]
            assert (found["number"], found["name"], found["consistent"]) == (k + 1, name, True)
            assert found["mass"] == pytest.approx(mass)
            assert found["center_of_mass"] == pytest.approx(center, abs=1e-12)
            assert found["principal_moments"] == pytest.approx(moments)
            number, said, *values = table[k]
            assert (number, said) == (str(k + 1), name)
            assert float(values[0]) == pytest.approx(mass, rel=FOUR_DIGITS)
            close(read(values[1]), center)
            close(read(values[2]), moments)
        assert record["total_mass"] == pytest.approx(total)
        assert pages.facts(page)["total mass"] == f"{total:.6g} kg"
        assert record["gravity"] == GRAVITY.tolist()

    def test_joints(self, shown, arm):
        page, record = shown
        moving = [joint for joint in arm.joints if joint.get("type") != "fixed"]
        table = pages.table(page, "from body → to body")
        (limits,) = [rows for rows in pages.all_tables(page, "rad or m, rad/s or m/s, N m or N") if len(rows[0]) == 8]
        names = ("base", *BODIES)
        for k, joint in enumerate(moving):
            placement, axis = arm.placement(joint), numbers(joint.find("axis"), "xyz")
            inside = names.index(joint.find("parent").get("link"))
            found = record["joints"][k]
            assert (found["name"], found["kind"]) == (JOINTS[k], joint.get("type"))
            assert (found["inside"], found["body"]) == (names[inside], BODIES[k])
            assert found["axis"] == pytest.approx(axis)
            assert found["xyz"] == pytest.approx(placement[:3, 3])
            assert found["rpy"] == pytest.approx(rpy(placement[:3, :3]), abs=1e-9)
            number, name, kind, between, *vectors = table[k]
            assert (number, name, kind) == (str(k + 1), JOINTS[k], joint.get("type"))
            assert between == f"{inside} → {k + 1}"
            for text, wanted in zip(vectors, (axis, placement[:3, 3], rpy(placement[:3, :3])), strict=True):
                close(read(text), wanted)
            limit, dynamics = joint.find("limit"), joint.find("dynamics")
            wanted = [None if limit is None else float(limit.get(name)) for name in LIMITS]
            wanted += [0.0 if dynamics is None else float(dynamics.get(name)) for name in DYNAMICS]
            assert [found[name] for name in (*LIMITS, *DYNAMICS)] == wanted
            assert limits[k][:2] == [str(k + 1), JOINTS[k]]
            np.testing.assert_array_equal(pages.numbers(limits[k][2:]), np.array(wanted, float))

    def test_graph(self, shown, arm):
        """S, T = -S⁻¹, and vectors from the centers of mass to the joints."""
        page, record = shown
        incidence = np.array([[-1, 1, 1], [0, -1, 0], [0, 0, -1]])
        graph = record["graph"]
        assert graph["incidence"] == graph["force_element"] == incidence.tolist()
        assert graph["path"] == (-np.linalg.inv(incidence)).round().astype(int).tolist()
        rows = pages.table(page, "S_ij times the vector")
        assert len(rows) == np.count_nonzero(incidence)
        for i, body in enumerate(BODIES):
            _, center, _ = arm.body(body)
            for j, joint in enumerate(one for one in arm.joints if one.get("type") != "fixed"):
                wanted = np.zeros(3)
                if incidence[i, j]:
                    at = np.zeros(3) if i == j else arm.placement(joint)[:3, 3]
                    wanted = incidence[i, j] * (at - center)
                    row = next(row for row in rows if row[0] == str(i + 1) and row[2] == str(j + 1))
                    assert row[1::2][:2] == [body, JOINTS[j]]
                    assert row[4] == f"{incidence[i, j]:+d}"
                    close(read(row[5]), wanted)
                np.testing.assert_allclose(graph["body_joint_vectors"][i][j], wanted, atol=1e-12)

    def test_system(self, shown):
        page, record = shown
        system = record["system"]
        entries = sum(row.count("1") for row in system["pattern"])
        facts = pages.facts(page)
        assert {len(row) for row in system["pattern"]} == {33}
        assert facts["entries"] == f"{entries} of 1089 are not zero ({100 * entries / 1089:.1f}%)"
        assert facts["rank"] == "33 of 33"
        assert system["rank"] == system["size"] == 33
        assert float(facts["condition number"]) == pytest.approx(system["condition_number"], rel=FOUR_DIGITS)


class TestState:
    def test_joints(self, shown, arm):
        page, record = shown
        state = record["state"]
        gravity, bias = arm.gravity_torque(Q), arm.bias_torque(Q, V)
        assert state["gravity_torque"] == pytest.approx(gravity)
        assert state["bias_torque"] == pytest.approx(bias, rel=SLOPES)
        (rows,) = [rows for rows in pages.all_tables(page, "rad or m, rad/s or m/s, N m or N") if len(rows[0]) == 6]
        for k, row in enumerate(rows):
            assert row[:2] == [str(k + 1), JOINTS[k]]
            assert read(" ".join(row[2:])) == pytest.approx([Q[k], V[k], gravity[k], bias[k]], rel=2e-5)

    def test_energies_and_momentum(self, shown, arm):
        page, record = shown
        state, facts, matrix = record["state"], pages.facts(page), arm.mass_matrix(Q)
        kinetic = V @ matrix @ V / 2
        parts = list(arm.masses(Q))
        potential = -sum(m * at @ GRAVITY for m, at, _, _ in parts)
        assert (state["kinetic_energy"], state["potential_energy"]) == pytest.approx((kinetic, potential))
        assert float(facts["kinetic energy"].removesuffix(" J")) == pytest.approx(kinetic, rel=1e-5)
        assert float(facts["potential energy"].split(" J")[0]) == pytest.approx(potential, rel=1e-5)
        mass = sum(m for m, *_ in parts)
        center = sum(m * at for m, at, _, _ in parts) / mass
        linear = sum(m * (j @ V)[:3] for m, _, j, _ in parts)
        origin = sum(m * np.cross(at, (j @ V)[:3]) + tensor @ (j @ V)[3:] for m, at, j, tensor in parts)
        about_center = origin - np.cross(center, linear)
        motion = state["motion"]
        assert motion["center_of_mass"] == pytest.approx(center)
        assert motion["center_of_mass_velocity"] == pytest.approx(linear / mass)
        assert motion["momentum"] == pytest.approx([*linear, *about_center])
        assert motion["momentum_about_origin"] == pytest.approx([*linear, *origin])
        said = {
            "center of mass": center, "its velocity": linear / mass, "momentum": linear,
            "angular momentum": about_center, "": origin,
        }  # fmt: skip
        for name, wanted in said.items():
            close(read(re.match(r"[-−\d.e+ ]+(?= )", facts[name])[0]), wanted)

    def test_matrices(self, shown, arm):
        page, record = shown
        state, matrix = record["state"], arm.mass_matrix(Q)
        np.testing.assert_allclose(state["mass_matrix"], matrix, rtol=1e-9, atol=1e-12)
        assert state["mass_matrix_condition"] == pytest.approx(np.linalg.cond(matrix))
        rows = pages.table(page, "[kg m², kg m, kg]; joints by number")
        close([pages.numbers(row[1:]) for row in rows], matrix)
        assert f"Mass matrix, condition number {np.linalg.cond(matrix):.4g}" in page
        jacobian, frame = arm.jacobian(Q, "tool", np.zeros(3)), arm.frames(Q)["tool"]
        found = state["frame"]
        np.testing.assert_allclose(found["jacobian"], jacobian, atol=1e-12)
        assert found["velocity"] == pytest.approx(jacobian @ V)
        assert found["xyz"] == pytest.approx(frame[:3, 3])
        assert found["rpy"] == pytest.approx(rpy(frame[:3, :3]))
        rows = pages.rows(page, "[m; 1 of revolute joints]")
        close([pages.numbers(rows[name]) for name in ("v_x", "v_y", "v_z", "ω_x", "ω_y", "ω_z")], jacobian)
        said = pages.facts(page)
        at, turned = re.fullmatch(r"at (.*) m, rpy (.*)°", said["in the world"]).groups()
        close(read(at), frame[:3, 3])
        close(read(turned), rpy(frame[:3, :3]))
        linear, angular = re.fullmatch(r"(.*) m/s, (.*) rad/s", said["velocity"]).groups()
        close(read(linear), (jacobian @ V)[:3])
        close(read(angular), (jacobian @ V)[3:])

    def test_links(self, shown, arm):
        page, record = shown
        table = pages.table(page, "Link frames in the world")
        for k, name in enumerate(BODIES):
            frame = arm.frames(Q)[name]
            found = record["state"]["bodies"][k]
            assert found["name"] == name
            assert found["xyz"] == pytest.approx(frame[:3, 3], abs=1e-12)
            assert found["rpy"] == pytest.approx(rpy(frame[:3, :3]), abs=1e-9)
            assert table[k][:2] == [str(k + 1), name]
            close(read(table[k][2]), frame[:3, 3])
            close(read(table[k][3]), rpy(frame[:3, :3]))


def test_picture(arm, tmp_path, small_arm_text):
    """Centers of mass are drawn at their places, with areas in proportion to their masses; joints at theirs."""
    (tmp_path / "small.urdf").write_text(small_arm_text, encoding="utf-8")
    model = urdf.load(tmp_path / "small.urdf")
    drawing = stick_figure._Drawing(model, Q)
    frames = arm.frames(Q)
    centers = []
    for name in BODIES:
        centers.append((frames[name] @ [*arm.body(name)[1], 1])[:3])
    view = drawing._view
    np.testing.assert_allclose(view @ view.T, np.eye(2), atol=1e-12)
    assert view[0, 2] == 0
    assert view[1, 2] > 0
    np.testing.assert_allclose(drawing.centers, np.array(centers) @ view.T, atol=1e-9)
    origins = [np.zeros(3), *(frames[name][:3, 3] for name in BODIES)]
    np.testing.assert_allclose(drawing.origins, np.array(origins) @ view.T, atol=1e-9)
    reach = np.array(origins)[:, :2] - origins[0][:2]
    far = reach[np.argmax(np.hypot(*reach.T))]
    across, deep = view[:, :2] @ far / np.hypot(*far)
    assert across > 0.5 > abs(deep)  # what is farthest is mostly on the right
    np.testing.assert_allclose(drawing.shadow, (origins * np.array([1, 1, 0])) @ view.T, atol=1e-9)  # on the ground
    axes = Figure().add_axes((0, 0, 1, 1))
    drawing.draw(axes)
    masses = np.array([arm.body(name)[0] for name in BODIES])
    (areas,) = [part.get_sizes() for part in axes.collections if len(part.get_sizes()) == 3]
    np.testing.assert_allclose(areas, stick_figure.DISC_AREA * masses / masses.sum())


class TestLoops:
    def test_both_ends_of_a_chord_are_drawn_in_one_place(self):
        """Where the loop is closed: 2 m along the coupler, 1.5 m along the rocker."""
        model = four_bar()
        q = model.closed_pose
        ((one, other),) = (drawing := stick_figure._Drawing(model, q)).chord_ends
        rotation, position = graphdyn.frame_placement(model, q, "coupler")
        expected = drawing._view @ (position + rotation @ [2, 0, 0])
        np.testing.assert_allclose([one, other], [expected, expected], atol=1e-9)

    def test_page(self):
        """Ends of the chord on its bodies, what holds itself, largest first, and reactions as the record has them."""
        described = describe(four_bar(), "four-bar")
        report, loops = show_report(described), described.loops
        chords, ends, reactions, stresses = tables(report, "loops")
        (chord,) = described.model.chords
        assert texts(chords)[0][:5] == ["c1", "closing", "hinge", "5", f"{chord.body_i} – {chord.body_j}"]
        for row, body, place in zip(texts(ends), ("coupler", "rocker"), ([2, 0, 0], [1.5, 0, 0]), strict=True):
            assert row[:2] == ["c1", body]
            assert read(row[2]) == place
            close(read(row[4]), chord.axis)
        for row, stress in zip(texts(stresses), loops.analysis.self_stresses, strict=True):
            parts = [part.rsplit(" ", 1) for part in row[1].split(", ") if not part.endswith(" more")]
            sizes = [abs(float(size)) for _, size in parts]
            assert sizes == sorted(sizes, reverse=True)
            assert {name: float(size) for name, size in parts} == {
                name: pytest.approx(stress[name], rel=0.006) for name, _ in parts
            }
            assert max(map(abs, stress.values())) == pytest.approx(1)
        for reaction in loops.reactions:
            row = cells(reactions)[reaction.name]
            for text, known, value in zip(row, reaction.determined, reaction.values, strict=False):
                assert bool(text) == known
                if known:
                    assert float(text) == pytest.approx(value, rel=FOUR_DIGITS, abs=1e-9)
        facts = dict(next(block for block in blocks(report, "loops") if isinstance(block, Facts)).items)
        assert facts["pose"].endswith(" ".join(f"{x:.4g}" for x in loops.q))
        assert not [block for block in blocks(report, "loops") if isinstance(block, Picture)]


def test_whole(shown):
    approve("show", page_text(shown[0]))
    approve_record("show", shown[1], without=("versions",))
