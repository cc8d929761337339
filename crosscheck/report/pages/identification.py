"""The page of an identification: what the recording determines, how each method predicts, which model to use."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from markupsafe import Markup

from crosscheck.identifying import Identified, TorqueCurve
from crosscheck.identifying.parameters import base_rows, body_rows, deviations_of
from crosscheck.identifying.recommending import joint_errors, mean_error, real
from crosscheck.report.pages.rendering import render
from crosscheck.report.pages.torque_curves import torque_curves
from crosscheck.report.pictures.method_errors import method_errors, singular_values
from crosscheck.report.pictures.parameter_bars import parameter_bars
from crosscheck.report.versions import versions
from graphdyn.identification import MethodResult
from graphdyn.layout import Array


@dataclass(frozen=True)
class JointPicture:
    """One joint: its name, and its torques over time."""

    name: str
    curves: Markup


def identification_page(found: Identified, shown: MethodResult | None, command: Sequence[str]) -> str:
    """One page. The same arguments and versions give the same characters but for the times that methods took.

    shown: the result whose torques and parameters are drawn; None where no method has an answer
    command: the arguments that made it
    """
    answered = [result for result in found.comparison.results if result.failure is None]
    joints = found.torque_model.model.joint_names
    rows = base_rows(found, shown) if shown is not None else []
    return render(
        "identification.html",
        found=found,
        name=Path(found.subject.name).name,
        comparison=found.comparison,
        shown=shown,
        results=[(result, mean_error(result), real(result)) for result in found.comparison.results],
        joints=joints,
        fitted={result.name: found.fitted_errors(result) for result in answered},
        slow=bool(np.any(np.asarray(found.preparation.min_speed) > 0)),
        errors=method_errors("methods", [r.name for r in answered], joints, _errors(answered)) if answered else None,
        excitation=singular_values("excitation", _singular_values(found)),
        pictures=_joint_pictures(found, shown) if shown is not None else [],
        rows=rows,
        bars=parameter_bars("parameters", rows, _sizes(found)) if rows else None,
        deviations=deviations_of(found, shown)[1] if shown is not None else "",
        bodies=body_rows(found, shown) if shown is not None else [],
        command=shlex.join(command),
        versions=versions(),
    )


def _errors(results: Sequence[MethodResult]) -> Array:
    """Relative held-out errors, training errors where nothing was held out (m, n)."""
    chosen = [result.held_out or result.training for result in results]
    return np.array([joint_errors(statistics) for statistics in chosen if statistics is not None])


def _joint_pictures(found: Identified, shown: MethodResult) -> list[JointPicture]:
    fitted = found.fit.curves(shown.name)
    ahead: list[TorqueCurve] = [curve for trial in found.trials for curve in trial.curves(shown.name)]
    return [
        JointPicture(
            joint.name,
            torque_curves(f"joint-{j}", joint.name, j, fitted, ahead, "N" if joint.is_prismatic else "N m"),
        )
        for j, joint in enumerate(found.torque_model.model.joints)
    ]


def _singular_values(found: Identified) -> Array:
    """Of the regressor of the base parameters, joints weighted by their torque, columns at unit length (r,)."""
    equations = found.problem.equations
    size = np.sqrt(equations.measured_squares / np.maximum(equations.counts, 1))
    r, _ = equations.weighted(np.where(size > 0, size, 1.0))
    return np.asarray(np.linalg.svd(r / np.linalg.norm(r, axis=0), compute_uv=False))


def _sizes(found: Identified) -> Array:
    """Root mean square torque that each base parameter makes at 1, over the rows that count (r,)."""
    factors = found.problem.equations.factors[..., :-1]
    return np.asarray(np.sqrt(np.sum(factors**2, axis=(0, 1)) / found.problem.equations.counts.sum()))
