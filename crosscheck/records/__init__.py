"""Recordings: read from files as they are found in the wild, checked, filtered, differentiated and split."""

from crosscheck.records.errors import AmbiguousColumns, BadMapping, BadRecordingFile, DirtyRecording
from crosscheck.records.findings import DROPPABLE, Finding
from crosscheck.records.loading import inspect_record, load_record
from crosscheck.records.mapping import ColumnMapping, load_mapping
from crosscheck.records.record import Provenance, Record, concatenated, record_of
from crosscheck.records.recording_files import load_recording, save_recording
