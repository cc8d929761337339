"""The recursion with spatial vectors and their transforms, its operations open to slips.

Featherstone, "Rigid Body Dynamics Algorithms", 2008, table 5.1, and table 6.2 for composite inertias. The transform X
of motions consists of E and -E r×, E turning from the inside link into the link; forces go back by Xᵀ.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    joint_placement,
    turned,
    turned_back,
)
from crosscheck.judging.slips.operations import Operations
from graphdyn.layout import Array

Spatial = tuple[Array, Array]
"""Angular and linear part (3, …)."""


TRANSFORMS = "every use of the transform X"
WAYS_OF_TRANSFORMS = (
    *("used with the opposite r", "used with a transposed rotation", "used without its rotation", "used without r"),
    *("used as (-r× E), not (-E r×)", "used with its blocks exchanged", "used inverted"),
    "used as (-Eᵀ r×), not (-E r×)",
)
"""What a wrong matrix X does to velocities, accelerations and forces at once."""


def _moved(name: str, j: int, turn: Array, r: Array, m: Spatial, do: Operations) -> Spatial:
    """A motion m of the inside link, at the link and in its axes; slips of X, and of this use of it."""
    w, u = m
    shifted = u - crossed(r, w)
    ways: dict[str, Callable[[], Spatial]] = {
        "used with the opposite r": lambda: (turned_back(turn, w), turned_back(turn, u + crossed(r, w))),
        "used with a transposed rotation": lambda: (turned(turn, w), turned(turn, shifted)),
        "used without its rotation": lambda: (w, shifted),
        "used without r": lambda: (turned_back(turn, w), turned_back(turn, u)),
        "used as (-r× E), not (-E r×)": lambda: (
            turned_back(turn, w),
            turned_back(turn, u) - crossed(r, turned_back(turn, w)),
        ),
        "used as (-Eᵀ r×), not (-E r×)": lambda: (
            turned_back(turn, w), turned_back(turn, u) - turned(turn, crossed(r, w))),
        "used with its blocks exchanged": lambda: (turned_back(turn, w - crossed(r, u)), turned_back(turn, u)),
        "used as that of forces": lambda: (turned_back(turn, w - crossed(r, u)), turned_back(turn, u)),
        "used inverted": lambda: (turned(turn, w), turned(turn, u) + crossed(r, turned(turn, w))),
        "used transposed": lambda: (turned(turn, w) + crossed(r, turned(turn, u)), turned(turn, u)),
    }  # fmt: skip
    found = np.stack([turned_back(turn, w), turned_back(turn, shifted)])
    others = _stacked(ways)
    found = do.result(f"the transform X of {name}", j, found, others)
    found = do.result(TRANSFORMS, j, found, {way: others[way] for way in WAYS_OF_TRANSFORMS})
    return found[0], found[1]


def _passed(j: int, turn: Array, r: Array, wrench: Spatial, do: Operations) -> Spatial:
    """A wrench (moment, force) of the link, at the inside link."""
    n, f = wrench
    back = turned(turn, f)
    ways: dict[str, Callable[[], Spatial]] = {
        "used with the opposite r": lambda: (turned(turn, n) - crossed(r, back), back),
        "used with a transposed rotation": lambda: (
            turned_back(turn, n) + crossed(r, turned_back(turn, f)), turned_back(turn, f)),
        "used without its rotation": lambda: (n + crossed(r, f), f),
        "used without r": lambda: (turned(turn, n), back),
        "used as (-r× E), not (-E r×)": lambda: (turned(turn, n + crossed(r, f)), back),
        "used as (-Eᵀ r×), not (-E r×)": lambda: (turned(turn, n) + crossed(r, turned_back(turn, f)), back),
        "used as that of motions": lambda: (turned(turn, n), back + crossed(r, turned(turn, n))),
        "used with its blocks exchanged": lambda: (turned(turn, n), back + crossed(r, turned(turn, n))),
        "used inverted": lambda: (turned_back(turn, n - crossed(r, f)), turned_back(turn, f)),
        "used not transposed": lambda: (turned_back(turn, n), turned_back(turn, f - crossed(r, n))),
        "used with r × f not turned": lambda: (turned(turn, n) + crossed(r, f), back),
    }  # fmt: skip
    found = np.stack(np.broadcast_arrays(turned(turn, n) + crossed(r, back), back))
    others = _stacked(ways)
    found = do.result("the transform Xᵀ of forces", j, found, others)
    found = do.result(TRANSFORMS, j, found, {way: others[way] for way in WAYS_OF_TRANSFORMS})
    return found[0], found[1]


def _stacked(ways: dict[str, Callable[[], Spatial]]) -> dict[str, Callable[[], Array]]:
    """Both parts of each as one array (2, 3, …)."""
    return {way: partial(_stack, other) for way, other in ways.items()}


def _stack(other: Callable[[], Spatial]) -> Array:
    return np.stack(np.broadcast_arrays(*other()))


def _both(do: Operations, name: str, j: int, right: Spatial, ways: dict[str, Callable[[], Spatial]]) -> Spatial:
    found = np.stack(np.broadcast_arrays(*right))
    others = _stacked(ways)
    found = do.result(name, j, found, others)
    return found[0], found[1]


def _inertia(x: Numbers, j: int, m: Spatial, do: Operations, name: str) -> Spatial:
    """The spatial inertia of a body times a motion: (moment, force)."""
    w, u = m
    mass, c, tensor = x.masses[j], x.centers[j], x.tensors[j]
    first = mass * c
    lower = do.result(f"-m c× in the lower left of {name}", j, -crossed(first, w))
    upper = do.result(f"m c× in the upper right of {name}", j, crossed(first, u))
    steiner = do.result(f"-m c× c× in the upper left of {name}", j, -crossed(first, crossed(c, w)), {
        "taken without m": lambda: -crossed(c, crossed(c, w)),
        "taken as m c cᵀ": lambda: first * (c * w).sum(axis=0) + 0 * w,
        "taken as m ∣c∣² 1": lambda: first * 0 + mass * (c * c).sum(axis=0) * w,
    })  # fmt: skip
    plain = do.result(f"J in {name}", j, turned(tensor, w))
    return plain + steiner + upper, do.result(f"m in the lower right of {name}", j, mass * u) + lower


def _bias(motion: Spatial, momentum: Spatial) -> Spatial:
    """v ×* h, as moment and force."""
    (w, u), (n, f) = motion, momentum
    return crossed(w, n) + crossed(u, f), crossed(w, f)


def spatial(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """Newton-Euler with spatial vectors, gravity as an acceleration of the base."""
    q, v, a = state
    zero = np.zeros((3, 1, 1))
    velocities: list[Spatial] = [(zero, zero)]
    accelerations: list[Spatial] = [(zero, -x.gravity)]
    wrenches: list[Spatial] = []
    frames: list[tuple[Array, Array]] = []
    apart = Operations([], 1)  # for the parts of what else a code may compute
    for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
        p = x.axes[j]
        turn, r = joint_placement(code, x, q, j)
        frames.append((turn, r))
        speed = do.result("S q̇ in the velocity", j, p * v[j])
        push = do.result("S q̈ in the acceleration", j, p * a[j])
        w, u = _moved("velocities", j, turn, r, velocities[inside], do)
        before = w, u
        w, u = (w, u + speed) if slides else (w + speed, u)
        velocities.append((w, u))
        s = p * v[j]
        bias = (0 * crossed(w, s), crossed(w, s)) if slides else (crossed(w, s), crossed(u, s))
        ways: dict[str, Callable[[], Spatial]] = {
            "taken with ×*, that of forces": lambda: (
                (crossed(u, s), crossed(w, s)) if slides else (crossed(w, s), 0 * s + 0 * w)),
            "taken without its linear part": lambda: (bias[0], 0 * bias[1]),
            "taken without its angular part": lambda: (0 * bias[0], bias[1]),
        }  # fmt: skip
        bias_w, bias_u = _both(do, "the term v × S q̇ in the acceleration", j, bias, ways)
        dw, du = _moved("accelerations", j, turn, r, accelerations[inside], do)
        dw, du = (dw + bias_w, du + bias_u + push) if slides else (dw + bias_w + push, du + bias_u)
        still = (dw, du - push) if slides else (dw - push, du)
        ways = {"taken without S q̈": lambda: still}
        accelerations.append(_both(do, "the acceleration that is carried on", j, (dw, du), ways))
        n, f = _both(do, "I a", j, _inertia(x, j, (dw, du), do, "the spatial inertia"), {
            "taken without S q̈ of the joint": lambda: _inertia(x, j, still, apart, ""),
        })  # fmt: skip
        h_n, h_f = _inertia(x, j, (w, u), do, "the spatial inertia")
        right = _bias((w, u), (h_n, h_f))
        ways = {
            "taken with ×, that of motions": lambda: (crossed(w, h_n), crossed(w, h_f) + crossed(u, h_n)),
            "taken with ×* in one half, with × of motions in the other": lambda: (
                crossed(w, h_n) + crossed(u, h_f) / 2,
                crossed(w, h_f) + crossed(u, h_n) / 2,
            ),
            "taken without v × f in its moment": lambda: (crossed(w, h_n), crossed(w, h_f)),
            "taken without ω × n in its moment": lambda: (crossed(u, h_f) + 0 * right[0], crossed(w, h_f)),
            "taken without its force": lambda: (right[0], 0 * right[1]),
            "taken without its moment": lambda: (0 * right[0], right[1]),
            "taken without S q̇ of the joint in v": lambda: _bias(before, _inertia(x, j, before, apart, "")),
            "taken without S q̇ of the joint in I v": lambda: _bias((w, u), _inertia(x, j, before, apart, "")),
            "taken without S q̇ of the joint in v ×*": lambda: _bias(before, (h_n, h_f)),
            "taken with -v × f in its moment": lambda: (crossed(w, h_n) - crossed(u, h_f), crossed(w, h_f)),
        }
        b_n, b_f = _both(do, "the bias wrench v ×* I v", j, right, ways)
        wrenches.append((n + b_n, f + b_f))
    tau = []
    for j in reversed(range(len(code.inside))):
        tau.append(do.result("the torque Sᵀ f", j, (x.axes[j] * wrenches[j][code.prismatic[j]]).sum(axis=0), {
            "taken of the other half of f": lambda: (x.axes[j] * wrenches[j][not code.prismatic[j]]).sum(axis=0),
        }))  # fmt: skip
        i = code.inside[j] - 1
        if i >= 0:
            n, f = _passed(j, *frames[j], wrenches[j], do)
            wrenches[i] = wrenches[i][0] + n, wrenches[i][1] + f
    return np.stack(np.broadcast_arrays(*reversed(tau)))
