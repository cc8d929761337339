"""Models in Pinocchio's own form: read from a file, built from a RobotModel, changed."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from graphdyn import Body, GraphDynError, Placement, RobotModel
from graphdyn.layout import Array
from urdf import Xacro
from urdf.document import content_of, is_expanded


@contextmanager
def kept_standard_error() -> Iterator[list[str]]:
    """Collect standard error, where C++ writes past Python; at the end the list holds its lines.

    It is that of the whole process.
    """
    written: list[str] = []
    kept = os.dup(2)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        try:
            yield written
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            file.seek(0)
            written += file.read().decode(errors="replace").splitlines()


PINOCCHIO_VERSION: str = pin.__version__

UNIVERSE = "universe"
"""Name of joint 0 in every model of Pinocchio, which finds joints by name."""


class PinocchioRefuses(GraphDynError, ValueError):
    """Pinocchio cannot build this file, or builds a robot with other joints or links.

    said: what its reader wrote about the file
    """

    def __init__(self, problem: str, said: tuple[str, ...] = ()):
        self.said = said
        super().__init__(problem)


def read(path: Path, xacro: Xacro | None = None) -> pin.Model:
    """Pinocchio's own reading of a URDF file; of a .xacro or MJCF file, its expansion. Raises what Pinocchio raises."""
    if is_expanded(path):
        return pin.buildModelFromXML(content_of(path, xacro).decode())
    return pin.buildModelFromUrdf(str(path))


def built(model: RobotModel) -> pin.Model:
    """The RobotModel, built body by body through Pinocchio's API, on a ground at the origin of the world."""
    native = pin.Model()
    native.name = model.name
    ids = {0: 0}

    def add_outside(i: int) -> None:  # depth first: Pinocchio's algorithms rely on that order
        for j in model.graph.outside(i):
            joint, body = model.joints[j - 1], model.bodies[j - 1]
            # a continuous joint is a plain angle here: the (cos, sin) joint takes no axis in the Python bindings
            kind = pin.JointModelPrismaticUnaligned if joint.is_prismatic else pin.JointModelRevoluteUnaligned
            ids[j] = native.addJoint(ids[i], kind(np.array(joint.axis)), se3(joint.placement), joint.name)
            native.appendBodyToJoint(ids[j], _inertia(body), pin.SE3.Identity())
            native.addBodyFrame(body.name, ids[j], pin.SE3.Identity(), 0)
            add_outside(j)

    add_outside(0)
    for frame in model.frames:
        native.addBodyFrame(frame.name, ids[frame.body], se3(frame.placement), 0)
    return native


def with_kinds_for_axes(native: pin.Model) -> pin.Model:
    """The same robot, without frames, with Pinocchio's faster kinds of joints about x, y and z.

    Its reader of files makes them too.
    """
    aligned = pin.Model()
    aligned.gravity = native.gravity
    for k in range(1, native.njoints):
        joint = native.joints[k].extract()
        for kind, of_axes in KINDS_FOR_AXES.items():
            if isinstance(joint, kind):
                along = np.flatnonzero((joint.axis == np.eye(3)).all(axis=1))
                joint = of_axes[along[0]]() if along.size else joint
        aligned.addJoint(native.parents[k], joint, native.jointPlacements[k], native.names[k])
        aligned.appendBodyToJoint(k, native.inertias[k], pin.SE3.Identity())
    return aligned


KINDS_FOR_AXES = {
    pin.JointModelRevoluteUnaligned: (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ),
    pin.JointModelPrismaticUnaligned: (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ),
}
"""Kinds of joints for the axes x, y and z, by the kind for any axis."""


def held(native: pin.Model, lock: Mapping[str, float]) -> pin.Model:
    """The model with these joints held still at these values [rad or m]."""
    reference = pin.neutral(native)
    for name, value in lock.items():
        write_position(native.joints[native.getJointId(name)], reference, value)
    return pin.buildReducedModel(native, [native.getJointId(name) for name in lock], reference) if lock else native


def moved(native: pin.Model, base: Placement) -> pin.Model:
    """A copy of the model with its ground frame moved by the placement base."""
    native = pin.Model(native)
    for k in range(1, native.njoints):
        if native.parents[k] == 0:
            native.jointPlacements[k] = se3(base) * native.jointPlacements[k]
    for k, frame in enumerate(native.frames):
        if frame.parentJoint == 0:
            native.frames[k].placement = se3(base) * frame.placement
    return native


def se3(placement: Placement) -> pin.SE3:
    return pin.SE3(np.array(placement.rotation), np.array(placement.translation))


def write_position(joint: pin.JointModel, full: Array, value: float) -> None:
    """Write one joint position into Pinocchio's q; a continuous joint takes two entries, (cos, sin)."""
    full[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (np.cos(value), np.sin(value))


def _inertia(body: Body) -> pin.Inertia:
    """Inertia from mass, center and tensor; from the ten parameters where Pinocchio refuses a tensor that is not
    positive."""
    if np.linalg.eigvalsh(body.inertia)[0] < 0:
        return pin.Inertia.FromDynamicParameters(np.array(body.parameters))
    return pin.Inertia(body.mass, np.array(body.center_of_mass), np.array(body.inertia))


def function_named(name: str) -> Callable[..., Any]:
    """One of Pinocchio's functions."""
    found: Callable[..., Any] = getattr(pin, name)
    return found
