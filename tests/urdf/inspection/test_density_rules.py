"""Inertials denser than any material, or thinner than air: by bodies whose mass and tensor are known."""

import numpy as np
import pytest
from inspected.sample import FORE, changed

import urdf
from urdf.inspection.rules.density_rules import ellipsoid_density
from urdf.inspection.structure import LinkInertial

BOX = np.array([0.3, 0.1, 0.2])


def of_tensor(mass, tensor):
    return LinkInertial(mass, np.zeros(3), np.eye(3), tensor, "a", None)


def told(mass, moments):
    ixx, iyy, izz = moments
    inertia = FORE.replace("0.05", f"{ixx!r}").replace("0.06", f"{iyy!r}").replace("0.02", f"{izz!r}")
    text = changed('"1.5"', f'"{mass!r}"', FORE, inertia)
    return [each for each in urdf.inspect(text).findings if each.code == "inertial-density"]


def ellipsoid(density, halves=(0.1, 0.07, 0.2)):
    """Mass and moments of a uniform ellipsoid."""
    mass, squares = float(density * 4 / 3 * np.pi * np.prod(halves)), np.square(halves)
    return mass, [float(x) for x in mass / 5 * (squares.sum() - squares)]


@pytest.mark.parametrize(
    ("density", "severity"), [(1.19, "note"), (1.21, None), (7850, None), (22_500, None), (22_700, "warning")]
)
def test_ellipsoids(density, severity):
    assert [each.severity for each in told(*ellipsoid(density))] == ([severity] if severity else [])


def test_thin_links_are_told_in_one_line():
    (finding,) = told(*ellipsoid(0.5))
    assert (finding.element, finding.line) == (None, 11)
    assert finding.message == (
        "1 link is thinner than air, as ellipsoids of their mass and tensor: 0.002932 kg of link 'fore' are one of "
        "0.5 kg/m³"
    )
    assert finding.remedy == "give the real ones, if forces matter"


def test_no_body_is_less_dense_everywhere():
    """Boxes, hollow ones and points: the ellipsoid is never denser than the densest place."""
    rng = np.random.default_rng(0)
    for _ in range(200):
        points = rng.uniform(-0.5, 0.5, (3000, 3)) * BOX * rng.uniform(0.3, 3, 3)
        weights = rng.uniform(0, 1, len(points)) ** rng.uniform(0, 5)  # uneven filling of a box
        volume = np.prod(np.ptp(points, axis=0))
        mass = weights.sum()
        centered = points - weights @ points / mass
        spread = (centered.T * weights) @ centered
        densest = weights.max() * len(points) / volume
        assert ellipsoid_density(of_tensor(mass, np.trace(spread) * np.eye(3) - spread)) < densest


def test_a_plate_is_not_accused_of_its_rounding():
    """1 kg of a plate of 1 m by 0.5 m, whose moments have three digits and miss its thickness of 2 mm of nothing."""
    assert told(1.0, (0.0208, 0.0833, 0.1041)) == []
