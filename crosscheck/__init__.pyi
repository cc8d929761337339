from . import identifying as identifying
from .assertions import Disagreement, WrongDynamics, assert_agrees, assert_correct
from .comparing.accuracy import TrueErrors, true_errors
from .comparing.compare import compare
from .comparing.comparison import Comparison, QuantityResult
from .distributing import DaskWorkers, LocalProcesses
from .exact import ExactArray, Proof, exact_values, prove
from .identifying import Identified, identify
from .judging.judge import judge
from .judging.judgment import Diagnosis, JudgedFunction, Judgment
from .recordings import (
    DirtyRecording,
    PartitionedRecording,
    Recording,
    StreamedRecording,
    concatenated,
    differentiated,
    inspect_recording,
    load_mapping,
    load_recording,
    load_virtual_recording,
    recording_of,
    samples_of,
    save_virtual_recording,
    split_by_file,
    split_by_rows,
    split_by_time,
    time_folds,
)

__all__ = [
    "Comparison",
    "DaskWorkers",
    "Diagnosis",
    "DirtyRecording",
    "Disagreement",
    "ExactArray",
    "Identified",
    "JudgedFunction",
    "Judgment",
    "LocalProcesses",
    "PartitionedRecording",
    "Proof",
    "QuantityResult",
    "Recording",
    "StreamedRecording",
    "TrueErrors",
    "WrongDynamics",
    "assert_agrees",
    "assert_correct",
    "compare",
    "concatenated",
    "differentiated",
    "exact_values",
    "identify",
    "identifying",
    "inspect_recording",
    "judge",
    "load_mapping",
    "load_recording",
    "load_virtual_recording",
    "prove",
    "recording_of",
    "samples_of",
    "save_virtual_recording",
    "split_by_file",
    "split_by_rows",
    "split_by_time",
    "time_folds",
    "true_errors",
]
