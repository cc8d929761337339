"""Whether tiny errors are proven, and right functions left in peace: python tests/tools proven_faults [ROBOT ...].

Plants a relative error (--error 1e-12) in every constant of a textbook recursion, one at a time: masses, lengths,
angles, centers of mass, inertias. `judge --exact` has to find those whose effect on the torques exceeds ten times the
rounding of the recursion itself, both as the largest at all judged states, relative to the largest joint wrench. Then
functions that are right are judged: every function of graphdyn by two methods, Pinocchio's, recursions in link axes and
in world axes, and torques summed term by term. None may be accused; the largest errors are printed in units of what
half an ulp of the inputs causes (those of vectors are wrong from 2 on, of matrices from 3). Two minutes for a robot.
"""

import argparse
import warnings
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from faults.textbook import TextbookArm
from faults.world_axes import world_axes_rnea
from scipy.spatial.transform import Rotation

import crosscheck
import graphdyn
import urdf
from crosscheck.judging.exact_errors import ExactErrors
from crosscheck.judging.observing.references import References
from crosscheck.judging.states import JudgedStates
from crosscheck.judging.verdicts.exact_answers import has_exact_values
from crosscheck.quantities import FUNCTIONS, LOADS, Quantity
from graphdyn import SingularMassMatrix
from graphdyn.arguments import Method

ROBOTS = ("kr500", "ur3", "ur5", "ur10", "kinova", "z1")

WELL_ABOVE = 10
"""Times its own rounding that a fault changes the answers by, to be looked for."""

SHOWN = 8


def main() -> int:
    parser = argparse.ArgumentParser(prog="python tests/tools proven_faults")
    parser.add_argument("robots", nargs="*", default=ROBOTS)
    parser.add_argument("--error", type=float, default=1e-12)
    parser.add_argument("--samples", type=int, default=100)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    planted, found, accused, excess = 0, 0, 0, []
    for robot in asked.robots:
        model = urdf.load(robot).uncoupled
        tried, above, proven = planted_in(model, asked.error, asked.samples)
        planted, found = planted + above, found + proven
        print(f"{model.name}: {tried} constants, {above} with an effect to be found, {proven} proven", flush=True)
        for name, errors in right_functions(model, asked.samples):
            accused += errors.wrong
            excess.append((float(errors.excess.max()) * errors.factor, f"{name} of {model.name}"))
            if errors.wrong:
                print(f"  ACCUSED: {excess[-1][1]}", flush=True)
    print(f"{found} of {planted} faults of {asked.error:g} proven; {accused} of {len(excess)} right functions accused")
    print("largest errors of right functions, in what half an ulp causes:")
    for size, name in sorted(excess, reverse=True)[:SHOWN]:
        print(f"  {size:.2f}  {name}")
    return int(accused > 0 or found < planted)


def planted_in(model: graphdyn.RobotModel, error: float, samples: int) -> tuple[int, int, int]:
    """Numbers of constants, of those whose effect is large enough, and of those that are proven."""
    arm = TextbookArm.of(model)
    states = JudgedStates.draw(model, samples, 0, needs_tau=False)
    scale = np.abs(states.wrenches).max(axis=(1, 2))
    right = torques(arm, states)
    rounding = judged(model, "inverse_dynamics", arm.inverse_dynamics, samples).most.max()
    tried, above, proven = 0, 0, 0
    for what, faulty in faults(arm, error):
        tried += 1
        effect = (np.abs(torques(faulty, states) - right).max(axis=1) / scale).max()
        if effect <= WELL_ABOVE * rounding:
            continue
        above += 1
        errors = judged(model, "inverse_dynamics", faulty.inverse_dynamics, samples)
        proven += errors.wrong
        if not errors.wrong:
            print(f"  MISSED: {what} of {model.name}, {effect / rounding:.1f} times its rounding", flush=True)
    return tried, above, proven


def torques(arm: TextbookArm, states: JudgedStates) -> np.ndarray:
    return np.array([arm.inverse_dynamics(*x) for x in zip(states.q, states.v, states.a, strict=True)])


