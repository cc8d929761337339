"""`graphdyn inspect`: one file and many, the terminal, the JSON file, the page."""

import json
import re
import shutil
from pathlib import Path

import pytest
from inspected.sample import CLEAN, FORE_INERTIAL, MASS, SHOULDER, changed
from inspected.workers import broken, fatal
from jsonschema import Draft202012Validator
from long_check import LONG
from robots.mesh_files import box, mesh, one_link, stl, visual
from shared_data import REPOSITORY
from shown.approved import approve_report
from shown.blocks import blocks, tables, texts
from shown.browser import CHROMIUM, document
from shown.pages import parsed
from typer.testing import CliRunner

import urdf
from crosscheck.commands import app
from crosscheck.commands.inspect import many_files as inspect_many
from crosscheck.commands.inspect.many_files import MIN_PARALLEL_FILES, inspect_files
from crosscheck.commands.inspect.record import FileRecord
from crosscheck.commands.inspect.report import MAX_UNFOLDED_FILES, inspect_report, worst
from crosscheck.commands.program import console
from crosscheck.report.html import MAX_NOTES_PER_CODE, page
from crosscheck.report.records.record import plain, written
from crosscheck.report.report import Group
from urdf.inspection.findings import Finding
from urdf.inspection.findings import report as findings_report

SCHEMA = json.loads((REPOSITORY / "docs/schemas/inspect-1.schema.json").read_text(encoding="utf-8"))
NARROW = 80


@pytest.fixture
def folder(tmp_path):
    """A file of each verdict, one of them in a folder below."""
    place = tmp_path / "robots"
    (place / "more").mkdir(parents=True)
    (place / "a_dynamics.urdf").write_text(CLEAN, encoding="utf-8")
    (place / "b_kinematics.urdf").write_text(changed(FORE_INERTIAL, ""), encoding="utf-8")
    (place / "more" / "c_refused.urdf").write_text(
        changed(MASS, "<mass/>", SHOULDER, SHOULDER.replace(' type="revolute"', "")), encoding="utf-8"
    )
    (place / "readme.txt").write_text("not a robot", encoding="utf-8")
    return place


def run(*arguments):
    return CliRunner().invoke(app, ["inspect", *map(str, arguments)])


def page_of(*files, failures=()):
    return page(inspect_report([urdf.inspect(file) for file in files], failures), ["graphdyn"], {})


def words(element):
    return " ".join("".join(element.itertext()).split())


