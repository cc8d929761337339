"""The pages of a comparison and of a judgement: complete, self-contained, reproducible, and usable in a browser."""

import dataclasses
import hashlib
import html
import json
import math
import re
import subprocess
import sys
from base64 import b64encode
from pathlib import Path

import identified_arm
import numpy as np
import pytest
from browser import CHROMIUM, document
from lxml import etree
from planting import SAMPLES, SEED, Plant, compared, with_body
from urdf_text import joint, link, robot_text

import crosscheck
import graphdyn
import urdf
from crosscheck.judging.functions.table import FUNCTIONS
from crosscheck.judging.judgement import Diagnosis, JudgedFunction, Judgement, WorstCall
from crosscheck.referee.comparison import QUANTILES, WorstState
from crosscheck.referee.quantities import BY_NAME
from crosscheck.referee.states import cases
from crosscheck.report.commands.crosscheck import crosscheck_report
from crosscheck.report.commands.identify import identify_report
from crosscheck.report.commands.judge import judge_report
from crosscheck.report.html import page as page_of
from crosscheck.report.json import plain
from crosscheck.report.pictures.spread import SpreadRow, spread
from crosscheck.report.pictures.stick_figure import BENT, pose, pose_text, stick_figure
from crosscheck.report.records.crosscheck import robot_record
from crosscheck.report.report import Plot
from crosscheck.report.snippets import CALLS, worst_state
from crosscheck.report.versions import versions
from graphdyn import Joint, Placement

COMMAND = ["graphdyn", "crosscheck", "my arm.urdf", "--html", "page.html"]
WIDTHS = (1280, 400)
LARGEST = 400_000
"""Characters of the page of one small robot."""

PHYSICAL = 1e-9
"""A planted difference, as a part of the value."""

VOID = {"meta", "br", "hr", "img", "link", "input", "wbr"}


