"""What faults of the catalog do to the torques, against graphdyn with the same change made by hand."""

import dataclasses
import itertools
import re
from types import SimpleNamespace

import numpy as np
import pytest
from faults.files import TOOLS
from lxml import etree
from planting import mixed_tree, with_body, with_joint
from random_trees import random_tree
from scipy.spatial.transform import Rotation
from urdf_text import inertial

import urdf
from crosscheck.judging.faults import catalog
from crosscheck.judging.faults.arguments import angles, arguments, orders, units
from crosscheck.judging.faults.fault import is_round
from crosscheck.judging.faults.file_reading import file_reading
from crosscheck.judging.faults.geometry import geometry
from crosscheck.judging.faults.inertials import inertials, parameters
from crosscheck.judging.faults.recursion import DynamicsCode, torques_of
from crosscheck.judging.faults.signs import signs
from crosscheck.judging.faults.terms import gravity, joint_terms, terms
from crosscheck.judging.observing.noise import noise
from crosscheck.judging.searching.own_faults import OWN_FAULTS
from crosscheck.judging.states import JudgedStates
from graphdyn import JointLimits, inverse_dynamics
from graphdyn.model import PARAMETER_NAMES
from urdf.reading import Misreadings

ALIKE = 1e-12
"""Two recursions: some hundred roundings each."""

FITTED = 1e-9
"""Matrices of turns by other formulas, relative to the largest torque."""

URDF_TENSOR = ("xx", "xy", "xz", "yy", "yz", "zz")
PER_METER = {"millimeters": 1000, "centimeters": 100, "inches": 39.37007874015748}


@pytest.fixture(scope="module")
def model():
    return mixed_tree()


@pytest.fixture(scope="module")
def state(model):
    q, v = model.random_state(np.random.default_rng(5), 4)
    return q, v, np.random.default_rng(6).uniform(-5, 5, q.shape)


def said(fault):
    (description,) = fault.say(fault.right)
    return description


def torques(model, faults, state):
    """Torques (R, n) of a code with each fault, by what it says."""
    faults = list(faults(model))
    codes = [fault.change(DynamicsCode.of(model), fault.right) for fault in faults]
    return {said(fault).message: tau for fault, tau in zip(faults, torques_of(codes, state), strict=True)}


def check(found, expected):
    assert np.abs(found - expected).max() <= ALIKE * np.abs(expected).max()


def test_orders(model, state):
    """Every quantity is looked up by the name of its joint."""
    found, names = torques(model, orders, state), model.joint_names
    others = [order for order in itertools.permutations(names) if order != names]
    assert len(found) == 3 * len(others)
    for order in others:
        listed = ", ".join(order)
        ours, theirs = [order.index(name) for name in names], [names.index(name) for name in order]
        tau, reordered = (
            inverse_dynamics(model, *(x[:, which] for x in state)).tau for which in (range(len(names)), ours)
        )
        check(found[f"joint quantities are in the order {listed}"], reordered[:, theirs])
        check(found[f"joint motions, but not torques, are in the order {listed}"], reordered)
        check(found[f"torques, but not joint motions, are in the order {listed}"], tau[:, theirs])


TURNED_SIGNS = {
    "the axis of joint 'x' points the other way": "qvat",
    "the torque of joint 'x' has the opposite sign": "t",
    "the motion of joint 'x' is taken with the opposite sign, its torque is not": "qva",
    "velocity, acceleration and torque of joint 'x' are taken with the opposite sign, its position is not": "vat",
    "all torques have the opposite sign": "t",
}
"""What is negative, by the words that do not name it themselves."""

ANGLES = {
    "is clipped at ±π": lambda q: np.minimum(np.maximum(q, -np.pi), np.pi),
    "is replaced by its cosine": np.cos,
    "is replaced by its sine": np.sin,
    "is the other angle of (cos, sin), π/2 - q": lambda q: np.arctan2(np.cos(q), np.sin(q)),
    "is halved, as in a quaternion": lambda q: 0.5 * q,
    "is doubled": lambda q: q + q,
    "is held at zero": lambda q: 0.0 * q,
}


