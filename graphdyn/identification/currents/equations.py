"""The equations of currents: what each joint's compressed equations say of gains, links, friction and loads.

Unknowns, in this order: logarithms of the gains (n,), base parameters of the links (r,), friction of every recording
and joint in units of its current, and ten parameters of every load. Friction has its own parameters in every recording:
a warmer gear is no heavier load. The signs of the gains are no unknowns: they are set beforehand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.compressed import CompressedEquations, merged
from graphdyn.identification.algebra.least_squares import orthonormal_basis
from graphdyn.identification.problem.torque_model import TorqueModel, structure
from graphdyn.identification.terms.bodies import carrier
from graphdyn.layout import BODY_PARAMETERS, Array, parameter_columns


@dataclass(frozen=True, eq=False)
@short_repr
class LoadedRecording:
    """A recording of currents, as the time blocks of a Problem, and the load that was carried.

    blocks: in the base parameters of the torque model's structure (Problem.recorded)
    load: its name; None for none. Recordings with the same name carried the same load
    """

    blocks: Sequence[CompressedEquations]
    load: str | None = None


@dataclass(frozen=True, eq=False)
@short_repr
class CurrentEquations:
    """Recordings of one robot, and the layout of their unknowns.

    torque_model: its first term is RigidBodies; the structure of all recordings
    carrier: link that carries the loads, the last one if None
    signs: of the gains: -1 where a current runs against the torque, 1 everywhere if None   (n,)
    """

    torque_model: TorqueModel
    recordings: Sequence[LoadedRecording]
    carrier: str | None = None
    signs: Array | None = None

    @cached_property
    def n_joints(self) -> int:
        """Number of joints."""
        return self.torque_model.model.nv

    @cached_property
    def loads(self) -> tuple[str, ...]:
        """Names of the loads, each once."""
        return tuple(dict.fromkeys(recording.load for recording in self.recordings if recording.load is not None))

    @cached_property
    def links(self) -> NDArray[np.int64]:
        """Base parameters that belong to links (r,)."""
        base = structure(self.torque_model).base
        return np.flatnonzero(base.independent < BODY_PARAMETERS * self.torque_model.model.n_bodies)

    @cached_property
    def load_matrix(self) -> Array:
        """Change of the links' base parameters by the ten parameters of a load (r, 10)."""
        columns = parameter_columns(carrier(self.torque_model.model, self.carrier))
        return structure(self.torque_model).base.matrix[self.links, columns]

    @cached_property
    def gain_columns(self) -> slice:
        """Places of the logarithms of the gains among the unknowns."""
        return slice(0, self.n_joints)

    @cached_property
    def link_columns(self) -> slice:
        """Places of the links' base parameters among the unknowns."""
        return slice(self.n_joints, self.n_joints + len(self.links))

    def friction_columns(self, recording: int, joint: int) -> tuple[NDArray[np.int64], slice]:
        """Base parameters that are friction of this joint, and their places among the unknowns."""
        own, start = self._friction[joint], self.link_columns.stop
        start += recording * sum(map(len, self._friction)) + sum(map(len, self._friction[:joint]))
        return own, slice(start, start + len(own))

    def load_columns(self, load: str) -> slice:
        start = self.link_columns.stop + len(self.recordings) * sum(map(len, self._friction))
        start += BODY_PARAMETERS * self.loads.index(load)
        return slice(start, start + BODY_PARAMETERS)

    @cached_property
    def torque_columns(self) -> NDArray[np.int64]:
        """Places of links and loads among the unknowns."""
        loads = [np.r_[self.load_columns(load)] for load in self.loads]
        return np.concatenate([np.r_[self.link_columns], *loads])

    @cached_property
    def size(self) -> int:
        """Number of unknowns."""
        first: int = self.link_columns.stop + len(self.recordings) * sum(map(len, self._friction))
        return first + BODY_PARAMETERS * len(self.loads)

    @cached_property
    def totals(self) -> list[CompressedEquations]:
        """The equations of every recording as a whole."""
        return [merged(recording.blocks) for recording in self.recordings]

    @cached_property
    def without_friction(self) -> list[Array]:
        """Factors of every recording, links and currents, without what friction explains (n, b + 1, r + 1)."""
        found = []
        for k, total in enumerate(self.totals):
            rows = total.factors[..., np.append(self.links, total.n_columns)]
            for joint, factor in enumerate(total.factors):
                own, _ = self.friction_columns(k, joint)
                basis = orthonormal_basis(factor[:, own], RANK_TOLERANCE)
                rows[joint] -= basis @ (basis.T @ rows[joint])
            found.append(rows)
        return found

    def per_torque(self, x: Array) -> Array:
        """Currents per torque of the joints (n,): signs over gains."""
        found: Array = np.exp(-x[self.gain_columns])
        return found if self.signs is None else self.signs * found

    def currents(self, recording: int, x: Array) -> Array:
        """The linear parameters u (n, b) with c_j = W_j u_j in a recording, for the unknowns x."""
        found = np.zeros((self.n_joints, structure(self.torque_model).base.rank))
        load = self.recordings[recording].load
        links = x[self.link_columns] + (0 if load is None else self.load_matrix @ x[self.load_columns(load)])
        for joint, per_torque in enumerate(self.per_torque(x)):
            own, places = self.friction_columns(recording, joint)
            found[joint, self.links], found[joint, own] = per_torque * links, x[places]
        return found

    def derivatives(self, recording: int, x: Array) -> Array:
        """Derivatives of `currents` by the unknowns (n, b, size)."""
        found = np.zeros((self.n_joints, structure(self.torque_model).base.rank, self.size))
        load = self.recordings[recording].load
        values = self.currents(recording, x)
        for joint, per_torque in enumerate(self.per_torque(x)):
            own, places = self.friction_columns(recording, joint)
            found[joint, self.links, joint] = -values[joint, self.links]
            found[joint, self.links, self.link_columns] = per_torque * np.eye(len(self.links))
            found[joint, own, places] = np.eye(len(own))
            if load is not None:
                found[joint, self.links, self.load_columns(load)] = per_torque * self.load_matrix
        return found

    def known_loads(self, known: Mapping[str, tuple[Array, Array]]) -> tuple[Array, Array]:
        """Rows and right side that say what is known of loads, for all unknowns."""
        rows, right = [np.zeros((0, self.size))], [np.zeros(0)]
        for load, (a, b) in known.items():
            spread = np.zeros((len(b), self.size))
            spread[:, self.load_columns(load)] = a
            rows.append(spread)
            right.append(b)
        return np.concatenate(rows), np.concatenate(right)

    @cached_property
    def _friction(self) -> list[NDArray[np.int64]]:
        """Base parameters that are friction of each joint."""
        found = structure(self.torque_model)
        friction = np.setdiff1d(np.arange(found.base.rank), self.links)
        return [friction[found.support[joint, friction]] for joint in range(self.n_joints)]
