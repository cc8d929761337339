"""The functions of a robot as code to take along, which computes without graphdyn.

Public are the names in `__all__` here, and in those of the modules casadi and jax. Other modules may change without
notice.
"""

from graphdyn.export.c.code import USUAL_FUNCTIONS, CCode, c_code
from graphdyn.export.c.dialect import Precision, Sines
from graphdyn.export.functions import ExportChoices, ExportedFunction, exportable

__all__ = [
    "USUAL_FUNCTIONS",
    "CCode",
    "ExportChoices",
    "ExportedFunction",
    "Precision",
    "Sines",
    "c_code",
    "exportable",
]
