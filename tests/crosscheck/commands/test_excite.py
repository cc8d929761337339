"""`graphdyn excite`: motions, what they promise, and the files that robots take."""

import json
import re
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from jsonschema import Draft202012Validator
from planting import mixed_tree
from shared_data import REPOSITORY
from shown import pages

import urdf
from crosscheck.commands.excite import command as excite_search
from crosscheck.commands.excite import record as excite_record
from crosscheck.commands.excite.report import random_is_better
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.distributing import LocalProcesses, Lost
from crosscheck.exciting.excited import PlannedMotion, assumed_noise
from crosscheck.exciting.motion_formats.krl import AxisSettings
from crosscheck.exciting.motion_formats.motion_file import WRITTEN_SUFFIXES, document, read_motion, slides
from crosscheck.exciting.motion_formats.timed_motion import TimedMotion
from crosscheck.exciting.self_collision import Hit
from crosscheck.recordings import load_recording
from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import InvalidInput, joint_torques
from graphdyn.excitation import FourierBasis, Trajectory, optimized

ROOT = REPOSITORY

SHORT = ("--duration", 4, "--harmonics", 2, "--seeds", 1, "--random", 3, "--jobs", 1, "--rate", 100)
LIMITS = ("--velocity", 2, "--torque", 200, "--lower", -2, "--upper", 2)

ROUNDED = {".csv": 1e-15, ".yaml": 1e-15, ".yml": 1e-15, ".script": 1e-15, ".src": 1e-8}
"""[rad or m] Degrees and millimeters have six decimals."""

SETTINGS = AxisSettings((1.0, -1.0, 1.0), (0.0, 25.0, -90.0))


def course(model):
    rng = np.random.default_rng(0)
    return Trajectory(FourierBasis(4.0, 3), 0.3 * rng.normal(size=(model.nv, 5)))


def timed(model, rate=50.0):
    return TimedMotion.of(course(model), model.independent_joints, slides(model), rate)


@pytest.mark.parametrize("suffix", WRITTEN_SUFFIXES)
def test_files_are_read_back(suffix, tmp_path):
    model, path = mixed_tree(), tmp_path / f"motion{suffix}"
    path.write_bytes(document(timed(model), path, SETTINGS))
    found = read_motion(path, model, SETTINGS)
    assert found.duration == pytest.approx(4.0, abs=1e-9)
    assert np.abs(found.positions - timed(model).q).max() < ROUNDED[suffix]


def test_rows_at_a_rate():
    """The end is a row even where it is no multiple of the period."""
    motion = timed(mixed_tree(), rate=0.4)
    assert motion.time.tolist() == [0.0, 2.5, 4.0]
    assert np.abs(motion.v[[0, -1]]).max() < 1e-12


def test_message_for_ros(tmp_path):
    model, path = mixed_tree(), tmp_path / "motion.yaml"
    message = yaml.safe_load(document(timed(model), path, SETTINGS))
    assert message["joint_names"] == list(model.joint_names)
    assert set(message) == {"header", "joint_names", "points"}
    assert message["points"][51]["time_from_start"] == {"sec": 1, "nanosec": 20_000_000}
    assert message["points"][51]["velocities"] == timed(model).v[51].tolist()


def test_program_for_kuka(tmp_path):
    """Degrees, the maker's signs and zeros, sliding joints as external axes in millimeters, the time of the block."""
    model = mixed_tree()
    text = document(timed(model), tmp_path / "motion.src", SETTINGS).decode()
    q = timed(model).q[0]
    degrees = np.degrees(q) * [1, 0, 1] + [0, 0, -90]
    expected = f"PTP {{A1 {degrees[0]:.6f},E1 {25 - 1000 * q[1]:.6f},A2 {degrees[2]:.6f}}}"
    assert text.splitlines()[2] == expected
    assert "TIME_BLOCK END = 4.000000" in text
    assert text.count("SPTP {") == 200


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.yaml", "a: [", r"a\.yaml: is no YAML"),
        ("a.yaml", "points: []", r"a\.yaml: has no joint_names and points"),
        ("a.yaml", "{joint_names: [x], points: []}", r"a\.yaml: joint_names lacks joint 'joint1'; it has x"),
        (
            "a.yaml",
            "{joint_names: [joint1, joint2, joint3], points: [{positions: [1]}]}",
            r"a\.yaml: line 1: a point lacks time_from_start",
        ),
        ("a.script", "servoj([1])", r"a\.script: line 1: 'servoj\(\[1\]\)' where 'def NAME\(\):' is needed"),
        ("a.src", "PTP {A1 1}", r"a\.src: line 1: 'PTP \{A1 1\}' where 'DEF NAME\(\)' is needed"),
        ("a.src", "DEF a()", r"a\.src: ends where 'BAS\(#INITMOV,0\)' is needed"),
    ],
)
def test_faulty_files(name, content, message, tmp_path):
    (tmp_path / name).write_text(content, encoding="utf-8")
    with pytest.raises(BadRecordingFile, match=message):
        read_motion(tmp_path / name, mixed_tree(), SETTINGS)


