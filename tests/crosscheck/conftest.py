"""Fixtures of the cross-check tests."""

import errno
import functools
import importlib
import math
import os
import re
import shutil
import subprocess
import sys
from itertools import islice
from pathlib import Path

import pyarrow
import pytest
import typer
from faults.textbook import TextbookArm
from identified.remembered_quality import remember_quality
from identified.study_tables import study_tables
from planting import PLANTED, Plant, compared, mixed_tree, remember_comparisons, remember_our_answers, with_body
from pyarrow.parquet import write_table
from shown import pages
from urdf_text import joint, link, robot_text

import crosscheck
import urdf
from crosscheck.commands import main
from crosscheck.commands.program import console, own_process
from crosscheck.commands.study.report import study_report
from crosscheck.comparing import compare as comparing
from crosscheck.distributing import LocalProcesses
from crosscheck.paper import errata
from crosscheck.report.html import page
from crosscheck.study.statistics.outcomes import read_outcomes

MY_CODE = """
import graphdyn, urdf

ur5 = urdf.load("ur5")
hanging = ur5.with_gravity(-ur5.gravity)
number = 3

def rnea(q, v, a):
    return graphdyn.inverse_dynamics(ur5, q, v, a).tau

def upside_down(q, v, a):
    return graphdyn.inverse_dynamics(hanging, q, v, a).tau

def loaded(q, v, a, external_wrenches):
    return graphdyn.inverse_dynamics(ur5, q, v, a, external_wrenches).tau

def jacobian(q):
    return graphdyn.frame_jacobian(ur5, q, "wrist_3_link", reference="local")

def picky(q, v, a):
    if q[0] > 2:
        raise ValueError("too far")
    return rnea(q, v, a)

def broken(q, v, a):
    raise RuntimeError("out of ideas")
"""

SMALL_ARM = robot_text(
    "small",
    link("base", None),
    link("upper", 2.5, xyz="0.1 0.2 0.3", tensor="0.11 0.01 0.02 0.13 0.03 0.17"),
    link("fore", 1.5, xyz="0 0.1 0.4", rpy="0.3 -0.2 0.7", tensor="0.05 0 0 0.06 0 0.02"),
    link("slider", 0.7, xyz="-0.1 0 0.05", rpy="0 0.4 0", tensor="0.004 0.001 0 0.006 0 0.005"),
    link("tool", 0.2, xyz="0.02 0.01 0.03", tensor="0.0001 0 0 0.0002 0 0.0002"),
    joint(
        "z_shoulder", "base", "upper", "continuous",
        '<origin xyz="0 0.1 0.5" rpy="0.4 0.3 -1.1"/><axis xyz="0 0.6 0.8"/>',
    ),
    joint(
        "y_elbow", "upper", "fore", "revolute",
        '<origin xyz="0.3 0 0.1" rpy="1.2 0 0.5"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="2" effort="30" velocity="3"/><dynamics damping="0.5" friction="0.25"/>',
    ),
    joint(
        "a_slide", "upper", "slider", "prismatic",
        '<origin xyz="-0.2 0.1 0" rpy="0 0.2 0"/><axis xyz="1 0 0"/>'
        '<limit lower="-0.3" upper="0.4" effort="30" velocity="1"/>',
    ),
    joint("flange", "fore", "tool", "fixed", '<origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/>'),
)  # fmt: skip
"""One joint of each kind, branching; the order of the file is the reverse of the alphabet; a tool with mass."""


PENDULUM = robot_text(
    "pendulum",
    link("base", None),
    link("bob", 1.5, xyz="0.1 0.2 0.3"),
    joint("swing", "base", "bob", "continuous", '<origin xyz="0 0.1 0.5" rpy="0.4 0.3 -1.1"/><axis xyz="0 1 0"/>'),
)


@pytest.fixture(scope="session")
def small_arm_text():
    return SMALL_ARM


@pytest.fixture(scope="session")
def pendulum_text():
    return PENDULUM


@pytest.fixture
def small_arm(tmp_path):
    path = tmp_path / "small.urdf"
    path.write_text(SMALL_ARM, encoding="utf-8")
    return path


