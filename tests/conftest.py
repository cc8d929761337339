"""What all tests share: hypothesis' number of examples, one thread in linear algebra, kept bytecode, rare sweeps, and
machine code of their own, most of it not optimized."""

import gc
import os
import sys
import tempfile

import pytest
from hypothesis import settings
from threadpoolctl import threadpool_limits

from graphdyn.compiler import native, running
from graphdyn.simulation import loop_rows
from graphdyn.simulation.integration import compiled

sys.dont_write_bytecode = False  # else each of the programs that tests start compiles every file again
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

settings.register_profile("graphdyn", deadline=None, derandomize=True, max_examples=20)
settings.register_profile("nightly", deadline=None, derandomize=False, max_examples=1000, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "graphdyn"))


def pytest_configure(config):
    """All processes of one run share what one of them has compiled; nothing is taken from earlier runs.

    Thousands of tests live to the end, and recording a program makes 100,000 objects: sweep seldom, past both.
    """
    gc.set_threshold(50_000, 10, 10)
    if not hasattr(config, "workerinput"):
        folder = tempfile.TemporaryDirectory(prefix="graphdyn-code-")
        config.add_cleanup(folder.cleanup)
        os.environ["GRAPHDYN_CACHE"] = folder.name


def pytest_collection_finish():
    """What lives to the end need not be looked through again."""
    gc.collect()
    gc.freeze()


TOGETHER = ("bench", "paper", "identify", "commands/study")
"""Parts of the paths of files that share a result which takes seconds."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """One process runs all tests of a file, and those of files that share a result: it is made once."""
    if config.getvalue("dist") != "load":
        return None
    from xdist.scheduler import LoadFileScheduling

    class BySharedResults(LoadFileScheduling):
        def _split_scope(self, nodeid):
            file = super()._split_scope(nodeid)
            return next((part for part in TOGETHER if part in file), file)

    return BySharedResults(config, log)


OPTIMIZED = (
    "graphdyn/compiler",
    "graphdyn/recursions",
    "test_many_robots.py",
    "test_compiled.py",
    "test_single_precision.py",
    "test_agreement.py",
    "crosscheck/study",
    "crosscheck/distributing",
    "recordings/parts",
)
"""Parts of the paths of files whose tests are of compiled code, or compare its bits with those of other processes: it
is optimized there as users have it."""

OPTIMIZATION = native.OPTIMIZATION


@pytest.fixture(autouse=True, scope="module")
def _quickly_compiled(request):
    """Code that is not optimized does the same operations, as test_batch.py of the compiler shows, and is there in half
    the time; the long check compiles all code as users have it."""
    optimized = any(part in request.path.as_posix() for part in OPTIMIZED)
    level = OPTIMIZATION if optimized or request.config.option.markexpr != "not long" else 0
    if level != native.OPTIMIZATION:
        native.OPTIMIZATION = level
        for programs in running._of_contents.values():
            programs.ready, programs.at_the_other_level = getattr(programs, "at_the_other_level", {}), programs.ready
        compiled._compiled.clear()
        loop_rows._prepared.clear()


@pytest.fixture(autouse=True)
def _nothing_has_paid():
    """No test depends on which ran before it in the same process: none has computed anything yet."""
    for programs in running._of_contents.values():
        programs.samples.clear()


@pytest.fixture(autouse=True, scope="session")
def _one_blas_thread():
    """Threads only get in each other's way on matrices this small."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield
