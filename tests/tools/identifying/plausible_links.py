"""Whether recommended links are plausible, and what the limits cost: python tests/tools plausible_links [SEED…].

Makers' arms and those of example-robot-data are simulated with friction, noise, and CAD masses and centers that are
wrong by up to 30 %. Every second one has springs and Stribeck friction that the torque model lacks, which drives links
to odd places. Each is identified with limits and without. Printed per arm: the recommended method; masses and centers
of the links inside of their limits; those told as undetermined, and those that are neither; the largest ratio of a
determined mass and that of CAD; the held-out error of the recommended result relative to the best without limits; and
warnings of inspect about the written file that the file with the CAD values does not have.

`recordings` in place of seeds does the same for the recordings of docs/industrial_arms.md, one row for every method,
errors relative to those with --cad-factor inf.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from shared_data import ARMS, DATA, REPOSITORY

import urdf
from crosscheck.commands.identify.command import new_warnings
from crosscheck.identifying import OtherRecordings, Preparation, friction_terms, identify, virtual_robot
from crosscheck.identifying.methods.methods import Labeled, method_named
from crosscheck.identifying.results.link_findings import link_findings
from crosscheck.identifying.results.recommending import mean_error, recommendation
from crosscheck.identifying.virtual import as_in_cad
from graphdyn import InvalidInput
from graphdyn.identification import (
    ConsistentLeastSquares,
    ConsistentWithPrior,
    PhysicalLimits,
    RobustConsistent,
    WeightedLeastSquares,
)
from graphdyn.identification.terms import RigidBodies
from urdf import Reading

ROBOTS = (
    *("ur3", "ur5", "ur10", "kinova", "xarm7"),
    *("aubo_i5", "m1013", "ur5e", "ur10e", "crx10ia_l", "dof6xarm", "vs060", "z1", "PAROL6", "kr210_r2700_2"),
)
"""Names of the catalog, and files of makers' arms that have masses and limits of velocity."""

SEEDS = (0, 2)
"""The first while limits were chosen, the second kept aside."""

CAD_ERROR = 0.3
SECONDS = 10.0
KNOWN, LACKING = ("viscous", "coulomb", "offset"), ("viscous", "coulomb", "offset", "stribeck", "spring")
FREE = PhysicalLimits(cad_factor=np.inf, in_boxes=False)
INSIDE = 1 + 1e-4
"""Largest rounding of a value at its limit."""


def constrained(limits):
    return (ConsistentLeastSquares(limits), ConsistentWithPrior(limits=limits), RobustConsistent(limits=limits))


def simulated(name, seed, lacking):
    """The identification of a simulated arm, its file, and whether it could be done."""
    file = name if (ARMS / f"{name}.urdf").exists() is False else str(ARMS / f"{name}.urdf")
    arm = virtual_robot(file, friction_terms(LACKING if lacking else KNOWN), seconds=SECONDS, seed=seed)
    rng = np.random.default_rng(seed)
    cad = as_in_cad(urdf.load(file), rng, CAD_ERROR)
    free = [Labeled(method, f"{method.name}, free") for method in constrained(FREE)]
    found = identify(
        cad,
        arm.fitted,
        terms=(RigidBodies(), *friction_terms(KNOWN)),
        methods=[WeightedLeastSquares(), *constrained(PhysicalLimits()), *free],
        preparation=Preparation(cutoff=10.0),
        held_out=OtherRecordings((arm.held_out,)),
        poses=200,
    )
    return file, found


def chosen(found, free):
    """The candidate that is recommended among those with limits, or among those without; CAD is among both."""
    of_kind = [c for c in found.candidates if c.model.cad_of is not None or c.result.name.endswith(", free") == free]
    name = recommendation(of_kind).name
    return next((c for c in of_kind if c.name == name), None)


