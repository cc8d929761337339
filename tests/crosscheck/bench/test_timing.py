"""Times of the benchmark: runs that take turns, their quotients, and whether they can be trusted."""

import time
from pathlib import Path

import numpy as np
import pytest

from crosscheck.bench import cold, contender, curves, identification
from crosscheck.bench.benchmark import thread_numbers
from crosscheck.bench.contender import MIN_CORE_SHARE, Contender, MeasuredWork, TimedContender, Work, measure
from crosscheck.bench.curves import Line, long_notes
from crosscheck.bench.machine.timing import CoreShare, Ratio, Times, fitting_count, in_turns, ratio
from graphdyn.compiler.running import interpreted


class TestTimes:
    def test_in_turns(self):
        calls = []
        runs = [lambda: calls.append("a"), lambda: calls.append("b")]
        rows = in_turns(runs, [1, 1], repeats=3, shortest=0.0)
        assert [len(row) for row in rows] == [3, 3]
        assert "".join(calls).endswith("ababab")

    def test_seconds_are_those_of_one_call(self, monkeypatch):
        """Of a clock that each call moves on by 2 s: four calls in a row last at least 8 s."""
        now, calls = [0.0], []

        def run():
            now[0] += 2.0
            calls.append(now[0])

        monkeypatch.setattr(time, "perf_counter", lambda: now[0])
        assert in_turns([run], [1], repeats=2, shortest=8.0) == [[2.0, 2.0]]
        assert len(calls) == 2 + 2 * 4

    def test_fitting_count(self):
        asked = []
        assert fitting_count(asked.append, 1, 5000, 1e9) == 5000
        assert asked == sorted(asked)
        assert fitting_count(asked.append, 700, 5000, 0.0) == 700
        assert fitting_count(asked.append, 1, 5, 1e9) == 5

    def test_ratio(self):
        found = ratio(Times((1.0, 2.0, 3.0)), Times((10.0, 40.0, 30.0)))
        assert (found.median, found.fastest, found.quartiles) == (10.0, 10.0, (10.0, 15.0))
        # one disturbed repeat of each: the quotient of the medians, 1.5, is outside the quartiles
        found = ratio(Times((2.0, 2.0, 9.0)), Times((4.0, 3.0, 3.0)))
        assert found.quartiles[0] <= found.median == 1.5 <= found.quartiles[1]

    @pytest.mark.parametrize(("spread", "steady"), [((10.0, 14.9), True), ((10.0, 15.1), False)])
    def test_steady(self, spread, steady):
        assert Ratio(12.0, 12.0, spread).steady is steady

    def test_core_share(self):
        """Of runs on one thread only: sleeping is a time without a core."""
        share = CoreShare()
        assert share.share == 1.0
        in_turns([lambda: time.sleep(0.01), lambda: time.sleep(0.01)], [1, 2], 2, 0.0, share)
        assert share.elapsed >= 0.02
        assert share.share < MIN_CORE_SHARE
        share = CoreShare(elapsed=3.0, used=3.1)  # clocks differ a little
        assert share.share == 1.0

    @pytest.mark.parametrize(("most", "numbers"), [(1, (1,)), (2, (1, 2)), (6, (1, 2, 4, 6)), (8, (1, 2, 4, 8))])
    def test_thread_numbers(self, most, numbers):
        assert thread_numbers(most) == numbers

    def test_exponent(self):
        x = (1, 2, 4, 8, 16)
        assert Line("", 1, x, tuple(Times((3.0 * k**2,)) for k in x)).exponent == pytest.approx(2.0)
        assert Line("", 1, (1, 2), (Times((1.0,)), Times((2.0,)))).exponent is None

    def test_an_error_that_is_not_a_number_is_not_in_bound(self):
        entry = TimedContender("graphdyn", 1, True, 1, Times((1.0,)), float("inf"), 1, "")
        assert not MeasuredWork("", "", "", 1.0, (entry,)).agrees

    def test_memory_that_nobody_tells(self, monkeypatch):
        def absent(*_args, **_options):
            raise FileNotFoundError

        monkeypatch.setattr(Path, "read_text", absent)
        assert cold._memory("VmRSS") is None
        assert identification.free_memory() == 2 * 1024**3


def test_note_on_long_chains():
    """It names the number of bodies whatever lengths are measured; nothing is said where all code is alike."""
    assert long_notes((2, 60)) == ("beyond 24 bodies, code for one body after the other",)
    assert long_notes((2, 24)) == ()
    with interpreted():
        assert long_notes((2, 60)) == ()


def test_the_first_call_is_timed_in_seconds(monkeypatch):
    """Of a function that takes 10 ms, no longer than all around it takes."""
    monkeypatch.setattr(curves.graphdyn, "forward_dynamics", lambda *_args, **_options: time.sleep(0.01))
    start = time.perf_counter()
    assert 0.01 <= curves._first_call(2) <= time.perf_counter() - start


def test_sizes_of_a_batch(monkeypatch):
    """Times per sample; a line ends where a call takes more than half of the duration: 2 s of 3, not 1 s."""
    forms = [Contender(name, 1, lambda count, name=name: (name, count), None, "") for name in ("quick", "slow")]
    per_call = {"quick": lambda count: 0.01 * count, "slow": lambda count: 0.2 * count}

    def in_turns(runs, threads, repeats):
        return [[per_call[name](count)] * repeats for name, count in (run() for run in runs)]

    monkeypatch.setattr(curves, "_forms", lambda states, work, threads: forms)
    monkeypatch.setattr(curves, "in_turns", in_turns)
    found = curves.batch_sizes(range(500), "forward_dynamics", (1,), 3.0, 2, lambda what: None)
    assert [(line.name, line.x) for line in found.lines] == [("quick", (1, 10, 100)), ("slow", (1, 10))]
    for line in found.lines:
        assert [times.median for times in line.times] == pytest.approx([per_call[line.name](1)] * len(line.x))


def test_times_are_per_sample(monkeypatch):
    """Ten samples, five for one that takes no more; the limit runs second, on one thread; a core half of the time."""
    taken = []

    def in_turns(runs, threads, repeats, shortest, share):
        taken.extend(threads)
        share.add(2.0, 1.0)
        return [[2.0, 4.0], [1.0, 3.0], [6.0, 8.0]]

    monkeypatch.setattr(contender, "fitting_count", lambda run, least, most, duration: most)
    monkeypatch.setattr(contender, "in_turns", in_turns)
    ours = Contender("graphdyn", 1, lambda count: None, None, "", ours=True)
    theirs = Contender("other", 2, lambda count: None, lambda _: np.array([1e-9, np.nan]), "", most=5)
    found = measure(Work("w", "w", "", 1e-9, (ours, theirs)), 10, 1.0, 2, limit=lambda count: None)
    assert [entry.times.seconds for entry in found.entries] == [(0.2, 0.4), (1.2, 1.6)]
    assert [(entry.samples, entry.error, entry.judged) for entry in found.entries] == [(10, None, 0), (5, np.inf, 2)]
    assert found.limit.seconds == (0.1, 0.3)
    assert (taken, found.core_share) == ([1, 1, 2], 0.5)
    assert found.above_limit == ratio(found.limit, found.entries[0].times)