def test_refused_settings(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "yaml", None)
    with pytest.raises(BadRecordingFile, match=r"a\.yaml: to read YAML, install PyYAML"):
        read_motion(tmp_path / "a.yaml", mixed_tree(), SETTINGS)
    for count in (0, 2, 4):
        with pytest.raises(InvalidInput, match=f"{count} axis zeros for 3 joints; give one, or one for each"):
            AxisSettings(zeros=(5.0,) * count).of(3)
    with pytest.raises(InvalidInput, match=r"axis signs are 2; each is 1 or -1"):
        AxisSettings((2.0,))
    with pytest.raises(InvalidInput, match=r"a planned motion is written as .csv, .*, not as '.h5'"):
        document(timed(mixed_tree()), tmp_path / "a.h5", SETTINGS)


def test_assumed_noise(small_arm):
    noise, words = assumed_noise(urdf.load("ur5"))
    assert noise == pytest.approx([1.5, 1.5, 1.5, 0.28, 0.28, 0.28])
    assert "efforts" in words
    noise, words = assumed_noise(mixed_tree())
    assert np.all(noise > 0)
    assert "torque that the bodies" in words
    model = mixed_tree()
    q, v = model.random_state(np.random.default_rng(0), 1000)
    squares = PinocchioModel.from_model(model).rnea(q, v, np.zeros_like(q)) ** 2
    assert noise == pytest.approx(0.01 * np.sqrt(squares.mean(axis=0)))
    first, *others = model.joints
    partly = (replace(first, limits=replace(first.limits, effort=50.0)), *others)
    assert assumed_noise(replace(model, joints=partly))[0] == pytest.approx(noise), "one effort is not enough"
    massless = mixed_tree().with_inertial_parameters(np.zeros(30))
    assert assumed_noise(massless)[0].tolist() == [1, 1, 1]


def test_the_time_of_a_collision():
    """Poses are looked at 1000 times per second: that of number 2345 comes at 2.345 s."""
    model = mixed_tree()
    motion = PlannedMotion(course(model), (), (Hit("a - b", 7, 2345),), 4001)
    (found,) = excite_record._motion(1, motion, model)["collisions"]
    assert found == {"links": "a - b", "poses": 7, "first": 2.345}


@pytest.mark.usefixtures("unpictured")
def test_the_program(program, small_arm, tmp_path):
    """Record, page and file of two motions; the file keeps its promise when it is examined."""
    out, file, page = tmp_path / "m.csv", tmp_path / "r.json", tmp_path / "r.html"
    done = program(
        "excite", "--robot", small_arm, *SHORT, *LIMITS, "--motions", 2, "--out", out, "--json", file, "--html", page
    )
    assert done.code == AGREED, done.err
    assert "keeps all limits" in done.out
    record = json.loads(file.read_text(encoding="utf-8"))
    schema = json.loads((ROOT / "docs" / "schemas" / "excite-1.schema.json").read_text(encoding="utf-8"))
    Draft202012Validator(schema).validate(record)
    assert [motion["number"] for motion in record["motions"]] == [1, 2]
    assert all(limit["used"] <= 1 for motion in record["motions"] for limit in motion["limits"])
    assert record["plan"]["geometric_mean"] < record["median_random"]["geometric_mean"]
    text = page.read_text(encoding="utf-8")
    assert f"Standard deviations of {len(record['parameters'])} base parameters" in text
    assert {*re.findall(r">Motion (\d+)<", text)} == {"1", "2"}

    first = tmp_path / "m-1.csv"
    assert record["out"] == [str(first), str(tmp_path / "m-2.csv")]
    again = tmp_path / "again.json"
    arguments = ("--motion", first, "--against", first, "--cutoff", "none", "--json", again, "--random", 0)
    done = program("excite", "--robot", small_arm, *SHORT[:-6], *LIMITS, "--rate", 100, *arguments)
    assert done.code == AGREED, done.err
    examined = json.loads(again.read_text(encoding="utf-8"))
    assert examined["motions"][0]["seed"] is None
    assert examined["best_random"] is None
    for row, whole in zip(examined["parameters"], record["parameters"], strict=True):
        assert row["recorded"] == pytest.approx(row["sigma"], rel=0.05)  # the rates differ, and the borders
        assert whole["sigma"] < row["sigma"]  # two motions determine more than one


