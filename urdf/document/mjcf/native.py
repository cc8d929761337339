"""The robot as MuJoCo compiles it. The only file of this package that imports mujoco, when first needed.

Defaults, classes, orientations, units and the settings of <compiler> are MuJoCo's own business: what it makes of them
is read. Geoms, meshes and everything that draws, senses or drives is taken away before it compiles, so that missing
mesh files do not matter.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

from urdf.document.mjcf.merging import Merged
from urdf.errors import InvalidMJCF, MujocoNotInstalled, UnsupportedConstraint, UnsupportedJoint, shortened

_LEFT_OUT = (
    *("keys", "sensors", "actuators", "tendons", "pairs", "excludes", "tuples", "skins", "texts", "numerics"),
    *("cameras", "lights", "materials", "textures"),
)
"""Lists of MjSpec that the dynamics of the bodies do not need."""

_READ_EQUALITIES = ("mjEQ_JOINT", "mjEQ_CONNECT", "mjEQ_WELD")

FROM_GEOMS = 1
"""compiler inertiafromgeom="true": geoms replace every <inertial>."""

_TINY = 1e-12
"""Mass and moments of a body without <inertial> while MuJoCo compiles it, which refuses zero [kg, kg m²]."""


@dataclass(frozen=True, eq=False)
class Actuator:
    """What drives a joint: name of the joint, and the largest force that it can exert there, None without limit."""

    joint: str
    effort: float | None


@dataclass(frozen=True, eq=False)
class Tendon:
    """A tendon. acts: what it does by itself, in words; empty where it only passes on forces of actuators"""

    name: str
    acts: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Native:
    """A compiled robot.

    model: mjModel; lines: of bodies, joints and equalities, what MuJoCo notes about them, by kind and name
    without_inertial: names of bodies without <inertial>, by whether they have geoms
    from_geoms: names of bodies whose inertia MuJoCo computed from geoms
    changed_inertials: settings of <compiler> by which inertials are not those of the file
    """

    mujoco: Any
    model: Any
    lines: dict[tuple[str, str], str]
    without_inertial: dict[str, bool]
    from_geoms: tuple[str, ...]
    actuators: tuple[Actuator, ...]
    tendons: tuple[Tendon, ...]
    changed_inertials: tuple[str, ...]


def compiled(whole: Merged, use_geoms: bool) -> Native:
    """The robot. use_geoms: bodies without <inertial> get that of their geoms

    Raises MujocoNotInstalled, InvalidMJCF with what MuJoCo says, UnsupportedJoint for free and ball joints,
    UnsupportedConstraint for equalities of tendons and the like.
    """
    mujoco = _library(whole.path)
    spec = _quiet(mujoco, whole, lambda: mujoco.MjSpec.from_string(whole.text))
    _name_all(spec)
    lines = _lines(spec)
    for joint in spec.joints:
        if joint.type in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
            raise _no_joint(whole, joint, joint.type == mujoco.mjtJoint.mjJNT_FREE)
    for equality in list(spec.equalities):
        if int(equality.type) not in [int(getattr(mujoco.mjtEq, name)) for name in _READ_EQUALITIES]:
            if equality.active:
                raise _no_equality(whole, equality)
            spec.delete(equality)
    actuators, tendons = _actuators(mujoco, spec), _tendons(spec)
    for kind in _LEFT_OUT:
        for element in list(getattr(spec, kind, ())):
            spec.delete(element)
    without, computed = _inertials(spec, use_geoms)
    compiler = spec.compiler
    compiler.fusestatic = compiler.discardvisual = False
    spec.memory = -1
    if whole.path.parent.is_dir():
        spec.modelfiledir = str(whole.path.resolve().parent)
    model = _quiet(mujoco, whole, spec.compile)
    settings = {
        "settotalmass": compiler.settotalmass > 0,
        "boundmass": compiler.boundmass > 0,
        "boundinertia": compiler.boundinertia > 0,
        "balanceinertia": bool(compiler.balanceinertia),
        "inertiafromgeom": int(compiler.inertiafromgeom) == FROM_GEOMS,
    }
    changed = tuple(name for name, set_ in settings.items() if set_)
    return Native(mujoco, model, lines, without, tuple(computed), actuators, tendons, changed)


def _library(path: Path) -> Any:
    try:
        import mujoco
    except ImportError:
        problem = "an MJCF file is read by MuJoCo, which is not installed"
        raise MujocoNotInstalled(problem, "pip install 'graphdyn[mujoco]'", path=path) from None
    return mujoco


def _quiet(mujoco: Any, whole: Merged, work: Callable[[], Any]) -> Any:
    """What MuJoCo answers, without its warnings, which are about deprecated attributes. Raises InvalidMJCF."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return work()
    except (ValueError, mujoco.FatalError) as error:
        raise _refused(whole, error) from error