def members(model, message):
    """Numbers of the joints or bodies that a sentence names."""
    names = re.findall(r"'([^']*)'", message)
    known = model.body_names if "bod" in message else model.joint_names
    return [known.index(name) for name in names] if names else list(range(model.n_bodies))


def test_signs(model, state):
    """Of q, v, a and τ of joints; of products of inertia, and of centers of mass."""
    found = torques(model, signs, state)
    for message, tau in found.items():
        who = members(model, message)
        if "bod" in message:
            other = model
            for k in who:
                body = model.bodies[k]
                changed = {"inertia": body.inertia * (2 * np.eye(3) - 1)}
                if "center of mass" in message:
                    changed = {"center_of_mass": -body.center_of_mass}
                other = with_body(other, k + 1, **changed)
            check(tau, inverse_dynamics(other, *state).tau)
            continue
        words = re.sub(r"(every joint|joints? '.*')", "joint 'x'", message)
        named = {"position": "q", "velocity": "v", "acceleration": "a", "torque": "t"}
        turned = TURNED_SIGNS.get(words) or "".join(letter for word, letter in named.items() if word in words)
        sign = np.where(np.isin(np.arange(model.n_bodies), who), -1.0, 1.0)
        q, v, a = (sign * x if name in turned else x for name, x in zip("qva", state, strict=True))
        check(tau, inverse_dynamics(model, q, v, a).tau * (sign if "t" in turned else 1.0))
    n = model.n_bodies
    several = sum(1 for size in range(2, n) for _ in itertools.combinations(range(n), size))
    assert len(found) == 15 * n + 5 + 1 + 5 * several + 2 * (n + 1)


def test_angles_and_arguments(model, state):
    """Of turning joints; arguments that are ignored, or taken for one another."""
    limits = JointLimits(lower=-0.5, upper=0.25)
    limited = with_joint(model, 1, limits=limits)
    q, v, a = state
    turning = np.array([not joint.is_prismatic for joint in model.joints])
    for message, tau in torques(limited, angles, state).items():
        which = np.isin(np.arange(model.n_bodies), members(model, message)) & turning
        if "at its limits" in message:
            angle = np.where(np.arange(model.n_bodies) == 0, np.clip(q, -0.5, 0.25), q)
        else:
            angle = next(change(q) for words, change in ANGLES.items() if message.endswith(words))
        check(tau, inverse_dynamics(model, np.where(which, angle, q), v, a).tau)
    given = {"positions": q, "velocities": v, "accelerations": a}
    for message, tau in torques(model, arguments, state).items():
        taken = dict(given)
        if found := re.fullmatch("(.*) and (.*) are exchanged", message):
            first, second = found.groups()
            taken[first], taken[second] = given[second], given[first]
        elif found := re.fullmatch("the (.*) of joint '.*' is ignored", message):
            name = {"velocity": "velocities", "acceleration": "accelerations"}[found[1]]
            taken[name] = np.where(np.isin(np.arange(model.n_bodies), members(model, message)), 0.0, given[name])
        else:
            taken[re.fullmatch("the (.*) are ignored", message)[1]] = 0 * q
        check(tau, inverse_dynamics(model, *taken.values()).tau)


