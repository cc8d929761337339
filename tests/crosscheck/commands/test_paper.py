"""What graphdyn paper says: on the terminal, as a page, as JSON."""

import dataclasses
import json
import math
import re

import numpy as np
import pytest
from faults.planted_records import planted
from jsonschema import Draft202012Validator
from long_check import LONG
from matplotlib.figure import Figure
from reproduced_paper import SAMPLES, reproduced
from rich.cells import cell_len
from shared_data import REPOSITORY
from shown.approved import approve_report
from shown.browser import CHROMIUM, too_wide
from shown.pages import complaints, parsed, table
from typer.testing import CliRunner

from crosscheck.commands import app
from crosscheck.commands.errata import report as errata_report
from crosscheck.commands.paper import identification_report
from crosscheck.commands.paper.identification_report import error_text, misprints, printed_text, value_text
from crosscheck.commands.paper.multipliers_report import MARKED_SAMPLE_INTERVAL
from crosscheck.commands.paper.record import record as record_of
from crosscheck.commands.paper.report import _draw_cylinder, paper_report
from crosscheck.commands.program import console
from crosscheck.paper.printed import TABLE_2, Printed
from crosscheck.paper.reproduction import PROGRESS_STEPS, REFERENCE_BOUND, Check, reproduce
from crosscheck.report.html import page as html_page
from crosscheck.report.records.record import plain, taking_part, versions
from crosscheck.report.report import Plot
from crosscheck.report.text import renderables

ROOT = REPOSITORY
SCHEMA = json.loads((ROOT / "docs/schemas/paper-1.schema.json").read_text(encoding="utf-8"))
COMMAND = ["graphdyn", "paper", "--samples", str(SAMPLES), "--html", "page.html", "--json", "r.json"]
NARROW = 80

LARGEST = 1_000_000
"""Bytes of the page."""


