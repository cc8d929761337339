"""What of an MJCF file is not part of the model, though forces or masses depend on it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdf.document.connections.loops import Unread
from urdf.document.mjcf.merging import Merged
from urdf.document.mjcf.native import Native
from urdf.errors import shortened


def notes(native: Native, whole: Merged, use_geoms: bool) -> Iterator[Unread]:
    """One per kind and element."""
    model = native.model

    def note(kind: str, name: str, problem: str) -> Unread:
        path, line = whole.place(kind, name, native.lines.get((kind, name), ""))
        file = None if path == whole.path else str(path)
        return Unread(f"{kind} '{shortened(name)}' {problem}", f"{kind} '{shortened(name)}'", line, file)

    for name, has_geoms in native.without_inertial.items():
        if has_geoms:
            remedy = "inertiafromgeom forbids it" if use_geoms else 'repair="geoms" (--repair geoms) computes it'
            yield note("body", name, f"has no <inertial>; that of its geoms is not computed: {remedy}")
    for j in range(model.njnt):
        name, dof = model.joint(j).name, model.jnt_dofadr[j]
        lower, upper = map(float, model.jnt_range[j])
        if lower > upper:
            yield note("joint", name, f"has the range {lower:g} to {upper:g}, which MuJoCo takes for no limit")
        stiffness = float(model.jnt_stiffness[j])
        curved = [array[at] for array, at in _polynomials(model, j, dof) if array[at].any()]
        if stiffness or curved:
            said = f"a spring of {stiffness:g}" if stiffness else "a spring or damper that is not linear"
            yield note("joint", name, f"has {said}, which is no part of the model")
    for i in range(1, model.nbody):
        name = model.body(i).name
        if model.body_gravcomp[i]:
            yield note("body", name, "is lifted by gravcomp, which is no part of the model")
        if model.body_mocapid[i] >= 0:
            yield note("body", name, "is moved from outside (mocap), and stands still here")
    for tendon in native.tendons:
        if tendon.acts:
            yield note("tendon", tendon.name, f"acts by its {', '.join(tendon.acts)}, which is no part of the model")
    if model.opt.density or model.opt.viscosity:
        yield Unread(
            "the bodies move in a fluid (option density, viscosity), which is no part of the model", "<option>"
        )


def _polynomials(model: Any, j: int, dof: int) -> Iterator[tuple[Any, int]]:
    """Higher coefficients of springs and dampers, where this version of MuJoCo has them."""
    for name, at in (("jnt_stiffnesspoly", j), ("dof_dampingpoly", dof)):
        array = getattr(model, name, None)
        if array is not None:
            yield array, at
