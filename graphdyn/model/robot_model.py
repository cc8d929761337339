"""The description of a robot: bodies, joints, gravity. It never changes; states and results are other objects."""

from __future__ import annotations

import dataclasses
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Integral
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.display import Displayed
from graphdyn.errors import InvalidInput, InvalidModel, UnknownFrame, counted
from graphdyn.layout import BODY_PARAMETERS, Array, parameter_columns
from graphdyn.model import random_states
from graphdyn.model.assembly import refuse_infinitesimal
from graphdyn.model.chord import Chord
from graphdyn.model.content import content_digest
from graphdyn.model.coupling import Coupling, DegreesOfFreedom, degrees_of_freedom
from graphdyn.model.graph import Graph
from graphdyn.model.inertia import Consistency, consistency_problems, pseudo_inertia
from graphdyn.model.loops import Loops, pivoted_columns
from graphdyn.model.parts import Body, Frame, Joint, as_floats, check_type, freeze, read_only
from graphdyn.model.spatial import Placement
from graphdyn.tables import data_frame

if TYPE_CHECKING:
    import pandas

STANDARD_GRAVITY = (0.0, 0.0, -9.81)
"""Gravity of a model by default [m/s²]: the value Pinocchio and most URDF tools use."""


@dataclass(frozen=True, eq=False, repr=False)
class RobotModel(Displayed):
    """A tree of n rigid bodies on n joints of one degree of freedom each, some of which others may drive, and chords.

    bodies, joints: in regular labeling, parents first; joints[j-1] is the inside joint of bodies[j-1]
    gravity: in world axes                                  (3,)  [m/s²]
    base: the ground frame (body 0) in the world
    base_name: name of the ground frame (the root link of a URDF)
    frames: named frames fixed in the bodies
    couplings: joints that others drive, in any order; joint states q, v, a and tau have entries for the others only
    chords: connections that close loops; states q, v, a have an entry for every joint, and hold the loops closed
        (graphdyn.assemble)
    actuated: of a robot with chords, the joints that have motors: torques of the others are zero. None where that is
        not known; verbs that answer torques then refuse

    Raises InvalidModel, naming the body, joint or chord, for duplicate names, joints out of order, non-finite numbers,
    couplings that name unknown joints, drive one twice or in a circle, chords on bodies that there are not, and
    actuated joints that are unknown or driven.
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    gravity: Array = field(default_factory=lambda: np.array(STANDARD_GRAVITY))
    base: Placement = field(default_factory=Placement)
    base_name: str = "base"
    frames: tuple[Frame, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    chords: tuple[Chord, ...] = ()
    actuated: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        who = f"robot '{self.name}'"
        for name in ("bodies", "joints", "frames", "couplings", "chords"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        freeze(self, who, gravity=(3,))
        check_type(who, "base", self.base, Placement)
        if not self.bodies:
            raise InvalidModel(f"{who}: no moving body; the dynamics of a model without joints are empty")
        if len(self.bodies) != len(self.joints):
            raise InvalidModel(
                f"{who}: {counted(len(self.bodies), 'body', 'bodies')} but {counted(len(self.joints), 'joint')}; "
                "a tree has one each"
            )
        bodies = [self.base_name, *(body.name for body in self.bodies)]
        frames = [name for frame in self.frames for name in (frame.name, *frame.aliases)]
        joints = [joint.name for joint in self.joints]
        chords = [chord.name for chord in self.chords]
        for what, names in (
            ("body", bodies),
            ("joint", joints),
            ("frame", bodies + frames),
            ("chord", joints + chords),
        ):
            repeated = [name for name in names if names.count(name) > 1]
            if repeated:
                raise InvalidModel(f"{who}: {what} name '{repeated[0]}' is used more than once")
        for j, joint in enumerate(self.joints, start=1):
            if not 0 <= joint.inside < j:
                raise InvalidModel(
                    f"joint '{joint.name}': inside body {joint.inside} does not come before body {j}; "
                    "list parents first (0 is the ground)"
                )
        for frame in self.frames:
            if not 0 <= frame.body <= self.n_bodies:
                raise InvalidModel(f"frame '{frame.name}': there is no body {frame.body}")
        for chord in self.chords:
            if not (0 <= chord.body_i <= self.n_bodies and 0 <= chord.body_j <= self.n_bodies):
                raise InvalidModel(f"chord '{chord.name}': there is no body {max(chord.body_i, chord.body_j)}")
        _ = self.degrees_of_freedom  # refuses couplings that cannot be
        if self.actuated is not None:
            self._check_actuated(who, self.actuated)

    def summary(self) -> str:
        """Number of joints, mass, and what moves what."""
        slides = sum(joint.is_prismatic for joint in self.joints)
        kinds = (
            f"{counted(self.n_bodies, 'joint')}, {slides} of them prismatic"
            if slides
            else counted(self.n_bodies, "joint")
        )
        driven = f", {counted(len(self.couplings), 'coupling')}" if self.couplings else ""
        closed = f", {counted(len(self.chords), 'chord')}" if self.chords else ""
        mass = sum(body.mass for body in self.bodies)
        return (
            f"robot {self.name}: {kinds}{driven}{closed}, {mass:.4g} kg\njoints: {', '.join(self.joint_names)}\n"
            f"bodies: {', '.join((self.base_name, *self.body_names))}"
        )

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every joint with the body that it moves: kind, limits, mass and center of mass in the link frame.

        Raises ImportError where pandas is missing.
        """
        limits = ("lower", "upper", "velocity", "effort")
        columns = {
            "kind": [joint.kind for joint in self.joints],
            **{name: [getattr(joint.limits, name) for joint in self.joints] for name in limits},
            "body": self.body_names,
            "mass": [body.mass for body in self.bodies],
            **{f"center {axis}": [body.center_of_mass[k] for body in self.bodies] for k, axis in enumerate("xyz")},
        }
        return data_frame(columns, self.joint_names, "joint")

    def _check_actuated(self, who: str, given: Sequence[str]) -> None:
        if isinstance(given, str):
            raise InvalidModel(f"{who}: actuated is the text '{given}'; give a list of joint names")
        actuated = tuple(given)
        if not self.chords:
            raise InvalidModel(f"{who}: actuated is given, but every joint of a tree is; leave it out (None)")
        for name in actuated:
            if name not in self.independent_joints:
                driven = ", which another joint drives" if name in self.joint_names else ""
                known = ", ".join(self.independent_joints)
                raise InvalidModel(f"{who}: there is no joint '{name}' to actuate{driven}; choose among {known}")
            if actuated.count(name) > 1:
                raise InvalidModel(f"{who}: joint '{name}' is actuated more than once; name it once")
        object.__setattr__(self, "actuated", actuated)

    @property
    def n_bodies(self) -> int:
        """n, the number of moving bodies and of joints."""
        return len(self.bodies)

    @cached_property
    def digest(self) -> bytes:
        """Equal for models that are equal to the last bit, and for no others."""
        return content_digest(self)

    @cached_property
    def degrees_of_freedom(self) -> DegreesOfFreedom:
        """What the couplings leave free, and what they transmit."""
        return degrees_of_freedom(f"robot '{self.name}'", self.joint_names, self.couplings)

    @property
    def nv(self) -> int:
        """The number of joints that no others drive: n, where there are no couplings."""
        return len(self.degrees_of_freedom.independent)

    @property
    def independent_joints(self) -> tuple[str, ...]:
        """Names of the joints that no others drive: the order of q, v, a and τ."""
        return tuple(self.joints[k].name for k in self.degrees_of_freedom.independent)

    @property
    def n_chord_rows(self) -> int:
        """The number of constraint rows of all chords, and of their multipliers."""
        return sum(len(chord.rows) for chord in self.chords)

    @cached_property
    def loops(self) -> Loops:
        """The geometry of the loops that the chords close."""
        return Loops(self.joints, self.chords, self.degrees_of_freedom)

    @cached_property
    def closed_pose(self) -> Array:
        """Joint positions (nv,) that close the loops: near q = 0, or else near one of 100 random poses.

        Raises InconsistentState, naming a loop, where none of them closes.
        """
        return read_only(random_states.closed_pose(f"robot '{self.name}'", self.loops))

    @cached_property
    def regular_pose(self) -> Array:
        """Find, among some closed poses (nv,), the one farthest from a singular one.

        That of the largest rank, and among these of the largest ratio of smallest to largest singular value of J.
        Raises InconsistentState where the loops cannot be closed.
        """
        return read_only(random_states.regular_pose(f"robot '{self.name}'", self.loops, self.closed_pose))

    @cached_property
    def dependent_joints(self) -> tuple[int, ...]:
        """Numbers, among the entries of q, of joints that follow from the others where loops are closed.

        Chosen in regular_pose, as many as J has rank; motors are among the others as far as these determine the rest.
        Raises InconsistentState where the loops have infinitesimal mobility only.
        """
        refuse_infinitesimal(f"robot '{self.name}'", self.loops, self.regular_pose)
        jacobian = self.loops.jacobian(self.loops.links(self.regular_pose))
        motors = [self.independent_joints.index(name) for name in self.actuated or ()]
        rank = int(self.loops.spaces(jacobian).rank)
        return tuple(sorted(pivoted_columns(self.loops.in_sizes.in_units(jacobian), rank, motors)))

    def joint_positions(self, q: ArrayLike) -> Array:
        """Joint positions of all joints (…, n) [rad or m], from those of the independent ones (…, nv)."""
        return np.asarray(q) @ self.degrees_of_freedom.matrix.T + self.degrees_of_freedom.offset

    @property
    def body_names(self) -> tuple[str, ...]:
        """Body names in the order of the bodies."""
        return tuple(body.name for body in self.bodies)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Joint names in the order of the joints."""
        return tuple(joint.name for joint in self.joints)

    @cached_property
    def graph(self) -> Graph:
        """Bodies as vertices, joints as edges."""
        return Graph(tuple(joint.inside for joint in self.joints))

    def frame(self, name: str) -> Frame:
        """The frame of this name: a body, the ground, a fused link or the fixed joint that carried it.

        Raises UnknownFrame with the known names.
        """
        own = (self.base_name, *self.body_names)
        if name in own:
            return Frame(name, own.index(name), Placement())
        for frame in self.frames:
            if frame.name == name:
                return frame
        for frame in self.frames:
            if name in frame.aliases:
                return frame
        known = ", ".join((*own, *(frame.name for frame in self.frames)))
        raise UnknownFrame(f"robot '{self.name}' has no frame '{name}'; known: {known}")

    def body_joint_vectors(self) -> Array:
        """C (n, n, 3): S_ij c_ij, c_ij from the center of mass of body i to joint j, in axes of body i. Eq. (11) [m].

        A prismatic joint is taken at q = 0: its force acts along the axis, through the same line at every q. The joint
        force elements act at the joints: the paper's C^e of Eq. (17)-(18) is C.
        """
        c = np.zeros((self.n_bodies, self.n_bodies, 3))
        for j, joint in enumerate(self.joints, start=1):
            c[j - 1, j - 1] = self.bodies[j - 1].center_of_mass  # S_jj c_jj = -1 · (-c)
            if joint.inside > 0:
                c[joint.inside - 1, j - 1] = joint.placement.translation - self.bodies[joint.inside - 1].center_of_mass
        return c

    @cached_property
    def inertial_parameters(self) -> Array:
        """(10 n,): the parameters of all bodies (Body.parameters), body after body."""
        return read_only(np.concatenate([body.parameters for body in self.bodies]))

    @cached_property
    def skeleton(self) -> RobotModel:
        """The rooted robot with massless bodies whose centers of mass are their link origins.

        Its maximal states are the motions of the link frames, free of any inertial parameter.
        """
        bodies = tuple(Body(body.name, 0.0, np.zeros(3), np.zeros((3, 3))) for body in self.bodies)
        return dataclasses.replace(self.rooted, bodies=bodies)

    @cached_property
    def rooted(self) -> RobotModel:
        """The same robot shifted so that joint 1 is at the world's origin.

        The dynamics do not depend on where in the world it stands; their rounding errors would, through differences of
        large positions.
        """
        shift = self.base.rotation @ self.joints[0].placement.translation
        return dataclasses.replace(self, base=Placement(self.base.rotation, -shift))

    @cached_property
    def uncoupled(self) -> RobotModel:
        """The same robot without couplings: every joint is free. Itself where it has none."""
        return dataclasses.replace(self, couplings=()) if self.couplings else self

    @cached_property
    def opened(self) -> RobotModel:
        """The same robot without chords: its tree, whose joints are free. Itself where it has none."""
        return dataclasses.replace(self, chords=(), actuated=None) if self.chords else self

    def with_inertial_parameters(self, parameters: ArrayLike) -> RobotModel:
        """The same robot with other inertial parameters (10 n,). Raises InvalidModel for a wrong length."""
        pi = as_floats(f"robot '{self.name}'", "parameter vector", parameters, (BODY_PARAMETERS * self.n_bodies,))
        bodies = [
            Body.from_parameters(body.name, pi[parameter_columns(i)]) for i, body in enumerate(self.bodies, start=1)
        ]
        return dataclasses.replace(self, bodies=tuple(bodies))

    def with_gravity(self, gravity: ArrayLike) -> RobotModel:
        """The same robot under another gravity vector (3,) [m/s²], world axes."""
        return dataclasses.replace(self, gravity=np.asarray(gravity))

    def with_base(self, base: Placement) -> RobotModel:
        """The same robot mounted with its ground frame at another placement in the world."""
        return dataclasses.replace(self, base=base)

    def with_actuated(self, joints: Sequence[str]) -> RobotModel:
        """The same robot with motors at these joints. Raises InvalidModel as the class does."""
        return dataclasses.replace(self, actuated=joints)  # type: ignore[arg-type]  # of which it makes a tuple

    def random_state(self, rng: np.random.Generator, size: int | Sequence[int] = ()) -> tuple[Array, Array]:
        """q, v (size, nv), uniform within limits, or default ranges where these are zero, missing or absurd.

        Continuous joints are drawn from [-π, π] rad. The default ranges are ±π rad, ±π rad/s, ±0.5 m and ±0.5 m/s;
        a limit beyond 1e6 is absurd. Limits of joints that others drive are not looked at.

        With chords the states are closed: reached from closed_pose by moving towards such a draw, and therefore neither
        uniform nor always within limits; drawn again where a pose is as good as singular.
        Raises InconsistentState where the loops cannot be closed.
        """
        shape: Sequence[int] = (int(size),) if isinstance(size, Integral) else tuple(size)  # type: ignore[arg-type]
        if self.chords:
            who = f"robot '{self.name}'"
            return random_states.closed_states(who, self.loops, self.closed_pose, rng, shape)
        return random_states.drawn(self.loops.free_joints, rng, shape)

    def physical_consistency(self) -> tuple[Consistency, ...]:
        """Per body: whether a real body can have these inertials, and if not why. Reports; refuses nothing."""
        return tuple(
            Consistency(
                body.name,
                float(np.linalg.eigvalsh(pseudo_inertia(body.mass, body.center_of_mass, body.inertia))[0]),
                consistency_problems(body.mass, body.inertia),
            )
            for body in self.bodies
        )


def check_model(model: object) -> None:
    """Raise InvalidInput for anything but a RobotModel, such as the name of a robot."""
    if not isinstance(model, RobotModel):
        raise InvalidInput(
            f"the model is {reprlib.repr(model)}, of type {type(model).__name__}; give a RobotModel, into which a "
            "robot's name or file is loaded first"
        )


def total_mass(model: RobotModel) -> float:
    """Σ m [kg]. Raises InvalidInput for a robot without any mass, which has no center of mass."""
    mass = float(sum(body.mass for body in model.bodies))
    if mass == 0:
        raise InvalidInput(
            f"robot '{model.name}' has no center of mass: the masses of its bodies add up to zero; "
            "see physical_consistency()"
        )
    return mass
