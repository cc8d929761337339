"""`graphdyn simulate`, the files it writes, and an identification from one of them."""

import json
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from planting import mixed_tree
from pyarrow import parquet
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from shared_data import DATA, REPOSITORY, existing

import crosscheck
import graphdyn
import urdf
from crosscheck.commands.program.exits import AGREED, BAD_INPUT
from crosscheck.commands.simulate.record import PassedLimit, SimulatedRun
from crosscheck.identifying import Preparation
from crosscheck.recordings import BadRecordingFile, load_recording, load_virtual_recording
from crosscheck.recordings.formats.format import motion_document
from crosscheck.reference.mujoco_model import MujocoModel
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from graphdyn import ComputedTorqueControl, Friction, InvalidInput, JointLimits, kr500, rollout, simulate
from graphdyn.identification.terms import Coulomb, Offset, RigidBodies, Viscous
from graphdyn.motion_laws import FourierSeries

ROOT = REPOSITORY

START = "0.1,0.2,0.3"

SPACED = 1e-9
"""[s] Stamps of bags are whole nanoseconds."""

TORQUES = """
import numpy as np

def swing(t, q, v):
    return np.array([0.3 * np.sin(t), 0.2, 0.0]) - 0.1 * v

def wrong(t, q, v):
    return [1.0]
"""


@pytest.fixture
def torques(tmp_path, monkeypatch, my_code):
    (tmp_path / "torques.py").write_text(TORQUES, encoding="utf-8")
    monkeypatch.delitem(sys.modules, "torques", raising=False)


def motion():
    return simulate(mixed_tree(), [0.1, 0.2, 0.3], np.zeros(3), 0.1, at=np.linspace(0.0, 0.1, 11)).recording()


@pytest.mark.parametrize("suffix", [".csv", ".mcap", ".npz", ".parquet"])
def test_files_are_read_back(suffix, tmp_path):
    recording, path = motion(), tmp_path / f"run{suffix}"
    path.write_bytes(motion_document(recording, path, {"urdf": "<robot/>"}))
    found = load_recording(path, joints=recording.joint_names)
    assert np.abs(found.t - recording.time).max() < SPACED
    for name in ("q", "v", "tau"):
        assert np.array_equal(getattr(found, name), getattr(recording, name))
    if suffix != ".mcap":
        assert np.array_equal(found.a, recording.a)


def test_tables_have_every_channel(tmp_path):
    recording, path = motion(), tmp_path / "run.parquet"
    path.write_bytes(motion_document(recording, path, {}))
    found = load_virtual_recording(path)
    assert np.array_equal(found.joint_forces, recording.joint_forces)
    assert np.array_equal(found.joint_moments, recording.joint_moments)


def test_refused_files(tmp_path, monkeypatch):
    with pytest.raises(InvalidInput, match=r"run.h5: a motion is written as .mcap, .csv, .npz, .parquet, not as '.h5'"):
        motion_document(motion(), tmp_path / "run.h5", {})
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(BadRecordingFile, match=r"run.mcap: the package rosbags is not installed; .*\[rosbag\]'"):
        motion_document(motion(), tmp_path / "run.mcap", {})


