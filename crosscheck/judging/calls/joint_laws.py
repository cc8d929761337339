"""Laws of torques that depend on the position or the velocity of one joint, fitted to what was seen of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.judgment import FittedNumber
from graphdyn.layout import Array

MAX_HARMONIC = 40
"""Largest number of periods per turn of a torque that ripples."""

MAX_POLYNOMIAL_DEGREE = 5

N_PHASES = 60
WIRE_SHARES = (0.2, 0.5, 0.8, 0.95)
"""Start values of the search for a wire spring: angles over a turn, and parts of the largest length that change."""

WIDTHS = np.geomspace(0.01, 1.0, 30)
"""Start values of the Stribeck velocity, as parts of the largest velocity."""

IDLE_SHARE = 1e-9
"""Part of the largest torque below which a term of a fit is rounding."""

Column = Callable[[Array], NDArray[Any]]


@dataclass(frozen=True, eq=False)
class AddedLaw:
    """A law: its torque as a function of the position or velocity, in words; "" for no torque.

    values: its numbers by name and unit
    plain: whether it is a line, dry friction, or one sine: a physical fault may have the same torque
    """

    said: str
    torque: Column
    values: tuple[tuple[str, float, str], ...] = ()
    plain: bool = False
    of_velocity: bool = False

    def numbers(self, joint: str) -> Iterator[FittedNumber]:
        for name, value, unit in self.values:
            yield FittedNumber(f"{name}, {joint}", value, 0.0, unit)


def of_position(q: Array, torque: Array, room: float, *, slides: bool) -> AddedLaw | None:
    """The simplest law through torques (K,) at positions (K,) that leaves no more than room [N m]."""
    force, unit = ("N", "m") if slides else ("N m", "rad")
    if np.abs(torque).max() <= room:
        return AddedLaw("", np.zeros_like, plain=True)
    one = np.ones_like
    laws = [
        _linear(q, torque, room, (("", one), ("q", lambda x: x)), force, plain=True),
        *([] if slides else [_sine(q, torque, room, k, force) for k in range(1, MAX_HARMONIC + 1)]),
        *(
            _linear(q, torque, room, tuple((_power(k), _to_the(k)) for k in range(degree + 1)), force)
            for degree in range(2, MAX_POLYNOMIAL_DEGREE + 1)
        ),
        *([] if slides else [_series(q, torque, room, k, force) for k in (2, 3)]),
    ]
    found = next((law for law in laws if law is not None), None)
    found = found or _one_sided(q, torque, room, force, unit)
    return found or (None if slides else _wire_spring(q, torque, room))


def of_velocity(v: Array, torque: Array, room: float, *, slides: bool) -> AddedLaw | None:
    """The same of velocities."""
    force = "N" if slides else "N m"
    if np.abs(torque).max() <= room:
        return AddedLaw("", np.zeros_like, plain=True, of_velocity=True)
    dry = (("sign v", np.sign), ("v", lambda x: x))
    law = _linear(v, torque, room, dry, force, plain=True)
    law = law or _linear(v, torque, room, (*dry, ("v ∣v∣", lambda x: x * np.abs(x))), force)
    law = law or _linear(
        v, torque, room,
        (("(v > 0)", lambda x: 1.0 * (x > 0)), ("v (v > 0)", lambda x: x * (x > 0)),
         ("(v < 0)", lambda x: 1.0 * (x < 0)), ("v (v < 0)", lambda x: x * (x < 0))), force,
    )  # fmt: skip
    if law is not None:
        what = "viscous or dry friction" if law.plain else "friction"
        return AddedLaw(f"{what} {law.said}", law.torque, law.values, law.plain, of_velocity=True)
    return _stribeck(v, torque, room, force, "m/s" if slides else "rad/s")


def _power(k: int) -> str:
    return {0: "", 1: "q", 2: "q²", 3: "q³"}.get(k, f"q^{k}")


def _to_the(k: int) -> Column:
    return lambda x: x**k


def _fit(columns: Array, torque: Array) -> Array:
    size = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    found: Array = np.linalg.lstsq(columns / size, torque, rcond=None)[0] / size
    return found


def _linear(
    x: Array, torque: Array, room: float, terms: tuple[tuple[str, Column], ...], force: str, *, plain: bool = False
) -> AddedLaw | None:
    """A sum of terms; those that do nothing are left out."""
    columns = np.stack([column(x) for _, column in terms], axis=1)
    factors = _fit(columns, torque)
    if np.abs(columns @ factors - torque).max() > room:
        return None
    effect = np.abs(columns * factors).max(axis=0)
    factors = np.where(effect > max(room, IDLE_SHARE * effect.max()), factors, 0.0)
    used = [(name, float(factor)) for (name, _), factor in zip(terms, factors, strict=True) if factor]
    said = " + ".join(f"{factor:.6g}{f' {name}' if name else ''}" for name, factor in used).replace("+ -", "- ")
    return AddedLaw(
        f"{said} {force}",
        lambda y: sum(f * column(y) for f, (_, column) in zip(factors, terms, strict=True)) + 0 * y,
        tuple((f"factor of {name or '1'}", factor, force) for name, factor in used),
        plain,
    )


def _sine(q: Array, torque: Array, room: float, harmonic: int, force: str) -> AddedLaw | None:
    """k sin(m (q - q0)) + c."""
    columns = np.stack([np.ones_like(q), np.sin(harmonic * q), np.cos(harmonic * q)], axis=1)
    constant, along, across = _fit(columns, torque)
    if np.abs(columns @ [constant, along, across] - torque).max() > room:
        return None
    size, phase = float(np.hypot(along, across)), float(np.arctan2(-across, along)) / harmonic
    constant = float(constant) if abs(constant) > max(room, IDLE_SHARE * size) else 0.0
    inner = "q" if abs(phase) < IDLE_SHARE else f"q {'-' if phase > 0 else '+'} {abs(phase):.6g}"
    argument = inner if harmonic == 1 else f"{harmonic} ({inner})" if " " in inner else f"{harmonic} q"
    said = f"{size:.6g} sin({argument}){f' {constant:+.6g}' if constant else ''} {force}"
    return AddedLaw(
        said,
        lambda x: size * np.sin(harmonic * (x - phase)) + constant,
        (("amplitude", size, force), ("zero", phase, "rad"), ("constant", constant, force)),
        plain=harmonic == 1,
    )


def _series(q: Array, torque: Array, room: float, count: int, force: str) -> AddedLaw | None:
    terms: list[tuple[str, Column]] = [("", np.ones_like)]
    for k in range(1, count + 1):
        inner = "q" if k == 1 else f"{k} q"
        terms += [
            (f"cos({inner})", lambda x, k=k: np.cos(k * x)),  # type: ignore[misc]
            (f"sin({inner})", lambda x, k=k: np.sin(k * x)),  # type: ignore[misc]
        ]
    return _linear(q, torque, room, tuple(terms), force)


def _one_sided(q: Array, torque: Array, room: float, force: str, unit: str) -> AddedLaw | None:
    """A spring that acts beyond a position: c + k max(0, q - q0), or below it."""
    for sign in (1.0, -1.0):
        x, y = (z[:: int(sign)] for z in (sign * q, torque))
        rest = np.abs(y - y[0]) <= room
        first = int((~rest).argmax())
        if first < 2 or len(x) - first < 4:
            continue
        slope, start = np.polyfit(x[first:], y[first:] - y[0], 1)
        if np.abs(slope * x[first:] + start + y[0] - y[first:]).max() > room:
            continue
        stiffness, place, constant = float(slope), float(-start / slope), float(y[0] if abs(y[0]) > room else 0.0)
        if not x[first - 1] - IDLE_SHARE <= place <= x[first] + IDLE_SHARE:
            continue
        side = "above" if sign > 0 else "below"
        said = f"a spring of {sign * stiffness:.6g} {force}/{unit} that acts {side} {sign * place:.6g} {unit}"
        return AddedLaw(
            said,
            lambda z, s=sign, k=stiffness, p=place, c=constant: c + k * np.maximum(0.0, s * z - p),  # type: ignore[misc]
            (("stiffness", sign * stiffness, f"{force}/{unit}"), ("start", sign * place, unit)),
        )
    return None


def _wire(x: Array, q: Array) -> Array:
    """c (1 - l / √(1 - e cos(q - q0))) sin(q - q0): a spring between a point of one link and a crank of the other.

    With its stiffness k, arms r and h, and free length l₀: c = k r h, e = 2 r h / (r² + h²), l = l₀ / √(r² + h²).
    """
    torque: Array = x[0] * (1 - x[1] / np.sqrt(1 - x[2] * np.cos(q - x[3]))) * np.sin(q - x[3])
    return torque


def _wire_spring(q: Array, torque: Array, room: float) -> AddedLaw | None:
    from scipy.optimize import least_squares  # imported where first used

    starts = []
    for phase in np.linspace(-np.pi, np.pi, N_PHASES, endpoint=False):
        for share in WIRE_SHARES:
            sine, root = np.sin(q - phase), np.sqrt(1 - share * np.cos(q - phase))
            columns = np.stack([sine, -sine / root], axis=1)
            stiff, free = _fit(columns, torque)
            left = float(np.abs(columns @ [stiff, free] - torque).max())
            if stiff:
                starts.append((left, [stiff, free / stiff, share, phase]))
    bounds = [-np.inf, -np.inf, 0.0, -np.inf], [np.inf, np.inf, 1 - 1e-9, np.inf]
    for _, start in sorted(starts, key=lambda x: x[0])[:4]:
        scale = [abs(start[0]), max(abs(start[1]), 1.0), 1.0, 1.0]
        found = least_squares(
            lambda x: _wire(x, q) - torque, start, bounds=bounds, x_scale=scale, jac="3-point", xtol=1e-15, ftol=1e-15,
            gtol=1e-15, max_nfev=200,
        ).x  # fmt: skip
        if np.abs(_wire(found, q) - torque).max() <= room:
            break
    else:
        return None
    c, free, share, phase = (float(x) for x in found)
    phase = (phase + np.pi) % (2 * np.pi) - np.pi
    said = (
        f"a wire spring with stiffness × both levers = {c:.6g} N m, no torque at q = {phase:.6g} rad, and a free "
        f"length of {free:.6g} √(r² + h²), where 2 r h = {share:.6g} (r² + h²) for its levers r and h"
    )
    values = (
        ("k r h", c, "N m"),
        ("zero", phase, "rad"),
        ("l₀ / √(r² + h²)", free, ""),
        ("2 r h / (r² + h²)", share, ""),
    )
    return AddedLaw(said, lambda x: _wire(found, x), values)


def _stribeck(v: Array, torque: Array, room: float, force: str, unit: str) -> AddedLaw | None:
    """sign v (c + s exp(-(∣v∣/w)^p)) + d v with p 1 or 2."""
    from scipy.optimize import minimize_scalar  # imported where first used

    largest = float(np.abs(v).max())
    for power in (2, 1):

        def columns(width: float, x: Array = v, power: int = power) -> Array:
            return np.stack([np.sign(x), np.sign(x) * np.exp(-((np.abs(x) / width) ** power)), x], axis=1)

        def left(logarithm: float, columns: Callable[[float], Array] = columns) -> float:
            table = columns(float(np.exp(logarithm)))
            return float(np.linalg.norm(table @ _fit(table, torque) - torque))

        trials = [left(float(np.log(width * largest))) for width in WIDTHS]
        best = int(np.argmin(trials))
        ends = np.log(largest * WIDTHS[[max(best - 1, 0), min(best + 1, len(WIDTHS) - 1)]])
        width = float(np.exp(minimize_scalar(left, bounds=tuple(ends), method="bounded", options={"xatol": 1e-14}).x))
        width = _polished(width, lambda w: columns(w), torque)
        factors = _fit(columns(width), torque)
        if np.abs(columns(width) @ factors - torque).max() > room:
            continue
        dry, more, viscous = (float(x) for x in factors)
        viscous = viscous if abs(viscous) * largest > room else 0.0
        exponent = "(v/w)²" if power == 2 else "∣v∣/w"
        said = (
            f"Stribeck friction with sign v: {dry:.6g} {force} dry, {dry + more:.6g} {force} at the start, "
            f"exp(-{exponent}) with w = {width:.6g} {unit}" + (f", {viscous:.6g} v viscous" if viscous else "")
        )
        values = (
            ("dry", dry, force), ("at the start", dry + more, force), ("Stribeck velocity", width, unit),
            ("viscous", viscous, f"{force} per {unit}"),
        )  # fmt: skip
        return AddedLaw(said, lambda x, w=width, f=factors, c=columns: c(w, x) @ f, values, of_velocity=True)  # type: ignore[misc]
    return None


def _polished(width: float, columns: Callable[[float], Array], torque: Array) -> float:
    """A few Gauss-Newton steps on the width, the other numbers fitted with it."""
    for _ in range(8):
        step = 1e-6 * width
        table, slope = columns(width), (columns(width + step) - columns(width - step)) / (2 * step)
        factors = _fit(table, torque)
        both = np.concatenate([table, (slope @ factors)[:, None]], axis=1)
        moved = float(_fit(both, torque)[-1])
        if not abs(moved) < width / 2:
            break
        width += moved
    return width
