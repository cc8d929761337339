"""Every function of the table: a right one agrees, whatever convention it follows; a wrong one is found and named."""

import dataclasses
import re

import numpy as np
import pytest
from faults.pinocchio_code import PinocchioCode, own_functions
from faults.textbook_faults import WRIST_LOCKED
from long_check import few
from shared_data import REPOSITORY
from shown.approved import approve
from typer.testing import CliRunner

import crosscheck
import graphdyn
import urdf
from crosscheck.commands.application import app
from crosscheck.commands.judge.report import judge_report
from crosscheck.commands.program.judged_functions import function_list
from crosscheck.judging import judge as judging
from crosscheck.quantities import FUNCTIONS
from crosscheck.report.html import page as page_of
from crosscheck.report.records.record import versions
from crosscheck.report.snippets import worst_call
from crosscheck.report.text import as_text
from graphdyn import InvalidInput, UnknownFrame

SAMPLES = 20
FRAME = "wrist_3_link"
OF_FRAME = ("frame_jacobian", "frame_jacobian_derivative", "frame_velocity", "frame_acceleration")
ROUNDED = 1e-12
"""Right codes in double precision, on the scales of the functions: some hundred roundings."""


@pytest.fixture(scope="module")
def code():
    return PinocchioCode("ur5", FRAME)


def judged(robot="ur5", samples=SAMPLES, **options):
    return crosscheck.judge(robot, samples=samples, frame=FRAME, **options)


def named(name, f, **options):
    """Kind and message of the one diagnosis."""
    judgment = judged(**{name: f}, **options)
    assert not judgment.agrees
    assert judgment.decided
    (diagnosis,) = judgment.diagnoses
    return diagnosis.kind, diagnosis.message


