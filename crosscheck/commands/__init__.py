"""The program `graphdyn`: one file per command, imported without Pinocchio, which the commands import when they run.

A process that works for one command imports this command alone.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, submod_attrs={"application": ["app", "main"]})
