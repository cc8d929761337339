"""The report of every result that has one, and its beginning as HTML: the entry point `graphdyn.html`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from crosscheck.bench.benchmark import Benchmark
from crosscheck.commands.bench.report import bench_report
from crosscheck.commands.crosscheck.exact.report import accuracy_report
from crosscheck.commands.crosscheck.report import crosscheck_report
from crosscheck.commands.excite.report import excite_report
from crosscheck.commands.identify.reports.report import identify_report
from crosscheck.commands.inspect.report import inspect_report
from crosscheck.commands.judge.report import judge_report
from crosscheck.commands.payload.report import payload_report
from crosscheck.commands.recording.report import recording_report
from crosscheck.comparing.accuracy import TrueErrors
from crosscheck.comparing.comparison import Comparison
from crosscheck.exciting.excited import Excited
from crosscheck.identifying import Identified, IdentifiedPayload
from crosscheck.judging.judgment import Judgment
from crosscheck.notebook.motions import motion_report, recording_overview, virtual_recording_overview
from crosscheck.notebook.robots import robot_report
from crosscheck.recordings import RecognizedLog, Recording
from crosscheck.report.fragment import fragment
from crosscheck.report.report import Report
from graphdyn import GraphDynError, RobotModel, Simulation, VirtualRecording
from urdf import Inspection

REPORTS: dict[type, Callable[[Any], Report]] = {
    Benchmark: bench_report,
    Comparison: lambda found: crosscheck_report([found]),
    Excited: lambda found: excite_report(found, ()),
    Identified: lambda found: identify_report(found, found.shown(None)),
    IdentifiedPayload: payload_report,
    Inspection: lambda found: inspect_report([found], ()),
    Judgment: judge_report,
    RecognizedLog: lambda found: recording_report(found, "graphdyn identify"),
    Recording: recording_overview,
    RobotModel: robot_report,
    Simulation: motion_report,
    TrueErrors: lambda found: accuracy_report([found]),
    VirtualRecording: virtual_recording_overview,
}
"""What makes the report of a result, by its class."""


def html(result: object) -> str | None:
    """The beginning of the page of a result; None where there is none, so that a notebook shows the text.

    Of a robot whose loops cannot be closed there is no picture, and so no page.
    """
    report = REPORTS.get(type(result))
    try:
        return None if report is None else fragment(report(result))
    except GraphDynError:
        return None