@pytest.mark.parametrize(
    ("best_random", "seed", "better"), [(0.9, 3, True), (1.1, 3, False), (0.9, None, False), (None, 3, False)]
)
def test_a_better_random_motion_is_told(best_random, seed, better):
    found = SimpleNamespace(
        motions=[SimpleNamespace(seed=seed)],
        plan=SimpleNamespace(geometric_mean=1.0),
        best_random=best_random and SimpleNamespace(geometric_mean=best_random),
    )
    assert random_is_better(found) is better


@pytest.mark.usefixtures("unpictured")
def test_motion_beyond_a_limit(program, small_arm, tmp_path):
    model = urdf.load(small_arm)
    path = tmp_path / "fast.csv"
    path.write_bytes(document(timed(model), path, SETTINGS))
    file, fast = tmp_path / "r.json", ("--velocity", 0.01, "--motion", path, "--random", 0)
    page = tmp_path / "page.html"
    done = program("excite", "--robot", small_arm, *LIMITS, *fast, "--json", file, "--html", page)
    assert done.code == DISAGREED
    assert "VIOLATES LIMITS" in done.out
    (table,) = [
        one
        for one in pages.parsed(page.read_text(encoding="utf-8")).iter("table")
        if "largest part of each limit" in "".join(one.xpath("caption//text()"))
    ]
    assert len(table.xpath("tbody/tr[contains(@class, 'disagrees')]")) == 3
    (motion,) = json.loads(file.read_text(encoding="utf-8"))["motions"]
    beyond = [limit for limit in motion["limits"] if limit["used"] > 1]
    assert len(beyond) == 3
    worst = max(beyond, key=lambda limit: limit["used"])
    assert f"velocity of {worst['name']}: {100 * worst['used']:.4g} % of its limit" in done.out
    largest = np.abs(timed(model, 1000.0).v).max(axis=0) / 0.01
    assert [limit["used"] for limit in beyond] == pytest.approx(largest, rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), r"joint '.*' has no limit of velocity; give velocity=, or --velocity"),
        (("--out", "m.h5"), r"--out m.h5: name a file that ends with .csv"),
        (("--plane", "1,2"), r"--plane 1,2: four numbers X,Y,Z,D are needed"),
        (("--criterion", "best"), r"--criterion best: use one of log-det, sigma, condition"),
        (("--velocity-share", "2"), r"--velocity-share 2.0: give a part, above 0 and at most 1"),
        (("--rate", "0"), r"--rate and --out-rate must be above zero"),
        (("--noise", "x"), r"--noise x: give numbers with commas between them"),
        (("--axis-signs", "3"), r"axis signs are 3; each is 1 or -1"),
    ],
)
def test_bad_options(program, small_arm, arguments, message):
    velocity = ("--velocity", 2) if arguments else ()
    done = program("excite", "--robot", small_arm, *velocity, *arguments)
    assert done.code == BAD_INPUT
    assert re.search(message, " ".join(done.err.replace("│", " ").split()))


def motion_of(value, seed):
    return SimpleNamespace(value=value, seed=seed)


def test_the_best_seed_is_kept(monkeypatch, capsys):
    """Also after an interruption, a seed that found nothing, and a process that died."""

    def interrupted(_self, function, tasks):
        yield 1, motion_of(-3.0, 1)
        yield 0, motion_of(-2.0, 0)
        yield 2, "no motion from seed 2"
        yield 3, Lost("it died")
        raise KeyboardInterrupt

    monkeypatch.setattr(LocalProcesses, "each", interrupted)
    found = excite_search.best_of(None, None, range(5), 2, lambda what, steps: None)
    assert (found.best.seed, found.interrupted) == (1, True)
    assert found.failures == ["no motion from seed 2", "the search from seed 3 was lost: it died"]
    assert "interrupted: the best motion so far, of seed 1, is kept" in capsys.readouterr().err


def test_interrupted_too_early(monkeypatch):
    def interrupted(_self, function, tasks):
        raise KeyboardInterrupt
        yield

    monkeypatch.setattr(LocalProcesses, "each", interrupted)
    with pytest.raises(KeyboardInterrupt):
        excite_search.best_of(None, None, range(2), 2, lambda what, steps: None)


def test_table_is_a_recording(tmp_path):
    """Its torques are those of the motion, so that a plan can be compared with what was measured."""
    model, path = mixed_tree(), tmp_path / "motion.csv"
    path.write_bytes(document(timed(model), path, SETTINGS))
    found = load_recording(path, joints=model.joint_names)
    assert found.prismatic == slides(model)
    expected = joint_torques(model, *course(model).motion(found.t)[:3])
    assert np.abs(joint_torques(model, found.q, found.v, found.a) - expected).max() < 1e-9