def recorded(path, *arguments):
    done = run(*arguments, "--json", path)
    record = json.loads(path.read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(record)
    return record, done


class TestCommand:
    def test_one_file(self, folder):
        done = run(folder / "a_dynamics.urdf")
        assert done.exit_code == 0
        assert done.stderr == ""
        assert "│ note     │ mass-matrix" in done.stdout
        assert done.stdout.startswith(
            "a_dynamics.urdf: good for dynamics\nDynamics can be computed (0 errors, 0 warnings, 2 notes)\n"
        )
        assert str(folder / "a_dynamics.urdf") in done.stdout.replace("\n", "")

    def test_numbers_that_no_arm_has(self, folder, tmp_path):
        text = (folder / "a_dynamics.urdf").read_text(encoding="utf-8")
        heavy = re.sub(r'mass value="[^"]*"', 'mass value="5e6"', text, count=1)
        (tmp_path / "heavy.urdf").write_text(heavy, encoding="utf-8")
        done = run(tmp_path / "heavy.urdf")
        assert done.exit_code == 0
        assert done.stdout.startswith("heavy.urdf: good for dynamics, with improbable numbers\n")
        assert "Improbable: " in done.stdout

    def test_a_robot_of_the_catalog(self):
        done = run("kr500")
        assert done.exit_code == 0
        assert done.stdout.startswith("kr500: good for dynamics\nDynamics can be computed (0 errors, ")

    @pytest.mark.parametrize(("meshes", "told"), [("summary", False), ("detail", True), ("off", False)])
    def test_meshes(self, tmp_path, meshes, told):
        stl(tmp_path / "a.stl", box())
        robot = tmp_path / "r.urdf"
        robot.write_text(one_link(visual(mesh("a.stl"))), encoding="utf-8")
        done = run(robot, "--meshes", meshes)
        assert ("inertia-of-mesh" in done.output) == told
        assert ("not opened" in done.output) == (meshes == "off")

    def test_kinematics_only(self, folder):
        done = run(folder / "b_kinematics.urdf")
        assert done.exit_code == 1
        assert done.stdout.startswith("b_kinematics.urdf: good for kinematics only\n0 errors, ")
        assert "1 note: the mass matrix has rank 1 of 2 over 5 random states" in done.stdout

    def test_refused(self, folder):
        done = run(folder / "more" / "c_refused.urdf")
        assert done.exit_code == 1
        rows = re.findall(r"│ (error|warning|note) ", done.stdout)
        assert rows == sorted(rows, key=["error", "warning", "note"].index)
        assert rows[0] == "error"
        assert done.stdout.startswith("c_refused.urdf: refused\n2 errors, ")
        assert "1 note: <mass> of link 'upper': attribute 'value' is missing" in done.stdout

    def test_findings_of_one_kind_share_a_row(self, tmp_path):
        path = tmp_path / "arm.urdf"
        path.write_text(CLEAN.replace('"0 1 0"', '"0 0 1"').replace('"0 0 1"', '"0 0 -1"'), encoding="utf-8")
        assert "negative-axis 2×" in run(path).stdout

    def test_many_of_a_kind_and_many_reasons(self, tmp_path):
        path = tmp_path / "arm.urdf"
        path.write_text(re.sub(r' rpy="0 0 0"', ' rpy="0 0"', CLEAN), encoding="utf-8")
        done = run(path)
        assert done.exit_code == 1
        assert "wrong-number-of-entries" in done.stdout
        assert "and 2 more" in done.stdout
        assert done.stdout.count("separate numbers by spaces") == 1
        assert "refused 5 errors, 0 warnings, 1 note: <origin> of link 'upper': rpy=" in " ".join(done.stdout.split())
        assert re.search(r"such an axis; and 4\s+more\n", done.stdout)  # of the same kind

    def test_reasons_of_several_kinds(self):
        kinds = [urdf.Finding(f"code-{k}", "error", f"link '{k}'", None, "is odd", "write it") for k in range(5)]
        report = inspect_report([urdf.Inspection("arm", None, (*kinds, *kinds[:1]))], ())
        assert report.verdict.reason == (
            "6 errors, 0 warnings, 0 notes: link '0': is odd; link '1': is odd; link '2': is odd; and 3 more"
        )

    def test_folder(self, folder):
        done = run(folder)
        assert done.exit_code == 1
        assert done.stdout.startswith(
            f"3 robot files: 1 refused, 1 good for kinematics only, 1 good for dynamics\nIn the folder {folder}"
        )
        heading = re.compile("^(?:Refused|Good for kinematics only|Good for dynamics): 1 file +$", re.MULTILINE)
        parts = heading.split(done.stdout)
        for name, part in zip(("c_refused", "b_kinematics", "a_dynamics"), parts[1:], strict=True):
            assert re.search(rf"│ (more/)?{name}.urdf +│ +\d │ +\d │ +\d │", part)
        assert re.search(r"│ rotor-inertia +│ +3 │", done.stdout)
        assert re.search(r"c_refused.* missing-mass", done.stdout)

    def test_files_are_compared(self, tmp_path):
        """The same robot of water and of steel."""
        steel = (MASS, '<mass value="19.625"/>', 'ixx="0.11"', 'ixx="0.8635"', 'iyy="0.13"', 'iyy="1.0205"')
        for name, text in (("water", CLEAN), ("steel", changed(*steel, 'izz="0.17"', 'izz="1.3345"'))):
            (tmp_path / f"{name}.urdf").write_text(text, encoding="utf-8")
        assert "other-density" in run(tmp_path).stdout
        assert "other-density" not in run(tmp_path / "steel.urdf").stdout

    def test_files_and_names_together(self, folder):
        done = run(folder / "a_dynamics.urdf", "kr500")
        assert done.exit_code == 0
        assert done.stdout.startswith("2 robot files: 2 good for dynamics\n")

    @pytest.mark.parametrize(
        ("argument", "message"),
        [
            ("ur55", "'ur55' is neither a file nor a robot of the catalog; close names: ur5"),
            ("", "no \\*.urdf in the folder '.*'; give a folder with URDF files"),
        ],
    )
    def test_bad_input_and_the_others_go_on(self, folder, tmp_path, argument, message):
        empty = tmp_path / "empty"
        empty.mkdir()
        done = run(argument or empty, folder / "a_dynamics.urdf")
        assert done.exit_code == 2
        assert re.search(rf"error: {message}", done.stderr)
        assert "a_dynamics.urdf: good for dynamics" in done.stdout.replace("\n", "")

    def test_nothing_but_bad_input(self, tmp_path):
        file = tmp_path / "page.html"
        record, done = recorded(tmp_path / "r.json", "ur55", "--html", file)
        assert (done.exit_code, record["files"], record["usable"]) == (2, [], False)
        assert done.stdout == "0 robot files: 1 could not be inspected\n"
        assert [failure["robot"] for failure in record["failures"]] == ["ur55"]
        assert "<strong>ur55</strong>" in file.read_text(encoding="utf-8")

    @pytest.mark.parametrize("others", [(), ("a_dynamics.urdf",)])
    def test_an_unreadable_file(self, folder, monkeypatch, others):
        """Alone, and beside one that can be read."""
        opened, sealed = Path.open, folder / "b_kinematics.urdf"

        def denied(path, *arguments, **options):
            if path == sealed:
                raise PermissionError(13, "Permission denied")
            return opened(path, *arguments, **options)

        monkeypatch.setattr(Path, "open", denied)
        done = run(*(folder / name for name in others), sealed)
        assert done.exit_code == 2
        assert ("unreadable-file" if others else "Permission denied") in done.stdout
        assert ("1 good for dynamics" in done.stdout) == bool(others)

    def test_narrow_terminal(self, folder, monkeypatch):
        monkeypatch.setattr(console.out, "width", NARROW)
        for argument in (folder, folder / "more" / "c_refused.urdf"):
            table = [line for line in run(argument).stdout.splitlines() if line[:1] in "│┃┏└"]
            assert max(map(len, table)) <= NARROW

    def test_help_tells_the_exit_codes(self):
        said = " ".join(run("--help").stdout.split())
        assert "Exit code 0: all are good for dynamics; 1: some file is refused or good for kinematics only; 2:" in said


class TestJson:
    def test_one(self, folder, tmp_path):
        path = folder / "more" / "c_refused.urdf"
        record, done = recorded(tmp_path / "r.json", path)
        assert done.exit_code == 1
        report = urdf.inspect(path)
        (file,) = record["files"]
        assert file == plain(written(FileRecord, report))
        assert (file["verdict"], file["usable"], record["usable"]) == ("refused", False, False)
        assert [finding["code"] for finding in file["findings"]][:2] == ["missing-mass", "missing-type"]
        assert file["findings"][0]["line"] == 6

    def test_several(self, folder, tmp_path):
        record, _ = recorded(tmp_path / "r.json", folder)
        assert [Path(file["robot"]).name for file in record["files"]] == [
            "a_dynamics.urdf", "b_kinematics.urdf", "c_refused.urdf",
        ]  # fmt: skip
        assert record["occurrences"]["rotor-inertia"] == 3
        assert record["failures"] == []

    def test_usable(self, folder, tmp_path):
        record, done = recorded(tmp_path / "r.json", folder / "a_dynamics.urdf", "kr500")
        assert (record["usable"], done.exit_code) == (True, 0)


class TestPage:
    def test_every_finding(self, folder, tmp_path):
        file = tmp_path / "page.html"
        assert run(folder, "--html", file).exit_code == 1
        root = parsed(file.read_text(encoding="utf-8"))
        text = words(root)
        for path in sorted(folder.rglob("*.urdf")):
            report = urdf.inspect(path)
            assert str(path) in text
            for finding in report.findings:
                assert finding.message in text
                assert finding.remedy in text
        title = words(root.find(".//title"))
        assert title == "3 robot files: 1 refused, 1 good for kinematics only, 1 good for dynamics"
        assert not root.xpath("//link | //img | //iframe | //script[@src]")

    def test_worst_files_first_and_folded_findings(self, folder):
        root = parsed(page_of(*sorted(folder.rglob("*.urdf"))))
        assert [words(title) for title in root.xpath("//section/h2")] == [
            "Refused: ✗ 1 file", "Good for kinematics only: ? 1 file", "Good for dynamics: ✓ 1 file",
        ]  # fmt: skip
        (link,) = root.xpath("//a[contains(., 'c_refused')]")
        (group,) = root.xpath(f"//*[@id='{link.get('href')[1:]}']")
        assert words(group.find("details/summary")).startswith("more/c_refused.urdf: 2 errors, ")
        assert not root.xpath("//details[@open]")
        shown = root.xpath("//table[not(ancestor::details)]/tbody/tr")
        assert len(shown) == 3

    def test_every_link_leads_somewhere(self, folder):
        root = parsed(page_of(*sorted(folder.rglob("*.urdf"))))
        ids = root.xpath("//@id")
        assert len(set(ids)) == len(ids)
        links = root.xpath("//a/@href")
        assert len(links) == 6
        assert {link[1:] for link in links} <= set(ids)

    @pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
    def test_a_link_opens_what_it_leads_to(self, folder, tmp_path):
        file = tmp_path / "page.html"
        file.write_text(page_of(*sorted(folder.rglob("*.urdf"))), encoding="utf-8")
        root = parsed(document(f"{file.as_uri()}#refused-1", tmp_path / "profile"))
        assert [words(details.find("summary")) for details in root.xpath("//details[@open]")] == [
            "Findings of each file", "more/c_refused.urdf: 2 errors, 0 warnings, 1 note",
        ]  # fmt: skip

    def test_only_tables_with_sentences_are_stacked_on_narrow_screens(self, folder):
        root = parsed(page_of(*sorted(folder.rglob("*.urdf"))))
        headings = {words(table.find("thead/tr/th")): table.get("class") for table in root.iter("table")}
        assert headings == {"file": None, "severity": "wordy", "finding": None}

    def test_kinds_that_occur_more_than_once(self, tmp_path):
        path = tmp_path / "arm.urdf"
        path.write_text(re.sub(r' rpy="0 0 0"', ' rpy="0 0"', CLEAN), encoding="utf-8")
        kind = [f for f in urdf.inspect(path).findings if f.code == "wrong-number-of-entries"]
        assert len(kind) > MAX_NOTES_PER_CODE
        root = parsed(page_of(path))
        (row,) = [row for row in root.xpath("//tbody/tr") if "wrong-number-of-entries" in words(row)]
        assert f"wrong-number-of-entries {len(kind)}×" in words(row)
        (group,) = root.xpath("//details[@class='notes']")
        assert words(group.find("summary")) == f"✗ wrong-number-of-entries ({len(kind)})"
        for finding in kind:
            assert f"{finding.element}, line {finding.line}: {finding.message} → {finding.remedy}" in words(group)

    def test_many_files_fit_for_dynamics_are_folded(self, folder):
        path = folder / "a_dynamics.urdf"
        for number, rows in ((MAX_UNFOLDED_FILES, MAX_UNFOLDED_FILES), (MAX_UNFOLDED_FILES + 1, 0)):
            report = inspect_report([urdf.inspect(path)] * number, ())
            root = parsed(page(report, ["graphdyn"], {}))
            assert len(root.xpath("//table[not(ancestor::details)]/tbody/tr")) == rows

    def test_one_file(self, folder):
        text = page_of(folder / "a_dynamics.urdf")
        assert "<title>a_dynamics.urdf: good for dynamics</title>" in text
        assert "How many files" not in text

    def test_names_are_escaped(self, tmp_path):
        path = tmp_path / "<b>.urdf"
        path.write_text(changed('name="flange"', 'name="&lt;i>/x"'), encoding="utf-8")
        text = page_of(path, failures=[{"robot": "<u>", "message": "<s>"}])
        for forbidden in ("<b>", "<i>", "<u>", "<s>"):
            assert forbidden not in text

    def test_the_same_input_gives_the_same_page(self, folder):
        files = sorted(folder.rglob("*.urdf"))
        assert page_of(*files) == page_of(*files)


class TestSweep:
    """Many files, in processes."""

    @pytest.fixture
    def many(self, folder, tmp_path):
        place = tmp_path / "many"
        place.mkdir()
        for k in range(MIN_PARALLEL_FILES + 2):
            shutil.copy(folder / "a_dynamics.urdf", place / f"{k:02}.urdf")
        return place

    def names(self, place):
        return sorted(map(str, place.iterdir()))

    @LONG
    def test_in_processes(self, many):
        """With an error of the program for one of them."""
        (many / "03.urdf").rename(many / "03_broken.urdf")
        seen = []
        robots = self.names(many)
        reports = inspect_files(robots, lambda robot, steps: seen.append((robot, steps)), broken)
        assert [report.robot for report in reports] == robots
        assert sorted(seen) == [(robot, 1) for robot in robots]
        assert reports[0] == urdf.inspect(robots[0])
        failed = [report.reasons for report in reports if not report.usable]
        assert failed == [("the inspection failed: ZeroDivisionError: no reason",)]

    def test_a_file_that_kills_its_process(self, many, monkeypatch):
        monkeypatch.setattr(inspect_many, "MIN_PARALLEL_FILES", 1)
        monkeypatch.setattr(inspect_many, "cores", lambda: 1)
        for path in sorted(many.iterdir())[4:]:
            path.unlink()
        (many / "03.urdf").rename(many / "03_fatal.urdf")
        reports = inspect_files(self.names(many), lambda *_: None, fatal)
        assert len(reports) == 4
        failed = [report for report in reports if not report.usable]
        assert [Path(report.robot).name for report in failed] == ["03_fatal.urdf"]
        assert failed[0].reasons == ("the inspection was lost: its process died with code 1, tries: 2",)
        assert failed[0].codes == ("inspection-failed",)
        assert failed[0].findings[0].remedy == "report it, with the file"

    def test_progress(self, many, monkeypatch):
        for name, value in {"FORCE_COLOR": "1", "TERM": "xterm", "COLUMNS": "140"}.items():
            monkeypatch.setenv(name, value)
        monkeypatch.setattr(console.err, "is_interactive", True)
        few = self.names(many)[:2]
        done = run(*few)
        assert re.search(r"inspect.* 2/2 .*…\S*/many/01\.urdf", done.stderr)


def test_worst_findings_come_from_the_worst_severity(folder):
    assert worst(urdf.inspect(folder / "a_dynamics.urdf")) == []
    assert worst(urdf.inspect(folder / "b_kinematics.urdf")) == ["mass-matrix-singular", "missing-inertial"]
    assert worst(urdf.inspect(folder / "more" / "c_refused.urdf")) == ["missing-mass", "missing-type"]


def finding(severity, code, k, line=None):
    return Finding(code, severity, f"<x> of link '{k}'", line, f"{code} {k}", "mend it")


class TestEveryNumber:
    """Of the report and the record, counted by hand."""

    @pytest.fixture
    def inspected(self):
        refused = [finding("error", "no-mass", k, 10 + k) for k in range(5)]
        refused += [finding("error", "bad-axis", k, 30) for k in range(2)] + [finding("error", "no-joint", 0)]
        refused += [finding("error", "twice", 0), finding("warning", "flat", 0), finding("warning", "flat", 1)]
        fit = [finding("warning", "flat", k, 7 + k) for k in range(3)] + [finding("note", "long", 0)]
        return [
            findings_report("/robots/a.urdf", "/robots/a.urdf", refused),
            findings_report("/robots/more/b.urdf", "/robots/more/b.urdf", fit),
            findings_report("/robots/c.urdf", "/robots/c.urdf", []),
        ]

    def test_whole(self, inspected):
        approve_report("inspect", inspect_report(inspected[:1], []))
        approve_report("inspect_folder", inspect_report(inspected, []))

    def test_one(self, inspected):
        report = inspect_report(inspected[:1], [])
        assert report.verdict.words == "refused"
        told = "; ".join(f"<x> of link '0': {code} 0" for code in ("no-joint", "twice", "no-mass"))
        assert report.verdict.reason == f"9 errors, 2 warnings, 0 notes: {told}; and 6 more"
        (table,) = tables(report, "findings")
        rows = {row[1]: row for row in texts(table)}
        assert set(rows) == {"no-mass 5×", "bad-axis 2×", "no-joint", "twice", "flat 2×"}
        places = [f"<x> of link '{k}', line {10 + k}" for k in range(3)]
        assert rows["no-mass 5×"][2].split("\n") == [*places, "and 2 more"]
        assert rows["bad-axis 2×"][2].split("\n") == [f"<x> of link '{k}', line 30" for k in range(2)]
        assert rows["no-joint"][2] == "<x> of link '0'"
        every = next(block for block in blocks(report, "findings") if block.title.startswith("Every finding"))
        assert len(every.notes) == 5 + 2 + 2

    def test_places(self):
        """Of an element, of a line, of both, of the file."""
        places = [("<x> of link 'a'", 5), (None, 6), ("<y> of joint 'b'", None), (None, None)]
        found = [Finding(f"code-{k}", "error", *place, "is odd", "mend it") for k, place in enumerate(places)]
        (table,) = tables(inspect_report([urdf.Inspection("arm", None, tuple(found))], []), "findings")
        said = ["<x> of link 'a', line 5", "line 6", "<y> of joint 'b'", ""]
        assert [row[2] for row in texts(table)] == said

    def test_several(self, inspected):
        report = inspect_report(inspected, [{"robot": "x", "message": "no"}, {"robot": "y", "message": "no"}])
        assert report.title == "3 robot files"
        assert report.verdict.words == "1 refused, 2 good for dynamics, 2 could not be inspected"
        assert texts(tables(report, "refused")[0]) == [["a.urdf", "9", "2", "0", "no-joint, twice, no-mass, bad-axis"]]
        assert texts(tables(report, "dynamics")[0]) == [
            ["more/b.urdf", "0", "3", "1", "flat"], ["c.urdf", "0", "0", "0", ""],
        ]  # fmt: skip
        titles = [group.title for group in blocks(report, "dynamics") if isinstance(group, Group)]
        assert titles == ["more/b.urdf: 0 errors, 3 warnings, 1 note", "c.urdf: 0 errors, 0 warnings, 0 notes"]
        often = dict(texts(tables(report, "occurrences")[0]))
        assert often.pop("flat") == "2"
        assert often == dict.fromkeys(("no-mass", "bad-axis", "no-joint", "twice", "long"), "1")
        record = plain(report.record(["inspect"]))
        assert record["occurrences"] == {code: int(count) for code, count in often.items()} | {"flat": 2}
        assert next(iter(record["occurrences"])) == "flat"
        assert record["usable"] is False
        assert [len(file["findings"]) for file in record["files"]] == [11, 4, 0]

    def test_lines_of_a_file(self, folder, tmp_path):
        """Each finding that has a line names that of its element in the text."""
        file = folder / "more" / "c_refused.urdf"
        record, _ = recorded(tmp_path / "r.json", file)
        lines = file.read_text(encoding="utf-8").splitlines()
        (found,) = record["files"]
        with_line = [one for one in found["findings"] if one["line"]]
        assert len(with_line) >= 2
        for one in with_line:
            tag, name = re.fullmatch(r"<?(\w+)>?(?: of \w+)? '(.*)'", one["element"]).groups()
            at = one["line"] - 1
            assert f"<{tag}" in lines[at]
            assert f'"{name}"' in "".join(lines[max(0, at - 3) : at + 1])
