"""Logs of a simulated arm in many layouts: what is recognized is what was written, and the mapping reads it back."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.io
from shared_data import DATA, existing

import graphdyn
import urdf
from crosscheck.recordings import BadMapping, BadRecordingFile, Untold, load_recording, mapping_of, recognize
from crosscheck.recordings.formats.bag_files import write_mcap
from graphdyn import InvalidInput
from urdf.document import parsed_toml

RATE = 100.0
GAINS = np.array([12.0, 8.0, 5.0, 3.0, 3.0, 3.0])


@pytest.fixture(scope="module")
def arm():
    return urdf.load("ur5")


@pytest.fixture(scope="module")
def log(arm):
    """Time, positions, velocities and torques with friction and noise, 8 s, by sines."""
    t = np.arange(0, 8, 1 / RATE)
    speed, size = np.array([1.1, 0.9, 1.3, 1.7, 1.9, 2.3]), np.array([1.5, 0.8, 1.0, 1.2, 1.4, 1.6])
    angle = np.outer(t, speed) + np.arange(6)
    q = size * np.sin(angle) + np.array([0, -1.2, 0.5, 0, 0.3, 0])
    v, a = size * speed * np.cos(angle), -size * speed**2 * np.sin(angle)
    tau = graphdyn.inverse_dynamics(arm, q, v, a).tau + 2 * np.tanh(v / 0.05) + v
    return t, q, v, tau + 0.02 * np.random.default_rng(0).normal(size=q.shape)


def csv(path, names, *columns, delimiter=","):
    """A text file, with a header unless names is empty."""
    head = delimiter.join(name for group in names for name in group)
    np.savetxt(path, np.column_stack(columns), header=head, comments="", delimiter=delimiter, fmt="%.9g")
    return path


def numbered(stem, first=1):
    return [f"{stem}{k}" for k in range(first, first + 6)]


def read_back(paths, found, arm):
    mapping = mapping_of(parsed_toml(found.mapping.encode()), "columns.toml")
    return load_recording(paths, mapping, joints=arm.independent_joints)


def assert_is(recording, log):
    t, q, v, tau = log
    np.testing.assert_allclose(recording.t - recording.t[0], t, atol=1e-6)
    np.testing.assert_allclose(recording.q, q, atol=1e-6)
    np.testing.assert_allclose(recording.tau, tau, atol=1e-4)
    if recording.v is not None:
        np.testing.assert_allclose(recording.v, v, atol=1e-6)


def test_without_names(arm, log, tmp_path):
    t, q, v, tau = log
    temperature = 40 + np.sin(0.1 * t)[:, None] + np.arange(6)
    path = csv(tmp_path / "log.csv", [], t, q, v, tau, temperature)
    found = recognize(path, arm)
    assert found.complete
    assert [found.of(quantity).columns[0] for quantity in ("q", "v", "tau")] == [2, 8, 14]
    assert_is(read_back(path, found, arm), log)


def test_degrees_in_an_array(arm, log, tmp_path):
    t, q, _, tau = log
    path = tmp_path / "log.npz"
    np.savez(path, data=np.column_stack([t, np.rad2deg(q), tau]))
    found = recognize(path, arm)
    assert (found.of("q").unit, found.of("tau").unit) == ("deg", "N m")
    assert_is(read_back(path, found, arm), log)


def test_columns_of_joint_after_joint(arm, log, tmp_path):
    _, q, v, tau = log
    path = tmp_path / "log.mat"
    scipy.io.savemat(path, {"X": np.stack([q, v, tau], axis=2).reshape(len(q), -1)})
    untold = recognize(path, arm)
    assert not untold.complete
    assert "--rate HZ" in untold.open[0].options
    found = recognize(path, arm, Untold(rate=RATE))
    assert found.complete
    assert_is(read_back(path, found, arm), log)


class TestUniversalRobots:
    """CSV of the real-time interface: numbers from 0, targets beside what was measured, currents in place of torques"""

    @pytest.fixture
    def path(self, log, tmp_path):
        t, q, v, tau = log
        names = [["timestamp"], numbered("target_q_", 0), numbered("target_moment_", 0), numbered("actual_q_", 0)]
        names += [numbered("actual_qd_", 0), numbered("actual_current_", 0), numbered("actual_TCP_pose_", 0)]
        columns = (t + 1000, q + 1e-3, 1.01 * tau, q, v, tau / GAINS, q)
        return csv(tmp_path / "log.csv", names, *columns, delimiter=" ")

    def test_gains_are_left_to_be_said(self, arm, path):
        found = recognize(path, arm)
        assert [choice.quantity for choice in found.open] == ["tau"]
        by_targets, by_masses, as_they_are = found.open[0].lines
        assert as_they_are.startswith("gain = 1  # keeps the currents")
        assert "by target_moment_*, which is computed" in by_targets
        for line, tolerance in ((by_targets, 0.02), (by_masses, 0.1)):
            gains = [float(x) for x in line.partition("[")[2].partition("]")[0].split(",")]
            np.testing.assert_allclose(gains[:3], GAINS[:3], rtol=tolerance)
        with pytest.raises(BadMapping, match=r"'A' is not a unit of torque; give the gain in N m per A"):
            read_back(path, found, arm)

    def test_with_gains(self, arm, log, path):
        found = recognize(path, arm, Untold(gain=tuple(GAINS)))
        assert found.complete
        assert_is(read_back(path, found, arm), log)
        unused = {block.label: block.why for block in found.blocks if not block.taken}
        assert unused["target_q_*"] == "'target' in its name: computed, not measured"
        assert unused["actual_TCP_pose_*"] == "no quantity by its name"

    def test_torques_of_a_model_are_not_taken_where_nothing_is_measured(self, arm, log, tmp_path):
        t, q, _, tau = log
        names = [["timestamp"], numbered("actual_q_", 0), numbered("target_moment_", 0)]
        found = recognize(csv(tmp_path / "log.csv", names, t, q, tau), arm)
        assert found.of("tau") is None
        (choice,) = found.open
        assert choice.question == "none is measured: target_moment_*, 'target' in its name: computed, not measured"
        assert choice.options == ("--take 'tau=target_moment_*'",)


def test_accelerations_among_columns_without_names(arm, log, tmp_path):
    """Velocities are rates, and have rates."""
    t, q, v, tau = log
    found = recognize(csv(tmp_path / "log.csv", [], t, q, v, np.gradient(v, t, axis=0), tau), arm)
    assert found.complete
    assert [found.of(quantity).columns[0] for quantity in ("q", "v", "tau")] == [2, 8, 20]


class TestCounterOfRows:
    """A column 0, 1, 2, … may be a clock in milliseconds, or number the rows."""

    def test_beside_a_clock(self, arm, log, tmp_path):
        t, q, v, tau = log
        path = csv(tmp_path / "log.csv", [], np.arange(len(t)), np.round(1e3 * t), q, v, tau)
        found = recognize(path, arm)
        assert found.complete
        assert [(clock.columns, clock.taken) for clock in found.clocks] == [((2,), True), ((1,), False)]
        assert_is(read_back(path, found, arm), log)

    def test_alone(self, arm, log, tmp_path):
        t, q, v, tau = log
        path = csv(tmp_path / "log.csv", [], np.arange(len(t)), q, v, tau)
        choice = next(choice for choice in recognize(path, arm).open if choice.quantity == "time")
        assert choice.question == "column 1 counts the rows; it is no clock, or one in ms"
        assert choice.options == ("--rate HZ", "--take time=1")
        assert choice.lines[1].startswith("rate = 100  # if 8 … 13 are the rates of the positions")
        found = recognize(path, arm, Untold(rate=RATE))
        assert found.complete
        assert_is(read_back(path, found, arm), log)


def test_torques_that_are_zero_are_none(arm, log, tmp_path):
    t, q, v, tau = log
    names = [["time_s"], numbered("q_rad_"), numbered("qd_rad_s_"), numbered("effort_Nm_")]
    found = recognize(csv(tmp_path / "log.csv", names, t, q, v, 0 * tau), arm)
    assert found.of("tau") is None
    assert found.open[0].question.startswith("none is measured: effort_Nm_*, zero in all rows: shoulder_pan_joint")


def test_a_bag_with_other_names_of_joints(arm, log, tmp_path):
    """Messages of a left arm, whose joints a driver has sorted by name."""
    pytest.importorskip("rosbags")
    t, q, v, tau = log
    order = np.argsort(arm.independent_joints)
    names = [f"left_{arm.independent_joints[j]}" for j in order]
    motion = SimpleNamespace(joint_names=names, time=t, q=q[:, order], v=v[:, order], tau=tau[:, order])
    path = tmp_path / "log.mcap"
    path.write_bytes(write_mcap(motion, path, {}))
    found = recognize(path, arm)
    assert found.complete
    assert found.of("tau").columns[0] == "effort.left_shoulder_pan_joint"
    assert_is(read_back(path, found, arm), log)


def test_the_topic_that_was_named_is_in_the_mapping(arm, log, tmp_path):
    pytest.importorskip("rosbags")
    t, q, v, tau = log
    path = tmp_path / "log.mcap"
    motion = SimpleNamespace(joint_names=arm.independent_joints, time=t, q=q, v=v, tau=tau)
    path.write_bytes(write_mcap(motion, path, {}))
    found = recognize(path, arm, topic="/joint_states")
    assert 'topic = "/joint_states"' in found.mapping.splitlines()
    assert_is(read_back(path, found, arm), log)


def test_of_several_none_is_taken_unless_it_is_said(arm, log, tmp_path):
    t, q, _, tau = log
    path = csv(tmp_path / "log.csv", [["t_s"], numbered("q_a_rad_"), numbered("q_b_rad_"), numbered("tau_Nm_")],
               t, q, q + 0.1, tau)  # fmt: skip
    found = recognize(path, arm)
    assert found.of("q") is None
    choice = next(choice for choice in found.open if choice.quantity == "q")
    assert choice.options == ("--take 'q=q_a_rad_*'", "--take 'q=q_b_rad_*'")
    assert_is(read_back(path, recognize(path, arm, Untold(take={"q": "q_a_rad_*"})), arm), log)
    with pytest.raises(InvalidInput, match=r"no block 'q_c' of q; there are q_a_rad_\*, q_b_rad_\*"):
        recognize(path, arm, Untold(take={"q": "q_c"}))


def test_clocks_that_differ(arm, log, tmp_path):
    t, q, _, tau = log
    names = [["time_s", "stamp_s"], numbered("q_rad_"), numbered("tau_Nm_")]
    path = csv(tmp_path / "log.csv", names, t, 1.1 * t, q, tau)
    assert recognize(path, arm).open[0].options == ("--take time=time_s", "--take time=stamp_s")
    found = recognize(path, arm, Untold(take={"time": "time_s"}))
    assert found.rate == pytest.approx(RATE)
    assert_is(read_back(path, found, arm), log)


def test_the_velocities_tell_the_rate(arm, log, tmp_path):
    _, q, v, tau = log
    path = csv(tmp_path / "log.csv", [numbered("q_rad_"), numbered("qd_rad_s_"), numbered("tau_Nm_")], q, v, tau)
    found = recognize(path, arm)
    assert found.rate == pytest.approx(RATE, rel=1e-3)
    assert found.assumed == ("the rate of 100 Hz is that of the velocities; no column is a clock",)
    assert_is(read_back(path, found, arm), log)


@pytest.mark.parametrize(
    ("untold", "message"),
    [
        (Untold(ratio=(1.0, 2.0)), "ratio has 2 numbers, the robot 6 joints"),
        (Untold(units={"q": "ell"}), "the unit that is given: 'ell' is not a unit of q"),
    ],
)
def test_answers_that_cannot_be(arm, untold, message, tmp_path):
    with pytest.raises(InvalidInput, match=message):
        recognize(tmp_path / "log.csv", arm, untold)


def test_files_of_several_logs(arm, log, tmp_path):
    t, q, *_ = log
    paths = [csv(tmp_path / f"{rows}.csv", [["t"], numbered("q_")], t[:rows], q[:rows]) for rows in (50, 60)]
    with pytest.raises(BadRecordingFile, match="different numbers of rows"):
        recognize(paths, arm)


def test_ur10():
    path = existing(DATA / "data" / "ur10" / "ur10_free_motion.csv")
    arm = urdf.load("ur10")
    found = recognize(path, arm)
    assert found.complete
    assert [clock.taken for clock in found.clocks] == [True, False]  # they agree
    assert (found.of("q").unit, found.of("v").unit, found.of("tau").unit) == ("rad", "rad/s", "N m")
    assert read_back(path, found, arm).tau.shape == (2408, 6)


def test_tx40():
    """Motor angles in rad, or angles in degrees; currents by the name, torques of the motors in truth; no rate."""
    folder = existing(DATA / "data" / "tx40")
    paths = [folder / "pos_read_data.csv", folder / "curr_data.csv"]
    arm = urdf.load(folder / "tx40.urdf")
    assert {choice.quantity for choice in recognize(paths, arm).open} == {"time", "q", "tau"}
    untold = Untold(rate=5000, ratio=(32, 32, 45, -48, 45, 32), units={"tau": "N m"})
    found = recognize(paths, arm, untold)
    assert found.complete
    assert (found.of("q").side, found.of("tau").side) == ("motor", "motor")
    assert np.abs(read_back(paths, found, arm).q).max() < 2 * np.pi
