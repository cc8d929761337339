"""urdf.inspect: every fault and every oddity of a URDF file, and whether it is good for dynamics."""

from urdf.inspection.families import compared
from urdf.inspection.findings import Finding, Inspection, Severity, Verdict
from urdf.inspection.inspecting import inspect
from urdf.inspection.remedies import NOTHING

__all__ = ["NOTHING", "Finding", "Inspection", "Severity", "Verdict", "compared", "inspect"]
