"""Recordings: read from files as they are found in the wild, checked, filtered, differentiated and split."""

from crosscheck.records.decimation import decimated, decimated_columns
from crosscheck.records.derivatives import chosen_cutoff, derivative, differentiated
from crosscheck.records.errors import AmbiguousColumns, BadMapping, BadRecordingFile, DirtyRecording
from crosscheck.records.filtering import lowpass
from crosscheck.records.findings import DROPPABLE, Finding
from crosscheck.records.loading import inspect_record, load_record
from crosscheck.records.mapping import ColumnMapping, load_mapping, mapping_of
from crosscheck.records.noise_floor import ResidualAnalysis, residual_analysis
from crosscheck.records.record import Provenance, Record, concatenated, record_of
from crosscheck.records.recording_files import load_recording, save_recording
from crosscheck.records.resampling import resampled, sampling_rate
from crosscheck.records.splits import Split, fold_numbers, split_by_file, split_by_rows, split_by_time, time_folds
from crosscheck.records.streaming import StreamedRecording

__all__ = [
    "DROPPABLE",
    "AmbiguousColumns",
    "BadMapping",
    "BadRecordingFile",
    "ColumnMapping",
    "DirtyRecording",
    "Finding",
    "Provenance",
    "Record",
    "ResidualAnalysis",
    "Split",
    "StreamedRecording",
    "chosen_cutoff",
    "concatenated",
    "decimated",
    "decimated_columns",
    "derivative",
    "differentiated",
    "fold_numbers",
    "inspect_record",
    "load_mapping",
    "load_record",
    "load_recording",
    "lowpass",
    "mapping_of",
    "record_of",
    "resampled",
    "residual_analysis",
    "sampling_rate",
    "save_recording",
    "split_by_file",
    "split_by_rows",
    "split_by_time",
    "time_folds",
]
