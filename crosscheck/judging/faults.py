"""Common faults of dynamics codes, put into graphdyn one at a time: the torques of a code that has this fault."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.judging.experiments import Function, torques
from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn._inertia import parameters_from_inertia
from graphdyn._rotation import rotation_about
from graphdyn.layout import Array, parameter_columns
from urdf._rpy import rpy_from_rotation

MOST_SUBSETS = 7
"""Largest number of joints for which every set of reversed axes is tried (2^n); beyond, single axes and all."""

E1, E2, E3 = np.eye(3)


@dataclass(frozen=True, eq=False)
class Fault:
    """One fault: its kind, message and remedy, and the torques of a code that has it."""

    kind: str
    message: str
    remedy: str
    torque: Function


def faults(model: RobotModel, links: Mapping[str, tuple[int, Array]]) -> Iterator[Fault]:
    """All faults, the likelier of two indistinguishable ones first.

    links: fixed links by name: number of the body that they are fused into, and what they contribute to its
        inertial parameters (10,)
    """
    yield from _signs(model)
    yield from _fixed_links(model, links)
    yield from _units(model)
    yield from _angles(model)
    yield from _frames(model)
    yield from _inertials(model)
    yield from _reversed_axes(model, _larger_sets(model.n_bodies))


def _signs(model: RobotModel) -> Iterator[Fault]:
    own, names = torques(model), model.joint_names
    yield Fault("sign", "all torques have the opposite sign", "negate the result", lambda q, v, a: -own(q, v, a))
    yield from _reversed_axes(model, [[k] for k in range(model.n_bodies)])
    for k, name in enumerate(names):
        s = np.where(np.arange(model.n_bodies) == k, -1.0, 1.0)
        yield Fault(
            "sign",
            f"the torque of joint '{name}' has the opposite sign",
            "negate it",
            lambda q, v, a, s=s: s * own(q, v, a),  # type: ignore[misc]
        )
        yield Fault(
            "sign",
            f"the motion of joint '{name}' is taken with the opposite sign, its torque is not",
            "use one sense for motion and torque",
            lambda q, v, a, s=s: own(s * q, s * v, s * a),  # type: ignore[misc]
        )
    yield from _of_bodies(
        model,
        "sign",
        "the products of inertia of {who} have the opposite sign",
        "a tensor holds I_xy = -∫xy dm; some programs print +∫xy dm",
        lambda body, _: dataclasses.replace(body, inertia=2 * np.diag(np.diag(body.inertia)) - body.inertia),
    )
    yield from _of_bodies(
        model,
        "sign",
        "the centre of mass of {who} lies on the other side of the link origin",
        "negate it",
        lambda body, _: dataclasses.replace(body, center_of_mass=-body.center_of_mass),
    )


def _reversed_axes(model: RobotModel, sets: Iterable[Sequence[int]]) -> Iterator[Fault]:
    own = torques(model)
    for joints in sets:
        s = np.where(np.isin(np.arange(model.n_bodies), joints), -1.0, 1.0)
        yield Fault(
            "sign",
            f"the axis of {_joints_said(model, joints)} points the other way",
            "reverse the axis, or negate position, velocity, acceleration and torque of the joint",
            lambda q, v, a, s=s: s * own(s * q, s * v, s * a),  # type: ignore[misc]
        )


def _fixed_links(model: RobotModel, links: Mapping[str, tuple[int, Array]]) -> Iterator[Fault]:
    heavy = [name for name, (_, share) in links.items() if share.any()]
    sets = [[name] for name in heavy] + ([heavy] if len(heavy) > 1 else [])
    for names in sets:
        parameters = np.array(model.inertial_parameters)
        for name in names:
            body, contribution = links[name]
            parameters[parameter_columns(body)] -= contribution
        bodies = ", ".join(dict.fromkeys(f"'{model.body_names[links[name][0] - 1]}'" for name in names))
        yield Fault(
            "fixed_link",
            f"the mass of {_who('fixed link', names)} is left out",
            f"add mass, first moment and inertia to {bodies}, which carries it",
            _linear(model, parameters),
        )


def _units(model: RobotModel) -> Iterator[Fault]:
    own, angle = torques(model), np.array([not joint.is_prismatic for joint in model.joints])
    degrees = np.where(angle, np.rad2deg(1.0), 1.0)
    for factor, said in ((1 / degrees, "degrees"), (degrees, "radians where the code means degrees")):
        for which, what in ((slice(0, 3), "positions, velocities and accelerations"), (slice(0, 1), "positions")):
            yield Fault(
                "unit",
                f"joint {what} are taken as {said}",
                "convert angles to radians when they are read",
                _scaled_input(own, factor, which),
            )
    rpm = np.where(angle, 2 * np.pi / 60, 1.0)
    for factor, said in ((1 / degrees, "degrees per second"), (rpm, "rev/min")):
        yield Fault(
            "unit",
            f"joint velocities are taken as {said}",
            "convert velocities to rad/s when they are read",
            _scaled_input(own, factor, slice(1, 2)),
        )
    for length, said in ((1e3, "millimetres"), (1e2, "centimetres"), (1 / 0.0254, "inches")):
        yield Fault(
            "unit",
            f"the joint placements are in {said}, the rest in metres",
            "convert lengths to metres",
            _with_joints(model, lambda joint, f=length: _moved(joint, f * joint.placement.translation)),  # type: ignore[misc]
        )
    for turn, said in ((np.pi / 180, "degrees"), (180 / np.pi, "radians, but the code means degrees")):
        yield from _of_joints(
            model,
            "unit",
            f"the rpy angles of {{who}} are taken as {said}",
            "URDF gives rpy in radians",
            lambda joint, f=turn: _turned(joint, _rotation(f * _rpy(joint))),  # type: ignore[misc]
        )


def _angles(model: RobotModel) -> Iterator[Fault]:
    """Wrong uses of the angle of a revolute or continuous joint."""
    own = torques(model)
    turning = [k for k, joint in enumerate(model.joints) if not joint.is_prismatic]
    lower, upper = (
        np.array([default if limit is None else limit for limit in limits])
        for limits, default in (
            ([joint.limits.lower for joint in model.joints], -np.inf),
            ([joint.limits.upper for joint in model.joints], np.inf),
        )
    )
    maps: tuple[tuple[str, Callable[[Array], Array]], ...] = (
        ("is clipped at ±π", lambda q: np.clip(q, -np.pi, np.pi)),
        ("is clipped at its limits", lambda q: np.clip(q, lower, upper)),
        ("is replaced by its cosine", np.cos),
        ("is replaced by its sine", np.sin),
        ("is the other angle of (cos, sin), π/2 - q", lambda q: np.pi / 2 - q),
        ("is halved, as in a quaternion", lambda q: q / 2),
        ("is doubled", lambda q: 2 * q),
        ("is held at zero", np.zeros_like),
    )
    for said, change in maps:
        for joints in [*([k] for k in turning), *([turning] if len(turning) > 1 else [])]:
            mask = np.isin(np.arange(model.n_bodies), joints)
            yield Fault(
                "continuous_joint",
                f"the angle of {_joints_said(model, joints)} {said}",
                "a revolute or continuous joint takes its plain angle, any number of turns; Pinocchio's continuous "
                "joints take (cos q, sin q)",
                lambda q, v, a, mask=mask, change=change: own(np.where(mask, change(q), q), v, a),  # type: ignore[misc]
            )


def _frames(model: RobotModel) -> Iterator[Fault]:
    """Wrong placements of the joints: rotations, axes in which translations are expressed, joint axes."""
    place = "compare the placement of the joint frame in the inside body's link frame (forward kinematics)"
    changes: tuple[tuple[str, Callable[[Joint], Joint]], ...] = (
        ("the rotation of {who} is transposed", lambda j: _turned(j, j.placement.rotation.T)),
        ("the rotation of {who} is left out", lambda j: _turned(j, np.eye(3))),
        ("the rpy angles of {who} are applied in the opposite order", lambda j: _turned(j, _opposite(_rpy(j)))),
        (
            "the translation of {who} is expressed in the axes of the joint frame",
            lambda j: _moved(j, j.placement.rotation @ j.placement.translation),
        ),
        (
            "the translation of {who} is expressed in the axes of the joint frame and turned the wrong way",
            lambda j: _moved(j, j.placement.rotation.T @ j.placement.translation),
        ),
        ("the translation of {who} is left out", lambda j: _moved(j, np.zeros(3))),
        ("the translation of {who} has the opposite sign", lambda j: _moved(j, -j.placement.translation)),
        (
            "the placement of {who} is inverted",
            lambda j: dataclasses.replace(
                j, placement=Placement(j.placement.rotation.T, -j.placement.rotation.T @ j.placement.translation)
            ),
        ),
        (
            "the axis of {who} is expressed in the inside body's axes",
            lambda j: dataclasses.replace(j, axis=j.placement.rotation.T @ j.axis),
        ),
    )
    for message, change in changes:
        yield from _of_joints(model, "frame", message, place, change)
    for name, axis in (("x", E1), ("y", E2), ("z", E3)):
        yield from _of_joints(
            model,
            "frame",
            f"the axis of {{who}} is taken as {name}",
            "read the axis from the model",
            lambda joint, axis=axis: dataclasses.replace(joint, axis=axis),  # type: ignore[misc]
        )


def _inertials(model: RobotModel) -> Iterator[Fault]:
    """Wrong centres of mass and tensors: axes, missing entries, exchanged bodies."""
    axes = "the inertial frame's rotation turns the tensor into link axes: R J Rᵀ"
    changes: tuple[tuple[str, Callable[[Body, Array], Body]], ...] = (
        ("the centre of mass of {who} is expressed in the axes of the inside body", lambda b, r: _placed(b, r.T, None)),
        ("the centre of mass of {who} is turned the wrong way", lambda b, r: _placed(b, r, None)),
        ("the tensor of {who} is expressed in the axes of the inside body", lambda b, r: _placed(b, None, r.T)),
        ("the tensor of {who} is turned the wrong way", lambda b, r: _placed(b, None, r)),
        (
            "centre of mass and tensor of {who} are expressed in the axes of the inside body",
            lambda b, r: _placed(b, r.T, r.T),
        ),
        ("centre of mass and tensor of {who} are turned the wrong way", lambda b, r: _placed(b, r, r)),
    )
    for message, change in changes:
        yield from _of_bodies(model, "frame", message, axes, change)
    yield from _of_bodies(
        model,
        "frame",
        "the tensor of {who} is taken in its principal axes as if they were the link axes",
        axes,
        lambda body, _: dataclasses.replace(body, inertia=np.diag(np.linalg.eigvalsh(body.inertia))),
    )
    yield from _of_bodies(
        model,
        "inertial_parameters",
        "the products of inertia of {who} are left out",
        "use the full tensor",
        lambda body, _: dataclasses.replace(body, inertia=np.diag(np.diag(body.inertia))),
    )
    yield from _of_bodies(
        model,
        "inertial_parameters",
        "the centre of mass of {who} is taken at the link origin",
        "use the centre of mass in the link frame",
        lambda body, _: dataclasses.replace(body, center_of_mass=np.zeros(3)),
    )
    pi = model.inertial_parameters.reshape(model.n_bodies, -1)
    for i, k in itertools.combinations(range(model.n_bodies), 2):
        order = list(range(model.n_bodies))
        order[i], order[k] = k, i
        yield Fault(
            "inertial_parameters",
            f"the inertial parameters of bodies '{model.body_names[i]}' and '{model.body_names[k]}' are exchanged",
            "assign them by name",
            _linear(model, pi[order].ravel()),
        )


def _of_joints(
    model: RobotModel, kind: str, message: str, remedy: str, change: Callable[[Joint], Joint]
) -> Iterator[Fault]:
    """The same fault at one joint, for each joint, and at every joint at once."""
    for name in model.joint_names:
        yield Fault(
            kind, message.format(who=f"joint '{name}'"), remedy,
            _with_joints(model, lambda joint, name=name: change(joint) if joint.name == name else joint),  # type: ignore[misc]
        )  # fmt: skip
    if model.n_bodies > 1:
        yield Fault(kind, message.format(who="every joint"), remedy, _with_joints(model, change))


def _of_bodies(
    model: RobotModel, kind: str, message: str, remedy: str, change: Callable[[Body, Array], Body]
) -> Iterator[Fault]:
    """The same fault at one body, for each body, and at every body at once; change(body, rotation of its joint)."""
    changed = []
    for body, joint in zip(model.bodies, model.joints, strict=True):
        other = change(body, joint.placement.rotation)
        changed.append(parameters_from_inertia(other.mass, other.center_of_mass, other.inertia))
    for k, name in enumerate(model.body_names, start=1):
        parameters = np.array(model.inertial_parameters)
        parameters[parameter_columns(k)] = changed[k - 1]
        yield Fault(kind, message.format(who=f"body '{name}'"), remedy, _linear(model, parameters))
    if model.n_bodies > 1:
        yield Fault(kind, message.format(who="every body"), remedy, _linear(model, np.concatenate(changed)))


def _linear(model: RobotModel, parameters: Array) -> Function:
    return torques(model.with_inertial_parameters(parameters))


def _with_joints(model: RobotModel, change: Callable[[Joint], Joint]) -> Function:
    return torques(dataclasses.replace(model, joints=tuple(map(change, model.joints))))


def _scaled_input(own: Function, factor: Array, which: slice) -> Function:
    def torque(*state: Array) -> Array:
        chosen = range(3)[which]
        return own(*(factor * x if k in chosen else x for k, x in enumerate(state)))

    return torque


def _turned(joint: Joint, rotation: Array) -> Joint:
    return dataclasses.replace(joint, placement=Placement(rotation, joint.placement.translation))


def _moved(joint: Joint, translation: Array) -> Joint:
    return dataclasses.replace(joint, placement=Placement(joint.placement.rotation, translation))


def _placed(body: Body, center: Array | None, tensor: Array | None) -> Body:
    """Rotations applied to the centre of mass and to the tensor."""
    return dataclasses.replace(
        body,
        center_of_mass=body.center_of_mass if center is None else center @ body.center_of_mass,
        inertia=body.inertia if tensor is None else tensor @ body.inertia @ tensor.T,
    )


def _rpy(joint: Joint) -> Array:
    return rpy_from_rotation(joint.placement.rotation)


def _rotation(rpy: Array) -> Array:
    """R_z(yaw) R_y(pitch) R_x(roll)."""
    roll, pitch, yaw = rpy
    return rotation_about(E3, yaw) @ rotation_about(E2, pitch) @ rotation_about(E1, roll)


def _opposite(rpy: Array) -> Array:
    """R_x(roll) R_y(pitch) R_z(yaw)."""
    roll, pitch, yaw = rpy
    return rotation_about(E1, roll) @ rotation_about(E2, pitch) @ rotation_about(E3, yaw)


def _larger_sets(n: int) -> Iterator[tuple[int, ...]]:
    """Sets of two and more joints, small ones first."""
    for size in range(2, n + 1) if n <= MOST_SUBSETS else [n]:
        yield from itertools.combinations(range(n), size)


def _joints_said(model: RobotModel, joints: Sequence[int]) -> str:
    every = len(joints) == model.n_bodies > 1
    return "every joint" if every else _who("joint", [model.joint_names[k] for k in joints])


def _who(what: str, names: list[str]) -> str:
    """joint 'a'; joints 'a', 'b'"""
    return f"{what}{'s' if len(names) > 1 else ''} {', '.join(repr(name) for name in names)}"
