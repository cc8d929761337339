"""Faults that any function may have: the answers are those of the verb with the change that the words name, by hand."""

import dataclasses
import itertools
import re

import numpy as np
import pytest
import scipy
from planting import mixed_tree, with_joint
from scipy.spatial.transform import Rotation

import graphdyn
from crosscheck.judging.searching.answer_faults import answer_fault, faults, layouts
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS
from graphdyn import Frame, Placement
from graphdyn.model.spatial import rotation_about

ALIKE = 1e-9
"""Relative to the largest entry."""

STEP, DIFFERENCED = 1e-6, 1e-5
"""Rates of angles by central differences, and how near these are where no angle is at its singularity."""

JUDGED = (
    "inverse_dynamics", "forward_dynamics", "mass_matrix", "kinetic_energy", "potential_energy", "gravity_torque",
    "coriolis_matrix", "frame_placement", "frame_jacobian", "frame_velocity", "joint_torque_regressor", "momentum",
    "mass_matrix_inverse", "da_dv",
)  # fmt: skip


@pytest.fixture(scope="module")
def model():
    turned = Placement(rotation_about(np.array([0.6, 0.0, 0.8]), 0.4), np.ones(3) / 3)
    tree = dataclasses.replace(mixed_tree(), frames=(Frame("tool", 3, turned), Frame("eye", 2, turned)))
    return tree.with_base(Placement(rotation_about(np.array([0.0, 0.6, 0.8]), 1.1), np.array([0.3, -0.2, 0.7])))


