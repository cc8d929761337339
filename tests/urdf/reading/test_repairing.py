"""repair=: what the caller asks to have mended is mended and told; nothing else is touched."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

import urdf

REVERSED = ('lower="-1" upper="2"', 'lower="2" upper="-1"')


def axis(text):
    return '<axis xyz="0 0 1"/>', f'<axis xyz="{text}"/>'


def told(path, repair):
    """The model, and the warnings by class."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model = urdf.load(path, repair=repair)
    assert {warning.filename for warning in caught} <= {__file__}
    return model, {warning.category: str(warning.message) for warning in caught}


def test_reversed_limits_are_exchanged(arm):
    path = arm(*REVERSED)
    with pytest.raises(urdf.InvalidRobot, match="lower limit 2 is above upper limit -1; swap them, or") as caught:
        urdf.load(path)
    assert (caught.value.code, caught.value.line) == ("limits-crossed", 23)
    model, said = told(path, ("limits",))
    assert (model.joints[0].limits.lower, model.joints[0].limits.upper) == (-1.0, 2.0)
    assert said == {
        urdf.RepairWarning: f"{path}: repaired: line 23: <limit> of joint 'shoulder': lower 2 and upper -1 exchanged"
    }


def test_an_axis_is_normalized(arm):
    path = arm(*axis("0 0.5773 0.8165"))
    model, said = told(path, ["axis"])
    assert_allclose(model.joints[0].axis, urdf_axis(path), rtol=0, atol=2e-16)
    assert said == {
        urdf.RepairWarning: f"{path}: repaired: line 22: <axis> of joint 'shoulder': xyz 0 0.5773 0.8165 made 0.0 "
        "0.5773151431748109 0.8165214176376807, of length 1"
    }


def urdf_axis(path):
    """Of the first joint without the repair: it is normalized as well, with another warning."""
    with pytest.warns(urdf.AxisNotNormalizedWarning):
        return urdf.load(path).joints[0].axis


@pytest.mark.parametrize("text", ["0 0 0.9991", "0 2 0"])
def test_every_miss_is_mended(arm, text):
    _, said = told(arm(*axis(text)), ("axis",))
    assert set(said) == {urdf.RepairWarning}


def test_all_repairs_in_one_warning(arm):
    _, said = told(arm(*axis("0 0 0.9999"), *REVERSED), ("limits", "axis"))
    (message,) = said.values()
    assert "xyz 0 0 0.9999 made 0.0 0.0 1.0, of length 1, line 23: <limit>" in message


def test_nothing_to_repair_says_nothing(arm):
    _, said = told(arm(), ("limits", "axis"))
    assert said == {}


def test_endless_and_continuous_limits_stay(arm):
    endless = arm('lower="-1" upper="2"', 'lower="1.7976931348623157e308" upper="-1"')
    model, said = told(endless, ("limits",))
    assert (model.joints[0].limits.upper, said) == (-1.0, {})
    model, said = told(arm('shoulder" type="revolute"', 'shoulder" type="continuous"', *REVERSED), ("limits",))
    assert (model.joints[0].limits.lower, said) == (None, {})


def test_truncated_angles_are_mended_only_when_named(arm):
    """Else they are used as written, whatever else is asked for, and urdf.inspect reports them."""
    path = arm()
    assert "rpy-truncated" in urdf.inspect(path).codes
    model, said = told(path, ("axis", "limits"))
    assert abs(model.joints[0].placement.rotation[0, 0] - np.cos(1.5708)) < 1e-16
    assert said == {}
    model, said = told(path, ("angles",))
    assert abs(model.joints[0].placement.rotation[0, 0]) < 1e-16
    change = "line 19: <origin> of joint 'shoulder': rpy 0 0 1.5708 made 0 0 1.5707963267948966"
    assert said == {urdf.RepairWarning: f"{path}: repaired: {change}"}


def test_broken_numbers_are_refused_all_the_same(arm):
    with pytest.raises(urdf.InvalidNumber, match="'x' is not a number"):
        urdf.load(arm('lower="-1"', 'lower="x"'), repair=("limits",))
    with pytest.raises(urdf.InvalidNumber, match="the axis is zero"):
        urdf.load(arm(*axis("0 0 0")), repair=("axis",))


def test_fused_links_take_repairs(arm):
    assert set(urdf.fused_links(arm(*REVERSED), lock=["slide"], repair=("limits",))) == {"fore"}


def test_an_unknown_repair(arm):
    with pytest.raises(
        urdf.InvalidRepair, match=r"arm.urdf: no repair is called 'mass'; known: angles, axis, geoms, inertials, limits"
    ):
        urdf.load(arm(), repair=("mass",))


def test_a_single_string(arm):
    with pytest.raises(urdf.InvalidRepair, match=r"repair is the string 'axis'; give a tuple: \('axis',\)"):
        urdf.load(arm(), repair="axis")
