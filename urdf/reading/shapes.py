"""urdf.shapes: the visual or collision geometry of a robot, on the bodies of the model that urdf.load makes."""

from __future__ import annotations

from numbers import Integral
from typing import Unpack

from graphdyn import Frame, InvalidInput, Placement
from urdf.document.elements import GEOMETRIES, Geometry
from urdf.document.opening import Given
from urdf.geometry.reading import placed_shapes
from urdf.geometry.shape import Shapes
from urdf.reading.parsing import build, parsed_source
from urdf.reading.reading import Reading, ReadingKeywords


def shapes(
    source: Given,
    *,
    geometry: Geometry = "visual",
    faces: int | None = None,
    **reading: Unpack[ReadingKeywords],
) -> Shapes:
    """What a robot looks like: boxes, cylinders, spheres and mesh files as triangles, each on a body of the model.

    source, reading: as in load; the bodies are those of the model that load makes of them
    geometry: "visual" or "collision"
    faces: how many triangles all shapes may have together, about; None leaves them as they are

    Mesh files are STL, OBJ and Collada (.dae), in meters times their scale; a Collada file states its own unit.
    package://NAME/… is looked for beside the file and in every folder above it, then in ROS_PACKAGE_PATH and
    AMENT_PREFIX_PATH; other paths are relative to the file. Nothing is fetched. What cannot be shown is listed in
    .missing with the reason.

    Raises load's errors, and InvalidInput for another geometry or a number of faces that is none. Warns nothing.
    """
    if geometry not in GEOMETRIES:
        raise InvalidInput(f"geometry is {geometry!r}; give 'visual' or 'collision'")
    if faces is not None and (not isinstance(faces, Integral) or isinstance(faces, bool) or faces < 1):
        raise InvalidInput(f"faces is {faces!r}; give a whole number from 1 on, or None")
    opened, elements, parsed = parsed_source(source, Reading.of(shapes, reading))
    model = build(parsed, opened.gravity)
    names = (model.base_name, *model.body_names)
    own = (Frame(name, body, Placement()) for body, name in enumerate(names))
    places = {frame.name: (names[frame.body], frame.placement) for frame in (*model.frames, *own)}
    return placed_shapes(elements, geometry, places, faces)
