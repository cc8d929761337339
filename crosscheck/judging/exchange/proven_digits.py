"""Answers with proven digits, for test vectors of codes that compute with more than doubles."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from crosscheck.exact import ExactArray, Truth, exact_values
from crosscheck.judging.setting import Setting
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import LOADS, Quantity
from crosscheck.quantities.measures import Chosen, linear_first
from graphdyn import InvalidInput
from graphdyn.verbs import VERBS

COMPUTED_SO = ("reference", "acceleration", "order")
"""Conventions in which exact values are computed as chosen; of others only the usual way has them."""


@dataclass(frozen=True)
class ProvenDigits:
    """How many digits are asked for, and of which truth (crosscheck.exact_values)."""

    count: int
    truth: Truth

    def refuse_inexact(self, functions: Iterable[Quantity]) -> None:
        """Raises InvalidInput, naming the first function without an exact form."""
        for known in functions:
            if not known.ours.verb:
                raise InvalidInput(f"{known.name} has no exact form; leave it out of --for, or omit --digits")

    def of(self, known: Quantity, chosen: Chosen, setting: Setting, states: JudgedStates) -> ExactArray | None:
        """The answer at all states; None where the function has no exact form in these conventions."""
        ours = known.ours
        others = {name: ways[0] for name, ways in known.conventions.items() if name not in COMPUTED_SO}
        if not ours.verb or any(chosen[name] != usual for name, usual in others.items()):
            return None
        options: dict[str, Any] = dict(ours.options(chosen))
        if known.of_frame:
            options["frame"] = states.frame
        if LOADS in known.called_with(setting.external_wrenches):
            options[LOADS] = states.all_loads
        robot: Any = states.model
        if self.truth == "file":
            robot, reading = setting.robot, setting.reading
            options["reading"] = replace(reading, mimic="independent") if reading.mimic == "coupled" else reading
        given = (getattr(states, name) * (name in known.arguments) for name in VERBS[ours.verb].inputs)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # reading the file has warned before
            found = exact_values(robot, ours.verb, *given, digits=self.count, truth=self.truth, **options)
        array = found[ours.output]
        balls: Any = array.balls
        ordered: Any = linear_first(balls, chosen, known.six)
        return replace(array, balls=ordered)