def _refused(whole: Merged, error: Exception) -> InvalidMJCF:
    said = " ".join(str(error).split())
    line = re.search(r"line(?: number)?\s*[=:]?\s*(\d+)", said, re.IGNORECASE)
    problem = re.sub(r"^(?:XML )?Error:\s*|,?\s*line \d+$", "", said)
    number = int(line[1]) if line is not None and whole.as_written else None
    remedy = "correct it; MuJoCo reads the file, and its documentation lists elements and attributes"
    sentence, _, element = problem.partition(" Element ")
    quoted = f"{shortened(sentence)} (element {shortened(element)})" if element else shortened(sentence)
    return InvalidMJCF(f"MuJoCo refuses the file: {quoted}", remedy, path=whole.path, line=number)


def _no_joint(whole: Merged, joint: Any, is_free: bool) -> UnsupportedJoint:
    path, line = whole.place("joint", joint.name, joint.info)
    what = f"joint '{shortened(joint.name)}' of body '{shortened(joint.parent.name)}'"
    if is_free:
        problem, remedy = "is free", "remove it: a robot here stands on the ground"
    else:
        problem, remedy = "is a ball joint", "replace it by three hinges in the same body"
    return UnsupportedJoint(problem, remedy, code="unsupported-joint", path=path, line=line, element=what)


def _no_equality(whole: Merged, equality: Any) -> UnsupportedConstraint:
    path, line = whole.place("equality", equality.name, equality.info)
    problem, remedy = "is neither of joints nor a connect or weld", 'leave it out, or make it active="false"'
    element = f"equality '{shortened(equality.name)}'"
    return UnsupportedConstraint(problem, remedy, path=path, line=line, element=element)


def _name_all(spec: Any) -> None:
    """Give bodies, joints and equalities without a name one."""
    for kind, elements in (("body", spec.bodies), ("joint", spec.joints), ("equality", spec.equalities)):
        taken = {element.name for element in elements}
        for number, element in enumerate(elements):
            if not element.name:
                element.name = next(
                    name for k in count(number) if (name := f"{kind}_{k}") not in taken
                )  # fmt: skip
                taken.add(element.name)


def _lines(spec: Any) -> dict[tuple[str, str], str]:
    kinds = (("body", spec.bodies), ("joint", spec.joints), ("equality", spec.equalities))
    return {(kind, element.name): str(element.info) for kind, elements in kinds for element in elements}


def _actuators(mujoco: Any, spec: Any) -> tuple[Actuator, ...]:
    on_joints = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)
    found = []
    for actuator in spec.actuators:
        if actuator.trntype in on_joints:
            force = max(abs(float(bound)) for bound in actuator.forcerange)
            effort = force * abs(float(actuator.gear[0]))
            found.append(Actuator(str(actuator.target), effort or None))
    return tuple(found)


def _tendons(spec: Any) -> tuple[Tendon, ...]:
    found = []
    for number, tendon in enumerate(spec.tendons):
        numbers = {name: getattr(tendon, name, 0.0) for name in ("stiffness", "damping", "frictionloss", "armature")}
        acts = [name for name, value in numbers.items() if _any(value)]
        if _any(tendon.range):
            acts.append("limits")
        found.append(Tendon(tendon.name or f"tendon_{number}", tuple(acts)))
    return tuple(found)


def _any(value: Any) -> bool:
    """Whether a number, or one of several, is not zero."""
    try:
        return any(float(one) != 0 for one in value)
    except TypeError:
        return float(value) != 0


def _inertials(spec: Any, use_geoms: bool) -> tuple[dict[str, bool], list[str]]:
    """Take away the geoms that no inertia is computed from. Answers bodies without <inertial>, and those whose inertia
    comes from geoms."""
    setting = int(spec.compiler.inertiafromgeom)
    without: dict[str, bool] = {}
    computed: list[str] = []
    for number, body in enumerate(spec.bodies):
        geoms = list(body.geoms)
        automatic = setting != 0 and not body.explicitinertial
        if number > 0 and geoms and (setting == FROM_GEOMS or (automatic and use_geoms)):
            computed.append(body.name)
            for geom in geoms:
                geom.material = ""
            continue
        for geom in geoms:
            spec.delete(geom)
        if number > 0 and not body.explicitinertial:
            without[body.name] = bool(geoms)
            body.explicitinertial = True
            body.mass, body.inertia = _TINY, [_TINY] * 3
    if not computed:
        for kind in ("meshes", "hfields"):
            for element in list(getattr(spec, kind)):
                spec.delete(element)
    return without, computed
