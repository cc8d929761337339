"""The health of a recording: faults that can be seen in it, and what cannot be seen, before anything is identified."""

from graphdyn.identification.health.changes import Change
from graphdyn.identification.health.channels import Channels
from graphdyn.identification.health.excitation import Excitation, excitation
from graphdyn.identification.health.gain import Gains
from graphdyn.identification.health.lag import Lag
from graphdyn.identification.health.recorded_columns import RecordedColumns
from graphdyn.identification.health.recording_health import RecordingHealth, recording_health
from graphdyn.identification.health.searching import Fault
from graphdyn.identification.health.thinning import Piece, TooShort

__all__ = [
    "Change",
    "Channels",
    "Excitation",
    "Fault",
    "Gains",
    "Lag",
    "Piece",
    "RecordedColumns",
    "RecordingHealth",
    "TooShort",
    "excitation",
    "recording_health",
]
