"""The benchmark: who takes part, that its numbers fit together, and what it says. Nothing is said about time."""

import json
import math
import os
import re
import shutil
import sys
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from lxml import etree
from planted_records import planted
from rich.cells import cell_len
from typer.testing import CliRunner

import graphdyn
from crosscheck.cli import app
from crosscheck.referee.mujoco_model import MujocoModel, MujocoRefuses
from crosscheck.referee.pinocchio_model import PinocchioModel, PinocchioRefuses
from crosscheck.report.commands.bench import bench_report, facts
from crosscheck.report.durations import ratio_span_text, ratio_text, span_text, time_text
from crosscheck.report.html import page
from crosscheck.report.json import plain
from crosscheck.report.records.bench import record as record_of
from crosscheck.report.report import Plot
from crosscheck.report.text import as_text
from crosscheck.report.versions import versions
from crosscheck.studies.bench import benchmark, casadi_forms, cold, graphdyn_forms, identification, mujoco_forms
from crosscheck.studies.bench.benchmark import PARTS, Effort, thread_numbers
from crosscheck.studies.bench.calls import CALLS, CallWork, contenders
from crosscheck.studies.bench.casadi_forms import CasadiRefuses
from crosscheck.studies.bench.chains import chain
from crosscheck.studies.bench.cold import in_fresh_process
from crosscheck.studies.bench.contender import LEAST_SHARE, Entry, Measured
from crosscheck.studies.bench.curves import Line, long_notes
from crosscheck.studies.bench.floor import REQUESTS, Floor, Loops, Machine, floor, limit, machine
from crosscheck.studies.bench.instructions import floating_point_operations, fused_instructions
from crosscheck.studies.bench.load import Load, load
from crosscheck.studies.bench.pinocchio_forms import instruction_set
from crosscheck.studies.bench.states import FEW, random_states
from crosscheck.studies.bench.timing import CoreShare, Ratio, Times, fitting_count, in_turns, ratio
from crosscheck.studies.bench.works import DESCRIPTIONS, OURS
from graphdyn import Body, InvalidInput, Joint, Placement, RobotModel, kr500
from graphdyn.kernels.expressions import Recorder
from graphdyn.kernels.programs import record
from graphdyn.kernels.running import interpreted

ROOT = Path(__file__).parents[2]
SCHEMA = Draft202012Validator(json.loads((ROOT / "docs/schemas/bench-2.schema.json").read_text(encoding="utf-8")))
SMALL = Effort(duration=1e-3, repeats=3, processes=1, most_loop=300, lengths=(2, 3, 4))
SAMPLES = 60

ROUNDED = 1e-12
"""Quotients of times that were written to a file and read again."""

PEERS = 1e-10
"""Other libraries against Pinocchio on the scales of the works: principal axes and other recursions round more."""

DERIVED = {
    "inverse_dynamics_derivatives": ("dtau_dq", "dtau_dv", "dtau_da"),
    "forward_dynamics_derivatives": ("da_dq", "da_dv", "da_dtau"),
    "mass_matrix_inverse": ("mass_matrix_inverse",),
    "coriolis_matrix": ("coriolis_matrix",),
    "kinetic_energy": ("kinetic_energy",),
    "frame_jacobian": ("frame_jacobian",),
}
WORKS = (
    "inverse_dynamics",
    "forward_dynamics",
    "everything",
    "regressor",
    *DERIVED,
    "simulation",
    *CALLS,
    "single_inverse",
    "single_forward",
)

needs_a_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler (cc)")


@pytest.fixture(scope="module")
def found():
    """A benchmark of one arm, and the steps of its progress."""
    steps = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(benchmark, "QUICK", SMALL)
        patch.setattr("crosscheck.studies.bench.contender.STEADY", SMALL.duration)
        result = benchmark.benchmark("kr500", kr500(), SAMPLES, 0, 2, True, lambda _, count: steps.append(count))
    assert sum(steps) == PARTS
    return result


