"""The report of an identification: what stands in its tables, and the torques that its plots hold."""

import dataclasses
import re
from unittest.mock import Mock

import numpy as np
import pytest
from identified import identified_arm
from identified.own_rows import own_rows
from shown.approved import approve_record, approve_report, approve_result
from shown.blocks import cells, tables

import graphdyn
from crosscheck.commands.identify.models import methods_of
from crosscheck.commands.identify.record import record as identify_record
from crosscheck.commands.identify.reports.model_report import _torque_sizes
from crosscheck.commands.identify.reports.quality_report import _of_predicted
from crosscheck.commands.identify.reports.report import _singular_values, _without_reasons, identify_report
from crosscheck.identifying import Folds
from crosscheck.report.records.record import plain
from crosscheck.report.report import Facts, Plot
from crosscheck.report.text import as_text

WHY = "the recording has torques about the joint axes alone"


@pytest.fixture(scope="module")
def found():
    """The last method failed."""
    all_answered = identified_arm.compared()
    *others, graph = all_answered.comparison.results
    unanswered = ("estimate", "base_values", "training", "held_out", "plausibility")
    failed = dataclasses.replace(graph, failure=WHY, **dict.fromkeys(unanswered))
    results = tuple(dataclasses.replace(result, seconds=2.0 + k) for k, result in enumerate((*others, failed)))
    comparison = dataclasses.replace(all_answered.comparison, results=results)
    return dataclasses.replace(all_answered, comparison=comparison)


@pytest.fixture(scope="module")
def report(found):
    return identify_report(found, found.shown())


def section(report, key):
    return next(part for part in report.sections if part.key == key)


def test_findings_stand_under_their_recording():
    """Of two that are predicted, the second is too short to be examined."""
    finding = Mock(severity="fault", message="τ is late", remedy="shift it", code="delay", lines=())
    found = Mock(predicted_recordings=("a.csv", "b.csv"), validation_data_quality=(Mock(findings=[finding]), None))
    heading, notes, last = _of_predicted(found)
    assert heading.text == "Of a.csv, which is predicted:"
    assert notes.notes[0].text == "fault: τ is late; shift it"
    assert last.text == "b.csv, which is predicted, is too short to be examined."


def test_what_only_rounded_angles_show_is_named(found):
    named = dataclasses.replace(found.comparison, nearly_undetermined=("arm m", "arm I_xx"))
    sections = identify_report(dataclasses.replace(found, comparison=named), None).sections
    facts = [fact for part in sections for block in part.blocks if isinstance(block, Facts) for fact in block.items]
    why = "only the rounding of angles in the robot's file shows them; --angles-as-written keeps them"
    assert ("nearly undetermined", f"arm m, arm I_xx: {why}") in facts


def test_reasons_are_told_once(found):
    reasons = ("joint_2 is predicted badly", "joint_4 is predicted badly")
    told = f"WLS is the best result, but 2 reasons speak against it: {'; '.join(reasons)}"
    recommended = dataclasses.replace(found.recommendation, name=None, reason=told, rejection_reasons=reasons)
    rejected = Mock(recommendation=recommended)
    assert _without_reasons(rejected) == "WLS is the best result, but 2 reasons speak against it"


@pytest.mark.parametrize("text", [None, "all"])
def test_the_graph_method_is_left_out_without_wrenches(text):
    with_wrenches = methods_of(text, of_sums=False, wrenches=True)
    assert [name for name in with_wrenches if name != "graph"] == methods_of(text, of_sums=False, wrenches=False)
    assert "graph" in with_wrenches


class TestMethods:
    def test_one_row_per_method(self, found, report):
        (methods, held_out, fitted) = tables(report, "methods")
        names = [*(result.name for result in found.comparison.results), "CAD links: WLS"]
        assert [row.cells[0] for row in methods.rows] == names
        assert next(row.cells[0] for row in methods.ordered) == "graph method"  # failures first
        answered = [candidate.result for candidate in found.candidates if candidate.result.failure is None]
        for table, part in ((held_out, "held_out"), (fitted, "training")):
            assert len(table.rows) == len(answered)
            for row, result in zip(table.rows, answered, strict=True):
                np.testing.assert_array_equal([rms for rms, _ in row.cells[1:]], getattr(result, part).everything.rms)

    def test_verdicts(self, found, report):
        said = {row.cells[0]: getattr(row.cells[1], "words", "") for row in tables(report, "methods")[0].rows}
        assert said["graph method"] == "failed"
        assert said["OLS"] == "not physically consistent"
        assert [name for name, words in said.items() if words == "recommended"] == [found.recommendation.name]

    def test_no_answer(self, found):
        graph = found.comparison.of("graph method")
        comparison = dataclasses.replace(found.comparison, results=(graph,))
        nothing = dataclasses.replace(found, comparison=comparison, others=())
        report = identify_report(nothing, None)
        assert (report.verdict.words, report.verdict.reason) == ("no usable model", "No method has a result.")
        assert [part.key for part in report.sections] == ["recording", "data_quality", "methods", "excitation", "end"]
        assert f"graph method: failed: {WHY}" in as_text(report)


