"""The inspection of one file: the stages of urdf.load, continued after a fault as far as the file can be read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from typing import Literal, Unpack, get_args

import numpy as np

from graphdyn import InvalidInput
from graphdyn.arguments import reproducible
from graphdyn.model import STANDARD_GRAVITY
from urdf.document.connections.loops import CompanionFiles
from urdf.document.document import Document
from urdf.document.opening import Given, open_document, path_of, said
from urdf.document.source import Source, reduced
from urdf.document.tree import carriers, tree_faults
from urdf.errors import URDFError
from urdf.inspection.findings import Finding, Inspection, of_file, refusal, report
from urdf.inspection.rules.density_rules import density_findings
from urdf.inspection.rules.document_rules import document_findings, name_findings, unread_findings
from urdf.inspection.rules.joint_rules import joint_findings
from urdf.inspection.rules.link_rules import link_findings
from urdf.inspection.rules.mesh_rules import mesh_findings
from urdf.inspection.rules.model_rules import model_findings
from urdf.inspection.rules.plausibility_rules import plausibility_findings
from urdf.inspection.rules.reader_rules import reader_findings
from urdf.inspection.rules.rounding_rules import rounding_findings
from urdf.inspection.rules.slender_rules import slender_findings
from urdf.inspection.structure import Structure
from urdf.loops.closing import all_closures, closure_faults, stated_beside
from urdf.reading.checks import faults
from urdf.reading.parsing import build, parse
from urdf.reading.reading import Reading, ReadingKeywords
from urdf.reading.repairing import repair, uses_geoms

MAX_FINDINGS = 1000
"""Largest number of findings that a stage reports."""


Meshes = Literal["summary", "detail", "off"]


@reproducible()
def inspect(source: Given, *, meshes: Meshes = "summary", **reading: Unpack[ReadingKeywords]) -> Inspection:
    """Everything odd or wrong about a URDF file or a robot of the catalog, and whether it is good for dynamics.

    source: as urdf.load takes it: name, path, XML as text or bytes, an open file
    meshes: inertials are compared with the meshes of their links where these are found: "detail" tells of every
        link's tensor, "summary" in one finding of those that are far from it, "off" opens no mesh
    reading: as in urdf.load; findings about elements are those of the whole file after repairs, findings about the
        model those of the arm that is cut out, with its joints locked

    Raises InvalidInput for another value of meshes, and nothing for the content of a file, nor for a file that does
    not exist: both are errors among the findings. report.usable says whether forward dynamics can be computed;
    report.findings has a code, a severity ("error": urdf.load refuses the file, "warning": dynamics are doubtful,
    "note"), the element, its line, a message that also states what Pinocchio and yourdfpy do there, and a remedy. The
    mass matrix is examined at five random states.

    >>> import urdf
    >>> pendulum = '''<robot name="pendulum">
    ...   <link name="base"/>
    ...   <link name="rod"><inertial>
    ...     <mass value="-2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
    ...   </inertial></link>
    ...   <joint name="hinge" type="continuous">
    ...     <parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
    ...   </joint>
    ... </robot>'''
    >>> found = urdf.inspect(pendulum)
    >>> found.verdict, found.findings[0].line, found.findings[0].code
    ('refused', 4, 'negative-mass')
    """
    if meshes not in get_args(Meshes):
        raise InvalidInput(f"meshes is {meshes!r}; give one of {', '.join(map(repr, get_args(Meshes)))}")
    how = Reading.of(inspect, reading)
    asked, path = said(source), None
    try:
        path = path_of(source)
        with np.errstate(all="ignore"):  # numbers may be as large as the largest double
            return report(
                asked, str(path), list(_findings(open_document(source, how.xacro, uses_geoms(how.repair)), meshes, how))
            )
    except URDFError as error:
        found = refusal(error)
    except OSError as error:
        found = of_file("unreadable-file", f"the file cannot be read: {error}")
    return report(asked, None if path is None else str(path), [found])


def _findings(document: Document, meshes: Meshes, reading: Reading) -> Iterator[Finding]:
    around = [
        *_of_the_expansion(document),
        *_limited(document_findings(document)),
        *_limited(reader_findings(document)),
    ]
    try:
        beside = stated_beside(reading.loops, document.path)
        source = reduced(document)
        repair(source, reading.repair)
    except URDFError as error:
        yield from around
        yield refusal(error)
        return
    refusals = [refusal(error) for error in islice(_refusals(source, beside, reading), MAX_FINDINGS + 1)]
    structure = Structure.of(source)
    found = [*_limited(iter(refusals))]
    for rules in (
        unread_findings,
        name_findings,
        link_findings,
        density_findings,
        slender_findings,
        joint_findings,
    ):
        found += _limited(rules(structure))
    sound = not any(finding.severity == "error" for finding in found)
    drawn = [*_limited(mesh_findings(structure, meshes == "detail"))] if sound and meshes != "off" else []
    if drawn:  # which tell of the mesh files too
        around = [finding for finding in around if finding.code != "mesh-files"]
    yield from (*around, *found, *drawn)
    if sound:
        yield from _of_the_model(source, beside, structure, replace(reading, repair=()))


def _of_the_expansion(document: Document) -> Iterator[Finding]:
    if document.complaints is None:
        return
    yield of_file("xacro-expanded", "the file is expanded by xacro: lines are those of the files that it is made of")
    for complaint in document.complaints:
        yield of_file("xacro-complaint", f"expanding the file: {complaint}")


def _refusals(source: Source, beside: CompanionFiles, reading: Reading) -> Iterator[URDFError]:
    yield from faults(source)
    yield from tree_faults(source)
    if reading.chain is None and not reading.lock:  # else they depend on what is cut out and locked
        yield from closure_faults(all_closures(source, beside), carriers(source), source)


def _of_the_model(source: Source, beside: CompanionFiles, structure: Structure, reading: Reading) -> Iterator[Finding]:
    try:
        model = build(parse(source, beside, reading), STANDARD_GRAVITY)
    except URDFError as error:
        yield refusal(error)
        return
    yield from model_findings(model, structure)
    yield from plausibility_findings(model, structure)
    yield from rounding_findings(model, structure)


def _limited(findings: Iterator[Finding]) -> Iterator[Finding]:
    """The first MAX_FINDINGS findings, and a note if there are more."""
    yield from islice(findings, MAX_FINDINGS)
    if next(findings, None) is not None:
        yield of_file("more-findings", f"only the first {MAX_FINDINGS} findings of a kind are listed")
