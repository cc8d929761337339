"""Real recordings in a study: what their tables say, and methods compared on rows that they have not seen."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest
from identified import small_study as small
from identified.small_study import ARM, InThisProcess
from long_check import LONG
from shared_data import DATA, REPOSITORY, existing

import graphdyn
import urdf
from crosscheck.commands.program.exits import AGREED, BAD_INPUT
from crosscheck.commands.study.recordings import read_recordings
from crosscheck.distributing import LocalProcesses
from crosscheck.study.settings.configuration import configuration_of, read_configuration
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
    (folder / "springs.py").write_text("from stiffness import a, b\n")
    (folder / "stiffness.py").write_text("a = b = None\n")
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
    """By the kinds of the options; all files that are read are among the files, those of code too."""
    further = "known_bodies = true\nderive_velocity = false\ndecimate = [2, 2]\ngravity = [0, 0, -9.81]\n"
    further += 'known_torque = ["springs.py:a", "springs.py:b"]\n'
    (recording,) = study_of(folder, RECORDING + further, allow_code=True).recordings
    assert recording.label == "log"
    assert " ".join(recording.arguments) == (
        "log.csv --robot small.urdf --cutoff 10 --decimate 2,2 --terms viscous --known-torque springs.py:a "
        "--known-torque springs.py:b --gravity 0 0 -9.81 --split 0:6 6:9 --known-bodies"
    )
    names = ("log.csv", "small.urdf", "springs.py", "stiffness.py")
    assert recording.files == tuple(str((folder / name).resolve()) for name in names)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (RECORDING + RECORDING, r"label in \[recordings 2\] is 'log', as that of another; give a label of its own"),
        (RECORDING.replace("log.csv", "none.csv"), r"files in \[recordings\] has none.csv, which is no file in "),
        (RECORDING.replace('["log.csv"]', "[]"), r"files in \[recordings\] is \[\]; give a list of files"),
        (RECORDING.replace('["log.csv"]', '"log.csv"'), r"files in \[recordings\] is 'log.csv'; give a list of files"),
        (RECORDING.replace("files", "file"), r"files in \[recordings\] is missing; give a list of files"),
        (RECORDING.replace('split = ["0:6", "6:9"]\n', ""), r"split in \[recordings\] is missing; say what is fitted"),
        (
            RECORDING.replace('["0:6", "6:9"]', '"0:6"'),
            r"split in \[recordings\] is '0:6'; say what is fitted and what",
        ),
        (RECORDING + 'split_rows = ["0:6", "6:"]\n', r"split in \[recordings\] stands beside split_rows; give one"),
        (RECORDING.replace('robot = "small.urdf"\n', ""), r"robot in \[recordings\] is missing; give a name or a file"),
        (RECORDING + 'label = "a/b"\n', r"label in \[recordings\] is 'a/b', which is a path; give a name"),
        (RECORDING + "label = 3\n", r"label in \[recordings\] is 3; give a text"),
        (RECORDING + "folds = 3\n", r"folds in \[recordings\] is no setting of this table"),
        (
            RECORDING + "width = [true]\n",
            r"width in \[recordings\] is \[True\]; give a text, a number, or a list of them",
        ),
        (RECORDING + "known_bodies = 1\n", r"known_bodies in \[recordings\] is 1; give true or false"),
        (RECORDING + "gravity = [0, 9.81]\n", r"gravity in \[recordings\] is \[0, 9.81\]; give a list of 3"),
        (RECORDING + 'mapping = "no.toml"\n', r"mapping in \[recordings\] has no.toml, which is no file in "),
        (RECORDING + 'term = "no.py:f"\n', r"term in \[recordings\] has no.py, which is no file in "),
        (
            RECORDING + 'known_torque = "springs.py:a"\n',
            r"recordings: names Python code, springs.py:a, .* --allow-code",
        ),
        (RECORDING + 'models = "bad.toml"\n', r"models in \[recordings\] has bad.toml, which cannot be read: "),
        (
            RECORDING + 'models = "two.toml"\n',
            r"models in \[recordings\] has two.toml with 2 torque models; give a file w",
        ),
        (
            RECORDING + 'models = "own.toml"\n',
            r"models in \[recordings\] has own.toml with methods of its own; name the",
        ),
        ("[recordings]\n", r"\[recordings\] must be \[\[recordings\]\], which can be given several times"),
    ],
)
def test_bad_tables(text, said, folder):
    (folder / "bad.toml").write_text("[a")
    (folder / "two.toml").write_text("[a]\n[b]\n")
    (folder / "own.toml").write_text('[a]\nmethods = ["wls"]\n')
    with pytest.raises(BadConfiguration, match=said):
        study_of(folder, text)


def test_methods_are_compared_on_them(program, words, folder, tmp_path, monkeypatch):
    """Before anything is simulated; a second call does nothing again."""
    monkeypatch.setattr(LocalProcesses, "each", lambda _self, *given: InThisProcess().each(*given))
    config, out = folder / "study.toml", tmp_path / "out"
    config.write_text('[study]\nruns = 1\nmethods = ["wls", "iv"]\n' + small.ROBOT + small.SCENARIO + RECORDING)
    done = program("study", "--config", config, "--out", out)
    assert done.code == AGREED
    found = read_recordings(out, ["log"])["log"]
    assert [one.method for one in found] == ["wls", "iv", "CAD links: WLS"], "as in the other tables"
    assert found[0].torque_error < 0.05
    assert (found[1].torque_error, found[1].failure[:36]) == (None, "needs the controller of the loop in ")
    written = json.loads((out / "study.json").read_text())
    assert [one["method"] for one in written["recordings"]["log"]] == ["wls", "iv", "CAD links: WLS"]
    assert written["recordings"]["log"][0]["torque_error"] == pytest.approx(found[0].torque_error)
    assert str(folder / "log.csv") in written["files"]
    shown = words(done.out)
    assert "One split of one recording does not rank methods" in shown
    assert "iv: needs the controller of the loop" in shown
    file = out / "recordings" / "log.json"
    before = file.stat().st_mtime_ns
    assert program("study", "--config", config, "--out", out, "--resume").code == AGREED
    assert file.stat().st_mtime_ns == before
    file.write_text("{")
    assert read_recordings(out, ["log"]) == {}, "damaged, so that it is made again"


def test_recordings_alone(program, words, folder, tmp_path):
    """Without a robot nothing is simulated; warnings are told, what fails is named before, and a study can lose a
    recording again."""
    config, out = folder / "alone.toml", tmp_path / "out"
    one = '[study]\nmethods = ["wls"]\n' + RECORDING.replace("small.urdf", "long_axis.urdf")
    (folder / "long_axis.urdf").write_text(ARM.replace('"0 1 0"', '"0 2 0"'), encoding="utf-8")
    config.write_text(one)
    done = program("study", "--config", config, "--out", out)
    assert "recording 'log': warning: long_axis.urdf: axis not of unit length, normalized" in words(done.err)
    assert (done.code, "compared: 1 real recording" in words(done.out)) == (AGREED, True)
    only = program("study", "--config", config, "--only", "a:0")
    assert (only.code, "alone.toml has no such run; it simulates nothing" in words(only.err)) == (BAD_INPUT, True)
    again = program("study", "--report", out, "--tables", tmp_path / "paper")
    assert again.code == AGREED
    lines = (tmp_path / "paper" / "recordings.csv").read_text().splitlines()
    assert lines[0] == "recording,method,torque_error,real,failure"
    assert [line.split(",")[:2] for line in lines[1:]] == [["log", "wls"], ["log", "CAD links: WLS"]]
    config.write_text(one + RECORDING.replace("small.urdf", "nothing.urdf") + 'label = "other"\n')
    failed = program("study", "--config", config, "--out", out, "--extend")
    assert failed.code == BAD_INPUT
    assert re.search(r"alone.toml: recording 'other': .*nothing.urdf", words(failed.err))
    config.write_text(one)
    assert program("study", "--config", config, "--out", out, "--extend").code == AGREED
    assert json.loads((out / "study.json").read_text())["recordings"].keys() == {"log"}


@pytest.fixture(scope="module")
def industrial(tmp_path_factory):
    """docs/studies and docs/recordings, with the public files beside the configuration; skipped without them."""
    folder = tmp_path_factory.mktemp("industrial")
    for name in ("studies", "recordings"):
        (folder / name).mkdir()
        for file in (REPOSITORY / "docs" / name).iterdir():
            if file.is_file():
                (folder / name / file.name).write_bytes(file.read_bytes())
    for arm in ("ur10", "tx40", "kr300"):
        for file in existing(DATA / "data" / arm).iterdir():
            (folder / "studies" / file.name).symlink_to(file)
    made = [sys.executable, "../recordings/kr300.py", "kr300.json", "kr300_150.urdf", "150"]
    subprocess.run(made, cwd=folder / "studies", check=True)
    return folder / "studies"


def test_the_shipped_configuration(industrial):
    """All methods that need no wrenches, on three recordings whose files are there."""
    study = read_configuration(str(industrial / "recordings.toml"), allow_code=True)
    assert [recording.label for recording in study.recordings] == ["UR10", "TX40", "KR300"]
    assert [len(recording.files) for recording in study.recordings] == [2, 4, 4]
    assert (study.robots, study.scenarios, "graph" in study.methods) == ((), (), False)


@LONG
@pytest.mark.usefixtures("unpictured")
def test_the_table_of_the_document(program, industrial, tmp_path):
    """Its rows of two methods and of the links of CAD, as printed."""
    text = (industrial / "recordings.toml").read_text()
    (industrial / "two.toml").write_text('[study]\nmethods = ["wls", "consistent"]\n' + text)
    done = program("study", "--config", industrial / "two.toml", "--allow-code", "--out", tmp_path / "out")
    assert done.code == AGREED
    found = read_recordings(tmp_path / "out", ["UR10", "TX40", "KR300"])
    lines = (REPOSITORY / "docs" / "benchmark.md").read_text(encoding="utf-8").partition("| UR10 |")[2].splitlines()
    printed = {
        cells[0]: cells[1:] for cells in ([part.strip() for part in line.split("|")[1:-1]] for line in lines) if cells
    }
    for k, name in enumerate(("wls, wls-pinocchio", "consistent", "CAD links: WLS")):
        errors = [of[k] for of in found.values()]
        assert [f"{100 * one.torque_error:.1f}" for one in errors] == [cell.strip("()") for cell in printed[name]]
        assert [one.real for one in errors] == [not cell.startswith("(") for cell in printed[name]]