class TestRightFunctions:
    def test_pinocchio_has_most(self, code):
        right = code.functions()
        assert set(right) | set(OF_FRAME) | set(own_functions(code.model)) == set(FUNCTIONS)
        judgment = judged(**right, joint_names=code.names)
        assert judgment.agrees, judgment.diagnoses
        for name, function in judgment.functions.items():
            assert function.errors["graphdyn"].max() <= ROUNDED, name

    def test_the_others(self, ur5):
        judgment = judged(**own_functions(ur5), samples=3, batched=True)
        assert judgment.agrees, judgment.diagnoses
        for name, function in judgment.functions.items():
            assert {"graphdyn", "pinocchio"} <= set(function.errors), name

    def test_a_frame_of_the_ground(self, ur5):
        """Pinocchio gives no motion of it."""
        still = {"frame_jacobian": lambda q: np.zeros((6, 6)), "frame_velocity": lambda q, v: np.zeros(6)}
        judgment = crosscheck.judge("ur5", **still, frame="base_link", samples=3)
        assert judgment.agrees
        assert judgment.references == ("graphdyn",)

    @pytest.mark.parametrize("reference", ["local", "world", "local_world_aligned"])
    def test_references_are_found_out(self, code, reference):
        judgment = judged(**code.of_frame(reference), joint_names=code.names)
        assert judgment.agrees
        for function in judgment.functions.values():
            assert function.conventions["reference"] == reference
            assert function.conventions["order"] == "linear first"
            assert function.errors["graphdyn"].max() <= ROUNDED

    @pytest.mark.parametrize("reference", ["local", "world", "local_world_aligned"])
    def test_classical_or_spatial_is_found_out(self, code, reference):
        classical, spatial = code.of_frame(reference)["frame_acceleration"], code.spatial_acceleration(reference)
        for f, way in ((classical, "classical"), (spatial, "spatial")):
            (function,) = judged(frame_acceleration=f, joint_names=code.names).functions.values()
            assert function.agrees
            assert (function.conventions["acceleration"], function.conventions["reference"]) == (way, reference)

    @pytest.mark.parametrize("name", ["frame_jacobian", "frame_velocity"])
    def test_the_order_is_found_out(self, code, name):
        f = code.of_frame("world")[name]
        (function,) = judged(**{name: lambda *state: np.roll(f(*state), 3, axis=0)}).functions.values()
        assert function.agrees
        assert dict(function.conventions) == {"reference": "world", "order": "angular first"}
        assert function.code is None

    @pytest.mark.parametrize("sign", [1, -1])
    @pytest.mark.parametrize("axes", ["link", "world"])
    def test_conventions_of_wrenches(self, ur5, axes, sign):
        def wrenches(q, v, a):
            found = sign * graphdyn.inverse_dynamics(ur5, q, v, a).joint_wrenches
            turned = np.einsum("iab,ihb->iha", graphdyn.maximal_state(ur5, q).rotation, found.reshape(-1, 2, 3))
            return turned.reshape(-1, 6) if axes == "world" else found

        (function,) = judged(joint_wrenches=wrenches).functions.values()
        assert function.agrees
        assert function.conventions["axes"] == axes
        assert function.conventions["acts on"] == ("the outside body" if sign == 1 else "the inside body")
        assert function.conventions["actuator"] == "included"

    def test_constraint_wrenches_without_the_actuator(self, ur5):
        def constraint(q, v, a):
            found = np.array(graphdyn.inverse_dynamics(ur5, q, v, a).joint_wrenches)
            for row, joint in zip(found, ur5.joints, strict=True):
                row[3:] -= (row[3:] @ joint.axis) * joint.axis
            return found

        (function,) = judged(joint_wrenches=constraint).functions.values()
        assert function.agrees
        assert function.conventions["actuator"] == "left out"

    def test_momentum_about_either_point(self, ur5):
        about_origin = judged(momentum=lambda q, v: graphdyn.momentum(ur5, q, v).about_origin).functions["momentum"]
        assert about_origin.agrees
        assert about_origin.conventions["about"] == "the world's origin"

    def test_potential_energy_up_to_a_constant(self, ur5):
        (function,) = judged(potential_energy=lambda q: graphdyn.potential_energy(ur5, q) + 7.5).functions.values()
        assert function.agrees
        assert function.conventions == {"zero": "elsewhere"}

    def test_another_coriolis_matrix_is_no_fault(self, ur5):
        """C + P S P, S skew and P the projection off v: the same C v, the same C + Cᵀ."""

        def another(q, v):
            off = np.eye(6) - np.outer(v, v) / (v @ v or 1.0)
            skew = np.triu(np.outer(np.cos(q), np.arange(6)), 1)
            return graphdyn.coriolis_matrix(ur5, q, v) + off @ (skew - skew.T) @ off

        (function,) = judged(coriolis_matrix=another).functions.values()
        assert function.agrees
        assert function.conventions == {"matrix": "another with the same C v and Ṁ - 2C skew"}

    def test_a_full_regressor_is_a_base_regressor_too(self, ur5):
        order = np.random.default_rng(0).permutation(60)
        regressor = lambda q, v, a: graphdyn.joint_torque_regressor(ur5, q, v, a)[:, order]  # noqa: E731
        assert judged(base_regressor=regressor).agrees

    @pytest.mark.usefixtures("undiagnosed")
    def test_another_joint_order(self, ur5):
        order = np.array([3, 0, 5, 1, 4, 2])
        back = np.argsort(order)
        given = {
            "frame_jacobian": lambda q: graphdyn.frame_jacobian(ur5, q[back], FRAME, reference="local")[:, order],
            "joint_wrenches": lambda q, v, a: graphdyn.inverse_dynamics(ur5, q[back], v[back], a[back]).joint_wrenches[
                order
            ],
            "static_torque": lambda q, f: graphdyn.static_torque(ur5, q[back], f[back])[order],
            "momentum_regressor": lambda q, v: (
                graphdyn.momentum_regressor(ur5, q[back], v[back])
                .reshape(6, 6, 10)[np.ix_(order, order)]
                .reshape(6, 60)
            ),
        }
        names = [ur5.joint_names[k] for k in order]
        assert judged(**given, joint_names=names).agrees
        assert not judged(static_torque=given["static_torque"], samples=3).agrees


def scaled_joint(model, k, factor):
    return np.where(np.arange(model.n_bodies) == k, factor, 1.0)


@pytest.fixture(scope="module")
def three_joints():
    return urdf.load("ur5", lock=WRIST_LOCKED)


