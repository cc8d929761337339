"""Recordings of robots: reading files of many formats, checks, filters, derivatives and splits."""

from crosscheck.recordings.errors import (
    DROPPABLE,
    AmbiguousColumns,
    BadMapping,
    BadRecordingFile,
    DirtyRecording,
    RecordingFinding,
)
from crosscheck.recordings.loading import inspect_recording, load_recording
from crosscheck.recordings.mapping.mapping import ColumnMapping, load_mapping, mapping_of
from crosscheck.recordings.parts.partitioned import PartitionedRecording
from crosscheck.recordings.parts.streaming import StreamedRecording
from crosscheck.recordings.preparation.derivatives import (
    ResidualAnalysis,
    chosen_cutoff,
    derivative,
    differentiated,
    residual_analysis,
)
from crosscheck.recordings.preparation.filtering import decimated_columns, lowpass, samples_of
from crosscheck.recordings.preparation.resampling import resampled, sampling_rate
from crosscheck.recordings.preparation.splits import (
    Split,
    fold_numbers,
    split_by_file,
    split_by_rows,
    split_by_time,
    time_folds,
)
from crosscheck.recordings.recognizing.recognized import RecognizedLog, Untold
from crosscheck.recordings.recognizing.recognizing import recognize
from crosscheck.recordings.recording import Provenance, Recording, concatenated, recording_of
from crosscheck.recordings.virtual import save_virtual_recording
from crosscheck.recordings.virtual_reading import load_virtual_recording

__all__ = [
    "DROPPABLE",
    "AmbiguousColumns",
    "BadMapping",
    "BadRecordingFile",
    "ColumnMapping",
    "DirtyRecording",
    "PartitionedRecording",
    "Provenance",
    "RecognizedLog",
    "Recording",
    "RecordingFinding",
    "ResidualAnalysis",
    "Split",
    "StreamedRecording",
    "Untold",
    "chosen_cutoff",
    "concatenated",
    "decimated_columns",
    "derivative",
    "differentiated",
    "fold_numbers",
    "inspect_recording",
    "load_mapping",
    "load_recording",
    "load_virtual_recording",
    "lowpass",
    "mapping_of",
    "recognize",
    "recording_of",
    "resampled",
    "residual_analysis",
    "samples_of",
    "sampling_rate",
    "save_virtual_recording",
    "split_by_file",
    "split_by_rows",
    "split_by_time",
    "time_folds",
]
