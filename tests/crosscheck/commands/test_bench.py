"""What the benchmark says, on the terminal, on its page and as JSON."""

import json
import math
import os
import re
from dataclasses import replace

import numpy as np
import pytest
import small_benchmark
from faults.planted_records import planted
from jsonschema import Draft202012Validator
from rich.cells import cell_len
from shared_data import REPOSITORY
from shown.pages import parsed
from small_benchmark import SAMPLES, WORKS, quiet
from typer.testing import CliRunner

from crosscheck.bench import benchmark
from crosscheck.bench.machine.floor import Floor, Machine
from crosscheck.bench.machine.timing import Load, Times, load
from crosscheck.commands import app
from crosscheck.commands.bench.record import record as record_of
from crosscheck.commands.bench.report import bench_report, facts
from crosscheck.report.html import page
from crosscheck.report.plain_text import ratio_span_text, ratio_text, span_text, time_text
from crosscheck.report.records.record import plain, versions
from crosscheck.report.report import Plot
from crosscheck.report.text import as_text

ROOT = REPOSITORY
SCHEMA = json.loads((ROOT / "docs/schemas/bench-3.schema.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def found():
    return small_benchmark.measured()


@pytest.fixture
def program(found, monkeypatch):
    """The command, which gives what was found without measuring again."""

    def run(*arguments, result=found):
        monkeypatch.setattr(benchmark, "benchmark", lambda *_: result)
        return CliRunner().invoke(app, ["bench", *map(str, arguments)])

    return run


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
        work = found.works[0]
        entries = tuple(replace(entry, times=Times((2e-7, 3e-7, 4e-7))) for entry in work.entries)
        floor = Floor(operations=1000, instructions=700, products=600, bytes=200, seconds=1e-7)
        works = (replace(work, entries=entries, limit=Times((1e-7, 1e-7, 1e-7))),)
        alone = replace(found, works=works, curves=(), floors={work.name: floor})
        html = page(bench_report(alone), [], {})
        assert "take at least 100 ns; measured 3× as much (quartiles 2.5 … 3.5×), at best 2×" in html


class TestSaid:
    def test_schema(self, program, tmp_path):
        path = tmp_path / "bench.json"
        done = program("--json", path)
        assert done.exit_code == 0
        written = json.loads(path.read_text(encoding="utf-8"))
        Draft202012Validator(SCHEMA).validate(written)

    @pytest.mark.parametrize("number", [math.nan, math.inf])
    def test_every_number_that_may_be_null(self, found, number):
        spoiled = plain(planted(record_of(found, []), SCHEMA, number))
        assert spoiled["works"][0]["entries"][0]["error"] is None
        Draft202012Validator(SCHEMA).validate(spoiled)

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
        root = parsed(page)
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
        works = (replace(found.works[0], entries=(wrong, *found.works[0].entries[1:])),)
        html = page(bench_report(replace(found, works=works, curves=())), ["graphdyn", "bench"], versions())
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