FAULTS = {
    "bias_torque, no gravity": (
        "bias_torque", lambda m: lambda q, v: graphdyn.bias_torque(m.with_gravity(np.zeros(3)), q, v),
        "gravity", "gravity is left out",
    ),
    "gravity_torque, sign": (
        "gravity_torque", lambda m: lambda q: -graphdyn.gravity_torque(m, q),
        "gravity", "gravity has the opposite sign",
    ),
    "coriolis_matrix, not skew": (
        "coriolis_matrix",
        lambda m: lambda q, v: outer_along(graphdyn.coriolis_matrix(m, q, v), v),
        "not_skew", "C v is right, but C + Cᵀ is not Ṁ: Ṁ - 2C is not skew",
    ),
    "mass_matrix_inverse, M": (
        "mass_matrix_inverse", lambda m: lambda q: graphdyn.mass_matrix(m, q),
        "other_function", "the answers are those of mass_matrix",
    ),
    "mass_matrix_inverse, upper triangle": (
        "mass_matrix_inverse", lambda m: lambda q: np.triu(graphdyn.mass_matrix_inverse(m, q)),
        "triangle", "only the upper triangle of the matrix is filled in",
    ),
    "frame_placement, rotation": (
        "frame_placement",
        lambda m: lambda q: homogeneous(graphdyn.frame_placement(m, q, FRAME), np.linalg.matrix_transpose),
        "frame", "the rotation is transposed",
    ),
    "frame_placement, inverse": (
        "frame_placement", lambda m: lambda q: np.linalg.inv(homogeneous(graphdyn.frame_placement(m, q, FRAME))),
        "frame", "the placement is inverted: the world seen from the frame",
    ),
    "frame_placement, degrees": (
        "frame_placement", lambda m: lambda q: homogeneous(graphdyn.frame_placement(m, np.deg2rad(q), FRAME)),
        "unit", "q is taken as degrees",
    ),
    "frame_jacobian, column by column": (
        "frame_jacobian",
        lambda m: lambda q: column_by_column(graphdyn.frame_jacobian(m, q, FRAME, reference="local")),
        "transposed", "the numbers of the matrix are stored column by column",
    ),
    "frame_jacobian, one axis": (
        "frame_jacobian",
        lambda m: lambda q: graphdyn.frame_jacobian(m, q, FRAME, reference="local") * scaled_joint(m, 2, -1.0),
        "slip", "the joint axis in world axes at joint 'elbow_joint' has the opposite sign",
    ),
    "frame_velocity, linear part": (
        "frame_velocity",
        lambda m: lambda q, v: graphdyn.frame_velocity(m, q, v, FRAME, reference="world") * np.repeat([-1, 1], 3),
        "sign", "the linear part has the opposite sign",
    ),
    "frame_velocity, another frame": (
        "frame_velocity", lambda m: lambda q, v: graphdyn.frame_velocity(m, q, v, "wrist_2_link", reference="local"),
        "frame", "the answers are those of frame 'wrist_2_link'",
    ),
    "frame_velocity, millimeters": (
        "frame_velocity",
        lambda m: lambda q, v: graphdyn.frame_velocity(m, q, v, FRAME, reference="local") * np.repeat([1000, 1], 3),
        "unit", "the linear part is multiplied by 1000",
    ),
    "frame_acceleration, a ignored": (
        "frame_acceleration",
        lambda m: lambda q, v, a: graphdyn.frame_acceleration(m, q, v, 0 * a, FRAME, reference="world"),
        "argument", "a is ignored",
    ),
    "frame_acceleration, exchanged": (
        "frame_acceleration",
        lambda m: lambda q, v, a: graphdyn.frame_acceleration(m, q, a, v, FRAME, reference="world"),
        "argument", "v and a are exchanged",
    ),
    "kinetic_energy, without ½": (
        "kinetic_energy", lambda m: lambda q, v: 2 * graphdyn.kinetic_energy(m, q, v),
        "inertial_parameters", "all inertial parameters of every body, or all torques, multiplied by 2",
    ),
    "potential_energy, sign": (
        "potential_energy", lambda m: lambda q: -graphdyn.potential_energy(m, q),
        "sign", "all answers have the opposite sign",
    ),
    "momentum, sign of the angular part": (
        "momentum",
        lambda m: lambda q, v: graphdyn.momentum(m, q, v).about_center_of_mass * np.repeat([1, -1], 3),
        "sign", "the angular part has the opposite sign",
    ),
    "center_of_mass, axis": (
        "center_of_mass", lambda m: lambda q: graphdyn.center_of_mass(m, q * scaled_joint(m, 1, -1.0)),
        "sign", "the axis of joint 'shoulder_lift_joint' points the other way",
    ),
    "dtau_dq, transposed": (
        "dtau_dq",
        lambda m: lambda q, v, a: np.swapaxes(graphdyn.inverse_dynamics_derivatives(m, q, v, a).dtau_dq, 1, 2),
        "transposed", "the matrix is transposed",
    ),
    "da_dv, sign": (
        "da_dv", lambda m: lambda q, v, tau: -graphdyn.forward_dynamics_derivatives(m, q, v, tau).da_dv,
        "sign", "all answers have the opposite sign",
    ),
    "power, no velocity": (
        "power", lambda m: lambda q, v, a: graphdyn.inverse_dynamics(m, q, v, a).tau,
        "other_function", "the answers are those of inverse_dynamics",
    ),
    "base_regressor, friction": (
        "base_regressor",
        lambda m: lambda q, v, a: np.concatenate(
            [graphdyn.joint_torque_regressor(m, q, v, a), v[..., None] * np.eye(3)], axis=-1
        ),
        "column_space",
        "no combination of the columns of inertial parameters gives columns 31, 32, 33 (rank 18, not 15)",
    ),
}  # fmt: skip
"""Function, the faulty one of all states at once, kind and message of the diagnosis."""


