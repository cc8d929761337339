"""The page of a comparison: complete, self-contained, reproducible, and usable in a browser."""

import dataclasses
import hashlib
import html
import math
import re
import subprocess
import sys
from base64 import b64encode
from pathlib import Path

import numpy as np
import pytest
from faults.judged_functions import DIAGNOSIS, judged, judgment, judgment_page
from lxml import etree
from planting import compared
from shown.axe import AXE, violations
from shown.browser import CHROMIUM, too_wide
from shown.driven_browser import DrivenBrowser
from shown.pages import COMMAND, balanced, comparison_page, complaints, opened, parsed, rows, snippets

import crosscheck
import urdf
from crosscheck.report.records.record import versions

LARGEST, LARGEST_FURTHER = 300_000, 120_000
"""Bytes of the page of one small robot, and of every further robot that agrees."""


@pytest.fixture(scope="module")
def page(small_comparison):
    return comparison_page([small_comparison], COMMAND)


class TestComparison:
    def test_every_quantity_with_its_numbers(self, page, small_comparison):
        table = rows(page, "Largest relative errors")
        assert list(table) == list(small_comparison.quantities)
        for name, result in small_comparison.quantities.items():
            quantity = result.quantity
            expected = [
                "✓ agrees",
                f"{result.max_relative_error:.1e}",
                f"{quantity.tolerance.bound:.1e}",
                quantity.against,
                f"{result.worst.case} ({result.worst.route})" if result.worst else "all states",
                quantity.scale,
            ]
            assert table[name] == expected

    @pytest.mark.usefixtures("unpictured")
    def test_overview(self, small_comparison, wrong_comparison):
        table = rows(comparison_page([small_comparison, wrong_comparison], COMMAND), "The verdict on every robot")
        assert set(table) == {"small.urdf", wrong_comparison.robot}
        assert table["small.urdf"][0] == "✓ agrees"
        assert table[wrong_comparison.robot][0] == "✗ DISAGREES"

    def test_versions_and_command(self, page):
        text = html.unescape(page)
        assert "graphdyn crosscheck 'my arm.urdf' --html page.html" in text
        for library, number in versions().items():
            assert f"<dt>{library}</dt><dd>{number}</dd>" in text

    def test_conditioning_and_base_parameters(self, page, small_comparison):
        table = rows(page, "Smallest and largest over all states")
        assert table["φ_q, constraints"][:2] == ["15", "15"]
        assert table["KKT, Eq. (111)"][:2] == ["33", "33"]
        assert f"{small_comparison.conditioning.mass_matrix_condition[1]:.3g}" in table["M, mass matrix"][-1]
        assert f"{small_comparison.identification.rank} with our regressor" in page

    def test_full_path_in_the_detail_only(self, page, small_comparison):
        assert "<h2>small.urdf: " in page
        assert f"<dd>{small_comparison.robot}</dd>" in page
        assert f"<p>{small_comparison.robot}: 3 joints; " in page

    def test_disagreement_comes_first(self, wrong_comparison):
        text = comparison_page([wrong_comparison], COMMAND)
        verdicts = [row[0] for row in rows(text, "Largest relative errors").values()]
        assert verdicts == sorted(verdicts, key=lambda verdict: verdict != "✗ DISAGREES")
        assert 0 < verdicts.count("✗ DISAGREES") < len(verdicts)
        assert "<title>graphdyn against Pinocchio on tree7: DISAGREES</title>" in text
        assert "✗ joint_wrench" in text  # in the picture

    @pytest.mark.usefixtures("unpictured")
    def test_notes_and_what_was_left_out(self, small_comparison):
        changed = dataclasses.replace(
            small_comparison, notes=("a note",), not_compared={"x": "why", "y": "why", "z": "other"}
        )
        text = comparison_page([changed], COMMAND)
        assert "<li>a note</li>" in text
        assert "<li>not compared: x, y: why</li>" in text
        assert "<li>not compared: z: other</li>" in text

    def test_failures_and_nothing_else(self):
        text = comparison_page([], COMMAND, [{"robot": "nonsense", "message": "is not a file"}])
        assert "<strong>nonsense</strong>: is not a file" in text
        assert "<title>graphdyn against Pinocchio: incomplete</title>" in text

    @pytest.mark.usefixtures("unpictured")
    def test_locked_joints(self, small_comparison):
        assert "locked: grip = 0.25" in " ".join(
            comparison_page(
                [dataclasses.replace(small_comparison, reading=urdf.Reading(lock={"grip": 0.25}))], COMMAND
            ).split()
        )

    @pytest.mark.usefixtures("unpictured")
    def test_infinite_error_and_missing_identification(self, small_comparison):
        torque = small_comparison.quantities["inverse_dynamics"]
        broken = dataclasses.replace(torque, errors=np.array([math.inf]), max_relative_error=math.inf)
        quantities = {**small_comparison.quantities, "inverse_dynamics": broken}
        text = comparison_page(
            [dataclasses.replace(small_comparison, quantities=quantities, identification=None)], COMMAND
        )
        first, cells = next(iter(rows(text, "Largest relative errors").items()))
        assert first == "inverse_dynamics"
        assert cells[:3] == ["✗ DISAGREES", "∞", "1.0e-13"]
        assert "Not identified: the robot has no mass." in text


