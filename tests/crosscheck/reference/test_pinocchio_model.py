"""PinocchioModel: the reference speaks graphdyn's order, angles and axes, and says why it refuses."""

import math

import numpy as np
import pytest
from long_check import LONG
from planting import SAMPLES, compared, flagged, mixed_tree
from urdf_text import joint, link, robot_text

import crosscheck
import urdf
from crosscheck.comparing import compare as comparing
from crosscheck.reference.pinocchio_model import PinocchioModel, PinocchioRefuses
from graphdyn import InvalidInput, Placement, RobotModel, frame_placement, inverse_dynamics, kr500
from graphdyn.layout import BODY_PARAMETERS
from graphdyn.model.spatial import rotation_about

SMALL = 1e-13
"""Two recursions of some ten products each, relative to the largest term: tolerances.AGREEMENT."""


def state_of(model, size=3):
    rng = np.random.default_rng(2)
    q, v = model.random_state(rng, size)
    return q, v, rng.normal(size=q.shape)


def assert_same_torques(pinocchio, model):
    q, v, a = state_of(model)
    ours = inverse_dynamics(model, q, v, a)
    assert np.abs(pinocchio.rnea(q, v, a) - ours.tau).max() <= SMALL * np.abs(ours.joint_wrenches).max()


def test_kinds_for_axes():
    """As Pinocchio reads them from a file: of axes x, y and z, not of others; with the same torques."""
    kinds = [("continuous", "1 0 0"), ("prismatic", "0 1 0"), ("continuous", "0 0 -1"), ("prismatic", "0 0.6 0.8")]
    kinds += [("continuous", "0 0 1")]
    more = '<axis xyz="{}"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    joints = [joint(f"j{k}", f"l{k}", f"l{k + 1}", kind, more.format(axis)) for k, (kind, axis) in enumerate(kinds)]
    model = urdf.load(robot_text("kinds", *(link(f"l{k}") for k in range(6)), *joints))
    model = model.with_gravity(np.array([1.0, 2.0, 3.0]))
    pinocchio = PinocchioModel.from_model(model)
    fast, (q, v, a) = pinocchio.bare_calls(), state_of(model)
    assert [one.shortname().removeprefix("JointModel") for one in fast.model.joints][1:] == [
        "RX", "PY", "RevoluteUnaligned", "PrismaticUnaligned", "RZ"
    ]  # fmt: skip
    tau = [fast.rnea(fast.model, fast.data, *state) for state in zip(q, v, a, strict=True)]
    assert np.abs(tau - pinocchio.rnea(q, v, a)).max() <= SMALL * np.abs(tau).max()


class TestOrderAndAngles:
    def test_siblings_are_matched_by_name(self, small_arm):
        """The file lists y_elbow before a_slide; Pinocchio sorts siblings the other way round."""
        model = urdf.load(small_arm)
        assert model.joint_names == ("z_shoulder", "y_elbow", "a_slide")
        pinocchio = PinocchioModel.from_urdf(small_arm, model)
        there = pinocchio.configuration(np.array([0.0, 0.2, 0.3]))
        assert there.tolist() == [1.0, 0.0, 0.3, 0.2]  # (cos, sin) of the shoulder, a_slide, y_elbow
        assert_same_torques(pinocchio, model)

    def test_an_order_that_is_no_exchange(self, tmp_path):
        """Three siblings that Pinocchio turns round: each of its answers has to be brought back, and none twice."""
        links = [link(name, 1.0 + k, xyz="0.1 0.2 0.3", tensor="0.2 0 0 0.3 0 0.2") for k, name in enumerate("cab")]
        joints = [
            joint(f"{name}_joint", "base", name, "revolute", f'<origin xyz="0 {k} 0"/><axis xyz="{axis}"/>'
                  '<limit lower="-3" upper="3" effort="9" velocity="9"/>')
            for k, (name, axis) in enumerate(zip("cab", ("1 0 0", "0.6 0.8 0", "0 1 0"), strict=True))
        ]  # fmt: skip
        path = tmp_path / "siblings.urdf"
        path.write_text(robot_text("siblings", link("base", None), *links, *joints), encoding="utf-8")
        pinocchio = PinocchioModel.from_urdf(path, urdf.load(path))
        assert pinocchio.columns.tolist() == [2, 0, 1]
        assert pinocchio.torques(pinocchio.there(np.array([7.0, 8.0, 9.0]))).tolist() == [7.0, 8.0, 9.0]
        assert flagged(crosscheck.compare(path, SAMPLES)) == set()

    def test_order_of_the_regressor(self, small_arm):
        """W π = τ with our parameters in our order, joint by joint."""
        model = urdf.load(small_arm)
        q, v, a = state_of(model)
        w = PinocchioModel.from_urdf(small_arm, model).torque_regressor(q, v, a)
        assert w.shape == (*q.shape, BODY_PARAMETERS * model.n_bodies)
        ours = inverse_dynamics(model, q, v, a)
        assert np.abs(w @ model.inertial_parameters - ours.tau).max() <= SMALL * np.abs(ours.joint_wrenches).max()

    def test_continuous_joints_of_a_file_are_cosine_and_sine(self, small_arm):
        model = urdf.load(small_arm)
        pinocchio = PinocchioModel.from_urdf(small_arm, model)
        there = pinocchio.configuration(np.array([0.7, 0.0, 0.0]))
        assert there[:2].tolist() == [math.cos(0.7), math.sin(0.7)]

    def test_continuous_joints_of_a_model_are_angles(self):
        model = kr500()
        assert {joint.kind for joint in model.joints} == {"continuous"}
        q = np.arange(1.0, 7.0)
        assert PinocchioModel.from_model(model).configuration(q).tolist() == q.tolist()

    def test_bodies_not_numbered_depth_first(self):
        """Pinocchio's algorithms need depth-first numbers; graphdyn does not."""
        tree = mixed_tree()
        chain, branch = tree.joints[1], tree.joints[2]
        names = ("first", "second", "on the first")
        inside = (0, 0, 1)
        joints = [
            type(chain)(name, joint.kind, i, joint.placement, joint.axis)
            for name, i, joint in zip(names, inside, (tree.joints[0], chain, branch), strict=True)
        ]
        model = RobotModel("forest", tree.bodies, tuple(joints))
        pinocchio = PinocchioModel.from_model(model)
        assert pinocchio.configuration(np.array([1.0, 2.0, 3.0])).tolist() == [1.0, 3.0, 2.0]
        assert_same_torques(pinocchio, model)
        assert compared(model).agrees


