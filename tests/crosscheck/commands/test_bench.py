"""What the benchmark says, on the terminal, on its page and as JSON."""

import json
import math
import os
import re
import statistics
from dataclasses import replace

import numpy as np
import pytest
import small_benchmark
from faults.planted_records import planted
from jsonschema import Draft202012Validator
from rich.cells import cell_len
from shared_data import REPOSITORY
from shown.blocks import blocks, cells, tables, texts
from shown.pages import parsed
from small_benchmark import SAMPLES, WORKS, quiet
from typer.testing import CliRunner

from crosscheck.bench import benchmark
from crosscheck.bench.machine.disturbance import Load, load
from crosscheck.bench.machine.floor import Floor, Machine
from crosscheck.bench.machine.timing import Times
from crosscheck.commands import app
from crosscheck.commands.bench.record import record as record_of
from crosscheck.commands.bench.report import bench_report, facts
from crosscheck.report.html import page
from crosscheck.report.plain_text import ratio_span_text, ratio_text, span_text, time_text
from crosscheck.report.records.record import plain, versions
from crosscheck.report.report import Picture, Plot, Prose
from crosscheck.report.text import as_text

ROOT = REPOSITORY
SCHEMA = json.loads((ROOT / "docs/schemas/bench-4.schema.json").read_text(encoding="utf-8"))


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
        assert f"kr500 3 bodies {SAMPLES} random states seed 0" in words
        assert words.startswith("Benchmark on kr500 ")
        assert "Every answer of graphdyn is within its bound" in words
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

    @pytest.mark.usefixtures("unpictured")
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
        report = bench_report(quiet(found))
        text = as_text(report)
        assert report.verdict.state == "agrees"
        assert "Not to be trusted" not in text
        assert "Other programs used the caches" not in text

    def test_shared_caches(self, found):
        """Against the fastest copy of all works; the ratios of processor time stay trusted."""
        still = quiet(found)
        first, second, *others = still.works
        first, second = replace(first, copy=Times((1.4e-4, 1e-4, 1.6e-4))), replace(second, copy=Times((1.2e-4,)))
        shared = replace(still, works=(first, second, *others))
        text = said(shared)
        assert f"Other programs used the caches, at the cost of the fastest forms {first.title}: a copy" in text
        assert text.count("a copy within the caches took 1.4× as long as at best") == 1
        assert "caches a copy of 4 MB within them, in turns with the works, took 1 … 1.4× as long as at best" in text
        assert "Not to be trusted" not in text
        written = plain(record_of(shared, []))
        assert [written["copy_slowdown"][x.name] for x in still.works] == pytest.approx([1.4, 1.2, *[1] * len(others)])
        assert written["works"][0]["copy"]["seconds"] == [1.4e-4, 1e-4, 1.6e-4]

    def test_a_busy_machine(self, found):
        """Each reason is told, the ratios of wall times that are concerned are marked, and only those."""
        still = quiet(found)
        works = (replace(still.works[0], core_share=0.62), *still.works[1:])
        busy = replace(still, works=works, load=(Load(12.0, 2), Load(1.0, 2)))
        text = as_text(bench_report(busy), 140)
        marked = sum(c.threads > 1 for c in still.works[0].comparisons)
        every = sum(len(x.comparisons) for x in still.works) + 2
        assert f"Not to be trusted: {marked} of {every} ratios (marked ?)" in text
        assert bench_report(busy).verdict.state == "undecided"
        assert text.startswith(f"Benchmark on kr500: not to be trusted: {marked} of {every} ratios\n")
        assert "the machine was busy before the benchmark began: 12 programs on 2 cores" in text
        assert "inverse dynamics: runs on one thread had a core for 62% of the time, so that wall times are too" in text
        assert len(re.findall(r"\? [\d.]+×", text)) == marked
        written = plain(record_of(busy, []))
        assert [work["core_share"] for work in written["works"]] == [0.62] + [1] * (len(WORKS) - 1)
        for one in written["works"][0]["ratios"]:
            assert one["clock"] == ("processor" if one["threads"] == 1 else "wall")
            assert one["trusted"] == (one["threads"] == 1)
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
        assert list(facts(there))[5:] == [
            ("mujoco", "left out: it rains"),
            ("graphdyn", "runs on NumPy arrays here: nothing is compiled"),
        ]


