"""The table of the functions that can be judged."""

from __future__ import annotations

from difflib import get_close_matches

from crosscheck.judging.functions.derivatives import DERIVATIVES
from crosscheck.judging.functions.energies import ENERGIES
from crosscheck.judging.functions.frames import FRAMES, PLACEMENTS
from crosscheck.judging.functions.known_function import KnownFunction
from crosscheck.judging.functions.matrices import MATRICES
from crosscheck.judging.functions.momenta import MOMENTA
from crosscheck.judging.functions.regressors import REGRESSORS
from crosscheck.judging.functions.torques import TORQUES
from graphdyn import InvalidInput

FUNCTIONS: dict[str, KnownFunction] = {
    function.name: function
    for function in (*TORQUES, *MATRICES, *PLACEMENTS, *FRAMES, *MOMENTA, *ENERGIES, *DERIVATIVES, *REGRESSORS)
}


def known_function(name: str) -> KnownFunction:
    """Raises InvalidInput with the known names."""
    if name in FUNCTIONS:
        return FUNCTIONS[name]
    near = get_close_matches(name, FUNCTIONS, n=1)
    raise InvalidInput(
        f"there is no function {name!r} to judge{f'; did you mean {near[0]!r}?' if near else ''}; "
        f"known are {', '.join(FUNCTIONS)}"
    )