def homogeneous(placement, change=np.asarray):
    rotation, position = placement
    found = np.zeros((*position.shape[:-1], 4, 4))
    found[..., :3, :3], found[..., :3, 3], found[..., 3, 3] = change(rotation), position, 1.0
    return found


def outer_along(matrix, v):
    """(matrix v) vᵀ / v²: what is applied to v is the same."""
    size = (v * v).sum(axis=-1)[..., None, None]
    return (matrix @ v[..., None]) * v[..., None, :] / np.where(size > 0, size, 1.0)


def column_by_column(matrix):
    return np.linalg.matrix_transpose(matrix).reshape(matrix.shape)


@pytest.mark.parametrize("fault", few(FAULTS, *(set(FAULTS) - {"mass_matrix_inverse, M"})))
def test_faults_are_named(three_joints, fault):
    name, faulty, kind, message = FAULTS[fault]
    judgment = judged(**{name: faulty(three_joints)}, lock=WRIST_LOCKED, batched=True)
    (diagnosis,) = judgment.diagnoses
    assert (diagnosis.kind, diagnosis.message) == (kind, message)
    assert judgment.decided
    assert not judgment.agrees
    approve(f"judged/{fault}", as_text(judge_report(judgment)))


def test_a_base_regressor_that_lacks_a_parameter(code):
    kind, message = named("base_regressor", code.base_regressor(left_out=1))
    assert kind == "column_space"
    assert re.match(
        r"no combination of its columns gives those of I_zz of body 'shoulder_link', .* and \d+ more", message
    )
    assert message.endswith("(rank 35, not 36)")


class TestDeclaredConventions:
    def test_what_is_followed(self, ur5):
        f = lambda q: graphdyn.frame_jacobian(ur5, q, FRAME, reference="local")  # noqa: E731
        assert judged(frame_jacobian=f, conventions={"reference": "local"}).agrees
        assert named("frame_jacobian", f, conventions={"reference": "world"}) == (
            "convention", "the answers follow another convention: reference is 'local', not 'world'",
        )  # fmt: skip

    def test_spatial_for_classical(self, ur5):
        f = lambda q, v, a: graphdyn.frame_acceleration(  # noqa: E731
            ur5, q, v, a, FRAME, reference="world", classical=False
        )
        assert named("frame_acceleration", f, conventions={"acceleration": "classical"}) == (
            "convention", "the answers follow another convention: acceleration is 'spatial', not 'classical'",
        )  # fmt: skip

    def test_refused(self, ur5):
        f = lambda q: graphdyn.mass_matrix(ur5, q)  # noqa: E731
        with pytest.raises(InvalidInput, match="convention 'reference' belongs to none of the functions"):
            judged(mass_matrix=f, conventions={"reference": "world"})
        with pytest.raises(InvalidInput, match="convention 'reference' is 'globe'; give one of 'local_world_al"):
            judged(frame_jacobian=f, conventions={"reference": "globe"})


