"""Times, ratios and sizes in words: the same on the terminal and on the page."""

from __future__ import annotations

from collections.abc import Iterator

from crosscheck.studies.bench.benchmark import Benchmark
from crosscheck.studies.bench.contender import Entry, Measured
from crosscheck.studies.bench.floor import Floor
from crosscheck.studies.bench.identification import IdentificationRun, Identifications
from crosscheck.studies.bench.timing import Ratio

UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))


def time_text(seconds: float) -> str:
    """With three digits and a unit."""
    size, unit = next(((size, unit) for size, unit in UNITS if seconds >= size), UNITS[-1])
    return f"{seconds / size:.3g} {unit}"


def span_text(spread: tuple[float, float]) -> str:
    """Both in the unit of the larger one."""
    size, unit = next(((size, unit) for size, unit in UNITS if spread[1] >= size), UNITS[-1])
    low, high = (f"{x / size:.3g}" for x in spread)
    return f"{low} … {high} {unit}"


def ratio_text(ratio: float) -> str:
    return f"{ratio:.3g}×" if ratio < 1000 else f"{ratio:.0f}×"


def ratio_span_text(ratio: Ratio) -> str:
    low, high = map(ratio_text, ratio.spread)
    return f"{low} … {high}"


def threads_text(count: int) -> str:
    return f"{count} thread{'' if count == 1 else 's'}"


def error_text(entry: Entry) -> str:
    return "–" if entry.error is None else f"{entry.error:.1e}"


def floor_text(measured: Measured, floor: Floor) -> str:
    """How far our form on one thread is from what the machine could do."""
    ours = next(entry for entry in measured.entries if entry.ours and entry.threads == 1)
    return (
        f"{measured.title}: {floor.operations} floating-point operations and {floor.bytes} bytes per sample take at "
        f"least {time_text(floor.seconds)}; measured {ratio_text(ours.times.median / floor.seconds)} as much, at best "
        f"{ratio_text(ours.times.fastest / floor.seconds)}"
    )


def included(measured: Measured) -> list[str]:
    """What the times of each contender are of, and what errors are relative to."""
    by_name = {entry.name: entry.included for entry in measured.entries}
    return [
        *(f"{name}: {what}" for name, what in by_name.items()),
        f"errors: largest of all samples judged, against Pinocchio, relative to: {measured.error}",
    ]


def memory_text(extra: int | None) -> str:
    return "–" if extra is None else f"{extra / 1e6:.0f} MB"


def whole_time_text(entry: IdentificationRun, samples: int) -> str:
    """Of the whole recording; extrapolated where fewer samples were worked on."""
    prefix = "" if entry.samples == samples else "≈ "
    return prefix + time_text(entry.times.median * samples)


def extrapolated(found: Identifications) -> list[str]:
    """What was not measured on the whole recording."""
    fewer = {entry.name: entry.samples for entry in found.entries if entry.samples < found.samples}
    return [
        f"{name}: measured on {count} samples and extrapolated in proportion to {found.samples}; its memory is that of "
        f"{count} samples"
        for name, count in fewer.items()
    ]


def facts(found: Benchmark) -> Iterator[str]:
    """What a reader must know before the numbers."""
    yield (
        f"{found.robot}: {found.model.n_bodies} bodies, {found.samples} random states, seed {found.seed}; "
        f"{found.effort.repeats} repeats in turns; {found.cores} cores, compared with "
        f"{' and '.join(map(threads_text, found.threads))}"
    )
    for library, description in found.peers.items():
        yield f"{library} {description}"
    for library, reason in found.left_out.items():
        yield f"{library} left out: {reason}"
    if found.backend != "llvm":
        yield "graphdyn runs on NumPy arrays here: nothing is compiled"
    for machine in found.machine:
        yield (
            f"this machine with {threads_text(machine.threads)}: {machine.operations / 1e9:.3g} GFlop/s in vectors of "
            f"{machine.lanes}, {machine.bandwidth / 1e9:.3g} GB/s"
        )
