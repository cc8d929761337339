"""The page of `graphdyn bench`: ratios, times, accuracy and curves."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from crosscheck.report.pages.bench_curves import curve_picture, ratio_picture
from crosscheck.report.pages.rendering import render
from crosscheck.report.versions import versions
from crosscheck.studies.bench import texts
from crosscheck.studies.bench.benchmark import Benchmark
from crosscheck.studies.bench.identification import OURS, THEIRS


def bench_page(found: Benchmark, command: Sequence[str]) -> str:
    """One page. command: the arguments that made it"""
    return render(
        "bench.html",
        found=found,
        facts=list(texts.facts(found)),
        texts=texts,
        ours=OURS,
        theirs=THEIRS,
        ratios={work.name: ratio_picture(f"ratios-{work.name}", work.comparisons) for work in found.works},
        curves=[(curve, curve_picture(f"curve-{curve.name}", curve)) for curve in found.curves],
        command=shlex.join(command),
        versions=versions(),
    )
