"""The table of the functions that can be judged."""

from __future__ import annotations

from crosscheck.judging.functions.derivatives import DERIVATIVES
from crosscheck.judging.functions.energies import ENERGIES
from crosscheck.judging.functions.frames import FRAMES
from crosscheck.judging.functions.known_function import KnownFunction
from crosscheck.judging.functions.matrices import MATRICES
from crosscheck.judging.functions.momenta import MOMENTA
from crosscheck.judging.functions.placements import PLACEMENTS
from crosscheck.judging.functions.regressors import REGRESSORS
from crosscheck.judging.functions.torques import TORQUES

FUNCTIONS: dict[str, KnownFunction] = {
    function.name: function
    for function in (*TORQUES, *MATRICES, *PLACEMENTS, *FRAMES, *MOMENTA, *ENERGIES, *DERIVATIVES, *REGRESSORS)
}
