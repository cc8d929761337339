"""The program `graphdyn`: one file per command, imported without Pinocchio, which the commands import when they run.

The public names are listed in __init__.pyi and imported when first used: a process that works for one command imports
that command alone.
"""

from typing import TYPE_CHECKING

import lazy_loader

if TYPE_CHECKING:  # the same edge as __init__.pyi, for the import contract
    from crosscheck.commands import application  # noqa: F401

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
