"""User code runs in a process of its own: whatever it does to that process, there is a verdict or an error."""

import errno
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from unittest.mock import Mock

import pytest
from identified.small_study import GRID, ROBOT, SCENARIO, STUDY
from long_check import LONG, few
from own_processes import HANGS, alive

from crosscheck.commands.program import own_process
from crosscheck.commands.program.console import in_words
from crosscheck.commands.program.exits import AGREED, BAD_INPUT

CODE = """
import ctypes, os, signal, subprocess, sys
import graphdyn, urdf

class Own(BaseException):
    pass

def ends(q, v, a):
    os._exit(0)

def exits(q, v, a):
    sys.exit(0)

def is_killed(q, v, a):
    os.kill(os.getpid(), signal.SIGTERM)

def crashes(q, v, a):
    ctypes.string_at(0)

def closes(q, v, a):
    os.closerange(3, 100)
    os._exit(0)

def talks(q, v, a):
    print("printed")
    os.write(1, b"written\\n")
    return graphdyn.joint_torques(urdf.load("pendulum.urdf"), q, v, a)

def deaf():
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)

def waits(q, v, a):
    print(subprocess.Popen(["sleep", "1000"], preexec_fn=deaf).pid, flush=True)
    while True:
        pass

class Method:
    name, reference, assumptions, needs = "own", "none", "none", "nothing"
    def estimate(self, problem):
        raise Own("no base")

class Slow(Method):
    def estimate(self, problem):
        print("estimating", flush=True)
        while True:
            pass

def method_that_divides():
    return 1 / 0
"""

NO_RESULT = "there is no result: a function has to return, or to raise an exception\n"

ENDS = "import os\nos._exit(0)\n"


def judge(name, *options):
    return ("judge", "pendulum.urdf", "--inverse-dynamics", f"own.py:{name}", "--samples", 1, *options)


