"""Where a report goes: the terminal, and if asked for a page and a JSON file."""

from __future__ import annotations

from pathlib import Path

from crosscheck.cli.console import out
from crosscheck.cli.options import command_line
from crosscheck.report.report import Report


def deliver(report: Report, html_file: Path | None = None, json_file: Path | None = None) -> None:
    """Print it; write the page and the JSON file, each whole or not at all, also where the output is closed early.

    Raises OSError.
    """
    from crosscheck.report.text import renderables

    try:
        for part in renderables(report, out.width):
            out.print(part)
    finally:
        _write(report, html_file, json_file)


def _write(report: Report, html_file: Path | None, json_file: Path | None) -> None:
    if html_file is not None:
        from crosscheck.report.html import page, write_page
        from crosscheck.report.versions import versions

        write_page(html_file, page(report, command_line(), versions()))
    if json_file is not None and report.record is not None:
        from crosscheck.report.json import write_json

        write_json(json_file, report.record(command_line()))
