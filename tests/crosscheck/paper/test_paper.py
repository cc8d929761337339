"""The paper reproduced: its tables, its multipliers, and checks that can fail."""

import dataclasses
import math

import numpy as np
import pytest
from reproduced_paper import reproduced

from crosscheck.paper.errata import ERRATA
from crosscheck.paper.multipliers import MIN_REPRODUCED_DIGITS, agreeing_digits, printed_ratios
from crosscheck.paper.printed import MULTIPLIERS, PARAMETERS, TABLE_2, TABLE_3, TABLE_4
from crosscheck.paper.reproduction import CORRECTED_FORM_BOUND, EXACT_PARAMETER_BOUND, REFERENCE_BOUND, Check, checks
from crosscheck.paper.tables import SEEDS
from graphdyn import kr500

LARGEST_PRINTED_ERROR = 0.0424
"""Of Table 4 [kg m²]."""

QUOTIENT = 1e-6
"""Of two numbers of seven digits, relative."""


@pytest.fixture(scope="module")
def found():
    return reproduced()


class TestTable2:
    @pytest.mark.parametrize("name", TABLE_2.rows)
    def test_every_printed_digit(self, found, name):
        row = list(TABLE_2.rows).index(name)
        assert found.geometry.texts[row] == tuple(number.text for number in TABLE_2.rows[name])

    def test_a_wrong_digit_is_counted(self, found):
        wrong = found.geometry.ours.copy()
        wrong[2, 3] += 1e-4
        assert found.geometry.differing == 0
        assert dataclasses.replace(found.geometry, ours=wrong).differing == 1

    def test_length_of_a_row(self):
        for printed in (TABLE_2, TABLE_3, TABLE_4, MULTIPLIERS):
            assert {len(row) for row in printed.rows.values()} == {6}


class TestIdentification:
    @pytest.mark.parametrize("way", ["exact", "together"])
    def test_exact_data(self, found, way):
        trial = getattr(found.identification, way)
        determined = np.isfinite(trial.values)
        error = np.abs(trial.errors / found.identification.true)[determined].max()
        assert error <= EXACT_PARAMETER_BOUND
        assert trial.undetermined == ("B1 m(e_2)", "B1 J_22", "B1 J_33")
        assert trial.rank == determined.sum() == 33

    def test_seven_digits(self, found):
        """Every trial, not the luckiest, is better than the paper in the largest error and in the rms."""
        identification = found.identification
        assert len(identification.rounded) == 2 + len(SEEDS)
        assert identification.printed_largest == LARGEST_PRINTED_ERROR
        assert identification.printed_rms == pytest.approx(0.009424, abs=1e-6)
        for trial in identification.rounded:
            assert 1e-3 < trial.largest(identification.compared) <= LARGEST_PRINTED_ERROR
            assert trial.rms(identification.compared) < identification.printed_rms
            assert trial.undetermined == identification.exact.undetermined

    def test_standard_deviations_tell_the_error(self, found):
        """Of the rounded data: no determined parameter is off by more than seven of them."""
        trial = found.identification.rounded[0]
        known = np.isfinite(trial.values)
        assert np.abs(trial.errors / trial.standard_deviations)[known].max() < 7

    def test_compared_entries(self, found):
        compared = found.identification.compared
        assert compared.sum() == 33
        assert [PARAMETERS[row] for row, body in np.argwhere(~compared) if body == 0] == ["m(e_2)", "J_22", "J_33"]

    def test_table_4_is_table_3_minus_table_2_but_for_the_misprint(self, found):
        assert found.identification.contradictions == ((5, 3),)
        misprint = TABLE_3.rows["J_33"][3]
        assert (misprint.text, misprint.reading, misprint.erratum) == ("5.4619", "5.6419", "B5")
        assert misprint.value - TABLE_2.values[5, 3] == pytest.approx(TABLE_4.values[5, 3], abs=1e-6)

    def test_undetermined_moments_of_body_1_are_the_cylinder_formula(self, found):
        assert (
            f"{found.identification.implied_moment:.4f}" == TABLE_3.rows["J_22"][0].text == TABLE_3.rows["J_33"][0].text
        )


class TestAsPrinted:
    def test_rank(self, found):
        assert (found.printed.rank, found.printed.n_rows) == (27, 30)
        assert found.over_time.ranks == {0.0: 25, 0.02: 27, 1.5: 27, 2.0: 27}

    @pytest.mark.parametrize(
        ("name", "digits"),
        [("λ_63", 6), ("λ_64", 7), ("λ_65", 6), ("λ_53", 7), ("λ_43", 7), ("λ_44", 6), ("λ_45", 6), ("λ_33", 7),
         ("λ_23", 7), ("λ_13", 7)],
    )  # fmt: skip
    def test_reproduced(self, found, name, digits):
        number = next(number for number in found.numbers if number.name == name)
        assert number.kind == "reproduced"
        assert number.digits == digits >= MIN_REPRODUCED_DIGITS
        assert number.ours == pytest.approx(number.printed.value, rel=1e-6)

    def test_the_others_are_marked(self, found):
        by_kind = {}
        for number in found.numbers:
            by_kind.setdefault(number.kind, []).append(number.name)
        assert by_kind["free"] == ["λ_54", "λ_55", "λ_34", "λ_35", "λ_24", "λ_25"]
        assert by_kind["unexplained"] == ["λ_14", "λ_15"]
        assert len(by_kind["rounding"]) == 12
        assert len(by_kind["reproduced"]) == 10
        for number in found.numbers:
            assert math.isnan(number.ours) == (number.kind == "free")
            assert (number.digits > 0) == (number.kind == "reproduced")

    def test_misprints(self):
        assert MULTIPLIERS.rows["λ_j3"][2].value == -2.393758e4
        assert MULTIPLIERS.rows["λ_j2"][3].text == "30.072190e-4"

    @pytest.mark.parametrize("joint", [2, 3, 5])
    def test_ratio_of_the_null_vector(self, found, joint):
        tangent = math.tan(math.radians(33.75))
        assert found.printed.ratios[joint] == pytest.approx(tangent, rel=1e-12)
        assert printed_ratios()[joint] == pytest.approx(tangent, rel=QUOTIENT)

    @pytest.mark.parametrize(
        ("printed", "ours", "digits"),
        [(1.234567, 1.234567, 7), (1.234567, 1.2345674, 7), (1.234567, 1.234568, 6), (-6489.101, -6489.101844, 6),
         (2.0, 3.0, 0), (2.0, -2.0, 0), (1e11, math.nan, 0), (math.nan, 1.0, 0), (0.0, 0.0, 0)],
    )  # fmt: skip
    def test_agreeing_digits(self, printed, ours, digits):
        assert agreeing_digits(printed, ours) == digits


