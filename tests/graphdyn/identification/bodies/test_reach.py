"""Boxes of links by their kinematics and by their inertia, and the inequalities that hold matter inside."""

import numpy as np
import pytest
from identified import consistent_data as data

import urdf
from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn.identification.bodies.inequalities import inequalities
from graphdyn.identification.bodies.limits import PhysicalLimits
from graphdyn.identification.bodies.reach import extents, gyration_radii, joined, reach_boxes, spreads
from graphdyn.identification.bodies.unknown_bodies import unknown_bodies
from graphdyn.model.inertia import pseudo_inertia

MESHED = ("ur5", "kinova", "xarm7", "z1")
"""Robots of the catalog with meshes."""


def arm():
    """Two links, 0.4 and 0.1 m long."""
    bodies = tuple(Body(name, 1.0, [0, 0, 0], np.eye(3)) for name in "ab")
    places = (Placement(translation=[0, 0, 0.4]), Placement(translation=[0.1, 0, 0]))
    return RobotModel("arm", bodies, tuple(Joint(f"j{k}", "revolute", k, places[k], [0, 0, 1]) for k in range(2)))


def test_boxes_reach_the_next_joints_and_as_far_again():
    first, second = reach_boxes(arm())
    assert first == pytest.approx(np.array([[-0.4, -0.4, -0.4], [0.5, 0.4, 0.4]]))
    assert second == pytest.approx(np.array([[-0.25] * 3, [0.25] * 3]))  # the mean of both joints


def test_radii_of_gyration_are_those_of_which_inspect_warns():
    assert gyration_radii(arm()) == pytest.approx([0.5, 0.5])


@pytest.mark.parametrize("name", MESHED)
def test_boxes_hold_the_meshes(name):
    model, shapes = urdf.load(name), urdf.shapes(name)
    boxes = dict(zip(model.body_names, reach_boxes(model), strict=True))
    for shape in shapes.meshes:
        if shape.body in boxes:
            places = shape.vertices @ shape.placement.rotation.T + shape.placement.translation
            low, high = boxes[shape.body]
            assert np.all(places >= low)
            assert np.all(places <= high)


def test_extents_of_a_uniform_block_are_its_sides():
    sides, center, mass = np.array([0.3, 0.1, 0.6]), np.array([0.2, -0.1, 0.4]), 3.0
    squares = sides**2 / 12
    block = pseudo_inertia(mass, center, mass * np.diag(squares.sum() - squares))
    (box,) = extents(block[None])
    assert box == pytest.approx(np.stack([center - sides / 2, center + sides / 2]))
    assert spreads(block[None]) == pytest.approx([np.sqrt(squares.sum())])
    assert joined(box, box + 1.0) == pytest.approx(np.stack([box[0], box[1] + 1.0]))


def parameters(points, masses):
    """Ten parameters of point masses."""
    matrix = np.einsum("k,ki,kj->ij", masses, *2 * (np.column_stack([points, np.ones(len(points))]),))
    squares = np.trace(matrix[:3, :3]) * np.eye(3) - matrix[:3, :3]
    entries = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
    return np.array([matrix[3, 3], *matrix[:3, 3], *(squares[k] for k in entries)])


def test_point_masses_within_a_box_keep_its_inequalities_and_others_do_not():
    model = data.torque_model()
    bodies = unknown_bodies(model, None)
    limits = PhysicalLimits(cad_factor=np.inf).of(bodies)
    names = [column.name for column in model.columns]
    rows = inequalities(limits, bodies, names)
    rng = np.random.default_rng(0)
    low, high = limits.box[2]
    masses = rng.uniform(0.1, 2.0, 12)
    x = model.prior()
    x[20:30] = parameters(rng.uniform(low, high, (12, 3)), masses)
    about = [name for name in rows.violated(x) if "B3" in name and "matter" in name]
    assert not about
    corners = low + (high - low) * rng.integers(0, 2, (12, 3))  # on the walls: equality
    x[20:30] = parameters(corners, masses)
    assert not [name for name in rows.violated(x) if "B3" in name and "matter" in name]
    x[20:30] = parameters(corners + np.array([1.05 * (high - low)[0], 0.0, 0.0]), masses)
    assert [name for name in rows.violated(x) if "B3" in name and "matter" in name] == [
        f"matter of 'B3' in x from {low[0]:.3g} to {high[0]:.3g} m"
    ]
