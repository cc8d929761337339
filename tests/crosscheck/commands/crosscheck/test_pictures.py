"""The errors over all states: their quantiles, and the pictures of them and of the robot."""

import dataclasses
import json
import math

import numpy as np

import crosscheck
import graphdyn
from crosscheck.commands.crosscheck.record import robot_record
from crosscheck.comparing.comparison import QUANTILES
from crosscheck.quantities import COMPARED
from crosscheck.report.pictures.spread import SpreadRow, spread
from crosscheck.report.pictures.stick_figure import BENT_ANGLE, pose, pose_text, stick_figure
from crosscheck.report.records.record import plain
from graphdyn import Joint, Placement


class TestQuantiles:
    def test_errors_of_all_routes_and_states(self, small_comparison):
        torque, base = small_comparison.quantities["inverse_dynamics"], small_comparison.quantities["base_parameters"]
        assert torque.errors.max() == torque.max_relative_error
        assert len(torque.errors) == 2 * len(small_comparison.quantities["constraint_rank"].errors)
        assert base.errors.tolist() == [base.max_relative_error]

    def test_are_errors_that_occurred(self):
        result = crosscheck.QuantityResult(
            COMPARED["inverse_dynamics"], np.array([4.0, 0.0, math.inf, 1.0]), math.inf, {}, {}, None
        )
        assert result.quantiles == {"0": 0.0, "0.5": 4.0, "0.9": math.inf, "0.99": math.inf, "1": math.inf}

    def test_in_json_instead_of_the_errors(self, small_comparison):
        record = plain(robot_record(small_comparison))["quantities"]["inverse_dynamics"]
        assert list(record["quantiles"]) == [f"{part:g}" for part in QUANTILES]
        assert record["quantiles"]["1"] == record["max_relative_error"]
        assert record["scale"] == COMPARED["inverse_dynamics"].scale
        assert "errors" not in record
        assert "model" not in plain(robot_record(small_comparison))
        json.dumps(record, allow_nan=False)

    def test_every_quantity_names_its_scale(self):
        assert all(quantity.scale for quantity in COMPARED.values())


class TestPictures:
    def test_zero_infinity_and_nan_have_places(self):
        text = spread(
            "k", [SpreadRow("a", np.array([0.0, 1e-16, math.inf]), 1e-13), SpreadRow("b", np.array([math.nan]), 1e-13)]
        )
        assert ">0</text>" in text
        assert ">∞</text>" in text
        assert "✗ a" in text
        assert "✗ b" in text
        assert "the largest is inf of a" in text

    def test_axis_is_labeled_with_powers_of_ten(self):
        text = spread("k", [SpreadRow("a", np.array([1e-16, 20.0]), 1e-13)])
        assert "10⁻" in text
        assert "10²" in text or "10¹" in text
        assert "relative error" in text

    def test_only_zeros(self):
        assert "✗" not in spread("k", [SpreadRow("rank", np.zeros(3), 0.0)])
        assert "✗ rank" in spread("k", [SpreadRow("rank", np.array([0.0, 0.1]), 0.0)])

    def test_straight_robot_is_bent(self):
        """Two revolute joints above each other: zero would hide everything in one line."""
        joints = [Joint(f"j{k}", "revolute", k, Placement(translation=[0, 0, 1.0]), [0, 1.0, 0]) for k in range(2)]
        body = graphdyn.Body("a", 1.0, np.zeros(3), np.eye(3))
        bodies = (body, dataclasses.replace(body, name="b"))
        straight = graphdyn.RobotModel("straight", bodies, tuple(joints))
        assert pose(straight).tolist() == [BENT_ANGLE, BENT_ANGLE]
        assert "straight line" in pose_text(straight)
        sliding = dataclasses.replace(straight, joints=(joints[0], dataclasses.replace(joints[1], kind="prismatic")))
        assert pose(sliding).tolist() == [BENT_ANGLE, 0]
        assert "straight line" in pose_text(sliding)
        assert 'role="img"' in stick_figure("k", straight, "straight")

    def test_usual_robot_is_in_its_zero_pose(self, tree):
        assert not pose(tree).any()
        assert pose_text(tree) == "Zero pose"

    def test_all_in_one_point_and_massless(self):
        """Nothing to be seen, and nothing that fails."""
        joints = (Joint("j", "prismatic", 0, Placement(), [0, 0, 1.0]),)
        body = graphdyn.Body("a", 0.0, np.zeros(3), np.zeros((3, 3)))
        assert "1 prismatic joint" in stick_figure("k", graphdyn.RobotModel("point", (body,), joints), "point")

    def test_robot_label_counts_joints(self, small_comparison):
        assert "2 revolute and 1 prismatic joints" in stick_figure("k", small_comparison.model, "small")