class TestCorrected:
    def test_against_rnea(self, found):
        corrected = found.corrected
        assert corrected.multipliers.shape == corrected.rnea.shape == (6, 5)
        assert corrected.difference <= REFERENCE_BOUND
        assert np.abs(corrected.multipliers - corrected.rnea).max() <= REFERENCE_BOUND * np.abs(corrected.rnea).max()

    def test_forces_of_section_3(self, found):
        forces = found.corrected.forces
        np.testing.assert_allclose(forces[0], [24853.753, -7277.143, 110108.771], rtol=0, atol=1e-3)
        np.testing.assert_allclose(forces[5], [854.467, -2008.935, 5947.395], rtol=0, atol=1e-3)

    def test_over_the_whole_motion(self, found):
        motion = found.over_time
        assert motion.difference <= REFERENCE_BOUND
        assert motion.multipliers.shape == (101, 6, 5)
        row = int(np.argmin(np.abs(motion.recording.time - 1.5)))
        np.testing.assert_allclose(motion.multipliers[row], found.corrected.multipliers, rtol=1e-9)
        total = sum(body.mass for body in kr500().bodies)
        assert motion.multipliers[0, 0, 0] == pytest.approx(
            motion.recording.acceleration[0, :, 0] @ [body.mass for body in kr500().bodies]
        )
        assert motion.multipliers[0, 0, 2] > 9 * total


class TestChecks:
    def test_all_hold(self, found):
        assert found.agrees
        assert all(check.why for check in found.checks)

    def test_errata(self, found):
        """What the corrected forms must keep is in the checks; that the printed ones miss it is shown."""
        assert {effect.erratum for effect in found.effects} == set(ERRATA)
        for effect in found.effects:
            assert len(effect.errors) == len(effect.corrected_errors)
            if effect.erratum not in ("A2", "A3"):
                assert effect.median > 1e9 * CORRECTED_FORM_BOUND
            if effect.erratum == "A2":
                assert effect.median == {"kr500": 2, "ur5": 3}[effect.robot]

    @pytest.mark.parametrize(
        ("part", "field", "value", "where"),
        [
            ("corrected", "difference", 1e-9, "section 3.2"),
            ("corrected", "difference", math.nan, "section 3.2"),
            ("motion", "difference", 1e-9, "section 3"),
            ("motion", "ranks", {0.0: 25, 1.5: 28}, "Eq. (111)"),
            ("printed", "ratios", {2: 0.66818, 3: 0.6681786, 5: 0.6681786}, "Eq. (114), (116), (117)"),
            ("printed", "ratios", {2: 0.6681786, 3: 0.6681786}, "Eq. (114), (116), (117)"),
        ],
    )
    def test_each_can_fail(self, found, part, field, value, where):
        parts = {"printed": found.printed, "corrected": found.corrected, "motion": found.over_time}
        parts[part] = dataclasses.replace(parts[part], **{field: value})
        failing = checks(found.geometry, found.identification, numbers=found.numbers, effects=found.effects, **parts)
        assert [check.where for check in failing if not check.agrees] == [where]

    def test_a_parameter_that_is_lost_fails(self, found):
        """Of every trial: what is not determined has no error that could be too large."""
        values = found.identification.exact.values.copy()
        values[0, 1] = math.nan
        exact = dataclasses.replace(found.identification.exact, values=values)
        fewer = dataclasses.replace(found.identification, exact=exact)
        parts = (found.geometry, fewer, found.printed, found.numbers, found.corrected, found.over_time, found.effects)
        failing = [check for check in checks(*parts) if not check.agrees]
        assert [check.what for check in failing] == ["parameters that the data determine and the paper prints"]

    def test_a_lost_digit_fails(self, found):
        numbers = [dataclasses.replace(found.numbers[2], digits=5), *found.numbers[:2], *found.numbers[3:]]
        parts = (found.geometry, found.identification, found.printed, numbers, found.corrected)
        failing = [check for check in checks(*parts, found.over_time, found.effects) if not check.agrees]
        assert [check.what for check in failing] == ["as printed: fewest agreeing significant digits of these"]

    def test_bounds_of_both_kinds(self):
        assert Check("", "", 1.0, 1.0, "").agrees
        assert Check("", "", 1.0, 1.0, "", at_least=True).agrees
        assert not Check("", "", math.nan, 1.0, "").agrees
        assert not Check("", "", 0.0, 1.0, "", at_least=True).agrees
