"""What plain URDF cannot say about a model: chords as <loop>, couplings of several joints as <coupling>, of URDF+.

URDF+ is the one form among those that are read which has both, and a publication and files to go with it. It has no
type for a ball and for a distance: these are written as type "spherical", and "distance" with a <length>. Motors are
<transmission> elements, as everywhere in URDF.
"""

from __future__ import annotations

from collections.abc import Iterator
from graphlib import TopologicalSorter
from itertools import product

from lxml import etree

from graphdyn import Coupling, RobotModel
from urdf.document.numbers import add_placement, text
from urdf.errors import CannotSave, shortened

LOOP_TYPES = {"hinge": "revolute", "slide": "prismatic", "weld": "fixed", "ball": "spherical", "distance": "distance"}
"""Loop types by the kind of a chord: the type of <loop>."""


def loop_elements(model: RobotModel) -> Iterator[etree._Element]:
    """One <loop> per chord."""
    links = (model.base_name, *model.body_names)
    for chord in model.chords:
        loop = etree.Element("loop", name=chord.name, type=LOOP_TYPES[chord.kind])
        add_placement(etree.SubElement(loop, "predecessor", link=links[chord.body_i]), chord.placement_i)
        add_placement(etree.SubElement(loop, "successor", link=links[chord.body_j]), chord.placement_j)
        etree.SubElement(loop, "axis", xyz=text(chord.axis))
        if chord.length is not None:
            etree.SubElement(loop, "length", value=repr(chord.length))
        yield loop


def coupling_elements(model: RobotModel) -> Iterator[etree._Element]:
    """One <coupling> per coupling of several joints; those that drive others before these.

    Raises CannotSave for a coupling with an offset, and for one that is not of two sums from a common ancestor.
    """
    driven = {coupling.joint: coupling for coupling in model.couplings}
    order = TopologicalSorter({name: coupling.ratios for name, coupling in driven.items()}).static_order()
    for coupling in (driven[name] for name in order if name in driven):
        if len(coupling.ratios) > 1:
            predecessor, successor, ratio = _sums(model, coupling)
            element = etree.Element("coupling", name=f"{coupling.joint}_coupling")
            etree.SubElement(element, "predecessor", link=predecessor)
            etree.SubElement(element, "successor", link=successor)
            etree.SubElement(element, "ratio", value=repr(ratio))
            yield element


def independent_marks(model: RobotModel) -> dict[str, str]:
    """The attribute independent= of each joint in a coupling of several."""
    driven = {coupling.joint for coupling in model.couplings}
    several = [coupling for coupling in model.couplings if len(coupling.ratios) > 1]
    named = {name for coupling in several for name in (coupling.joint, *coupling.ratios)}
    return {name: "false" if name in driven else "true" for name in named}


def transmission_elements(model: RobotModel) -> Iterator[etree._Element]:
    """One <transmission> per actuated joint."""
    for joint in model.actuated or ():
        transmission = etree.Element("transmission", name=f"{joint}_transmission")
        etree.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
        etree.SubElement(transmission, "joint", name=joint)
        etree.SubElement(transmission, "actuator", name=f"{joint}_motor")
        yield transmission


def _sums(model: RobotModel, coupling: Coupling) -> tuple[str, str, float]:
    """The two links of <coupling>, and the ratio of the sum down to the second to that down to the first."""
    index = {name: k for k, name in enumerate(model.joint_names)}
    wanted = {index[coupling.joint]: 1.0} | {index[name]: -ratio for name, ratio in coupling.ratios.items()}
    ends = {0, *(j + 1 for j in wanted), *(model.joints[j].inside for j in wanted)}
    ways = {body: _way(model, body) for body in ends}
    for predecessor, successor in product(sorted(ends), repeat=2) if coupling.offset == 0 else ():
        up, down = ways[predecessor] - ways[successor], ways[successor] - ways[predecessor]
        if index[coupling.joint] in down and up | down == wanted.keys():
            ratios = {-wanted[j] for j in up} or {1.0}
            if {wanted[j] for j in down} == {1.0} and len(ratios) == 1:
                links = (model.base_name, *model.body_names)
                return links[predecessor], links[successor], ratios.pop()
    raise CannotSave(
        f"joint '{shortened(coupling.joint)}' is driven by {len(coupling.ratios)} joints, and neither <mimic> nor "
        "<coupling> can say how",
        "save model.uncoupled, and state the coupling where the file is loaded",
    )


def _way(model: RobotModel, body: int) -> set[int]:
    """Indices of the joints between the ground and a body."""
    way = set()
    while body:
        way.add(body - 1)
        body = model.joints[body - 1].inside
    return way
