"""Gains of motors in JSON files."""

from __future__ import annotations

from collections.abc import Sequence

from crosscheck.identifying import FittedCurrents
from crosscheck.report.records.record import Numbers, Record, attribute
from graphdyn.identification.currents import JointGains


class GainsRecord(Record, of=JointGains):
    """Torque per unit of the recorded column, joint by joint."""

    deviations: Numbers = attribute()


class CurrentsRecord(Record, of=FittedCurrents, only=("known",)):
    """Gains that have converted recorded currents to torques.

    recordings: files that gave the gains, that with a known load last
    gains: of the joints, in the order of joint_names
    relative_residuals: of the fit of the gains, for every recording and joint
    lower_bound: the recordings are too short for standard deviations
    warnings: currents that say nothing, and joints that do not move
    base_deviations: standard deviations of the base parameters from those of the gains alone
    """

    recordings: Sequence[str] = attribute("names")
    gains: GainsRecord = attribute()
    relative_residuals: Sequence[Numbers] = attribute()
    lower_bound: bool = attribute()
    warnings: Sequence[str] = attribute()
    base_deviations: Numbers
