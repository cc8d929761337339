"""An identification as plain data; the format is described in docs/json.md."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from crosscheck.identifying.parameters import base_rows, body_rows, deviations_of
from crosscheck.identifying.recommending import mean_error
from crosscheck.identifying.result import Identified
from graphdyn._inertia import PARAMETER_NAMES
from graphdyn.identification import MethodResult, ResidualSizes, ResidualStatistics

FORMAT = "graphdyn identify 1"


def as_json(found: Identified, shown: MethodResult | None) -> dict[str, Any]:
    """Everything; arrays as lists."""
    comparison, subject = found.comparison, found.subject
    plain: dict[str, Any] = _plain(
        {
            "robot": subject.name,
            "file": subject.file,
            "file_sha256": subject.file_sha256,
            "locked": dict(subject.locked),
            "chain": subject.chain,
            "joint_names": found.torque_model.model.joint_names,
            "usable": found.usable,
            "recommended": found.recommendation.name,
            "reason": found.recommendation.reason,
            "recording": _recording(found),
            "parameters": [
                {"name": column.name, "symbol": column.symbol, "unit": column.unit}
                for column in found.torque_model.columns
            ],
            "rank": comparison.rank,
            "structural_rank": comparison.structural_rank,
            "gap": comparison.gap,
            "condition_number": comparison.condition_number,
            "base_parameters": [
                {"name": name, "unit": unit}
                for name, unit in zip(comparison.base_names, comparison.base_units, strict=True)
            ],
            "undetermined": comparison.undetermined,
            "lost": comparison.lost,
            "methods": [_method(found, result) for result in comparison.results],
            "shown": _shown(found, shown),
            "truth": found.truth,
        }
    )
    return plain


def _recording(found: Identified) -> dict[str, Any]:
    fit, test = found.division.fit, [split.test for split in found.division.trials]
    return {
        "files": fit.provenance.files,
        "mapping": fit.provenance.mapping,
        "steps": fit.provenance.steps,
        "decimate": found.preparation.decimate,
        "min_speed": found.preparation.min_speed,
        "fitted_rows": sum(len(t) for t in found.fit.times),
        "held_out": found.division.words,
        "held_out_files": list(dict.fromkeys(name for recording in test for name in recording.provenance.files)),
        "held_out_rows": sum(len(t) for trial in found.trials for t in trial.times),
        "findings": [asdict(finding) for recording in found.recordings for finding in recording.findings],
    }


def _method(found: Identified, result: MethodResult) -> dict[str, Any]:
    estimate, plausible = result.estimate, result.plausibility
    answered = estimate is not None and plausible is not None
    return {
        **{name: getattr(result, name) for name in ("name", "reference", "assumptions", "needs", "failure", "seconds")},
        "mean_error": mean_error(result) if answered else None,
        "held_out": _statistics(result.held_out),
        "training": _statistics(result.training),
        "fitted_relative": found.fitted_errors(result) if answered else None,
        "parameters": estimate.parameters if estimate else None,
        "base_values": result.base_values,
        "standard_deviations": result.standard_deviations,
        "block_deviations": result.block_deviations,
        "relative_deviations": result.relative_deviations,
        "noise": estimate.noise if estimate else None,
        "iterations": estimate.iterations if estimate else None,
        "settings": dict(estimate.settings) if estimate else {},
        "remarks": estimate.remarks if estimate else (),
        "consistent": plausible.consistent if plausible else None,
        "pseudo_inertia_eigenvalues": plausible.pseudo_inertia_eigenvalues if plausible else None,
        "positive_definite": plausible.positive_definite if plausible else None,
        "poses": len(plausible.mass_matrix_eigenvalues) if plausible else None,
        "smallest_mass_matrix_eigenvalue": plausible.mass_matrix_eigenvalues.min() if plausible else None,
    }


def _statistics(statistics: ResidualStatistics | None) -> dict[str, Any] | None:
    if statistics is None:
        return None
    return {
        "everything": _sizes(statistics.everything),
        "moving": _sizes(statistics.moving),
        "durbin_watson": statistics.durbin_watson,
        "ljung_box_p": statistics.ljung_box_p,
    }


def _sizes(sizes: ResidualSizes) -> dict[str, Any]:
    return {name: getattr(sizes, name) for name in ("count", "mean", "rms", "largest", "relative")}


def _shown(found: Identified, result: MethodResult | None) -> dict[str, Any] | None:
    """The result that the terminal shows, parameter by parameter."""
    if result is None:
        return None
    return {
        "method": result.name,
        "deviations": deviations_of(found, result)[1],
        "base_parameters": [asdict(row) for row in base_rows(found, result)],
        "bodies": [
            {
                "name": row.name,
                "cad": dict(zip(PARAMETER_NAMES, row.cad_parameters, strict=True)),
                "identified": dict(zip(PARAMETER_NAMES, row.parameters, strict=True)),
                "center_of_mass": row.center,
                "pseudo_inertia_eigenvalue": row.eigenvalue,
            }
            for row in body_rows(found, result)
        ],
    }


def _plain(value: Any) -> Any:
    """Arrays, tuples and NumPy numbers as what JSON has."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
