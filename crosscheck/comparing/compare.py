"""The cross-check of one robot: graphdyn against Pinocchio, number by number."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Unpack

import numpy as np
from threadpoolctl import threadpool_limits

from crosscheck.comparing.baseline import compare_identification
from crosscheck.comparing.compared_states import ComparedStates
from crosscheck.comparing.comparison import Comparison
from crosscheck.comparing.conditioning import rank_errors
from crosscheck.comparing.coupled import coupled_case, coupled_errors
from crosscheck.comparing.error_record import ErrorTable
from crosscheck.comparing.looped import looped_case, looped_errors, why_not_closed
from crosscheck.quantities import COMPARED, LOOPED, RECURSIVE, TabulatedQuantity
from crosscheck.quantities.states import RANDOM, Case, cases, has_mass
from crosscheck.reference.pinocchio_model import PinocchioModel, PinocchioRefuses
from crosscheck.reference.subject import Robot, Subject, check_counts, subject
from graphdyn import RobotModel, SingularMassMatrix, forward_dynamics, mass_matrix
from graphdyn.arguments import MANY_SAMPLES, reproducible
from graphdyn.compiler import interpreted
from graphdyn.equations import singular
from graphdyn.layout import Array
from urdf import Reading, ReadingKeywords

log = logging.getLogger(__name__)

CHUNK_STATES = 250
"""Number of states handled at once: their dense 11n × 11n systems take some tens of megabytes."""

Progress = Callable[[str, int], None]
"""Called with the name of a case and the number of states just done."""


@reproducible()
def compare(
    robot: Robot,
    samples: int = 1000,
    seed: int = 0,
    *,
    progress: Progress | None = None,
    **reading: Unpack[ReadingKeywords],
) -> Comparison:
    """Compare all quantities at random and at special states.

    Pinocchio's model of the robot is made in two ways, called routes: "urdf", where Pinocchio reads the same file, and
    "model", where it is built from our RobotModel.

    robot: name (urdf.robots), path of a URDF (both routes), or RobotModel (route "model" only, and notes say so)
    samples: random states, to which the special ones are added. From 1000 on the recursive method is compiled, as it is
        for batches of that size; with fewer it runs on NumPy
    reading: as in urdf.load, for names and paths only

    Where joints drive each other (RobotModel.couplings), the quantities are those of the robot without couplings, and a
    few more (quantities.COUPLED) compare the coupled one with their projection. Where chords close loops, they are
    those of the tree, and a few more (quantities.LOOPED) compare the closed robot with constraintDynamics.

    Raises InvalidInput for invalid samples or seed, and for a way to read a RobotModel; urdf's errors for a file that
    cannot be loaded; InconsistentState, before anything is compared, where loops cannot be closed or close only when
    stretched.

    >>> import crosscheck
    >>> comparison = crosscheck.compare("kr500", samples=2)  # 1000, if left out
    >>> comparison.agrees
    True
    >>> comparison.quantities["inverse_dynamics"].agrees
    True
    """
    check_counts(samples, seed)
    compared = subject(robot, Reading.of(compare, reading))
    coupled, looped = compared.model.opened, compared.model.uncoupled
    why_open = why_not_closed(looped)
    closed = None if why_open or not looped.chords else looped_case(looped, samples, seed)  # refuses before it all
    model = coupled.uncoupled
    compared = replace(compared, model=model)
    natives, notes = pinocchio_models(compared)
    record = ErrorTable()
    reason = why_not_forward(model)
    skipped = {name: reason for name, quantity in COMPARED.items() if quantity.solves and reason}
    compiled = nullcontext() if samples >= MANY_SAMPLES else interpreted()
    with compiled, threadpool_limits(limits=1, user_api="blas"):  # threads slow down matrices this small
        for number, chunk in enumerate(_chunks(model, samples, seed)):
            # derivatives in the first chunk only: complex steps take long
            _compare_chunk(record, chunk, natives, with_forward=reason is None, derive=number == 0)
            if progress:
                progress(chunk.name, len(chunk.q))
        if coupled.couplings:
            errors = partial(coupled_errors, forward=reason is None)
            log.info("comparing couplings")
            record.add_of_routes(coupled_case(coupled, samples, seed), errors, natives)
        if looped.chords:
            log.info("comparing loops")
            notes.append(f"chords close loops: {', '.join(LOOPED)} are those of the robot, all others of its tree")
            if why_open:
                skipped |= dict.fromkeys(LOOPED, why_open)
            elif closed is not None:
                record.add_of_routes(closed, looped_errors, natives)
        log.info("identifying base parameters")
        identification = compare_identification(model, natives["model"], seed) if has_mass(model) else None
    notes += record.singular_notes()
    if identification:
        record.add_identification(identification)
    else:
        skipped |= {
            name: "no body has mass: kinematics only" for name, quantity in COMPARED.items() if quantity.massive
        }
        notes.append("no body has mass: torques, wrenches and bias are compared but vanish on both sides")
    assert record.conditioning is not None
    quantities = record.results()
    if not all(quantity.agrees for quantity in quantities.values()):
        notes += [note for pinocchio in natives.values() for note in _reader_wrote(pinocchio.said)]
    return Comparison(
        robot=compared.name,
        file=compared.file,
        file_sha256=compared.file_sha256,
        model=model,
        n_bodies=model.n_bodies,
        samples=samples,
        seed=seed,
        reading=compared.reading,
        routes=tuple(natives),
        quantities=quantities,
        not_compared=skipped,
        conditioning=record.conditioning,
        identification=identification,
        notes=tuple(notes),
    )


def count_states(robot: Robot, samples: int, seed: int, reading: Reading) -> int:
    """Number of states that are compared: drawing them takes a hundredth of the time of comparing them."""
    with warnings.catch_warnings(action="ignore"):  # the comparison loads the robot again and shows them
        model = subject(robot, reading).model.uncoupled.opened
    return sum(len(case.q) for case in cases(model, samples, seed))


def pinocchio_models(compared: Subject) -> tuple[dict[str, PinocchioModel], list[str]]:
    """Pinocchio's models by route, and notes about a route that is not taken."""
    natives = {"model": PinocchioModel.from_model(compared.model)}
    if not compared.file:
        return natives, ["route 'urdf' not taken: a RobotModel was given, not a file"]
    try:
        native = PinocchioModel.from_urdf(Path(compared.file), compared.model, compared.reading)
    except PinocchioRefuses as refusal:
        return natives, [f"route 'urdf' not taken: {refusal}", *_reader_wrote(refusal.said)]
    return {"urdf": native, **natives}, []


