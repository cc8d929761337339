"""The public functions of the dynamics, the table that says how each is computed, and what they answer."""

from graphdyn.verbs.compiled import SingleState
from graphdyn.verbs.table import VERBS

__all__ = ["VERBS", "SingleState"]
