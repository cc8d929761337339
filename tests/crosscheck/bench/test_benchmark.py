"""The benchmark: who takes part, and that its numbers fit together. Nothing is said about time."""

from itertools import pairwise

import numpy as np
import pytest
import small_benchmark
from small_benchmark import DERIVED, PEERS, SAMPLES, SMALL, WORKS

from crosscheck.bench import cold, identification
from crosscheck.bench.calls import CALL_WORKS
from crosscheck.bench.forms import peers
from crosscheck.bench.machine.floor import REQUESTS
from crosscheck.commands.bench.record import record as record_of
from crosscheck.report.records.record import plain

ROUNDED = 1e-12
"""Quotients of times that were written to a file and read again."""


@pytest.fixture(scope="module")
def found():
    return small_benchmark.measured()


def by_name(entries):
    return {(entry["name"], entry["threads"]): entry for entry in entries}


class TestNumbers:
    def test_every_work(self, found):
        assert tuple(measured.name for measured in found.works) == WORKS
        assert found.agrees

    def test_who_takes_part(self, found):
        names = {measured.name: {(entry.name, entry.threads) for entry in measured.entries} for measured in found.works}
        for work in ("inverse_dynamics", "forward_dynamics"):
            assert {("graphdyn compiled", 1), ("graphdyn compiled", 2), ("graphdyn NumPy", 1)} <= names[work]
            assert {("pinocchio loop", 1), ("pinocchio InParallel", 1), ("pinocchio InParallel", 2)} <= names[work]
            assert ("graphdyn projected", 1) in names[work]
        assert {("dense NumPy", 1), ("pinocchio loop (aba + rnea)", 1)} <= names["solve_kkt"]
        assert {("graphdyn compiled, streamed", 2), ("pinocchio loop", 1)} <= names["joint_torque_regressor"]
        for work in DERIVED:
            assert names[work] == {
                ("graphdyn compiled", 1), ("graphdyn compiled", 2), ("graphdyn NumPy", 1), ("pinocchio loop", 1)
            }  # fmt: skip
        assert {("graphdyn rollout", 1), ("pinocchio loop", 1)} <= names["simulation"]
        for work in CALL_WORKS:
            assert names[work] == {("graphdyn by default", 1), ("pinocchio InParallel", 1)}
        assert names["single_forward"] == {
            (n, 1) for n in ("graphdyn.compile", "graphdyn.compile, in place", "pin.aba")
        }

    def test_peers_take_part_or_it_is_said_why(self, found):
        names = {entry.name for measured in found.works for entry in measured.entries}
        for library, form in (("mujoco", peers.MUJOCO_ROLLOUT), ("casadi", peers.CASADI_NAME)):
            assert (form in names) == (library in found.peers) == (library not in found.left_out)

    def test_accuracy(self, found):
        for measured in found.works:
            for entry in measured.entries:
                if entry.error is None:
                    assert (measured.name, entry.name) == ("solve_kkt", "pinocchio loop (aba + rnea)")
                else:
                    assert 0 <= entry.error <= (measured.bound if entry.name.startswith("graphdyn") else PEERS)
                    assert entry.judged > 0

    def test_ratios_are_quotients(self, found):
        for work in plain(record_of(found, []))["works"]:
            entries = by_name(work["entries"])
            assert work["ratios"]
            for one in work["ratios"]:
                ours, theirs = entries[one["ours"], one["threads"]], entries[one["theirs"], one["threads"]]
                assert ours["ours"]
                assert not theirs["ours"]
                quotients = [y / x for x, y in zip(ours["seconds"], theirs["seconds"], strict=True)]
                assert one["ratio"] == pytest.approx(np.median(quotients), rel=ROUNDED)
                assert one["quartiles"][0] <= one["ratio"] <= one["quartiles"][1]
                assert one["fastest_ratio"] == pytest.approx(theirs["fastest"] / ours["fastest"], rel=ROUNDED)

    def test_times(self, found):
        def inspect(value):
            if isinstance(value, dict):
                if "seconds" in value and isinstance(value["seconds"], list):
                    low, high = value["quartiles"]
                    assert 0 < value["fastest"] <= low <= value["median"] <= high
                    assert value["fastest"] == min(value["seconds"])
                for inner in value.values():
                    inspect(inner)
            elif isinstance(value, list):
                for inner in value:
                    inspect(inner)

        inspect(plain(record_of(found, [])))

    def test_samples(self, found):
        for measured in found.works:
            for entry in measured.entries:
                assert 1 <= entry.samples <= SAMPLES  # fewer where the machine is slow

    def test_floor(self, found):
        assert set(found.floors) == set(REQUESTS)
        assert found.machine[0].threads == 1
        for measured in found.works:
            assert (measured.limit is None) == (measured.name not in REQUESTS)
            if measured.limit is not None:
                ours = next(entry for entry in measured.entries if entry.ours and entry.threads == 1)
                assert len(measured.limit.seconds) == len(ours.times.seconds)
                assert measured.above_limit.fastest == ours.times.fastest / measured.limit.fastest
                assert found.floors[measured.name].seconds == measured.limit.median

    def test_identification(self, found):
        entries = found.identification.entries
        assert [(entry.name, entry.threads) for entry in entries] == [
            (name, threads)
            for threads in (1, 2)
            for name in (identification.GRAPHDYN_STREAMED, identification.PINOCCHIO_LSTSQ)
        ]
        assert {entry.samples for entry in entries} == {10 * SAMPLES, SMALL.most_loop}
        assert all(entry.error < PEERS for entry in entries)
        assert all(entry.extra_bytes is None or entry.extra_bytes >= 0 for entry in entries)
        for (threads, quotient), ours, theirs in zip(
            found.identification.comparisons, entries[0::2], entries[1::2], strict=True
        ):
            assert threads == ours.threads == theirs.threads
            quotients = np.array(theirs.times.seconds) / ours.times.seconds
            assert quotient.median == pytest.approx(np.median(quotients), rel=ROUNDED)

    def test_once_per_process(self, found):
        assert set(found.imports) == {"numpy", "graphdyn", "pinocchio"}
        assert set(found.first_calls) == set(cold.FIRST_CALLS)

    def test_curves(self, found):
        assert [curve.name for curve in found.curves] == [
            "threads", "batch_inverse_dynamics", "batch_forward_dynamics", "bodies", "first_call",
        ]  # fmt: skip
        for curve in found.curves:
            for line in curve.lines:
                assert len(line.x) == len(line.times) > 0
                assert all(x < y for x, y in pairwise(line.x))
        lines = {line.name: line for line in found.curves[3].lines}
        assert lines["graphdyn compiled"].x == lines["dense NumPy"].x == SMALL.lengths
        for line in (*found.curves[1].lines, *found.curves[2].lines):
            assert line.x == (1, 10, 100)[: len(line.x)]