def links(found, candidate):
    """Numbers of masses and centers inside, told, and neither; the largest ratio of an untold mass and CAD."""
    limits, estimate = candidate.result.estimate.limits, candidate.result.estimate
    if limits is None:
        return len(found.torque_model.model.bodies) * 4, 0, 0, 1.0
    told = {(each.body, each.quantity) for each in limits.reached(estimate.parameters)}
    inside = lost = 0
    ratios = [1.0]
    for k, part in enumerate(limits.columns):
        name, mass, *moments = limits.names[k], *estimate.parameters[part][:4]
        low, high = limits.mass[k]
        kept = {("mass"): low / INSIDE <= mass <= high * INSIDE}
        for axis, moment, (first, last) in zip("xyz", moments, limits.box[k].T, strict=True):
            room = (INSIDE - 1) * (last - first)
            kept[f"center of mass in {axis}"] = first - room <= moment / mass <= last + room
        for quantity, is_inside in kept.items():
            inside += is_inside and (name, quantity) not in told
            lost += not is_inside and (name, quantity) not in told
        if (name, "mass") not in told:
            ratios.append(max(mass / limits.cad_mass[k], limits.cad_mass[k] / mass))
    return inside, len(told), lost, float(np.nanmax(ratios))


def warned(file, found, candidate):
    """Codes of new warnings of inspect, of the written file against that with the values of CAD."""
    with tempfile.TemporaryDirectory() as folder:
        before, after = Path(folder) / "cad.urdf", Path(folder) / "identified.urdf"
        model = found.torque_model.model
        try:
            urdf.update(file, before, model.inertial_parameters.reshape(-1, 10), inconsistent=True)
            urdf.update(before, after, found.model_of(candidate.result).body_parameters(candidate.result))
        except urdf.CannotUpdate:  # fixed links keep their inertials, and the rest would be no real body
            return ["cannot be written"]
        return [finding.code for finding in new_warnings(str(before), after, Reading())]


def row(name, seed, lacking):
    try:
        file, found = simulated(name, seed, lacking)
    except InvalidInput as error:
        print(f"{name:14} {seed:4} {'yes' if lacking else 'no':>7}  cannot be simulated: {error}", flush=True)
        return None
    best, free = chosen(found, free=False), chosen(found, free=True)
    if best is None or free is None:
        print(f"{name:14} {seed:4} {'yes' if lacking else 'no':>7}  nothing is recommended", flush=True)
        return None
    inside, told, lost, ratio = links(found, best)
    cost = mean_error(best.result) / mean_error(free.result) - 1
    warnings = warned(file, found, best)
    notes = [finding.code for finding in link_findings(found, best.result) if finding.code == "cad-mass"]
    print(
        f"{name:14} {seed:4} {'yes' if lacking else 'no':>7}  {best.name:28} {inside:6} {told:5} {lost:8} {ratio:6.2f} "
        f"{100 * mean_error(best.result):7.3f} {100 * cost:+7.2f}  {', '.join(warnings + notes)}",
        flush=True,
    )
    return inside, told, lost, cost, len(warnings)


def simulations(seeds):
    print("Simulated arms, CAD wrong by up to 30 %: masses and centers of recommended links")
    numbers = f"{'inside':>6} {'told':>5} {'neither':>8} {'ratio':>6} {'error %':>7} {'cost %':>7}"
    print(f"{'arm':14} {'seed':>4} {'lacking':>7}  {'recommended':28} {numbers}  new warnings")
    cases = [(name, seed, (k + seed) % 2 == 1) for seed in seeds for k, name in enumerate(ROBOTS)]
    rows = np.array([found for case in cases if (found := row(*case)) is not None])
    print(
        f"{len(rows)} of {len(cases)} recommended: {rows[:, 0].sum():.0f} inside, {rows[:, 1].sum():.0f} told, "
        f"{rows[:, 2].sum():.0f} neither; error {100 * rows[:, 3].mean():+.2f} % in the mean, "
        f"{100 * rows[:, 3].max():+.2f} % at worst; {np.count_nonzero(rows[:, 4])} files with new warnings"
    )


