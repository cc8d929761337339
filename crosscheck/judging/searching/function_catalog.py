"""The search for the fault of a function of motion, momentum or energy: the same faults, put into that function."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

import numpy as np

from crosscheck.judging.faults.catalog import families, faults
from crosscheck.judging.faults.fault import NO_NUMBERS, CodeFault, named
from crosscheck.judging.faults.file_reading import FileFaults
from crosscheck.judging.faults.link_mistakes import mistakes, shifted
from crosscheck.judging.faults.link_parameters import PlacedInertial
from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, State, torques_of
from crosscheck.judging.functions.derivatives import Derivative, Written
from crosscheck.judging.functions.reactions import JointWrenches, Multipliers
from crosscheck.judging.functions.table import formulation_of
from crosscheck.judging.observing.observation import Observation
from crosscheck.judging.searching.parameters import with_parameters
from crosscheck.judging.searching.search import Catalog
from crosscheck.judging.slips.body_wrenches import add_body_with_first_moments
from crosscheck.judging.slips.link_axes import LinkAxes
from crosscheck.judging.slips.operations import Formulation, Operations
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import Quantity
from crosscheck.quantities.measures import Chosen, linear_first
from graphdyn.layout import BODY_DOF, Array

LINEAR_FUNCTIONS = (
    *("kinetic_energy", "potential_energy", "joint_wrenches", "multipliers", "power", "body_wrenches", "momenta"),
    *("dtau_", "dwrenches_", "dmultipliers_"),
)
"""Beginnings of the names of functions that are linear in the inertial parameters."""

RECURSIONS = (LinkAxes(), LinkAxes(gravity="apart"), LinkAxes(bodies=add_body_with_first_moments))
"""The recursions of joint wrenches that are open to slips."""

UNSLIPPED = ("power", "da_dq", "da_dv")
"""Functions made of others, without operations of their own."""

PROBED_STATES = 2
"""Number of states at which it is found out which numbers a function depends on."""

EQUAL_ANSWERS = 1e-13
"""Relative difference below which two answers are one."""

PROBE = 1e-3
"""Relative change of a number that shows whether a function depends on it."""


@dataclasses.dataclass(frozen=True)
class RightRecursion:
    """A formulation without slips."""

    formulation: Formulation

    def __call__(self, code: DynamicsCode, numbers: Numbers, state: State) -> Array:
        """The answers (D, K, R)."""
        form = self.formulation
        if isinstance(form, Written):
            return form.right(code, numbers, state)
        return form(code, numbers, state, Operations([], state[0].shape[-1]))


@dataclasses.dataclass(frozen=True, eq=False)
class FunctionFaults:
    """What may be wrong with a function of a robot, however its answers are read."""

    known: Quantity
    states: JudgedStates
    faults: Sequence[CodeFault]
    families: Sequence[CodeFault]
    links: Sequence[PlacedInertial]
    catalogs: dict[tuple[str, ...], Catalog] = dataclasses.field(default_factory=dict)

    @classmethod
    def of(cls, known: Quantity, states: JudgedStates, of_file: FileFaults) -> FunctionFaults:
        model = states.model
        tried = [*faults(model), *of_file.faults]
        if not known.name.startswith(LINEAR_FUNCTIONS):
            tried += _of_links(DynamicsCode.of(model), of_file)
        return cls(known, states, tried, list(families(model)), of_file.links)

    def catalog(self, chosen: Chosen) -> Catalog:
        """Read in one way, made once."""
        key = tuple(chosen.values())
        if key not in self.catalogs:
            self.catalogs[key] = self._made(chosen)
        return self.catalogs[key]

    def _made(self, chosen: Chosen) -> Catalog:
        known, states = self.known, self.states
        form = formulation_of(known.name, states.model, states.frame, chosen)
        assert form is not None
        own = dataclasses.replace(DynamicsCode.of(states.model), recursion=RightRecursion(form))
        shown = _shown(own, state_of(known, states.trial.rows(np.arange(PROBED_STATES))))
        takes_torques = "tau" in known.arguments

        def relevant(fault: CodeFault) -> bool:
            changed = fault.change(own, fault.right if fault.starts is None else fault.starts[-1])
            if changed.answers or (takes_torques and changed.arguments):
                return False
            return bool(changed.arguments) or any(
                getattr(changed.numbers, name) is not getattr(own.numbers, name) for name in shown
            )

        at_one = state_of(known, states.trial.rows(np.arange(1)))
        tried = _differing(own, list(filter(relevant, self.faults)), at_one)
        slips = () if known.name in UNSLIPPED else tuple(_written(form))
        fitted = list(filter(relevant, self.families))
        return Catalog(own, tried, fitted, self.links, slips, known.name.startswith(LINEAR_FUNCTIONS))


def _written(form: Formulation) -> Iterator[Formulation]:
    """The ways to write a function whose operations are tried."""
    if isinstance(form, JointWrenches | Multipliers):
        yield from (dataclasses.replace(form, by=by) for by in RECURSIONS)
    elif isinstance(form, Derivative) and isinstance(form.of, JointWrenches | Multipliers):
        yield from (dataclasses.replace(form, of=dataclasses.replace(form.of, by=by)) for by in RECURSIONS)
    else:
        yield form


def _differing(own: DynamicsCode, among: Sequence[CodeFault], state: State) -> list[CodeFault]:
    """The faults that change something, one of each kind that give the same answers.

    A function that takes no velocities cannot tell the sign of a velocity from that of a motion.
    """
    said_of = {fault: next(iter(fault.say(NO_NUMBERS))) for fault in among}
    among = sorted(among, key=lambda fault: (said_of[fault].size, said_of[fault].message))
    answers = torques_of([own, *(fault.change(own, NO_NUMBERS) for fault in among)], state)[:, 0]
    size = np.abs(answers[0]).max() or 1.0
    kept: list[CodeFault] = []
    known: dict[str, list[Array]] = {}
    for fault, answer in zip(among, answers[1:], strict=True):
        alike = known.setdefault(said_of[fault].kind, [answers[0]])
        if not (np.abs(np.array(alike) - answer).max(axis=1) <= EQUAL_ANSWERS * size).any():
            alike.append(answer)
            kept.append(fault)
    return kept


def _shown(own: DynamicsCode, state: State) -> set[str]:
    """The names of the numbers that a function depends on."""
    fields = [field.name for field in dataclasses.fields(Numbers)]
    rng = np.random.default_rng(0)
    codes = [own]
    for name in fields:
        right = getattr(own.numbers, name)
        codes.append(own.but(**{name: right + PROBE * (1 + np.abs(right)) * rng.uniform(0.5, 1, right.shape)}))
    answers = torques_of(codes, state)
    return {name for name, answer in zip(fields, answers[1:], strict=True) if not np.array_equal(answer, answers[0])}


def _of_links(own: DynamicsCode, of_file: FileFaults) -> Iterator[CodeFault]:
    """Mistakes in the inertial parameters of every link, and of each."""
    links = of_file.links
    sets = [[k] for k in range(len(links))] + ([list(range(len(links)))] if len(links) > 1 else [])
    for mistake in mistakes():
        differences = mistake.differences(links)
        if not np.isfinite(differences).all():
            continue
        for members in sets:
            some = [k for k in members if differences[k].any()]
            if not some or (len(members) > 1 and len(some) == 1):
                continue
            who = "every link" if len(members) > 1 else named("link", [links[k].name for k in members])
            change = with_parameters(own, [(links[k].body, differences[k]) for k in some])
            if change is not None:
                size = 1 if len(members) == 1 else 2
                yield CodeFault.of(mistake.kind, mistake.message.format(who=who), mistake.remedy, change, size)
    for message, of_bodies in shifted(links, own):
        change = with_parameters(own, of_bodies)
        if change is not None:
            yield CodeFault.of("inertial_parameters", message, "assign them by name", change)


def as_usual(known: Quantity, answer: Array, chosen: Chosen) -> tuple[Array, Chosen]:
    """Answers with their halves and signs as usual, and how these are read: conventions of writing numbers down."""
    sign = -1.0 if chosen.get("acts on") == "the inside body" else 1.0
    usual = {name: ways[0] for name, ways in known.conventions.items() if name in ("order", "acts on")}
    return sign * linear_first(answer, chosen, known.six), {**chosen, **usual}


def state_of(known: Quantity, states: JudgedStates) -> State:
    """q, v, and a or the torques (R, n)."""
    return states.q, states.v, states.tau if "tau" in known.arguments else states.a


def observed(known: Quantity, answer: Array, states: JudgedStates, chosen: Chosen, part: str) -> Observation:
    """The answers (N, …) as rows, relative to the largest numbers of graphdyn, of each half where there are two.

    Potential energies from any zero are taken less that of the first state.
    """
    size, rows = len(states.q), np.arange(len(states.q))
    ours = known.of_graphdyn(states, chosen)
    scale = np.ones(ours.shape[1:])
    for half in _halves(known):
        largest = float(np.abs(ours[(slice(None), *half)]).max())
        scale[half] = largest or 1.0
    given, less = answer.reshape(size, -1), np.full(size, -1)
    if chosen.get("zero") == "elsewhere":
        given, less = given - given[0], np.zeros(size, dtype=np.intp)
    scales = np.broadcast_to(scale.ravel(), given.shape)
    return Observation(state_of(known, states), rows, less, given / scales, scales, np.full(size, part))


def _halves(known: Quantity) -> Sequence[tuple[slice, ...]]:
    """Places of the linear and the angular half, or of all numbers."""
    if BODY_DOF not in known.shape:
        return [tuple(slice(None) for _ in known.shape)]
    axis = known.shape.index(BODY_DOF)
    before = tuple(slice(None) for _ in range(axis))
    return [(*before, slice(0, 3)), (*before, slice(3, 6))]
