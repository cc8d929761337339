"""Judge one peer on one robot, in a process that may crash: python one.py PEER ROBOT prints JSON. See run.py."""

import importlib
import importlib.metadata
import itertools
import json
import os
import sys
import warnings

import numpy as np
from robot_file import FILE_CAUSES, causes_in

import crosscheck
import graphdyn
import urdf


def main(peer, robot):
    answer = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what libraries print is not the answer
    warnings.simplefilter("ignore")
    json.dump(judged(importlib.import_module(f"peer_{peer}"), robot), answer)


def judged(peer, robot):
    """Verdict per function, diagnoses, and the smallest set of causes without which the library agrees."""
    file = {entry.name: str(entry.path) for entry in urdf.robots()}.get(robot, robot)
    model = urdf.load(robot)
    row = {"package": peer.PACKAGE, "version": importlib.metadata.version(peer.PACKAGE)}
    try:
        functions = peer.load(file, np.array(model.gravity))
    except Exception as error:
        row |= {"agrees": False, "refusal": f"{type(error).__name__}: {' '.join(str(error).split())}"}
    else:
        judgment = crosscheck.judge(robot, **functions)
        row |= {"agrees": bool(judgment.agrees), "errors": _errors(judgment)}
        keys = ("function", "kind", "status", "message")
        row["diagnoses"] = [{key: getattr(diagnosis, key) for key in keys} for diagnosis in judgment.diagnoses]
    if not row["agrees"]:
        row["undone"], row["errors_undone"] = _undone(peer, robot, file, model)
        row["alone"] = _alone(peer, robot, file, model, row["undone"] or [])
    return row


def _undone(peer, robot, file, model):
    """Of all sets of causes, the smallest without which the judge finds agreement, and the errors then."""
    present = causes_in(file)
    known = [cause for cause in peer.CAUSES if cause not in FILE_CAUSES or cause in present]
    sets = [causes for size in range(1, len(known) + 1) for causes in itertools.combinations(known, size)]
    for causes in sorted(sets, key=lambda causes: "fixed links" in causes):
        try:
            functions = peer.load(file, np.array(model.gravity), causes)
        except Exception:
            continue  # the library cannot read the edited file
        if _near(functions, model):
            judgment = crosscheck.judge(robot, **functions)
            if judgment.agrees:
                return list(causes), _errors(judgment)
    return None, None


def _alone(peer, robot, file, model, causes):
    """Of several causes, the diagnoses of each with the others undone."""
    messages = {}
    for cause in causes if len(causes) > 1 else ():
        others = [other for other in causes if other != cause]
        try:
            functions = peer.load(file, np.array(model.gravity), others)
        except Exception as error:
            messages[cause] = [f"{type(error).__name__}: {' '.join(str(error).split())}"]
            continue
        diagnoses = crosscheck.judge(robot, **functions).diagnoses
        messages[cause] = [f"{x.function}: {x.status}: {x.message}" for x in diagnoses]
    return messages


def _near(functions, model):
    """Whether torques at three states within the limits are graphdyn's to 1e-6: what is far away need not be judged."""
    if sorted(functions["joint_names"]) != sorted(model.joint_names):
        return False
    order = [model.joint_names.index(name) for name in functions["joint_names"]]
    limits = [joint.limits for joint in model.joints]
    lower = np.array([-1.0 if limit.lower is None else limit.lower for limit in limits])
    upper = np.array([1.0 if limit.upper is None else limit.upper for limit in limits])
    for part, v, a in np.random.default_rng(0).uniform(0.1, 0.9, (3, 3, len(order))):
        q = lower + part * (upper - lower)
        torque = functions["inverse_dynamics"](q[order], v[order], a[order])
        expected = graphdyn.joint_torques(model, q, v, a)[order]
        if np.abs(torque - expected).max() > 1e-6 * np.abs(expected).max():
            return False
    return True


def _errors(judgment):
    return {name: float(np.max(function.errors["graphdyn"])) for name, function in judgment.functions.items()}


if __name__ == "__main__":
    main(*sys.argv[1:])
