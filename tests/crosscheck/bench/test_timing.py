"""Times of the benchmark: runs that take turns, their quotients, and whether they can be trusted."""

import itertools
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from crosscheck.bench import cold, contender, curves, identification
from crosscheck.bench.benchmark import thread_numbers
from crosscheck.bench.contender import MIN_CORE_SHARE, Contender, MeasuredWork, TimedContender, Work, measure
from crosscheck.bench.curves import Line, long_notes
from crosscheck.bench.machine import clocks, timing
from crosscheck.bench.machine.clocks import Elapsed, clock_of, clock_step, elapsed
from crosscheck.bench.machine.disturbance import Disturbance
from crosscheck.bench.machine.timing import Ratio, TimedRun, Times, fitting_count, in_turns, ratio
from graphdyn.compiler import in_threads
from graphdyn.compiler.running import interpreted


class Machine:
    """Clocks by hand: work moves all on, another program that has the core that of wall time alone.

    elsewhere: processor time of other threads of this program
    """

    def __init__(self, monkeypatch):
        self.processor = self.wall = self.elsewhere = 0.0
        monkeypatch.setattr(time, "thread_time", lambda: self.processor)
        monkeypatch.setattr(time, "process_time", lambda: self.processor + self.elsewhere)
        monkeypatch.setattr(time, "perf_counter", lambda: self.wall)
        monkeypatch.setattr(timing, "clock_step", lambda: 1e-9)
        monkeypatch.setattr(clocks, "clock_step", lambda: 1e-9)

    def works(self, seconds, waits=0.0):
        self.processor += seconds
        self.wall += seconds + waits


@pytest.fixture
def machine(monkeypatch):
    return Machine(monkeypatch)


