"""`graphdyn view`: what is shown, the command, and the server of its page."""

import dataclasses
import gzip
import hashlib
import html
import http.client
import json
import re
import socket
import threading
from base64 import b64decode, b64encode
from itertools import islice, product

import numpy as np
import pytest
from robots.mesh_files import one_link, visual
from scipy.spatial.transform import Rotation
from shown.pages import opened

import graphdyn
import urdf
from crosscheck.commands.program.exits import AGREED, BAD_INPUT
from crosscheck.comparing import compare as comparing
from crosscheck.quantities.states import cases
from crosscheck.recordings import Recording
from crosscheck.recordings.recording import recording_of
from crosscheck.viewing.figures import BodyShape, Figure, ShownRobot, inertia_ellipsoid, standing_position
from crosscheck.viewing.motions import MAX_INSTANTS, closed_instant, planned_motion, recorded_motion, shown_rows
from crosscheck.viewing.robots import shown_robot, stand_ins
from crosscheck.viewing.scene import NumberStore, lacking_mass, scene, usual_loads
from crosscheck.viewing.server import MAX_QUESTION_BYTES, SIMULATION_STEP, PageServer
from graphdyn import Body, Chord, Joint, JointLimits, Placement, RobotModel, inverse_dynamics, simulate
from graphdyn.excitation import FourierBasis, Trajectory

ROUNDING = 1e-12

SINGLE = 1e-6
"""Relative: loads are sent as 32-bit numbers."""

LARGEST_STAGE = 1_500_000
"""Characters of a page of the player with one robot and its meshes, or with few and simple ones."""


def pendulum(*, limits=None, couplings=()):
    rod = Body("rod", 2.0, np.array([0.0, 0.0, -0.4]), np.diag([0.02, 0.02, 0.001]))
    bob = Body("bob", 0.5, np.array([0.0, 0.0, -0.1]), np.diag([0.001, 0.001, 0.001]))
    joints = (
        Joint("swing", "revolute", 0, Placement(), np.array([0.0, 1.0, 0.0]), limits or JointLimits()),
        Joint("slide", "prismatic", 1, Placement(translation=np.array([0.0, 0.0, -0.8])), np.array([0.0, 0.0, 1.0])),
    )
    return RobotModel("pendulum", (rod, bob), joints, couplings=couplings)


def roped_pendulum():
    """A taut rope from the ground holds the slide where it is at q = 0."""
    rope = Chord("rope", "distance", 0, Placement(), 2, Placement(), length=0.8)
    return dataclasses.replace(pendulum(), chords=(rope,))