@pytest.mark.parametrize("n", [2, 6, 7])
def test_number_of_orders(n):
    """All of up to six joints; of more, exchanges of two, shifts, and the reverse and alphabetical order."""
    names = [f"j{(5 * k) % 8}" for k in range(n)]
    tree = random_tree(1, range(n), ["revolute"] * n)
    joints = [dataclasses.replace(joint, name=name) for joint, name in zip(tree.joints, names, strict=True)]
    descriptions = list(map(said, orders(dataclasses.replace(tree, joints=tuple(joints)))))
    listed = {one.message.split("in the order ")[1]: one.size for one in descriptions}
    known = {", ".join(names[k:] + names[:k]) for k in range(1, n)} | {", ".join(names[::-1]), ", ".join(sorted(names))}
    expected = set(map(", ".join, itertools.permutations(names)))
    if n > 6:
        pairs = itertools.combinations(range(n), 2)
        exchanged = [[{i: k, k: i}.get(place, place) for place in range(n)] for i, k in pairs]
        expected = known | {", ".join(names[k] for k in order) for order in exchanged}
    assert set(listed) == expected - {", ".join(names)}
    assert len(descriptions) == 3 * len(listed)
    assert {order for order in known if listed.get(order, 1) > 1} == set()
    if n == 6:
        others = {order: size for order, size in listed.items() if order not in known}
        assert sum(size == 1 for size in others.values()) == 15  # exchanges of two
        assert max(others.values()) == 5


def test_units(model, state):
    found = torques(model, units, state)
    for k, joint in enumerate(model.joints):
        for unit, per_meter in PER_METER.items():
            place = dataclasses.replace(joint.placement, translation=per_meter * joint.placement.translation)
            tau = inverse_dynamics(with_joint(model, k + 1, placement=place), *state).tau
            check(found[f"the placement of joint '{joint.name}' is in {unit}, the rest in meters"], tau)
        per_unit = PER_METER if joint.is_prismatic else {"degrees": 180 / np.pi}
        for unit, size in per_unit.items():
            scale = np.where(np.arange(model.n_bodies) == k, 1 / size, 1.0)
            q, v, a = state
            of = f"of joint '{joint.name}' are taken as {unit}"
            check(found[f"positions {of}"], inverse_dynamics(model, scale * q, v, a).tau)
            whole = inverse_dynamics(model, scale * q, scale * v, scale * a).tau
            check(found[f"positions, velocities and accelerations {of}"], whole)
    one = np.array([joint.is_prismatic for joint in model.joints]).argmin()
    slower = np.where(np.arange(model.n_bodies) == one, np.pi / 30, 1.0)
    name = model.joint_names[one]
    check(
        found[f"velocities of joint '{name}' are taken as rev/min"],
        inverse_dynamics(model, state[0], slower * state[1], state[2]).tau,
    )


ORDERS = ("xx yy zz xy xz yz", "xx yy zz xy yz xz", "xx yy zz yz xz xy", "xx xy yy xz yz zz")
"""MuJoCo's, SDF's and Voigt's, Pinocchio's."""


@pytest.mark.parametrize("order", ORDERS)
def test_tensors_in_other_orders(model, state, order):
    """Six numbers that one side writes in one order, and the other side reads in another."""
    found, names = torques(model, inertials, state), order.split()
    listed = ", ".join(f"I_{name}" for name in names)
    tensor = model.bodies[1].inertia
    number = {name: tensor["xyz".index(name[0]), "xyz".index(name[1])] for name in URDF_TENSOR}
    for words, written, read in (("is read", URDF_TENSOR, names), ("is written", names, URDF_TENSOR)):
        got = dict(zip(read, (number[name] for name in written), strict=True))
        xx, xy, xz, yy, yz, zz = (got[name] for name in URDF_TENSOR)
        wrong = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        expected = inverse_dynamics(with_body(model, 2, inertia=wrong), *state).tau
        of = f"the tensor of body '{model.body_names[1]}'"
        read, other = (f"{of} is {way} in the order {listed}" for way in ("read", "written"))
        check(found[read if words == "is read" or other not in found else other], expected)


def test_remedies_of_signs(model):
    remedies = {description.message: description.remedy for description in map(said, signs(model))}
    name = model.joint_names[0]
    assert remedies[f"the torque of joint '{name}' has the opposite sign"] == "negate it"
    assert remedies[f"the axis of joint '{name}' points the other way"].startswith("reverse the axis, or negate")


def named_number(text):
    """The number after the last word of a sentence that says one."""
    return float(re.search(r"(-?[\d.]+(?:e[+-]?\d+)?)(?:,| |;|$)", text)[1])