def quiet(found):
    """The same, as if nothing had disturbed it: all repeats alike."""

    def calm(entry):
        return replace(entry, times=Times((entry.times.median,) * len(entry.times.seconds)))

    works = tuple(replace(x, core_share=1.0, entries=tuple(map(calm, x.entries))) for x in found.works)
    once = replace(found.identification, entries=tuple(map(calm, found.identification.entries)))
    return replace(found, works=works, identification=once, load=(Load(0.1, 2), Load(1.0, 2)))


@pytest.fixture
def program(found, monkeypatch):
    """The command, which gives what was found without measuring again."""

    def run(*arguments, result=found):
        monkeypatch.setattr(benchmark, "benchmark", lambda *_: result)
        return CliRunner().invoke(app, ["bench", *map(str, arguments)])

    return run


@pytest.fixture(scope="module")
def states():
    return random_states(kr500(), SAMPLES, 1)


def said(found):
    """What a terminal of 200 characters shows, spaces and frames aside."""
    return " ".join(re.sub("[│┃]", " ", as_text(bench_report(found), 200)).split())


class TestShown:
    """Beside numbers that are written here: units and factors."""

    def test_spans(self):
        assert span_text((2e-6, 1.5e-3)) == "0.002 … 1.5 ms"
        assert ratio_span_text((2.5, 40.0)) == "2.5 … 40×"

    def test_machine(self, found):
        text = said(replace(found, machine=(Machine(4, 1, operations=4e10, instructions=3e10, bandwidth=1.2e10),)))
        assert "machine, 1 thread 40 GFlop/s and 30 G instructions/s in vectors of 4, 12 GB/s at best" in text

    def test_identification(self, found):
        """Two microseconds per sample, of a million samples."""
        (first, *others) = found.identification.entries
        first = replace(
            first, samples=10**6, times=Times((2e-6,) * len(first.times.seconds)), extra_bytes=250_000_000, error=3e-9
        )
        text = said(
            replace(found, identification=replace(found.identification, samples=10**6, entries=(first, *others)))
        )
        assert f"{first.name} {first.threads} 2 s 250 MB 3.0e-09" in text

    def test_at_best(self, found):
        """Three times as long as the machine needs at least."""
        (work, *others) = found.works
        entries = tuple(replace(entry, times=Times((2e-7, 3e-7, 4e-7))) for entry in work.entries)
        floor = Floor(operations=1000, instructions=700, products=600, bytes=200, seconds=1e-7)
        works = (replace(work, entries=entries, limit=Times((1e-7, 1e-7, 1e-7))), *others)
        html = page(bench_report(replace(found, works=works, floors={**found.floors, work.name: floor})), [], {})
        assert "take at least 100 ns; measured 3× as much (quartiles 2.5 … 3.5×), at best 2×" in html


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
        assert {("dense NumPy", 1), ("pinocchio loop (aba + rnea)", 1)} <= names["everything"]
        assert {("graphdyn compiled, streamed", 2), ("pinocchio loop", 1)} <= names["regressor"]
        for work in DERIVED:
            assert names[work] == {
                ("graphdyn compiled", 1), ("graphdyn compiled", 2), ("graphdyn NumPy", 1), ("pinocchio loop", 1)
            }  # fmt: skip
        assert {("graphdyn rollout", 1), ("pinocchio loop", 1)} <= names["simulation"]
        for work in CALLS:
            assert names[work] == {("graphdyn compiled", 1), ("pinocchio InParallel", 1)}
        assert names["single_forward"] == {
            (n, 1) for n in ("graphdyn.compile", "graphdyn.compile, in place", "pin.aba")
        }

    def test_peers_take_part_or_it_is_said_why(self, found):
        names = {entry.name for measured in found.works for entry in measured.entries}
        for library, form in (("mujoco", mujoco_forms.ROLLOUT), ("casadi", casadi_forms.NAME)):
            assert (form in names) == (library in found.peers) == (library not in found.left_out)

    def test_accuracy(self, found):
        for measured in found.works:
            for entry in measured.entries:
                if entry.error is None:
                    assert (measured.name, entry.name) == ("everything", "pinocchio loop (aba + rnea)")
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
                assert 1 <= entry.samples <= SAMPLES
                assert entry.samples == SAMPLES or not entry.name.startswith(
                    ("graphdyn compiled", "pinocchio InParallel")
                )

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

    @pytest.mark.parametrize(
        ("operations", "instructions", "bandwidth", "loop"),
        [
            (1e10, 5.2e9, 1e12, ("mix", 24)),
            (1e10, 5e9, 1e12, ("multiply", 12)),
            (1e9, 8e9, 1e12, ("multiply", 12)),
            (1e10, 6e9, 1e9, ("copy", 2)),
        ],
    )
    def test_what_limits(self, monkeypatch, operations, instructions, bandwidth, loop):
        """The least time is that of what takes longest, and the loop does as much of it."""
        on = Machine(8, 1, operations, instructions, bandwidth)
        least = floor(kr500(), "inverse_dynamics", on)
        assert least.operations / 2 <= least.instructions < least.operations
        assert least.products < least.instructions
        needed = least.instructions / instructions, 2 * least.products / operations, least.bytes / bandwidth
        assert least.seconds == max(needed)
        done = []
        for name in ("mix", "multiply", "copy"):
            monkeypatch.setattr(Loops, name, lambda self, count, name=name: done.append((name, count)))
        limit(least, on)(9600)
        ((name, count),) = done
        amount = {"mix": least.instructions, "multiply": least.products, "copy": least.bytes}[name]
        if instructions == operations / 2:
            amount = least.instructions
        assert (name, count) == (loop[0], pytest.approx(amount * 9600 / (8 * loop[1]), abs=0.5))

    def test_identification(self, found):
        entries = found.identification.entries
        assert [(entry.name, entry.threads) for entry in entries] == [
            (name, threads) for threads in (1, 2) for name in (identification.OURS, identification.THEIRS)
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
        assert set(found.first_calls) == set(cold.CALLS)

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


class TestSaid:
    def test_schema(self, program, tmp_path):
        path = tmp_path / "bench.json"
        done = program("--json", path)
        assert done.exit_code == 0
        written = json.loads(path.read_text(encoding="utf-8"))
        SCHEMA.validate(written)

    @pytest.mark.parametrize("number", [math.nan, math.inf])
    def test_every_number_that_may_be_null(self, found, number):
        spoiled = plain(planted(record_of(found, []), number))
        assert spoiled["works"][0]["entries"][0]["error"] is None
        SCHEMA.validate(spoiled)

    def test_terminal(self, program, found):
        done = program()
        assert done.exit_code == 0
        words = " ".join(re.sub("[^\\w.×-]+", " ", done.stdout).split())
        for measured in found.works:
            assert measured.title.split(",")[0].lower() in words.lower()
        first = found.works[0].comparisons[0]
        assert ratio_text(first.ratio.median) in words
        assert "measured on 300 samples and extrapolated in proportion to 600" in words
        assert f"kr500 6 bodies {SAMPLES} random states seed 0" in words
        assert words.startswith("Benchmark on kr500 agrees")
        faster = sum(c.ratio.median > 1 for measured in found.works for c in measured.comparisons)
        faster += sum(ratio.median > 1 for _, ratio in found.identification.comparisons)
        assert f"Above 1× graphdyn is faster as in {faster} of " in words

    @pytest.mark.parametrize("width", [80, 120])
    def test_nothing_is_cut(self, found, width):
        lines = as_text(bench_report(found), width).splitlines()
        assert max(map(cell_len, lines)) <= width
        for curve in found.curves:
            for line in curve.lines:
                said = " ".join(lines[next(k for k, one in enumerate(lines) if one.lower() == curve.title) :])
                assert all(time_text(times.median) in said for times in line.times)
        assert "…" not in " ".join(re.findall(r"[a-z]…", " ".join(lines)))

    def test_a_disagreement_is_exit_code_1(self, program, found):
        wrong = replace(found.works[0].entries[0], error=2 * found.works[0].bound)
        works = (replace(found.works[0], entries=(wrong, *found.works[0].entries[1:])), *found.works[1:])
        done = program(result=replace(found, works=works))
        assert done.exit_code == 1

    def test_page(self, program, found, tmp_path):
        path = tmp_path / "bench.html"
        assert program("--html", path).exit_code == 0
        page = path.read_text(encoding="utf-8")
        root = etree.fromstring(page.encode(), etree.HTMLParser(encoding="utf-8"))
        ids = [element.get("id") for element in root.iter() if element.get("id")]
        assert len(set(ids)) == len(ids)
        assert {*WORKS, *(curve.name for curve in found.curves), "identification", "once"} <= set(ids)
        assert len(root.findall(".//svg")) == len(found.works) + len(found.curves) + len(("identification",))
        assert len(root.findall(".//figure[@class='plot']")) == len(found.curves)
        assert not re.search(r"""(src|href)=["'](https?:)?//""", page)
        assert "DISAGREES" not in page
        assert time_text(found.works[0].entries[0].times.median) in page

    def test_page_of_a_disagreement(self, found):
        wrong = replace(found.works[0].entries[0], error=float("inf"))
        works = (replace(found.works[0], entries=(wrong, *found.works[0].entries[1:])), *found.works[1:])
        html = page(bench_report(replace(found, works=works)), ["graphdyn", "bench"], versions())
        assert "Benchmark on kr500: DISAGREES</title>" in html
        assert f"further from Pinocchio&#39;s than its bound: {found.works[0].title}." in html

    def test_curves_as_plots(self, found):
        """Over the union of all x; lines that end early have gaps there, and the quartiles are around the median."""
        sections = {section.key: section for section in bench_report(found).sections}
        for curve in found.curves:
            (plot,) = [block for block in sections[curve.name].blocks if isinstance(block, Plot)]
            x = plot.x.tolist()
            assert x == sorted({point for line in curve.lines for point in line.x})
            for line, series in zip(curve.lines, plot.panels[0].series, strict=True):
                assert dict(zip(x, series.y, strict=True)) == pytest.approx(
                    {**dict.fromkeys(x, np.nan), **{p: t.median for p, t in zip(line.x, line.times, strict=True)}},
                    nan_ok=True,
                )
                drawn = ~np.isnan(series.y)
                assert (series.low[drawn] <= series.y[drawn]).all()
                assert (series.y[drawn] <= series.high[drawn]).all()

    def test_a_quiet_machine(self, found):
        assert "Not to be trusted" not in as_text(bench_report(quiet(found)))

    def test_a_busy_machine(self, found):
        """Each reason is told, the ratios concerned are marked, and only those."""
        still = quiet(found)
        works = (replace(still.works[0], core_share=0.62), *still.works[1:])
        busy = replace(still, works=works, load=(Load(12.0, 2), Load(1.0, 2)))
        text = as_text(bench_report(busy), 140)
        marked, every = len(still.works[0].comparisons), sum(len(x.comparisons) for x in still.works) + 2
        assert f"Not to be trusted: {marked} of {every} ratios (marked ?)" in text
        assert "the machine was busy before the benchmark began: 12 programs on 2 cores" in text
        assert "inverse dynamics: runs on one thread had a core for 62% of the time" in text
        assert len(re.findall(r"\? [\d.]+×", text)) == marked
        written = plain(record_of(busy, []))
        assert [work["core_share"] for work in written["works"]] == [0.62] + [1] * (len(WORKS) - 1)
        assert not any(one["trusted"] for one in written["works"][0]["ratios"])
        assert all(one["trusted"] for one in written["works"][1]["ratios"])
        assert written["load"] == [{"programs": 12.0, "cores": 2}, {"programs": 1.0, "cores": 2}]

    def test_scattered_ratios(self, found):
        still = quiet(found)
        first, *others = still.works[0].entries
        seconds = tuple(k * second for k, second in zip((1, 3, 9), first.times.seconds, strict=True))
        scattered = replace(first, times=Times(seconds))
        works = (replace(still.works[0], entries=(scattered, *others)), *still.works[1:])
        text = as_text(bench_report(replace(still, works=works)), 140)
        assert re.search(r"\d ratios have an upper quartile of more than 1.5 times the lower one", text)

    def test_load_that_nobody_tells(self, found, monkeypatch):
        monkeypatch.delattr(os, "getloadavg")
        assert load().programs is None
        assert not load().busy
        assert ("load", "not known before, not known after") in facts(replace(found, load=(load(), load())))

    @pytest.mark.parametrize(("programs", "busy"), [(1.9, False), (2.1, True)])
    def test_busy(self, programs, busy):
        assert Load(programs, 4).busy is busy

    def test_what_could_not_take_part(self, found):
        there = replace(found, left_out={"mujoco": "it rains"}, backend="numpy", machine=(), peers={})
        assert list(facts(there))[4:] == [
            ("mujoco", "left out: it rains"),
            ("graphdyn", "runs on NumPy arrays here: nothing is compiled"),
        ]


class TestRefusals:
    @pytest.mark.parametrize("option", ["--samples", "--threads"])
    def test_numbers(self, option):
        done = CliRunner().invoke(app, ["bench", option, "0"])
        assert done.exit_code == 2
        assert f"Invalid value for '{option}'" in done.output

    def test_unknown_robot(self):
        done = CliRunner().invoke(app, ["bench", "--robot", "ur55"])
        assert done.exit_code == 2
        assert "ur55" in done.output

    def test_folder_does_not_exist(self, tmp_path):
        done = CliRunner().invoke(app, ["bench", "--json", str(tmp_path / "no" / "bench.json")])
        assert done.exit_code == 2
        assert "does not exist" in done.output

    def test_threads_of_the_function(self):
        with pytest.raises(InvalidInput, match="threads is 0; give a number from 1, or None for all cores"):
            benchmark.benchmark("kr500", kr500(), 10, 0, 0, True, lambda *_: None)

    def test_no_mujoco(self, states, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "mujoco", None)
        peers = benchmark.Peers(states, tmp_path)
        assert "the package mujoco is not installed" in peers.left_out["mujoco"]

    def test_no_casadi(self, states, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "casadi", None)
        peers = benchmark.Peers(states, tmp_path)
        found = peers.contenders("inverse_dynamics", (1,))
        assert casadi_forms.NAME not in {contender.name for contender in found}
        assert peers.left_out["casadi"] == "the package casadi is not installed: pip install 'graphdyn[peers]'"

    def test_no_c_compiler(self, states, tmp_path, monkeypatch):
        pytest.importorskip("casadi")
        monkeypatch.setattr(shutil, "which", lambda _: None)
        with pytest.raises(CasadiRefuses, match=r"generates C code, and there is no C compiler \(cc\)"):
            casadi_forms.inverse(states, tmp_path)

    def test_the_c_compiler_fails(self, states, tmp_path, monkeypatch):
        pytest.importorskip("casadi")
        failing = tmp_path / "cc"
        failing.write_text("#!/bin/sh\necho no space left >&2\nexit 1\n", encoding="utf-8")
        failing.chmod(0o755)
        monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
        with pytest.raises(CasadiRefuses, match="the C compiler fails on CasADi's code: no space left"):
            casadi_forms.inverse(states, tmp_path)

    def test_a_process_that_fails(self, tmp_path):
        with pytest.raises(RuntimeError, match=r"the task first_calls in a process of its own failed.*model\.pickle"):
            in_fresh_process("first_calls", tmp_path)

    def test_another_order_of_joints(self):
        """Breadth first here, depth first there."""
        body = Body("", 1.0, np.zeros(3), np.eye(3))
        bodies = tuple(replace(body, name=f"b{k}") for k in range(3))
        joints = tuple(
            Joint(f"j{k}", "revolute", inside, Placement(), np.eye(3)[2]) for k, inside in enumerate((0, 0, 1))
        )
        model = RobotModel("bush", bodies, joints)
        with pytest.raises(PinocchioRefuses, match="'bush': Pinocchio has other coordinates, or another order"):
            PinocchioModel.from_model(model).bare_calls()
        pytest.importorskip("mujoco")
        with pytest.raises(MujocoRefuses, match="MuJoCo has the joints in another order"):
            MujocoModel(model).rollout(np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, 3)), 1)

    def test_instruction_set_is_not_known(self, monkeypatch):
        assert instruction_set() != "unknown"
        monkeypatch.setitem(sys.modules, "eigenpy", None)
        assert instruction_set() == "unknown"