class TestFigures:
    @pytest.mark.parametrize("axes", [(0.1, 0.2, 0.3), (0.5, 0.5, 0.0)])
    def test_the_ellipsoid_of_a_homogeneous_ellipsoid_is_itself(self, axes):
        """J of half axes a, b, c is m / 5 diag(b² + c², a² + c², a² + b²); seen along axes that are turned."""
        squares = np.square(axes)
        turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
        inertia = turn @ np.diag(3.0 / 5 * (squares.sum() - squares)) @ turn.T
        found, directions = inertia_ellipsoid(Body("solid", 3.0, np.zeros(3), inertia))
        assert np.abs(np.sort(found) - np.sort(axes)).max() < 1e-7  # a root of rounding
        assert abs(np.linalg.det(directions) - 1) < ROUNDING
        assert np.abs((directions * found**2) @ directions.T - (turn * squares) @ turn.T).max() < ROUNDING

    def test_no_real_body_has_it(self):
        assert inertia_ellipsoid(Body("thin", 1.0, np.zeros(3), np.diag([1.0, 1.0, 3.0]))) is None
        assert inertia_ellipsoid(Body("point", 0.0, np.zeros(3), np.zeros((3, 3)))) is None

    def test_a_robot_stands_within_its_limits(self):
        assert standing_position(pendulum(limits=JointLimits(0.4, 1.0))).tolist() == [0.4, 0.0]

    def test_cylinders_are_closed_and_seen_from_outside(self):
        """Their volume by the theorem of Gauss: that of a prism with as many sides, π r² l at most."""
        shapes = stand_ins(pendulum())
        assert [shape.body for shape in shapes] == [1, 2]
        corners = shapes[0].vertices[shapes[0].faces]
        volume = np.einsum("ka,ka->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        radius = np.linalg.norm(shapes[0].vertices[:, :2], axis=1).max()
        assert 0.98 < volume / (np.pi * radius**2 * 0.8) < 1.0
        assert abs(2.0 * radius**2 / 2 - 0.001) < ROUNDING  # m r² / 2 = J_zz

    def test_shapes_are_placed_in_their_link(self):
        """A box, moved and turned about all axes as SciPy turns it; what is not shown is told."""
        xyz, rpy = np.array([0.1, -0.2, 0.3]), [0.3, -0.5, 0.9]
        place = f'<origin xyz="{" ".join(map(str, xyz))}" rpy="{" ".join(map(str, rpy))}"/>'
        drawn = visual('<box size="0.4 0.1 0.2"/>', place) + visual('<mesh filename="gone.stl"/>')
        text = one_link(drawn)
        found = shown_robot(text, urdf.load(text), urdf.Reading(), 1000)
        (shape,) = found.shapes
        corners = 0.5 * np.array([0.4, 0.1, 0.2]) * np.array(list(product((-1, 1), repeat=3)))
        expected = Rotation.from_euler("xyz", rpy).apply(corners) + xyz
        assert shape.body == 1
        apart = np.linalg.norm(shape.vertices[:, None] - expected, axis=-1)
        assert apart.min(axis=1).max() < 1e-9
        assert apart.min(axis=0).max() < 1e-9
        (note,) = found.notes
        assert note.startswith("arm: ")
        assert "gone.stl is not shown: " in note

    def test_shapes_as_they_are_sent(self):
        """Vertices within half a step of 65535 of the box, on each axis; colors to a thousandth."""
        rng = np.random.default_rng(4)
        vertices = rng.normal(size=(30, 3)) * [1.0, 0.1, 20.0]
        faces = np.arange(30).reshape(10, 3)
        shape = BodyShape(1, vertices, faces, (0.12345, 0.5, 1.0, 0.25))
        store = NumberStore()
        (sent,) = scene("one", [Figure("a", ShownRobot(pendulum(), (shape,)))], store)["robots"][0]["shapes"]
        numbers = gzip.decompress(b64decode(store.text()))
        kind, first, length = sent["vertices"]
        steps = np.frombuffer(numbers, f"<{kind}", length, first).reshape(-1, 3)
        found, half = np.array(sent["low"]) + steps * sent["step"], np.ptp(vertices, axis=0) / 65535 / 2
        assert (np.abs(found - vertices) <= half * (1 + 1e-6)).all()
        assert sent["color"] == [0.123, 0.5, 1.0, 0.25]

    @pytest.mark.parametrize(("count", "kind"), [(300, "u2"), (70_000, "u4")])
    def test_faces_as_they_are_sent(self, count, kind):
        """Numbers of vertices, whole, in as few bytes as hold the largest."""
        faces = np.array([[0, 1, count - 1], [count - 2, 5, 7]])
        shape = BodyShape(1, np.random.default_rng(1).normal(size=(count, 3)), faces, (1, 1, 1, 1))
        store = NumberStore()
        (sent,) = scene("one", [Figure("a", ShownRobot(pendulum(), (shape,)))], store)["robots"][0]["shapes"]
        found, first, length = sent["faces"]
        assert found == kind
        numbers = np.frombuffer(gzip.decompress(b64decode(store.text())), f"<{kind}", length, first)
        assert np.array_equal(numbers.reshape(-1, 3), faces)

    def test_torques_that_miss_links_without_mass(self):
        """Those of the joints before such a link; the page shows – in their place."""
        model = urdf.load("ur5")
        assert lacking_mass(model) == [False] * 6
        massless = dataclasses.replace(model.bodies[3], mass=0.0, inertia=np.zeros((3, 3)))
        bodies = (*model.bodies[:3], massless, *model.bodies[4:])
        assert lacking_mass(dataclasses.replace(model, bodies=bodies)) == [True] * 4 + [False] * 2

    def test_usual_loads(self):
        """2.5 kg at 0.8 m and 0.1 m; without gravity on Earth; without mass the efforts, apart."""
        model = pendulum()
        weight = 2.5 * np.linalg.norm(model.gravity)
        assert usual_loads(model) == pytest.approx({"force": weight, "torque": 0.9 * weight}, rel=ROUNDING)
        free = usual_loads(model.with_gravity(np.zeros(3)))
        assert free == pytest.approx({"force": 2.5 * 9.80665, "torque": 0.9 * 2.5 * 9.80665}, rel=ROUNDING)
        bodies = [dataclasses.replace(body, mass=0.0, inertia=np.zeros((3, 3))) for body in model.bodies]
        joints = [
            dataclasses.replace(joint, limits=JointLimits(effort=effort))
            for joint, effort in zip(model.joints, (30.0, 400.0), strict=True)
        ]
        assert usual_loads(dataclasses.replace(model, bodies=bodies, joints=joints)) == {"force": 400.0, "torque": 30.0}
        assert usual_loads(dataclasses.replace(model, bodies=bodies)) == {"force": 0.0, "torque": 0.0}


class TestMotions:
    def test_rows(self):
        """Fifty a second and the last; of a long motion no more than the most."""
        time = 3.0 + np.arange(1001) / 1000
        assert np.abs(time[shown_rows(time)] - 3.0 - np.arange(51) / 50).max() < ROUNDING
        assert shown_rows(np.array([0.0, 0.001, 0.002])).tolist() == [0, 2]
        assert shown_rows(np.array([5.0])).tolist() == [0]
        assert len(shown_rows(np.arange(0, 1000, 0.01))) == MAX_INSTANTS + 1

    def test_loads_of_inverse_dynamics_or_as_recorded(self):
        model = pendulum()
        motion = simulate(model, [0.3, 0.1], [0.0, 0.0], 0.2, at=np.linspace(0, 0.2, 21))
        full = recording_of(motion.recording())
        plain = Recording(full.joint_names, full.t, full.q, full.v, full.a)
        recorded, told = recorded_motion(model, full)
        computed, _ = recorded_motion(model, plain)
        assert told == ("0.2 s, 11 of 21 instants shown", "loads as recorded")
        size = np.abs(motion.reactions.joint_wrenches).max()
        for found in (recorded, computed):
            assert np.abs(found.joint_wrenches - motion.reactions.joint_wrenches[::2]).max() < ROUNDING * size
            assert np.abs(found.tau).max() < ROUNDING * size
        assert computed.recorded_tau is None
        assert recorded.recorded_tau.shape == (11, 2)

    def test_loads_of_a_planned_motion(self):
        """Fifty instants a second, with the torques that the bodies need."""
        model, rng = pendulum(), np.random.default_rng(2)
        course = Trajectory(FourierBasis(2.0, 3), 0.3 * rng.normal(size=(2, 5)))
        motion, told = planned_motion(model, course)
        assert motion.time == pytest.approx(np.arange(101) / 50)
        q, v, a, _ = course.motion(motion.time)
        assert np.array_equal(motion.q, q)
        assert np.abs(motion.tau - inverse_dynamics(model, q, v, a).tau).max() < 1e-9
        assert told == ("as planned", "loads by inverse dynamics of q, v and a")

    def test_a_long_plan_is_thinned(self):
        """400 s: no more than the most instants, from its start to its end."""
        course = Trajectory(FourierBasis(400.0, 2), np.zeros((2, 3)) + 0.1)
        motion, _ = planned_motion(pendulum(), course)
        assert motion.time == pytest.approx(np.linspace(0, 400, MAX_INSTANTS + 1))

    def test_pieces_are_told(self):
        model = pendulum()
        t, still = np.array([1.0, 1.1, 5.0]), np.zeros((3, 2))
        recording = Recording(model.joint_names, t, still, still, still, block=np.array([0, 0, 1]))
        motion, told = recorded_motion(model, recording)
        assert told[0] == "4 s from 1 s on, 3 of 3 instants shown"
        assert told[-1] == "2 uninterrupted pieces, joined by straight lines"
        assert np.abs(motion.tau - inverse_dynamics(model, still, still, still).tau).max() < ROUNDING

    def test_loads_of_loops_may_be_open(self):
        """Where motors are unknown, the robot is shown without loads, which is told."""
        loop = roped_pendulum()
        motion, told = closed_instant(loop)
        assert np.abs(motion.q[0] - loop.closed_pose).max() == 0
        assert np.isnan(motion.joint_wrenches).all()
        assert told[0] == "the pose that closes the loops, at rest"
        assert re.match("no loads are shown: robot 'pendulum' has loops, and which joints have motors is not", told[1])


@pytest.fixture(scope="module")
def server():
    """Figure 0 is a tree, joint 2 of figure 1 is driven, figure 2 has a loop."""
    coupled = pendulum(couplings=(graphdyn.Coupling("slide", {"swing": 0.1}),))
    models = (pendulum(), coupled, roped_pendulum())
    with PageServer("three", [Figure("a", ShownRobot(model, stand_ins(model))) for model in models]) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def arrays(content):
    """array(name) of a motion that the server answered."""
    answer = json.loads(content)
    numbers = gzip.decompress(b64decode(answer["numbers"]))

    def array(name):
        kind, first, length = answer["motion"][name]
        return np.frombuffer(numbers, f"<{kind}", length, first)

    return array


class TestServer:
    def asked(self, server, method="GET", path=None, body=None, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, server.path if path is None else path, body, headers)
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer.status, content, answer.headers

    def let_go(self, server, body, origin=None, name="let-go"):
        own = f"http://127.0.0.1:{server.server_port}"
        return self.asked(server, "POST", f"{server.path}{name}", body, Origin=origin or own)[:2]

    def test_only_this_machine_with_the_token(self, server):
        assert server.server_address[0] == "127.0.0.1"
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[\w-]{22}/", server.address)
        status, content, headers = self.asked(server)
        assert (status, headers["Cache-Control"], headers["Referrer-Policy"]) == (200, "no-store", "no-referrer")
        assert "connect-src 'self'" in content.decode()
        for path in ("/", "/favicon.ico", server.path[:-1], server.path + "x", "/" + "A" * 22 + "/"):
            assert self.asked(server, path=path)[0] == 404
        assert self.asked(server, "POST", "/let-go", b"{}", Origin=server.address[:-25])[0] in (403, 404)

    @pytest.mark.parametrize("host", ["evil.example", "localhost", "127.0.0.1", "127.0.0.1:1"])
    def test_another_host_is_refused(self, server, host):
        assert self.asked(server, Host=host)[:2] == (403, b"the page has another address")

    @pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1"])
    def test_another_origin_is_refused(self, server, origin):
        assert self.asked(server, Origin=origin)[:2] == (403, b"a page elsewhere asks")
        assert self.let_go(server, b"{}", origin) == (403, b"a page elsewhere asks")

    def test_a_question_without_origin_is_refused(self, server):
        assert self.asked(server, "POST", f"{server.path}let-go", b"{}")[0] == 403

    def test_let_go(self, server):
        """The motion that graphdyn.simulate gives, in the form of the page."""
        status, content = self.let_go(server, json.dumps({"figure": 0, "q": [0.5, 0.1], "seconds": 0.2}))
        assert status == 200
        array = arrays(content)
        expected = simulate(pendulum(), [0.5, 0.1], [0.0, 0.0], 0.2, method="rk4", step=SIMULATION_STEP)
        rows = shown_rows(expected.time)
        assert np.array_equal(array("time"), expected.time[rows])
        assert np.array_equal(array("q").reshape(-1, 2), expected.q[rows])
        wrenches = expected.reactions.joint_wrenches[rows]
        assert np.abs(array("wrenches").reshape(wrenches.shape) - wrenches).max() < SINGLE * np.abs(wrenches).max()

    def test_let_go_with_friction_for_no_longer_than_the_most(self, monkeypatch):
        """A question for an hour is answered for the longest time; what the file says of friction is in it."""
        model = pendulum()
        joints = [dataclasses.replace(joint, damping=0.3, friction=0.1) for joint in model.joints]
        model = dataclasses.replace(model, joints=joints)
        monkeypatch.setattr("crosscheck.viewing.server.MAX_DURATION", 0.2)
        with PageServer("one", [Figure("a", ShownRobot(model, stand_ins(model)))]) as server:
            answer = server.answer("let-go", b'{"figure": 0, "q": [0.5, 0.1], "seconds": 3600}')
        array = arrays(json.dumps(answer))
        rubbed, free = (
            simulate(model, [0.5, 0.1], [0.0, 0.0], 0.2, method="rk4", step=SIMULATION_STEP, friction=friction).q[-1]
            for friction in ("model", None)
        )
        assert array("time")[-1] == pytest.approx(0.2)
        assert np.array_equal(array("q")[-2:], rubbed)
        assert np.abs(rubbed - free).max() > 1e-3

    def test_a_loop_is_closed(self, server):
        """The moved joint stays where it was put, the others follow."""
        question = json.dumps({"figure": 2, "q": [0.2, 0.1], "hold": "swing"})
        status, content = self.let_go(server, question, name="pose")
        assert status == 200
        assert np.abs(arrays(content)("q") - [0.2, 0.0]).max() < ROUNDING

    @pytest.mark.parametrize(
        ("question", "reason"),
        [
            (b"[", "the question has another form than the page gives it"),
            (b'{"figure": 1e999, "q": [0, 0], "seconds": 1}', "another form"),
            (b'{"figure": 7, "q": [0, 0], "seconds": 1}', "another form"),
            (b'{"figure": 0, "q": [0], "seconds": 1}', "q"),
            (b'{"figure": 0, "q": [0, 0], "seconds": 0}', "duration is 0.0"),
        ],
    )
    def test_other_questions_are_answered_with_the_reason(self, server, question, reason):
        status, content = self.let_go(server, question)
        assert status == 400
        assert reason in content.decode()

    def test_a_long_question_is_not_read(self, server):
        assert self.let_go(server, b" " * (MAX_QUESTION_BYTES + 1))[0] == 413


@pytest.mark.usefixtures("unpictured")
class TestCommand:
    def test_a_page(self, program, small_arm, tmp_path):
        run, file = tmp_path / "run.npz", tmp_path / "view.html"
        program("simulate", small_arm, "--duration", 0.05, "--position", "0.1,0.2,0.3", "--out", run)
        done = program("view", small_arm, "--play", run, "--play", run, "--html", file)
        assert (done.code, done.out) == (AGREED, "")
        assert "small.urdf: run.npz: loads by inverse dynamics of q, v and a" in done.err
        assert "small.urdf: run.npz: cylinders from joint to joint, in place of shapes" in done.err
        text = file.read_text(encoding="utf-8")
        assert "connect-src" not in text
        shown = json.loads(re.search('id="scene">(.*?)</script>', text).group(1))
        assert [figure["robot"] for figure in shown["figures"]] == [0, 0]
        assert len(shown["robots"]) == 1
        assert shown["figures"][0]["start"] == [0.1, 0.2, 0.3]

    def test_a_log_of_positions(self, program, small_arm, tmp_path):
        """Velocities and accelerations are derived, which is told."""
        t = np.arange(0, 4, 0.01)
        q = np.stack([0.5 * np.sin(2 * t), 0.5 + 0.3 * np.cos(t), 0.1 * np.sin(t)], axis=1)
        log, file = tmp_path / "log.csv", tmp_path / "view.html"
        header = "t,q_z_shoulder,q_y_elbow,q_a_slide"
        np.savetxt(log, np.column_stack([t, q]), delimiter=",", header=header, comments="")
        done = program("view", small_arm, "--play", log, "--cutoff", "none", "--html", file)
        assert done.code == AGREED, done.err
        assert "log.csv: no filter; v, a by central differences" in done.err

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (("kr500", "kr500", "--play", "a.csv"), "2 robots and 1 run; give one robot, or one for each run"),
            (("kr500", "--play", "a.csv", "--cutoff", "x"), "--cutoff x: give Hz, CHANNEL=HZ,…, residual or none"),
            (("kr500", "--play", "missing.csv"), "missing.csv"),
            (("kr501",), "'kr501' is neither a file nor a robot"),
        ],
    )
    def test_refused(self, program, words, arguments, message):
        done = program("view", *arguments, "--html", "-")
        assert done.code == BAD_INPUT
        assert message in words(done.err)

    def test_a_port_that_is_taken(self, program, words, server):
        done = program("view", "kr500", "--no-browser", "--port", server.server_port)
        assert done.code == BAD_INPUT
        assert f"--port {server.server_port}: Address already in use; name another, or 0" in words(done.err)

    @pytest.mark.parametrize("browser", [True, False])
    def test_served_until_ctrl_c(self, program, monkeypatch, browser):
        opened, ports = [], []

        def interrupted(server):
            ports.append(server.server_port)
            raise KeyboardInterrupt

        monkeypatch.setattr("webbrowser.open", opened.append)
        monkeypatch.setattr(PageServer, "serve_forever", interrupted)
        done = program("view", "kr500", *(() if browser else ("--no-browser",)))
        assert done.code == AGREED
        (port,) = ports
        address, told = done.out.strip().split("  ")
        assert address.startswith(f"http://127.0.0.1:{port}/")
        assert told == "(Ctrl-C ends)"
        assert opened == [address] * browser
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", port))

    @pytest.fixture
    def figures(self, program, tmp_path):
        """figures(command, …): what the player of its page shows, in place of a picture where there is one robot.

        The policy of the page allows the scripts of both and no others; the player is in it once.
        """

        def figures(*arguments):
            file = tmp_path / "report.html"
            done = program(*arguments, "--3d", "--html", file)
            assert done.code == AGREED, done.err
            text = file.read_text(encoding="utf-8")
            (inside,) = map(html.unescape, re.findall('srcdoc="([^"]*)"', text))
            scripts = re.findall(r"<script>(.*?)</script>", text + inside, re.DOTALL)
            scripts.append(gzip.decompress(b64decode(re.search('id="libraries">(.*?)<', inside)[1])).decode())
            hashes = {f"'sha256-{b64encode(hashlib.sha256(script.encode()).digest()).decode()}'" for script in scripts}
            assert set(re.search('script-src ([^"]*)"', text)[1].split()) == hashes
            assert len(inside) < LARGEST_STAGE
            found = json.loads(re.search('id="scene">(.*?)</script>', inside)[1])["figures"]
            assert ("Stick figure of" in opened(text)) == (len(found) > 1)
            return found

        return figures

    def test_on_the_page_of_show(self, figures, small_arm):
        (figure,) = figures("show", small_arm, "--state", "0.1,0.2,0.3")
        assert figure["motion"] is None
        assert figure["start"] == [0.1, 0.2, 0.3]

    def test_on_the_page_of_simulate(self, figures, small_arm):
        (figure,) = figures("simulate", small_arm, "--position", "0.1,0.2,0.3", "--duration", 0.05)
        assert figure["start"] == [0.1, 0.2, 0.3]
        assert figure["motion"]["time"][2] == 4  # nearest to each 0.02 s, and the last

    def test_on_the_page_of_crosscheck(self, figures, small_arm, second_pendulum, monkeypatch):
        """Several robots side by side; one of show stands in place of its picture."""
        monkeypatch.setattr(comparing, "cases", lambda *arguments: islice(cases(*arguments), 1))
        robots = [small_arm, second_pendulum]
        found = figures("crosscheck", *robots, "--samples", 1)
        assert [figure["name"] for figure in found] == [robot.name for robot in robots]
        assert all(figure["motion"] is None for figure in found)

    def test_an_arm_that_was_cut_out(self, figures, small_arm):
        """It has the bodies of its chain alone."""
        (figure,) = figures("show", small_arm, "--chain", "base", "fore")
        assert len(figure["start"]) == 2

    def test_on_the_page_of_judge(self, figures, my_code):
        (figure,) = figures("judge", "ur5", "--inverse-dynamics", "my_code.py:rnea", "--samples", 1)
        assert figure["name"] == "ur5"
        assert figure["motion"] is None

    @pytest.mark.usefixtures("unexamined")
    def test_on_the_page_of_identify(self, figures, small_arm):
        """The motion that was fitted, with the torque of the recording."""
        (figure,) = figures("identify", "--robot", small_arm, "--seconds", 10, "--methods", "consistent", "--poses", 9)
        assert figure["notes"][0] == "simulated motion 1 of small, the motion as it was fitted"
        instants, rows = map(int, re.search(r"(\d+) of (\d+) instants shown", figure["notes"][1]).groups())
        assert rows / 10 < instants < rows
        assert figure["motion"]["time"][2] == instants
        assert figure["motion"]["recorded"][2] == 3 * instants

    @pytest.mark.parametrize("command", ["show", "simulate", "crosscheck", "judge", "identify"])
    def test_3d_without_a_page(self, program, words, command, small_arm):
        done = program(command, *(["--robot"] if command == "identify" else []), small_arm, "--3d")
        assert done.code == BAD_INPUT
        assert "--3d is for the page of --html FILE; name it, or look with `graphdyn view`" in words(done.err)

    def test_3d_of_a_folder(self, program, words, small_arm, tmp_path):
        done = program("crosscheck", tmp_path, "--3d", "--html", tmp_path / "x.html")
        assert done.code == BAD_INPUT
        assert "--3d is not for folders; name the robots" in words(done.err)
