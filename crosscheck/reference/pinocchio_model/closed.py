"""Robots with loops in Pinocchio: its constrained dynamics, with points that are held together.

Carpentier, Budhiraja and Mansard, "Proximal and sparse resolution of constrained dynamic equations", Robotics: Science
and Systems, 2021.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
import pinocchio as pin

from crosscheck.reference.pinocchio_model.model import PinocchioModel
from crosscheck.reference.pinocchio_model.native import se3
from graphdyn import Chord
from graphdyn.layout import Array

POINT_CHORD_KINDS = ("hinge", "ball", "weld")
"""Chords that can be held by points; a slide and a distance cannot."""

CLOSURE_ACCURACY, MAX_CLOSURE_ITERATIONS = 1e-14, 30
"""Accuracy and iterations of the proximal method, whose accuracy only ends it early."""

CLOSURE_TRIALS = tuple((apart, mu) for apart in (1.0, 0.1, 0.01) for mu in (1e-12, 1e-10, 1e-8))
"""Distance of a chord's further points [m] and μ. With redundant rows and μ = 0 Pinocchio is silently wrong; with links
of 7 mg on a delta robot it is NaN for most of these. The answer that leaves the smallest residual is taken."""


def closed_dynamics(
    robot: PinocchioModel, chords: tuple[Chord, ...], q: Array, v: Array, tau: Array, external_wrenches: Array
) -> tuple[Array, Array, float]:
    """Accelerations (n,), joint wrenches data.f (n, 6) and what is missing of τ, at one state of a tree with chords.

    Of redundant constraints the joint wrenches are those of the forces that Pinocchio finds. NaN where it finds none.
    """
    state, still = robot.configuration(q), np.zeros(robot.native.nv)
    forces, native = robot.forces(external_wrenches), robot.native
    resting = pin.rnea(native, robot.data, state, still, still)
    loads = pin.rnea(native, robot.data, state, still, still, forces) - resting
    best = (np.inf, np.full(q.shape, np.nan), np.full((*q.shape, 6), np.nan))
    for apart, mu in CLOSURE_TRIALS:
        a, forces = _solved(robot, _contacts(robot, chords, apart), mu, state, v, tau, loads, external_wrenches)
        if np.isfinite(a).all():
            needed = pin.rnea(native, robot.data, state, robot.there(v), a, forces)[robot.columns]
            residual = float(np.abs(needed - tau).max())
            if residual < best[0]:
                best = (residual, a[robot.columns], robot.joint_wrenches())
    return best[1], best[2], best[0]


def _solved(
    robot: PinocchioModel,
    contacts: Iterable[pin.RigidConstraintModel],
    mu: float,
    state: Array,
    v: Array,
    tau: Array,
    loads: Array,
    external_wrenches: Array,
) -> tuple[Array, pin.StdVec_Force]:
    """Accelerations in Pinocchio's order, and all forces on the bodies, those of the contacts included."""
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for contact in contacts:
        models.append(contact)
        datas.append(contact.createData())
    native, data = robot.native, robot.native.createData()
    pin.initConstraintDynamics(native, data, models, datas)
    settings, torques = pin.ProximalSettings(CLOSURE_ACCURACY, mu, MAX_CLOSURE_ITERATIONS), robot.there(tau) - loads
    a = np.array(pin.constraintDynamics(native, data, state, robot.there(v), torques, models, datas, settings))
    pin.forwardKinematics(native, robot.data, state)
    forces = robot.forces(external_wrenches)
    for contact, found in zip(models, datas, strict=True):
        first, second = contact.joint1_id, contact.joint2_id
        at_1, at_2 = robot.data.oMi[first] * contact.joint1_placement, robot.data.oMi[second] * contact.joint2_placement
        on_1 = found.contact_force
        forces[first] = forces[first] + contact.joint1_placement.act(on_1)
        forces[second] = forces[second] - contact.joint2_placement.act(at_2.actInv(at_1.act(on_1)))
    return a, forces


def _contacts(robot: PinocchioModel, chords: tuple[Chord, ...], apart: float) -> Iterator[pin.RigidConstraintModel]:
    for chord in chords:
        (joint_i, at_i), (joint_j, at_j) = (
            (robot.ids[body - 1] if body else 0, _on_body(robot, body, se3(placement)))
            for body, placement in ((chord.body_i, chord.placement_i), (chord.body_j, chord.placement_j))
        )
        for point in _points(chord, apart):
            there = pin.SE3(np.eye(3), point)
            yield pin.RigidConstraintModel(
                pin.ContactType.CONTACT_3D,
                robot.native,
                joint_i,
                at_i * there,
                joint_j,
                at_j * there,
                pin.ReferenceFrame.LOCAL,
            )


def _points(chord: Chord, apart: float) -> list[Array]:
    """What both bodies share, in axes of the chord [m]: the origin, and points apart from it.

    Not six constraints for a weld, which are NaN where a closing body has no mass.
    """
    further = {"hinge": [chord.triad[:, 2]], "ball": [], "weld": [chord.triad[:, 0], chord.triad[:, 1]]}
    return [np.zeros(3), *(apart * direction for direction in further[chord.kind])]


def _on_body(robot: PinocchioModel, body: int, placement: pin.SE3) -> pin.SE3:
    """On the ground the frame of the robot's mounting, which Pinocchio's universe does not have."""
    return placement if body else se3(robot.model.base) * placement
