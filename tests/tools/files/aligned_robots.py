"""How well two descriptions of one robot are aligned and compared: python tests/tools aligned_robots [PAIRS [ROBOT…]].

Pairs: a robot and the same robot with three things changed at once: senses, zeros, base, last link frame, all link
frames, names, limits left out. Counted are the maps with which B moves like A, and printed is the largest error of
torques and of the flange, as a part of the largest torque and of the reach. Planted: one link of B has another mass
(5 %), center (5 mm), tensor (10 %), length (1 mm) or axis (0.1°), in half of the cases disguised as above. Counted are
the cases in which exactly that link and kind is named, in which it is named with others, in which others alone are
named, and in which nothing differs; the last happens where the difference does not show: the axis of a joint that may
be moved along itself, a length before the first joint, which base and tool absorb.

The robots are names or files, with @LINK up to a tip; or `tuned` or `aside`: arms on which the method was, or was not,
tuned; or `cut`: arms with grippers and one that slides up and down, up to their flanges. --seed changes the
random numbers, --only planted leaves out the pairs, --list prints every case that is not named exactly.
"""

import argparse
import warnings
from collections import Counter

import numpy as np
from robots.disguised import CHANGES, KINDS, disguised, planted
from shared_data import ARMS

import urdf
from graphdyn import frame_placement, joint_torques
from graphdyn.aligning import differences

ASIDE = ("m1013", "kr16_r1610_2", "tx2_60l", "ur10e", "crx10ia_l", "vs060", "talos_left_arm", "mk3")
"""Arms on which nothing was tuned."""

BY_NAME = ("ur5", "ur10", "kr500", "panda")
CUT = {"j2s6s200_standalone": "j2s6s200_link_6", "piper": "link6", "vx300s": "vx300s/gripper_link"}
"""Arms with grippers, and the tips that cut these off."""

CUT_BY_NAME = ("tiago@arm_7_link", "panda@panda_link8")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("pairs", type=int, nargs="?", default=200)
    parser.add_argument("robots", nargs="*", default=["tuned"])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=("pairs", "planted"))
    parser.add_argument("--list", action="store_true")
    asked = parser.parse_args()
    names = arms(*asked.robots) if asked.robots in (["tuned"], ["aside"], ["cut"]) else asked.robots
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", urdf.URDFWarning)
        models = [loaded(name) for name in names]
    rng = np.random.default_rng(asked.seed)
    if asked.only != "planted":
        pairs(models, asked.pairs, rng, asked.list)
    if asked.only != "pairs":
        plants(models, asked.pairs, rng, asked.list)


def loaded(name: str):
    """A robot, up to the tip that stands behind @."""
    robot, _, tip = name.partition("@")
    if not tip:
        return urdf.load(robot, mimic="locked")
    return urdf.load(robot, chain=(urdf.load(robot).base_name, tip))


def arms(which: str) -> list[str]:
    """Names and files of the robots of a share."""
    if which == "cut":
        return [*(f"{ARMS / name}.urdf@{tip}" for name, tip in CUT.items()), *CUT_BY_NAME]
    known = [path for path in sorted(ARMS.glob("*.urdf")) if path.stem not in CUT]
    chosen = [str(path) for path in known if (path.stem in ASIDE) == (which == "aside")]
    return chosen + [name for name in BY_NAME if which == "tuned" and name != "panda"]


def pairs(models, number, rng, listed) -> None:
    """Pairs of one robot."""
    right, same, errors = 0, 0, np.zeros(2)
    for k in range(number):
        model = models[k % len(models)]
        changes = rng.choice(CHANGES, 3, replace=False)
        found = differences(model, disguised(model, rng, changes)[0], samples=10)
        size = errors_of(model, found.alignment.model, rng)
        good = found.verdict == "same model" or ("limits" in changes and not (found.joints or found.links))
        right, same = right + (size.max() < 1e-9), same + good
        errors = np.maximum(errors, size)
        if listed and not (good and size.max() < 1e-12):
            print("pair", model.name, changes, size, found.verdict, found.joints, found.links)
    print(f"{number} pairs: {right} maps of the right class, {same} models the same")
    print(f"largest error of torques {errors[0]:.1e}, of the flange {errors[1]:.1e}")


def errors_of(model, again, rng):
    """Largest difference of torques and of the flange, as parts of the largest torque and of the reach."""
    q, v = model.random_state(rng, 20)
    tau, other = joint_torques(model, q, v, v), joint_torques(again, q, v, v)
    name = model.body_names[-1]
    here, there = (frame_placement(each, q, name)[1] for each in (model, again))
    scale = np.abs(tau).max() or 1.0
    return np.array([np.abs(other - tau).max() / scale, np.abs(here - there).max() / np.abs(here).max()])


def plants(models, number, rng, listed) -> None:
    """Planted differences."""
    counts, k, most, several = Counter(), 0, 0, 0
    while k < number:
        model, kind = models[k % len(models)], KINDS[int(rng.integers(len(KINDS)))]
        j = int(rng.integers(1, model.n_bodies + 1))
        link = model.bodies[j - 1]
        if kind not in ("length", "axis") and not (link.mass and link.inertia.any()):
            continue
        other = planted(model, rng, kind, j)
        changes = rng.choice(CHANGES, 3, replace=False) if k % 2 else ()
        found = differences(model, disguised(other, rng, changes)[0], samples=10)
        told = told_of(model, found)
        where = (model.joint_names[j - 1] if kind in ("length", "axis") else link.name, kind)
        true = [where in each for each in told]
        result = "nothing" if not told else "exactly" if all(true) else "with others" if any(true) else "others"
        counts[kind, result] += 1
        k += 1
        named = max(map(len, told), default=0)
        most, several = max(most, named), several + (result == "exactly" and named > 1)
        if listed and result != "exactly":
            print(
                result,
                model.name,
                "massless" if not link.mass else "",
                where,
                j,
                list(changes),
                found.joints,
                found.links,
            )
    for kind in KINDS:
        print(f"{kind:8}", {name: number for (of, name), number in sorted(counts.items()) if of == kind})
    total = Counter()
    for (_, name), one in counts.items():
        total[name] += one
    print(f"{number} planted:", dict(total), f"of these exactly, {several} with other causes, {most} at most")


def told_of(model, found):
    """Of everything that is named the causes that it may have."""
    told = [{(each.joint, each.kind), *causes(each)} for each in found.joints]
    told += [{(each.link, each.kind), *causes(each)} for each in found.links]
    return [{(name, "axis" if kind == "angle" else kind) for name, kind in each} for each in told]


def causes(difference):
    return {(each.element, each.kind) for each in difference.or_else}
