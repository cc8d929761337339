"""urdf.inspect: every fault and every oddity of a URDF file, and whether it is good for dynamics."""

from urdf.inspection.findings import NOTHING, Finding, Inspection, Severity, Verdict
from urdf.inspection.inspecting import inspect

__all__ = ["NOTHING", "Finding", "Inspection", "Severity", "Verdict", "inspect"]
