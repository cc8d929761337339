"""Whether plans with noise of positions hold: python tests/tools encoder_plans FOLDER [NAME …].

`graphdyn excite --position-noise` plans a motion, or examines a random one. Recordings of it are then made without the
code of the plan: positions by the formula of the series, torques by Pinocchio from the robot's file, friction and
offset of the size that the plan expects, normal noise. The weighted least squares of `graphdyn identify` fits each;
the first one goes through the command too, which has to answer the same. Standard deviation and mean of the parameters
over the recordings are compared with the plan. NAME: of CASES, all if left out. FOLDER keeps the plans.
"""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio
from shared_data import DATA, REPOSITORY

import urdf
from crosscheck.identifying import Preparation
from crosscheck.recordings import Recording
from graphdyn.identification import Problem, TorqueModel, WeightedLeastSquares, one_thread
from graphdyn.identification.terms import Coulomb, Offset, RigidBodies, Viscous
from urdf.document import locate

DRAWS = 250
"""Recordings of a case: they know a standard deviation within 4.5 %, and the 200 of the plan within 5 %."""

LEAST, LARGEST = 0.8, 1.25
"""Of found over promised σ."""

SEED = 20261129
"""Of the noise of the recordings."""

TX40 = REPOSITORY / "crosscheck" / "study" / "configurations" / "tx40.toml"
KR300 = DATA / "data" / "kr300" / "kr300.json"


@dataclass(frozen=True)
class Case:
    """robot, lock: as for the commands; rate [Hz], cutoff: as --cutoff; position: noise [rad]; duration [s]

    options: further ones of `graphdyn excite`; random: the motion is a random series of so many harmonics
    """

    robot: str
    rate: float
    cutoff: str
    position: float
    duration: float = 10.0
    options: str = ""
    lock: tuple[str, ...] = ()
    random: int = 0


SLOW = "--velocity 1.5 --acceleration 6 --lower -2 --upper 2 --torque 9000 --noise 60,60,60,20,20,10"
WRIST = ("wrist_1_joint", "wrist_2_joint", "wrist_3_joint")
FINGERS = ("panda_finger_joint1", "panda_finger_joint2")

CASES = {
    "ur10-residual": Case("ur10", 125, "residual", 1e-4),
    "ur10-random": Case("ur10", 250, "12", 1e-4, 8.0, random=3),
    "tx40-raw": Case("tx40.urdf", 500, "none", 1e-5, 6.0, "--noise 0.3 --torque 60 --acceleration 20"),
    "kr300": Case("kr300.urdf", 250, "8", 1e-4, 12.0, SLOW),
    "panda": Case("panda", 1000, "40", 2e-5, 6.0, lock=FINGERS),
    "three-joints": Case("ur5", 200, "10", 1e-4, 6.0, lock=WRIST),
    "three-joints-raw": Case("ur5", 200, "none", 1e-4, 6.0, lock=WRIST),
}


def make_robots(folder):
    """The robot files of the cases that have no name."""
    figures = [REPOSITORY / "docs" / "recordings" / "kr300.py", KR300, folder / "kr300.urdf", 150]
    subprocess.run([sys.executable, *map(str, figures)], check=True)
    urdf.save(urdf.load(TX40), folder / "tx40.urdf")


def graphdyn_command(folder, *arguments):
    called = [sys.executable, "-m", "crosscheck", *map(str, arguments)]
    done = subprocess.run(called, cwd=folder, check=False, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(called)}\n{done.stderr}")


def motion_of(case, series, times):
    """q, v, a (N, n) of series offset + Σ (a sin(l ω t) - b cos(l ω t)) / (l ω)."""
    q, v, a = (np.zeros((len(times), len(series))) for _ in range(3))
    for joint, (offset, sines, cosines) in enumerate(series):
        q[:, joint] = offset
        for number, (one, other) in enumerate(zip(sines, cosines, strict=True), start=1):
            w = 2 * np.pi * number / case.duration
            s, c = np.sin(w * times), np.cos(w * times)
            q[:, joint] += (one * s - other * c) / w
            v[:, joint] += one * c + other * s
            a[:, joint] += w * (other * c - one * s)
    return q, v, a


def random_series(case, joints):
    """Normal amplitudes of about 0.5 rad/s."""
    rng = np.random.default_rng(case.random)
    size = 0.5 / np.sqrt(case.random)
    return [(0.3 * rng.standard_normal(), *(size * rng.standard_normal((2, case.random)))) for _ in range(joints)]


def sample_times(case, rate):
    return np.arange(round(case.duration * rate) + 1) / rate


def write_recording(file, joints, t, **channels):
    header = ",".join(["t", *(f"{name}_{joint}" for name in channels for joint in joints)])
    np.savetxt(file, np.column_stack([t, *channels.values()]), "%.17g", ",", header=header, comments="")


