"""Machine code or NumPy operations from a traced recursion, and the arrays of a verb through it.

From a verb down: batch (arrays in and out), running (threads, compiled or not), programs (a recursion recorded for one
robot), native and interpreter (the two back ends), disk_cache (machine code of earlier processes).
"""

from graphdyn.compiler.disk_cache import CACHE_VARIABLE, CodeCache, clear_code_cache, code_cache
from graphdyn.compiler.gram.gram import TorqueGram, torque_gram
from graphdyn.compiler.llvm.memory import aligned
from graphdyn.compiler.llvm.vector_code import VectorCode
from graphdyn.compiler.native import MachineCode, host_lanes
from graphdyn.compiler.programs import GROUND_SHAPES, Parts, Request, trace
from graphdyn.compiler.rolled.rolling import is_long, most_unrolled
from graphdyn.compiler.running import BACKEND_VARIABLE, chosen_backend, cores, in_threads, interpreted, quick_for_few

__all__ = [
    "BACKEND_VARIABLE",
    "CACHE_VARIABLE",
    "GROUND_SHAPES",
    "CodeCache",
    "MachineCode",
    "Parts",
    "Request",
    "TorqueGram",
    "VectorCode",
    "aligned",
    "chosen_backend",
    "clear_code_cache",
    "code_cache",
    "cores",
    "host_lanes",
    "in_threads",
    "interpreted",
    "is_long",
    "most_unrolled",
    "quick_for_few",
    "torque_gram",
    "trace",
]