class Told:
    """What the words and numbers of a fault mean, done by hand to the robot, its states or its torques."""

    def __init__(self, model, state, x, description):
        self.model, self.state, self.x, self.description = model, state, x, description
        self.message = description.message
        self.numbers = {number.name: number for number in description.numbers}
        self.joint, self.body = (
            next((k for k, name in enumerate(names) if f"'{name}'" in self.message), None)
            for names in (model.joint_names, model.body_names)
        )

    def theirs(self, name, ours, unit):
        """The number of this name, which tells ours, too."""
        if name not in self.numbers:
            return ours
        number = self.numbers.pop(name)
        assert (number.ours, number.unit) == (pytest.approx(ours), unit)
        return number.theirs

    def tau(self, model=None, state=None):
        return inverse_dynamics(model or self.model, *(state or self.state)).tau

    def at_joint(self, value, otherwise):
        return np.where(np.arange(self.model.n_bodies) == self.joint, value, otherwise)

    def translation(self):
        placement = self.model.joints[self.joint].placement
        moved = [self.theirs(axis, own, "m") for axis, own in zip("xyz", placement.translation, strict=True)]
        assert self.message.endswith(", ".join(
            f"{axis} by {there - own:.6g} m"
            for axis, own, there in zip("xyz", placement.translation, moved, strict=True) if there != own
        ))  # fmt: skip
        placement = dataclasses.replace(placement, translation=np.array(moved))
        return self.tau(with_joint(self.model, self.joint + 1, placement=placement))

    def turn(self):
        """By Rodrigues' vector: of the tangent of half the angle."""
        angle = self.theirs("turned by", 0.0, "rad")
        assert np.tan(angle / 2) == pytest.approx(np.linalg.norm(self.x) / 2)
        axis = self.x / np.linalg.norm(self.x)
        assert f"by {angle:.6g} rad about ({', '.join(f'{x:.4g}' for x in axis)})" in self.message
        return Rotation.from_rotvec(angle * axis).as_matrix()

    def turned_placement(self):
        placement = self.model.joints[self.joint].placement
        placement = dataclasses.replace(placement, rotation=self.turn() @ placement.rotation)
        return self.tau(with_joint(self.model, self.joint + 1, placement=placement))

    def tilted_axis(self):
        axis = self.turn() @ self.model.joints[self.joint].axis
        return self.tau(with_joint(self.model, self.joint + 1, axis=axis))

    def zero(self):
        slides = self.model.joints[self.joint].is_prismatic
        off, (q, v, a) = self.theirs("zero", 0.0, "m" if slides else "rad"), self.state
        assert named_number(self.message) == pytest.approx(off, rel=1e-5)
        return self.tau(state=(q + self.at_joint(off, 0.0), v, a))

    def gear(self):
        return self.at_joint(named_number(self.message.split("multiplied by")[1]), 1.0) * self.tau()

    def scale(self):
        factor = named_number(self.message.split("multiplied by")[1])
        named = {"the position": "q", "the velocity": "v", "the acceleration": "a"}.get(
            self.message.split(" of ")[0], "qva"
        )
        scale = self.at_joint(factor, 1.0)
        return self.tau(state=[scale * x if name in named else x for name, x in zip("qva", self.state, strict=True)])

    def long_axis(self):
        """Displacements are those of the axis times its length; so is the power."""
        factor = named_number(self.message.split("multiplied by")[1])
        scale = np.full(self.model.n_bodies, factor) if self.joint is None else self.at_joint(factor, 1.0)
        return scale * self.tau(state=[scale * x for x in self.state])

    def coupled(self):
        names = self.model.joint_names
        first, second = (names.index(name) for name in re.findall(r"'([^']*)'", self.message))
        factor = named_number(self.message.split("by a factor")[1])
        moved = [x.copy() for x in self.state]
        for x in moved:
            x[:, first] += factor * x[:, second]
        tau = self.tau(state=moved)
        if not self.message.endswith("the torques do not"):  # the power of both is that of the two joints
            tau[:, second] += factor * tau[:, first]
        return tau

    def parameters(self):
        body = self.model.bodies[self.body]
        center = [self.theirs(f"c_{axis}", own, "m") for axis, own in zip("xyz", body.center_of_mass, strict=True)]
        tensor = np.empty((3, 3))
        for i, k in itertools.combinations_with_replacement(range(3), 2):
            own = body.inertia[i, k]
            tensor[i, k] = tensor[k, i] = self.theirs(f"I_{'xyz'[i]}{'xyz'[k]}", own, "kg m²")
        mass = self.theirs("m", body.mass, "kg")
        return self.tau(
            with_body(self.model, self.body + 1, mass=mass, center_of_mass=np.array(center), inertia=tensor)
        )

    def factor(self):
        factor, model = named_number(self.message.split("multiplied by")[1]), self.model
        for number in range(1, model.n_bodies + 1) if self.body is None else (self.body + 1,):
            body = model.bodies[number - 1]
            what = self.message.split(" of ")[0]
            field = {"the mass": "mass", "the center": "center_of_mass", "the tensor": "inertia"}[
                " ".join(what.split()[:2])
            ]
            model = with_body(model, number, **{field: factor * getattr(body, field)})
        return self.tau(model)

    def all_torques(self):
        return named_number(self.message.split("multiplied by")[1]) * self.tau()

    def gravity(self):
        turn = self.model.base.rotation
        ours = turn.T @ self.model.gravity
        found = [self.theirs(f"g_{axis}", own, "m/s²") for axis, own in zip("xyz", ours, strict=True)]
        assert self.message.startswith(f"gravity acts along ({', '.join(f'{x:.6g}' for x in found)})")
        return self.tau(self.model.with_gravity(turn @ found))

    def joint_term(self):
        """Added to right torques: d v, F sign(v), k q, an offset, J a; of the constant torque, what is no slack."""
        (q, v, a), names = self.state, self.model.joint_names
        laws = {"viscous friction": v, "dry friction": np.sign(v), "a spring": q, "a constant diagonal": a}
        units = {
            "viscous friction": "N m s/rad or N s/m",
            "a spring": "N m/rad or N/m",
            "a constant diagonal": "kg m² or kg",
        }
        added = np.zeros_like(q)
        for name, law in laws.items():
            for k, joint in enumerate(names):
                added[:, k] += self.theirs(f"{name}, {joint}", 0.0, units.get(name, "N m or N")) * law[:, k]
        return added

    def matrix(self):
        n = self.model.n_bodies
        matrix = np.zeros((n, n))
        for i, k in itertools.combinations_with_replacement(range(n), 2):
            matrix[i, k] = matrix[k, i] = self.theirs(f"M[{i + 1}, {k + 1}]", 0.0, "kg m², kg m or kg")
        return self.tau() + self.state[2] @ matrix


