"""Linear fits: faults with free numbers, found by fitting known columns to the deviation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from crosscheck.judging.experiments import Parts, TrialStates, split, stacked, torques
from crosscheck.judging.velocity_terms import velocity_terms
from graphdyn import RobotModel, joint_torque_regressor
from graphdyn._inertia import parallel_axis, parameters_from_inertia
from graphdyn.layout import Array, parameter_columns

ROUND = 1e-4
"""Relative distance from a round number within which a fitted factor is that number."""

SETTLED = 1e-6
"""Part of the largest singular value below which the data do not determine a direction."""


@dataclass(frozen=True)
class FittedFault:
    """A fault found by a fit: kind, message, remedy, and the relative error that is left."""

    kind: str
    message: str
    remedy: str
    left: float


def fit(columns: Array, target: Array) -> tuple[Array, float]:
    """Least squares (m, p), (m,) → the smallest factors (p,), and the largest entry that is left."""
    unit = np.linalg.norm(columns, axis=0)
    unit = np.where(unit > 0, unit, 1.0)
    factors = np.linalg.lstsq(columns / unit, target, rcond=SETTLED)[0] / unit
    return factors, float(np.abs(columns @ factors - target).max())


def gravity_vector(model: RobotModel, trial: TrialStates, observed: Parts, scale: dict[str, float]) -> FittedFault:
    """The gravity vector that gives the torques at rest: g is linear in it."""
    assert observed.gravity is not None
    zero = np.zeros_like(trial.q)
    columns = [torques(model.with_gravity(e))(trial.q, zero, zero).ravel() for e in np.eye(3)]
    found, left = fit(np.stack(columns, axis=-1) / scale["gravity"], observed.gravity.ravel() / scale["gravity"])
    ours = np.array(model.gravity)
    shown = ", ".join(f"{x:.6g}" for x in np.where(np.abs(found) < ROUND, 0.0, found))
    here = ", ".join(f"{x:.6g}" for x in ours)
    settled = np.linalg.matrix_rank(np.stack(columns, axis=-1), tol=SETTLED * np.abs(columns).max()) == 3
    found_factor = float(found @ ours / (ours @ ours)) if ours.any() else np.nan
    if not np.abs(found).max() > ROUND:
        message = "gravity is left out"
    elif np.abs(found + ours).max() < ROUND:
        message = "gravity has the opposite sign"
    elif np.abs(found - found_factor * ours).max() < ROUND:
        message = f"gravity is {np.linalg.norm(found):.6g} m/s², not {np.linalg.norm(ours):.6g} m/s²"
    else:
        message = f"gravity acts along ({shown}), not ({here}) m/s², or the base is turned"
    unsettled = "" if settled else " (the torques of this robot do not determine all three components)"
    return FittedFault(
        "gravity", message + unsettled, f"use the gravity vector ({here}) m/s² in the axes of the base", left
    )


def friction(trial: TrialStates, deviation: Array, scale: float) -> FittedFault:
    """Torques proportional to v_j, or to its sign, in the row of joint j alone."""
    viscous, dry, left = [], [], 0.0
    for k in range(trial.v.shape[1]):
        columns = np.stack([trial.v[:, k], np.sign(trial.v[:, k])], axis=-1)
        (d, c), rest = fit(columns, deviation[:, k])
        viscous.append(d)
        dry.append(c)
        left = max(left, rest / scale)
    said = [
        f"{name} ({', '.join(f'{x:.4g}' for x in values)}) {unit}"
        for name, values, unit in (
            ("viscous friction", viscous, "N m s/rad or N s/m"),
            ("dry friction", dry, "N m or N"),
        )
        if np.abs(values).max() > SETTLED * scale
    ]
    return FittedFault(
        "friction",
        f"{' and '.join(said) or 'friction'} per joint is included",
        "the dynamics of rigid bodies have no friction; switch it off for the comparison",
        left,
    )


def rotor_inertia(deviation: Array, scale: float) -> FittedFault:
    """A constant diagonal added to M (N, n, n)."""
    diagonal = np.diagonal(deviation, axis1=-2, axis2=-1)
    rotors = diagonal.mean(axis=0)
    left = float(np.abs(deviation - np.diag(rotors)).max()) / scale
    return FittedFault(
        "rotor_inertia",
        f"a constant diagonal ({', '.join(f'{x:.4g}' for x in rotors)}) is added to the mass matrix",
        "rotor inertia (armature) belongs to the drives; switch it off for the comparison",
        left,
    )


def velocity_factors(model: RobotModel, trial: TrialStates, observed: Parts, scale: dict[str, float]) -> FittedFault:
    """Wrong factors on the terms of c(q, v), in the decomposition that leaves least, the first of equals."""
    assert observed.velocity is not None
    target = observed.velocity.ravel() / scale["velocity"]
    findings = [FittedFault("coriolis", "velocity terms appear where there are none", "compare with a = 0", np.inf)]
    for terms in velocity_terms(model, trial):
        weak = SETTLED * max(np.abs(torque).max() for torque in terms.values())
        present = {name: torque for name, torque in terms.items() if np.abs(torque).max() > weak}
        if not present:
            break
        columns = np.stack([torque.ravel() for torque in present.values()], axis=-1) / scale["velocity"]
        factors, left = fit(columns, target)
        wrong = {name: x for name, x in zip(present, factors, strict=True) if abs(x - 1) > ROUND}
        message = "; ".join(_factor_said(name, factor) for name, factor in wrong.items())
        findings.append(
            FittedFault("coriolis", message, "check that term in the recursion of velocities and accelerations", left)
        )
        if left <= SETTLED:
            break
    return min(findings, key=lambda finding: finding.left)


PIECES = ("mass", "first moment", "parallel-axis term", "tensor about the center of mass")
"""Parts of a body's ten parameters, which are their sum: a wrong factor on one of them is a fault with a name."""

