"""Table 2, masses and moments of inertia from the geometry; Tables 3 and 4, the identification; motion of section 3.1.

The identification has five samples, with exact data and with rounded ones. The paper had seven significant digits of
every measurement. How they were rounded is not known, so several ways are tried and shown: two roundings of the exact
data, and noise of one unit of the seventh digit before the rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crosscheck.paper.printed import SAMPLE_TIMES, TABLE_2, TABLE_3, TABLE_4, Printed
from graphdyn import BaseMotion, RobotModel, VirtualRecording, kr500, kr500_experiment
from graphdyn.experiments import BODY_LENGTHS, BODY_RADII, RAIL_ACCELERATION
from graphdyn.identification import EPS, identify_principal_parameters, identify_principal_parameters_together
from graphdyn.layout import BODY_DOF, LINEAR, Array

WHY_TABLE_2 = (
    "Nothing differs: homogeneous steel cylinders of 7801 kg/m³ give every printed digit. The row labels J_i1 and J_i2 "
    "of the paper are J_11 and J_22 (B8)."
)


@dataclass(frozen=True, eq=False)
class GeometryTable:
    """Table 2 and the cylinder formula; rows as printed, first the lengths and radii, which are given.

    ours: not rounded                                       (6, 6)  [m, kg, kg m²]
    """

    rows: tuple[str, ...]
    printed: tuple[tuple[Printed, ...], ...]
    ours: Array

    @property
    def texts(self) -> tuple[tuple[str, ...], ...]:
        """Our numbers with the decimal places of the paper."""
        return tuple(
            tuple(f"{value:.{number.decimal_places}f}" for value, number in zip(values, numbers, strict=True))
            for values, numbers in zip(self.ours, self.printed, strict=True)
        )

    @property
    def differing(self) -> int:
        """Number of entries that differ in any printed digit."""
        return sum(
            text != number.text
            for texts, numbers in zip(self.texts, self.printed, strict=True)
            for text, number in zip(texts, numbers, strict=True)
        )


def geometry_table() -> GeometryTable:
    """Table 2 of graphdyn.kr500()."""
    bodies = kr500().bodies
    moments = np.array([np.diag(body.inertia) for body in bodies]).T
    ours = np.vstack([BODY_LENGTHS, BODY_RADII, [body.mass for body in bodies], moments])
    return GeometryTable(tuple(TABLE_2.rows), tuple(TABLE_2.rows.values()), ours)


def joint_motion(time: float) -> tuple[Array, Array, Array]:
    """q, v, a (6,) at a time [s]."""
    recording = kr500_experiment([time])
    return recording.q[0], recording.v[0], recording.a[0]


def rail(time: ArrayLike) -> BaseMotion:
    """The carriage at times (…) [s], from rest."""
    t = np.asarray(time, dtype=float)[..., None]
    acceleration = np.zeros((*t.shape[:-1], BODY_DOF))
    acceleration[..., 0] = RAIL_ACCELERATION
    path = t**2 / 2 * acceleration[..., LINEAR]
    return BaseMotion(translation=path, velocity=t * acceleration, acceleration=acceleration)


MEASURED_DIGITS = 7
"""Significant digits of the paper's measurements."""

PRINTED_ROUNDING = 10.0 ** (1 - MEASURED_DIGITS)
"""Relative rounding of a number of seven digits; also the precision of the data that the solver assumes."""

NOISE_SHARE = PRINTED_ROUNDING / 10
"""Standard deviation of the noise, as a part of a channel's root mean square: one unit of the seventh digit of a number
that begins with 9, a tenth of one that begins with 1."""

SEEDS = range(10)

TABLE_ROUNDING = 1.5e-4
"""Largest difference of Table 4 from Table 3 minus Table 2 by rounding: three numbers of four decimal places."""

WHY_TABLE_3 = (
    "Exact data give the true parameters; seven digits leave errors of the size of Table 4 or smaller. B_1 turns about "
    "e_1 only, so that the motion does not determine its m(e_2), J_22 and J_33: the printed 982.8120 of J_22 and J_33 "
    "is the cylinder formula with the mean identified mass. J_33 of B_4 is misprinted (B5): Table 4 gives 5.6419."
)


@dataclass(frozen=True, eq=False)
class PaperTrial:
    """One identification.

    data: which data
    values: rows as Table 3, columns B_1 … B_6; NaN where the data do not determine them        (6, 6)  [kg, kg m²]
    errors: values minus true ones                          (6, 6)  [kg, kg m²]
    standard_deviations: estimated from the residual        (6, 6)  [kg, kg m²]
    undetermined: names of the parameters that the data do not determine; rank: of 36 columns
    condition_number: the worst of the systems, on what they determine
    """

    data: str
    values: Array
    errors: Array
    standard_deviations: Array
    undetermined: tuple[str, ...]
    rank: int
    condition_number: float

    def largest(self, entries: NDArray[np.bool_]) -> float:
        """Largest absolute error of these entries."""
        return float(np.abs(self.errors[entries]).max())

    def rms(self, entries: NDArray[np.bool_]) -> float:
        """Root mean square error of these entries."""
        return float(np.sqrt(np.mean(self.errors[entries] ** 2)))