MEANINGS = {
    "the translation of joint": Told.translation, "the placement of joint": Told.turned_placement,
    "the axis of joint": Told.tilted_axis, "the zero of joint": Told.zero, "the torque of joint": Told.gear,
    "position, velocity": Told.scale, "the position of": Told.scale, "the velocity of": Told.scale,
    "the acceleration of": Told.scale, "joint ": Told.coupled, "all inertial parameters": Told.all_torques,
    "motion and torque of": Told.long_axis, "gravity acts": Told.gravity, "a constant matrix": Told.matrix,
}  # fmt: skip


@pytest.mark.parametrize("kinds", [geometry, parameters, gravity])
def test_families(model, state, kinds):
    """Of numbers that somebody's code may have, drawn here: the torques are those of what the words say."""
    rng, count = np.random.default_rng(8), 0
    for fault in kinds(model):
        x = np.round(fault.right + rng.uniform(0.1, 0.3, fault.right.shape), 4)  # sentences say six digits
        (description,) = fault.say(x)
        told = Told(model, state, x, description)
        if kinds is parameters and "all torques" not in description.message:
            meaning = Told.factor if "multiplied" in description.message else Told.parameters
        else:
            meaning = next(meaning for words, meaning in MEANINGS.items() if description.message.startswith(words))
        (tau,) = torques_of([fault.change(DynamicsCode.of(model), x)], state)
        expected = meaning(told)
        assert np.abs(tau - expected).max() <= FITTED * np.abs(expected).max(), description.message
        assert not told.numbers
        fitted = len(description.numbers)
        if kinds is not gravity and fitted:
            assert description.size == 1 + (3 if "turned by" in description.numbers[0].name else fitted)
        assert not [one for one in fault.say(fault.right) if kinds is not gravity]
        count += 1
    n = model.n_bodies
    assert count == {geometry: 10 * n + 1 + 2 * n * (n - 1), parameters: 13 * n + 4, gravity: 1}[kinds]


