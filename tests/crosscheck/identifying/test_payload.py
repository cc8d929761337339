"""A load and gains from recordings, files of gains, and what is rejected."""

import numpy as np
import pytest
from identified.loaded_arm import WANTED, WEIGHED, LoadedArm, currents, random_gains, recording, robot

from crosscheck.identifying import Preparation, gains_document, identify_gains, identify_payload, load_gains
from graphdyn import InvalidInput
from graphdyn.identification.currents import JointGains, KnownLoad, TrustedGravity

JOINTS = robot().independent_joints


@pytest.fixture(scope="module")
def gains():
    return random_gains(np.random.default_rng(2), 6)


@pytest.fixture(scope="module")
def logs(gains):
    """Recordings without a load, with the weighed one, and with the wanted one."""
    rng = np.random.default_rng(1)
    arm = LoadedArm.of(robot(), rng)
    loads = {"empty.csv": None, "weight.csv": WEIGHED, "load.csv": WANTED}
    return [recording(currents(arm.motion(rng, 20.0, load), gains, rng), JOINTS, name) for name, load in loads.items()]


def test_gains_then_another_load(logs, gains, tmp_path):
    """The first pair gives gains, written and read as a file; with them the second gives its load."""
    empty, weight, load = logs
    first = identify_payload("ur5", empty, weight, known_load=KnownLoad(WEIGHED[0]))
    assert first.mass_given
    assert first.rejection_reasons == ()
    assert (np.abs(np.log(first.gains.values / gains)) < 4 * first.gains.relative_deviations).all()
    path = tmp_path / "gains.toml"
    path.write_bytes(gains_document(first.gains, JOINTS, 'a "load" of 4 kg'))
    read = load_gains(path, JOINTS)
    assert np.array_equal(read.values, first.gains.values)
    assert np.array_equal(read.covariance, first.gains.covariance)
    second = identify_payload("ur5", empty, load, gains=read)
    assert abs(second.load.mass - WANTED[0]) < 3 * second.load.mass_deviation
    assert second.load.mass_deviation < 0.1 * WANTED[0]
    assert second.known.startswith("gains within")
    assert second.relative_residuals.shape == (2, 6)
    assert (second.relative_residuals < 0.1).all()
    assert second.names == ("empty.csv", "load.csv")


def test_a_calibration_in_one_fit(logs):
    empty, weight, load = logs
    found = identify_payload("ur5", empty, load, known_load=KnownLoad(WEIGHED[0]), calibration=weight)
    assert not found.mass_given
    assert abs(found.load.mass - WANTED[0]) < 3 * found.load.mass_deviation
    assert found.known == "a load of 4 kg"


@pytest.mark.long
def test_currents_that_are_taken_for_torques_are_rejected(logs):
    """Their gains are far from one, at the stated 5 %."""
    empty, _, load = logs
    found = identify_payload("ur5", empty, load)
    assert found.known == "torques as recorded, right to 5 %"
    (reason,) = found.rejection_reasons
    assert reason.startswith("the gains found are not those that were stated: shoulder_")
    assert reason.endswith("the columns may be currents, or of other gears: give a load of known mass, or the gains")


def test_a_load_that_is_not_there(logs, gains):
    empty, *_ = logs
    found = identify_payload("ur5", empty, empty, gains=JointGains.stated(gains, 0.03))
    (reason,) = found.rejection_reasons
    assert "kg, is not above three times its deviation" in reason


def test_exchanged_recordings_are_told(logs, gains):
    empty, weight, load = logs
    (reason,) = identify_payload("ur5", load, empty, gains=JointGains.stated(gains, 0.03)).rejection_reasons
    assert reason.startswith("the mass is -2.")
    assert reason.endswith("kg, below zero: the recordings with and without the load may be exchanged")
    (reason,) = identify_payload("ur5", weight, empty, known_load=KnownLoad(WEIGHED[0])).rejection_reasons
    assert reason.startswith("every current runs against its torque: the recordings with and without the load are ")