@pytest.fixture(scope="module")
def found():
    return reproduced()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the command writes, in its working folder."""
    folder = tmp_path_factory.mktemp("paper")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("sys.argv", COMMAND)
        done = CliRunner().invoke(app, COMMAND[1:])
    assert done.exit_code == 0, done.stderr
    (folder / "said").write_text(done.stdout, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def page(folder):
    return (folder / "page.html").read_text(encoding="utf-8")


def paper(*arguments):
    return CliRunner().invoke(app, ["paper", "--samples", "10", *map(str, arguments)])


def shown(found, monkeypatch, width=console.LINE_CHARACTERS):
    """What the terminal shows at this width."""
    monkeypatch.setattr(console.out, "width", width)
    with console.out.capture() as captured:
        for part in renderables(paper_report(found), width):
            console.out.print(part)
    return captured.get()


@pytest.mark.parametrize("upward", [1.0, -1.0])
def test_a_cylinder_shows_its_upper_end(upward):
    """Who looks from above sees it, wherever its origin is."""
    axes = Figure().add_axes((0, 0, 1, 1))
    _draw_cylinder(axes, np.zeros(3), np.array([[0, 0, 1.0], [0, 1, 0], [upward, 0, 0]]), 2.0, 0.1)
    outline, end = (patch.get_xy() for patch in axes.patches)
    assert end[:, 1].max() == pytest.approx(outline[:, 1].max())
    assert end[:, 1].min() > outline[:, 1].min() + 1.0


class TestText:
    def test_order_of_the_paper(self, found, monkeypatch):
        said = shown(found, monkeypatch)
        titles = ["What holds", "Table 2", "The experiment of section 3.1", "Tables 3 and 4", "Table 3", "Table 4",
                  "Section 3.2 as printed", "Section 3.2 corrected", "Over the whole motion",
                  "What the printed errors do"]  # fmt: skip
        places = [said.index(f"\n{title}") for title in titles]
        assert places == sorted(places)

    def test_contents(self, found, monkeypatch):
        said = shown(found, monkeypatch)
        assert "5.4619 B5" in said
        assert re.search(r"λ_33 +2\.393758e4 B6 +-2\.393758e\+04 +7 +reproduced", said)
        assert "2.393758e4 is a misprint for -2.393758e4 (B6)." in " ".join(said.split())
        assert re.search(r"λ_24 +-1\.233380e11 +– +not determined: .* \(A2\)", said)
        assert re.search(r"λ_14 .*not reproduced", said)
        assert re.search(r"λ_61 +1\.356146e-4 +0 +zero; the paper prints rounding", said)
        assert re.search(r"J_22 +printed +982\.8120", said)
        assert said.startswith("The paper beside the corrected model: every check holds\n")
        assert "Every number that the text determines is reproduced within its bound" in said
        for sentence in found.corrected.reading:
            assert sentence[:60] in said

    def test_tables_of_the_paper_fit_into_80_characters(self, found, monkeypatch):
        """None of them is taken apart or cut."""
        said = shown(found, monkeypatch, NARROW)
        assert max(map(cell_len, said.splitlines())) <= NARROW
        assert "…" not in said.replace("A1, A3 …", "")
        assert len(re.findall(r"parameter +source +B_1 +B_2 +B_3 +B_4 +B_5 +B_6\n", said)) == 3

    def test_failure_is_said(self, found, monkeypatch):
        broken = dataclasses.replace(found, checks=(Check("here", "this", 2.0, 1.0, "because"),))
        said = shown(broken, monkeypatch)
        assert "1 of 1 checks DO NOT HOLD" in said
        assert "DOES NOT HOLD" in said
        assert "Not every number is within its bound" in said

    def test_numbers(self):
        assert value_text(-0.00001) == "0.0000"
        assert value_text(math.nan) == error_text(math.nan) == printed_text(Printed(None)) == "–"
        assert (error_text(0.0), error_text(-3.4e-13)) == ("0", "-3e-13")
        assert misprints([Printed("1"), Printed("2", "3", "B9")]) == "2 is a misprint for 3 (B9)."


class TestCommand:
    def test_everything(self, folder, page):
        assert "Table 3" in (folder / "said").read_text(encoding="utf-8")
        record = json.loads((folder / "r.json").read_text(encoding="utf-8"))
        Draft202012Validator(SCHEMA).validate(record)
        assert record["format"] == "graphdyn paper 1"
        assert record["errata"]["samples"] == SAMPLES
        assert "<h1>The paper beside the corrected model</h1>" in page

    def test_failure_is_exit_code_1(self, found, monkeypatch):
        broken = dataclasses.replace(found, checks=(Check("here", "this", 2.0, 1.0, "because"),))
        monkeypatch.setattr("crosscheck.paper.reproduction.reproduce", lambda *_: broken)
        assert paper().exit_code == 1

    def test_bad_input(self, tmp_path):
        done = paper("--html", tmp_path)
        assert done.exit_code == 2
        assert "is a folder" in done.stderr
        assert CliRunner().invoke(app, ["paper", "--samples", "9"]).exit_code == 2

    def test_progress(self):
        """Each part once, in order."""
        said = []
        reproduce(10, progress=said.append)
        assert tuple(said[: len(PROGRESS_STEPS)]) == PROGRESS_STEPS
        assert said[len(PROGRESS_STEPS)] == "A1 on kr500"


class TestRecord:
    def test_follows_the_schema(self, found):
        record = plain(record_of(found, COMMAND))
        Draft202012Validator(SCHEMA).validate(json.loads(json.dumps(record, allow_nan=False)))

    @pytest.mark.parametrize("number", [math.nan, math.inf])
    def test_every_number_that_may_be_null(self, found, number):
        record = plain(planted(record_of(found, COMMAND), SCHEMA, number))
        assert record["corrected"]["difference"] is None
        Draft202012Validator(SCHEMA).validate(record)

    def test_a_number_that_is_none(self, found):
        broken = dataclasses.replace(found, checks=(Check("here", "this", math.nan, 1.0, "because"),))
        record = plain(record_of(broken, COMMAND))
        assert (record["agrees"], record["checks"][0]["measured"]) == (False, None)

    def test_undetermined_and_misprinted(self, found):
        record = plain(record_of(found, COMMAND))
        assert [row[0] for row in record["identification"]["trials"][0]["values"].values()].count(None) == 3
        assert record["identification"]["table_3"]["J_33"][3] == {
            "printed": "5.4619",
            "reading": "5.6419",
            "erratum": "B5",
        }
        assert record["identification"]["table_3"]["m(e_2)"][0]["printed"] is None


class TestPage:
    def test_tables(self, found, page):
        table_2 = table(page, "from 7801 kg/m³")
        assert table_2[4] == ["m [kg]", "printed", *(number.text for number in TABLE_2.rows["m [kg]"])]
        assert table_2[5] == ["", "graphdyn", *found.geometry.texts[2]]
        table_3 = table(page, "Table 3 [kg")
        assert len(table_3) == 18
        assert table_3[15][:3] == ["J_33", "printed", "982.8120"]
        assert table_3[15][5] == "5.4619 B5"
        assert "5.4619 is a misprint for 5.6419 (B5)." in page
        assert table_3[16][:3] == ["", "exact data", "–"]
        assert len(table(page, "Table 4 [kg")) == 18
        assert len(table(page, "Over the 33 entries")) == 3 + len(found.identification.rounded)

    def test_section_3_2(self, found, page):
        printed = {row[0]: row[1:] for row in table(page, "Eq. (113)-(118)")}
        assert list(printed) == [number.name for number in found.numbers]
        assert printed["λ_33"][:3] == ["2.393758e4 B6", "-2.393758e+04", "7"]
        assert "2.393758e4 is a misprint for -2.393758e4 (B6)." in page
        assert printed["λ_24"][1] == "–"
        corrected = table(page, "All thirty multipliers")
        assert len(corrected) == 12
        assert corrected[0][2:] == corrected[1][2:]
        assert [row[0] for row in table(page, "tan 33.75°")] == ["2", "3", "5"]

    def test_checks_and_errata(self, found, page):
        assert [row[1] for row in table(page, "Each number with its bound")] == ["✓ holds"] * len(found.checks)
        assert len(table(page, "Quantiles")) == len(found.effects)

    def test_failure(self, found):
        broken = dataclasses.replace(found, checks=(Check("here", "this", math.nan, 1.0, "because"),))
        whole = paper_report(broken)
        html = html_page(dataclasses.replace(whole, sections=whole.sections[:1]), COMMAND, versions())
        assert "✗ 1 of 1 checks do not hold." in html
        assert "Not every number is" in html
        assert table(html, "Each number with its bound")[0] == [
            "here",
            "✗ DOES NOT HOLD",
            "this",
            "–",
            "≤ 1",
            "because",
        ]

    def test_pictures(self, page):
        labels = re.findall(r'<svg[^>]*aria-label="([^"]*)"', page)
        starts = ["Figure 2", "Figure 11", "Figure 10", "Absolute errors", *(f"Joint {j}" for j in range(1, 7)),
                  "Distribution", "A3", "A2"]  # fmt: skip
        assert [label.startswith(start) for label, start in zip(labels, starts, strict=True)] == [True] * len(starts)
        assert "joint 1 at 33.75°, joint 2 at -33.75°, carriage at 2.25 m" in labels[1]
        for joint in range(1, 7):
            for number in range(1, 6):
                assert f">λ_{joint}{number}</text>" in page

    def test_curves_over_the_motion(self, found):
        """Every tenth sample of rnea lies on graphdyn's line."""
        (section,) = [one for one in paper_report(found).sections if one.key == "over-time"]
        plots = [block for block in section.blocks if isinstance(block, Plot)]
        motion = found.over_time
        assert [plot.title for plot in plots] == [f"Joint {j}" for j in range(1, 7)]
        for j, plot in enumerate(plots):
            assert np.array_equal(plot.x, motion.recording.time)
            for panel in plot.panels:
                assert [one.style for one in panel.series] == ["line"] * 3 + ["marks"] * 3
                scale = max(np.abs(one.y).max() for one in panel.series[:3])
                for line, marks in zip(panel.series[:3], panel.series[3:], strict=True):
                    assert np.array_equal(
                        np.flatnonzero(~np.isnan(marks.y)), np.arange(0, len(plot.x), MARKED_SAMPLE_INTERVAL)
                    )
                    assert np.nanmax(np.abs(marks.y - line.y)) <= REFERENCE_BOUND * scale
            expected = np.hstack(
                [motion.multipliers[:, j], motion.recording.tau[:, j, None], motion.recording.joint_moments[:, j]]
            )
            lines = np.column_stack([one.y for panel in plot.panels for one in panel.series[:3]])
            assert np.array_equal(lines, 1e-3 * expected)
            assert [panel.unit for panel in plot.panels] == ["kN", "kN m", "kN m"]

    def test_well_formed(self, page):
        assert complaints(page) == []
        ids = re.findall(r'\bid="([^"]+)"', page)
        assert len(set(ids)) == len(ids)
        assert set(re.findall(r'href="#([^"]+)"', page) + re.findall(r"url\(#([^)]+)\)", page)) <= set(ids)

    def test_needs_nothing_else(self, page):
        written = re.sub(r"<script>.*?</script>", "", page, flags=re.DOTALL)  # a comment of uPlot names its home
        assert set(re.findall(r"""https?://[^"'\s<)]*""", written)) == {"http://www.w3.org/2000/svg"}
        assert "default-src 'none'" in page
        root = parsed(page)
        assert not root.xpath("//link | //img | //iframe | //script[@src]")
        assert len(page.encode()) < LARGEST

    def test_semantics(self, page):
        root = parsed(page)
        assert len(root.xpath("//h1")) == 1
        assert all(one.find("caption") is not None for one in root.iter("table"))
        assert all(cell.get("scope") in ("row", "col", "rowgroup") for cell in root.iter("th"))

    @LONG
    def test_same_arguments_same_page(self, found, page):
        assert html_page(paper_report(found), COMMAND, taking_part()) == page

    @pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
    def test_never_wider_than_its_window(self, tmp_path, page):
        assert too_wide({"page.html": page}, tmp_path) == []