class TestExternalWrenches:
    def test_right(self, ur5):
        judgment = judged(
            inverse_dynamics=lambda q, v, a, f: graphdyn.inverse_dynamics(ur5, q, v, a, f).tau,
            forward_dynamics=lambda q, v, tau, f: graphdyn.forward_dynamics(ur5, q, v, tau, f).a,
            joint_wrenches=lambda q, v, a, f: graphdyn.inverse_dynamics(ur5, q, v, a, f).joint_wrenches,
            mass_matrix=lambda q: graphdyn.mass_matrix(ur5, q),
            external_wrenches=True,
        )
        assert judgment.agrees
        assert set(judgment.functions["inverse_dynamics"].worst.arguments) == {"q", "v", "a", "external_wrenches"}
        assert "mujoco" not in judgment.functions["inverse_dynamics"].errors

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda m, q, f: -f, "the external wrenches have the opposite sign"),
            (lambda m, q, f: 0 * f, "the external wrenches are left out"),
            (lambda m, q, f: np.roll(f, 3, axis=-1), "the external wrenches are taken as moment, then force"),
            (
                lambda m, q, f: np.einsum(
                    "...iba,...ihb->...iha", graphdyn.maximal_state(m, q).rotation, f.reshape(*f.shape[:-1], 2, 3)
                ).reshape(f.shape),
                "the external wrenches are taken in world axes",
            ),
        ],
    )  # fmt: skip
    def test_wrong(self, three_joints, change, message):
        arm = three_joints
        faulty = lambda q, v, a, f: graphdyn.inverse_dynamics(arm, q, v, a, change(arm, q, f)).tau  # noqa: E731
        assert named(
            "inverse_dynamics", faulty, external_wrenches=True, lock=WRIST_LOCKED, batched=True, samples=5
        ) == (
            "external_wrenches",
            message,
        )


class TestOptions:
    def test_batched(self, ur5):
        """All states at once; graphdyn's own verbs take them so."""
        judgment = judged(
            inverse_dynamics=lambda q, v, a: graphdyn.inverse_dynamics(ur5, q, v, a).tau,
            frame_jacobian=lambda q: graphdyn.frame_jacobian(ur5, q, FRAME, reference="world"),
            batched=True,
        )
        assert judgment.agrees
        with pytest.raises(
            crosscheck.judging.observing.function_under_test.FunctionFailure,
            match="called with all states at once, arr",
        ):
            judged(mass_matrix=lambda q: graphdyn.mass_matrix(ur5, q[0]), batched=True)

    @pytest.mark.usefixtures("undiagnosed")
    def test_a_batch_whose_rows_are_mixed_up(self, three_joints):
        mixed_up = lambda q, v, a: graphdyn.inverse_dynamics(three_joints, q, v, a).tau[::-1]  # noqa: E731
        judgment = judged(inverse_dynamics=mixed_up, batched=True, samples=1, lock=WRIST_LOCKED)
        assert not judgment.agrees

    def test_chain_and_gravity(self):
        moon = (0, 0, -1.62)
        options = {"chain": ("base_link", "forearm_link"), "gravity": moon}
        with pytest.warns(urdf.ChainWarning):
            arm = urdf.load("ur5_gripper", **options)
        tested = lambda q, v, a: graphdyn.inverse_dynamics(arm, q, v, a).tau  # noqa: E731
        with pytest.warns(urdf.ChainWarning):
            judgment = crosscheck.judge("ur5_gripper", inverse_dynamics=tested, **options, samples=3)
        assert judgment.agrees
        assert judgment.chain == ("base_link", "forearm_link")

    def test_couplings_are_left_out(self, ur5):
        coupled = dataclasses.replace(ur5, couplings=(graphdyn.Coupling("elbow_joint", {"shoulder_lift_joint": 0.5}),))
        judgment = judged(coupled, mass_matrix=lambda q: graphdyn.mass_matrix(ur5, q), samples=3)
        assert judgment.agrees
        assert judgment.notes == ("joints that others drive are judged as if they were independent",)

    def test_frame_is_needed(self, ur5):
        f = lambda q: np.eye(4)  # noqa: E731
        with pytest.raises(InvalidInput, match="frame_placement belong to one frame of the robot: give frame="):
            crosscheck.judge("ur5", frame_placement=f)
        with pytest.raises(UnknownFrame):
            crosscheck.judge("ur5", frame_placement=f, frame="no_such_link")

    def test_unknown_function(self):
        with pytest.raises(TypeError, match=r"judge\(\) has no option 'coriolis'; did you mean 'coriolis_matrix'\?"):
            crosscheck.judge("ur5", coriolis=lambda q, v: q)

    def test_the_help_lists_every_function_with_its_arguments(self):
        lines = re.findall(r"^  (\S.*?)  +(\S.*)((?:\n {10,}.*)*)", function_list(), re.MULTILINE)
        listed = {name: arguments for arguments, first, rest in lines for name in (first + rest).split()}
        assert listed == {name: ", ".join(known.arguments) for name, known in FUNCTIONS.items()}
        shown = CliRunner().invoke(app, ["judge", "--help"]).output
        assert all(f"\n  {line}" in shown for line in function_list().splitlines()[1:])  # not run together


