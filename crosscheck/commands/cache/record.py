"""The folder of compiled programs: the format `graphdyn cache 1`, and the report."""

from __future__ import annotations

from typing import Any

from crosscheck.report.records.record import Record, written
from crosscheck.report.report import Facts, Report, Section
from graphdyn.compiler import CACHE_VARIABLE, CodeCache


class CacheRecord(Record, of=CodeCache, format="graphdyn cache 1"):
    """The folder of compiled programs, before it was cleared if it was.

    cleared: whether all of them were removed
    """

    folder: str | None
    cleared: bool


def record(cache: CodeCache, cleared: bool) -> dict[str, Any]:
    return written(CacheRecord, cache, folder=cache.folder and str(cache.folder), cleared=cleared)


def cache_report(cache: CodeCache, cleared: bool) -> Report:
    """cleared: whether what was there has been removed"""
    facts: tuple[tuple[str, str], ...]
    if cache.folder is None:
        facts = (("folder", f"none: {CACHE_VARIABLE} is off, or there is no home folder"),)
    else:
        facts = (
            ("folder", str(cache.folder) if cache.is_writable else f"{cache.folder}, which cannot be written"),
            ("removed" if cleared else "compiled programs", f"{cache.files}, {cache.bytes / 1e6:.1f} MB"),
        )
    return Report(
        "Compiled programs", None, (Section("cache", "", (Facts(facts),)),), record=lambda _: record(cache, cleared)
    )
