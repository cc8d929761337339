"""Wrong uses of the arguments: angles cut off or replaced, arguments ignored or exchanged."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from crosscheck.judging.faults.changes import joints_said
from crosscheck.judging.faults.fault import CodeFault
from graphdyn import RobotModel
from graphdyn.layout import Array


def angles(model: RobotModel) -> Iterator[CodeFault]:
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
    remedy = (
        "a revolute or continuous joint takes its plain angle, any number of turns; Pinocchio's continuous joints take "
        "(cos q, sin q)"
    )
    for said, change in maps:
        for joints in [*([k] for k in turning), *([turning] if len(turning) > 1 else [])]:
            mask = np.isin(np.arange(model.n_bodies), joints)
            yield CodeFault.of(
                "continuous_joint",
                f"the angle of {joints_said(model, joints)} {said}",
                remedy,
                lambda code, mask=mask, change=change: code.taking(  # type: ignore[misc]
                    lambda q, v, a: (np.where(mask, change(q), q), v, a)
                ),
                len(joints),
            )


def arguments(model: RobotModel) -> Iterator[CodeFault]:
    """Arguments that are ignored, or taken for one another."""
    remedy = "compare the order of the arguments: q, v, a"
    for message, state in (
        ("the accelerations are ignored", lambda q, v, a: (q, v, 0 * a)),
        ("the positions are ignored", lambda q, v, a: (0 * q, v, a)),
        ("velocities and accelerations are exchanged", lambda q, v, a: (q, a, v)),
        ("positions and velocities are exchanged", lambda q, v, a: (v, q, a)),
        ("positions and accelerations are exchanged", lambda q, v, a: (a, v, q)),
    ):
        yield CodeFault.of("argument", message, remedy, lambda code, state=state: code.taking(state))  # type: ignore[misc]
    for k, name in enumerate(model.joint_names):
        kept = np.arange(model.n_bodies) != k
        for message, state in (
            (f"the velocity of joint '{name}' is ignored", lambda q, v, a, kept=kept: (q, kept * v, a)),
            (f"the acceleration of joint '{name}' is ignored", lambda q, v, a, kept=kept: (q, v, kept * a)),
        ):
            yield CodeFault.of(
                "argument", message, "pass all entries on",
                lambda code, state=state: code.taking(state),  # type: ignore[misc]
            )  # fmt: skip