def _reader_wrote(said: Iterable[str]) -> list[str]:
    return [f"Pinocchio's reader wrote: {line}" for line in said]


def _chunks(model: RobotModel, samples: int, seed: int) -> Iterator[Case]:
    for case in cases(model, samples, seed):
        for start in range(0, len(case.q), CHUNK_STATES):
            yield case.rows(slice(start, start + CHUNK_STATES))


def _compare_chunk(
    record: ErrorTable,
    chunk: Case,
    pinocchio_models: Mapping[str, PinocchioModel],
    *,
    with_forward: bool,
    derive: bool,
) -> None:
    """Record all errors at these states; what solves for accelerations only where the mass matrix is regular.

    derive: whether derivatives, energies and what belongs to them are compared here
    """
    regular = ~singular(mass_matrix(chunk.model, chunk.q)) if with_forward else np.zeros(len(chunk.q), dtype=bool)
    if with_forward:
        record.count_singular(chunk.name, ~regular)
    quantities = list(_compared_at(chunk, derive))
    shared = None
    for route, pinocchio in pinocchio_models.items():
        states = ComparedStates.of(chunk, regular, pinocchio, shared)
        shared = shared or states
        for number, quantity in enumerate(quantities, start=1):
            if not quantity.solves and (route == "urdf" or not quantity.row.from_file):
                log.info("%d of %d, %s", number, len(quantities), quantity.name)
                at = states.few if quantity.form.when == "few" else states
                record.add(route, at.case, {quantity.name: at.errors(quantity)})
        if regular.any():
            record.add(route, states.solvable.case, _solved_errors(states.solvable, quantities))
    log.info("ranks and condition numbers")
    errors, conditioning = rank_errors(states)
    record.add("model", chunk, errors)
    record.condition(conditioning)


def _compared_at(chunk: Case, derive: bool) -> Iterator[TabulatedQuantity]:
    """What of the table is compared at these states."""
    recursive = chunk.name == RANDOM  # compiled for one model: the special cases have many
    for quantity in COMPARED.values():
        if not isinstance(quantity, TabulatedQuantity):
            continue
        if (
            (derive or quantity.form.when == "all")
            and (recursive or not quantity.name.endswith(RECURSIVE))
            and (has_mass(chunk.model) or not quantity.massive)
            and (chunk.model.frames or not quantity.row.from_file)
        ):
            yield quantity


def _solved_errors(states: ComparedStates, quantities: Iterable[TabulatedQuantity]) -> dict[str, Array]:
    """Errors of what needs a regular mass matrix; infinite where a system is exactly singular: the ranks show the
    reason."""
    errors = {}
    solved = [quantity for quantity in quantities if quantity.solves]
    try:
        for number, quantity in enumerate(solved, start=1):
            log.info("solved %d of %d, %s", number, len(solved), quantity.name)
            errors[quantity.name] = states.errors(quantity)
    except np.linalg.LinAlgError:
        return {quantity.name: np.full(len(states.q), np.inf) for quantity in solved}
    return errors


def why_not_forward(model: RobotModel) -> str | None:
    """Why forward dynamics cannot be compared, or None. Tested at random states, which avoid special poses."""
    q, v = model.random_state(np.random.default_rng(0), 10)
    try:
        forward_dynamics(model, q, v, np.zeros_like(q))
    except SingularMassMatrix as error:
        return str(error)
    return None
