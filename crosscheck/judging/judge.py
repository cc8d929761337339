"""crosscheck.judge: foreign functions against graphdyn, Pinocchio and, where installed, MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

import urdf
from crosscheck.judging.columns import column_fault
from crosscheck.judging.diagnosis import diagnose, merged
from crosscheck.judging.experiments import TrialStates, observe
from crosscheck.judging.foreign import ForeignFunction, joint_order
from crosscheck.judging.judged_states import JudgedStates
from crosscheck.judging.judgement import Diagnosis, JudgedFunction, Judgement, WorstCall, largest_errors
from crosscheck.judging.references import (
    BACKWARD_SCALE,
    SCALES,
    Reference,
    backward_errors,
    foreign_errors,
    graphdyn_reference,
    mujoco_reference,
    pinocchio_reference,
)
from crosscheck.referee.mujoco_model import MujocoRefuses
from crosscheck.referee.subject import Lock, Robot, check_counts, subject
from crosscheck.referee.tolerances import FOREIGN
from graphdyn import InvalidInput
from graphdyn.layout import Array

Foreign = Callable[..., ArrayLike]
"""A function of one state: arrays of shape (n,) in the order of joint_names."""

Progress = Callable[[str], None]
"""Called with the name of the next step."""


def judge(
    robot: Robot,
    *,
    inverse_dynamics: Foreign | None = None,
    forward_dynamics: Foreign | None = None,
    mass_matrix: Foreign | None = None,
    regressor: Foreign | None = None,
    joint_names: Sequence[str] | None = None,
    samples: int = 100,
    seed: int = 0,
    tolerance: float = FOREIGN.bound,
    lock: Lock = None,
    gravity: ArrayLike | None = None,
    progress: Progress | None = None,
) -> Judgement:
    """Compare foreign functions with graphdyn, Pinocchio and MuJoCo (where installed), and say what is wrong with them.

    robot: name (urdf.robots), path of a URDF, or RobotModel
    inverse_dynamics: (q, v, a) → τ (n,); forward_dynamics: (q, v, τ) → a (n,); mass_matrix: q → M (n, n);
        regressor: (q, v, a) → W (n, 10n) with the parameters of docs/notation.md. All arguments (n,), one state per
        call; [rad or m, …/s, …/s², N m or N]. No external forces, no friction.
    joint_names: the order of the foreign arrays; default: that of urdf.load
    samples: random states within the limits, to which a few with whole turns are added
    tolerance: largest relative error that counts as agreement, on the scale of each function
    lock, gravity: as in urdf.load, for names and paths only

    Raises InvalidInput for invalid arguments, ForeignFailure where a foreign function raises or returns the wrong
    shape, urdf's errors for a file that cannot be loaded, SingularMassMatrix for forward dynamics where the torques do
    not determine the accelerations.
    """
    given = {
        "inverse_dynamics": inverse_dynamics,
        "forward_dynamics": forward_dynamics,
        "mass_matrix": mass_matrix,
        "regressor": regressor,
    }
    _check(given, tolerance)
    check_counts(samples, seed)
    judged_robot = subject(robot, lock, gravity, mimic="independent")
    model = judged_robot.model
    links = urdf.fused_links(judged_robot.file, lock=judged_robot.locked) if judged_robot.file else {}
    order = joint_order(model, joint_names)
    functions = [ForeignFunction(name, f, order) for name, f in given.items() if f is not None]
    say = progress or (lambda _: None)
    judged, diagnoses, notes = {}, [], []
    if not any(body.mass > 0 for body in model.bodies):
        notes.append("no body has mass: all torques vanish, and little can be judged")
    with threadpool_limits(limits=1, user_api="blas"):
        states = JudgedStates.draw(model, samples, seed, needs_tau=forward_dynamics is not None)
        say("evaluating the reference implementations")
        references = {"graphdyn": graphdyn_reference(states, given), "pinocchio": pinocchio_reference(states)}
        try:
            references["mujoco"] = mujoco_reference(states)
        except MujocoRefuses as refusal:
            notes.append(f"MuJoCo is not among the reference implementations: {refusal}")
        trial = states.trial
        for function in functions:
            say(f"judging {function.name}")
            answer = function(*states.arguments(function.name))
            judged[function.name] = verdict = _verdict(function, answer, references, states, tolerance)
            if not verdict.agrees:
                say(f"looking for the fault of {function.name}")
                diagnoses += _diagnoses(function, answer, verdict, references["graphdyn"].answers, states, trial, links)
    judgement = Judgement(
        robot=judged_robot.name,
        file=judged_robot.file,
        model=model,
        joint_names=tuple(model.joint_names[k] for k in order),
        samples=samples,
        seed=seed,
        locked=judged_robot.locked,
        referees=tuple(references),
        functions=judged,
        diagnoses=merged(diagnoses),
        notes=tuple(notes),
    )
    if not judgement.decided:
        notes.append("the reference implementations disagree: no verdict on the foreign code; please report this robot")
    return replace(judgement, notes=tuple(notes))


def _verdict(
    function: ForeignFunction,
    answer: Array,
    references: Mapping[str, Reference],
    states: JudgedStates,
    tolerance: float,
) -> JudgedFunction:
    name = function.name
    known = {referee: x.answers[name] for referee, x in references.items() if name in x.answers}
    ours = known["graphdyn"]
    others = {referee: theirs for referee, theirs in known.items() if referee != "graphdyn"}
    backward = name == "forward_dynamics"
    errors = {referee: foreign_errors(name, answer, theirs, states) for referee, theirs in known.items()}
    backward_of = {referee: backward_errors(answer, references[referee], states) for referee in known if backward}
    worst = int(largest_errors(errors, backward_of).argmax())
    row = [x[worst] for x in states.arguments(name)]
    return JudgedFunction(
        name=name,
        errors=errors,
        referees_differ={referee: foreign_errors(name, theirs, ours, states) for referee, theirs in others.items()},
        backward_errors=backward_of,
        referees_differ_backward={
            referee: backward_errors(theirs, references["graphdyn"], states)
            for referee, theirs in others.items()
            if backward
        },
        bound=tolerance,
        scale=SCALES[name],
        backward_scale=BACKWARD_SCALE if backward else "",
        worst=WorstCall(
            {argument: tuple(x.tolist()) for argument, x in function.foreign_arguments(row).items()},
            tuple(ours[worst].ravel().tolist()),
            tuple(answer[worst].ravel().tolist()),
        ),
    )


def _diagnoses(
    function: ForeignFunction,
    answer: Array,
    verdict: JudgedFunction,
    ours: Mapping[str, Array],
    states: JudgedStates,
    trial: TrialStates,
    links: Mapping[str, tuple[int, Array]],
) -> list[Diagnosis]:
    name, model = function.name, states.model
    wrong = verdict.largest_errors > verdict.bound
    count = f"{int(wrong.sum())} of {len(wrong)} states deviate"
    if name == "regressor" and (fault := column_fault(answer, ours["regressor"])):
        return [
            Diagnosis(
                name, fault.kind, fault.message, f"columns compared one by one; {count}", fault.remedy, fault.left
            )
        ]
    torque = np.maximum(np.sqrt(np.mean(ours["inverse_dynamics"] ** 2, axis=0)), np.finfo(float).tiny)
    try:
        observed = observe(function, model, trial, torque)
    except np.linalg.LinAlgError:
        message = "the accelerations do not determine a mass matrix: M⁻¹ from unit torques is singular"
        return [Diagnosis(name, "unknown", message, count, "ask it for accelerations at unit torques", np.inf)]
    found = diagnose(name, observed, model, trial, links)
    if found:
        return [replace(diagnosis, evidence=f"{diagnosis.evidence}; {count}") for diagnosis in found]
    message = "gravity, mass matrix and velocity terms are right separately; only certain states or their sum deviate"
    return [Diagnosis(name, "unknown", message, count, "look at the worst state", np.inf)]


def _check(given: Mapping[str, Foreign | None], tolerance: float) -> None:
    if all(function is None for function in given.values()):
        raise InvalidInput(f"no function to judge; give at least one of {', '.join(given)}")
    for name, function in given.items():
        if function is not None and not callable(function):
            raise InvalidInput(f"{name} is of type {type(function).__name__}; give a function")
    if not isinstance(tolerance, Real) or not 0 < tolerance < 1:
        raise InvalidInput(f"tolerance is {tolerance!r}; give a relative error between 0 and 1")
