"""Every number on the page and in the JSON file of a command, computed again beside it."""

import json
import re

import numpy as np
import pytest
from shown import pages
from shown.approved import approve, approve_record, page_text
from typer.testing import CliRunner

import urdf
from crosscheck.commands import app
from crosscheck.commands.program.exits import AGREED
from crosscheck.commands.simulate.record import SimulatedRun
from crosscheck.commands.simulate.report import simulate_report
from crosscheck.exciting.motion_formats.krl import AxisSettings
from crosscheck.exciting.motion_formats.motion_file import document, slides
from crosscheck.exciting.motion_formats.timed_motion import TimedMotion
from crosscheck.report.records.record import plain
from crosscheck.report.text import as_text
from graphdyn import inverse_dynamics, joint_torque_regressor, mass_matrix, maximal_state, simulate
from graphdyn.excitation import FourierBasis, Trajectory
from graphdyn.identification.terms.bodies import PARAMETER_SYMBOLS

FOUR_DIGITS = 6e-4
"""Relative: numbers of tables have four digits, 5e-4 at worst."""

SINGLE = 1e-6
"""Relative: curves are 32-bit numbers."""

ROUNDING = 1e-9

MIMIC = '<axis xyz="0 1 0"/><mimic joint="z_shoulder" multiplier="-0.5" offset="0.1"/>'


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("shown")


@pytest.fixture(scope="module")
def ran(folder):
    """ran(command, …): the page and the JSON of one run."""

    def ran(command, *arguments):
        page, file = folder / f"{command}.html", folder / f"{command}.json"
        done = CliRunner().invoke(app, [command, *map(str, arguments), "--html", str(page), "--json", str(file)])
        assert done.exit_code == AGREED, done.output
        return page.read_text(encoding="utf-8"), json.loads(file.read_text(encoding="utf-8"))

    return ran


@pytest.fixture(scope="module")
def driven_arm(folder, small_arm_text):
    """z_shoulder drives y_elbow; the independent joints are the first and the third."""
    path = folder / "driven.urdf"
    path.write_text(small_arm_text.replace('<axis xyz="0 1 0"/>', MIMIC), encoding="utf-8")
    return path


STEP = 5e-3
"""Of Euler's method, with a drift of energy that rounding does not hide; a row after every step [s]."""


@pytest.fixture(scope="module")
def simulated(ran, folder, driven_arm):
    how = ("--torque", "hold", "--method", "euler", "--step", STEP, "--rate", 200, "--duration", 0.2)
    out = folder / "run.npz"
    page, record = ran("simulate", driven_arm, "--position", "0.2,0.1", "--velocity", "1,-0.5", *how, "--out", out)
    with np.load(out) as file:
        return page, record, dict(file)


@pytest.fixture(scope="module")
def in_motion(simulated, driven_arm):
    """q, v, tau of all joints, forces and moments that they transmit, and the energies, at the rows of the file."""
    file, model = simulated[2], urdf.load(driven_arm, mimic="coupled")
    tree, (q, v, a) = model.uncoupled, (file[name][:, [0, 2]] for name in "qva")
    tau = inverse_dynamics(model, q, v, a).tau
    matrix = np.array([[1, 0], [-0.5, 0], [0, 1]])
    q, v, a = q @ matrix.T + [0, 0.1, 0], v @ matrix.T, a @ matrix.T
    wrenches = inverse_dynamics(tree, q, v, a).joint_wrenches
    kinetic = np.einsum("ki,kij,kj->k", v, mass_matrix(tree, q), v) / 2
    centers = np.array([maximal_state(tree, row).position for row in q])
    masses = np.array([body.mass for body in tree.bodies])
    potential = -np.einsum("j,kja,a->k", masses, centers, tree.gravity)
    power = np.einsum("kj,kj->k", tau, v[:, [0, 2]])
    work = np.append(0.0, STEP * np.cumsum(power[:-1]))
    driven = np.stack([tau[:, 0], 0 * tau[:, 0], tau[:, 1]], axis=1)
    forces, moments = (np.linalg.norm(wrenches[..., part], axis=-1) for part in (slice(0, 3), slice(3, 6)))
    return {
        "time": file["t"], "q": q, "v": v, "tau": driven,
        "force": forces, "moment": moments, "kinetic": kinetic, "potential": potential, "work": work,
    }  # fmt: skip