SMALL_ARM = robot_text(
    "small",
    link("base", None),
    link("upper", 2.5, xyz="0.1 0.2 0.3", tensor="0.11 0.01 0.02 0.13 0.03 0.17"),
    link("fore", 1.5, xyz="0 0.1 0.4", rpy="0.3 -0.2 0.7", tensor="0.05 0 0 0.06 0 0.02"),
    link("slider", 0.7, xyz="-0.1 0 0.05", tensor="0.004 0.001 0 0.006 0 0.005"),
    link("tool", 0.2, xyz="0.02 0.01 0.03", tensor="0.0001 0 0 0.0002 0 0.0002"),
    joint(
        "shoulder", "base", "upper", "continuous",
        '<origin xyz="0 0.1 0.5" rpy="0.4 0.3 -1.1"/><axis xyz="0 0.6 0.8"/>',
    ),
    joint(
        "elbow", "upper", "fore", "revolute",
        '<origin xyz="0.3 0 0.1" rpy="1.2 0 0.5"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="2" effort="30" velocity="3"/>',
    ),
    joint(
        "slide", "upper", "slider", "prismatic",
        '<origin xyz="-0.2 0.1 0"/><axis xyz="1 0 0"/><limit lower="-0.3" upper="0.4" effort="30" velocity="1"/>',
    ),
    joint("flange", "fore", "tool", "fixed", '<origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/>'),
)  # fmt: skip


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A file: both routes, a fused tool, a slide."""
    path = tmp_path_factory.mktemp("robots") / "small.urdf"
    path.write_text(SMALL_ARM, encoding="utf-8")
    return compared(path)


@pytest.fixture(scope="module")
def page(small):
    return comparison_page([small], COMMAND)


@pytest.fixture(scope="module")
def wrong(tree):
    """The random tree, heavier in Pinocchio than here."""
    with pytest.MonkeyPatch.context() as patch:
        mass = tree.bodies[0].mass * (1 + PHYSICAL)
        Plant(patch).referee_model(lambda model: with_body(model, 1, mass=mass))
        return compared(tree)


def comparison_page(comparisons, command, failures=()):
    return page_of(crosscheck_report(comparisons, failures), command, versions())


def parsed(text):
    return etree.fromstring(text.encode(), etree.HTMLParser(encoding="utf-8"))


def rows(text, caption):
    """Texts of the cells of the table with this caption, row by row, by the first cell."""
    (table,) = [t for t in parsed(text).iter("table") if caption in "".join(t.xpath("caption//text()"))]
    cells = [[" ".join("".join(c.itertext()).split()) for c in row] for row in table.find("tbody")]
    return {row[0]: row[1:] for row in cells}


def snippets(text):
    """The Python of the page, in its order; the last block is the command."""
    return [html.unescape(code) for code in re.findall(r"<pre><code>(.*?)</code></pre>", text, re.DOTALL)][:-1]


def executed(code, capsys, **names):
    """The names that a snippet leaves, and the last line that it prints as a number."""
    capsys.readouterr()
    exec(compile(code, "<page>", "exec"), names)
    return names, float(capsys.readouterr().out.splitlines()[-1])


class TestComparison:
    def test_every_quantity_with_its_numbers(self, page, small):
        table = rows(page, "Largest relative errors")
        assert list(table) == list(small.quantities)
        for name, result in small.quantities.items():
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

    def test_overview(self, page, small, wrong):
        assert list(rows(page, "The verdict on every robot")) == ["small.urdf"]
        table = rows(comparison_page([small, wrong], COMMAND), "The verdict on every robot")
        assert table["small.urdf"][0] == "✓ agrees"
        assert table[wrong.robot][0] == "✗ DISAGREES"

    def test_versions_and_command(self, page):
        text = html.unescape(page)
        assert "graphdyn crosscheck 'my arm.urdf' --html page.html" in text
        for library, number in versions().items():
            assert f"<dt>{library}</dt><dd>{number}</dd>" in text

    def test_conditioning_and_base_parameters(self, page, small):
        table = rows(page, "Smallest and largest over all states")
        assert table["φ_q, constraints"][:2] == ["15", "15"]
        assert table["KKT, Eq. (111)"][:2] == ["33", "33"]
        assert f"{small.conditioning.mass_matrix_condition[1]:.3g}" in table["M, mass matrix"][-1]
        assert f"{small.identification.rank} with our regressor" in page

    def test_full_path_in_the_detail_only(self, page, small):
        assert "<h2>small.urdf: " in page
        assert f"<dd>{small.robot}</dd>" in page
        assert f"<p>{small.robot}: 3 joints; " in page

    def test_disagreement_comes_first(self, wrong):
        text = comparison_page([wrong], COMMAND)
        verdicts = [row[0] for row in rows(text, "Largest relative errors").values()]
        assert verdicts == sorted(verdicts, key=lambda verdict: verdict != "✗ DISAGREES")
        assert 0 < verdicts.count("✗ DISAGREES") < len(verdicts)
        assert "<title>graphdyn against Pinocchio: DISAGREES</title>" in text
        assert "✗ joint_wrench" in text  # in the picture

    def test_notes_and_what_was_left_out(self, small):
        changed = dataclasses.replace(small, notes=("a note",), not_compared={"x": "why", "y": "why", "z": "other"})
        text = comparison_page([changed], COMMAND)
        assert "<li>a note</li>" in text
        assert "<li>not compared: x, y: why</li>" in text
        assert "<li>not compared: z: other</li>" in text

    def test_failures_and_nothing_else(self):
        text = comparison_page([], COMMAND, [{"robot": "nonsense", "message": "is not a file"}])
        assert "<strong>nonsense</strong>: is not a file" in text
        assert "<title>graphdyn against Pinocchio: incomplete</title>" in text

    def test_locked_joints(self, small):
        assert "locked: grip = 0.25" in " ".join(
            comparison_page([dataclasses.replace(small, locked={"grip": 0.25})], COMMAND).split()
        )

    def test_infinite_error_and_missing_identification(self, small):
        torque = small.quantities["torque"]
        broken = dataclasses.replace(torque, errors=np.array([math.inf]), max_relative_error=math.inf)
        quantities = {**small.quantities, "torque": broken}
        text = comparison_page([dataclasses.replace(small, quantities=quantities, identification=None)], COMMAND)
        first, cells = next(iter(rows(text, "Largest relative errors").items()))
        assert first == "torque"
        assert cells[:3] == ["✗ DISAGREES", "∞", "1.0e-13"]
        assert "Not identified: the robot has no mass." in text


def state_of(model, name):
    """The first state of a case, on the route that Pinocchio takes through the file."""
    case = next(case for case in cases(model, SAMPLES, SEED) if case.name == name)
    tau = None if case.tau is None else tuple(case.tau[0].tolist())
    numbers = (tuple(x[0].tolist()) for x in (case.q, case.v, case.a))
    wrenches = tuple(map(tuple, case.external_wrenches[0].tolist()))
    turn = tuple(map(tuple, case.turn.rotation.tolist()))
    return WorstState("urdf", name, *numbers, tau, wrenches, turn, tuple(case.model.gravity.tolist()))


class TestSnippets:
    @pytest.mark.parametrize("name", CALLS)
    def test_both_sides_of_every_quantity(self, small, name, capsys):
        _, difference = executed(worst_state(small, small.quantities[name]), capsys)
        assert difference < PHYSICAL

    def test_every_quantity_with_a_state_has_one(self, small):
        with_state = {name for name, result in small.quantities.items() if result.worst}
        assert with_state == set(CALLS) == set(BY_NAME) - {"base_parameters"}

    def test_the_first_of_the_page_shows_the_disagreement(self, wrong, tree, plant, capsys):
        """A RobotModel was compared: the reader puts it into `model`."""
        code, *others = snippets(comparison_page([wrong], COMMAND))
        results = [result for result in wrong.quantities.values() if result.worst]
        assert len(others) == len(results) - 1
        worst = max(results, key=lambda result: result.max_relative_error / (result.quantity.tolerance.bound or 1))
        assert not worst.agrees
        names, same = executed(code, capsys, model=tree)
        assert tuple(names["q"].tolist()) == worst.worst.q
        plant.referee_model(lambda model: with_body(model, 1, mass=tree.bodies[0].mass * (1 + PHYSICAL)))
        _, different = executed(code, capsys, model=tree)
        assert same < 1e-3 * PHYSICAL < PHYSICAL < different

    @pytest.mark.parametrize("case", ["gimbal lock of fore", "zero gravity", "torques of a"])
    @pytest.mark.parametrize("name", ["torque", "acceleration_external", "forward_multipliers"])
    def test_turned_weightless_and_balanced_states(self, small, case, name, capsys):
        """The snippet carries the base, the gravity and the torques of its case."""
        state = state_of(small.model, case)
        result = dataclasses.replace(small.quantities[name], worst=state)
        names, difference = executed(worst_state(small, result), capsys)
        np.testing.assert_allclose(names["model"].gravity, state.gravity)
        assert difference < PHYSICAL

    def test_numbers_survive(self, small, capsys):
        result = small.quantities["torque"]
        names, _ = executed(worst_state(small, result), capsys)
        for name in ("q", "v", "a"):
            assert tuple(names[name].tolist()) == getattr(result.worst, name)

    def test_names_of_the_catalogue(self, small):
        kr500 = next(entry for entry in urdf.robots() if entry.name == "kr500")
        renamed = dataclasses.replace(small, robot="kr500", file=str(kr500.path.resolve()))
        assert "urdf.load('kr500', gravity=[0.0, 0.0, -9.81])" in worst_state(renamed, small.quantities["torque"])
        elsewhere = dataclasses.replace(small, robot="kr500")  # a file of that name
        assert f"urdf.load({small.file!r}, " in worst_state(elsewhere, small.quantities["torque"])


class TestForm:
    def test_well_formed(self, page):
        known = {"ERR_HTML_UNKNOWN_TAG", "HTML_UNKNOWN_TAG"}  # libxml2 knows no <svg>, <main>, <figure>
        parser = etree.HTMLParser()
        etree.fromstring(page.encode(), parser)
        assert [e.message for e in parser.error_log if e.type_name not in known] == []
        assert balanced(page)

    def test_ids_are_unique_and_references_lead_somewhere(self, small, wrong):
        text = comparison_page([small, wrong], COMMAND)
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
        root = parsed(page)
        assert root.get("lang") == "en"
        assert len(root.xpath("//h1")) == 1
        assert all(table.find("caption") is not None for table in root.iter("table"))
        assert all(cell.get("scope") in ("row", "col") for cell in root.iter("th"))
        pictures = root.xpath("//svg")
        assert len(pictures) == 3
        assert all(svg.get("role") == "img" and svg.get("aria-label") for svg in pictures)
        assert all("<text" in etree.tostring(svg, encoding="unicode") for svg in pictures)
        assert all(button.get("hidden") is not None for button in root.iter("button"))  # until the script runs

    def test_the_same_input_gives_the_same_page(self, page, small):
        assert comparison_page([small], COMMAND) == page
        assert not re.search(r"20\d\d-\d\d-\d\d", page)

    def test_settings_of_the_user_do_not_matter(self, page, small):
        import matplotlib

        with matplotlib.rc_context({"font.size": 30, "svg.fonttype": "path", "axes.facecolor": "red"}):
            assert comparison_page([small], COMMAND) == page
            assert matplotlib.rcParams["font.size"] == 30

    def test_size(self, page):
        assert len(page.encode()) < LARGEST

    def test_names_are_escaped(self, tree):
        name = "<b>\"arm\" & 'co'</b><script>alert(1)</script>"
        joints = (dataclasses.replace(tree.joints[0], name="<i>$j</i>"), *tree.joints[1:])
        comparison = compared(dataclasses.replace(tree, name=name, joints=joints))
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


def balanced(text):
    """Whether every element is closed, in order."""
    text = re.sub(r"<!DOCTYPE[^>]*>|<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"<(script|style)>.*?</\1>", "", text, flags=re.DOTALL)
    stack = []
    for closing, tag, empty in re.findall(r"<(/?)([a-zA-Z][\w-]*)(?:\"[^\"]*\"|[^>\"])*?(/?)>", text):
        if closing:
            if not stack or stack.pop() != tag:
                return False
        elif tag not in VOID and not empty:
            stack.append(tag)
    return not stack


class TestQuantiles:
    def test_errors_of_all_routes_and_states(self, small):
        torque, base = small.quantities["torque"], small.quantities["base_parameters"]
        assert torque.errors.max() == torque.max_relative_error
        assert len(torque.errors) == 2 * len(small.quantities["constraint_rank"].errors)
        assert base.errors.tolist() == [base.max_relative_error]

    def test_are_errors_that_occurred(self):
        result = crosscheck.QuantityResult(
            BY_NAME["torque"], np.array([4.0, 0.0, math.inf, 1.0]), math.inf, {}, {}, None
        )
        assert result.quantiles == {"0": 0.0, "0.5": 4.0, "0.9": math.inf, "0.99": math.inf, "1": math.inf}

    def test_in_json_instead_of_the_errors(self, small):
        record = plain(robot_record(small))["quantities"]["torque"]
        assert list(record["quantiles"]) == [f"{part:g}" for part in QUANTILES]
        assert record["quantiles"]["1"] == record["max_relative_error"]
        assert record["scale"] == BY_NAME["torque"].scale
        assert "errors" not in record
        assert "model" not in plain(robot_record(small))
        json.dumps(record, allow_nan=False)

    def test_every_quantity_names_its_scale(self):
        assert all(quantity.scale for quantity in BY_NAME.values())


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

    def test_axis_is_labelled_with_powers_of_ten(self):
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
        assert pose(straight).tolist() == [BENT, BENT]
        assert "straight line" in pose_text(straight)
        assert 'role="img"' in stick_figure("k", straight, "straight")

    def test_usual_robot_is_in_its_zero_pose(self, tree):
        assert not pose(tree).any()
        assert pose_text(tree) == "Zero pose"

    def test_all_in_one_point_and_massless(self):
        """Nothing to be seen, and nothing that fails."""
        joints = (Joint("j", "prismatic", 0, Placement(), [0, 0, 1.0]),)
        body = graphdyn.Body("a", 0.0, np.zeros(3), np.zeros((3, 3)))
        assert "1 prismatic joint" in stick_figure("k", graphdyn.RobotModel("point", (body,), joints), "point")

    def test_robot_label_counts_joints(self, small):
        assert "2 revolute and 1 prismatic joints" in stick_figure("k", small.model, "small")


STATES = 40


def judged(model, name, factor=1.0, referees_differ=0.0, order=None):
    """A foreign function whose answer is graphdyn's times a factor; the referees differ by a relative error."""
    rng = np.random.default_rng(4)
    q, v = model.random_state(rng)
    a = tau = rng.normal(size=q.shape)
    ours = {
        "inverse_dynamics": lambda: graphdyn.inverse_dynamics(model, q, v, a).tau,
        "forward_dynamics": lambda: graphdyn.forward_dynamics(model, q, v, tau).a,
        "mass_matrix": lambda: graphdyn.mass_matrix(model, q),
        "regressor": lambda: graphdyn.joint_torque_regressor(model, q, v, a),
    }[name]().ravel()
    names = {"forward_dynamics": ("q", "v", "tau"), "mass_matrix": ("q",)}.get(name, ("q", "v", "a"))
    values = {"q": q, "v": v, "a": a, "tau": tau}
    here = [model.joint_names.index(joint) for joint in order or model.joint_names]
    errors = np.full(STATES, abs(factor - 1))
    call = WorstCall({x: tuple(values[x][here]) for x in names}, tuple(ours), tuple(factor * ours))
    between = {"pinocchio": np.full(STATES, referees_differ)}
    return JudgedFunction(
        name, {"graphdyn": errors, "pinocchio": errors}, between, 1e-9, "the largest entry", call,
        code=FUNCTIONS[name].code_for({}, None),
    )  # fmt: skip


