"""Destinations of a report: the terminal, and if asked for a page and a JSON file."""

from __future__ import annotations

from crosscheck.commands.program.console import out
from crosscheck.commands.program.options import command_line
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.report.report import Report


def deliver(report: Report, html_file: OutputFile | None = None, json_file: OutputFile | None = None) -> None:
    """Print it; write the page and the JSON file, each whole or not at all, also where the output is closed early.

    Raises OSError.
    """
    from crosscheck.report.text import renderables

    try:
        for part in renderables(report, out.width):
            out.print(part)
    finally:
        _write(report, html_file, json_file)


def _write(report: Report, html_file: OutputFile | None, json_file: OutputFile | None) -> None:
    if html_file is not None:
        from crosscheck.report.html import page
        from crosscheck.report.records.record import versions

        html_file.write(page(report, command_line(), versions()).encode())
    if json_file is not None and report.record is not None:
        from crosscheck.report.records.json import as_bytes, plain

        json_file.write(as_bytes(plain(report.record(command_line()))))
