"""The public verbs that answer the center of mass and the momentum of all bodies together.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinity, and for
a robot whose masses add up to zero.
"""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from graphdyn.arguments.choices import VerbKeywords
from graphdyn.equations import body_sums
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.answers import Momentum
from graphdyn.verbs.single_state import OfPositions, OfState, SingleState
from graphdyn.verbs.verb import computed, verb

__all__ = [
    "center_of_mass",
    "center_of_mass_jacobian",
    "center_of_mass_velocity",
    "centroidal_map",
    "momentum",
]


@verb(body_sums.center_of_mass)
def center_of_mass(model: RobotModel, q: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """c = Σ m r / Σ m of all bodies (…, 3), in the world [m].

    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput, also for a robot without mass.

    >>> import graphdyn, numpy as np
    >>> model, q = graphdyn.kr500(), np.full(6, 0.3)
    >>> graphdyn.center_of_mass(model, q).round(3)
    array([0.308, 0.098, 1.   ])
    """
    return computed(center_of_mass, model, (q,), keywords)


@verb(body_sums.center_of_mass_velocity)
def center_of_mass_velocity(
    model: RobotModel, q: ArrayLike, v: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]
) -> Array:
    """ċ = Σ m ṙ / Σ m (…, 3), world axes [m/s].

    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput, also for a robot without mass.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> mass = sum(body.mass for body in model.bodies)
    >>> momentum = graphdyn.momentum(model, q, v).about_origin[:3]
    >>> bool(np.allclose(momentum, mass * graphdyn.center_of_mass_velocity(model, q, v)))
    True
    """
    return computed(center_of_mass_velocity, model, (q, v), keywords)


@verb(body_sums.center_of_mass_jacobian)
def center_of_mass_jacobian(model: RobotModel, q: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """∂c/∂q (…, 3, n), world axes: ċ = it @ v while the base is at rest [m or 1].

    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput, also for a robot without mass.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> velocity = graphdyn.center_of_mass_jacobian(model, q) @ v
    >>> bool(np.allclose(velocity, graphdyn.center_of_mass_velocity(model, q, v)))
    True
    """
    return computed(center_of_mass_jacobian, model, (q,), keywords)


@verb(body_sums.momentum, answer=Momentum)
def momentum(model: RobotModel, q: ArrayLike, v: ArrayLike, **keywords: Unpack[VerbKeywords[Momentum]]) -> Momentum:
    """Linear and angular momentum of all bodies, about the center of mass and about the world's origin, world axes.

    Linear Σ m ṙ; angular Σ (r - c) × m ṙ + R J ω, or Σ r × m ṙ + R J ω. Its rate about the origin is the moment of
    gravity, external wrenches and the reaction of the ground.
    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput, also for a robot without mass.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> found = graphdyn.momentum(model, q, v)
    >>> found.about_origin.shape  # linear, then angular
    (6,)
    """
    return computed(momentum, model, (q, v), keywords)


@verb(body_sums.centroidal_map)
def centroidal_map(model: RobotModel, q: ArrayLike, **keywords: Unpack[VerbKeywords[Array]]) -> Array:
    """A_G (…, 6, n): momentum about the center of mass = A_G v while the base is at rest; linear first, world axes.

    Orin, Goswami and Lee, "Centroidal dynamics of a humanoid robot", Autonomous Robots 35(2), 2013; kg m and kg m² for
    a joint that turns, kg and kg m for one that slides.
    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput, also for a robot without mass.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> momentum = graphdyn.centroidal_map(model, q) @ v
    >>> bool(np.allclose(momentum, graphdyn.momentum(model, q, v).about_center_of_mass))
    True
    """
    return computed(centroidal_map, model, (q,), keywords)


class MomentumCalls:
    """The calls of a CompiledModel that answer the center of mass and the momentum."""

    center_of_mass: SingleState[OfPositions]
    """c (3,) [m]"""

    center_of_mass_velocity: SingleState[OfState]
    """ċ (3,) [m/s]"""

    center_of_mass_jacobian: SingleState[OfPositions]
    """∂ċ/∂v (3, n) [m or 1]"""

    centroidal_map: SingleState[OfPositions]
    """(6, n) [kg m, kg m² or kg, kg m]"""