def three(seconds):
    """Median, quartiles and fastest of repeats, by the statistics of Python."""
    low, middle, high = statistics.quantiles(seconds, n=4, method="inclusive")
    assert middle == pytest.approx(statistics.median(seconds))
    return {"median": middle, "quartiles": [low, high], "fastest": min(seconds)}


def ratios(ours, theirs):
    """Of repeats that followed each other, and of the fastest."""
    of = three([y / x for x, y in zip(ours, theirs, strict=True)])
    return {"ratio": of["median"], "quartiles": of["quartiles"], "fastest_ratio": min(theirs) / min(ours)}


def whole(record, wanted):
    return all(record[name] == pytest.approx(values) for name, values in wanted.items())


def times_said(wanted):
    """As the tables have them: median, quartiles, fastest."""
    return [time_text(wanted["median"]), span_text(wanted["quartiles"]), time_text(wanted["fastest"])]


def repeated(times, k=0):
    """Three repeats in place of one, which has no quartiles."""
    (second,) = times.seconds
    return Times((second, (1.7 + 0.1 * k) * second, 1.2 * second))


@pytest.fixture(scope="module")
def often(found):
    """The benchmark with three repeats of all that was done once."""
    entries = tuple(replace(e, times=repeated(e.times, k)) for k, e in enumerate(found.identification.entries))
    *curves, last = found.curves
    assert last.name == "first_call"
    (line,) = last.lines
    return replace(
        found,
        identification=replace(found.identification, entries=entries),
        imports={name: repeated(times) for name, times in found.imports.items()},
        first_calls={name: repeated(times) for name, times in found.first_calls.items()},
        curves=(*curves, replace(last, lines=(replace(line, times=tuple(map(repeated, line.times))),))),
    )