@pytest.fixture
def pendulum(tmp_path):
    """Where any robot will do: compared in a quarter of the time."""
    path = tmp_path / "pendulum.urdf"
    path.write_text(PENDULUM, encoding="utf-8")
    return path


@pytest.fixture
def second_pendulum(tmp_path):
    """Another file of the same robot."""
    path = tmp_path / "second.urdf"
    path.write_text(PENDULUM, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def tree():
    """Three bodies, one joint of each kind, branching, mounted anywhere: compared in a fifth of a second."""
    return mixed_tree()


@pytest.fixture(scope="session")
def ur5():
    return urdf.load("ur5")


@pytest.fixture(scope="session")
def textbook(ur5):
    """Right code for the ur5, which shares no line with graphdyn."""
    return TextbookArm.of(ur5)


@pytest.fixture
def undiagnosed(monkeypatch):
    """Judgments without the search for a fault, which takes most of their time."""
    monkeypatch.setattr("crosscheck.judging.judge.diagnoses_of", lambda *_: [])


@pytest.fixture
def unexamined(monkeypatch):
    """Identifications without the search for faults of their recordings, which takes half of their time."""
    for name in ("identify", "long_recordings"):
        module = importlib.import_module(f"crosscheck.identifying.{name}")  # a function has the same name
        monkeypatch.setattr(module, "data_quality", lambda *_: None)


@pytest.fixture
def unpictured(monkeypatch):
    """Pages whose pictures are drawn but not rendered, which takes most of their time."""
    empty = b'<svg xmlns="http://www.w3.org/2000/svg" width="1pt" height="1pt" version="1.1" viewBox="0 0 1 1"/>'
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda _figure, written, **_: written.write(empty))


@pytest.fixture(scope="session")
def wrong_judgment(textbook):
    """Of the ur5 in a code whose ω × q̇ p has the wrong sign."""
    return crosscheck.judge("ur5", inverse_dynamics=textbook.but(cross=-1.0).inverse_dynamics, samples=5)


@pytest.fixture(scope="session")
def small_comparison(tmp_path_factory):
    """Of a file: both routes, a fused tool, a slide."""
    path = tmp_path_factory.mktemp("robots") / "small.urdf"
    path.write_text(SMALL_ARM, encoding="utf-8")
    return compared(path)


@pytest.fixture(scope="session")
def study_folder(tmp_path_factory):
    """Tables of a study of eight runs."""
    folder = tmp_path_factory.mktemp("study")
    for name, rows in zip(("results", "scenarios", "times"), study_tables(8), strict=True):
        write_table(pyarrow.Table.from_pylist(rows), folder / f"{name}.parquet")
    return folder


@pytest.fixture(scope="session")
def studied(study_folder):
    """Its report."""
    return study_report(
        read_outcomes(study_folder),
        [("robot", "ur5: 6 joints")],
        lambda scenario, run: ["graphdyn", "study", "--only", f"{scenario}:{run}"],
    )


@pytest.fixture(scope="session")
def study_page(studied):
    return pages.opened(page(studied, ["graphdyn", "study"], {"graphdyn": "1"}))


@pytest.fixture(scope="session")
def wrong_comparison(tree):
    """Of the random tree, heavier in Pinocchio than here."""
    with pytest.MonkeyPatch.context() as patch:
        mass = tree.bodies[0].mass * (1 + PLANTED)
        Plant(patch).pinocchio_model(lambda model: with_body(model, 1, mass=mass))
        return compared(tree)


OURS_PLANTED = "test_can_fail.py"
"""Errors are planted there on our side too."""

SAYING = ("commands", "report", "viewing")
"""Rooms whose tests are about what is said of a comparison."""

EXAMINING = ("test_causes.py", "test_spoilt_recordings.py")
"""Tests that examine the same recording in two ways."""


@pytest.fixture(autouse=True, scope="module")
def _our_answers_once(request):
    with pytest.MonkeyPatch.context() as patch:
        if request.path.name != OURS_PLANTED:
            remember_our_answers(patch)
        if any(room in request.path.parts for room in SAYING):
            remember_comparisons(patch)
        if request.path.name not in EXAMINING:
            remember_quality(patch)
        yield