class TestClocks:
    def test_one_thread_by_processor_time(self):
        assert [clock_of(threads) for threads in (1, 2, 16)] == ["processor", "wall", "wall"]

    def test_both(self, machine):
        """Three calls of 2 s, each of which waits 1 s for a core."""
        taken = elapsed(lambda: machine.works(2.0, waits=1.0), 3)
        assert taken == Elapsed(6.0, 9.0)
        assert (taken.by("processor"), taken.by("wall")) == (6.0, 9.0)

    def test_one_thread_is_the_calling_one(self):
        """So that its processor time is all of it: no form of graphdyn gives its work to another thread."""
        seen = in_threads(lambda first, last: threading.get_ident(), [(0, 1), (1, 2), (2, 3)], threads=1)
        assert seen == [threading.get_ident()] * 3

    def test_threads_that_wait_busily_do_not_count(self, machine):
        """Those of OpenMP go on for some ten milliseconds after their work."""

        def work():
            machine.works(2.0)
            machine.elsewhere += 1.0

        assert elapsed(work) == Elapsed(2.0, 2.0)

    def test_step(self, monkeypatch):
        """Of a clock that ticks all 10 ms, read many times between two ticks."""
        readings = itertools.count()
        monkeypatch.setattr(time, "thread_time", lambda: 0.01 * (next(readings) // 7))
        assert clocks.clock_step.__wrapped__() == pytest.approx(0.01)

    def test_step_of_this_machine(self):
        assert 0 < clock_step() < 1


class TestTimes:
    def test_in_turns(self, machine):
        calls = []

        def run(name, threads):
            return TimedRun(lambda: (calls.append(name), machine.works(1.0)), threads, clock_of(threads))

        rows = in_turns([run("a", 1), run("b", 2), run("c", 1)], repeats=3, shortest=0.0)
        assert [len(row) for row in rows] == [3, 3, 3]
        assert "".join(calls).endswith("abcabcabc")

    def test_seconds_are_those_of_one_call(self, machine):
        """Of a clock that each call moves on by 2 s: four calls in a row last at least 8 s."""
        calls = []

        def run():
            machine.works(2.0)
            calls.append(machine.wall)

        assert in_turns([TimedRun(run, 1, "processor")], repeats=2, shortest=8.0) == [[2.0, 2.0]]
        assert len(calls) == 2 + 2 * 4

    def test_waiting_counts_by_the_clock_on_the_wall_alone(self, machine):
        """Calls of 2 s that wait 6 s for a core, by one clock and the other, the second in three rows of two."""
        runs = [TimedRun(lambda: machine.works(2.0, waits=6.0), 1, clock) for clock in ("processor", "wall")]
        assert in_turns(runs, repeats=2) == [[2.0, 2.0], [8.0, 8.0]]
        assert fitting_count(lambda count: machine.works(2.0 * count, waits=6.0), 1, 50, 8.0, "processor") == 4

    def test_a_clock_of_coarse_steps(self, machine, monkeypatch):
        """Runs last two hundred steps of 10 ms: a thousand calls of 2 ms, in processor time alone."""
        for module in (timing, clocks):
            monkeypatch.setattr(module, "clock_step", lambda: 0.01)
        assert [Elapsed(processor, 3.0).of_one("processor") for processor in (0.0, 1.9, 2.5)] == [3.0, 3.0, 2.5]
        counts = [0, 0]

        def run(k):
            counts[k] += 1
            machine.works(0.002)

        in_turns([TimedRun(lambda: run(0), 1, "processor"), TimedRun(lambda: run(1), 1, "wall")], 1, shortest=0.004)
        assert counts == [2 + 1000, 2 + 2]

    def test_fitting_count(self):
        asked = []
        assert fitting_count(asked.append, 1, 5000, 1e9, "processor") == 5000
        assert asked == sorted(asked)
        assert fitting_count(asked.append, 700, 5000, 0.0, "processor") == 700
        assert fitting_count(asked.append, 1, 5, 1e9, "processor") == 5

    def test_ratio(self):
        found = ratio(Times((1.0, 2.0, 3.0)), Times((10.0, 40.0, 30.0)))
        assert (found.median, found.fastest, found.quartiles) == (10.0, 10.0, (10.0, 15.0))
        # one disturbed repeat of each: the quotient of the medians, 1.5, is outside the quartiles
        found = ratio(Times((2.0, 2.0, 9.0)), Times((4.0, 3.0, 3.0)))
        assert found.quartiles[0] <= found.median == 1.5 <= found.quartiles[1]

    @pytest.mark.parametrize(("spread", "steady"), [((10.0, 14.9), True), ((10.0, 15.1), False)])
    def test_steady(self, spread, steady):
        assert Ratio(12.0, 12.0, spread).steady is steady

    def test_disturbance(self, machine):
        """Cores are those of runs on one thread, of which a third of the time is work; a copy follows every repeat."""
        disturbance = Disturbance()
        assert disturbance.core_share == 1.0
        run = TimedRun(lambda: machine.works(1.0, waits=2.0), 1, "processor")
        in_turns([run, TimedRun(lambda: machine.works(1.0), 2, "wall")], 4, 0.0, disturbance)
        assert disturbance.core_share == pytest.approx(1 / 3)
        assert disturbance.core_share < MIN_CORE_SHARE
        assert disturbance.copies == [0.0] * 4
        assert Disturbance(processor=3.1, wall=3.0).core_share == 1.0  # clocks differ a little

    def test_a_copy_takes_time(self):
        disturbance = Disturbance()
        disturbance.copy()
        assert 0 < disturbance.copies[0] < 1

    @pytest.mark.parametrize(("most", "numbers"), [(1, (1,)), (2, (1, 2)), (6, (1, 2, 4, 6)), (8, (1, 2, 4, 8))])
    def test_thread_numbers(self, most, numbers):
        assert thread_numbers(most) == numbers

    def test_exponent(self):
        x = (1, 2, 4, 8, 16)
        assert Line("", 1, x, tuple(Times((3.0 * k**2,)) for k in x)).exponent == pytest.approx(2.0)
        assert Line("", 1, (1, 2), (Times((1.0,)), Times((2.0,)))).exponent is None

    def test_an_error_that_is_not_a_number_is_not_in_bound(self):
        entry = TimedContender("graphdyn", 1, "processor", True, 1, Times((1.0,)), float("inf"), 1, "")
        assert not MeasuredWork("", "", "", 1.0, (entry,), 1.0, Times((1.0,))).agrees

    def test_memory_that_nobody_tells(self, monkeypatch):
        def absent(*_args, **_options):
            raise FileNotFoundError

        monkeypatch.setattr(Path, "read_text", absent)
        assert cold._memory("VmRSS") is None
        assert identification.free_memory() == 2 * 1024**3


def test_note_on_long_chains():
    """It names the number of bodies whatever lengths are measured; nothing is said where all code is alike."""
    assert long_notes((2, 60)) == ("beyond 16 bodies, code for one body after the other",)
    assert long_notes((2, 16)) == ()
    with interpreted():
        assert long_notes((2, 60)) == ()


def test_the_first_call_is_timed_in_seconds(monkeypatch, machine):
    """Of processor time: it works for 10 ms and waits for 1 s."""
    monkeypatch.setattr(curves.graphdyn, "forward_dynamics", lambda *_args, **_options: machine.works(0.01, waits=1.0))
    assert curves._first_call(2) == pytest.approx(0.01)


def test_sizes_of_a_batch(monkeypatch):
    """Times per sample; a line ends where a call takes more than half of the duration: 2 s of 3, not 1 s."""
    forms = [Contender(name, 1, lambda count, name=name: (name, count), None, "") for name in ("quick", "slow")]
    per_call = {"quick": lambda count: 0.01 * count, "slow": lambda count: 0.2 * count}

    def in_turns(runs, repeats):
        return [[per_call[name](count)] * repeats for name, count in (run.call() for run in runs)]

    monkeypatch.setattr(curves, "_forms", lambda states, work, threads: forms)
    monkeypatch.setattr(curves, "in_turns", in_turns)
    found = curves.batch_sizes(range(500), "forward_dynamics", (1,), 3.0, 2, lambda what: None)
    assert [(line.name, line.x) for line in found.lines] == [("quick", (1, 10, 100)), ("slow", (1, 10))]
    for line in found.lines:
        assert [times.median for times in line.times] == pytest.approx([per_call[line.name](1)] * len(line.x))


def test_times_are_per_sample(monkeypatch):
    """Ten samples, five for one that takes no more; the limit runs second, on one thread; a core half of the time."""
    taken = []

    def in_turns(runs, repeats, shortest, disturbance):
        taken.extend((run.threads, run.clock) for run in runs)
        disturbance.add(Elapsed(processor=1.0, wall=2.0))
        disturbance.copies.extend([3e-4, 4e-4])
        return [[2.0, 4.0], [1.0, 3.0], [6.0, 8.0]]

    monkeypatch.setattr(contender, "fitting_count", lambda run, least, most, duration, clock: most)
    monkeypatch.setattr(contender, "in_turns", in_turns)
    ours = Contender("graphdyn", 1, lambda count: None, None, "", ours=True)
    theirs = Contender("other", 2, lambda count: None, lambda _: np.array([1e-9, np.nan]), "", most=5)
    work = Work("w", "w", "", 1e-9, (ours, theirs))
    found = measure(work, 10, 1.0, 2, limit=lambda count: None)
    assert [entry.times.seconds for entry in found.entries] == [(0.2, 0.4), (1.2, 1.6)]
    assert [(entry.samples, entry.error, entry.judged) for entry in found.entries] == [(10, None, 0), (5, np.inf, 2)]
    assert [entry.clock for entry in found.entries] == ["processor", "wall"]
    assert found.limit.seconds == (0.1, 0.3)
    assert taken == [(1, "processor"), (1, "processor"), (2, "wall")]
    assert (found.core_share, found.copy.seconds) == (0.5, (3e-4, 4e-4))
    assert found.above_limit == ratio(found.limit, found.entries[0].times)
    measure(work, 10, 1.0, 2, limit=lambda count: None, clock=lambda threads: "wall")
    assert taken[3:] == [(1, "wall"), (1, "wall"), (2, "wall")]


class TestIdentification:
    """In a process of its own, which tells both clocks."""

    @pytest.mark.parametrize(("threads", "clock", "seconds"), [(1, "processor", 2e-3), (2, "wall", 5e-3)])
    def test_clock(self, monkeypatch, threads, clock, seconds):
        monkeypatch.setattr(identification, "_prediction_error", lambda parameters, test: 0.0)
        record = {"seconds": {"processor": 2.0, "wall": 5.0}, "extra_bytes": None, "parameters": []}
        found = identification._entry("x", threads, 1000, [record], None)
        assert (found.clock, found.times.seconds) == (clock, (seconds,))

    def test_both_clocks(self, monkeypatch, machine, tmp_path):
        monkeypatch.setattr(cold, "_model", lambda folder: None)
        for name in ("q", "v", "a", "tau"):
            np.save(tmp_path / f"{name}.npy", np.zeros(1))

        def work(model, *arrays):
            machine.works(2.0, waits=3.0)
            return np.zeros(1)

        assert cold._identified(tmp_path, work)["seconds"] == {"processor": 2.0, "wall": 5.0}
        assert cold._seconds(lambda: machine.works(2.0, waits=3.0)) == 2.0