class TestErrors:
    """Of the answers of the verbs against Pinocchio's functions."""

    @pytest.mark.parametrize(("work", "name"), [(work, name) for work, names in DERIVED.items() for name in names])
    def test_one_wrong_number_is_seen(self, states, work, name):
        """In any of the arrays, and in its sample only."""
        (form, *_) = OURS[work](states, (1,))
        answers = form.run(SAMPLES).copy()
        right = form.errors(answers)
        assert right.shape == (SAMPLES,)
        assert right.max() <= DESCRIPTIONS[work][2]
        answer = answers[DERIVED[work].index(name)]
        answer[(7, *(0,) * (answer.ndim - 1))] += 1e-9 * np.abs(answer).max()
        wrong = form.errors(answers) > DESCRIPTIONS[work][2]
        assert np.flatnonzero(wrong).tolist() == [7]

    def test_fewer_samples_than_are_judged(self, states):
        (form, *_) = OURS["coriolis_matrix"](states, (1,))
        assert len(form.errors(form.run(8))) == 8

    def test_many_samples(self):
        """The first ones are judged."""
        states = random_states(kr500(), FEW + 1, 1)
        (form, *_) = OURS["kinetic_energy"](states, (1,))
        assert len(form.errors(form.run(FEW + 1))) == FEW


