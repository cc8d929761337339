"""crosscheck.judge: functions under test against graphdyn, Pinocchio and, where installed, MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from numbers import Real
from typing import Any, Unpack

from threadpoolctl import threadpool_limits

from crosscheck.exact import check_installed
from crosscheck.judging.faults.file_reading import faults_of_file
from crosscheck.judging.judgment import UNCOUPLED, Diagnosis, JudgedFunction, Judgment
from crosscheck.judging.observing.function_under_test import FunctionUnderTest, joint_order
from crosscheck.judging.observing.references import References, check_declared
from crosscheck.judging.setting import TOLERANCES, JudgedKeywords, Precision, Setting
from crosscheck.judging.states import JudgedStates
from crosscheck.judging.verdicts.against_exact import needs_exact_values, with_exact_errors
from crosscheck.judging.verdicts.diagnosis import merged
from crosscheck.judging.verdicts.exact_answers import has_exact_values
from crosscheck.judging.verdicts.explaining import diagnoses_of
from crosscheck.judging.verdicts.smallest import smallest_call
from crosscheck.judging.verdicts.verdicts import judged
from crosscheck.quantities import FUNCTIONS, LOADS, Quantity, known_function
from crosscheck.quantities.tested_function import BatchFunction, TestedFunction
from crosscheck.reference.subject import Robot, Subject, check_counts, refuse_chords, subject
from graphdyn import InvalidInput, RobotModel
from graphdyn.arguments import refuse_unknown, reproducible
from urdf import Reading, ReadingKeywords

Progress = Callable[[str], None]
"""Called with the name of the next step."""


def judge(
    robot: Robot,
    *,
    joint_names: Sequence[str] | None = None,
    samples: int = 100,
    seed: int = 0,
    precision: Precision = "double",
    tolerance: float | None = None,
    beyond_limits: bool = False,
    frame: str | None = None,
    conventions: Mapping[str, str] | None = None,
    external_wrenches: bool = False,
    batched: bool = False,
    exact: bool = False,
    progress: Progress | None = None,
    **functions: Unpack[JudgedKeywords],
) -> Judgment:
    """Compare functions under test with graphdyn and Pinocchio, and say what is wrong with them.

    MuJoCo is a third reference implementation where it is installed.

    functions: by the names in docs/judge.md, which lists arguments and answers: inverse_dynamics=f with f(q, v, a) → τ.
        One state per call, arrays of shape (n,) [rad or m, …/s, …/s², N m or N]. No friction. Besides them, for names
        and paths, keywords that say how the robot is read, as in urdf.load
    robot: name (urdf.robots), path of a URDF, or RobotModel
    joint_names: the order of the function's arrays; default: that of urdf.load
    samples: random states within the limits, to which a few with whole turns are added
    precision: in which the functions compute; "single" means a tolerance of 1e-5 in place of 1e-9
    tolerance: largest relative error that counts as agreement, on the scale of each function; default: by precision
    beyond_limits: adds a fifth as many states outside the limits of positions and velocities
    frame: link or frame of the functions that belong to one, such as frame_jacobian
    conventions: those that the functions must follow, such as {"reference": "local"}; the others are found out
    external_wrenches: inverse_dynamics, forward_dynamics, joint_wrenches and multipliers take external wrenches as a
        last argument: force, moment on each body at its link origin, in link axes (n, 6) [N, N m]
    batched: functions take all states at once, arrays (N, n), and answer (N, …)
    exact: exact values (crosscheck.exact_values) at all states decide, in place of tolerances: what is off by more
        than rounding explains is wrong (docs/judge.md). Without it they decide where the references disagree

    Raises InvalidInput for invalid arguments, and for exact without python-flint; FunctionFailure where a function
    under test raises or returns the wrong shape at every state, urdf's errors for a file that cannot be loaded,
    SingularMassMatrix for forward dynamics where the torques do not determine the accelerations.

    >>> import crosscheck, graphdyn, urdf
    >>> model = urdf.load("ur5")
    >>> def rnea(q, v, a):  # stands for your function
    ...     tau = graphdyn.joint_torques(model, q, v, a)
    ...     tau[2] *= 1.01
    ...     return tau
    ...
    >>> judgment = crosscheck.judge("ur5", inverse_dynamics=rnea, samples=10)
    >>> judgment.verdict
    'DISAGREES'
    >>> print(judgment.diagnoses[0].message)
    the torque of joint 'elbow_joint' is multiplied by 1.01, as by a gear
    """
    refuse_unknown(judge, functions, JudgedKeywords.__annotations__)
    reading: Any = {name: value for name, value in functions.items() if name in ReadingKeywords.__annotations__}
    given: Any = {name: value for name, value in functions.items() if name not in reading and value is not None}
    setting = Setting(
        robot=robot,
        reading=Reading.of(judge, reading),
        joint_names=joint_names,
        samples=samples,
        seed=seed,
        precision=precision,
        tolerance=tolerance,
        beyond_limits=beyond_limits,
        frame=frame,
        conventions=conventions or {},
        external_wrenches=external_wrenches,
        batched=batched,
        exact=exact,
    )
    return judge_functions(given, setting, progress)


@reproducible()
def judge_functions(
    given: Mapping[str, TestedFunction], setting: Setting, progress: Progress | None = None
) -> Judgment:
    """Judge functions with given settings, like judge. given: functions by name. Raises InvalidInput for names that are
    none of FUNCTIONS."""
    _check(given, setting)
    robot = robot_of(setting, given)
    model = robot.model.uncoupled
    order = joint_order(model, setting.joint_names)
    say = progress or (lambda _: None)
    verdicts: dict[str, JudgedFunction] = {}
    diagnoses: list[Diagnosis] = []
    notes: list[str] = []
    if robot.model.couplings:
        notes.append(UNCOUPLED)
    if not any(body.mass > 0 for body in model.bodies):
        notes.append("no body has mass: all torques vanish, and little can be judged")
    with threadpool_limits(limits=1, user_api="blas"):
        states = drawn_states(model, setting, [FUNCTIONS[name] for name in given])
        say("evaluating the reference implementations")
        references = References.of(states, notes)
        unloaded = references if states.loads is None else References.of(replace(states, loads=None), notes)
        loaded = references if setting.external_wrenches else unloaded
        for name, f in given.items():
            say(f"judging {name}")
            known = FUNCTIONS[name]
            function = FunctionUnderTest(known, f, order, setting.batched, setting.external_wrenches)
            against = references if LOADS in known.arguments else loaded if known.ours.takes_loads else unloaded
            answers = function.ask(*known.arguments_at(against.states))
            declared = {x: way for x, way in setting.conventions.items() if x in known.conventions}
            found = judged(function, answers, against, declared, setting.bound)
            if setting.exact or needs_exact_values(found):
                say(f"computing exact values of {name}")
                found = with_exact_errors(found, robot, setting, notes)
            verdicts[name] = found.verdict
            notes += [f"{name} changes its argument {x}: give it a copy" for x in sorted(answers.changed)]
            if function.returned.overwritten:
                notes.append(f"{name} returns one array at every call and overwrites it: answers were copied at once")
            if not found.verdict.agrees and not found.verdict.wrong_by_proof_alone:
                say(f"looking for the fault of {name}")
                diagnoses += diagnoses_of(found, partial(faults_of_file, robot), say)
                say(f"looking for the smallest example of {name}")
                verdicts[name] = replace(found.verdict, smallest=smallest_call(found))
    judgment = Judgment(
        robot=robot.name,
        file=robot.file,
        model=model,
        joint_names=tuple(model.joint_names[k] for k in order),
        samples=setting.samples,
        seed=setting.seed,
        reading=robot.reading,
        references=tuple(dict.fromkeys(reference for verdict in verdicts.values() for reference in verdict.errors)),
        functions=verdicts,
        diagnoses=merged(diagnoses),
        notes=(),
        frame=setting.frame,
        precision=setting.precision,
        external_wrenches=setting.external_wrenches,
        beyond_limits=setting.beyond_limits,
    )
    if differing := [verdict for verdict in verdicts.values() if not verdict.references_agree]:
        left = "exact values decide" if all(verdict.decided for verdict in differing) else "no verdict on the user code"
        notes.append(f"the reference implementations disagree: {left}; please report this robot")
    return replace(judgment, notes=tuple(dict.fromkeys(notes)))


def robot_of(setting: Setting, names: Collection[str]) -> Subject:
    """The robot that functions of these names are judged on.

    Raises InvalidInput, UnknownFrame, and urdf's errors for a file that cannot be loaded.
    """
    check_counts(setting.samples, setting.seed)
    robot = subject(setting.robot, setting.reading)
    refuse_chords(robot.model)
    check_frame(names, setting.frame, robot.model)
    return robot


@reproducible()
def drawn_states(model: RobotModel, setting: Setting, functions: Collection[Quantity]) -> JudgedStates:
    """The states at which functions are judged on a robot without couplings."""
    return JudgedStates.draw(
        model,
        setting.samples,
        setting.seed,
        needs_tau=any("tau" in known.arguments for known in functions),
        loaded=setting.external_wrenches or any(LOADS in known.arguments for known in functions),
        beyond_limits=setting.beyond_limits,
        frame=setting.frame,
    )


def _check(given: Mapping[str, TestedFunction], setting: Setting) -> None:
    if not given:
        raise InvalidInput(f"no function to judge; give at least one of {', '.join(FUNCTIONS)}")
    for name, function in given.items():
        known_function(name)
        if not callable(function) and not isinstance(function, BatchFunction):
            raise InvalidInput(f"{name} is of type {type(function).__name__}; give a function")
    precision, tolerance = setting.precision, setting.tolerance
    if precision not in TOLERANCES:
        raise InvalidInput(f"precision is {precision!r}; give one of {', '.join(map(repr, TOLERANCES))}")
    if tolerance is not None and (not isinstance(tolerance, Real) or not 0 < tolerance < 1):
        raise InvalidInput(f"tolerance is {tolerance!r}; give a relative error between 0 and 1")
    check_declared(setting.conventions, [FUNCTIONS[name] for name in given])
    if setting.exact:
        check_installed()
        if without := [name for name in given if not has_exact_values(FUNCTIONS[name])]:
            raise InvalidInput(f"{', '.join(without)}: there are no exact values of this; leave it out, or exact")


def check_frame(names: Collection[str], frame: str | None, model: RobotModel) -> None:
    """Raises UnknownFrame, and InvalidInput where functions need a frame and there is none."""
    of_frames = [name for name in names if FUNCTIONS[name].of_frame]
    if of_frames and frame is None:
        raise InvalidInput(f"{', '.join(of_frames)} belong to one frame of the robot: give frame=, the name of a link")
    if frame is not None:
        model.frame(frame)