class TestParameters:
    def test_truth(self, found, report):
        virtual = dataclasses.replace(found, truth=identified_arm.virtual().truth)
        headings = [
            column.heading for column in tables(identify_report(virtual, found.shown()), "parameters")[0].columns
        ]
        assert headings[1:5] == ["CAD", "truth", "identified", "error"]
        assert "truth" not in [column.heading for column in tables(report, "parameters")[0].columns]

    @pytest.mark.parametrize("width", [80, 120])
    def test_fits_the_terminal(self, report, width):
        """No number is cut, and names of base parameters have room to be read."""
        text = as_text(report, width)
        assert max(map(len, text.splitlines())) <= width
        for row in tables(report, "parameters")[0].rows:
            assert f" {row.cells[1]:.4g} " in text
        assert "determined in combinations only" in text


@pytest.mark.usefixtures("unexamined")
class TestTorques:
    def test_measured_and_predicted(self, found, report):
        plots = section(report, "torques").blocks
        joints = found.torque_model.model.joint_names
        assert [plot.title for plot in plots] == [f"{j}, {side}" for j in joints for side in ("fitted", "held out")]
        for j in range(len(joints)):
            for plot, curves in zip(
                plots[2 * j : 2 * j + 2],
                (found.fit.curves(found.shown().name), found.trials[0].curves(found.shown().name)),
                strict=True,
            ):
                assert isinstance(plot, Plot)
                (measured, predicted), (residual,) = (panel.series for panel in plot.panels)
                assert measured.style != predicted.style
                assert measured.color != predicted.color
                there = ~np.isnan(measured.y)
                np.testing.assert_array_equal(plot.x[there], np.concatenate([curve.t for curve in curves]))
                for series, name in ((measured, "measured"), (predicted, "predicted")):
                    whole = np.concatenate([getattr(curve, name)[:, j] for curve in curves])
                    np.testing.assert_array_equal(series.y[there], whole)
                np.testing.assert_array_equal(residual.y, predicted.y - measured.y)

    def test_pieces_of_time(self):
        """Folds follow one another; between them the curves are interrupted."""
        folds = identified_arm.identified(("wls",), held_out=Folds(3))
        plot = section(identify_report(folds, folds.shown()), "torques").blocks[1]
        assert np.isnan(plot.panels[0].series[0].y).sum() == 2
        assert np.all(np.diff(plot.x) >= 0)
        assert plot.x_title == "t [s]"

    def test_recordings_that_begin_anew(self):
        arm = identified_arm.virtual()
        both = identified_arm.crosscheck.identify(
            arm.subject.model, [arm.fitted, arm.held_out], methods=["wls"], terms=arm.torque_model.terms,
            preparation=identified_arm.CUTOFF, poses=identified_arm.POSES,
        )  # fmt: skip
        plot = section(identify_report(both, both.shown()), "torques").blocks[0]
        assert plot.x_title == "t [s], recordings one after another"
        assert np.all(np.diff(plot.x) >= 0)
        first, second = both.fit.times
        assert plot.x[-1] - plot.x[0] == pytest.approx(first[-1] - first[0] + second[-1] - second[0])


TEN = ("m", "mc_x", "mc_y", "mc_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz")
FOUR_DIGITS, THREE_DIGITS, TWO_DIGITS = 6e-4, 6e-3, 0.051
"""Relative, of numbers with as many digits."""


def smallest_eigenvalue(ten):
    """Of the pseudo-inertia, from its definition: ∫ x xᵀ dm, m c, m."""
    m, x, y, z, xx, xy, yy, xz, yz, zz = ten
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    second = np.trace(tensor) / 2 * np.eye(3) - tensor
    return np.linalg.eigvalsh(np.block([[second, np.array([[x], [y], [z]])], [np.array([x, y, z]), m]]))[0]


