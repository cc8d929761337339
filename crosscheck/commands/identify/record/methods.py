"""What `graphdyn identify 2` says of a method: its answer, and the errors of its prediction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from crosscheck.identifying.results.identified_model import IdentifiedModel
from crosscheck.identifying.results.recommending import mean_error
from crosscheck.report.record_fields import Number, taken
from graphdyn.identification import MethodResult, ResidualStatistics


@dataclass(frozen=True, kw_only=True)
class SizesRecord:
    """Sizes of residuals."""

    count: Sequence[int]
    """Rows, per joint, in the order of joint_names."""

    mean: Sequence[Number]
    """Of predicted minus measured torque, per joint, in the order of joint_names [N m or N]."""

    rms: Sequence[Number]
    """Root mean square of it, per joint, in the order of joint_names [N m or N]."""

    largest: Sequence[Number]
    """Largest absolute value of it, per joint, in the order of joint_names [N m or N]."""

    relative: Sequence[Number]
    """‖e‖ / ‖τ‖ with the measured torque, per joint, in the order of joint_names."""


@dataclass(frozen=True, kw_only=True)
class StatisticsRecord:
    """Sizes of the residuals; null where there are none."""

    everything: SizesRecord
    """Over all rows."""

    moving: SizesRecord
    """Per joint over its rows with |v| > 0.02 rad/s or m/s."""

    durbin_watson: Sequence[Number]
    """2 for white noise, per joint, in the order of joint_names."""

    ljung_box_p: Sequence[Number]
    """Below 0.05: not white, per joint, in the order of joint_names; null where several trials were put together."""

    correlation_length: Sequence[Number]
    """Rows after which the autocorrelation has fallen to 1/e, 0 for a white residual, per joint, in the order of
    joint_names; null where several trials were put together.
    """


@dataclass(frozen=True, kw_only=True)
class MethodRecord:
    """One method."""

    name: str
    """As in the tables."""

    reference: str
    """Where it is published."""

    assumptions: str
    """What has to hold."""

    needs: str
    """What has to be measured."""

    failure: str | None
    """Why there is no answer; null where there is one."""

    seconds: Number
    """Of the estimation [s]."""

    mean_error: Number
    """Mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows."""

    held_out: StatisticsRecord | None
    """Errors on the predicted rows, of all trials together."""

    training: StatisticsRecord | None
    """Errors on the rows of the fit, slow ones included."""

    fitted_relative: Sequence[Number] | None
    """‖e‖ / ‖τ‖ over the rows that counted in the fit, per joint, in the order of joint_names."""

    parameters: Sequence[Number] | None
    """Standard parameters."""

    base_values: Sequence[Number] | None
    """Base parameters."""

    standard_deviations: Sequence[Number] | None
    """Of the base parameters, for white noise."""

    block_deviations: Sequence[Number] | None
    """The same, allowing for correlation in time: jackknife over time blocks."""

    relative_deviations: Sequence[Number] | None
    """100 block_deviations / |value| [%]."""

    noise: Sequence[Number] | None
    """Standard deviation of the torque as the method sees it, per joint, in the order of joint_names [N m or N]."""

    iterations: int | None
    """How often the equations were solved."""

    settings: Mapping[str, Number]
    """Numbers that the method chose."""

    remarks: Sequence[str]
    """What the reader has to know."""

    consistent: bool | None
    """Every link can be a real body."""

    pseudo_inertia_eigenvalues: Sequence[Number] | None
    """The smallest of every link."""

    positive_definite: int | None
    """Poses with a positive definite mass matrix."""

    poses: int | None
    """Poses that were tried."""

    smallest_mass_matrix_eigenvalue: Number
    """Over all poses [kg m² or kg]."""


def method_record(found: IdentifiedModel, result: MethodResult) -> MethodRecord:
    estimate, plausible = result.estimate, result.plausibility
    answered = estimate is not None and plausible is not None
    return taken(
        MethodRecord,
        result,
        mean_error=mean_error(result) if answered else None,
        held_out=_statistics(result.held_out),
        training=_statistics(result.training),
        fitted_relative=found.fitted_errors(result) if answered else None,
        parameters=estimate.parameters if estimate else None,
        noise=estimate.noise if estimate else None,
        iterations=estimate.iterations if estimate else None,
        settings=estimate.settings if estimate else {},
        remarks=estimate.remarks if estimate else (),
        consistent=plausible.consistent if plausible else None,
        pseudo_inertia_eigenvalues=plausible.pseudo_inertia_eigenvalues if plausible else None,
        positive_definite=plausible.positive_definite if plausible else None,
        poses=len(plausible.mass_matrix_eigenvalues) if plausible else None,
        smallest_mass_matrix_eigenvalue=plausible.mass_matrix_eigenvalues.min() if plausible else None,
    )


def _statistics(statistics: ResidualStatistics | None) -> StatisticsRecord | None:
    if statistics is None:
        return None
    return taken(
        StatisticsRecord,
        statistics,
        everything=taken(SizesRecord, statistics.everything),
        moving=taken(SizesRecord, statistics.moving),
    )