@pytest.mark.parametrize("quarters", [-3, -1, 1, 2, 4])
def test_zeros_that_are_right_angles(model, quarters):
    """Of turning joints; a slide has its zero in meters."""
    zeros = list(geometry(model))[3 : 9 * model.n_bodies : 9]
    for fault, joint in zip(zeros, model.joints, strict=True):
        (told,) = fault.say(np.array([quarters * np.pi / 2]))
        shown = f"{quarters * np.pi / 2:.6g} m" if joint.is_prismatic else f"{quarters} π/2 rad"
        assert told.message.startswith(f"the zero of joint '{joint.name}' is off by {shown}: ")


def test_changes_of_answers_and_arguments_in_their_order(model, state):
    """Answers one after the other; what is taken later is taken before."""
    code = DynamicsCode.of(model)
    answers = code.giving(lambda tau, _: tau + 1).giving(lambda tau, _: 2 * tau)
    arguments = code.taking(lambda q, v, a: (q, v + 1, a)).taking(lambda q, v, a: (q, 2 * v, a))
    q, v, a = state
    tau, taken = torques_of([answers, arguments], state)
    check(tau, 2 * (inverse_dynamics(model, *state).tau + 1))
    check(taken, inverse_dynamics(model, q, 2 * v + 1, a).tau)


def test_columns_outside_of_a_base_regressor(model, state):
    """The parameter and body of a column that no combination gives, and the number of one that is too many."""
    states = JudgedStates(model, *state, 0 * state[0], None, None)
    ours, more = np.random.default_rng(3).normal(size=(2, 12, 3, 10 * model.n_bodies))
    missing = np.delete(ours, 13, axis=-1)
    found = OWN_FAULTS["base_regressor"](np.concatenate([missing, more[..., :1]], axis=-1), ours, states, 1e-9)
    name = f"{PARAMETER_NAMES[3]} of body '{model.body_names[1]}'"
    assert f"no combination of its columns gives those of {name} (both of rank " in found.said.message
    assert f"gives columns {10 * model.n_bodies}; " in found.said.message


def test_torques_that_a_joint_adds(model, state):
    """Friction, springs, offsets and drives at once, and a constant matrix: what is added is what is said."""
    rng, n = np.random.default_rng(9), model.n_bodies
    each, matrix = joint_terms(model)
    x = rng.uniform(0.1, 0.3, (5, n))
    x[3] = 0.0
    (tau,) = torques_of([each.change(DynamicsCode.of(model), x.ravel())], state)
    v, added = state[1], 0.0
    for description in each.say(x.ravel()):
        added = added + Told(model, state, x, description).joint_term()
        if "viscous" in description.message:  # one sentence for both, and the numbers of the first
            assert (
                f"dry friction ({', '.join(f'{value:.4g}' for value in x[1])}) N m or N per joint"
                in description.message
            )
            added = added + x[1] * np.sign(v)
    np.testing.assert_allclose(tau - inverse_dynamics(model, *state).tau, added, atol=1e-12 * np.abs(tau).max())
    x = rng.uniform(0.1, 0.3, matrix.right.shape)
    (tau,) = torques_of([matrix.change(DynamicsCode.of(model), x)], state)
    (description,) = matrix.say(x)
    told = Told(model, state, x, description)
    check(tau, told.matrix())
    assert not told.numbers
    (offset,) = each.say(np.where(np.arange(5)[:, None] == 3, [0.5, 0.0, -2.0], 0.0).ravel())
    assert [(number.name, number.theirs) for number in offset.numbers] == [
        (f"a constant torque, {model.joint_names[k]}", value) for k, value in ((0, 0.5), (2, -2.0))
    ]
    slack = np.zeros((5, n))
    slack[2, 1], slack[3, 1] = 4.0, 2.0  # 4 (q + 0.5)
    (spring,) = each.say(slack.ravel())
    assert (
        spring.message == f"a spring of 4 N m/rad or N/m, slack at -0.5, at joint '{model.joint_names[1]}' is included"
    )
    assert spring.size == 3