def relative(errors, tau, which=None):
    which = np.ones_like(tau, bool) if which is None else which
    return np.sqrt((errors**2 * which).sum(axis=0) / (tau**2 * which).sum(axis=0))


RESIDUALS, SHARES = ("residual", "free_residual"), ("standstill", "clipped")


def unit_of(symbol, model):
    """Of a parameter of a body, or of the friction of a joint."""
    kind, number = symbol.split("_")
    slides = model.joints[int(number) - 1].is_prismatic
    friction = {"FV": ("N m s/rad", "N s/m"), "FC": ("N m", "N")}
    if kind in friction:
        return friction[kind][slides]
    return {"M": "kg", "MX": "kg m", "MY": "kg m", "MZ": "kg m"}.get(kind, "kg m²")


def evaluated(name, values):
    """A base parameter as its name says: such as "XX_2 - YY_2 + 0.18 M_3"."""
    terms = re.findall(r"(?:^|([+-]) )(?:([\d.e-]+) )?(\w+)", name)
    return sum((-1 if sign == "-" else 1) * float(factor or 1) * values[symbol] for sign, factor, symbol in terms)


@pytest.fixture(scope="module")
def compared_with_truth():
    """All methods on a robot whose truth is known: the result, its record, its report, and the rows of both motions."""
    arm = identified_arm.virtual()
    found = dataclasses.replace(identified_arm.compared(), truth=arm.truth)
    model = found.torque_model.model
    rows = [own_rows(model, recording) for recording in (arm.fitted, arm.held_out)]
    record = plain(identify_record(found, found.shown(), ["identify"]))
    return found, record, identify_report(found, found.shown()), *rows


def belongs(symbol, group, friction):
    """Whether a base parameter, by its symbol, is of a group of the excitation."""
    kind = symbol.split("_")[0]
    if group in friction:
        return kind == friction[group]
    inertia = len(kind.removesuffix("R")) == 2 and set(kind.removesuffix("R")) <= set("XYZ")
    return kind[:2] not in friction.values() and inertia == (group == "inertia tensors")


def block_of(report, key, kind):
    return next(block for block in section(report, key).blocks if isinstance(block, kind))


