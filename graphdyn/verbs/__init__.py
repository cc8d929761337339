"""The public functions of the dynamics, how each is computed, and what they answer.

graphdyn exports what `__all__` of the files says; here is what other packages need beside it.
"""

from graphdyn.verbs.single_state import SingleState
from graphdyn.verbs.verb import VERBS, Verb

__all__ = ["VERBS", "SingleState", "Verb"]