def test_bag_for_ros(program, small_arm, tmp_path):
    """The bag opens with another library, and carries the robot and all settings."""
    out = tmp_path / "run.mcap"
    done = program("simulate", small_arm, "--duration", 0.05, "--position", START, "--out", out, "--rate", 200)
    assert done.code == AGREED
    assert "joints closed to" in done.out
    with AnyReader([out], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as bag:
        (connection,) = bag.connections
        assert (connection.topic, connection.msgtype) == ("/joint_states", "sensor_msgs/msg/JointState")
        messages = [bag.deserialize(raw, connection.msgtype) for _, _, raw in bag.messages()]
    assert [message.header.stamp.nanosec for message in messages] == [5_000_000 * k for k in range(11)]
    assert messages[0].position.tolist() == [0.1, 0.2, 0.3]
    content = out.read_bytes().decode("utf-8", errors="ignore")
    assert "<robot name=" in content.replace('\\"', '"').replace("''", "'")
    assert "--duration" in content


@pytest.mark.filterwarnings("ignore::urdf.ChainWarning")
def test_settings_in_parquet(program, small_arm, tmp_path):
    out = tmp_path / "run.parquet"
    chain = (urdf.load(small_arm).base_name, urdf.load(small_arm).body_names[-1])
    done = program(
        *("simulate", small_arm, "--duration", 0.01, "--torque", "hold", "--method", "rk4", "--out", out),
        *("--chain", *chain),
    )
    assert done.code == AGREED
    metadata = parquet.read_schema(out).metadata
    told = json.loads(metadata[b"simulation"])
    assert (told["torque"], told["chain"], told["locked"]) == ("hold", list(chain), {})
    assert told["command"][:2] == ["graphdyn", "simulate"]
    assert urdf.load(metadata[b"urdf"]).joint_names == urdf.load(small_arm, chain=chain).joint_names


def test_hold(program, small_arm, tmp_path):
    """A pushed arm comes back to where it started, whatever the gravity."""
    out = tmp_path / "run.parquet"
    arguments = ("--position", START, "--velocity", "0.5,0.2,-0.1", "--method", "rk4", "--duration", 2, "--out", out)
    assert program("simulate", small_arm, "--torque", "hold", *arguments).code == AGREED
    found = load_recording(out, joints=urdf.load(small_arm).joint_names)
    assert np.abs(found.q[-1] - [0.1, 0.2, 0.3]).max() < 1e-8
    assert np.abs(found.q - [0.1, 0.2, 0.3]).max() > 1e-3


@pytest.mark.parametrize(
    ("option", "asked"),
    [((), {}), (("--friction",), {"friction": "model"}), (("--limits",), {"limits": "stop"}),
     (("--efforts",), {"torque_limits": "model"})],
)  # fmt: skip
def test_each_option_is_the_keyword_of_its_name(option, asked, program, small_arm, monkeypatch):
    seen = {}

    def simulated(*_, **how):
        seen.update(how)
        raise InvalidInput("seen")

    monkeypatch.setattr(graphdyn, "simulate", simulated)
    assert program("simulate", small_arm, "--duration", 0.01, "--rate", 200, *option).code == BAD_INPUT
    names = ("friction", "limits", "torque_limits")
    assert {name: seen[name] for name in names} == dict.fromkeys(names) | asked
    assert seen["at"] == pytest.approx([0.0, 0.005, 0.01])


def test_torque_of_a_function(program, small_arm, torques, tmp_path):
    out = tmp_path / "run.npz"
    arguments = ("--duration", 0.1, "--friction", "--rate", 100, "--json", tmp_path / "r.json", "--out", out)
    done = program("simulate", small_arm, "--torque", "torques.py:swing", *arguments)
    assert done.code == AGREED
    found = load_recording(out)
    expected = np.column_stack([0.3 * np.sin(found.t), np.full(11, 0.2), np.zeros(11)]) - 0.1 * found.v
    assert np.abs(found.tau - expected).max() < 1e-12
    record = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    schema = json.loads((ROOT / "docs" / "schemas" / "simulate-1.schema.json").read_text(encoding="utf-8"))
    Draft202012Validator(schema).validate(record)
    assert record["rows"] == 11
    assert record["energy_drift"] < 1e-8
    assert record["joints"][0]["largest_force"] > 0
    assert record["torque"] == "torques.py:swing"


def test_limits_end_it(program, small_arm, tmp_path):
    file = tmp_path / "r.json"
    done = program("simulate", small_arm, "--velocity", "0,3,0", "--limits", "--duration", 9, "--json", file)
    assert "ended by: upper limit of joint 'a_slide'" in " ".join(done.out.split())
    record = json.loads(file.read_text(encoding="utf-8"))
    assert record["ended"] == record["occurrences"][-1]["name"] == "upper limit of joint 'a_slide'"
    assert record["duration"] < 9


LIMITED = (JointLimits(-0.5, 2.0, 4.0, 3.0), JointLimits(velocity=1.0), JointLimits(-0.1, 0.4, 1.0, 3.0))


def limited(q, v, tau):
    """Three joints, the last of which slides, at three instants a second apart, with q, v, τ (3, 3)."""
    tree = mixed_tree()
    joints = [
        replace(joint, limits=limits)
        for joint, limits in zip(sorted(tree.joints, key=lambda one: one.is_prismatic), LIMITED, strict=True)
    ]
    model = SimpleNamespace(
        joints=joints, n_bodies=3, degrees_of_freedom=SimpleNamespace(independent=[0, 1, 2], matrix=np.eye(3)),
        joint_positions=lambda q: q,
    )  # fmt: skip
    motion = SimpleNamespace(model=model, time=np.arange(3.0), q=np.array(q), v=np.array(v), tau=np.array(tau))
    return SimulatedRun(motion, "arm", urdf.Reading(), "zero", "dop853", None, None).passed_limits, joints


def test_passed_limits():
    """The farthest value of each kind, both ways, and when it is first beyond. Reaching a limit passes none."""
    q = [[0, 9, 0], [-0.7, 9, 0.4], [-0.6, 9, 0.4 + 1e-8]]
    v = [[0, 0, 1], [0, 0.5, -1.5], [0, -1.2, 0]]
    found, joints = limited(q, v, [[0, 50, 0], [3, 50, 2], [0, 50, -3.5]])
    assert found == [
        PassedLimit(joints[0].name, False, "position", -0.5, -0.7, 1.0),
        PassedLimit(joints[1].name, False, "velocity", 1.0, 1.2, 2.0),
        PassedLimit(joints[2].name, True, "velocity", 1.0, 1.5, 1.0),
        PassedLimit(joints[2].name, True, "effort", 3.0, 3.5, 2.0),
    ]


def test_passed_limits_are_told(program, small_arm, tmp_path):
    file = tmp_path / "r.json"
    done = program("simulate", small_arm, "--velocity", "0,3,0", "--duration", 2, "--json", file)
    passed = json.loads(file.read_text(encoding="utf-8"))["passed_limits"]
    assert "Limits that the motion passes" in done.out
    said = " ".join(done.out.split())
    for one in passed:
        unit = {"position": "m", "velocity": "m/s", "effort": "N"}[one["kind"]] if one["prismatic"] else "rad"
        assert f"{one['joint']}: its {one['kind']} reaches {one['farthest']:.4g} {unit}" in said
        assert f"; it passes the limit of {one['limit']:.4g} {unit}" in said
    assert "a_slide" in {one["joint"] for one in passed}


def test_page(program, small_arm, tmp_path):
    page = tmp_path / "run.html"
    assert program("simulate", small_arm, "--duration", 0.05, "--html", page).code == AGREED
    text = page.read_text(encoding="utf-8")
    assert "torque of the actuators" in text
    assert "largest speeds and loads" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--out", "run.txt"), "--out run.txt: name a file that ends with .mcap, .csv, .npz, .parquet"),
        (("--out", "-"), "--out -: name a file that ends with .mcap"),
        (("--rate", "0"), "--rate and --duration must be above zero"),
        (("--position", "1,2"), "--position has 2 numbers for 3 joints: z_shoulder, y_elbow, a_slide"),
        (("--velocity", "1,2,x"), "--velocity 1,2,x: give numbers with commas between them"),
        (("--torque", "torques.py:wrong"), "the function torque answers shape (1,) at 0 s"),
        (("--torque", "torques.py:none"), "none does not exist in torques.py"),
        (("--method", "rk5"), "method is 'rk5'; use one of dop853, rk8, rk4, euler"),
    ],
)
def test_refused(arguments, message, program, small_arm, torques):
    done = program("simulate", small_arm, "--duration", 0.1, *arguments)
    assert done.code == BAD_INPUT
    assert message in " ".join(done.err.replace("│", " ").split())