MAPPINGS = REPOSITORY / "docs" / "recordings"
UR10, TX40, KR300 = (DATA / "data" / arm for arm in ("ur10", "tx40", "kr300"))

COMMANDS = {
    "ur10": [
        UR10 / "ur10_free_motion.csv", "--robot", "ur10", "--mapping", MAPPINGS / "ur10.toml", "--cutoff", 8,
        "--models", "smooth.toml", "--split-rows", "60:1700", "1750:",
    ],
    "tx40": [
        TX40 / "pos_read_data.csv", TX40 / "curr_data.csv", "--robot", TX40 / "tx40.urdf", "--mapping",
        MAPPINGS / "tx40.toml", "--cutoff", 20, "--decimate", "10,10", "--terms",
        "viscous,coulomb,offset,rotor,coupled-wrist", "--width", 0.05, "--split", "0:6", "6:9",
    ],
    "kr300": [
        KR300 / "kr300_A.csv", "--robot", "kr300_150.urdf", "--mapping", MAPPINGS / "kr300.toml", "--cutoff", 8,
        "--min-speed", 0.02, "--scaled-torque", f"{MAPPINGS / 'kr300.py'}:counterbalance", "--terms",
        "viscous,coulomb,offset,rotor", "--split", "0:7", "7:10",
    ],
}  # fmt: skip

MODEL_NAMES = {"ur10": "smooth: "}
"""What stands before the names of methods where the torque model has a name."""

METHODS = "consistent,entropic,consistent-huber,entropic-huber"


def make_inputs(folder):
    """What the commands read and the shared data do not have: a robot file, and the second torque model of the UR10."""
    figures = [MAPPINGS / "kr300.py", KR300 / "kr300.json", folder / "kr300_150.urdf", "150"]
    subprocess.run([sys.executable, *map(str, figures)], check=True)
    models = (MAPPINGS / "ur10_models.toml").read_text(encoding="utf-8")
    (folder / "smooth.toml").write_text(models[models.index("[smooth]") :], encoding="utf-8")


def recordings():
    print(f"{'arm':6} {'method':34} {'error %':>8} {'cost %':>7} {'masses [kg]':44} told")
    with tempfile.TemporaryDirectory() as folder:
        make_inputs(Path(folder))
        for arm in COMMANDS:
            for method in METHODS.split(","):
                limited, free = (_record(Path(folder), arm, method, more) for more in ([], ["--cad-factor", "inf"]))
                error, without = (_error(record) for record in (limited, free))
                shown = limited["shown"]
                masses = " ".join(f"{body['identified']['m']:.3g}" for body in shown["bodies"])
                told = "; ".join(f"{each['body']} {each['quantity']}".strip() for each in shown["reached_limits"])
                cost = 100 * (error / without - 1)
                print(f"{arm:6} {shown['method']:34} {100 * error:8.3f} {cost:+7.2f} {masses:44} {told}", flush=True)


def _record(folder, arm, method, more):
    path = folder / "found.json"
    command = [sys.executable, "-m", "crosscheck", "identify", *COMMANDS[arm], "--methods", method]
    environment = {**os.environ, "KR300_JSON": str(KR300 / "kr300.json")}
    name = f"{MODEL_NAMES.get(arm, '')}{method_named(method).name}"
    wanted = [*command, *more, "--poses", "100", "--choose", name, "--json", path]
    done = subprocess.run(list(map(str, wanted)), cwd=folder, env=environment, check=False, capture_output=True)
    if done.returncode not in (0, 1):
        raise SystemExit(done.stderr.decode())
    return json.loads(path.read_text(encoding="utf-8"))


def _error(record):
    return next(row["mean_error"] for row in record["comparison"] if row["name"] == record["shown"]["name"])


def main():
    if sys.argv[1:] == ["recordings"]:
        recordings()
        return
    simulations([int(seed) for seed in sys.argv[1:]] or SEEDS)
