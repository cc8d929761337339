"""graphdyn against Pinocchio, number by number. Needs `pin`; the only package that does.

The public names are listed in __init__.pyi and imported when first used: the command line and the pytest fixture start
without Pinocchio. With those of crosscheck.identifying they are the whole public interface; other modules may change.
"""

from typing import TYPE_CHECKING

import lazy_loader

if TYPE_CHECKING:  # the same edges as __init__.pyi, for the import contract
    from crosscheck import assertions, comparing, distributing, exact, identifying, judging, recordings  # noqa: F401

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
