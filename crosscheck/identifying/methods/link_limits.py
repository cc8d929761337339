"""Limits of the links for every method that keeps any: boxes from meshes that are found, factors as asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import is_dataclass, replace
from typing import Any

import numpy as np

import urdf
from crosscheck.identifying.methods.methods import Labeled
from crosscheck.reference.subject import Subject
from graphdyn import InvalidInput
from graphdyn.identification import Estimator, PhysicalLimits
from graphdyn.layout import Array

MESH_MARGIN = 0.1
"""Margin around the meshes of a link, relative to the longest side of their box: for cables, covers, and rounding."""

PAYLOAD = "payload"


def link_limits(robot: Subject, asked: PhysicalLimits | None) -> PhysicalLimits:
    """The limits that were asked for, with boxes from the meshes of the robot's file for links without one.

    Raises InvalidInput for limits of links that the robot does not have.
    """
    asked = asked or PhysicalLimits()
    for given in (asked.mass, asked.center, asked.cad_factors, asked.box):
        for name in given:
            if name not in (*robot.model.body_names, PAYLOAD):
                raise InvalidInput(
                    f"there is no link '{name}' to limit; robot '{robot.model.name}' has "
                    f"{', '.join(robot.model.body_names)}"
                )
    return replace(asked, box={**mesh_boxes(robot), **asked.box}) if asked.in_boxes else asked


def mesh_boxes(robot: Subject) -> dict[str, Array]:
    """Boxes (2, 3) around the meshes of the links that carry others, with MESH_MARGIN, in link axes [m].

    What is mounted on the last link is in no file; its box is that of its reach. A link with a mesh that cannot be
    read has none either.
    """
    if robot.file is None:
        return {}
    try:
        shapes = urdf.shapes(robot.name, reading=robot.reading)
    except (urdf.URDFError, OSError):  # the model was read all the same
        return {}
    missing = {shape.link for shape in shapes.missing}
    places: dict[str, list[Array]] = {}
    incomplete = set()
    for shape in shapes.meshes:
        if shape.link in missing:
            incomplete.add(shape.body)
        places.setdefault(shape.body, []).append(
            shape.vertices @ shape.placement.rotation.T + shape.placement.translation
        )
    names = robot.model.body_names
    carriers = {names[joint.inside - 1] for joint in robot.model.joints if joint.inside > 0}
    boxes = {}
    for body, vertices in places.items():
        corners = np.concatenate(vertices)
        if body in carriers and body not in incomplete | missing and len(corners):
            low, high = corners.min(axis=0), corners.max(axis=0)
            margin = MESH_MARGIN * float((high - low).max())
            boxes[body] = np.stack([low - margin, high + margin])
    return boxes


def with_limits(estimators: Sequence[Estimator], limits: PhysicalLimits) -> list[Estimator]:
    """The estimators; those with limits of their own kind take these, unless they were given others."""
    return [_limited(estimator, limits) for estimator in estimators]


def _limited(estimator: Any, limits: PhysicalLimits) -> Estimator:
    if isinstance(estimator, Labeled):
        return replace(estimator, estimator=_limited(estimator.estimator, limits))
    own = getattr(estimator, "limits", None)
    if is_dataclass(estimator) and isinstance(own, PhysicalLimits) and not own.stated:
        return replace(estimator, limits=limits)  # type: ignore[type-var, return-value]
    return estimator  # type: ignore[no-any-return]
