"""Keywords that functions hand on: declared for type checkers, and refused by name where nobody has them."""

import dataclasses
import inspect

import numpy as np
import pytest

import crosscheck
import urdf
from crosscheck.judging.setting import FunctionsUnderTest, Setting
from crosscheck.quantities import FUNCTIONS
from graphdyn import InvalidInput, kr500

MISSPELLED = {
    "judge": (lambda: crosscheck.judge("ur5", inverse_dynamics=np.add, toleranc=1e-3), "tolerance"),
    "judge, None": (lambda: crosscheck.judge("ur5", inverse_dynamcs=None), "inverse_dynamics"),
    "assert_correct": (lambda: crosscheck.assert_correct("ur5", mass_matrix=np.add, sample=3), "samples"),
    "compare": (lambda: crosscheck.compare("ur5", chian=("a", "b")), "chain"),
    "assert_agrees": (lambda: crosscheck.assert_agrees("ur5", sed=3), "seed"),
    "identify": (lambda: crosscheck.identify("ur5", [], method=["wls"]), "methods"),
    "virtual_robot": (lambda: crosscheck.identifying.virtual_robot("ur5", [], gravty=(0, 0, -1)), "gravity"),
    "load": (lambda: urdf.load("ur5", repairs=["axis"]), "repair"),
    "inspect": (lambda: urdf.inspect("ur5", mesh="off"), "meshes"),
    "shapes": (lambda: urdf.shapes("ur5", mimics="locked"), "mimic"),
    "fused_links": (lambda: urdf.fused_links("ur5", loop=()), "loops"),
    "update": (lambda: urdf.update("ur5", "x.urdf", [], inconsistant=True), "inconsistent"),
}


@pytest.mark.parametrize("name", MISSPELLED)
def test_a_misspelt_keyword_is_an_error_that_names_the_closest(name):
    call, meant = MISSPELLED[name]
    with pytest.raises(TypeError, match=rf"\(\) has no option '\w+'; did you mean '{meant}'\?"):
        call()


def test_a_keyword_like_no_other():
    with pytest.raises(TypeError, match=r"load\(\) has no option 'xyzzy'; known are source, reading, chain, lock"):
        urdf.load("ur5", xyzzy=1)


def test_every_function_that_can_be_judged_is_declared():
    assert list(FunctionsUnderTest.__annotations__) == list(FUNCTIONS)


def test_every_option_of_a_reading_is_declared():
    fields = [field.name for field in dataclasses.fields(urdf.Reading)]
    assert list(urdf.ReadingKeywords.__annotations__) == ["reading", *fields]


def test_every_option_of_the_judge_is_in_its_setting():
    parameters = set(inspect.signature(crosscheck.judge).parameters) - {"functions", "progress"} | {"reading"}
    assert {field.name for field in dataclasses.fields(Setting)} == parameters


@pytest.mark.parametrize(("strict", "like"), [("assert_agrees", "compare"), ("assert_correct", "judge")])
def test_the_functions_of_test_suites_have_the_same_signature(strict, like):
    one, other = (inspect.signature(getattr(crosscheck, name)) for name in (strict, like))
    assert list(one.parameters.values()) == list(other.parameters.values())


class TestReading:
    def test_one_object_or_keywords(self, small_arm):
        reading = urdf.Reading(lock=["a_slide"], gravity=(0, 0, -1.62))
        one, other = (
            urdf.load(small_arm, reading=reading),
            urdf.load(small_arm, lock=["a_slide"], gravity=(0, 0, -1.62)),
        )
        assert one.joint_names == other.joint_names == ("z_shoulder", "y_elbow")
        assert one.gravity.tolist() == other.gravity.tolist() == [0, 0, -1.62]

    def test_keywords_beside_it_take_its_place(self, small_arm):
        model = urdf.load(small_arm, reading=urdf.Reading(lock=["a_slide"]), lock=["y_elbow"])
        assert model.joint_names == ("z_shoulder", "a_slide")

    def test_what_is_stated(self):
        assert urdf.Reading().stated == ()
        stated = urdf.Reading(lock=iter(["a"]), gravity=np.zeros(3), repair=["axis"], loops=(), mimic="locked")
        assert stated.stated == ("lock", "mimic", "loops", "repair", "gravity")
        assert (stated.locked, stated.lock) == ({"a": 0.0}, ("a",))

    def test_of_a_model(self):
        with pytest.raises(InvalidInput, match="mimic and repair: only for names and files; a RobotModel already"):
            crosscheck.compare(kr500(), mimic="locked", repair=["axis"])

    def test_pinocchio_reads_no_repaired_file(self, small_arm):
        text = small_arm.read_text().replace('lower="-1" upper="2"', 'lower="2" upper="-1"')
        small_arm.write_text(text, encoding="utf-8")
        with pytest.warns(urdf.RepairWarning):
            comparison = crosscheck.compare(small_arm, 1, repair=["limits"])
        assert comparison.agrees
        assert comparison.routes == ("model",)
        assert (
            "route 'urdf' not taken: the file is repaired first, and Pinocchio reads it as it stands"
            in comparison.notes
        )