class TestSimulate:
    def test_joints(self, simulated, in_motion):
        page, record, _ = simulated
        e = in_motion
        largest = [np.abs(e[name]).max(axis=0) for name in ("v", "tau", "force", "moment")]
        wanted = np.array([e["q"].min(axis=0), e["q"].max(axis=0), *largest]).T
        names = ("lowest", "highest", "largest_velocity", "largest_torque", "largest_force", "largest_moment")
        found = np.array([[joint[name] for name in names] for joint in record["joints"]])
        np.testing.assert_allclose(found, wanted, rtol=ROUNDING, atol=1e-12)
        shown = pages.table(page, "Joints, and their largest speeds and loads")
        assert [row[:2] for row in shown] == [["1", "z_shoulder"], ["2", "y_elbow"], ["3", "a_slide"]]
        np.testing.assert_allclose([pages.numbers(row[2:]) for row in shown], wanted, rtol=FOUR_DIGITS)
        assert [joint["prismatic"] for joint in record["joints"]] == [False, False, True]
        assert min(wanted[[0, 2], 3]) > 1  # the driven joint has no actuator

    def test_energies(self, simulated, in_motion):
        page, record, _ = simulated
        e = in_motion
        error = e["kinetic"] + e["potential"] - e["work"]
        drift = np.abs(error - error[0]).max() / e["kinetic"].max()
        assert drift > 1e-3
        assert record["energy_drift"] == pytest.approx(drift, rel=1e-6)
        said, largest = re.match(
            r"(\S+) of the largest kinetic energy, (\S+) J", pages.facts(page)["energy drift"]
        ).groups()
        assert float(said) == pytest.approx(drift, rel=0.05)
        assert float(largest) == pytest.approx(e["kinetic"].max(), rel=FOUR_DIGITS)

    def test_facts(self, simulated):
        page, record, _ = simulated
        facts = pages.facts(page)
        assert (record["duration"], record["rows"], record["step"]) == (pytest.approx(0.2), 41, STEP)
        assert (record["locked"], record["chain"]) == ({}, None)
        assert (facts["time"], facts["method"], facts["torque"]) == (
            "0.2 s, 41 rows",
            "euler, steps of 0.005 s",
            "hold",
        )
        assert record["closure_error"] < 1e-12
        assert float(re.search(r"closed to (\S+) ", facts["closure"])[1]) < 1e-12

    def test_curves(self, simulated, in_motion):
        ((time, curves),) = pages.plots(simulated[0])
        e, names = in_motion, ("z_shoulder", "y_elbow", "a_slide")
        np.testing.assert_allclose(time, e["time"], rtol=ROUNDING)
        for title, name in (("position", "q"), ("velocity", "v"), ("torque of the actuators", "tau")):
            size = np.abs(e[name]).max()
            for j, joint in enumerate(names):
                np.testing.assert_allclose(curves[title][joint], e[name][:, j], rtol=0, atol=SINGLE * size)
        for shown, name in (("kinetic", "kinetic"), ("potential", "potential"), ("work of the actuators", "work")):
            np.testing.assert_allclose(
                curves["energy"][shown], e[name], rtol=0, atol=SINGLE * np.abs(e["kinetic"]).max() * 10
            )
        assert np.all(curves["energy"]["dissipated by friction and stops"] == 0)


def test_the_largest_closure_error_is_told(driven_arm, monkeypatch):
    """Of all rows, on the page and in the JSON."""
    model = urdf.load(driven_arm, mimic="coupled")
    motion = simulate(model, [0.2, 0.1], [0, 0], 0.01, method="euler", step=STEP)
    run = SimulatedRun(motion, "driven", urdf.Reading(), "zero", "euler", STEP, None)
    monkeypatch.setattr(type(motion), "closure_error", lambda _: np.array([1e-3, 2.5e-3, 5e-4]))
    report = simulate_report(run)
    assert plain(report.record([]))["closure_error"] == 2.5e-3
    assert "closed to 2.5e-03 (m, cosines)" in as_text(report)


