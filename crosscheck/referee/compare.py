"""The cross-check of one robot: graphdyn against Pinocchio, number by number."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import nullcontext
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from crosscheck.referee.baseline import compare_identification
from crosscheck.referee.comparison import Comparison, QuantityResult, WorstState
from crosscheck.referee.pinocchio_model import PinocchioModel, PinocchioRefuses
from crosscheck.referee.quantities import (
    BY_NAME,
    QUANTITIES,
    RECURSIVE,
    Conditioning,
    forward_errors,
    frame_errors,
    passive_errors,
    rank_errors,
    torque_errors,
)
from crosscheck.referee.reference_values import RefereeValues
from crosscheck.referee.states import RANDOM, Case, cases
from crosscheck.referee.subject import Lock, Robot, check_counts, subject
from graphdyn import RobotModel, SingularMassMatrix, forward_dynamics, mass_matrix
from graphdyn._methods import WORTH_COMPILING
from graphdyn._projected import singular
from graphdyn.kernels.running import interpreted
from graphdyn.layout import Array
from urdf._cutting import Chain

CHUNK = 250
"""Number of states handled at once: their dense 11n × 11n systems take some tens of megabytes."""

Progress = Callable[[str, int], None]
"""Called with the name of a case and the number of states just done."""


def compare(
    robot: Robot,
    samples: int = 1000,
    seed: int = 0,
    *,
    lock: Lock = None,
    gravity: ArrayLike | None = None,
    chain: Chain = None,
    progress: Progress | None = None,
) -> Comparison:
    """Compare all quantities at random and at special states.

    Pinocchio's model of the robot is made in two ways, called routes: "urdf", where Pinocchio reads the same file, and
    "model", where it is built from our RobotModel.

    robot: name (urdf.robots), path of a URDF (both routes), or RobotModel (route "model" only, and notes say so)
    samples: random states, to which the special ones are added. From 1000 on the recursive method is compiled, as it is
        for batches of that size; with fewer it runs on NumPy
    lock, gravity, chain: as in urdf.load, for names and paths only

    Raises InvalidInput for invalid samples or seed, and for lock, gravity or chain with a RobotModel; urdf's errors for
    a file that cannot be loaded.
    """
    check_counts(samples, seed)
    compared = subject(robot, lock, gravity, chain)
    model = compared.model
    notes = [] if compared.file else ["route 'urdf' not taken: a RobotModel was given, not a file"]
    referees = {"model": PinocchioModel.from_model(model)}
    if compared.file:
        try:
            native = PinocchioModel.from_urdf(Path(compared.file), model, compared.locked, cut=chain is not None)
            referees = {"urdf": native, **referees}
        except PinocchioRefuses as refusal:
            notes += [f"route 'urdf' not taken: {refusal}", *_reader_wrote(refusal.said)]

    record = _Record()
    reason = _why_not_forward(model)
    skipped = {quantity.name: reason for quantity in QUANTITIES if quantity.forward and reason}
    singular_states: dict[str, int] = {}
    compiled = nullcontext() if samples >= WORTH_COMPILING else interpreted()
    with compiled, threadpool_limits(limits=1, user_api="blas"):  # threads slow down matrices this small
        for case in cases(model, samples, seed):
            recursive = case.name == RANDOM  # compiled for one model: the special cases have many
            for chunk in _chunks(case):
                regular = np.zeros(len(chunk.q), dtype=bool) if reason else ~singular(mass_matrix(model, chunk.q))
                if not reason and not regular.all():
                    singular_states[case.name] = singular_states.get(case.name, 0) + int((~regular).sum())
                for route, referee in referees.items():
                    turned = referee.turned(chunk.turn, chunk.model.gravity)
                    tau = turned.rnea(chunk.q, chunk.v, chunk.a) if chunk.tau is None else chunk.tau
                    reference = turned.evaluate(chunk.q, chunk.v, chunk.a, tau, chunk.external_wrenches)
                    record.add(route, chunk, passive_errors(chunk, reference, recursive=recursive))
                    record.add(route, chunk, torque_errors(chunk, turned))
                    if route == "urdf" and model.frames:
                        record.add(route, chunk, frame_errors(chunk, turned))
                    if regular.any():
                        at = chunk.rows(regular)
                        errors = _forward_errors(at, tau[regular], reference.rows(regular), recursive=recursive)
                        record.add(route, at, errors)
                errors, conditioning = rank_errors(chunk, tau, regular)
                record.add("model", chunk, errors)
                record.condition(conditioning)
                if progress:
                    progress(case.name, len(chunk.q))
        notes += [
            f"{count} of the states '{name}' have a singular mass matrix: forward quantities left out there"
            for name, count in singular_states.items()
        ]
        identification = None
        if any(body.mass > 0 for body in model.bodies):
            identification = compare_identification(model, referees["model"], seed)
            missing = abs(identification.rank - identification.rank_there)
            error = np.inf if missing else max(identification.difference, identification.error)
            record.add_summary("model", "base_parameters", error)
        else:
            skipped["base_parameters"] = "no body has mass: kinematics only"
            notes.append("no body has mass: torques, wrenches and bias are compared but vanish on both sides")
    assert record.conditioning is not None
    quantities = record.results()
    if not all(quantity.agrees for quantity in quantities.values()):
        notes += [note for referee in referees.values() for note in _reader_wrote(referee.said)]
    return Comparison(
        robot=compared.name,
        file=compared.file,
        file_sha256=compared.file_sha256,
        model=model,
        n_bodies=model.n_bodies,
        samples=samples,
        seed=seed,
        locked=compared.locked,
        chain=compared.chain,
        routes=tuple(referees),
        quantities=quantities,
        not_compared=skipped,
        conditioning=record.conditioning,
        identification=identification,
        notes=tuple(notes),
    )


def _reader_wrote(said: Iterable[str]) -> list[str]:
    return [f"Pinocchio's reader wrote: {line}" for line in said]


def _chunks(case: Case) -> Iterable[Case]:
    for start in range(0, len(case.q), CHUNK):
        yield case.rows(slice(start, start + CHUNK))


def _forward_errors(case: Case, tau: Array, reference: RefereeValues, *, recursive: bool) -> dict[str, Array]:
    """forward_errors, infinite where a system is exactly singular: the rank quantities then show the reason."""
    try:
        return forward_errors(case, tau, reference, recursive=recursive)
    except np.linalg.LinAlgError:
        names = (quantity.name for quantity in QUANTITIES if quantity.forward and quantity.name != "kkt_rank")
        return {name: np.full(len(case.q), np.inf) for name in names if recursive or not name.endswith(RECURSIVE)}


def _why_not_forward(model: RobotModel) -> str | None:
    """Why forward dynamics cannot be compared, or None. Tested at random states, which avoid special poses."""
    q, v = model.random_state(np.random.default_rng(0), 10)
    try:
        forward_dynamics(model, q, v, np.zeros_like(q))
    except SingularMassMatrix as error:
        return str(error)
    return None


class _Record:
    """All errors so far, and the states of the largest ones."""

    def __init__(self) -> None:
        self._errors: dict[str, list[Array]] = {}
        self._by_case: dict[str, dict[str, float]] = {}
        self._by_route: dict[str, dict[str, float]] = {}
        self._worst: dict[str, tuple[float, WorstState | None]] = {}
        self.conditioning: Conditioning | None = None

    def add(self, route: str, case: Case, errors: Mapping[str, Array]) -> None:
        for name, values in errors.items():
            values = np.where(np.isnan(values), np.inf, values)
            k = int(values.argmax())
            self._note(name, route, case.name, values)
            if name not in self._worst or values[k] > self._worst[name][0]:
                self._worst[name] = float(values[k]), _worst_state(route, case, k)

    def add_summary(self, route: str, name: str, error: float) -> None:
        """Add an error that belongs to all samples together."""
        self._note(name, route, "all states", np.array([error]))
        self._worst[name] = error, None

    def condition(self, conditioning: Conditioning) -> None:
        self.conditioning = conditioning if self.conditioning is None else self.conditioning.merged(conditioning)

    def results(self) -> dict[str, QuantityResult]:
        return {
            name: QuantityResult(
                quantity,
                np.concatenate(self._errors[name]),
                self._worst[name][0],
                self._by_case[name],
                self._by_route[name],
                self._worst[name][1],
            )
            for name, quantity in BY_NAME.items()
            if name in self._worst
        }

    def _note(self, name: str, route: str, case: str, values: Array) -> None:
        self._errors.setdefault(name, []).append(values)
        for table, key in ((self._by_case, case), (self._by_route, route)):
            row = table.setdefault(name, {})
            row[key] = max(row.get(key, 0.0), float(values.max()))


def _worst_state(route: str, case: Case, k: int) -> WorstState:
    """State k of a case as plain numbers."""
    return WorstState(
        route,
        case.name,
        q=tuple(case.q[k].tolist()),
        v=tuple(case.v[k].tolist()),
        a=tuple(case.a[k].tolist()),
        tau=None if case.tau is None else tuple(case.tau[k].tolist()),
        external_wrenches=tuple(map(tuple, case.external_wrenches[k].tolist())),
        turn=tuple(map(tuple, case.turn.rotation.tolist())),
        gravity=tuple(case.model.gravity.tolist()),
    )
