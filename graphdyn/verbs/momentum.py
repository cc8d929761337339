"""The public verbs that answer the center of mass and the momentum of all bodies together.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinity, and for
a robot whose masses add up to zero.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.arguments.choices import Method, with_keywords
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.answers import Momentum
from graphdyn.verbs.table import Verbs


@with_keywords
def center_of_mass(
    model: RobotModel,
    q: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """c = Σ m r / Σ m of all bodies (…, 3), in the world [m].

    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput, also for a robot without mass.
    """
    return Verbs.center_of_mass(model, (q,), base, method, threads, check, out)


@with_keywords
def center_of_mass_velocity(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """ċ = Σ m ṙ / Σ m (…, 3), world axes [m/s].

    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput, also for a robot without mass.
    """
    return Verbs.center_of_mass_velocity(model, (q, v), base, method, threads, check, out)


@with_keywords
def center_of_mass_jacobian(
    model: RobotModel,
    q: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """∂c/∂q (…, 3, n), world axes: ċ = it @ v while the base is at rest [m or 1].

    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput, also for a robot without mass.
    """
    return Verbs.center_of_mass_jacobian(model, (q,), base, method, threads, check, out)


@with_keywords
def momentum(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Momentum | None = None,
) -> Momentum:
    """Linear and angular momentum of all bodies, about the center of mass and about the world's origin, world axes.

    Linear Σ m ṙ; angular Σ (r - c) × m ṙ + R J ω, or Σ r × m ṙ + R J ω. Its rate about the origin is the moment of
    gravity, external wrenches and the reaction of the ground.
    q, v: joint state (…, n) [rad or m, …/s]

    Raises InvalidInput, also for a robot without mass.
    """
    return Verbs.momentum(model, (q, v), base, method, threads, check, out)


@with_keywords
def centroidal_map(
    model: RobotModel,
    q: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """A_G (…, 6, n): momentum about the center of mass = A_G v while the base is at rest; linear first, world axes.

    Orin, Goswami and Lee, "Centroidal dynamics of a humanoid robot", Autonomous Robots 35(2), 2013; kg m and kg m² for
    a joint that turns, kg and kg m for one that slides.
    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.

    Raises InvalidInput, also for a robot without mass.
    """
    return Verbs.centroidal_map(model, (q,), base, method, threads, check, out)