SECONDS, RATE, NOISE = 4, 100, np.array([0.5, 0.4, 2.0])
LARGEST = {"position": 2.0, "velocity": 2.0, "acceleration": 20.0, "torque": 200.0}
PLANE_DISTANCE = -3.0
"""Of a horizontal plane, far below the robot [m]."""


@pytest.fixture(scope="module")
def planned(ran, folder, small_arm_text):
    """One motion from one seed, beside three random ones and a recording of another."""
    path, log = folder / "small.urdf", folder / "log.csv"
    path.write_text(small_arm_text, encoding="utf-8")
    model = urdf.load(path)
    earlier = Trajectory(FourierBasis(SECONDS, 3), 0.3 * np.random.default_rng(0).normal(size=(3, 5)))
    timed = TimedMotion.of(earlier, model.independent_joints, slides(model), float(RATE))
    log.write_bytes(document(timed, log, AxisSettings()))
    limits = ("--velocity", 2, "--acceleration", 20, "--torque", 200, "--lower", -2, "--upper", 2)
    search = ("--duration", SECONDS, "--harmonics", 2, "--seeds", 1, "--random", 3, "--jobs", 1, "--rate", RATE)
    noise = ("--noise", ",".join(map(str, NOISE)), "--plane", f"0,0,1,{PLANE_DISTANCE}")
    against = ("--against", log, "--cutoff", "none")
    return *ran("excite", "--robot", path, *limits, *search, *noise, *against), model, timed


def fourier(record, times):
    """q, v, a (N, n) of the motion in the JSON file."""
    (motion,) = record["motions"]
    columns = []
    for joint in motion["fourier"]:
        a, b = np.array(joint["a"]), np.array(joint["b"])
        w = 2 * np.pi / motion["duration"] * np.arange(1, len(a) + 1)
        s, c = np.sin(np.outer(times, w)), np.cos(np.outer(times, w))
        columns.append((joint["offset"] + s @ (a / w) - c @ (b / w), c @ a + s @ b, c @ (b * w) - s @ (a * w)))
    return np.array(columns).transpose(1, 2, 0)


def information(model, record, motion, samples):
    """F of rows of a motion, as of so many samples: of the columns that name the base parameters."""
    q, v, a = motion
    regressor = joint_torque_regressor(model, q, v, a)
    drives = [x[:, :, None] * np.eye(3) for x in (v, np.sign(v), np.ones_like(v))]
    symbols = [f"{symbol}_{body}" for body in (1, 2, 3) for symbol in PARAMETER_SYMBOLS]
    symbols += [f"{symbol}_{joint}" for symbol in ("FV", "FC", "OFF") for joint in (1, 2, 3)]
    columns = [symbols.index(row["name"].split()[0]) for row in record["parameters"]]
    whole = np.concatenate([regressor, *drives], axis=-1)[..., columns] / NOISE[:, None]
    return np.einsum("kji,kjl->il", whole, whole) * samples / len(q)