class ByHand:
    """What a function answers at a state that was changed as a sentence says."""

    def __init__(self, name, states, chosen):
        self.name, self.states, self.chosen, self.model, self.frame = name, states, chosen, states.model, "tool"
        self.given = {"q": states.q, "v": states.v, "a": states.a, "tau": states.tau}
        self.loads = states.loads

    def answer(self):
        verb = {"inverse_dynamics": "joint_torques", "forward_dynamics": "joint_accelerations"}
        arguments = [self.given[name] for name in FUNCTIONS[self.name].arguments if name in self.given]
        loaded = self.loads is not None and self.name in (*verb, "power")
        options = {"external_wrenches": self.loads} if loaded else {}
        if self.name.startswith("frame"):
            options = {} if self.name == "frame_placement" else {"reference": self.chosen["reference"]}
            arguments.append(self.frame)
        if self.name.startswith("da_"):
            return getattr(graphdyn.forward_dynamics_derivatives(self.model, *arguments), self.name)
        found = getattr(graphdyn, verb.get(self.name, self.name))(self.model, *arguments, **options)
        if self.name == "frame_placement":
            placed = np.zeros((len(self.states.q), 4, 4))
            placed[:, :3, :3], placed[:, :3, 3], placed[:, 3, 3] = *found, 1.0
            return placed
        if self.name == "momentum":
            found = (
                found.about_origin if self.chosen.get("about") == "the world's origin" else found.about_center_of_mass
            )
        six = {"frame_jacobian": 1, "frame_velocity": 1, "momentum": 1}.get(self.name)
        return np.roll(found, 3, axis=six) if six and self.chosen.get("order") == "angular first" else found

    def of(self, message):
        """The answers of a function that does as the sentence says."""
        matches = ((re.fullmatch(pattern, message), change) for pattern, change in CHANGES.items())
        found, change = next((found, change) for found, change in matches if found)
        return change(self, *found.groups())

    def changed_arguments(self, names, how):
        factor = {
            "taken as degrees": np.pi / 180,
            "converted to degrees": 180 / np.pi,
            "taken with the opposite sign": -1,
            "ignored": 0,
        }[how]
        for name in names.split(" and "):
            self.given[name] = factor * self.given[name]
        return self.answer()

    def exchanged(self, x, y):
        self.given[x], self.given[y] = self.given[y], self.given[x]
        return self.answer()

    def part(self, which):
        found = self.answer()
        second = (which == "angular") != (self.chosen.get("order") == "angular first")
        found = found.copy()
        found[:, 3 * second : 3 * second + 3] *= -1
        return found

    def other_loads(self, how):
        force, moment = self.loads[..., :3].copy(), self.loads[..., 3:].copy()
        if how == "are left out":
            self.loads = 0 * self.loads
        elif how == "have the opposite sign":
            self.loads = -self.loads
        elif how == "are taken as moment, then force":
            self.loads = np.concatenate([moment, force], axis=-1)
        elif how == "are taken without their moments: they are left out":
            self.loads = np.concatenate([force, 0 * moment], axis=-1)
        elif how == "are taken without their forces: they are left out":
            self.loads = np.concatenate([0 * force, moment], axis=-1)
        elif how == "have moments of the opposite sign":
            self.loads = np.concatenate([force, -moment], axis=-1)
        elif body := re.fullmatch(r"(on body|of all bodies but) '(.*)' are left out", how):
            of_it = np.array([name == body[2] for name in self.model.body_names])
            self.loads = self.loads * (of_it != (body[1] == "on body"))[:, None]
        elif found := re.fullmatch("(are|have forces that are|have moments that are) taken in (.*)", how):
            state = graphdyn.maximal_state(self.model, self.states.q)
            self.loads = self.loads.copy()
            for k, joint in enumerate(self.model.joints):
                base = np.tile(self.model.base.rotation, (len(force), 1, 1))
                inside, own = state.rotation[:, joint.inside - 1] if joint.inside else base, state.rotation[:, k]
                back = np.swapaxes(own, 1, 2)
                turn = {
                    "world axes": back,
                    "world axes, turned the wrong way": back @ back,
                    "axes of the inside links": back @ inside,
                }[found[2]]
                for half, words in ((slice(0, 3), "have forces that are"), (slice(3, 6), "have moments that are")):
                    if found[1] in ("are", words):
                        self.loads[:, k, half] = np.einsum("nab,nb->na", turn, self.loads[:, k, half])
        elif how in ("are taken as those of the body after", "are taken as those of the body before"):
            shifted = np.zeros_like(self.loads)
            if how.endswith("before"):
                shifted[:, 1:] = self.loads[:, :-1]
            else:
                shifted[:, :-1] = self.loads[:, 1:]
            self.loads = shifted
        elif how == "are taken as acting at the origins of the inside links":
            state = graphdyn.maximal_state(self.model, self.states.q)
            places = [graphdyn.frame_placement(self.model, self.states.q, x.name)[1] for x in self.model.bodies]
            for k, joint in enumerate(self.model.joints):
                ground = np.tile(self.model.base.translation, (len(force), 1))
                arm = (places[joint.inside - 1] if joint.inside else ground) - places[k]
                local = np.einsum("nba,nb->na", state.rotation[:, k], arm)
                moment[:, k] += np.cross(local, force[:, k])
            self.loads = np.concatenate([force, moment], axis=-1)
        else:
            centers = np.array([body.center_of_mass for body in self.model.bodies])
            self.loads = np.concatenate([force, moment + np.cross(centers, force)], axis=-1)
        return self.answer()

    def rates(self, angles):
        """By differences of the angles along each column."""
        sequence = {"roll, pitch and yaw": "xyz", "yaw, pitch and roll": "ZYX", "the Euler angles of z, y, z": "ZYZ"}
        found, q = self.answer().copy(), self.given["q"]
        second = 0 if self.chosen.get("order") == "angular first" else 3
        ways = np.eye(q.shape[1]) if found.ndim == 3 else self.given["v"][None]
        for k, way in enumerate(ways):
            there, back = (
                Rotation.from_matrix(
                    graphdyn.frame_placement(self.model, q + sign * STEP * way, self.frame)[0]
                ).as_euler(sequence[angles])
                for sign in (1, -1)
            )
            rate = (np.mod(there - back + np.pi, 2 * np.pi) - np.pi) / (2 * STEP)
            if found.ndim == 3:
                found[:, second : second + 3, k] = rate
            else:
                found[:, second : second + 3] = rate
        return found

    def placed(self, how):
        found = self.answer()
        if how == "the placement is inverted: the world seen from the frame":
            return np.array([np.linalg.inv(one) for one in found])
        for one in found:
            one[:3, :3] = one[:3, :3].T.copy()
        return found

    def of_quaternion(self, order):
        """Of four numbers in the other order, read in this one; by the formula of the matrix."""
        found = self.answer()
        for one in found:
            x, y, z, w = Rotation.from_matrix(one[:3, :3]).as_quat(canonical=True)
            x, y, z, w = (w, x, y, z) if order == "x, y, z, w" else (y, z, w, x)
            one[:3, :3] = [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        return found

    def of_frame(self, name):
        self.frame = name
        return self.answer()

    def other_model(self, message):
        names = re.findall(r"'(.*)'", message)
        if message == "gravity is left out":
            self.model = self.model.with_gravity(np.zeros(3))
        elif message == "gravity has the opposite sign":
            self.model = self.model.with_gravity(-self.model.gravity)
        elif not names:
            self.model = self.model.with_base(Placement())
        else:
            number = self.model.joint_names.index(names[0])
            joint = self.model.joints[number]
            if message.startswith("the axis"):
                self.model = with_joint(self.model, number + 1, axis=-joint.axis)
            else:
                turned = Placement(joint.placement.rotation.T, joint.placement.translation)
                self.model = with_joint(self.model, number + 1, placement=turned)
        return self.answer()

    def of_other_mass_matrix(self):
        """The derivatives of M⁻¹ (τ − h), with M⁻¹ of another pose."""
        at_zero = [graphdyn.mass_matrix(self.model, 0 * q) for q in self.given["q"]]
        return np.linalg.inv(at_zero) @ graphdyn.mass_matrix(self.model, self.given["q"]) @ self.answer()

    def with_gravity(self):
        q = self.given["q"]
        return self.answer() + graphdyn.forward_dynamics(self.model, q, 0 * q, 0 * q).a[..., None]

    def of_triangle(self, which):
        triangle = {"lower": np.tril, "upper": np.triu}[which]
        return np.linalg.inv(triangle(graphdyn.mass_matrix(self.model, self.given["q"])))

    def of_factors(self):
        factors = [
            scipy.linalg.inv(scipy.linalg.cholesky(M)) for M in graphdyn.mass_matrix(self.model, self.given["q"])
        ]
        return np.array([factor.T @ factor for factor in factors])

    def partly_inverted(self):
        right = self.answer()
        return np.array([np.block([[x[:3, :3].T, -x[:3, 3:]], [x[3:]]]) for x in right])

    def column_by_column(self):
        found = self.answer()
        return np.array([one.T.ravel().reshape(one.shape) for one in found])

    def of_other_function(self, name):
        return ByHand(name, self.states, {}).answer()


CHANGES = {
    "the absolute values of the numbers are given": lambda self: np.abs(self.answer()),
    "negative numbers are replaced by zero": lambda self: np.where(self.answer() < 0, 0.0, self.answer()),
    "the angular part is of the rates of (.*), not of the angular velocity": ByHand.rates,
    "the last row is \\(0, 0, 0, 0\\), not \\(0, 0, 0, 1\\)": lambda self: (
        self.answer() * np.array([[1], [1], [1], [0]])
    ),
    "all answers have the opposite sign": lambda self: -self.answer(),
    "the matrix is made symmetric, ½ .X . Xᵀ.": lambda self: (self.answer() + self.answer().swapaxes(1, 2)) / 2,
    "each entry is the sum of those of all joints before it, and its own": lambda self: self.answer().cumsum(axis=1),
    "each column is that of the joint before it": lambda self: self.answer()[
        ..., [-1, *range(self.states.q.shape[1] - 1)]
    ],
    "each column is that of the joint after it": lambda self: self.answer()[
        ..., [*range(1, self.states.q.shape[1]), 0]
    ],
    "the (lower|upper) triangle of the mass matrix alone is inverted": ByHand.of_triangle,
    "M⁻¹ is that at q = 0": ByHand.of_other_mass_matrix,
    "gravity acts in every column.*": ByHand.with_gravity,
    "the inverse of the factor of Cholesky .*": ByHand.of_factors,
    "the placement is inverted, but .*": ByHand.partly_inverted,
    "the matrix is transposed": lambda self: self.answer().swapaxes(1, 2),
    "only the diagonal of the matrix is filled in": lambda self: self.answer() * np.eye(self.answer().shape[-1]),
    "only the lower triangle of the matrix is filled in": lambda self: np.tril(self.answer()),
    "only the upper triangle of the matrix is filled in": lambda self: np.triu(self.answer()),
    "the numbers of the matrix are stored column by column": ByHand.column_by_column,
    "the (linear|angular) part has the opposite sign": ByHand.part,
    "the answers are those of (\\w*)(?:, which takes no .*)?": ByHand.of_other_function,
    "(.*) (?:is|are) (.* degrees|taken with the opposite sign|ignored)": ByHand.changed_arguments,
    "(.) and (.) are exchanged": ByHand.exchanged,
    "the external wrenches (.*)": ByHand.other_loads,
    "the answers are those of frame '(.*)'": ByHand.of_frame,
    "the quaternion of the rotation is taken in the order (.*), which is not its own": ByHand.of_quaternion,
    "(the placement is inverted.*|the rotation is transposed)": ByHand.placed,
    "(.*)": ByHand.other_model,
}
"""By the words of a fault; of the patterns that fit the first."""


@pytest.mark.parametrize(("name", "loaded"), [*((name, False) for name in JUDGED), ("inverse_dynamics", True)])
def test_words(model, name, loaded):
    """Each in some ways to read the answers; a fault is found again."""
    known = FUNCTIONS[name]
    states = JudgedStates.draw(model, 1, 4, needs_tau=True, loaded=loaded, frame="tool")
    for chosen in itertools.islice(known.readings({}), 3):
        right = known.of_graphdyn(states, chosen)
        np.testing.assert_allclose(ByHand(name, states, chosen).answer(), right, atol=ALIKE * np.abs(right).max())
        told = []
        for fault in itertools.chain(layouts(known), faults(known, states)):
            expected = ByHand(name, states, chosen).of(fault.message)
            size = max(np.abs(right).max(), np.abs(expected).max())
            np.testing.assert_allclose(
                fault.answers(states, chosen),
                expected,
                atol=(DIFFERENCED if "rates" in fault.message else ALIKE) * size,
                err_msg=f"{fault.message} {chosen}",
            )
            told.append(fault.message)
        assert len(set(told)) == len(told)
    found = answer_fault(known, -right, states, chosen, 1e-9)
    assert (found.said.message, found.said.kind) == ("all answers have the opposite sign", "sign")
