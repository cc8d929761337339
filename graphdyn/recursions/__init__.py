"""The fast forms: recursions over the bodies, written once on scalars, and the table of them.

Each is declared beside its function (declarations); they are in the table when their files are imported.
"""

from graphdyn.recursions import derivatives, forward, frames, inertia, inverse, momentum, motion, regressors
from graphdyn.recursions.declarations import ARRAY_SPECS, CLOSED, RECURSIONS
from graphdyn.recursions.frames import FixedFrame
from graphdyn.recursions.loops import couplings, loops
from graphdyn.recursions.mechanism.mechanism import Link
from graphdyn.recursions.motion import Root

FILES = (inverse, forward, inertia, momentum, derivatives, frames, regressors, motion, couplings, loops)
"""Files that declare recursions."""

CLOSED.update({name: loops.at_motors(each) for name, each in RECURSIONS.items() if each.of_torques})

__all__ = ["ARRAY_SPECS", "RECURSIONS", "FixedFrame", "Link", "Root"]