@pytest.mark.parametrize(
    ("factor", "size"), [(0.0, 1), (-1.0, 1), (2.0, 1), (-2.0, 1), (10.0, 1), (-0.01, 1), (3.0, 2), (0.7, 2)]
)
def test_round_factors_are_one_step(model, factor, size):
    """Of a term, a gear, all torques: a number beside them has to be fitted."""
    assert is_round(factor) == (size == 1)
    families = {
        "term": next(itertools.islice(terms(model), 1, None)), "gear": list(geometry(model))[4],
        "torques": list(parameters(model))[-1],
    }  # fmt: skip
    for name, fault in families.items():
        if factor != -1 or name == "term":  # elsewhere a sign
            assert [one.size for one in fault.say(np.array([factor + 1e-9]))] == [size], name


class Noisy:
    """Inverse dynamics with white noise, its standard deviation a part of the largest torque."""

    name = "inverse_dynamics"
    known = SimpleNamespace(arguments_at=lambda states: states.state)

    def __init__(self, model, size):
        self.model, self.size, self.rng = model, size, np.random.default_rng(7)

    def __call__(self, *state):
        tau = inverse_dynamics(self.model, *state).tau
        return tau + self.size * np.abs(tau).max() * self.rng.normal(size=tau.shape)


@pytest.mark.parametrize("size", [1e-9, 1e-5])
def test_noise(model, state, size):
    """Of the noisiest of three torques, relative to the largest on a line."""
    found = noise(Noisy(model, size), SimpleNamespace(q=state[0], model=model, state=state))
    assert 0.5 * size < found < 5 * size


