"""Parameters that drift with time or temperature.

Friction of gears changes by a factor of two while their grease warms up: Simoni, Beschi, Legnani and Visioli, "Friction
modeling with temperature effects for industrial robot manipulators", IEEE/RSJ IROS 2015.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.term import Term, TermParameter
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

DRIFT_UNITS = {"time": "s", "temperature": "K"}


@dataclass(frozen=True, eq=False)
class Drift:
    """An addition to a term in proportion to time or temperature: its torque is W x' (s - reference), that of the term
    W x.

    Use it together with the term itself, whose parameters are then those at the reference.
    term: with one column per joint, such as Viscous()
    over: variable of the drift: samples.time [s], or samples.temperature of each joint [°C]
    reference: [s or °C]
    """

    term: Term
    over: Literal["time", "temperature"] = "time"
    reference: float = 0.0

    @property
    def has_memory(self) -> bool:
        """Whether the term has memory."""
        return getattr(self.term, "has_memory", False)

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        if self.over not in DRIFT_UNITS:
            raise InvalidInput(f"a drift is over '{self.over}'; use {' or '.join(DRIFT_UNITS)}")
        return tuple(
            TermParameter(
                f"{column.name} per {self.over}",
                f"{column.symbol}/{DRIFT_UNITS[self.over]}",
                f"{column.unit}/{DRIFT_UNITS[self.over]}",
            )
            for column in self.term.columns(model)
        )

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        values = samples.time if self.over == "time" else samples.temperature
        if values is None:
            raise InvalidInput(
                f"the torque model has a drift over {self.over}, which the samples lack; map its column, or leave the "
                "drift out"
            )
        factor = values - self.reference
        if factor.ndim == 1:
            factor = factor[:, None]
        return self.term.rows(model, samples) * factor[:, :, None]