def judgement(model, *functions, robot="some robot", file=None, diagnoses=(), order=None):
    return Judgement(
        robot, file, model, order or model.joint_names, STATES, SEED, {}, ("graphdyn", "pinocchio"),
        {function.name: function for function in functions}, diagnoses, ("no MuJoCo",),
    )  # fmt: skip


DIAGNOSIS = Diagnosis(
    function="inverse_dynamics",
    kind="joint_order",
    message="joints <1> and 2 are swapped",
    evidence="at 40 states",
    remedy="swap them",
    explains=3e-16,
    also=("x", "y & z"),
)


def judgement_page(judged_functions):
    return page_of(judge_report(judged_functions), COMMAND, versions())


SYMBOLS = {"agrees": "✓", "DISAGREES": "✗", "UNDECIDED": "?"}


class TestJudgement:
    @pytest.mark.parametrize(
        ("factor", "between", "title", "sentence"),
        [
            (1.0, 0.0, "agrees", "same numbers as every reference implementation (graphdyn, pinocchio)"),
            (1.5, 0.0, "DISAGREES", "inverse_dynamics: other numbers than the reference implementations"),
            (1.5, 1e-3, "UNDECIDED", "The reference implementations (graphdyn, pinocchio) differ among themselves"),
        ],
    )
    def test_three_verdicts(self, tree, factor, between, title, sentence):
        judged_functions = judgement(tree, judged(tree, "inverse_dynamics", factor, between))
        text = judgement_page(judged_functions)
        assert f"Foreign functions for some robot: {title}</title>" in text
        assert sentence in " ".join(text.split())
        table = rows(text, "Largest error over all states against each reference implementation")
        error = f"{factor - 1:.1e}"
        assert table["inverse_dynamics"] == [f"{SYMBOLS[title]} {title}", error, error, "1.0e-09", "the largest entry"]
        assert balanced(text)

    def test_every_referee(self, tree):
        text = judgement_page(judgement(tree, judged(tree, "mass_matrix", 1.5, 1e-3)))
        assert rows(text, "Errors over all states, relative to the largest entry") == {
            "against graphdyn": ["✗ DISAGREES", "5.0e-01", "5.0e-01", "1.0e-09"],
            "against pinocchio": ["✗ DISAGREES", "5.0e-01", "5.0e-01", "1.0e-09"],
            "pinocchio against graphdyn": ["✗ DISAGREES", "1.0e-03", "1.0e-03", "1.0e-09"],
        }
        assert "<li>no MuJoCo" in text

    def test_errors_over_the_states(self, tree):
        """A curve per comparison; none where no error can stand on a logarithmic axis."""
        report = judge_report(judgement(tree, judged(tree, "mass_matrix", 1.5, 1e-3)))
        (plot,) = [block for block in report.sections[-1].blocks if isinstance(block, Plot)]
        (panel,) = plot.panels
        assert [one.name for one in panel.series] == [
            "against graphdyn", "against pinocchio", "pinocchio against graphdyn",
        ]  # fmt: skip
        assert [set(one.y.tolist()) for one in panel.series] == [{0.5}, {0.5}, {1e-3}]
        assert (len(plot.x), panel.level) == (STATES, 1e-9)
        nothing = judge_report(judgement(tree, judged(tree, "mass_matrix")))
        assert not any(isinstance(block, Plot) for block in nothing.sections[-1].blocks)

    def test_functions_that_disagree_beside_an_undecided_one(self, tree):
        both = judgement(tree, judged(tree, "mass_matrix", 1.5, 1e-3), judged(tree, "inverse_dynamics", 1.5))
        text = " ".join(judgement_page(both).split())
        assert "differ among themselves on mass_matrix: no verdict there. inverse_dynamics: other numbers than" in text
        assert text.index('<section id="inverse_dynamics"') < text.index('<section id="mass_matrix"')

    def test_diagnoses_come_before_the_numbers(self, tree):
        function = judged(tree, "inverse_dynamics", 1.5)
        text = judgement_page(judgement(tree, function, diagnoses=(DIAGNOSIS,)))
        for part in ("joints &lt;1&gt; and 2 are swapped", "[joint_order]", "at 40 states", "swap them", "3.0e-16",
                     "x; or y &amp; z"):  # fmt: skip
            assert part in text
        places = [text.index(f'<section id="{key}"') for key in ("diagnoses", "errors", "judged", "inverse_dynamics")]
        assert places == sorted(places)

    def test_entries_of_a_vector_in_order_and_of_a_matrix_worst_first(self, tree):
        function = judged(tree, "inverse_dynamics", 1.5)
        table = rows(judgement_page(judgement(tree, function)), "Both answers where they differ most")
        assert list(table) == list(tree.joint_names)
        text = judgement_page(judgement(tree, judged(tree, "mass_matrix", 1.5)))
        matrix = graphdyn.mass_matrix(tree, judged(tree, "mass_matrix").worst.arguments["q"])
        i, j = np.unravel_index(np.abs(matrix).argmax(), matrix.shape)
        (table,) = [t for t in parsed(text).iter("table") if "Largest differences" in t.findtext("caption", "")]
        first = ["".join(cell.itertext()) for cell in table.find("tbody")[0]]
        assert first[:3] == [tree.joint_names[i], str(j + 1), f"{matrix[i, j]:.9g}"]

    @pytest.mark.parametrize("name", ["inverse_dynamics", "forward_dynamics", "mass_matrix", "regressor"])
    @pytest.mark.parametrize("reverse", [False, True])
    def test_snippet_gives_what_was_expected(self, small, name, reverse, capsys):
        """Arguments are in the foreign order, answers in that of the model."""
        order = small.model.joint_names[::-1] if reverse else small.model.joint_names
        function = judged(small.model, name, 1.5, order=order)
        text = judgement_page(judgement(small.model, function, robot=small.robot, file=small.file, order=order))
        names, difference = executed(snippets(text)[0], capsys)
        np.testing.assert_allclose(names["expected"], function.worst.expected, rtol=1e-12, atol=1e-12)
        assert difference == pytest.approx(max(abs(x) for x in function.worst.expected) / 2)

    def test_snippet_of_a_given_model(self, tree, capsys):
        text = judgement_page(judgement(tree, judged(tree, "mass_matrix")))
        assert executed(snippets(text)[0], capsys, model=tree)[1] < PHYSICAL

    def test_errors_that_are_no_numbers(self, tree):
        function = judged(tree, "inverse_dynamics")
        broken = dataclasses.replace(function, errors={"graphdyn": np.array([0.0, math.nan])})
        text = judgement_page(judgement(tree, broken))
        assert rows(text, "Errors over all states, relative to the largest entry")["against graphdyn"][:3] == [
            "✗ DISAGREES",
            "0.0e+00",
            "∞",
        ]