class TestForm:
    @pytest.mark.parametrize("text", [lambda page: page, opened], ids=["closed", "opened"])
    def test_well_formed(self, page, text):
        assert complaints(text(page)) == []
        assert balanced(text(page))

    def test_ids_are_unique_and_references_lead_somewhere(self, small_comparison, wrong_comparison):
        text = comparison_page([small_comparison, wrong_comparison], COMMAND)
        ids = re.findall(r'\bid="([^"]+)"', text)
        assert len(set(ids)) == len(ids)
        targets = re.findall(r'href="#([^"]+)"', text) + re.findall(r"url\(#([^)]+)\)", text)
        assert targets
        assert set(targets) <= set(ids)

    def test_nothing_is_fetched(self, page):
        written = {"http://www.w3.org/2000/svg", "https://github.com/leeoniya/uPlot"}  # a namespace, the head of uPlot
        assert set(re.findall(r"""https?://[^"'\s<)]*""", page)) == written
        root = parsed(page)
        assert not root.xpath("//link | //img | //iframe | //script[@src] | //style[contains(., '@import')]")

    def test_semantics(self, page):
        root = parsed(opened(page))
        assert root.get("lang") == "en"
        assert len(root.xpath("//h1")) == 1
        assert all(table.find("caption") is not None for table in root.iter("table"))
        assert all(cell.get("scope") in ("row", "col") for cell in root.iter("th"))
        pictures = root.xpath("//svg")
        assert len(pictures) == 3
        assert all(svg.get("role") == "img" and svg.get("aria-label") for svg in pictures)
        assert all("<text" in etree.tostring(svg, encoding="unicode") for svg in pictures)
        assert all(button.get("hidden") is not None for button in root.iter("button"))  # until the script runs

    def test_the_same_input_gives_the_same_page(self, page, small_comparison):
        """Whatever the settings of the user are."""
        import matplotlib

        assert not re.search(r"20\d\d-\d\d-\d\d", page)
        with matplotlib.rc_context({"font.size": 30, "svg.fonttype": "path", "axes.facecolor": "red"}):
            assert comparison_page([small_comparison], COMMAND) == page
            assert matplotlib.rcParams["font.size"] == 30

    def test_size(self, page, small_comparison):
        assert len(page.encode()) < LARGEST
        two, three = (len(comparison_page(n * [small_comparison], COMMAND).encode()) for n in (2, 3))
        assert three - two < LARGEST_FURTHER

    def test_what_is_compressed_is_all_there(self, small_comparison):
        """Of one robot programs and picture; of several that agree everything below their verdicts."""
        one, two = (comparison_page(n * [small_comparison], COMMAND) for n in (1, 2))
        assert len(snippets(one)) == 1
        assert len(snippets(opened(one))) == sum(bool(r.worst) for r in small_comparison.quantities.values())
        assert "Joints and bodies" not in two
        assert opened(two).count("<summary>Joints and bodies</summary>") == 2

    @pytest.mark.usefixtures("random_states_alone")
    def test_names_are_escaped(self, tree):
        name = "<b>\"arm\" & 'co'</b><script>alert(1)</script>"
        joints = (dataclasses.replace(tree.joints[0], name="<i>$j</i>"), *tree.joints[1:])
        comparison = compared(dataclasses.replace(tree, name=name, joints=joints))
        few = {quantity: comparison.quantities[quantity] for quantity in ("inverse_dynamics", "forward_dynamics")}
        comparison = dataclasses.replace(comparison, quantities=few)
        text = comparison_page([comparison], ["graphdyn", name], [{"robot": "<u>", "message": "<s> & 'x'"}])
        for forbidden in ("<b>", "<i>$", "<u>", "<s>", "<script>alert"):
            assert forbidden not in text
        assert "&lt;b&gt;" in text
        assert balanced(text)

    def test_templates_are_installed(self):
        folder = Path(crosscheck.__file__).parent / "report"
        assert {"page.html", "blocks.html", "style.css", "page.js", "plots.js"} <= {
            path.name for path in (folder / "page").iterdir()
        }

    def test_the_vendored_library_is_the_published_one(self):
        """uPlot 1.6.32 as its authors published it, three.js as build.sh makes it: neither is changed."""
        folder = Path(crosscheck.__file__).parent / "vendor"
        published = dict(line.split()[::-1] for line in (folder / "SHA256").read_text(encoding="utf-8").splitlines())
        vendored = [*folder.glob("*.LICENSE"), *folder.glob("*.min.*")]
        assert {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in vendored} == published
        for name in ("uPlot", "three"):
            assert "The MIT License" in (folder / f"{name}.LICENSE").read_text(encoding="utf-8")

    def test_scripts_are_those_of_the_policy(self, page):
        """The content security policy names the hash of each script, and allows nothing to be evaluated."""
        (policy,) = parsed(page).xpath("//meta[@http-equiv='Content-Security-Policy']/@content")
        scripts = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
        hashes = {b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts}
        assert {f"'sha256-{x}'" for x in hashes} == set(re.search("script-src(.*)", policy).group(1).split())
        assert "unsafe-eval" not in policy
        assert not any(re.search(r"\beval\(|new Function", script) for script in scripts)

    def test_matplotlib_is_not_imported_early(self):
        code = "import sys, crosscheck, crosscheck.report.html; sys.exit('matplotlib' in sys.modules)"
        assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
def test_in_a_browser(tmp_path, wrong_comparison, tree):
    """No page is wider than its window, no script fails, and axe-core finds nothing."""
    function = judged(tree, "joint_torque_regressor", 1.5)
    verdict = judgment(tree, function, diagnoses=(DIAGNOSIS,))
    pages = {
        "wrong.html": comparison_page([wrong_comparison], COMMAND),
        "judged.html": judgment_page(verdict),
    }
    assert too_wide(pages, tmp_path) == []
    if AXE is not None:
        with DrivenBrowser(tmp_path / "profile") as browser:
            for name in pages:
                browser.load((tmp_path / name).as_uri(), "0")
                assert violations(browser) == []
