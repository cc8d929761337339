"""The three industrial arms, read with the mappings of docs/recordings; skipped where the data are absent."""

import numpy as np
import pytest
from shared_data import DATA, REPOSITORY, existing

from crosscheck.recordings import (
    AmbiguousColumns,
    chosen_cutoff,
    differentiated,
    load_mapping,
    load_recording,
    samples_of,
    sampling_rate,
    split_by_rows,
    split_by_time,
)

MAPPINGS = REPOSITORY / "docs" / "recordings"
FILES = {
    "ur10": ["ur10_free_motion.csv"],
    "tx40": ["pos_read_data.csv", "curr_data.csv"],
    "kr300": ["kr300_A.csv"],
}


def arm(name):
    return load_recording([existing(DATA / "data" / name / file) for file in FILES[name]], MAPPINGS / f"{name}.toml")


def columns(name, file, prefix):
    """Six columns by NumPy: the neutral witness."""
    table = np.genfromtxt(existing(DATA / "data" / name / file), delimiter=",", names=True)
    return np.column_stack([table[column] for column in table.dtype.names if column.startswith(prefix)])


@pytest.mark.parametrize("name", sorted(FILES))
def test_every_published_mapping_can_be_read(name):
    mapping = load_mapping(MAPPINGS / f"{name}.toml")
    assert len(mapping.joints) == 6
    assert {"q", "tau"} <= set(mapping.channels)


@pytest.mark.parametrize(
    ("name", "rows", "rate", "has_v"),
    [("ur10", 2408, 125, True), ("tx40", 45_000, 5000, False), ("kr300", 2501, 250, True)],
)
def test_the_arms_are_read_whole(name, rows, rate, has_v):
    recording = arm(name)
    assert recording.q.shape == recording.tau.shape == (rows, 6)
    assert sampling_rate(recording) == pytest.approx(rate, rel=1e-9)
    assert (recording.v is not None) == has_v
    assert len(recording.block_slices) == 1
    assert recording.findings == ()
    assert recording.provenance.steps == ()
    assert np.abs(recording.q).max() < 2 * np.pi


def test_names_alone_do_not_tell_which_encoder_or_clock():
    with pytest.raises(AmbiguousColumns, match=r"2 candidates for time: bag_t_s; stamp_s"):
        load_recording(existing(DATA / "data" / "ur10" / "ur10_free_motion.csv"))
    with pytest.raises(
        AmbiguousColumns, match=r"for q: q_mot_link_rad_1 … q_mot_link_rad_6; q_secenc_rad_1 … q_secenc_rad"
    ):
        load_recording(existing(DATA / "data" / "kr300" / "kr300_A.csv"))


def test_ur10_is_taken_as_it_is():
    recording = arm("ur10")
    for name, prefix in (("q", "q_"), ("v", "qd_"), ("tau", "effort_")):
        assert np.array_equal(getattr(recording, name), columns("ur10", "ur10_free_motion.csv", prefix))


def test_tx40_behind_its_coupled_transmission():
    recording = arm("tx40")
    motor = columns("tx40", "pos_read_data.csv", "Joint")
    torque = columns("tx40", "curr_data.csv", "Joint")
    ratios = np.array([32, 32, 45, -48, 45, 32])
    q = motor / ratios
    q[:, 5] = (motor[:, 5] - 32 * q[:, 4]) / 32
    q += np.deg2rad([0, -90, 90, 0, 0, 0])
    np.testing.assert_allclose(recording.q, q, rtol=0, atol=1e-13)
    tau = torque * ratios
    tau[:, 4] += 32 * torque[:, 5]
    np.testing.assert_allclose(recording.tau, tau, rtol=0, atol=1e-12)


def test_kr300_torques_behind_the_gears_are_the_published_ones():
    recording = arm("kr300")
    link = columns("kr300", "kr300_A.csv", "tau_link_Nm")
    printed = 1e-8 * np.abs(link).max(axis=0)
    """Nine digits are printed of the motor torques."""
    assert np.all(np.abs(recording.tau - link) <= printed)
    measured = columns("kr300", "kr300_A.csv", "q_mot_link_rad")
    np.testing.assert_allclose(
        recording.q - measured, np.broadcast_to(np.deg2rad([0, -90, 90, 0, 0, 0]), measured.shape)
    )


def test_settings_of_the_literature():
    tx40 = differentiated(arm("tx40"), {"q": 100.0})
    split = split_by_time(tx40, train=(0, 6), test=(6, 9))
    assert len(split.train.t) + len(split.test.t) == len(tx40.t)
    (train,) = samples_of(split.train, (10, 10))
    assert len(train.row_filter(train.q)) == -(-len(split.train.t) // 100)
    ur10 = differentiated(arm("ur10"), 8.0)
    split = split_by_rows(ur10, train=(60, 1700), test=(1750, 2400))
    assert len(split.train.t) == 1640
    assert ur10.rows[0] < 60
    integrated = np.cumsum(ur10.a, axis=0) / sampling_rate(ur10)
    drift = integrated - integrated[0] - (ur10.v - ur10.v[0])
    assert np.abs(drift).max() < 0.02 * np.ptp(ur10.v)  # a sum of steps errs by half a step of a


@pytest.mark.parametrize("name", sorted(FILES))
def test_a_cutoff_is_found_in_each(name):
    recording = arm(name)
    assert 4 < chosen_cutoff(recording) < sampling_rate(recording) / 4