@pytest.fixture
def folder(tmp_path, monkeypatch, pendulum):
    """The working folder, with CODE in it, and a robot."""
    (tmp_path / "own.py").write_text(CODE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def judged(folder, program_with_processes):
    """judged("ends"): what `graphdyn judge` says of a function of CODE, which runs in another process than this one."""
    return lambda name, *options: program_with_processes(*judge(name, *options))


class TestEnds:
    """Each would be exit code 0, or a disagreement, of a program that runs the code itself."""

    @LONG
    @pytest.mark.parametrize("name", ["ends", "closes"])
    def test_at_once(self, judged, name):
        done = judged(name)
        assert (done.code, done.out) == (BAD_INPUT, "")
        assert done.err == (
            "error: the process ended itself with exit code 0 while it ran "
            f"--inverse-dynamics own.py:{name}; {NO_RESULT}"
        )

    @LONG
    @pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
    def test_by_a_signal(self, judged):
        done = judged("is_killed")
        assert (done.code, done.out) == (BAD_INPUT, "")
        assert f"the process was ended by signal {int(signal.SIGTERM)} (" in done.err
        assert "while it ran --inverse-dynamics own.py:is_killed" in done.err

    @pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
    def test_by_a_fault_of_compiled_code(self, judged):
        """All that ran is named: the last one may not be the culprit."""
        done = judged("crashes", "--mass-matrix", "own.py:exits")
        assert (done.code, done.out) == (BAD_INPUT, "")
        line = CODE.splitlines().index("def crashes(q, v, a):") + 2
        assert f'own.py", line {line} in crashes' in done.err
        last = done.err.splitlines()[-1]
        assert f"error: the process was ended by signal {int(signal.SIGSEGV)} (" in last
        ran = "while it ran --inverse-dynamics own.py:crashes and --mass-matrix own.py:exits"
        assert f"{ran}; {NO_RESULT.rstrip()}" in last

    @pytest.mark.parametrize("option", few(["--term", "--known-torque", "--methods"], "--term"))
    def test_when_imported_for_an_identification(self, folder, program_with_processes, option):
        (folder / "own.py").write_text(ENDS, encoding="utf-8")
        done = program_with_processes("identify", "log.csv", "--robot", "ur5", option, "own.py:f")
        assert (done.code, done.out) == (BAD_INPUT, "")
        assert f"ended itself with exit code 0 while it ran {option} own.py:f" in done.err

    @LONG
    def test_two_at_once(self, judged):
        done = judged("ends", "--mass-matrix", "own.py:exits")
        assert (done.code, done.out) == (BAD_INPUT, "")
        assert done.err == (
            "error: the process ended itself with exit code 0 while it ran --inverse-dynamics own.py:ends and "
            f"--mass-matrix own.py:exits; {NO_RESULT}"
        )


class TestOutput:
    def test_what_the_code_prints_is_no_result(self, judged):
        done = judged("talks", "--json", "-")
        assert done.code == AGREED
        assert json.loads(done.out)["verdict"] == "agrees"
        assert done.err.count("printed\n") == done.err.count("written\n") > 1

    @LONG
    def test_the_report(self, judged):
        done = judged("talks")
        assert done.out.startswith("Your functions on pendulum.urdf: agrees\n")
        assert "printed" not in done.out


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="the processes of a program are found in /proc")
@pytest.mark.parametrize(
    ("name", "code"),
    few([("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129), ("SIGKILL", -9)], ("SIGTERM", 143)),
)
def test_the_program_is_ended(started, folder, name, code):
    """With the process of its command, and with what user code has started there, which hears no signal but one."""
    program = started(*judge("waits"))
    begun = int(program.stderr.readline())
    program.send_signal(getattr(signal, name))
    assert program.wait(HANGS) == code
    deadline = time.monotonic() + HANGS
    while alive(begun):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert program.communicate() == ("", "")


@LONG
@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_a_study_with_own_methods_says_how_to_go_on(started, folder, small_arm, name):
    text = STUDY + ROBOT + SCENARIO + GRID
    text = re.sub(r"methods = .*", "methods = ['own.py:Slow']", text).replace("small.urdf", str(small_arm))
    (folder / "study.toml").write_text(text, encoding="utf-8")
    study = started("study", "--config", "study.toml", "--out", "out", "--allow-code", "--jobs", 1)
    assert "estimating\n" in iter(study.stderr.readline, "")
    study.send_signal(getattr(signal, name))
    assert study.communicate(timeout=HANGS)[1].endswith("runs are kept in out; go on with --resume\n")
    assert study.returncode == 128 + getattr(signal, name)


class TestErrors:
    """In this process."""

    @pytest.fixture
    def own(self, folder, monkeypatch):
        monkeypatch.setattr(sys, "path", [*sys.path])
        monkeypatch.delitem(sys.modules, "own", raising=False)
        monkeypatch.setattr(own_process, "tell", lambda _: None)
        return folder / "own.py"

    @pytest.mark.usefixtures("unexamined")
    @pytest.mark.parametrize(
        ("name", "after", "words"),
        [
            ("method_that_divides", "def method_that_divides():", "in method_that_divides raised ZeroDivisionError"),
            ("Method", "    def estimate(self, problem):", "in estimate raised Own: no base"),
        ],
    )
    def test_they_are_not_errors_of_the_program(self, program, own, small_arm, name, after, words):
        """Nor, as of an exception that nobody catches, a disagreement."""
        options = ("--robot", small_arm, "--cutoff", 10, "--seconds", 10, "--poses", 1)
        done = program("identify", "--methods", f"own.py:{name}", *options)
        assert done.code == BAD_INPUT
        line = CODE.splitlines().index(after) + 2
        assert done.err.startswith(f"error: {own}, line {line}, {words}")

    def test_an_exception_that_means_exit_is_one_of_them(self, program, own):
        done = program(*judge("exits"))
        assert (done.code, done.out) == (BAD_INPUT, "")
        assert done.err.startswith("error: inverse_dynamics raised SystemExit: 0 (")

    def test_of_an_import(self, program, own):
        own.write_text("\n\n1 / 0\n", encoding="utf-8")
        done = program("judge", "ur5", "--mass-matrix", "own.py:M")
        assert done.code == BAD_INPUT
        said = " ".join(done.err.split())
        assert "importing own.py raised ZeroDivisionError: division by zero" in said
        assert f"({own}, line 3, in <module>)" in said


def test_a_process_that_does_not_unwind_is_killed():
    process = Mock(pid=None, exitcode=None)
    own_process._end(process, signal.SIGINT)
    assert [name for name, *_ in process.mock_calls] == ["join", "kill", "join"]
    process = Mock(pid=None, exitcode=130)
    own_process._end(process, signal.SIGINT)
    process.kill.assert_not_called()


def test_a_process_that_nobody_could_watch_is_ended(monkeypatch):
    process = subprocess.Popen(["sleep", "1000"])

    def refused(*_command, **_options):
        raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))

    monkeypatch.setattr(subprocess, "Popen", refused)
    with pytest.raises(BlockingIOError) as error, own_process._group_of(process):
        pass
    assert process.wait(HANGS) == -signal.SIGKILL
    assert in_words(error.value).startswith("no further process can be started; end other programs, or allow more")
