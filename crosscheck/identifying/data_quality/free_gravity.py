"""The mounting of a robot from its recordings: the direction of gravity that explains the torques best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from crosscheck.identifying.data_quality.data_quality import row_by_row
from crosscheck.identifying.methods.candidate_models import CandidateModel
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from crosscheck.reference.subject import Subject
from graphdyn.identification.data_quality import FoundGravity, found_gravity


def mounted(
    subject: Subject, candidate: CandidateModel, recordings: Sequence[Recording], preparation: Preparation
) -> tuple[Subject, FoundGravity]:
    """The robot under the gravity of its recordings. Raises InvalidInput if they fit none, or are too short."""
    pieces = [piece for recording in recordings for piece in preparation.pieces(recording)[0]]
    found = found_gravity(row_by_row(candidate.of(subject.model)), pieces, preparation.min_speed)
    model, reading = subject.model.with_gravity(found.gravity), replace(subject.reading, gravity=found.gravity)
    return replace(subject, model=model, reading=reading), found
