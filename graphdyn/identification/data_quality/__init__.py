"""Data quality of a recording before the identification: its faults, and faults that it cannot reveal."""

from graphdyn.identification.data_quality.causes.additions import Addition
from graphdyn.identification.data_quality.causes.changes import Change, RecordedColumns
from graphdyn.identification.data_quality.channels.channels import Channels, common_rate
from graphdyn.identification.data_quality.channels.held_channels import MAX_FEW_VALUES, HeldValues, held_values
from graphdyn.identification.data_quality.channels.measured_torque import Gains
from graphdyn.identification.data_quality.delays.torque_delays import MIN_DELAY, Lag
from graphdyn.identification.data_quality.fits.bounded_fit import contradictions
from graphdyn.identification.data_quality.fits.thinning import Piece, TooShort
from graphdyn.identification.data_quality.recording_quality import (
    Excitation,
    RecordingQuality,
    assess_recording,
    excitation,
)
from graphdyn.identification.data_quality.search.deciding import DataFault
from graphdyn.identification.data_quality.search.gravity_search import FoundGravity, found_gravity
from graphdyn.identification.data_quality.search.searching import MAX_RATE_GAIN_ERROR
from graphdyn.identification.data_quality.visible import VisibleSizes

__all__ = [
    "MAX_FEW_VALUES",
    "MAX_RATE_GAIN_ERROR",
    "MIN_DELAY",
    "Addition",
    "Change",
    "Channels",
    "DataFault",
    "Excitation",
    "FoundGravity",
    "Gains",
    "HeldValues",
    "Lag",
    "Piece",
    "RecordedColumns",
    "RecordingQuality",
    "TooShort",
    "VisibleSizes",
    "assess_recording",
    "common_rate",
    "contradictions",
    "excitation",
    "found_gravity",
    "held_values",
]
