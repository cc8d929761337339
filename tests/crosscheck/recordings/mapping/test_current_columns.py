"""Columns of currents by their names."""

import numpy as np
import pytest

from crosscheck.recordings import AmbiguousColumns, load_recording

JOINTS = ("elbow", "wrist")


def written(path, names):
    """A log of five rows, every column counted up from its number."""
    rows = np.arange(1.0, len(names)) + np.arange(5.0)[:, None] / 10
    table = np.column_stack([np.arange(5.0) / 10, rows])
    np.savetxt(path, table, delimiter=",", header=",".join(names), comments="")
    return path


@pytest.mark.parametrize(
    "names",
    [
        ["current_1", "current_2"],
        ["actual_current_0", "actual_current_1"],
        ["current_wrist [A]", "current_elbow [A]"],
        ["elbow.current", "wrist.current"],
        ["i_1", "i_2"],
    ],
)
def test_as_torques(tmp_path, names):
    path = written(tmp_path / "log.csv", ["t [s]", "q_elbow", "q_wrist", *names])
    found = load_recording(path, joints=JOINTS, currents=True)
    swapped = names[0].startswith("current_wrist")
    assert found.tau[0].tolist() == ([4.0, 3.0] if swapped else [3.0, 4.0])
    (finding,) = (one for one in found.findings if one.code == "currents")
    assert "their gains are found, or given" in finding.text


def test_measured_ones_go_before_targets_and_torques(tmp_path):
    names = ["target_current_1", "target_current_2", "actual_current_1", "actual_current_2", "tau_elbow", "tau_wrist"]
    path = written(tmp_path / "log.csv", ["t [s]", "q_elbow", "q_wrist", *names])
    assert load_recording(path, joints=JOINTS, currents=True).tau[0].tolist() == [5.0, 6.0]
    assert load_recording(path, joints=JOINTS).tau[0].tolist() == [7.0, 8.0]


def test_two_families_are_refused(tmp_path):
    path = written(tmp_path / "log.csv", ["t [s]", "q_elbow", "q_wrist", "i_1", "i_2", "current_1", "current_2"])
    with pytest.raises(AmbiguousColumns, match="2 candidates for currents: i_1, i_2; current_1, current_2; say in a"):
        load_recording(path, joints=JOINTS, currents=True)


def test_one_current_is_none_of_two_joints(tmp_path):
    path = written(tmp_path / "log.csv", ["t [s]", "q_elbow", "q_wrist", "current_1"])
    assert load_recording(path, joints=JOINTS, currents=True).tau is None
