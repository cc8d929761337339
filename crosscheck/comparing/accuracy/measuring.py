"""The accuracy of graphdyn and of the reference implementations on one robot, against exact values."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import replace
from typing import Unpack

import numpy as np
from threadpoolctl import threadpool_limits

from crosscheck.comparing.accuracy.measured_states import MeasuredQuantity, MeasuredStates, measured_quantities
from crosscheck.comparing.accuracy.results import MUJOCO, PINOCCHIO, CodeErrors, QuantityErrors, TrueErrors
from crosscheck.comparing.compare import Progress, pinocchio_models, why_not_forward
from crosscheck.comparing.compared_states import ComparedStates
from crosscheck.exact import ExactSource, Truth, check_installed
from crosscheck.quantities.states import RANDOM, Case, cases, has_mass
from crosscheck.quantities.tolerances import EPS
from crosscheck.reference.mujoco_model import MujocoModel, MujocoRefuses
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.subject import Robot, Subject, check_counts, refuse_chords, subject
from graphdyn import InvalidInput, mass_matrix
from graphdyn.arguments import reproducible
from graphdyn.compiler import interpreted
from graphdyn.equations import singular
from graphdyn.layout import Array
from urdf import Reading, ReadingKeywords
from urdf.reading import AS_IT_STANDS

log = logging.getLogger(__name__)

COMPILED_FROM = 100
"""Random states from which the recursive method is compiled: exact values take longer than compiling then."""

STATES_AT_ONCE = 25
"""Random states handled at once, some seconds: progress is told after each part."""


@reproducible()
def true_errors(
    robot: Robot,
    samples: int = 20,
    seed: int = 0,
    *,
    truth: Truth = "model",
    progress: Progress | None = None,
    **reading: Unpack[ReadingKeywords],
) -> TrueErrors:
    """Measure how far graphdyn, Pinocchio and, where installed, MuJoCo are from exact values.

    States, quantities, scales and bounds are those of compare, and so are the special states of each quantity. An arm
    takes ten seconds with 20 random states, half a minute with 100.

    robot: name (urdf.robots), path of a URDF, or RobotModel
    samples: random states, to which the special ones are added. From 100 on the recursive method is compiled for the
        random ones; else it runs on NumPy
    truth: "model" takes the doubles of the model in memory as exact, on which all of them work; "file" the decimals of
        the file, which Pinocchio then reads itself: errors of reading count, too
    progress: called with the name of a kind of state and the number of states just done
    reading: as in urdf.load, for names and paths only

    Where joints drive each other (RobotModel.couplings), the quantities are those of the robot without couplings.

    Raises InvalidInput without python-flint, for robots with loops, for invalid samples, seed or truth, for the truth
    of a file where there is none or joints drive each other, and for a way to read a RobotModel; urdf's errors for a
    file that cannot be loaded.
    """
    check_installed()
    check_counts(samples, seed)
    compared = subject(robot, Reading.of(true_errors, reading))
    refuse_chords(compared.model, "have no exact values; from Python, measure its tree: urdf.load(…).opened")
    model = compared.model.uncoupled
    if truth == "file" and compared.model.couplings:
        raise InvalidInput(
            f"robot '{model.name}': joints drive each other, and the errors are those of the robot without couplings; "
            "use truth='model', or mimic='independent'"
        )
    given, how = (robot, compared.reading) if truth == "file" else (model, AS_IT_STANDS)
    source = ExactSource(given, truth, how)
    found = _Measurement(compared, source)
    with threadpool_limits(limits=1, user_api="blas"):  # threads slow down matrices this small
        for case in cases(model, samples, seed):
            compiled = case.name == RANDOM and samples >= COMPILED_FROM
            for start in range(0, len(case.q), STATES_AT_ONCE):
                part = case.rows(slice(start, start + STATES_AT_ONCE))
                with nullcontext() if compiled else interpreted():
                    found.measure(part)
                if progress:
                    progress(part.name, len(part.q))
    coupled = ["joints drive each other: the quantities are those of the robot without couplings"]
    return TrueErrors(
        robot=compared.name,
        file=compared.file,
        file_sha256=compared.file_sha256,
        model=model,
        n_bodies=model.n_bodies,
        samples=samples,
        seed=seed,
        reading=compared.reading,
        truth=source.truth,
        compiled=samples >= COMPILED_FROM,
        quantities=found.results(),
        not_measured=found.not_measured,
        not_regular={name: count for name, count in found.not_regular.items() if count},
        notes=(*(coupled if compared.model.couplings else []), *found.notes),
    )


class _Measurement:
    """The errors of all states so far.

    not_measured: quantities left out, with the reason; not_regular: states where forward dynamics was, by kind
    """

    def __init__(self, compared: Subject, source: ExactSource) -> None:
        model = compared.model.uncoupled
        reason, massless = why_not_forward(model), not has_mass(model)
        self.not_measured: dict[str, str] = {}
        self.not_regular: Counter[str] = Counter()
        self.notes: list[str] = []
        self._quantities: list[MeasuredQuantity] = []
        for name, quantity in measured_quantities().items():
            if quantity is None:
                self.not_measured[name] = "no exact form"
            elif quantity.row.solves and reason:
                self.not_measured[name] = reason
            elif quantity.row.massive and massless:
                self.not_measured[name] = "no body has mass: kinematics only"
            else:
                self._quantities.append(quantity)
        self._source, self._pinocchio = source, PinocchioModel.from_model(model)
        if source.truth == "file":
            known, self.notes = pinocchio_models(replace(compared, model=model))
            self._pinocchio = known.get("urdf", self._pinocchio)
        self._solves, self._mujoco_refused = reason is None, False
        self._errors: dict[tuple[str, str, str], list[Array]] = {}

    def measure(self, case: Case) -> None:
        """Add the errors at these states."""
        regular = ~singular(mass_matrix(case.model, case.q)) if self._solves else np.zeros(len(case.q), dtype=bool)
        source = self._source.moved(case.model)
        every = MeasuredStates(ComparedStates.of(case, regular, self._pinocchio), source)
        solvable = every
        if self._solves:
            regular &= every.proven_regular()
            self.not_regular[case.name] += int((~regular).sum())
            solvable = every if regular.all() else MeasuredStates(every.states.rows(regular), source)
        mujoco = self._of_mujoco(every.states)
        for number, quantity in enumerate(self._quantities, start=1):
            log.info("%d of %d, %s", number, len(self._quantities), quantity.name)
            states, asked = (solvable, regular) if quantity.row.solves else (every, slice(None))
            answers = None if quantity.loaded else mujoco.get(quantity.row.mujoco or "")
            others = {} if answers is None else {MUJOCO: answers[asked]}
            if len(states.states.q) and (quantity.everywhere or case.name == RANDOM):
                for code, errors in states.errors(quantity, others).items():
                    self._errors.setdefault((quantity.name, code, case.name), []).append(errors)

    def results(self) -> dict[str, QuantityErrors]:
        """What was measured at random states, by name."""
        codes: dict[str, dict[str, dict[str, Array]]] = {}
        for (name, code, case), errors in self._errors.items():
            codes.setdefault(name, {}).setdefault(code, {})[case] = np.concatenate(errors, axis=1)
        found = {}
        for quantity in self._quantities:
            name, row = quantity.name, quantity.row
            by_code = {code: CodeErrors(by_case) for code, by_case in codes.get(name, {}).items() if RANDOM in by_case}
            if by_code:
                states = sum(errors.shape[1] for errors in by_code[PINOCCHIO].by_case.values())
                found[name] = QuantityErrors(name, row.tolerance.bound / EPS, row.scale, states, by_code)
            else:
                self.not_measured[name] = "the mass matrix is not proven regular at any random state"
        return found

    def _of_mujoco(self, states: ComparedStates) -> Mapping[str, Array]:
        """MuJoCo's answers by name, none where it does not take part."""
        if self._mujoco_refused:
            return {}
        try:
            return MujocoModel(states.model).evaluate(states.q, states.v, states.a, states.tau)
        except MujocoRefuses as refusal:
            self._mujoco_refused = True
            self.notes.append(f"MuJoCo does not take part: {refusal}")
            return {}
