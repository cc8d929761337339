"""Real recordings in a study: what their tables say, and methods compared on rows that they have not seen."""

import json

import numpy as np
import pytest
from identified import small_study as small
from identified.small_study import ARM, InThisProcess

import graphdyn
import urdf
from crosscheck.commands.program.exits import AGREED, BAD_INPUT
from crosscheck.commands.study.recordings import read_recordings
from crosscheck.distributing import LocalProcesses
from crosscheck.study.settings.configuration import configuration_of
from crosscheck.study.settings.settings import BadConfiguration
from graphdyn.motion_laws import FourierSeries

RECORDING = """
[[recordings]]
files = ["log.csv"]
robot = "small.urdf"
cutoff = 10
terms = "viscous"
split = ["0:6", "6:9"]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A robot, and a recording of it with noise and viscous friction."""
    folder = tmp_path_factory.mktemp("recorded")
    (folder / "small.urdf").write_text(ARM, encoding="utf-8")
    model, t = urdf.load(folder / "small.urdf"), np.arange(0, 9, 0.01)
    rng = np.random.default_rng(0)
    laws = [FourierSeries(0.5, *rng.normal(size=(2, 4))) for _ in range(2)]
    q, v, a = np.moveaxis(np.array([law(t) for law in laws]), 0, -1)
    tau = graphdyn.joint_torques(model, q, v, a) + 0.5 * v + 0.01 * rng.normal(size=q.shape)
    header = ",".join(["t", *(f"{name}_{joint}" for name in ("q", "tau") for joint in model.joint_names)])
    np.savetxt(folder / "log.csv", np.column_stack([t, q, tau]), delimiter=",", header=header, comments="")
    return folder


def study_of(folder, further, allow_code=False):
    text = small.STUDY + small.ROBOT + small.SCENARIO + further
    return configuration_of(text.encode(), "study.toml", folder, allow_code=allow_code)


def test_arguments(folder):
    (recording,) = study_of(folder, RECORDING + "known_bodies = true\nderive_velocity = false\n").recordings
    assert recording.label == "log"
    assert " ".join(recording.arguments) == (
        "log.csv --robot small.urdf --cutoff 10 --terms viscous --known-bodies --split 0:6 6:9"
    )
    assert recording.files == tuple(str((folder / name).resolve()) for name in ("log.csv", "small.urdf"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (RECORDING + RECORDING, r"label in \[recordings 2\] is 'log', as that of another; give a label of its own"),
        (RECORDING.replace("log.csv", "none.csv"), r"files in \[recordings\] has none.csv, which is no file in "),
        (RECORDING.replace('split = ["0:6", "6:9"]\n', ""), r"split in \[recordings\] is missing; say what is fitted"),
        (RECORDING.replace('robot = "small.urdf"\n', ""), r"robot in \[recordings\] is missing; give a name or a file"),
        (RECORDING + 'label = "a/b"\n', r"label in \[recordings\] is 'a/b', which is a path; give a name"),
        (RECORDING + "folds = 3\n", r"folds in \[recordings\] is no setting of this table"),
        (RECORDING + "width = [true]\n", r"width in \[recordings\] is \[True\]; give a text, a number, true, or"),
        (RECORDING + 'known_torque = "a.py:f"\n', r"recordings: names Python code, a.py:f, .* add --allow-code"),
        ("[recordings]\n", r"\[recordings\] must be \[\[recordings\]\], which can be given several times"),
    ],
)
def test_bad_tables(text, said, folder):
    with pytest.raises(BadConfiguration, match=said):
        study_of(folder, text)


def test_methods_are_compared_on_them(program, words, folder, tmp_path, monkeypatch):
    """Both recordings by the command; a second call does nothing again; what fails is named."""
    monkeypatch.setattr(LocalProcesses, "each", lambda _self, *given: InThisProcess().each(*given))
    config, out = folder / "study.toml", tmp_path / "out"
    config.write_text('[study]\nruns = 1\nmethods = ["wls", "iv"]\n' + small.ROBOT + small.SCENARIO + RECORDING)
    done = program("study", "--config", config, "--out", out)
    assert done.code == AGREED
    found = read_recordings(out)["log"]
    assert found["WLS"][0] < 0.05
    assert found["IDIM-IV"] is None, "no controller is known"
    written = json.loads((out / "study.json").read_text())
    assert written["recordings"]["log"] == {"WLS": pytest.approx(found["WLS"][0]), "IDIM-IV": None}
    assert str(folder / "log.csv") in written["files"]
    assert "One split of one recording does not rank methods" in words(done.out)
    before = (out / "recordings" / "log.json").stat().st_mtime_ns
    assert program("study", "--config", config, "--out", out, "--resume").code == AGREED
    assert (out / "recordings" / "log.json").stat().st_mtime_ns == before
    config.write_text(config.read_text() + RECORDING.replace("small.urdf", "nothing.urdf") + 'label = "other"\n')
    failed = program("study", "--config", config, "--out", out, "--extend")
    assert (failed.code, "recording 'other': " in words(failed.err)) == (BAD_INPUT, True)