class TestEveryNumber:
    """Of the record and the page, from the seconds of all repeats."""

    @pytest.fixture
    def shown(self, often):
        record = plain(record_of(often, ["bench"]))
        return record, bench_report(often), {work["name"]: work for work in record["works"]}

    def test_works(self, shown, found):
        _, report, works = shown
        for measured in found.works:
            work = works[measured.name]
            seconds = {(e.name, e.threads): e.times.seconds for e in measured.entries}
            (table,) = tables(report, measured.name)
            for entry, row in zip(work["entries"], texts(table), strict=True):
                own = entry["name"], entry["threads"]
                assert entry["seconds"] == list(seconds[own])
                wanted = three(seconds[own])
                assert whole(entry, wanted)
                error = "–" if entry["error"] is None else f"{entry['error']:.1e}"
                assert row == [own[0], str(own[1]), *times_said(wanted), str(entry["samples"]), error]
            assert work["agrees"] == all((e["error"] or 0) <= work["bound"] for e in work["entries"] if e["ours"])
            pairs = [
                (ours, theirs)
                for ours in work["entries"]
                for theirs in work["entries"]
                if ours["ours"] and not theirs["ours"] and ours["threads"] == theirs["threads"]
            ]
            for one, (ours, theirs) in zip(work["ratios"], pairs, strict=True):
                wanted = ratios(ours["seconds"], theirs["seconds"])
                assert (one["ours"], one["theirs"], one["threads"]) == (ours["name"], theirs["name"], ours["threads"])
                assert whole(one, wanted)
                low, high = wanted["quartiles"]
                had_cores = ours["threads"] == 1 or measured.core_share >= 0.95
                assert one["trusted"] == (high <= 1.5 * low and had_cores)
                assert one["clock"] == ours["clock"] == theirs["clock"]
            if work["floor"] is not None:
                first = next(e for e in work["entries"] if e["ours"] and e["threads"] == 1)
                assert whole(work["floor"], ratios(measured.limit.seconds, first["seconds"]))

    def test_table_of_ratios(self, shown):
        """All comparisons in order, with names where they change, and how often graphdyn is faster."""
        record, report, _ = shown
        every = [one for work in record["works"] for one in work["ratios"]]
        every += [
            {**one, "ours": "graphdyn streamed", "theirs": "pinocchio loop and lstsq"}
            for one in record["identification"]["ratios"]
        ]
        (table,) = tables(report, "ratios")
        for one, row in zip(every, texts(table), strict=True):
            mark = "" if one["trusted"] else "? "
            assert row[2:] == [
                one["theirs"], str(one["threads"]), mark + ratio_text(one["ratio"]), ratio_span_text(one["quartiles"]),
                ratio_text(one["fastest_ratio"]),
            ]  # fmt: skip
            assert row[1] in ("", one["ours"].removeprefix("graphdyn").strip())
        titles = [row[0] for row in texts(table)]
        starts = np.cumsum([0, *(len(work["ratios"]) for work in record["works"])])[:-1]
        assert [titles[k] for k, work in zip(starts, record["works"], strict=True) if work["ratios"]] == [
            work["title"] for work in record["works"] if work["ratios"]
        ]
        faster = sum(one["ratio"] > 1 for one in every)
        (words, *_) = [block.text for block in blocks(report, "ratios") if isinstance(block, Prose)]
        assert f"as in {faster} of {len(every)} comparisons" in words

    def test_bars(self, shown, found):
        _, report, works = shown
        for measured in found.works:
            for picture in (block for block in blocks(report, measured.name) if isinstance(block, Picture)):
                drawn = [one.ratio.median for one in picture.draw.keywords["comparisons"]]
                assert drawn == [one["ratio"] for one in works[measured.name]["ratios"]]

    def test_identification(self, shown):
        record, report, _ = shown
        of = record["identification"]
        entries = {(e["name"], e["threads"]): e for e in of["entries"]}
        for one in of["ratios"]:
            names = ("graphdyn streamed", "pinocchio loop and lstsq")
            ours, theirs = (entries[name, one["threads"]]["seconds"] for name in names)
            wanted = ratios(ours, theirs)
            assert whole(one, wanted)
            assert one["trusted"] == (wanted["quartiles"][1] <= 1.5 * wanted["quartiles"][0])
        (table,) = tables(report, "identification")
        for entry, row in zip(of["entries"], texts(table), strict=True):
            assert whole(entry, three(entry["seconds"]))
            about = "" if entry["samples"] == of["samples"] else "≈ "
            seconds = statistics.median(entry["seconds"]) * of["samples"]
            memory = f"{entry['extra_bytes'] / 1e6:.0f} MB"
            assert row == [
                entry["name"], str(entry["threads"]), about + time_text(seconds), memory, f"{entry['error']:.1e}"
            ]  # fmt: skip

    def test_once(self, shown):
        record, report, _ = shown
        (table,) = tables(report, "once")
        wanted = {f"import {name}": one for name, one in record["imports"].items()} | record["first_calls"]
        assert list(cells(table)) == list(wanted)
        for name, row in cells(table).items():
            assert whole(wanted[name], three(wanted[name]["seconds"]))
            assert row == times_said(three(wanted[name]["seconds"]))

    def test_curves(self, shown):
        """Every point, and growth by the slope of least squares through the upper half of the points."""
        record, report, _ = shown
        for curve in record["curves"]:
            rows = [row for table in tables(report, curve["name"]) if table.title for row in texts(table)]
            points = [point for line in curve["lines"] for point in line["points"]]
            for point, row in zip(points, rows, strict=True):
                assert whole(point, three(point["seconds"]))
                assert row[1:] == [str(point["x"]), *times_said(three(point["seconds"]))]
            for line in curve["lines"]:
                half = line["points"][len(line["points"]) // 2 :]
                if len(line["points"]) < 3:
                    assert line["exponent"] is None
                    continue
                x, y = (np.log([f(point) for point in half]) for f in (lambda p: p["x"], lambda p: min(p["seconds"])))
                slope = ((x - x.mean()) * (y - y.mean())).sum() / ((x - x.mean()) ** 2).sum()
                assert line["exponent"] == pytest.approx(slope)
                plot = next(block for block in blocks(report, curve["name"]) if isinstance(block, Plot))
                assert curve["x"] != "bodies" or f"{line['name']} as n^{slope:.1f}" in plot.caption