class Rewritten:
    """A URDF file that somebody wrote as another one reads it: the change that a sentence names, done to the text."""

    def __init__(self, text):
        self.robot = etree.fromstring(text.encode())

    def of(self, kind, name):
        return next(element for element in self.robot.iter(kind) if element.get("name") == name)

    def numbers(self, element, attribute):
        return np.array((element.get(attribute) or "0 0 0").split(), float)

    def put(self, element, attribute, values):
        element.set(attribute, " ".join(repr(float(x)) for x in values))

    def inertial_frame(self, message):
        links = re.findall(r"'([^']*)'", message) or [link.get("name") for link in self.robot.iter("link")]
        for origin in (origin for name in links for origin in self.of("link", name).iterfind("inertial/origin")):
            turn = Rotation.from_euler("xyz", self.numbers(origin, "rpy"))
            if "origin" in message or ("xyz of" in message and "ignored" in message):
                self.put(origin, "xyz", np.zeros(3))
            if "origin" in message or "rpy of" in message:
                self.put(origin, "rpy", np.zeros(3))
            if "transposed" in message:
                self.put(origin, "rpy", turn.inv().as_euler("xyz"))
            if "taken in the axes" in message:
                self.put(origin, "xyz", turn.apply(self.numbers(origin, "xyz")))

    def frame(self, message):
        """R = R_x(roll) R_y(pitch) R_z(yaw): about the axes that turn with it."""
        paths = ["link/inertial/origin"] if "inertial frames" in message else []
        for path in (*paths, *(["joint/origin"] if "joints" in message else [])):
            for origin in self.robot.iterfind(path):
                turn = Rotation.from_euler("XYZ", self.numbers(origin, "rpy"))
                self.put(origin, "rpy", turn.as_euler("xyz"))

    def massless_link(self, message):
        moment = "1" if "1 kg m²" in message else "0"
        for link in self.robot.iter("link"):
            if link.find("inertial") is None:
                link.append(etree.fromstring(inertial(1.0, "0 0 0", tensor=f"{moment} 0 0 {moment} 0 {moment}")))

    def fixed_link(self, message):
        names = re.findall(r"'([^']*)'", message)
        if "mass of" in message:
            for name in names:
                link = self.of("link", name)
                link.remove(link.find("inertial"))
        elif "sibling" in message:
            (joint,) = [one for one in self.robot.iter("joint") if one.find("child").get("link") == names[0]]
            joint.find("parent").set("link", names[1])
        else:
            origin = self.of("joint", names[0]).find("origin")
            for attribute, words in (("xyz", ("placement", "translation")), ("rpy", ("placement", "rotation"))):
                if message.split()[1] in words:
                    self.put(origin, attribute, np.zeros(3))

    def rounding(self, message):
        places = {
            "rpy angles": ("joint/origin", "rpy"),
            "placements": ("joint/origin", "xyz"),
            "masses": ("link/inertial/mass", "value"),
            "centers": ("link/inertial/origin", "xyz"),
            "tensors": ("link/inertial/inertia", "ixx ixy ixz iyy iyz izz"),
        }
        for words, (path, attributes) in places.items():
            if not (found := re.search(rf"the {words}[a-z ]* to (\d)", message)):
                continue
            for element in self.robot.iterfind(path):
                for attribute in (one for one in attributes.split() if element.get(one)):
                    self.put(element, attribute, np.round(self.numbers(element, attribute), int(found[1])))


def test_misread_files(small_arm_text, tmp_path, state):
    """Each code gives the torques of the arm of a file that was written as it reads this one."""
    last = "tool"
    tools = TOOLS.format(last=last).removesuffix("</robot>")
    text = re.sub(r'value="2.5"', 'value="2.512345678"', small_arm_text.replace("</robot>", tools + "</robot>"))
    (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    model = urdf.load(tmp_path / "arm.urdf")
    faults = list(file_reading(Misreadings(tmp_path / "arm.urdf")))
    codes = [fault.change(DynamicsCode.of(model), fault.right) for fault in faults]
    right, messages = inverse_dynamics(model, *state).tau, {kind: [] for kind in MISREAD}
    for fault, tau in zip(faults, torques_of(codes, state), strict=True):
        description = said(fault)
        messages[description.kind].append(description.message)
        written = Rewritten(text)
        getattr(written, description.kind)(description.message)
        misread = tmp_path / "misread.urdf"
        misread.write_bytes(etree.tostring(written.robot))
        expected = inverse_dynamics(urdf.load(misread), *state).tau
        assert np.abs(tau - expected).max() <= FITTED * np.abs(right).max(), description.message
    assert {kind: len(found) for kind, found in messages.items()} == MISREAD


MISREAD = {"inertial_frame": 23, "massless_link": 2, "frame": 3, "fixed_link": 7 + 3 * 3 + 1, "rounding": 12 + 10}
"""How many: of fixed links the sets of three with mass, three parts of three placements, and two siblings.
Of rounding one number and two."""


def test_no_law_of_friction_is_fitted_where_a_joint_at_rest_deviates(model, monkeypatch):
    """Both laws vanish there: whatever is fitted to the other states, it would not hold."""
    v = np.random.default_rng(0).normal(size=(12, 3))
    v[1, 0] = 0.0
    torque = 0.4 * v + 0.2 * np.tanh(v / 0.1)
    assert "tanh" in said(next(catalog.smooth_friction(model, v, torque, 1e-9))).message
    monkeypatch.setattr(catalog, "_fitted", lambda *_: pytest.fail("the search began"))
    torque[1, 0] = 1e-3
    assert list(catalog.smooth_friction(model, v, torque, 1e-9)) == []
