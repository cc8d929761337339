"""The public verbs that answer energies.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinity.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from graphdyn._base_motion import BaseMotion
from graphdyn._methods import Method, with_keywords
from graphdyn._model import RobotModel
from graphdyn._verbs import Verbs
from graphdyn.layout import Array


@with_keywords
def kinetic_energy(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """T = Σ ½ (m ṙ² + ωᵀ J ω) of all bodies (…) [J], in the world also where the base moves.

    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput.
    """
    return Verbs.kinetic_energy(model, (q, v), base, method, threads, check, out)


@with_keywords
def potential_energy(
    model: RobotModel,
    q: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """U = -Σ m g·r of all bodies (…) [J]; zero where the centers of mass are at the height of the world's origin.

    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput.
    """
    return Verbs.potential_energy(model, (q,), base, method, threads, check, out)