DENSITY = 7801.0
"""Of steel, as in the paper [kg/m³]."""


def significant(printed, ours):
    """Leading digits of seven that a number shares with the printed one, up to half a unit of the last."""
    size = abs(ours - printed) / 10 ** math.floor(math.log10(abs(printed)))
    return next((digits for digits in range(7, 0, -1) if size <= 0.5001 * 10.0 ** (1 - digits)), 0)


def as_read(number):
    """A printed number, misprints corrected; NaN where there is none."""
    return math.nan if number["printed"] is None else float(number["reading"] or number["printed"])


class TestEveryNumber:
    """Of the record and the page, from cylinders, from the printed tables, and from each other's parts."""

    @pytest.fixture
    def record(self, found):
        return plain(record_of(found, COMMAND))

    @staticmethod
    def trials(found):
        of = found.identification
        return of.exact, of.together, *of.rounded

    def test_cylinders(self, record):
        rows = {row["name"].split()[0]: row["ours"] for row in record["table_2"]["rows"]}
        (length, radius), others = list(rows.values())[:2], list(rows.values())[2:]
        length, radius = np.array(length), np.array(radius)
        mass = DENSITY * np.pi * radius**2 * length
        along, across = mass * radius**2 / 2, mass * (3 * radius**2 + length**2) / 12
        for ours, wanted in zip(others, (mass, along, across, across), strict=True):
            assert ours == pytest.approx(wanted.tolist())
        true = record["identification"]["true"]
        for ours, wanted in zip(true.values(), (*3 * [mass], along, across, across), strict=True):
            assert ours == pytest.approx(wanted.tolist())

    def test_identifications(self, found, record, page):
        """Errors, their largest and root mean square over what is compared, and the rows of the tables."""
        of = record["identification"]
        names = list(of["true"])
        true = np.array([of["true"][name] for name in names])
        printed = {
            key: np.array([list(map(as_read, of[key][name])) for name in names]) for key in ("table_3", "table_4")
        }
        exact = np.array([of["trials"][0]["values"][name] for name in names], float)
        compared = np.isfinite(exact) & np.isfinite(printed["table_3"])
        assert of["compared"] == compared.sum() == 33
        errors = np.abs(printed["table_4"][compared])
        assert (of["printed_largest"], of["printed_rms"]) == pytest.approx((errors.max(), np.sqrt((errors**2).mean())))
        rows = table(page, "Over the 33 entries")
        assert rows[0][:3] == ["Table 4", f"{errors.max():.4f}", f"{np.sqrt((errors**2).mean()):.4f}"]
        for k, (trial, row) in enumerate(zip(of["trials"], rows[1:], strict=True)):
            values = np.array([trial["values"][name] for name in names], float)
            own = np.array([trial["errors"][name] for name in names], float)
            np.testing.assert_allclose(own, values - true, atol=1e-12)
            sigma = np.array([trial["standard_deviations"][name] for name in names], float)
            (source,) = [one for one in self.trials(found) if one.data == trial["data"]]
            np.testing.assert_array_equal(sigma, source.standard_deviations)
            if k >= 2:  # rounded: errors are as large as their deviations say
                assert 0.3 < np.sqrt(np.mean((own[compared] / sigma[compared]) ** 2)) < 3
            size = np.abs(own[compared])
            largest, rms = size.max(), np.sqrt((size**2).mean())
            assert (trial["largest"], trial["rms"]) == pytest.approx((largest, rms))
            form = ".1e" if k < 2 else ".4f"
            assert row[:4] == [trial["data"], f"{largest:{form}}", f"{rms:{form}}", str(trial["rank"])]
            assert float(row[4]) == pytest.approx(trial["condition_number"], rel=6e-3)
            assert row[5] == ", ".join(trial["undetermined"])
        for caption, what, form in (("Table 3 [kg", "values", ".4f"), ("Table 4 [kg", "errors", ".0e")):
            lines = table(page, caption)
            for k, name in enumerate(names):
                for line, trial, shape in ((3 * k + 1, of["trials"][0], form), (3 * k + 2, of["trials"][2], ".4f")):
                    for text, value in zip(lines[line][2:], trial[what][name], strict=True):
                        assert (text == "–") if value is None else float(text) == float(f"{value:{shape}}")

    def test_multipliers_as_printed(self, record, page):
        rows = {row[0]: row[1:] for row in table(page, "Eq. (113)-(118)")}
        for number in record["as_printed"]["multipliers"]:
            printed, ours = number["reading"] or number["printed"], number["ours"]
            _, text, digits, meaning = rows[number["name"]]
            assert meaning == number["meaning"]
            if ours is None:
                assert (text, digits) == ("–", "")
                continue
            if number["kind"] == "reproduced":
                assert number["digits"] == significant(float(printed), ours) >= 6
                assert text == f"{ours:.6e}"
            assert digits == (str(number["digits"]) if number["digits"] else "")
        for ratio, row in zip(record["as_printed"]["ratios"], table(page, "tan 33.75°"), strict=True):
            of = {n["name"]: float(n["reading"] or n["printed"]) for n in record["as_printed"]["multipliers"]}
            quotient = of[f"λ_{ratio['joint']}4"] / of[f"λ_{ratio['joint']}5"]
            assert ratio["printed"] == pytest.approx(quotient)
            assert row == [str(ratio["joint"]), f"{quotient:.7f}", f"{ratio['null_vector']:.7f}"]
            assert abs(ratio["null_vector"]) == pytest.approx(np.tan(np.radians(33.75)), rel=1e-6)

    def test_corrected_multipliers(self, record, page):
        ours, there = (np.array(record["corrected"][name]) for name in ("multipliers", "rnea"))
        rows = table(page, "All thirty multipliers")
        for j in range(6):
            for row, values in ((rows[2 * j], ours[j]), (rows[2 * j + 1], there[j])):
                assert row[2:] == [f"{value:.3f}" for value in values]
        parts = [(ours[:, part], there[:, part]) for part in (slice(3), slice(3, 5))]
        differences = [np.abs(x - y).max() / np.abs(y).max() for x, y in parts]
        assert record["corrected"]["difference"] == pytest.approx(max(differences), rel=0.5, abs=1e-14)
        assert f"largest relative difference {record['corrected']['difference']:.1e}" in page

    def test_effects(self, found, record, page):
        rows = table(page, "Quantiles of the printed form")
        for effect, one, row in zip(found.effects, record["errata"]["effects"], rows, strict=True):
            ordered = np.sort(effect.errors)
            place = 0.9 * (len(ordered) - 1)
            low = ordered[int(place)]
            upper = low + (place - int(place)) * (ordered[min(int(place) + 1, len(ordered) - 1)] - low)
            half = (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2]) / 2
            wanted = (half, upper, ordered[-1], effect.corrected_errors.max())
            assert [one[name] for name in ("median", "upper", "largest", "corrected")] == pytest.approx(wanted)
            assert [float(text) for text in row[3:]] == pytest.approx(wanted, rel=0.051)

    def test_checks(self, record, page):
        of, rows = (
            {(check["where"], check["what"]): check["measured"] for check in record["checks"]},
            table(page, "Each number"),
        )
        trials = record["identification"]["trials"]
        measured = {
            ("Table 4", "7-digit data, worst trial: largest absolute error"): max(t["largest"] for t in trials[2:]),
            ("Table 4", "7-digit data, worst trial: root mean square error"): max(t["rms"] for t in trials[2:]),
            ("section 3", "the experiment against rnea at 101 times, relative"): record["over_time"]["difference"],
        }
        for key, value in measured.items():
            assert of[key] == value
        for check, row in zip(record["checks"], rows, strict=True):
            assert row[3] == f"{check['measured']:.2g}"
            assert row[4] == f"{'≥' if check['at_least'] else '≤'} {check['bound']:.3g}"
            sign = 1 if check["at_least"] else -1
            assert check["agrees"] == (sign * (check["measured"] - check["bound"]) >= 0)

    def test_errors_drawn(self, found):
        """Of every parameter of every body: exact data, the first rounding, the band of all, and Table 4."""
        axes, of = Figure().add_axes((0, 0, 1, 1)), found.identification
        identification_report._draw(axes, of)
        rows = {round(y, 6): {} for y in np.arange(36) + 0.5}
        for line in axes.lines:
            rows[round(line.get_ydata()[0], 6)][line.get_marker()] = np.array(line.get_xdata())

        def place(error):
            """Decades; below 1e-8 each has three tenths of its width."""
            decade = np.log10(np.maximum(np.abs(error), 10**-14.5))
            return np.where(decade > -8, decade, -8 + 0.3 * (decade + 8))

        trials = np.abs([trial.errors for trial in of.rounded])
        for body, row in np.ndindex(6, 6):
            drawn, printed = rows[6 * body + row + 0.5], of.printed_errors[row, body]
            if np.isfinite(of.exact.errors[row, body]):
                assert drawn["s"].item() == pytest.approx(place(of.exact.errors[row, body]))
                assert drawn["o"].item() == pytest.approx(place(trials[0, row, body]))
                band = trials[:, row, body].min(), trials[:, row, body].max()
                assert drawn["None"] == pytest.approx(place(np.array(band)))
            assert ("x" in drawn, "<" in drawn) == (bool(np.isfinite(printed) and printed), printed == 0)
            if "x" in drawn:
                assert drawn["x"].item() == pytest.approx(place(printed))

    def test_errata_drawn(self, found, page):
        """Towards gimbal lock: medians by |cos β|; of missing ranks: their shares of the states."""
        lock = [effect for effect in found.effects if effect.erratum == "A3"]
        axes = Figure().add_axes((0, 0, 1, 1))
        errata_report._draw_lock(axes, lock)
        medians = [line for line in axes.lines if line.get_marker() == "None"]
        drawn = [np.column_stack([line.get_xdata(), line.get_ydata()]) for line in medians]
        robots = dict.fromkeys(effect.robot for effect in lock)
        wanted = [[(np.log10(one.cosine), np.median(getattr(one, form))) for one in lock if one.robot == robot]
                  for robot in robots for form in ("errors", "corrected_errors")]  # fmt: skip
        for points, expected in zip(drawn, wanted, strict=True):
            assert points[:, 0] == pytest.approx([x for x, _ in expected])
            assert points[:, 1] == pytest.approx([np.log10(max(y, 1e-17)) for _, y in expected], abs=1e-9)
        ranks = [effect for effect in found.effects if effect.erratum == "A2"]
        axes = Figure().add_axes((0, 0, 1, 1))
        errata_report._draw_rank(axes, ranks)
        said = [text.get_text() for text in axes.texts]
        shares = []
        for effect in ranks:
            for errors in (effect.errors, effect.corrected_errors):
                counts = [int((errors == missing).sum()) for missing in sorted({*errors.tolist()})]
                shares += [f"{count / len(errors):.0%} of {len(errors)} states" for count in counts]
        assert said == shares
        reach = [f"{one.robot} {min(one.errors):.0f} to {max(one.errors):.0f}" for one in ranks]
        assert f'aria-label="A2: missing rank of the printed rows: {"; ".join(reach)}"' in page


def test_whole(found, page):
    approve_report("paper", paper_report(found), rounding="cos β", told=page)
