"""Samples as a term sees them: the motion without the measured torque."""

from __future__ import annotations

from graphdyn._errors import InvalidInput
from graphdyn.identification.samples import Samples
from graphdyn.layout import Array


class Motion(Samples):
    """Samples whose torque cannot be read.

    A part of the torque that is computed from the measured torque would explain it by itself, and where a model is only
    evaluated there is none.
    """

    def __init__(self, samples: Samples) -> None:
        self.__dict__.update(vars(samples))
        self.__dict__["_samples"] = samples

    @property
    def tau(self) -> Array:
        """Raises InvalidInput."""
        raise InvalidInput("a term reads samples.tau, the torque it is to explain; compute it from q, v and a alone")

    def __repr__(self) -> str:
        return f"Motion(q={self.q!r}, v={self.v!r}, a={self.a!r}, base={self.base!r})"

    def __getitem__(self, rows: slice) -> Motion:
        return Motion(self.__dict__["_samples"][rows])