@dataclass(frozen=True, eq=False)
class PaperIdentification:
    """Tables 3 and 4 beside our identifications.

    true: from density and geometry                         (6, 6)  [kg, kg m²]
    printed, printed_errors: Tables 3 and 4, misprints corrected        (6, 6)
    exact, together: from exact data, body by body (Eq. 56) and in one block-diagonal system (Eq. 64)
    rounded: from data of seven digits: two roundings, then noise by seed
    implied_moment: J_22 and J_33 of B_1 by the cylinder formula with the mean of its printed masses [kg m²]
    """

    true: Array
    printed: Array
    printed_errors: Array
    exact: PaperTrial
    together: PaperTrial
    rounded: tuple[PaperTrial, ...]
    implied_moment: float

    @property
    def compared(self) -> NDArray[np.bool_]:
        """Entries that the data determine and that the paper prints (6, 6)."""
        return np.isfinite(self.exact.values) & np.isfinite(self.printed)

    @property
    def printed_largest(self) -> float:
        """Largest absolute error of Table 4 over the compared entries [kg, kg m²]."""
        return float(np.abs(self.printed_errors[self.compared]).max())

    @property
    def printed_rms(self) -> float:
        """Root mean square of these errors [kg, kg m²]."""
        return float(np.sqrt(np.mean(self.printed_errors[self.compared] ** 2)))

    @property
    def exact_error(self) -> float:
        """Largest relative error from exact data over the compared entries, both ways."""
        relative = [np.abs(trial.errors / self.true)[self.compared] for trial in (self.exact, self.together)]
        return float(np.max(relative))

    @property
    def rounded_largest(self) -> float:
        """Largest absolute error of all trials with rounded data."""
        return float(np.max([trial.largest(self.compared) for trial in self.rounded]))

    @property
    def rounded_rms(self) -> float:
        """Root mean square error of the worst trial with rounded data."""
        return float(np.max([trial.rms(self.compared) for trial in self.rounded]))

    @property
    def contradictions(self) -> tuple[tuple[int, int], ...]:
        """Entries of Table 4 that are not Table 3 as printed minus Table 2 (row, column)."""
        printed = np.array([[float(n.text) if n.text else np.nan for n in row] for row in TABLE_3.rows.values()])
        gap = np.abs(printed - _table_2() - TABLE_4.values)
        return tuple((int(i), int(j)) for i, j in np.argwhere(gap > TABLE_ROUNDING))


def identify() -> PaperIdentification:
    """All trials; the data are graphdyn's experiment at the five times of the paper."""
    model, data = kr500(), kr500_experiment(SAMPLE_TIMES)
    true = np.array([[body.mass] * 3 + list(np.diag(body.inertia)) for body in model.bodies]).T
    rounded = [
        _trial("7 digits, to the nearest", model, data.rounded(MEASURED_DIGITS), true, PRINTED_ROUNDING),
        _trial("7 digits, truncated", model, data.rounded(MEASURED_DIGITS, "truncated"), true, PRINTED_ROUNDING),
    ]
    for seed in SEEDS:
        noisy = data.noisy(seed, relative=NOISE_SHARE).rounded(MEASURED_DIGITS)
        rounded.append(_trial(f"7 digits, noise seed {seed}", model, noisy, true, PRINTED_ROUNDING))
    masses, length, radius = TABLE_3.values[:3, 0], TABLE_2.values[0, 0], TABLE_2.values[1, 0]
    return PaperIdentification(
        true,
        TABLE_3.values,
        TABLE_4.values,
        _trial("exact, body by body", model, data, true, EPS),
        _trial("exact, all bodies in one system", model, data, true, EPS, together=True),
        tuple(rounded),
        float(np.nanmean(masses) * (3 * radius**2 + length**2) / 12),
    )


def _trial(
    name: str, model: RobotModel, data: VirtualRecording, true: Array, precision: float, *, together: bool = False
) -> PaperTrial:
    solve = identify_principal_parameters_together if together else identify_principal_parameters
    found = solve(model, data, precision=precision)
    return PaperTrial(
        name,
        found.values.T,
        found.values.T - true,
        found.standard_deviations.T,
        found.undetermined,
        found.rank,
        found.condition_number,
    )


def _table_2() -> Array:
    """The true values of Table 3, as Table 2 prints them (6, 6)."""
    mass, *moments = TABLE_2.values[2:]
    return np.stack([mass, mass, mass, *moments])
