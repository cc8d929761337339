"""Relative errors on scales that cannot vanish: the sizes of the terms that are summed to get a value.

Reference values may cancel to exactly zero, or to rounding: a moment of an upright arm at rest, the acceleration of a
joint that does not move. Each function returns one number per sample (N,).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from graphdyn import RobotModel
from graphdyn.layout import ANGULAR, BODY_PARAMETERS, LINEAR, Array

SHORTEST_LEVER = 1e-3
"""Length added to every lever [m], so that moments have a scale where all levers are zero; far below any arm's."""


PARAMETER_TYPES = (slice(0, 1), slice(1, 4), slice(4, 10))
"""Among the ten inertial parameters of a body: m, m c, I."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """Sizes of the summed terms at N states (N,).

    lever: from the base to a link origin, plus from there to a center of mass   [m]
    arm: how far a point moves per unit of a joint: lever where a joint turns, 1 where one slides   [m or 1]
    omega: ‖ω‖∞ of all bodies                                                    [rad/s]
    slide_rate: largest velocity of a joint that slides                          [m/s]
    velocity, acceleration: of a center of mass                                  [m/s, m/s²]
    turn: ‖ω̇‖ + ‖ω‖², terms of angular accelerations                             [rad/s²]
    compensated: gravity-compensated acceleration, r̈ − g                         [m/s²]
    force, moment: of all bodies together                                        [N, N m]
    spin: of the inertia tensors alone, about any axis                           [N m]
    """

    lever: Array
    arm: Array
    omega: Array
    slide_rate: Array
    velocity: Array
    acceleration: Array
    turn: Array
    compensated: Array
    force: Array
    moment: Array
    spin: Array

    @property
    def regressor_columns(self) -> tuple[Array, Array, Array]:
        """Scales of the columns of m, of m c and of I in a joint-torque regressor: what by_parameter_type takes."""
        return self.compensated * self.lever, self.compensated, self.turn

    def farther(self, distance: float) -> Sizes:
        """The same sizes for points that are farther away by a distance [m]; forces and moments stay."""
        lever = self.lever + distance
        return replace(
            self,
            lever=lever,
            arm=np.maximum(self.arm, lever),
            velocity=self.velocity + self.omega * distance,
            acceleration=self.acceleration + self.turn * distance,
        )

    def loaded(self, wrenches: Array) -> Sizes:
        """The same sizes with external wrenches (N, n, 6) among the terms."""
        force = largest(wrenches[..., LINEAR])
        moment = largest(wrenches[..., ANGULAR]) + force * self.lever
        return replace(self, force=self.force + force, moment=self.moment + moment)


def term_sizes(model: RobotModel, v: Array, a: Array, position: Array, velocity: Array, acceleration: Array) -> Sizes:
    """Sizes at N states: v, a (N, n); position (N, n, 3) of the link origins; velocity, acceleration (N, n, 6)."""
    omega, alpha = largest(velocity[..., ANGULAR]), largest(acceleration[..., ANGULAR])
    slides = np.array([joint.is_prismatic for joint in model.joints])
    slide_rate, slide_acceleration = largest(v * slides), largest(a * slides)
    lever = largest(position - model.base.translation) + center_offset(model) + SHORTEST_LEVER
    turn = alpha + omega**2
    swing = turn * lever + 2 * omega * slide_rate + slide_acceleration
    spin = largest_tensor(model) * turn
    compensated = swing + float(np.linalg.norm(model.gravity))
    force = compensated * sum(body.mass for body in model.bodies)
    return Sizes(
        lever=lever,
        arm=np.maximum(lever, float(slides.any())),
        omega=omega,
        slide_rate=slide_rate,
        velocity=omega * lever + slide_rate,
        acceleration=swing,
        turn=turn,
        compensated=compensated,
        force=force,
        moment=force * lever + spin,
        spin=spin,
    )


def center_offset(model: RobotModel) -> float:
    """Largest coordinate of a center of mass in its link frame [m]: link origins are found from centers of mass."""
    return max(float(np.abs(body.center_of_mass).max()) for body in model.bodies)


def largest_tensor(model: RobotModel) -> float:
    """Largest entry of an inertia tensor [kg m²]."""
    return max(float(np.abs(body.inertia).max()) for body in model.bodies)


def largest(x: Array) -> Array:
    """Largest absolute entry of each sample. (N, …) → (N,)."""
    sizes: Array = np.abs(x).reshape(len(x), -1).max(axis=-1)
    return sizes


def ratio(error: Array, scale: Array) -> Array:
    """error / scale; for a scale of zero, zero without an error and else infinite."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(error == 0, 0.0, error / scale)


def relative(x: Array, reference: Array, *sizes: Array) -> Array:
    """‖x - reference‖∞ over the largest of ‖reference‖∞ and the given sizes (N,)."""
    return ratio(largest(x - reference), np.maximum.reduce([largest(reference), *sizes]))


def by_part(x: Array, reference: Array, linear: Array, angular: Array) -> Array:
    """The larger error of the linear and angular parts (forces and moments), each on its own scale (N,)."""
    return np.maximum(
        relative(x[..., LINEAR], reference[..., LINEAR], linear),
        relative(x[..., ANGULAR], reference[..., ANGULAR], angular),
    )


def by_parameter_type(x: Array, reference: Array, mass: Array, first_moment: Array, tensor: Array) -> Array:
    """The largest error of the columns of m, of m c and of I, each on its own scale. (N, …, 10 k) → (N,)."""
    x, reference = (w.reshape(len(w), -1, BODY_PARAMETERS) for w in (x, reference))
    columns = zip(PARAMETER_TYPES, (mass, first_moment, tensor), strict=True)
    errors: Array = np.maximum.reduce([relative(x[..., part], reference[..., part], size) for part, size in columns])
    return errors


def backward_error(required: Array, tau: Array, wrenches: Array, mass: Array, a: Array, *external: Array) -> Array:
    """How far the torques that accelerations need are from the given ones: no condition number enters (N,).

    On the largest of the given torques, the joint wrenches, the external wrenches, and the entries of |M| |a|.

    required: the torques that inverse dynamics give at a; tau: the given ones; a   (N, n)
    wrenches: joint wrenches at a (N, n, 6); mass: M (N, n, n); external: wrenches, where there are (N, n, 6)
    """
    inertial = np.einsum("kij,kj->ki", np.abs(mass), np.abs(a))
    return ratio(largest(required - tau), np.maximum.reduce([largest(x) for x in (tau, wrenches, inertial, *external)]))


def acceleration_scale(mass: Array, a: Array, tau: Array, wrenches: Array) -> Array:
    """cond(M) ‖a‖∞ + ‖M⁻¹‖∞ (‖τ‖∞ + largest joint wrench): the change of a by a relative rounding of the data (N,)."""
    finite = np.isfinite(largest(mass))
    mass = np.where(finite[:, None, None], mass, np.eye(mass.shape[-1]))
    inverse_norm = np.abs(np.linalg.inv(mass)).sum(axis=-1).max(axis=-1)
    scale = np.linalg.cond(mass) * largest(a) + inverse_norm * (largest(tau) + largest(wrenches))
    return np.where(finite, scale, np.nan)