class TestParts:
    def test_in_turns(self):
        calls = []
        runs = [lambda: calls.append("a"), lambda: calls.append("b")]
        rows = in_turns(runs, [1, 1], repeats=3, shortest=0.0)
        assert [len(row) for row in rows] == [3, 3]
        assert "".join(calls).endswith("ababab")

    def test_fitting_count(self):
        asked = []
        assert fitting_count(asked.append, 1, 5000, 1e9) == 5000
        assert asked == sorted(asked)
        assert fitting_count(asked.append, 700, 5000, 0.0) == 700
        assert fitting_count(asked.append, 1, 5, 1e9) == 5

    def test_ratio(self):
        found = ratio(Times((1.0, 2.0, 3.0)), Times((10.0, 40.0, 30.0)))
        assert (found.median, found.fastest, found.spread) == (10.0, 10.0, (10.0, 15.0))
        # one disturbed repeat of each: the quotient of the medians, 1.5, is outside the quartiles
        found = ratio(Times((2.0, 2.0, 9.0)), Times((4.0, 3.0, 3.0)))
        assert found.spread[0] <= found.median == 1.5 <= found.spread[1]

    @pytest.mark.parametrize(("spread", "steady"), [((10.0, 14.9), True), ((10.0, 15.1), False)])
    def test_steady(self, spread, steady):
        assert Ratio(12.0, 12.0, spread).steady is steady

    def test_core_share(self):
        """Of runs on one thread only: sleeping is a time without a core."""
        share = CoreShare()
        assert share.share == 1.0
        in_turns([lambda: time.sleep(0.01), lambda: time.sleep(0.01)], [1, 2], 2, 0.0, share)
        assert share.elapsed >= 0.02
        assert share.share < LEAST_SHARE
        share = CoreShare(elapsed=3.0, used=3.1)  # clocks differ a little
        assert share.share == 1.0

    @pytest.mark.parametrize(("most", "numbers"), [(1, (1,)), (2, (1, 2)), (6, (1, 2, 4, 6)), (8, (1, 2, 4, 8))])
    def test_thread_numbers(self, most, numbers):
        assert thread_numbers(most) == numbers

    def test_exponent(self):
        x = (1, 2, 4, 8, 16)
        assert Line("", 1, x, tuple(Times((3.0 * k**2,)) for k in x)).exponent == pytest.approx(2.0)
        assert Line("", 1, (1, 2), (Times((1.0,)), Times((2.0,)))).exponent is None

    def test_operations(self):
        recorder = Recorder()
        x, y = recorder.inputs("x", 2)
        program = recorder.program({"out": [x * y + 3.0, -(1.0 / x)]}, {})
        assert floating_point_operations(program) == 3
        angles = recorder.program({"out": [x.sine, x.cosine]}, {})
        one = floating_point_operations(angles)
        both = recorder.program({"out": [x.sine, x.cosine, y.cosine]}, {})
        assert floating_point_operations(both) == 2 * one > 20

    @pytest.mark.parametrize(
        ("outputs", "instructions", "products"),
        [
            (lambda x, y: [x * y + 3.0], 1, 1),
            (lambda x, y: [x * y + 3.0, x * y], 2, 1),  # the product is wanted too
            (lambda x, y: [x * y + 3.0, x * y - y], 3, 1),
            (lambda x, y: [x * x + y * y], 2, 2),  # one of both is fused
            (lambda x, y: [x + y, x / y], 2, 1),
            (lambda x, y: [x.sine], 20, 19),  # polynomials of sine and cosine, reduction of the angle
        ],
    )
    def test_instructions_after_fusion(self, outputs, instructions, products):
        recorder = Recorder()
        program = recorder.program({"out": outputs(*recorder.inputs("x", 2))}, {})
        assert fused_instructions(program) == (instructions, products)

    def test_cold_calls_take_all_memory_in_turn(self, states):
        """Hot ones the same rows, and both are judged at the first."""
        third = len(states) // 3
        for elsewhere in (False, True):
            ours, theirs = contenders(states, CallWork(False, third, elsewhere))
            for call in (ours, theirs):
                answers = [np.array(call.run(third)) for _ in range(4)]
                rows = [slice(k * third * elsewhere, (k * elsewhere + 1) * third) for k in (0, 1, 2, 0)]
                for answer, part in zip(answers, rows, strict=True):
                    assert np.abs(answer - states.torque[part]).max() < 1e-9 * np.abs(states.torque).max()
                assert call.errors(answers[1]).max() < PEERS

    def test_nothing_compiled_no_floor(self, monkeypatch):
        monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")
        assert machine(1) is None

    def test_forms_without_a_compiler(self, states, monkeypatch):
        monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")
        forms = graphdyn_forms.inverse(states, (1, 2))
        assert [form.name for form in forms if form.ours] == ["graphdyn NumPy"]

    @pytest.mark.parametrize("before", [None, "numpy"])
    def test_backend_is_put_back(self, before, monkeypatch):
        monkeypatch.delenv("GRAPHDYN_BACKEND", raising=False)
        if before:
            monkeypatch.setenv("GRAPHDYN_BACKEND", before)
        with graphdyn_forms.backend("numpy"):
            assert os.environ["GRAPHDYN_BACKEND"] == "numpy"
        assert os.environ.get("GRAPHDYN_BACKEND") == before

    def test_chain(self):
        model = chain(5)
        q, v = model.random_state(np.random.default_rng(0), 3)
        tau = PinocchioModel.from_model(model).rnea(q, v, v)
        assert np.allclose(graphdyn.joint_torques(model, q, v, v), tau, rtol=PEERS, atol=PEERS)

    @needs_a_compiler
    def test_casadi_function(self, states):
        casadi = pytest.importorskip("casadi")
        program = record(states.model, REQUESTS["inverse_dynamics"])
        function = casadi_forms.casadi_function(casadi, program, "tau", "f")
        tau = np.array(function(states.q[0], states.v[0], states.a[0])).ravel()
        assert states.torque_errors(tau[None]).max() < PEERS

    def test_an_error_that_is_not_a_number_is_not_in_bound(self):
        entry = Entry("graphdyn", 1, True, 1, Times((1.0,)), float("inf"), 1, "")
        assert not Measured("", "", "", 1.0, (entry,)).agrees

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