PROBE = """<!DOCTYPE html><html><body>
{frames}
<script>
onload = () => {{
  const measured = [...document.querySelectorAll("iframe")].map(frame =>
    frame.contentDocument.documentElement.scrollWidth + "/" + frame.contentWindow.innerWidth);
  document.body.dataset.measured = measured.join(" ");
}};
</script></body></html>
"""


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
def test_in_a_browser(tmp_path, page, wrong, tree):
    """No page is wider than its window, no script fails, and the buttons appear."""
    function = judged(tree, "regressor", 1.5)
    verdict = judgement(tree, function, diagnoses=(DIAGNOSIS,))
    identified = identified_arm.compared()
    pages = {
        "small.html": page,
        "wrong.html": comparison_page([wrong], COMMAND),
        "judged.html": judgement_page(verdict),
        "identified.html": page_of(identify_report(identified, identified.shown()), COMMAND, versions()),
    }
    frames = ""
    for name, text in pages.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
        for width in WIDTHS:
            frames += f'<iframe src="{name}" style="border:0;width:{width}px;height:800px"></iframe>\n'
    (tmp_path / "probe.html").write_text(PROBE.format(frames=frames), encoding="utf-8")
    shown = document((tmp_path / "probe.html").as_uri(), tmp_path / "profile")
    (measured,) = re.findall(r'data-measured="([^"]*)"', shown)
    widths = [tuple(map(int, pair.split("/"))) for pair in measured.split()]
    assert [window for _, window in widths] == [*WIDTHS] * len(pages)
    assert all(content <= window for content, window in widths), widths
