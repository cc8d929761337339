"""A recording with what its user knows: the robot, the terms of the torque, and the preparation."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from identified.spoilt_recordings.materials import material

from crosscheck.identifying import Preparation
from crosscheck.recordings import Recording
from graphdyn import RobotModel
from graphdyn.identification import Samples, TorqueModel
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.identification.data_quality.fits.thinning import ThinnedRecording
from graphdyn.identification.terms.term import CarriesBodies


@dataclass(frozen=True, eq=False)
class Columns:
    """q = position c_q + zero, tau = torque c_tau, with the columns c of the file, (n, n) and (n,)."""

    position: np.ndarray
    torque: np.ndarray
    zero: np.ndarray


@dataclass(frozen=True, eq=False)
class Case:
    """A recording as its user gives it to `identify`.

    model, terms, known: what the user takes for the robot and its torque
    """

    model: RobotModel
    recording: Recording
    terms: tuple
    known: tuple
    preparation: Preparation

    @classmethod
    def of(cls, name):
        """The clean recording of a material."""
        given = material(name)
        options = given.options
        recording = given.load(given.mapping)
        return cls(given.model, recording, options["terms"], options.get("known", ()), options["preparation"])

    @property
    def n(self):
        return self.recording.n_joints

    @cached_property
    def torque_model(self):
        return TorqueModel(self.model, self.terms, self.known)

    def changed(self, **arrays):
        """The case with other arrays of its recording."""
        return replace(self, recording=replace(self.recording, **arrays))

    @cached_property
    def fit(self):
        """The bounded fit by which the program decides on the data quality, and the torque that it is fitted to."""
        pieces, _ = self.preparation.pieces(self.recording)
        thinned = ThinnedRecording(pieces)
        kept = np.abs(thinned.samples.v) >= self.preparation.min_speed
        return BoundedFit.of(self.torque_model, thinned.samples, kept), thinned.samples.tau

    @cached_property
    def errors(self):
        """‖e_j‖ / ‖τ_j‖ of the bounded fit (n,)."""
        fit, tau = self.fit
        return fit.errors(tau)

    @cached_property
    def parameters(self):
        """Parameters of the bounded fit (p,)."""
        fit, tau = self.fit
        return fit.parameters(tau)

    @cached_property
    def motion(self):
        """Times (N,) and the prepared motion."""
        prepared = self.preparation.differentiated(self.recording)
        return prepared.t, Samples(prepared.q, prepared.v, prepared.a, np.zeros_like(prepared.q), time=prepared.t)

    def torque_of(self, parameters, columns=None, *, at_rest=False):
        """Torque of some columns of the torque model at the times of the recording (N, n).

        parameters: of all columns (p,); at_rest: of the positions alone
        """
        t, samples = self.motion
        if at_rest:
            samples = replace(samples, v=np.zeros_like(samples.v), a=np.zeros_like(samples.a))
        chosen = np.arange(len(parameters)) if columns is None else columns
        pieces = [samples[start : start + 2000] for start in range(0, len(t), 2000)]
        tau = np.concatenate([self.torque_model.rows(piece, chosen) @ parameters[chosen] for piece in pieces])
        return self.at_rows(tau)

    def at_rows(self, values):
        """Values at the times of the motion, interpolated to the rows of the recording (N, n)."""
        t, _ = self.motion
        return np.column_stack([np.interp(self.recording.t, t, column) for column in values.T])

    def known_torque(self):
        _, samples = self.motion
        return self.at_rows(self.torque_model.known_torque(samples))

    def columns_of(self, bodies):
        """Numbers of the columns of bodies, or of drives."""
        found = [
            np.arange(columns.start, columns.stop)
            for term, columns in self.torque_model.parts
            if isinstance(term, CarriesBodies) == bodies
        ]
        return np.concatenate(found or [np.arange(0)])

    @cached_property
    def file_columns(self):
        """Columns of the file that was read."""
        mapping = self.recording.provenance.columns
        eye = np.eye(self.n)
        position, torque, zero = eye, eye, np.zeros(self.n)
        if mapping is not None:
            zero = mapping.channels["q"].offset
            if mapping.transmission is not None:
                position = np.linalg.inv(mapping.transmission.matrix) if mapping.channels["q"].motor else eye
                torque = mapping.transmission.torque_matrix if mapping.channels["tau"].motor else eye
        return Columns(position, torque, zero)


def without_velocity(case):
    """The case of a file that holds no velocities."""
    return case.changed(v=None, a=None)


def with_velocity(case):
    """The case of a file that holds velocities."""
    if case.recording.v is not None:
        return case
    return case.changed(v=case.at_rows(case.motion[1].v))