def test_currents_that_say_nothing_are_told(logs, gains):
    """A reversed one and a dead one; a joint that stands still, and all of them."""
    empty, _, load = logs
    signs = np.where(np.arange(6) == 2, -1.0, 1.0)
    reversed_logs = [one.take(slice(None), tau=signs * one.tau) for one in (empty, load)]
    stated = JointGains.stated(gains, 0.03)
    (reason,) = identify_payload("ur5", *reversed_logs, gains=stated).rejection_reasons
    assert reason == "the current of elbow_joint runs against the torque: reverse its sign in the mapping"

    wrist = np.arange(6) == 3
    still = [np.where(wrist, 0.5, load.q), np.where(wrist, 0.0, load.v), np.where(wrist, 0.0, load.a)]
    dead = np.where(np.arange(6) == 1, 2.0, load.tau)
    odd = load.take(slice(None), q=still[0], v=still[1], a=still[2], tau=dead)
    found = identify_payload("ur5", empty, odd, gains=stated)
    assert found.warnings == (
        "the current of shoulder_lift_joint does not change in load.csv: the joint is left out there",
        "wrist_1_joint does not move in load.csv: what it carries there cannot be told from its friction and offset; "
        "record a motion of all joints",
    )

    at_rest = load.take(slice(None), q=0 * load.q, v=0 * load.v, a=0 * load.a)
    filtered = Preparation(cutoff=8.0)
    (reason,) = identify_payload("ur5", empty, at_rest, gains=stated, preparation=filtered).rejection_reasons
    assert reason == "no joint moves in load.csv: record a motion of all joints"


@pytest.mark.long
def test_columns_that_are_not_those_of_their_joints_are_told(logs, gains):
    """Two that are exchanged, and one that is noise."""
    empty, _, load = logs
    stated = JointGains.stated(gains, 0.03)
    swapped = [one.take(slice(None), tau=one.tau[:, [0, 1, 3, 2, 4, 5]]) for one in (empty, load)]
    first, *_ = identify_payload("ur5", *swapped, gains=stated).rejection_reasons
    assert first.startswith("empty.csv: the torques of elbow_joint and wrist_1_joint are exchanged: undone, the ")

    noise = np.random.default_rng(0).normal(size=len(load.tau))
    unrelated = load.take(slice(None), tau=np.where(np.arange(6) == 0, noise[:, None], load.tau))
    (reason,) = identify_payload("ur5", empty, unrelated, gains=stated).rejection_reasons
    assert reason.startswith("load.csv: the torque of shoulder_pan_joint has nothing to do with the motion")
    reasons = identify_payload("ur5", empty, unrelated, known_load=KnownLoad(WANTED[0])).rejection_reasons
    message = "the motion explains less than 10 % of the current of shoulder_pan_joint in load.csv: check its column"
    assert any(reason.startswith(message) for reason in reasons)


def test_a_known_load_needs_its_recording(logs):
    with pytest.raises(InvalidInput, match="a known load and a recording with it belong together; give both"):
        identify_gains("ur5", logs[:1], known_load=KnownLoad(4.0))


def test_gains_of_trusted_links(logs, gains):
    """Not that of the last joint, on which gravity hardly acts."""
    found = identify_gains("ur5", logs[:1], TrustedGravity(0.05)).gains
    assert found.determined.tolist() == [True] * 5 + [False]
    off = np.abs(np.log(found.values / gains)) / found.relative_deviations
    assert off[found.determined].max() < 4


def test_a_calibration_needs_its_mass(logs):
    with pytest.raises(InvalidInput, match="a recording with a known load is given, but not the mass of this load"):
        identify_payload("ur5", logs[0], logs[2], calibration=logs[1])


def test_other_joints(logs):
    with pytest.raises(InvalidInput, match=r"empty.csv has the joints shoulder_pan_joint.*; load it with joints="):
        identify_payload("kinova", logs[0], logs[2])


GAINS = 'joints = ["elbow_joint"]\ngains = [3.0]\nrelative_deviations = [0.1]\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GAINS.replace("gains =", "gain ="), "gain is unknown; a file of gains has joints, gains"),
        (GAINS.replace('["elbow_joint"]', "[]"), "joints is []; list the joints that have a gain, each once"),
        (GAINS.replace("elbow_joint", "elbow"), "the robot has no joint 'elbow'; it has shoulder_pan_joint"),
        (GAINS.replace("[3.0]", "[1, 2]"), r"gains is [1, 2]; give 1 numbers, as many as joints"),
        (GAINS + "covariance = [[1.0]]\n", "give either relative_deviations or covariance"),
        (GAINS.replace("[3.0]", "[-3.0]"), "give one above zero per joint"),
        ("joints = [", "gains.toml: is no TOML"),
    ],
)
def test_files_of_gains(tmp_path, text, message):
    path = tmp_path / "gains.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidInput) as caught:
        load_gains(path, JOINTS)
    assert message in str(caught.value)


def test_some_joints_have_gains(tmp_path):
    path = tmp_path / "gains.toml"
    path.write_text(GAINS, encoding="utf-8")
    found = load_gains(path, JOINTS)
    assert found.determined.tolist() == [name == "elbow_joint" for name in JOINTS]
    assert found.relative_deviations[2] == pytest.approx(0.1)
