"""Regressors: the Newton-Euler equations as linear functions of the ten inertial parameters of each body.

Atkeson, An and Hollerbach, "Estimation of inertial parameters of manipulator loads and links", International Journal
of Robotics Research 5(3), 1986. In link axes, because the parameters are.
"""

from __future__ import annotations

import numpy as np

from graphdyn.layout import ANGULAR, BODY_DOF, BODY_PARAMETERS, LINEAR
from graphdyn.recursions.declarations import ArraySpec, recursion, recursion_of_torques
from graphdyn.recursions.mechanism.mechanism import Link, Links
from graphdyn.recursions.motion import BodyMotion, JointPlacement, Root, motions, places, resting_root
from graphdyn.scalars.vectors import E_Z, PerJoint, Scalars, cross, skew, zeros


@recursion(body_regressor=ArraySpec(("bodies", BODY_DOF, BODY_PARAMETERS), "N, N m per parameter"))
def body_regressor(links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint) -> list[Scalars]:
    """Y (6, 10) of every body: Y π is the wrench that its motion takes, about O_j, in link axes."""
    moving = motions(links, places(links, q), root, v, a)
    return [of_moving_body(_in_link_axes(link, motion)) for link, motion in zip(links, moving, strict=True)]


@recursion_of_torques(joint_torque_regressor=ArraySpec(("n", "10 bodies"), "N m or N per parameter"))
def joint_torque_regressor(links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint) -> Scalars:
    """W (n, 10 n): row j, columns of body i: the wrench of body i along joint j, if j is between it and the root."""
    at = places(links, q)
    moving = motions(links, at, root, v, a)
    matrix = zeros(len(links), BODY_PARAMETERS * len(links))
    screws: list[dict[int, tuple[Scalars, Scalars]]] = []
    for i, (link, place) in enumerate(zip(links, at, strict=True)):
        carried = screws[link.inside] if link.inside >= 0 else {}
        screws.append({j: _outwards(place, *screw) for j, screw in carried.items()})
        screws[i][i] = (E_Z, zeros(3)) if link.prismatic else (zeros(3), E_Z)
        columns = slice(BODY_PARAMETERS * i, BODY_PARAMETERS * (i + 1))
        body = of_moving_body(_in_link_axes(link, moving[i]))
        for j, (linear, angular) in screws[i].items():
            screw = np.concatenate([link.link_axes @ linear, link.link_axes @ angular])
            matrix[j, columns] = screw @ body
    return matrix


@recursion(momentum_regressor=ArraySpec(("n", "10 bodies"), "kg m²/s or kg m/s per parameter"))
def momentum_regressor(links: Links, q: PerJoint, v: PerJoint) -> Scalars:
    """Momentum regressor of M v (n, 10 n): the torque that accelerations v take at rest without gravity."""
    return joint_torque_regressor(links, resting_root(), q, [0.0] * len(links), v)


def _outwards(place: JointPlacement, linear: Scalars, angular: Scalars) -> tuple[Scalars, Scalars]:
    """Velocity of O_j and ω of body j when its inside body moves so."""
    return place.outwards(linear + cross(angular, place.translation)), place.outwards(angular)


def _in_link_axes(link: Link, motion: BodyMotion) -> BodyMotion:
    q = link.link_axes
    return BodyMotion(q @ motion.omega, q @ motion.alpha, q @ motion.compensated)


def of_moving_body(motion: BodyMotion) -> Scalars:
    y = zeros(6, BODY_PARAMETERS)
    y[LINEAR, 0] = motion.compensated
    y[LINEAR, 1:4] = motion.spread()
    y[ANGULAR, 1:4] = -skew(motion.compensated)
    y[ANGULAR, 4:] = _tensor_columns(motion.alpha) + skew(motion.omega) @ _tensor_columns(motion.omega)
    return y


def _tensor_columns(x: Scalars) -> Scalars:
    """L(x) with I x = L(x) (I_xx, I_xy, I_yy, I_xz, I_yz, I_zz)."""
    return np.array(
        [
            [x[0], x[1], 0.0, x[2], 0.0, 0.0],
            [0.0, x[0], x[1], 0.0, x[2], 0.0],
            [0.0, 0.0, 0.0, x[0], x[1], x[2]],
        ],
        dtype=object,
    )