_ABOUT = {
    0.0: "the tensor of {who} is about the center of mass and used as if about the link origin",
    2.0: "the tensor of {who} is about the link origin and used as if about the center of mass",
    -1.0: "the parallel-axis term of {who} has the opposite sign",
}
"""Messages by the factor on the parallel-axis term."""


class ParameterFits:
    """Deviations that other inertial parameters explain: τ is linear in them.

    target: the deviations
    """

    def __init__(self, model: RobotModel, trial: TrialStates, target: Parts, scale: dict[str, float]):
        known = target.known()
        parts = split(lambda q, v, a: joint_torque_regressor(model, q, v, a), trial)
        self._model, self._deviation = model, stacked(target, known, scale)
        self._regressor = stacked(parts, known, scale)

    def named(self) -> Iterator[FittedFault]:
        """Factors on parts of the parameters that are a known fault: of all bodies together, then of one at a time."""
        yield from (finding for finding, has_name in self._factors() if has_name)

    def unnamed(self) -> Iterator[FittedFault]:
        """Any factors on the parts; any ten parameters of one body; any parameters of all bodies."""
        yield from (finding for finding, has_name in self._factors() if not has_name)
        for k, name in enumerate(self._model.body_names, start=1):
            _, left = fit(self._regressor[:, parameter_columns(k)], self._deviation)
            yield FittedFault(
                "inertial_parameters",
                f"other inertial parameters of body '{name}' alone explain all numbers",
                f"compare mass, center of mass and tensor of '{name}', and the fixed links it carries",
                left,
            )
        _, left = fit(self._regressor, self._deviation)
        yield FittedFault(
            "inertial_parameters",
            "other inertial parameters of several bodies explain all numbers; the geometry of the joints is right",
            "compare masses, centers of mass and tensors body by body",
            left,
        )

    def _factors(self) -> Iterator[tuple[FittedFault, bool]]:
        blocks = {
            f"body '{body.name}'": self._regressor[:, parameter_columns(k)]
            @ _pieces(body.mass, body.center_of_mass, body.inertia).T
            for k, body in enumerate(self._model.bodies, start=1)
        }
        for who, block in {"every body": np.sum(list(blocks.values()), axis=0), **blocks}.items():
            extra, left = fit(block, self._deviation)
            factors = [_rounded(1 + x) for x in extra]
            if named := _interpreted(who, *factors):
                yield FittedFault(*named, left), True
            elif any(x != 1 for x in factors):
                wrong = ", ".join(f"{name} × {x:.4g}" for name, x in zip(PIECES, factors, strict=True) if x != 1)
                message = f"inertial parameters of {who} are wrong: {wrong}"
                yield FittedFault("inertial_parameters", message, "compare them one by one", left), False


def _pieces(mass: float, center: Array, tensor: Array) -> Array:
    """Ten parameters of each part (4, 10)."""
    zero = np.zeros(3)
    piece = np.zeros((4, 10))
    piece[0, 0] = mass
    piece[1, 1:4] = mass * center
    piece[2] = parameters_from_inertia(0.0, zero, parallel_axis(mass, center))
    piece[3] = parameters_from_inertia(0.0, zero, tensor)
    return piece


def _interpreted(who: str, m: float, mc: float, parallel: float, tensor: float) -> tuple[str, str, str] | None:
    """Kind, message and remedy of factors on m, m c, the parallel-axis term and the tensor; None for no known fault."""
    if m == mc == tensor == 1 and parallel in _ABOUT:
        remedy = "a tensor about the center of mass needs m (c·c E - c cᵀ) more about the link origin"
        return "inertia_point", _ABOUT[parallel].format(who=who), remedy
    if m == mc == parallel == tensor != 1:
        return _scaled(f"all inertial parameters of {who}, or all torques,", m)
    if m == mc == parallel != 1 and tensor == 1:
        return _scaled(f"the mass of {who}", m)
    if m == mc == parallel == 1 != tensor:
        return _scaled(f"the tensor of {who}", tensor)
    if m == tensor == 1 != mc and abs(parallel - mc**2) <= ROUND * mc**2:
        return _scaled(f"the center of mass of {who}", mc)
    return None


def _scaled(what: str, factor: float) -> tuple[str, str, str] | None:
    if factor == 0:
        return "inertial_parameters", f"{what} left out", "use the values of the model"
    power = np.log10(abs(factor))
    if round(power) == 0 or abs(power - round(power)) > ROUND:
        return "inertial_parameters", f"{what} multiplied by {factor:.6g}", "use the values of the model"
    return "unit", f"{what} multiplied by {'-' if factor < 0 else ''}1e{round(power)}", "use kg, m, kg m², N m"


def _rounded(x: float) -> float:
    """The round number (integer, power of ten) next to x, or x."""
    if abs(x - round(x)) < ROUND * max(1.0, abs(x)):
        return float(round(x))
    if x > 0 and abs(np.log10(x) - round(np.log10(x))) < ROUND:
        return float(10.0 ** round(np.log10(x)))
    return float(x)


def _factor_said(name: str, factor: float) -> str:
    factor = _rounded(factor)
    have, are = ("has", "is") if name.startswith(("the term ", "the gradient ")) else ("have", "are")
    if factor == 0:
        return f"{name} {are} left out"
    if factor == -1:
        return f"{name} {have} the opposite sign"
    return f"{name} {are} multiplied by {factor:.4g}"