class TestExcite:
    def test_curves(self, planned):
        page, record, model, _ = planned
        ((times, curves),) = pages.plots(page)
        q, v, a = fourier(record, times)
        tau = inverse_dynamics(model, q, v, a).tau
        assert times[-1] == SECONDS
        titles = ("position", "velocity", "acceleration", "torque of the bodies")
        for title, values in zip(titles, (q, v, a, tau), strict=True):
            for j, joint in enumerate(model.joint_names):
                size = np.abs(values[:, j]).max()
                np.testing.assert_allclose(curves[title][joint], values[:, j], rtol=0, atol=SINGLE * size)

    def test_limits(self, planned):
        """At 1 kHz; torques with the friction that the file states, planes from the origins of the links."""
        page, record, model, _ = planned
        q, v, a = fourier(record, np.arange(1000 * SECONDS + 1) / 1000)
        damping, friction = (np.array([getattr(j, name) for j in model.joints]) for name in ("damping", "friction"))
        tau = inverse_dynamics(model, q, v, a).tau + damping * v + friction * np.sign(v)
        used = {
            (kind, joint): np.abs(values[:, j]).max() / LARGEST[kind]
            for kind, values in zip(LARGEST, (q, v, a, tau), strict=True)
            for j, joint in enumerate(model.joint_names)
        }
        (motion,) = record["motions"]
        found = {(one["kind"], one["name"]): one["used"] for one in motion["limits"]}
        lowest = found.pop(("plane", "plane 1"))
        assert found == pytest.approx(used, rel=1e-6)
        shown = {row[0]: pages.numbers(row[1:]) for row in pages.table(page, "largest part of each limit")}
        for joint in model.joint_names:
            assert shown[joint] == pytest.approx([100 * used[kind, joint] for kind in LARGEST], rel=FOUR_DIGITS)
        assert shown["plane 1"][0] == pytest.approx(100 * lowest, rel=FOUR_DIGITS)
        assert np.isnan(shown["plane 1"][1:]).all()

    def test_parameters(self, planned):
        """σ from the columns of the regressor that name the base parameters."""
        page, record, model, timed = planned
        samples = RATE * SECONDS
        own = information(model, record, fourier(record, np.arange(samples + 1) / RATE), samples)
        before = information(model, record, (timed.q, timed.v, timed.a), samples)
        sigma, recorded = (np.sqrt(np.diag(np.linalg.inv(f))) for f in (own, before))
        rows = record["parameters"]
        assert [row["sigma"] for row in rows] == pytest.approx(sigma, rel=1e-6)
        assert [row["recorded"] for row in rows] == pytest.approx(recorded, rel=0.06)  # a by differences
        spread = np.array([row["spread"] for row in rows])
        relative = sigma / np.maximum(np.abs([row["prior"] for row in rows]), spread)
        assert [row["relative"] for row in rows] == pytest.approx(relative, rel=1e-6)
        words = np.where(relative <= 0.1, "well", np.where(relative <= 0.5, "roughly", "not"))
        assert [row["verdict"] for row in rows] == list(words)
        for name, values in {"plan": sigma, "recorded": recorded}.items():
            assert record[name]["geometric_mean"] == pytest.approx(np.exp(np.log(values / spread).mean()), rel=1e-2)
        scaled = np.linalg.eigvalsh(own * np.outer(spread, spread))
        assert record["plan"]["condition_number"] == pytest.approx(np.sqrt(scaled[-1] / scaled[0]), rel=1e-6)

        facts, others = pages.facts(page), ("best_random", "median_random", "recorded")
        assert facts["geometric mean σ"].startswith(f"{100 * record['plan']['geometric_mean']:.3g} % ")
        for title, name in zip(("best of 3 random", "median random", "recorded"), others, strict=True):
            ratio = record[name]["geometric_mean"] / record["plan"]["geometric_mean"]
            assert facts[title] == f"geometric mean σ {ratio:.2f} × as large"
        conditions = [record[name]["condition_number"] for name in ("plan", "best_random", "recorded")]
        assert re.findall(r"[\d.]+(?:e\+\d+)?", facts["condition number"]) == [f"{x:.3g}" for x in conditions]
        table = pages.table(page, "for independent errors of the torques")
        for row, cells, mean, size in zip(rows, table, sigma, relative, strict=True):
            assert [cells[0], cells[1]] == [row["name"], row["unit"]]
            wanted = [row["prior"] or np.nan, mean, 100 * size, *(row[name] / mean for name in others)]
            found = pages.numbers([*cells[2:5], *cells[6:]])
            assert cells[5].endswith(row["verdict"])
            np.testing.assert_allclose(found[:1], wanted[:1], rtol=FOUR_DIGITS)
            np.testing.assert_allclose(found[1:3], wanted[1:3], rtol=0.06)  # two digits
            np.testing.assert_allclose(found[3:], wanted[3:], atol=0.006)
        priors = {row["name"]: row["prior"] for row in rows}
        assert priors["M_3"] == pytest.approx(model.bodies[2].mass)
        assert priors["FV_1"] == 0


class TestWhole:
    def test_simulate(self, simulated):
        approve("simulate", page_text(simulated[0]))
        approve_record("simulate", simulated[1], without=("versions", "command"))

    def test_excite(self, planned):
        approve("excite", page_text(planned[0]), numbers=False)