@pytest.fixture(autouse=True, scope="session")
def _commands_once():
    """What typer's runner makes of the functions of the program for each call is the same every time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("typer.testing._get_command", functools.cache(typer.main.get_command))
        yield


@pytest.fixture
def plant(monkeypatch):
    return Plant(monkeypatch)


@pytest.fixture
def random_states_alone(monkeypatch):
    """Comparisons without the states that are chosen to be difficult, where any states will do."""
    cases = comparing.cases
    monkeypatch.setattr(comparing, "cases", lambda *arguments: islice(cases(*arguments), 1))


@pytest.fixture
def in_this_process(monkeypatch):
    """What is given to other processes is done here: they take a second to start."""
    monkeypatch.setattr(LocalProcesses, "each", lambda _self, function, items: enumerate(map(function, items)))
    monkeypatch.setattr(own_process, "tell", lambda _: None)


@pytest.fixture
def wrong_torque(plant: Plant):
    plant.pinocchio_value("tau", lambda x: x * (1 + PLANTED))


class Outcome:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err


def _through_main(monkeypatch, capture):
    def run(*arguments):
        monkeypatch.setattr(console, "PROGRESS_INTERVAL", math.inf)  # however slow the machine, no line of progress
        monkeypatch.setattr(sys, "argv", ["graphdyn", *map(str, arguments)])
        monkeypatch.setattr(sys.modules["__main__"], "__package__", None)  # not the one that pytest was started from
        with pytest.raises(SystemExit) as caught:
            main()
        captured = capture.readouterr()
        return Outcome(caught.value.code or 0, captured.out, captured.err)

    return run


@pytest.fixture
def program(monkeypatch, capsys):
    """program("crosscheck", "ur5"): exit code and what was written, through main as the script calls it."""
    return _through_main(monkeypatch, capsys)


@pytest.fixture
def program_with_processes(monkeypatch, capfd):
    """The same with what the processes write that it starts."""
    return _through_main(monkeypatch, capfd)


@pytest.fixture
def words():
    """words(text): a message of the program without the frames of typer and the line breaks."""
    return lambda text: " ".join(re.sub("[│╭╰─╮╯]", " ", text).split())


@pytest.fixture
def script(tmp_path):
    """The installed program, in a folder without sources."""
    path = shutil.which("graphdyn", path=os.path.dirname(sys.executable)) or shutil.which("graphdyn")
    if path is None:
        pytest.skip("the program graphdyn is not installed; pip install -e .")

    def run(*arguments, stdout=subprocess.PIPE, env=None, encoding="utf-8"):
        finished = subprocess.run(
            [path, *map(str, arguments)],
            cwd=tmp_path,
            stdout=stdout,
            stderr=subprocess.PIPE,
            env={**os.environ, **(env or {})},
            check=False,
            encoding=encoding,
        )
        return Outcome(finished.returncode, finished.stdout, finished.stderr)

    return run


@pytest.fixture
def started(tmp_path):
    """started("judge", …): the running program; it listens to signals even where who started us ignores them."""
    code = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "[signal.signal(number, signal.SIG_DFL) for number in (signal.SIGTERM, signal.SIGHUP)]; "
        "from crosscheck.commands import main; main()"
    )
    running = []

    def run(*arguments):
        command = [sys.executable, "-c", code, *map(str, arguments)]
        running.append(
            subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        )
        return running[-1]

    yield run
    for process in running:
        process.kill()
        process.communicate()


@pytest.fixture
def full_disk(monkeypatch):
    """The disk takes one byte of a file and no more."""
    original = Path.write_bytes

    def write_bytes(path, content):
        original(path, content[:1])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    monkeypatch.setattr(Path, "write_bytes", write_bytes)


@pytest.fixture
def no_work(monkeypatch):
    """Comparing anything fails the test."""

    def compare(*_arguments, **_options):
        raise AssertionError("the work began")

    monkeypatch.setattr(comparing, "compare", compare)
    monkeypatch.setattr(errata, "measure", compare)
    monkeypatch.setattr(urdf, "load", compare)


@pytest.fixture
def my_code(tmp_path, monkeypatch):
    """A folder with user code, which is the working folder; it runs in this process."""
    (tmp_path / "my_code.py").write_text(MY_CODE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "my_code", raising=False)
    monkeypatch.setattr(own_process, "tell", lambda _: None)  # this is the process of the command
