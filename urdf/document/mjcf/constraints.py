"""Equalities of MuJoCo: of joints as couplings or held joints, connect as a ball, weld as a weld.

MuJoCo's constraints are springs that give way a little (solref, solimp); here they hold exactly.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from lxml import etree

from graphdyn import Placement
from urdf.document.mjcf.bodies import Mimic, Tree
from urdf.document.mjcf.merging import Merged, Place
from urdf.document.mjcf.native import Native
from urdf.document.numbers import add_placement
from urdf.errors import UnsupportedConstraint, shortened

ANCHOR, RELATIVE_POSITION, RELATIVE_ROTATION, TORQUE_SCALE = slice(0, 3), slice(3, 6), slice(6, 10), 10
"""Entries of eq_data: of a weld, the anchor lies in body 2, the relative pose of which is seen from body 1; of a
connect, the first six are its two anchors."""


def _active(native: Native) -> Iterator[int]:
    """Numbers of the equalities that hold."""
    bits, model = native.mujoco.mjtDisableBit, native.model
    off = int(bits.mjDSBL_CONSTRAINT) | int(getattr(bits, "mjDSBL_EQUALITY", 0))
    if not int(model.opt.disableflags) & off:
        yield from (k for k in range(model.neq) if model.eq_active0[k])


def held_and_coupled(native: Native, whole: Merged) -> tuple[dict[int, float], dict[int, Mimic]]:
    """Joints that stand still at a position [rad or m], and joints that one other drives, by number.

    y − y_0 = c_0 + c_1 (x − x_0), with x_0 and y_0 the positions `ref`. Raises UnsupportedConstraint.
    """
    model, mujoco = native.model, native.mujoco
    held: dict[int, float] = {}
    coupled: dict[int, Mimic] = {}
    for k in _active(native):
        if int(model.eq_type[k]) != int(mujoco.mjtEq.mjEQ_JOINT):
            continue
        y, x = int(model.eq_obj1id[k]), int(model.eq_obj2id[k])
        c = [float(one) for one in model.eq_data[k][:5]]
        joint = f"joint '{shortened(model.joint(y).name)}'"
        if y in held or y in coupled:
            raise _refused(native, whole, k, f"drives {joint}, which another drives already", "keep one of them")
        ref = float(model.qpos0[model.jnt_qposadr[y]])
        if x < 0:
            held[y] = ref + c[0]
            continue
        if any(c[2:]):
            problem = f"drives {joint} by a polynomial that is not linear"
            raise _refused(native, whole, k, problem, 'give polycoef two numbers, or make it active="false"')
        if c[1] == 0:
            held[y] = ref + c[0]
        else:
            coupled[y] = model.joint(x).name, c[1], ref + c[0] - c[1] * float(model.qpos0[model.jnt_qposadr[x]])
    return held, coupled


def constraint_elements(native: Native, whole: Merged, tree: Tree) -> Iterator[tuple[etree._Element, Place]]:
    """One <loop> per connect and weld, and the motors of a robot that has some."""
    model, kinds = native.model, native.mujoco.mjtEq
    loops = False
    for k in _active(native):
        kind = int(model.eq_type[k])
        if kind == int(kinds.mjEQ_JOINT):
            continue
        welds = kind == int(kinds.mjEQ_WELD) and model.eq_data[k][TORQUE_SCALE] != 0
        name, ends = _name(native, k), _ends(native, k, tree)
        loop = etree.Element("loop", name=name, type="fixed" if welds else "spherical")
        for tag, (link, placement) in zip(("predecessor", "successor"), ends, strict=True):
            add_placement(etree.SubElement(loop, tag, link=link), placement)
        loops = True
        yield loop, _place(native, whole, k)
    if loops:
        for joint in dict.fromkeys(actuator.joint for actuator in native.actuators):
            transmission = etree.Element("transmission", name=f"{joint}_transmission")
            etree.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
            etree.SubElement(transmission, "joint", name=joint)
            etree.SubElement(transmission, "actuator", name=f"{joint}_motor")
            yield transmission, whole.place("joint", joint)


def _ends(native: Native, k: int, tree: Tree) -> tuple[tuple[str, Placement], tuple[str, Placement]]:
    model = native.model
    first, second, data = int(model.eq_obj1id[k]), int(model.eq_obj2id[k]), np.array(model.eq_data[k])
    if int(model.eq_objtype[k]) == int(native.mujoco.mjtObj.mjOBJ_SITE):
        return tree.site(first), tree.site(second)
    if int(model.eq_type[k]) == int(native.mujoco.mjtEq.mjEQ_CONNECT):
        on_first, on_second = Placement(translation=data[:3]), Placement(translation=data[3:6])
    else:
        from scipy.spatial.transform import Rotation  # imported where first used: help needs no scipy

        rotation = Rotation.from_quat(data[RELATIVE_ROTATION], scalar_first=True).as_matrix()
        on_first = Placement(rotation, data[RELATIVE_POSITION])
        on_second = Placement(translation=data[ANCHOR])
    return (tree.links[first], on_first), (tree.links[second], on_second)


def _name(native: Native, k: int) -> str:
    return str(native.model.equality(k).name)


def _place(native: Native, whole: Merged, k: int) -> Place:
    return whole.place("equality", _name(native, k), native.lines.get(("equality", _name(native, k)), ""))


def _refused(native: Native, whole: Merged, k: int, problem: str, remedy: str) -> UnsupportedConstraint:
    path, line = _place(native, whole, k)
    return UnsupportedConstraint(
        problem, remedy, path=path, line=line, element=f"equality '{shortened(_name(native, k))}'"
    )