class TestLock:
    @pytest.mark.parametrize(
        "lock",
        [
            {"y_elbow": -0.4},
            pytest.param({"z_shoulder": 0.8}, marks=LONG),
            pytest.param({"a_slide": 0.25}, marks=LONG),
        ],
    )
    def test_both_routes_hold_the_joint_at_its_value(self, small_arm, lock):
        comparison = crosscheck.compare(small_arm, SAMPLES, lock=lock)
        assert comparison.agrees
        assert comparison.routes == ("urdf", "model")
        assert comparison.locked == lock
        assert comparison.n_bodies == 2

    def test_two_joints(self, small_arm):
        comparison = crosscheck.compare(small_arm, SAMPLES, lock={"a_slide": 0.1, "z_shoulder": -2.0})
        assert comparison.agrees
        assert comparison.n_bodies == 1

    def test_another_value_is_another_robot(self, small_arm):
        """Otherwise agreement would prove nothing: the value reaches Pinocchio."""
        model = urdf.load(small_arm, lock={"y_elbow": 0.3})
        assert_same_torques(PinocchioModel.from_urdf(small_arm, model, urdf.Reading(lock={"y_elbow": 0.3})), model)
        q, v, a = state_of(model)
        elsewhere = PinocchioModel.from_urdf(small_arm, model, urdf.Reading(lock={"y_elbow": 0.4})).rnea(q, v, a)
        assert np.abs(elsewhere - inverse_dynamics(model, q, v, a).tau).max() > 1e-3


class TestGravity:
    @pytest.mark.parametrize("gravity", [pytest.param((0.0, 0.0, 0.0), marks=LONG), (1.0, -2.0, 3.0)])
    def test_both_routes_take_it(self, small_arm, gravity):
        comparison = crosscheck.compare(small_arm, SAMPLES, gravity=gravity)
        assert comparison.agrees
        assert comparison.routes == ("urdf", "model")

    def test_weightless_at_rest(self, small_arm):
        model = urdf.load(small_arm, gravity=(0.0, 0.0, 0.0))
        rest = np.zeros((1, 3))
        for pinocchio in (PinocchioModel.from_urdf(small_arm, model), PinocchioModel.from_model(model)):
            assert not pinocchio.rnea(rest, rest, rest).any()

    def test_the_models_gravity_not_pinocchios(self):
        """9.80665 for KR500, where Pinocchio would take 9.81: the force of the ground is the weight."""
        model, rest = kr500(), np.zeros((1, 6))
        _, wrenches = PinocchioModel.from_model(model).inverse_dynamics(rest, rest, rest)
        weight = sum(body.mass for body in model.bodies) * 9.80665
        assert np.linalg.norm(wrenches[0, 0, :3]) == pytest.approx(weight, rel=SMALL)