def test_the_guide_lists_every_function():
    """Name and arguments of each row of the table in docs/judge.md."""
    guide = (REPOSITORY / "docs" / "judge.md").read_text(encoding="utf-8")
    table = guide.split("| argument of `judge` |")[1].split("\n\n")[0]
    rows = [line.split("|")[1:3] for line in table.splitlines() if line.startswith("| `")]
    listed = {name: arguments.strip() for names, arguments in rows for name in re.findall(r"`(\w+)`", names)}
    assert listed == {name: ", ".join(known.arguments) for name, known in FUNCTIONS.items()}


class TestReport:
    @pytest.fixture(scope="class")
    @classmethod
    def judgment(cls, code):
        """All functions, each off by a part in a thousand of its own answer; those of frames by the reference local."""
        right = {**code.functions(), **code.of_frame("local")}, own_functions(code.model)
        one_by_one, at_once = (
            {name: lambda *state, f=f: 1.001 * np.asarray(f(*state)) for name, f in functions.items()}
            for functions in right
        )
        one_by_one.pop("base_regressor", None)  # every multiple of it is right
        at_once.pop("base_regressor", None)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(judging, "diagnoses_of", lambda *_: [])  # not what this is about
            found = judged(**one_by_one, joint_names=code.names, samples=1)
            others = judged(**at_once, joint_names=code.names, samples=1, batched=True)
            return dataclasses.replace(found, functions={**found.functions, **others.functions})

    def test_code_reproduces_what_was_expected(self, judgment, capsys):
        """The Python that the page shows, run as it stands."""
        for name, function in judgment.functions.items():
            names = {}
            exec(worst_call(judgment, function), names)
            assert np.allclose(names["expected"], function.worst.expected, rtol=0, atol=1e-9), name
        assert capsys.readouterr().out
        without = {name for name, function in judgment.functions.items() if function.code is None}
        assert without == {"potential_energy"}  # nearest to the wrong one with another zero: the numbers are shown

    def test_page_and_terminal(self, judgment):
        """A number, a matrix of twists, regressors of bodies and of the whole robot."""
        chosen = ("kinetic_energy", "frame_jacobian", "body_regressor", "potential_energy_regressor")
        few = dataclasses.replace(judgment, functions={name: judgment.functions[name] for name in chosen})
        report = judge_report(few)
        assert "kinetic_energy" in as_text(report, 100)
        page = page_of(report, ["graphdyn", "judge"], versions())
        for name in chosen:
            assert f'id="{name}"' in page
        assert "Largest differences of 36 entries" in page
        assert "Conventions that the answers follow" not in page

    def test_conventions_are_shown(self, code):
        report = judge_report(judged(frame_velocity=code.of_frame("local")["frame_velocity"], samples=1))
        for shown in (as_text(report, 100), page_of(report, ["graphdyn", "judge"], versions())):
            assert "Conventions that the answers follow" in shown
            assert "reference: local, order: linear first" in shown
