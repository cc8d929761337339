"""Test vectors: states, answers, and the tolerance of each number, for test suites without Python."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from crosscheck.exact import ExactArray
from crosscheck.judging.exchange.protocols import number_text
from crosscheck.judging.exchange.proven_digits import ProvenDigits
from crosscheck.judging.exchange.rounds import states_of
from crosscheck.judging.judge import drawn_states, robot_of
from crosscheck.judging.observing.references import References, check_declared, relative_errors
from crosscheck.judging.setting import Setting
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS, Quantity, known_function
from crosscheck.quantities.measures import Chosen
from graphdyn import GraphDynError, InvalidInput
from graphdyn.layout import Array


class ReferencesDisagree(GraphDynError):
    """The reference implementations give different answers: there is nothing to test others with."""


@dataclass(frozen=True, eq=False)
class VectorTable:
    """The test vectors of one function.

    arguments: by name                                      (N, n) each
    answer, tolerance: of each number                       (N, …)
    references: whose answers agree within the tolerance
    exact: the answer with proven digits; None where that was not asked for, or the function has no exact form
    """

    known: Quantity
    conventions: Chosen
    arguments: Mapping[str, Array]
    answer: Array
    tolerance: Array
    references: tuple[str, ...]
    exact: ExactArray | None = None

    @property
    def sizes(self) -> tuple[int, int]:
        """Numbers of a row: of all arguments, and of the answer."""
        return sum(x[0].size for x in self.arguments.values()), int(self.answer[0].size)

    def csv(self) -> bytes:
        """A head, then a row per state: the arguments, the answer row by row, the tolerance of each number."""
        return self._rows(self.answer)

    def exact_csv(self) -> bytes:
        """The same, with proven decimals in place of the answer."""
        assert self.exact is not None
        return self._rows(self.exact.decimals())

    def _rows(self, answer: np.ndarray) -> bytes:
        parts = {**self.arguments, "answer": answer, "tolerance": self.tolerance}
        flat = {name: x.reshape(len(x), -1) for name, x in parts.items()}
        head = [f"{name}{k}" for name, x in flat.items() for k in range(1, x.shape[1] + 1)]
        rows = np.concatenate([x.astype(object) for x in flat.values()], axis=1)
        lines = [",".join(head), *(",".join(x if isinstance(x, str) else number_text(x) for x in row) for row in rows)]
        return "".join(f"{line}\n" for line in lines).encode()


def confirmed_functions(frame: str | None) -> list[str]:
    """Names of the functions that have a second reference implementation, and an answer of a known size."""
    return [
        name
        for name, known in FUNCTIONS.items()
        if "p" not in known.shape and (frame is not None or not known.of_frame)
    ]


def vector_tables(
    setting: Setting, names: Collection[str], digits: ProvenDigits | None = None
) -> Iterator[VectorTable]:
    """The test vectors of each function, by the conventions of the setting, with tolerances by its bound.

    digits: of the exact answers, without which there are none

    Raises InvalidInput, ReferencesDisagree, and what crosscheck.judge raises for a robot.
    """
    functions = [known_function(name) for name in names]
    for known in functions:
        if "p" in known.shape:
            raise InvalidInput(f"{known.name} has no test vectors: answers of any number of columns may be right")
    check_declared(setting.conventions, functions)
    robot = robot_of(setting, [known.name for known in functions])
    drawn = drawn_states(robot.model.uncoupled, setting, functions)
    of_states: dict[bool, References] = {}
    for known in functions:
        states = states_of(known, drawn, setting)
        if (loaded := states.loads is not None) not in of_states:
            of_states[loaded] = References.of(states)
        references = of_states[loaded]
        own = {name: way for name, way in setting.conventions.items() if name in known.conventions}
        chosen = next(known.readings(own))
        ours = known.of_graphdyn(references.states, chosen)
        tolerance = tolerances(known, ours, references.states, chosen, setting.bound)
        answers = references.answers(known, chosen, ours)
        for reference, theirs in answers.items():
            if not (np.abs(theirs - ours) <= tolerance).all():
                raise ReferencesDisagree(
                    f"{known.name}: {reference} and graphdyn disagree on this robot; see `graphdyn crosscheck`"
                )
        names_of = known.called_with(setting.external_wrenches)
        arguments = dict(zip(names_of, known.arguments_at(references.states), strict=True))
        exact = None if digits is None else digits.of(known, chosen, robot, references.states)
        yield VectorTable(known, chosen, arguments, ours, tolerance, tuple(answers), exact)


def tolerances(known: Quantity, answer: Array, states: JudgedStates, chosen: Chosen, bound: float) -> Array:
    """How far each number may be from the answer: where it alone differs, the relative error is the bound (N, …)."""
    flat = answer.reshape(len(answer), -1)
    found = np.empty_like(flat)
    step = np.maximum(np.abs(flat).max(axis=1), 1.0)
    for k in range(flat.shape[1]):
        changed = flat.copy()
        changed[:, k] += step
        error = relative_errors(known, changed.reshape(answer.shape), answer, states, chosen)
        with np.errstate(divide="ignore"):
            found[:, k] = bound * (changed[:, k] - flat[:, k]) / error
    return found.reshape(answer.shape)