class TestFrames:
    def test_fused_link(self, small_arm):
        model = urdf.load(small_arm)
        q, _, _ = state_of(model)
        rotations, positions = PinocchioModel.from_urdf(small_arm, model).frame_placements(q, ["tool"])
        rotation, position = frame_placement(model, q, "tool")
        assert np.abs(rotations[:, 0] - rotation).max() <= SMALL
        assert np.abs(positions[:, 0] - position).max() <= SMALL * np.abs(position).max()

    def test_moves_with_the_base(self, small_arm):
        """Frames on the ground and on the bodies turn with it, once."""
        model = urdf.load(small_arm)
        base = Placement(rotation_about(np.array([0.6, 0.0, 0.8]), 0.9), np.array([0.1, -0.2, 0.3]))
        q, _, _ = state_of(model)
        here = PinocchioModel.from_urdf(small_arm, model)
        names = ["base", "upper", "tool"]
        rotations, positions = here.frame_placements(q, names)
        turned, moved = here.turned(base, model.gravity).frame_placements(q, names)
        assert np.abs(turned - base.rotation @ rotations).max() <= SMALL
        assert np.abs(moved - (positions @ base.rotation.T + base.translation)).max() <= SMALL

    def test_unknown(self, small_arm):
        model = urdf.load(small_arm)
        with pytest.raises(PinocchioRefuses, match="no link 'flange_9'"):
            PinocchioModel.from_urdf(small_arm, model).frame_placements(np.zeros((1, 3)), ["flange_9"])


class TestRefusals:
    def test_unreadable_file(self, tmp_path):
        path = tmp_path / "broken.urdf"
        path.write_text("<robot", encoding="utf-8")
        with pytest.raises(PinocchioRefuses, match=r"Pinocchio cannot read .*broken\.urdf: \S"):
            PinocchioModel.from_urdf(path, kr500())

    def test_other_joints(self, small_arm):
        with pytest.raises(PinocchioRefuses) as caught:
            PinocchioModel.from_urdf(small_arm, kr500())
        message = str(caught.value)
        assert "robot 'kr500': Pinocchio has other joints" in message
        assert f"only here: {sorted(kr500().joint_names)}" in message
        assert "only there: ['a_slide', 'y_elbow', 'z_shoulder']" in message

    def test_a_refusal_leaves_the_other_route(self, small_arm):
        """Pinocchio refuses an effort of -1; graphdyn does not use effort limits."""
        small_arm.write_text(small_arm.read_text().replace('effort="30"', 'effort="-1"'))
        comparison = compared(small_arm)
        assert comparison.agrees
        assert comparison.routes == ("model",)
        (note,) = comparison.notes
        assert note.startswith(f"route 'urdf' not taken: Pinocchio cannot read {small_arm}: ")


class TestInput:
    @pytest.mark.parametrize("samples", [0, -3])
    def test_samples(self, samples):
        with pytest.raises(InvalidInput, match=f"samples is {samples}; give a whole number"):
            crosscheck.compare("kr500", samples)

    @pytest.mark.parametrize("option", [{"lock": ["O1"]}, {"gravity": (0, 0, -1)}])
    def test_options_of_files_with_a_model(self, option):
        with pytest.raises(InvalidInput, match="a RobotModel already has its joints and gravity"):
            crosscheck.compare(kr500(), 1, **option)

    def test_unknown_name(self):
        with pytest.raises(urdf.RobotNotFound, match=r"close names: .*ur5"):
            crosscheck.compare("ur55", 1)

    def test_missing_file(self, tmp_path):
        with pytest.raises(urdf.RobotNotFound, match=r"nowhere\.urdf' is not a file"):
            crosscheck.compare(tmp_path / "nowhere.urdf", 1)

    def test_unknown_lock(self, small_arm):
        with pytest.raises(urdf.InvalidLock, match=r"cannot lock 'elbow'.*known: z_shoulder, y_elbow, a_slide"):
            crosscheck.compare(small_arm, 1, lock=["elbow"])

    def test_lock_as_a_string(self, small_arm):
        """A string is an iterable of letters, and no list of joints."""
        with pytest.raises(urdf.InvalidLock, match="lock is the string 'a_slide'"):
            crosscheck.compare(small_arm, 1, lock="a_slide")

    def test_assert_agrees_passes_options_on(self, small_arm):
        """Names of joints alone mean zero."""
        comparison = crosscheck.assert_agrees(small_arm, 1, lock=["a_slide"], gravity=(0, 0, -1.62))
        assert comparison.locked == {"a_slide": 0.0}
        assert comparison.model.gravity.tolist() == [0, 0, -1.62]

    def test_progress_counts_every_state_once(self, pendulum):
        done = {}

        def progress(case, states):
            done[case] = done.get(case, 0) + states

        comparison = crosscheck.compare(pendulum, SAMPLES, progress=progress)
        assert set(done) == set(comparison.quantities["inverse_dynamics"].by_case)
        assert done["random"] == SAMPLES

    def test_chunks_leave_nothing_out(self, monkeypatch, tree):
        """Many states are handled in portions; the last one counts as well."""
        monkeypatch.setattr(comparing, "CHUNK_STATES", 2)
        done = []
        comparison = crosscheck.compare(tree, 5, progress=lambda case, states: done.append((case, states)))
        assert comparison.agrees
        assert [states for case, states in done if case == "random"] == [2, 2, 1]