def plan_of(folder, name, case, joints):
    """The numbers of the command, and the series of the motion."""
    file = folder / f"{name}.json"
    drawn = random_series(case, len(joints)) if case.random else None
    if not file.exists():
        given = ["--rate", case.rate, "--cutoff", case.cutoff, "--position-noise", case.position, *case.options.split()]
        given += [word for joint in case.lock for word in ("--lock", joint)]
        if case.random:
            fine = sample_times(case, 1000.0)
            write_recording(folder / f"{name}-motion.csv", joints, fine, q=motion_of(case, drawn, fine)[0])
            given += ["--motion", f"{name}-motion.csv"]
        else:
            given += ["--duration", case.duration, "--seeds", 1, "--jobs", 1]
        fast = ["--no-collisions", "--random", 0]
        graphdyn_command(folder, "excite", "--robot", case.robot, *given, *fast, "--json", file.name)
    plan = json.loads(file.read_text(encoding="utf-8"))
    if case.random:
        return plan, drawn
    return plan, [(one["offset"], one["a"], one["b"]) for one in plan["motions"][0]["fourier"]]


def rigid_torques(file, case, joints, q, v, a):
    """Torques (N, n) by Pinocchio."""
    robot = pinocchio.buildModelFromUrdf(str(file))
    held = [robot.getJointId(joint) for joint in case.lock]
    robot = pinocchio.buildReducedModel(robot, held, np.zeros(robot.nq)) if held else robot
    data, order = robot.createData(), [robot.joints[robot.getJointId(joint)].idx_v for joint in joints]
    found = np.empty_like(q)
    for k in range(len(q)):
        state = np.zeros((3, robot.nv))
        state[:, order] = q[k], v[k], a[k]
        found[k] = pinocchio.rnea(robot, data, *state)[order]
    return found


def answer_of_command(folder, name, case, base):
    """Base parameters (b,) of the recording NAME.csv, with all rows fitted."""
    given = ["--robot", case.robot, *(word for joint in case.lock for word in ("--lock", joint))]
    given += ["--terms", "viscous,coulomb,offset", "--cutoff", case.cutoff, "--methods", "wls", "--folds", 2]
    graphdyn_command(folder, "identify", f"{name}.csv", *given, "--json", f"{name}-found.json")
    record = json.loads((folder / f"{name}-found.json").read_text(encoding="utf-8"))
    return base.values(next(one for one in record["methods"] if one["name"] == "WLS")["parameters"])


def check(folder, name, case):
    """Print what was found beside what was promised; whether every ratio is within the bounds."""
    named = not case.robot.endswith(".urdf")
    file = locate(case.robot)[0] if named else folder / case.robot
    model = urdf.load(case.robot if named else file, lock=dict.fromkeys(case.lock, 0.0))
    joints = model.independent_joints
    plan, series = plan_of(folder, name, case, joints)
    spreads = {one["name"]: one["spread"] for one in plan["parameters"]}  # of drives, which are base parameters alone
    drives = [np.array([spreads[f"{sort}_{k + 1}"] for k in range(len(joints))]) for sort in ("FV", "FC", "OFF")]
    t = sample_times(case, case.rate)
    q, v, a = motion_of(case, series, t)
    tau = rigid_torques(file, case, joints, q, v, a) + drives[0] * v + drives[1] * np.sign(v) + drives[2]

    torque_model = TorqueModel(model, (RigidBodies(), Viscous(), Coulomb(), Offset()))
    cutoffs = {"none": None, "residual": "residual"}
    preparation = Preparation(cutoffs[case.cutoff] if case.cutoff in cutoffs else float(case.cutoff))
    rng, found = np.random.default_rng(SEED), []
    for draw in range(DRAWS):
        seen, measured = (x + s * rng.standard_normal(q.shape) for x, s in ((q, case.position), (tau, plan["noise"])))
        if draw == 0:
            write_recording(folder / f"{name}.csv", joints, t, q=seen, tau=measured)
        recording = preparation.differentiated(Recording(joints, t, seen, tau=measured))
        problem = Problem(torque_model, preparation.samples(recording))
        base = problem.structure.base
        found.append(base.values(WeightedLeastSquares().estimate(problem).parameters))
    names = [one["name"] for one in plan["parameters"]]
    if names != list(base.names([column.symbol for column in torque_model.columns])):
        raise SystemExit(f"{name}: the plan has other base parameters")

    values, truth = np.array(found), base.values(np.concatenate([model.inertial_parameters, *drives]))
    sigma, told, plain = (
        np.array([one[key] for one in plan["parameters"]]) for key in ("encoder_sigma", "bias", "sigma")
    )
    ratio, bias, told = values.std(axis=0, ddof=1) / sigma, (values.mean(axis=0) - truth) / sigma, told / sigma
    command = np.abs(answer_of_command(folder, name, case, base) - values[0]).max() / sigma.min()
    worst = np.abs(bias - told).argmax()
    print(
        f"{name}: {len(ratio)} parameters, found / promised σ {ratio.min():.2f} to {ratio.max():.2f}, mean "
        f"{np.exp(np.log(ratio).mean()):.3f}; σ with encoder / σ up to {(sigma / plain).max():.3g}; bias up to "
        f"{np.abs(bias).max():.3g} σ, told {told[worst]:.2f} and found {bias[worst]:.2f} σ at worst; "
        f"the command differs by {command:.1g} σ",
        flush=True,
    )
    return bool(ratio.min() >= LEAST and ratio.max() <= LARGEST)


def main():
    folder, names = Path(sys.argv[1]), sys.argv[2:] or list(CASES)
    folder.mkdir(exist_ok=True)
    make_robots(folder)
    with one_thread():
        kept = [check(folder, name, CASES[name]) for name in names]
    print(f"{sum(kept)} of {len(kept)} cases within {LEAST} … {LARGEST}")