def test_the_same_motion_with_pinocchio():
    """Pinocchio's aba under the same DOP853 of SciPy, at the same tolerances."""
    from scipy.integrate import solve_ivp

    model = kr500()
    pinocchio = PinocchioModel.from_model(model)
    q, v = np.array([0.2, 0.5, -0.3, 0.4, 0.6, -0.2]), np.zeros(6)

    def rates(t, y):
        at_rest = np.zeros((1, 6))
        there = PinocchioAnswers(pinocchio, model, y[None, :6], y[None, 6:], at_rest, at_rest)
        return np.concatenate([y[6:], there.a[0]])

    theirs = solve_ivp(rates, (0.0, 0.5), np.concatenate([q, v]), method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    ours = simulate(model, q, v, 0.5, rtol=1e-12, atol=1e-12)
    assert np.abs(np.concatenate([ours.q[-1], ours.v[-1]]) - theirs).max() < 1e-10


def test_the_same_steps_as_mujoco():
    """Twenty arms, a hundred steps of RK4; measured 1e-14."""
    mujoco = pytest.importorskip("mujoco")
    model, rng, steps, width = kr500(), np.random.default_rng(0), 100, 1e-3
    q, v = rng.normal(size=(2, 20, 6))
    native = MujocoModel(model)._native
    native.opt.timestep, native.opt.integrator = width, mujoco.mjtIntegrator.mjINT_RK4
    data, theirs = mujoco.MjData(native), []
    for state in zip(q, v, strict=True):
        mujoco.mj_resetData(native, data)
        data.qpos[:], data.qvel[:] = state
        mujoco.mj_step(native, data, steps)
        theirs.append(np.concatenate([data.qpos, data.qvel]))
    ours = rollout(model, q, v, step=width, duration=steps * width, every=steps)
    assert np.abs(np.concatenate([ours.q[:, -1], ours.v[:, -1]], axis=-1) - theirs).max() < 1e-12


@pytest.mark.usefixtures("unexamined")
def test_identified_from_its_own_bag(tmp_path):
    """Every base parameter is found again within three standard deviations, friction among them; measured 2.01."""
    model, rng = mixed_tree(), np.random.default_rng(0)
    laws = [FourierSeries(0.2, rng.normal(size=5) * 0.4, rng.normal(size=5) * 0.4) for _ in range(3)]
    friction = Friction(rng.uniform(0.5, 2, 3), rng.uniform(0.5, 2, 3), rng.uniform(-0.3, 0.3, 3))
    start = [law(np.zeros(1)) for law in laws]
    moved = simulate(
        model,
        [position[0] for position, _, _ in start],
        [velocity[0] for _, velocity, _ in start],
        10.0,
        torque=ComputedTorqueControl(400.0, 40.0, laws),
        friction=friction,
        at=np.arange(5001) * 2e-3,
        method="rk4",
        step=1e-4,
    )
    noise = {"q": 2e-5, "tau": 0.01 * np.sqrt((moved.tau**2).mean(axis=0))}
    path = tmp_path / "run.mcap"
    path.write_bytes(motion_document(moved.recording().noisy(0, absolute=noise), path, {}))
    found = crosscheck.identify(
        model,
        load_recording(path, joints=model.joint_names),
        terms=(RigidBodies(), Viscous(), Coulomb(), Offset()),
        methods=["wls"],
        preparation=Preparation(cutoff=10.0),
        poses=1,
    )
    parameters = [model.inertial_parameters, friction.viscous, friction.coulomb, friction.offset]
    truth = found.problem.base.values(np.concatenate(parameters))
    (result,) = [result for result in found.comparison.results if result.name == "WLS"]
    assert np.all(np.abs(result.base_values - truth) < 3 * result.block_deviations)


def test_loops(program, tmp_path):
    linkage, out, record = existing(DATA / "loops" / "urdfplus" / "six_bar.urdf"), tmp_path / "run.npz", tmp_path / "j"
    settings = ("--duration", 0.05, "--rate", 100, "--velocity", "1,0,0,0,0", "--json", record)
    done = program("simulate", linkage, *settings, "--out", out)
    assert done.code == AGREED, done.err
    assert "joints and loops closed to" in done.out
    told = json.loads(record.read_text(encoding="utf-8"))
    assert told["closure_error"] < 1e-13
    assert told["joints"][0]["largest_velocity"] > 0
    assert told["joints"][0]["largest_force"] is None  # of plane loops: undetermined out of the plane
    assert load_recording(out, joints=urdf.load(linkage).joint_names).q.shape == (6, 5)
    refused = program("simulate", linkage, *settings[:4], "--out", tmp_path / "run.csv")
    assert refused.code == BAD_INPUT
    assert "joint forces that nothing determines have no place in this table" in " ".join(refused.err.split())
