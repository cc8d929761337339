"""Wrong uses of the angle of a revolute or continuous joint."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from crosscheck.judging.experiments import torques
from crosscheck.judging.faults.changes import joints_said
from crosscheck.judging.faults.fault import Fault
from graphdyn import RobotModel
from graphdyn.layout import Array


def angles(model: RobotModel) -> Iterator[Fault]:
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
                f"the angle of {joints_said(model, joints)} {said}",
                "a revolute or continuous joint takes its plain angle, any number of turns; Pinocchio's continuous "
                "joints take (cos q, sin q)",
                lambda q, v, a, mask=mask, change=change: own(np.where(mask, change(q), q), v, a),  # type: ignore[misc]
            )
