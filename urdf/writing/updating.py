"""New inertial parameters into an existing URDF file: every byte outside the <inertial> elements stays as it was."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from graphdyn import Body, InvalidModel
from graphdyn.display import short_repr
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model import consistency_problems
from urdf.document.catalog import locate
from urdf.document.files import write_whole
from urdf.document.numbers import inertial_element
from urdf.errors import CannotUpdate, one_line
from urdf.reading.loading import fused_links, load
from urdf.reading.reading import Reading, ReadingKeywords
from urdf.writing.in_place import editable, inertial_spans, refuse_xacro, with_inertials


@dataclass(frozen=True)
@short_repr
class Update:
    """What urdf.update did.

    changed: links that have a new <inertial>; kept: links that had these parameters already, to the last bit
    notes: the bodies whose mass is shared with links fixed to them
    """

    path: Path
    changed: tuple[str, ...]
    kept: tuple[str, ...]
    notes: tuple[str, ...]


def update(
    source: str | PathLike[str],
    destination: str | PathLike[str],
    parameters: ArrayLike,
    *,
    inconsistent: bool = False,
    **reading: Unpack[ReadingKeywords],
) -> Update:
    """Write a copy of a URDF file in which the bodies have other inertial parameters.

    source: path, or name of the catalog; destination: may be the same path
    parameters: ten per body of urdf.load(source, **reading), in its order
                                                            (n, 10) or (10n,)  [kg, kg m, kg m²]
    inconsistent: also write parameters that no real body can have
    reading: as in urdf.load, if the parameters were identified on an arm cut out or with locked joints

    A body may carry fixed or locked links. They keep their own <inertial>; the link of the body gets the rest, so that
    all together have the given parameters.

    Raises CannotUpdate for parameters of another shape, NaN or infinity, negative masses, physically inconsistent
    parameters unless inconsistent=True, and files in UTF-16 and the like; urdf.load's errors for the source; OSError.
    """
    how = Reading.of(update, reading).without_computed_inertials
    path, _ = locate(source)
    refuse_xacro(path)
    model = load(source, reading=how)
    wanted = _checked(parameters, model.n_bodies, path)
    shares = fused_links(source, reading=how)
    data = editable(path)
    spans = inertial_spans(data)
    edits, changed, notes = [], [], []
    for number, (old, new) in enumerate(zip(model.bodies, wanted, strict=True), start=1):
        carried = {name: share for name, (body, share) in shares.items() if body == number and share.any()}
        if np.array_equal(old.parameters, new):
            continue
        rest = _body(old.name, new - sum(carried.values()), path, bool(carried))
        if not inconsistent:
            _refuse_inconsistent(_body(old.name, new, path, False), path)
            _refuse_inconsistent(rest, path)
        edits.append((spans[old.name], inertial_element(rest)))
        changed.append(old.name)
        if carried:
            names = ", ".join(f"'{name}' ({share[0]:.6g} kg)" for name, share in carried.items())
            note = f"link '{old.name}' gets {rest.mass:.6g} kg: its fixed links {names} keep their own <inertial>"
            notes.append(one_line(note))
    write_whole(Path(destination), with_inertials(data, edits))
    kept = tuple(name for name in model.body_names if name not in changed)
    return Update(Path(destination), tuple(changed), kept, tuple(notes))


def _checked(parameters: ArrayLike, n: int, path: Path) -> Array:
    try:
        wanted = np.asarray(parameters, dtype=float)
    except (TypeError, ValueError) as error:
        raise CannotUpdate(
            f"the parameters are not numbers: {error}", "give ten numbers per body", path=path
        ) from error
    if wanted.shape not in ((n, BODY_PARAMETERS), (n * BODY_PARAMETERS,)):
        problem = f"the parameters have shape {wanted.shape}, expected ({n}, 10) or ({10 * n},)"
        remedy = "give ten per moving body, in the order of urdf.load"
        raise CannotUpdate(problem, remedy, path=path)
    wanted = wanted.reshape(n, BODY_PARAMETERS)
    if not np.isfinite(wanted).all():
        body = int(np.argwhere(~np.isfinite(wanted))[0, 0])
        problem = f"the parameters of body {body + 1} contain NaN or infinity"
        remedy = "parameters that the data do not determine need a value"
        raise CannotUpdate(problem, remedy, path=path)
    return wanted


def _body(name: str, parameters: Array, path: Path, is_rest: bool) -> Body:
    try:
        return Body.from_parameters(name, parameters)
    except InvalidModel as error:
        remedy = "its fixed links weigh as much or more by themselves: correct their <inertial> first" if is_rest else (
            "give a mass of at least 0"
        )  # fmt: skip
        raise CannotUpdate(str(error), remedy, path=path, element=f"link '{name}'") from error


def _refuse_inconsistent(body: Body, path: Path) -> None:
    problems = consistency_problems(body.mass, body.inertia)
    if problems:
        problem = f"no real body has these parameters: {'; '.join(problems)}"
        remedy = "identify with physical constraints, or write them nevertheless with inconsistent=True"
        raise CannotUpdate(problem, remedy, path=path, element=f"link '{body.name}'")
