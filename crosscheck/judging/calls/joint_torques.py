"""Torques of a joint that depend on its own position or velocity alone: springs, counterweights, friction.

The function itself is asked: the joint moves through its range while everything else is drawn anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.judging.calls.answered import Answered
from crosscheck.judging.calls.joint_laws import AddedLaw, of_position, of_velocity
from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.judgment import Diagnosis
from crosscheck.judging.observing.function_under_test import FunctionFailure
from crosscheck.judging.searching.found_fault import FoundFault
from crosscheck.judging.special_states import position_limits
from crosscheck.judging.states import JudgedStates
from graphdyn import inverse_dynamics
from graphdyn.layout import Array

N_SWEPT = 96
"""Number of positions, and of velocities, at which a torque is seen."""

N_VERIFIED_PAIRS = 24
"""Number of pairs of them at which it must be the sum of both."""

N_FIRST_PAIRS = 3
"""Number of pairs of position and velocity at which it must be the same twice, before all are asked."""

TORQUE_FUNCTIONS = ("inverse_dynamics", "forward_dynamics", "bias_torque", "gravity_torque", "static_torque")
"""Functions whose answers tell added torques."""

NOISE_FACTOR = 10.0
"""Torques count from so many times the bound on; sums of two deviations have the noise of both."""

ADDED_TORQUE_REMEDY = "the dynamics of rigid bodies have no such torque; switch it off for the comparison"


@dataclass(frozen=True, eq=False)
class JointTorques:
    """Torques that joints add.

    fault: in words, its laws at all judged states; None where some torque has no law
    plain: whether another search may explain the same: lines, constants and single sines of the position, and friction
        without a law
    regions: what is known without laws, in words
    """

    fault: FoundFault | None
    plain: bool
    regions: str

    def seen(self, given: Answered) -> FoundFault:
        """What is known without laws, as a fault."""
        return FoundFault(FaultDescription("joint_torque", self.regions, ADDED_TORQUE_REMEDY), np.inf, given.chosen)


def with_added_torques(diagnoses: list[Diagnosis], added: JointTorques | None) -> list[Diagnosis]:
    """Explanations by a physical fault, and the torque of one joint that gives the same answers."""
    first = diagnoses[0]
    if added is None or added.fault is None or first.kind in OWN_KINDS or len(diagnoses) > 1:
        return diagnoses
    own = added.fault.said
    apart = first.apart or "reading the code: both give the same torques"
    if len(first.numbers) <= len(own.numbers) and not first.message.startswith(MANY_NUMBERS):
        return [replace(first, status="candidate", also=(own.message, *first.also), apart=apart)]
    also = (first.message, *first.also)
    said = replace(first, kind=own.kind, message=own.message, remedy=own.remedy, numbers=own.numbers)
    return [replace(said, status="candidate", also=also, apart=apart)]


MANY_NUMBERS = ("the equations are right", "other values")
"""How messages begin that stand for many numbers."""

OWN_KINDS = ("friction", "spring", "offset", "clipped", "precision")
"""Kinds of torques that joints add, whoever names them."""


def added_torques(given: Answered) -> JointTorques | None:
    """None where a deviating torque depends on more than the motion of its joint."""
    model = given.states.model
    if given.name not in TORQUE_FUNCTIONS or model.n_bodies == 1 or not np.isfinite(given.answer).all():
        return None
    if getattr(given.function.function, "in_rounds", False):
        return None
    judged = _deviation(given, given.states, given.answer)
    room = NOISE_FACTOR * given.bound * _scale(given)
    joints = np.flatnonzero((np.abs(judged) > room).any(axis=0))
    if not len(joints) or not all(_alone(given.states, judged[:, k], int(k), room) for k in joints):
        return None
    if all(_on_lines(given.states, judged[:, k], int(k), room) for k in joints):
        return None
    found: list[Swept] = []
    try:
        if not all(_alone_at_few(given, int(k), room) for k in joints):
            return None
        for k in joints:
            if (swept := _swept(given, int(k), room)) is None:
                return None
            found.append(swept)
    except FunctionFailure:
        return None
    laws = [_laws(x, room) for x in found]
    regions = "; ".join(said for x in found if (said := x.said(model.joint_names[x.joint])))
    if any(law is None for pair in laws for law in pair):
        return JointTorques(None, plain=all(pair[0] is not None and pair[0].plain for pair in laws), regions=regions)
    known = [(x, [law for law in pair if law is not None]) for x, pair in zip(found, laws, strict=True)]
    torque = np.zeros_like(given.states.q)
    for x, pair in known:
        q, v = given.states.q[:, x.joint], given.states.v[:, x.joint]
        torque[:, x.joint] = sum(law.torque(v if law.of_velocity else q) for law in pair)
    left = np.abs(judged - torque).max() / _scale(given)
    plain = all(law.plain for _, pair in known for law in pair)
    if not left <= NOISE_FACTOR * given.bound:
        return JointTorques(None, plain=plain, regions=regions)
    said = "; ".join(
        f"{_alone_said('velocity' if law.of_velocity else 'position', model.joint_names[x.joint])}: {law.said}"
        for x, pair in known
        for law in pair
        if law.said
    )
    kind = "friction" if all(law.of_velocity or not law.said for _, pair in known for law in pair) else "spring"
    numbers = tuple(n for x, pair in known for law in pair for n in law.numbers(model.joint_names[x.joint]))
    description = FaultDescription(kind, said, ADDED_TORQUE_REMEDY, numbers=numbers)
    return JointTorques(FoundFault(description, float(left), given.chosen), plain, regions)


def _scale(given: Answered) -> float:
    """The scale of torques, the largest joint wrench [N m or N]."""
    return float(np.abs(given.states.wrenches).max()) or 1.0


def _deviation(given: Answered, states: JudgedStates, answer: Array) -> Array:
    """The torques that are added (N, n)."""
    if given.name == "forward_dynamics":
        needed = inverse_dynamics(states.model, states.q, states.v, answer, states.loads).tau
        return np.asarray(states.tau - needed)
    return np.asarray(answer - given.known.of_graphdyn(states, given.chosen))


def _alone(states: JudgedStates, torque: Array, k: int, room: float) -> bool:
    """Whether the judged states allow that the torque depends on the motion of joint k alone: at those with the same
    position and velocity it is the same."""
    pairs = np.stack([states.q[:, k], states.v[:, k]], axis=1)
    _, which = np.unique(pairs, axis=0, return_inverse=True)
    which = which.ravel()
    least, most = (np.full(which.max() + 1, x) for x in (np.inf, -np.inf))
    np.minimum.at(least, which, torque)
    np.maximum.at(most, which, torque)
    return bool((most - least).max() <= room)


def _alone_said(what: str, joint: str) -> str:
    return f"a torque that depends on the {what} of joint '{joint}' alone is added"


def _on_lines(states: JudgedStates, torque: Array, k: int, room: float) -> bool:
    """Whether the torque is a constant, lines of position and velocity, and dry friction: the catalog has these."""
    q, v = states.q[:, k], states.v[:, k]
    columns = np.stack([np.ones_like(q), q, v, np.sign(v)], axis=1)
    return bool(np.abs(columns @ np.linalg.lstsq(columns, torque, rcond=None)[0] - torque).max() <= room)


@dataclass(frozen=True, eq=False)
class Swept:
    """The torque of a joint over its positions at rest, and what its velocities add, at N_SWEPT of each."""

    joint: int
    q: Array
    at_q: Array
    v: Array
    at_v: Array
    room: float
    slides: bool

    def said(self, name: str) -> str:
        parts = []
        unit = "N" if self.slides else "N m"
        for what, torque in (("position", self.at_q), ("velocity", self.at_v)):
            if np.abs(torque).max(initial=0.0) > self.room:
                parts.append(f"{_alone_said(what, name)}, from {torque.min():.4g} to {torque.max():.4g} {unit}")
        return "; ".join(parts)


def _alone_at_few(given: Answered, k: int, room: float) -> bool:
    """Whether the torque of joint k is the same at the same position and velocity: a quick look at a few of them."""
    few = np.arange(N_FIRST_PAIRS) % len(given.states.q)
    pairs = [(given.states.q[row, k], given.states.v[row, k]) for row in (*few, *few)]
    first, again = np.split(_torque_at(given, k, pairs, np.random.default_rng(k)), 2)
    return bool(np.abs(first - again).max() <= room)


def _torque_at(given: Answered, k: int, pairs: Sequence[tuple[float, float]], rng: np.random.Generator) -> Array:
    """The torques of joint k at these positions and velocities, everything else drawn from the judged states."""
    states = given.states
    rows = rng.integers(len(states.q), size=(4, len(pairs)))
    asked = states.but(labels=np.array(""), **{
        name: getattr(states, name)[which] for name, which in zip(("q", "v", "a", "tau"), rows, strict=True)
    }, **({} if states.loads is None else {"loads": 0 * states.loads[rows[0]]}))  # fmt: skip
    asked.q[:, k], asked.v[:, k] = np.transpose(pairs)
    answer = given.function(*(getattr(asked, x) for x in given.known.arguments if x in ("q", "v", "a", "tau")))
    return _deviation(given, asked, answer)[:, k]


def _swept(given: Answered, k: int, room: float) -> Swept | None:
    """The torques of joint k; None where they are no sum of those of its position and its velocity."""
    states, rng = given.states, np.random.default_rng(k)
    lower, upper = position_limits(states.model.joints[k])
    ends = (lower, upper) if np.isfinite(upper - lower) else (-np.pi, np.pi)
    q = np.sort([*ends, *rng.uniform(*ends, N_SWEPT - 2)])  # uneven steps tell all harmonics apart
    if not q[0] < q[-1]:
        return None
    fastest = float(np.abs(states.v[:, k]).max()) or 1.0
    half = fastest * np.linspace(0, 1, N_SWEPT // 2 + 1)[1:] ** 2
    moving = "v" in given.function.arguments
    v = np.concatenate([-half[::-1], half]) if moving else np.zeros(0)
    i, j = rng.integers(len(q), size=N_VERIFIED_PAIRS), rng.integers(max(len(v), 1), size=N_VERIFIED_PAIRS)
    middle = q[N_SWEPT // 2]
    pairs = [(x, 0.0) for x in q] + [(middle, x) for x in v]
    pairs += [(q[a], v[b] if moving else 0.0) for a, b in zip(i, j, strict=True)]
    torque = _torque_at(given, k, pairs, rng)
    at_q, at_v, checked = np.split(torque, [len(q), len(q) + len(v)])
    at_v = at_v - at_q[N_SWEPT // 2] if moving else at_v
    expected = at_q[i] + (at_v[j] if moving else 0.0)
    if not np.abs(checked - expected).max() <= room:
        return None
    return Swept(k, q, at_q, v, at_v, room, states.model.joints[k].is_prismatic)


def _laws(swept: Swept, room: float) -> Sequence[AddedLaw | None]:
    """The law of its position, and of its velocity; None for one that has none."""
    laws: list[AddedLaw | None] = [of_position(swept.q, swept.at_q, room, slides=swept.slides)]
    if len(swept.v):
        laws.append(of_velocity(swept.v, swept.at_v, room, slides=swept.slides))
    return laws