@pytest.mark.usefixtures("unpictured")
def test_noise_of_positions(program, words, small_arm, tmp_path):
    """Scatter and bias beside σ, in the table and in the record."""
    file, noisy = tmp_path / "r.json", ("--position-noise", 1e-3, "--cutoff", 20, "--no-collisions")
    options = (*SHORT, *LIMITS, *noisy, "--json", file)
    done = program("excite", "--robot", small_arm, *options)
    assert done.code == AGREED, done.err
    assert "encoder 0.001 of positions: standard deviations " in words(done.out)
    rows = json.loads(file.read_text(encoding="utf-8"))["parameters"]
    assert all(row["encoder_sigma"] > 0.5 * row["sigma"] for row in rows)
    assert max(abs(row["bias"]) / row["sigma"] for row in rows) > 1


@pytest.mark.usefixtures("unpictured")
def test_noise_of_positions_of_what_was_recorded(program, small_arm, tmp_path):
    """The deviations with the encoder are those of both recordings together, as σ is: alone they were 1.4 times σ."""
    file, log, noisy = tmp_path / "r.json", tmp_path / "log.csv", ("--position-noise", 1e-7, "--cutoff", 20)
    options = (*SHORT, *LIMITS, "--no-collisions", "--out-rate", 500)
    assert program("excite", "--robot", small_arm, *options, "--out", log).code == AGREED
    done = program("excite", "--robot", small_arm, *options, *noisy, "--next", log, "--json", file)
    assert done.code == AGREED, done.err
    rows = json.loads(file.read_text(encoding="utf-8"))["parameters"]
    assert np.exp(np.mean([np.log(row["encoder_sigma"] / row["sigma"]) for row in rows])) == pytest.approx(1, abs=0.15)


@pytest.mark.usefixtures("unpictured")
def test_harmonics_choose_themselves(program, words, small_arm, monkeypatch):
    """More as long as the error falls by 2 %; as many as are asked for otherwise."""
    tried = []

    def best(problem, *_):
        tried.append(problem.basis.harmonics)
        error = {5: 0.0, 7: -0.1, 9: -0.11}[problem.basis.harmonics]
        return excite_search.SearchSummary(optimized(problem, 0), [], False, error)

    monkeypatch.setattr(excite_search, "best_of", best)
    few = ("--duration", 4, "--rate", 50, "--random", 0, "--seeds", 1, "--jobs", 1, "--no-collisions", *LIMITS)
    for asked, expected, shown in (((), [5, 7, 9], 7), (("--harmonics", 5), [5], 5)):
        tried.clear()
        done = program("excite", "--robot", small_arm, *few, *asked)
        assert (done.code, tried) == (AGREED, expected), done.err
        assert f"Fourier series of {shown} harmonics" in words(done.out)


@pytest.mark.usefixtures("unpictured")
def test_more_harmonics_go_on_from_the_best_motion(program, words, small_arm, monkeypatch):
    """Which is kept where Ctrl-C comes before a better one."""
    starts = []

    def best(problem, _collisions, seeds, _jobs, _advance, _noise, start=None):
        starts.append((problem.basis.harmonics, list(seeds), start))
        if len(starts) == 3:
            raise KeyboardInterrupt
        return excite_search.SearchSummary(optimized(problem, 0, start=start), [], False, -len(starts))

    monkeypatch.setattr(excite_search, "best_of", best)
    few = ("--duration", 4, "--rate", 50, "--random", 0, "--seeds", 2, "--jobs", 1, "--no-collisions", *LIMITS)
    done = program("excite", "--robot", small_arm, *few)
    assert done.code == AGREED, done.err
    assert "Fourier series of 7 harmonics" in words(done.out)
    assert "interrupted: the best motion so far, of seed 0, is kept" in done.err
    assert [(harmonics, seeds) for harmonics, seeds, _ in starts] == [(5, [0, 1]), (7, [0]), (9, [0])]
    assert [start and start.basis.harmonics for *_, start in starts] == [None, 7, 9]


@pytest.mark.usefixtures("unpictured")
def test_a_period_that_no_controller_has_is_told(program, words, small_arm, tmp_path):
    """Rows every 2 ms or a multiple where the duration is one; the program has the name of its file."""
    out = tmp_path / "my-motion.script"
    common = ("--random", 0, "--seeds", 1, "--jobs", 1, "--no-collisions", "--harmonics", 3, *LIMITS, "--rate", 50)
    for duration, period in ((4, "0.008"), (4.1234, None)):
        done = program("excite", "--robot", small_arm, *common, "--duration", duration, "--out", out)
        assert done.code == AGREED, done.err
        head = out.read_text(encoding="utf-8").splitlines()[:2]
        assert head[0] == "def my_motion():"
        told = "controllers take them every 2 ms (e-Series) or 8 ms (CB)" in words(done.err)
        assert told == (period is None)
        assert period is None or head[1].strip() == f"global period = {period}"