def faults(arm: TextbookArm, error: float) -> Iterator[tuple[str, TextbookArm]]:
    """The arm with one constant off by a relative error, for every constant that is not zero."""
    for field in ("masses", "translations", "centers"):
        values = getattr(arm, field)
        for place in zip(*np.nonzero(values), strict=True):
            changed = values.copy()
            changed[place] *= 1 + error
            yield f"{field} {place}", arm.but(**{field: changed})
    for body, row, column in zip(*np.nonzero(arm.tensors), strict=True):
        if row <= column:
            changed = arm.tensors.copy()
            changed[body, row, column] *= 1 + error
            changed[body, column, row] = changed[body, row, column]
            yield f"tensors {body, row, column}", arm.but(tensors=changed)
    for joint, rotation in enumerate(arm.rotations):
        angle = Rotation.from_matrix(rotation).as_rotvec()
        if angle.any():
            changed = arm.rotations.copy()
            changed[joint] = rotation @ Rotation.from_rotvec(angle * error).as_matrix()
            yield f"angle of joint {joint + 1}", arm.but(rotations=changed)


def right_functions(model: graphdyn.RobotModel, samples: int) -> Iterator[tuple[str, ExactErrors]]:
    """Judgments of functions that are right, by name."""
    arm = TextbookArm.of(model)
    yield "textbook recursion", judged(model, "inverse_dynamics", arm.inverse_dynamics, samples)
    yield "recursion in world axes", judged(model, "inverse_dynamics", world_axes_rnea(model), samples)
    yield "textbook mass matrix", judged(model, "mass_matrix", arm.mass_matrix, samples)
    yield "torques term by term", judged(model, "inverse_dynamics", term_by_term(model), samples)
    for name, known in FUNCTIONS.items():
        if not has_exact_values(known):
            continue
        codes = {
            "graphdyn, projected": in_batches(model, known, of_graphdyn),
            "graphdyn, recursive": in_batches(model, known, partial(of_graphdyn, method="recursive")),
            "Pinocchio": in_batches(model, known, of_pinocchio),
        }
        for code, function in codes.items():
            try:
                yield f"{name} of {code}", judged(model, name, function, samples, batched=True)
            except SingularMassMatrix:
                break


def of_graphdyn(states: JudgedStates, known: Quantity, method: Method = "projected") -> np.ndarray:
    return known.of_graphdyn(states, next(known.readings({})), method)


def of_pinocchio(states: JudgedStates, known: Quantity) -> np.ndarray:
    return known.of_pinocchio(References.of(states).pinocchio, states, next(known.readings({})))


def term_by_term(model: graphdyn.RobotModel) -> Callable[..., np.ndarray]:
    """M a + C v + g."""

    def rnea(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        velocity = graphdyn.coriolis_matrix(model, q, v) @ v
        return graphdyn.mass_matrix(model, q) @ a + velocity + graphdyn.gravity_torque(model, q)

    return rnea


def in_batches(model: graphdyn.RobotModel, known: Quantity, answer: Callable[..., np.ndarray]) -> Callable:
    """A function of arrays (N, n). answer: of states, and the row of the table"""

    def function(*arguments: np.ndarray) -> np.ndarray:
        zero = np.zeros_like(arguments[0])
        given = {"v": zero, "a": zero, "tau": zero, **dict(zip(known.arguments, arguments, strict=True))}
        loads = given.pop(LOADS, None)
        return answer(JudgedStates(model, **given, loads=loads, frame=frame_of(model)), known)

    return function


def frame_of(model: graphdyn.RobotModel) -> str:
    return model.frames[-1].name if model.frames else model.body_names[-1]


def judged(
    model: graphdyn.RobotModel, name: str, function: Callable, samples: int, batched: bool = False
) -> ExactErrors:
    judgment = crosscheck.judge(
        model, samples=samples, frame=frame_of(model), batched=batched, exact=True, **{name: function}
    )
    errors = judgment.functions[name].exact
    assert errors is not None, judgment.notes
    return errors
