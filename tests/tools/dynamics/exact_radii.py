"""Whether exact values are proven to their digits on every arm, and how long a state takes.

    python tests/tools exact_radii [ROBOT|FILE ...] [--states 20]
    python tests/tools exact_radii --times ur5

For each robot and truth: the largest radius of every function of graphdyn at random states, over the largest entry of
the array at the state (of arrays that vanish, their radius), the function where it is, and whether the recursions and
Eq. (111) solved in balls overlap, with wrenches on all bodies. Without names, the six arms of the command line and
those of the folder urdf/arms of the test data; functions that need a mass are left out for robots without. Three
seconds for a robot. Exit code 1 where a radius exceeds 1e-30, or nothing overlaps.

--times: processor time by function: of a state among 100, of a call for one state, and of the first such call.
"""

import argparse
import time
import warnings
from collections.abc import Iterator

import numpy as np
from shared_data import DATA

import crosscheck
import graphdyn
import urdf
from crosscheck.exact import ExactArray
from graphdyn.verbs import VERBS

DIGITS = 30

ROBOTS = ("kr500", "ur3", "ur5", "ur10", "kinova", "z1")

TIMED = {
    "torques": ("joint_torques",),
    "accelerations": ("joint_accelerations",),
    "all 66 unknowns, recursion": ("solve_kkt",),
    "66 equations": ("solve_kkt", "dense"),
    "first derivatives of torques": ("inverse_dynamics_derivatives",),
    "first derivatives of accelerations": ("forward_dynamics_derivatives",),
    "first derivatives of reactions": ("reaction_derivatives",),
    "second derivatives": ("inverse_dynamics_second_derivatives",),
}
"""What is timed: the function, and a method."""


def main() -> int:
    parser = argparse.ArgumentParser(prog="python tests/tools exact_radii")
    parser.add_argument("robots", nargs="*")
    parser.add_argument("--states", type=int, default=20)
    parser.add_argument("--times", action="store_true")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    robots = asked.robots or [*ROBOTS, *sorted((DATA / "urdf" / "arms").glob("*.urdf"))]
    if asked.times:
        for robot in asked.robots or ["ur5"]:
            timed(robot)
        return 0
    print(f"{'robot':34}{'truth':8}{'radius over scale':>18}  of{'':36}overlap")
    return max([measured(robot, asked.states) for robot in robots], default=0)


def measured(robot: object, count: int) -> int:
    """Prints a row for each truth; 1 where one fails."""
    model, failed = urdf.load(robot), 0
    for truth in ("file", "model"):
        found, left_out = [], []
        for name in VERBS:
            try:
                found += [(largest(array), name) for array in of_verb(robot, name, truth, count).values()]
            except (graphdyn.SingularMassMatrix, graphdyn.InvalidInput) as error:
                left_out.append((name, error))
        radius, name = max(found, default=(np.inf, "none"))
        together = overlap(robot, truth, count)
        failed |= int(radius > 10.0**-DIGITS or together is False)
        said = {True: "yes", False: "NO", None: "no mass"}[together]
        print(f"{model.name:34}{truth:8}{radius:18.1e}  {name:38}{said}", flush=True)
        for name, error in left_out:
            print(f"    without {name}: {str(error)[:110]}")
    return failed


def of_verb(robot: object, name: str, truth: str, count: int) -> dict[str, ExactArray]:
    model, verb = urdf.load(robot), VERBS[name]
    options = {"frame": model.body_names[-1], "reference": "local"} if verb.of_frame else {}
    return crosscheck.exact_values(robot, name, *states(model, verb.inputs, count), truth=truth, **options)


def states(model: graphdyn.RobotModel, names: tuple[str, ...], count: int) -> Iterator[np.ndarray]:
    rng = np.random.default_rng(0)
    q, v = model.random_state(rng, count)
    a, tau = 5 * rng.normal(size=(2, *q.shape))
    known = {"q": q, "v": v, "a": a, "tau": tau}
    return (known[name] for name in names)


def largest(array: ExactArray) -> float:
    """The radius over the largest entry, at the worst state."""
    worst = 0.0
    for row in array.balls.reshape(len(array.balls), -1):
        radius = max((float(x.rad()) for x in row), default=0.0)
        scale = max((float(x.abs_upper()) for x in row), default=0.0)
        worst = max(worst, radius if scale < 1e-40 else radius / scale)
    return worst


def overlap(robot: object, truth: str, count: int) -> bool | None:
    """Whether both formulations overlap in all numbers, with all joints independent; None where a body lacks mass."""
    model = urdf.load(robot, mimic="independent")
    given = list(states(model, VERBS["solve_kkt"].inputs, count))
    loads = np.random.default_rng(1).normal(size=(count, model.n_bodies, 6))
    options = {"truth": truth, "external_wrenches": loads, "mimic": "independent"}
    try:
        ways = [crosscheck.exact_values(robot, "solve_kkt", *given, method=way, **options) for way in METHODS]
    except graphdyn.SingularMassMatrix:
        return None
    pairs = ((one[name].balls.ravel(), other[name].balls.ravel()) for one, other in [ways] for name in one)
    return all(x.overlaps(y) for one, other in pairs for x, y in zip(one, other, strict=True))


METHODS = ("recursive", "dense")


def timed(robot: object) -> None:
    """Prints the processor time of each function."""
    model = urdf.load(robot)
    print(f"{f'{robot}, {DIGITS} digits, processor time [ms]':38}{'a state':>12}{'one call':>12}{'first call':>12}")
    for title, (name, *method) in TIMED.items():
        options = {"method": method[0]} if method else {}
        many = list(states(model, VERBS[name].inputs, 100))
        first, *others = (seconds(robot, name, [x[:1] for x in many], options) for _ in range(6))
        whole = min(seconds(robot, name, many, options) for _ in range(3))
        each = (whole - min(others)) / 99
        print(f"{title:38}{each * 1e3:12.2f}{min(others) * 1e3:12.1f}{first * 1e3:12.1f}", flush=True)


def seconds(robot: object, name: str, arguments: list[np.ndarray], options: dict[str, str]) -> float:
    start = time.process_time()
    crosscheck.exact_values(robot, name, *arguments, **options)
    return time.process_time() - start