class TestEveryNumber:
    """Of the record and the page, from rows that SciPy has filtered."""

    def test_methods(self, compared_with_truth):
        found, record, report, fit, held_out = compared_with_truth
        b = np.array(record["base_matrix"])
        answers = {result.name: result.estimate for result in found.comparison.results}
        (methods, held, fitted) = (cells(one) for one in tables(report, "methods"))
        for one in record["methods"]:
            if one["failure"] is not None:
                assert methods[one["name"]] == ["failed", "–", "–", "–", "–", methods[one["name"]][-1]]
                continue
            answer = answers[one["name"]]
            assert (one["remarks"], one["settings"]) == (list(answer.remarks), dict(answer.settings))
            x, base = np.array(one["parameters"]), np.array(one["base_values"])
            np.testing.assert_allclose(base, b @ x, rtol=1e-9, atol=1e-9)
            for rows, name, table in ((fit, "training", fitted), (held_out, "held_out", held)):
                errors, moves = rows.regressor @ x - rows.tau, np.abs(rows.v) > 0.02
                everything, moving = one[name]["everything"], one[name]["moving"]
                for sizes, which in ((everything, np.ones_like(moves)), (moving, moves)):
                    count = which.sum(axis=0)
                    of_these = np.where(which, errors, 0)
                    np.testing.assert_array_equal(sizes["count"], count)
                    np.testing.assert_allclose(sizes["rms"], np.sqrt((of_these**2).sum(axis=0) / count), rtol=1e-6)
                    np.testing.assert_allclose(sizes["mean"], of_these.sum(axis=0) / count, rtol=1e-4, atol=1e-7)
                    np.testing.assert_allclose(sizes["largest"], np.abs(of_these).max(axis=0), rtol=1e-6)
                    np.testing.assert_allclose(sizes["relative"], relative(errors, rows.tau, which), rtol=1e-6)
                watson = (np.diff(errors, axis=0) ** 2).sum(axis=0) / (errors**2).sum(axis=0)
                np.testing.assert_allclose(one[name]["durbin_watson"], watson, rtol=1e-4)
                for said, rms, part in zip(table[one["name"]], everything["rms"], moving["relative"], strict=True):
                    assert [float(text) for text in said.split(" / ")] == [
                        pytest.approx(rms, rel=THREE_DIGITS), pytest.approx(100 * part, abs=0.051)
                    ]  # fmt: skip
            errors = held_out.regressor @ x - held_out.tau
            mean = relative(errors, held_out.tau, np.abs(held_out.v) > 0.02).mean()
            assert one["mean_error"] == pytest.approx(mean, rel=1e-6)
            np.testing.assert_allclose(
                one["fitted_relative"], relative(fit.regressor @ x - fit.tau, fit.tau), rtol=1e-6
            )
            bodies = x[:30].reshape(3, 10)
            eigenvalues = [smallest_eigenvalue(ten) for ten in bodies]
            np.testing.assert_allclose(one["pseudo_inertia_eigenvalues"], eigenvalues, rtol=1e-6, atol=1e-9)
            assert one["consistent"] == (min(eigenvalues) >= 0)
            said = methods[one["name"]]
            assert float(said[1]) == pytest.approx(100 * mean, abs=0.0051)
            assert said[2] == f"{(np.array(eigenvalues) >= 0).sum()} of 3"
            assert said[3] == f"{one['positive_definite']} of {identified_arm.POSES}"
            assert one["poses"] == identified_arm.POSES
            assert float(said[4]) == pytest.approx(one["smallest_mass_matrix_eigenvalue"], rel=TWO_DIGITS)
            assert (one["positive_definite"] == one["poses"]) == (one["smallest_mass_matrix_eigenvalue"] > 0)
            if one["block_deviations"] is not None:
                percent = 100 * np.array(one["block_deviations"]) / np.abs(base)
                np.testing.assert_allclose(one["relative_deviations"], percent, rtol=1e-9)
        assert not all(one["consistent"] in (True, None) for one in record["methods"])
        said = next(block for block in section(report, "methods").blocks if block.title == "What the methods say")
        assert [(note.where, note.text) for note in said.notes] == [
            (one["name"], remark) for one in record["methods"] for remark in one["remarks"]
        ]
        assert len(said.notes) >= 3

    def test_smallest_mass_matrix(self, compared_with_truth):
        """No pose can have a smaller eigenvalue than the smallest of many; of some poses it is near that."""
        found, record, *_ = compared_with_truth
        model = found.torque_model.model
        q, _ = model.random_state(np.random.default_rng(1), 2000)
        for name in ("OLS", "consistent"):
            (one,) = (one for one in record["methods"] if one["name"] == name)
            changed = model.with_inertial_parameters(np.array(one["parameters"][:30]))
            lowest = np.linalg.eigvalsh(graphdyn.mass_matrix(changed, q))[:, 0]
            assert lowest.min() * 0.999 <= one["smallest_mass_matrix_eigenvalue"] <= np.median(lowest)

    def test_least_squares(self, compared_with_truth):
        """OLS and WLS, with the deviations that belong to white noise."""
        _, record, _, fit, _ = compared_with_truth
        of = {one["name"]: one for one in record["methods"]}
        columns = np.linalg.pinv(np.array(record["base_matrix"]))
        w = fit.regressor @ columns
        for name, weight in (("OLS", np.ones(3)), ("WLS", 1 / np.array(of["WLS"]["noise"]))):
            scaled, right = ((x * weight[:, None] if x.ndim == 3 else x * weight) for x in (w, fit.tau))
            scaled, right = scaled.reshape(-1, w.shape[-1]), right.ravel()
            solution = np.linalg.lstsq(scaled, right, rcond=None)[0]
            size = np.abs(solution).max()
            np.testing.assert_allclose(
                of[name]["base_values"], solution, rtol=0, atol=(1e-6 if name == "OLS" else 1e-4) * size
            )
        covariance = np.linalg.inv(scaled.T @ scaled)
        np.testing.assert_allclose(of["WLS"]["standard_deviations"], np.sqrt(np.diag(covariance)), rtol=1e-3)
        errors = w @ np.array(of["WLS"]["base_values"]) - fit.tau
        np.testing.assert_allclose(of["WLS"]["noise"], np.sqrt((errors**2).mean(axis=0)), rtol=0.01)

    def test_identifiability(self, compared_with_truth):
        """Rank and condition number of the regressor, joints weighted by their torque, columns at unit length."""
        found, record, report, fit, held_out = compared_with_truth
        assert record["rank"] == np.linalg.matrix_rank(fit.regressor.reshape(-1, 36), tol=1e-6)
        weighted = fit.regressor / np.sqrt((fit.tau**2).mean(axis=0))[:, None]
        base = weighted.reshape(-1, 36) @ np.linalg.pinv(np.array(record["base_matrix"]))
        unit = base / np.linalg.norm(base, axis=0)
        values = np.linalg.svd(unit, compute_uv=False)
        assert record["condition_number"] == pytest.approx(values[0] / values[-1], rel=1e-6)
        facts = dict(block_of(report, "recording", Facts).items)
        assert facts["condition number"].startswith(f"{values[0] / values[-1]:.3g}, ")
        rank, structural = record["rank"], record["structural_rank"]
        assert (
            facts["parameters"]
            == f"36; {structural} combinations are identifiable, and this motion determines all {rank}"
        )
        assert facts["fitted"].startswith(f"{len(fit.tau)} rows of ")
        assert facts["held out"].endswith(f", {len(held_out.tau)} rows")
        rows = record["recording"]
        assert (rows["fitted_rows"], rows["held_out_rows"]) == (len(fit.tau), len(held_out.tau))
        np.testing.assert_allclose(_singular_values(found), values, rtol=1e-6)
        symbols = [one["symbol"] for one in record["base_parameters"]]
        friction = {"viscous": "FV", "coulomb": "FC"}
        for group in record["excitation"]:
            own = [k for k, symbol in enumerate(symbols) if belongs(symbol, group["name"], friction)]
            q, _ = np.linalg.qr(np.delete(unit, own, axis=1))
            left = unit[:, own] - q @ (q.T @ unit[:, own])
            assert (group["determined"], group["structural"]) == (len(own), len(own))
            assert group["weakest"] == pytest.approx(np.linalg.svd(left, compute_uv=False)[-1], rel=1e-6)
            determined, weakest = cells(tables(report, "excitation")[0])[group["name"]]
            assert determined == f"{len(own)} of {len(own)}"
            assert float(weakest) == pytest.approx(group["weakest"], rel=TWO_DIGITS)

    def test_parameters(self, compared_with_truth):
        """Values of CAD and of the truth from the names of the base parameters; links from what was found."""
        found, record, report, fit, _ = compared_with_truth
        shown = record["shown"]
        (result,) = (one for one in record["methods"] if one["name"] == shown["method"])
        names = [one["symbol"] for one in record["parameters"]]
        bodies = found.torque_model.model.bodies
        prior = dict(zip(names, [*np.concatenate([body.parameters for body in bodies]), *6 * [0]], strict=True))
        truth = dict(zip(names, record["truth"], strict=True))
        source = next(
            one for one in record["methods"] if one["name"] == re.match(r"of (\S+?)(?:,|$)", shown["deviations"])[1]
        )
        base, links = tables(report, "parameters")
        base, links = cells(base), cells(links)
        for k, one in enumerate(shown["base_parameters"]):
            assert one["value"] == result["base_values"][k]
            assert one["cad"] == pytest.approx(evaluated(one["name"], prior), rel=1e-3, abs=2e-3)
            assert one["truth"] == pytest.approx(evaluated(one["name"], truth), rel=1e-3, abs=2e-3)
            assert one["error"] == pytest.approx(one["value"] - one["truth"])
            deviations = (source["standard_deviations"][k], source["block_deviations"][k])
            assert (one["deviation"], one["block_deviation"]) == deviations
            assert one["relative_deviation"] == pytest.approx(100 * deviations[1] / abs(one["value"]))
            assert one["unit"] == unit_of(one["name"].split()[0], found.torque_model.model)
            *numbers, unit, symbol = base[one["name"]]
            assert (unit, symbol) == (one["unit"], record["base_parameters"][k]["symbol"])
            wanted = [one[name] for name in ("cad", "truth", "value", "error")]
            assert [float(x) for x in numbers[:4]] == pytest.approx(wanted, rel=FOUR_DIGITS)
            assert [float(x) for x in numbers[4:]] == pytest.approx(
                [*deviations, one["relative_deviation"]], rel=TWO_DIGITS
            )
        found_bodies = np.array(result["parameters"][:30]).reshape(3, 10)
        for one, body, ten in zip(shown["bodies"], bodies, found_bodies, strict=True):
            assert list(one["identified"].items()) == list(zip(TEN, ten.tolist(), strict=True))
            assert list(one["cad"].values()) == pytest.approx(body.parameters.tolist())
            assert one["center_of_mass"] == pytest.approx((ten[1:4] / ten[0]).tolist())
            assert one["pseudo_inertia_eigenvalue"] == pytest.approx(smallest_eigenvalue(ten), rel=1e-6)
            cad_mass, mass, cad_center, center, eigenvalue = links[one["name"]]
            assert [float(cad_mass), float(mass)] == pytest.approx([body.mass, ten[0]], rel=FOUR_DIGITS)
            assert list(map(float, cad_center.split())) == pytest.approx(body.center_of_mass.tolist(), abs=5.1e-5)
            assert list(map(float, center.split())) == pytest.approx(one["center_of_mass"], abs=5.1e-5)
            assert float(eigenvalue) == pytest.approx(one["pseudo_inertia_eigenvalue"], rel=TWO_DIGITS)
        columns = fit.regressor @ np.linalg.pinv(np.array(record["base_matrix"]))
        sizes = np.sqrt((columns**2).sum(axis=(0, 1)) / fit.tau.size)
        np.testing.assert_allclose(_torque_sizes(found), sizes, rtol=1e-6)

    def test_data_quality(self, compared_with_truth):
        """What is shown of it, and the parts of it that the rows say."""
        _, record, report, fit, _ = compared_with_truth
        of = record["data_quality"]
        np.testing.assert_allclose(of["standstill"], (np.abs(fit.v) <= 0.02).mean(axis=0), atol=2e-3)
        table, visible = tables(report, "data_quality")
        for j, (gain, sign, delay, *parts) in enumerate(cells(table).values()):
            assert [float(x) for x in gain.split(" ± ")] == [
                pytest.approx(of["gain"][j], rel=THREE_DIGITS), pytest.approx(of["gain_deviation"][j], rel=0.5)
            ]  # fmt: skip
            assert float(sign) == pytest.approx(np.exp(of["sign_cost"][j]) ** (1 / 3), abs=0.0051)
            milliseconds = [1e3 * of["joint_delays"][j], 1e3 * of["joint_delay_deviations"][j]]
            assert [float(x) for x in delay.split(" ± ")] == pytest.approx(milliseconds, abs=0.051)
            wanted = [100 * of[name][j] for name in ("residual", "free_residual", "standstill", "clipped")]
            assert [float(x) for x in parts] == [
                pytest.approx(x, rel=THREE_DIGITS, abs=0.51 * (k > 1)) for k, x in enumerate(wanted)
            ]
        assert f"{1e3 * of['delay']:.1f} ± {1e3 * of['delay_deviation']:.1f} ms" in table.caption
        smallest = of["visible"]
        names = {"zeros": 1, "gear_ratios": 100, "torque_gains": 100, "torque_drifts": 100, "delays": 1e3}
        for j, parts in enumerate(cells(visible).values()):
            for shown, (name, unit) in zip(parts, names.items(), strict=True):
                value = smallest[name][j]
                assert shown == "–" if value is None else float(shown) == pytest.approx(unit * value, rel=0.06)
        assert f"turned by {smallest['tilt']:.2g}°, a clock wrong by {100 * smallest['clock']:.2g} %" in visible.caption

    def test_plots(self, compared_with_truth):
        _, record, report, fit, held_out = compared_with_truth
        (result,) = (one for one in record["methods"] if one["name"] == record["shown"]["method"])
        plots = [block for block in section(report, "torques").blocks if isinstance(block, Plot)]
        for j in range(3):
            for plot, rows in zip(plots[2 * j : 2 * j + 2], (fit, held_out), strict=True):
                predicted = (rows.regressor @ np.array(result["parameters"]))[:, j]
                size = np.abs(rows.tau[:, j]).max()
                series = [one.y for panel in plot.panels for one in panel.series]
                for y, own in zip(series, (rows.tau[:, j], predicted, predicted - rows.tau[:, j]), strict=True):
                    np.testing.assert_allclose(y, own, rtol=0, atol=1e-8 * size)
                rms = np.sqrt(((predicted - rows.tau[:, j]) ** 2).mean())
                said = re.fullmatch(rf"{len(predicted)} rows, root mean square error (\S+) N(?: m)?", plot.caption)[1]
                assert float(said) == pytest.approx(rms, rel=THREE_DIGITS)


def test_whole(found, report):
    record = plain(identify_record(found, None, []))
    searched = ("iterations", "strength", "gap")  # other ones on other processors, where results are alike
    approve_record("identify", record, without=("versions", "seconds", *searched))
    approve_result("identify", found, without=("model", "seconds", "others", *searched))
    approve_report("identify", report, rounding="CAD links: WLS .*3 of 3|Smallest accepted pivot")  # a time; pivots
