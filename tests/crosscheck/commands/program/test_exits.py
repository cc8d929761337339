"""Signals end the program with all its processes, and progress is told where nobody watches a bar."""

import logging
import os
import shutil
import signal
import time
from pathlib import Path

import pytest
from long_check import few
from own_processes import HANGS, alive

from crosscheck.commands.program import console
from crosscheck.commands.program import exits as ending_signals

LONG = 10**6
"""States of a sweep that takes minutes."""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="the processes of a program are found in /proc")
@pytest.mark.parametrize("name", few(["SIGINT", "SIGTERM", "SIGHUP", "SIGKILL"], "SIGINT", "SIGKILL"))
def test_a_sweep_ends_with_its_workers(started, tmp_path, small_arm, name):
    """Even if it is killed, and cannot end them."""
    folder, number = tmp_path / "robots", getattr(signal, name)
    folder.mkdir()
    (folder / "0.urdf").write_text("refused at once", encoding="utf-8")
    shutil.copy(small_arm, folder / "1.urdf")
    sweep = started("crosscheck", folder, "--samples", LONG, "--jobs", 1, "--json", tmp_path / "r.json")
    while not (tmp_path / "r.json").exists():  # from then on a worker compares the second robot
        assert sweep.poll() is None
        time.sleep(0.01)
    workers = Path(f"/proc/{sweep.pid}/task/{sweep.pid}/children").read_text().split()
    assert workers
    sweep.send_signal(number)
    _, said = sweep.communicate()
    assert said == ""
    assert sweep.returncode == (-number if name == "SIGKILL" else 128 + number)
    deadline = time.monotonic() + HANGS
    while left := [worker for worker in workers if alive(worker)]:
        assert time.monotonic() < deadline, left
        time.sleep(0.05)
    assert {path.name for path in tmp_path.iterdir()} <= {"robots", "r.json", small_arm.name}  # no part of a file


class TestSignals:
    @pytest.fixture(autouse=True)
    def usual(self):
        """Whatever those who started us ignore."""
        before = {number: signal.signal(number, signal.SIG_DFL) for number in ending_signals.SIGNALS}
        yield
        for number, handler in before.items():
            signal.signal(number, handler)

    def test_handlers_are_put_back(self):
        before = [signal.getsignal(number) for number in ending_signals.SIGNALS]
        with ending_signals.ended_by_signals():
            assert signal.getsignal(signal.SIGTERM) not in before
        assert [signal.getsignal(number) for number in ending_signals.SIGNALS] == before

    def test_one_that_is_ignored_stays_so(self):
        """As with nohup."""
        before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
        try:
            with ending_signals.ended_by_signals():
                assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
        finally:
            signal.signal(signal.SIGTERM, before)

    @pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
    def test_the_first_one_unwinds(self):
        """A second one does not interrupt what the first one has begun."""
        cleaned = []

        @ending_signals.ended_by_signals()
        def ended():
            try:
                signal.raise_signal(signal.SIGTERM)
            finally:
                signal.raise_signal(signal.SIGTERM)
                signal.raise_signal(signal.SIGHUP)
                cleaned.append(True)

        with pytest.raises(SystemExit) as caught:
            ended()
        assert cleaned
        assert caught.value.code == 128 + signal.SIGTERM


class TestProgressInLines:
    @pytest.fixture
    def clock(self, monkeypatch):
        now = [100.0]
        monkeypatch.setattr(console.time, "monotonic", lambda: now[0])
        return now

    def test_at_most_one_in_an_interval(self, clock, capsys):
        with console.progress("crosscheck", 40) as advance:
            for k in range(40):
                clock[0] += 0.3 * console.PROGRESS_INTERVAL
                advance(f"arm_{k}.urdf", 1)
        assert capsys.readouterr().err.splitlines() == [
            f"crosscheck: {k} of 40 after {3 * k} s, arm_{k - 1}.urdf" for k in range(4, 41, 4)
        ]

    def test_nothing_of_what_is_quick(self, clock, capsys):
        with console.progress("crosscheck", 40) as advance:
            for _ in range(40):
                clock[0] += console.PROGRESS_INTERVAL / 50
                advance("x", 1)
        assert capsys.readouterr().err == ""

    def test_what_is_logged_is_what_begins(self, clock, capsys):
        """Only inside, and only what says what begins."""
        logger = logging.getLogger("graphdyn.compiler.running")
        with console.progress("ur5", 40):
            clock[0] += 12
            logger.debug("nothing")
            logger.info("compiling %s", "mass_matrix")
        logger.info("compiling more")
        assert capsys.readouterr().err == "ur5: 0 of 40 after 12 s, compiling mass_matrix\n"
        assert not logger.isEnabledFor(logging.INFO)

    @pytest.mark.parametrize(
        ("name", "value"), [("JPY_PARENT_PID", "7"), ("MPLBACKEND", "module://matplotlib_inline.backend_inline")]
    )
    def test_in_cells_of_notebooks_where_the_cursor_cannot_move(self, clock, capsys, monkeypatch, name, value):
        monkeypatch.setattr(type(console.err), "is_terminal", True)
        monkeypatch.setenv(name, value)
        with console.progress("ur5") as advance:
            clock[0] += 75
            advance("", 3)
        assert capsys.readouterr().err == "ur5: 3 after 75 s\n"

    def test_without_total_or_name(self, clock, capsys):
        with console.progress("ur5") as advance:
            clock[0] += 75
            advance("", 3)
        assert capsys.readouterr().err == "ur5: 3 after 75 s\n"
