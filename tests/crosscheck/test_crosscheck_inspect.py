"""`graphdyn inspect`: one file and many, the terminal, the JSON file, the page."""

import json
import re
import shutil
from pathlib import Path

import pytest
from inspection_cases import CLEAN, FORE_INERTIAL, MASS, SHOULDER, changed
from inspection_workers import broken, fatal
from jsonschema import Draft202012Validator
from lxml import etree
from typer.testing import CliRunner

import urdf
from crosscheck.cli import app, console
from crosscheck.cli import inspect_many as sweeping
from crosscheck.cli.inspect_many import FEW, sweep
from crosscheck.cli.inspect_text import worst
from crosscheck.report.json import plain
from crosscheck.report.pages.inspection import inspection_page
from crosscheck.report.records.inspect import file_record

SCHEMA = json.loads((Path(__file__).parents[2] / "docs/schemas/inspect-1.schema.json").read_text(encoding="utf-8"))
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
        assert "a_dynamics.urdf: dynamics (0 errors, 0 warnings, 2 notes)" in done.stdout.replace("\n", "")

    def test_a_robot_of_the_catalogue(self):
        done = run("kr500")
        assert done.exit_code == 0
        assert "kr500: dynamics (0 errors, " in done.stdout

    def test_kinematics_only(self, folder):
        done = run(folder / "b_kinematics.urdf")
        assert done.exit_code == 1
        assert "b_kinematics.urdf: kinematics only" in done.stdout.replace("\n", "")
        assert "  the mass matrix has rank 1 of 2 over 5 random states" in done.stdout

    def test_refused(self, folder):
        done = run(folder / "more" / "c_refused.urdf")
        assert done.exit_code == 1
        rows = re.findall(r"│ (error|warning|note) ", done.stdout)
        assert rows == sorted(rows, key=["error", "warning", "note"].index)
        assert rows[0] == "error"
        assert "  <mass> of link 'upper': attribute 'value' is missing" in done.stdout

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
        for old in ("lower", "upper", "effort", "velocity"):
            path.write_text(path.read_text().replace(f'{old}="', f'{old}="x'), encoding="utf-8")
        assert run(path).stdout.rstrip().endswith("more")

    def test_folder(self, folder):
        done = run(folder)
        assert done.exit_code == 1
        for name, verdict in (
            ("a_dynamics", "dynamics"),
            ("b_kinematics", "kinematics only"),
            ("c_refused", "refused"),
        ):
            assert re.search(rf"{name}.urdf +│ {verdict} +│", done.stdout)
        assert done.stdout.rstrip().endswith("3 files: 1 dynamics, 1 kinematics only, 1 refused")
        assert re.search(r"│ rotor-inertia +│ 3 +│", done.stdout)
        assert re.search(r"c_refused.* missing-mass", done.stdout)

    def test_files_and_names_together(self, folder):
        done = run(folder / "a_dynamics.urdf", "kr500")
        assert done.exit_code == 0
        assert done.stdout.rstrip().endswith("2 files: 2 dynamics")

    @pytest.mark.parametrize(
        ("argument", "message"),
        [
            ("ur55", "'ur55' is neither a file nor a robot of the catalogue; close names: ur5"),
            ("", "no \\*.urdf in the folder '.*'; give a folder with URDF files"),
        ],
    )
    def test_bad_input_and_the_others_go_on(self, folder, tmp_path, argument, message):
        empty = tmp_path / "empty"
        empty.mkdir()
        done = run(argument or empty, folder / "a_dynamics.urdf")
        assert done.exit_code == 2
        assert re.search(rf"error: {message}", done.stderr)
        assert "a_dynamics.urdf: dynamics" in done.stdout.replace("\n", "")

    def test_nothing_but_bad_input(self, tmp_path):
        page = tmp_path / "page.html"
        record, done = recorded(tmp_path / "r.json", "ur55", "--html", page)
        assert (done.exit_code, done.stdout, record["files"], record["usable"]) == (2, "", [], False)
        assert [failure["robot"] for failure in record["failures"]] == ["ur55"]
        assert "<strong>ur55</strong>" in page.read_text(encoding="utf-8")

    def test_an_unreadable_file(self, folder, monkeypatch):
        def denied(*_arguments, **_options):
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(Path, "open", denied)
        done = run(folder / "a_dynamics.urdf")
        assert done.exit_code == 2
        assert "Permission denied" in done.stdout

    def test_narrow_terminal(self, folder, monkeypatch):
        monkeypatch.setattr(console.out, "width", NARROW)
        for argument in (folder, folder / "more" / "c_refused.urdf"):
            table = [line for line in run(argument).stdout.splitlines() if line[:1] in "│┃┏└"]
            assert max(map(len, table)) <= NARROW

    def test_help_tells_the_exit_codes(self):
        said = " ".join(run("--help").stdout.split())
        assert "Exit code 0: all are fit for dynamics; 1: some file is refused or good for kinematics only; 2: " in said


class TestJson:
    def test_one(self, folder, tmp_path):
        path = folder / "more" / "c_refused.urdf"
        record, done = recorded(tmp_path / "r.json", path)
        assert done.exit_code == 1
        report = urdf.inspect(path)
        (file,) = record["files"]
        assert file == plain(file_record(report))
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
        page = tmp_path / "page.html"
        assert run(folder, "--html", page).exit_code == 1
        root = etree.fromstring(page.read_bytes(), etree.HTMLParser(encoding="utf-8"))
        text = " ".join("".join(root.itertext()).split())
        for path in sorted(folder.rglob("*.urdf")):
            report = urdf.inspect(path)
            for finding in report.findings:
                assert finding.message in text
                assert finding.remedy in text
            for reason in report.reasons:
                assert reason in text
        assert "3 files inspected: 1 dynamics, 1 kinematics only, 1 refused." in text
        ids = [element.get("id") for element in root.iter("section")]
        assert {f"#{name}" for name in ids} == {link.get("href") for link in root.iter("a")}
        assert all(table.find("caption") is not None for table in root.iter("table"))
        assert not root.xpath("//link | //img | //iframe | //script[@src]")

    def test_one_file(self, folder):
        page = inspection_page([urdf.inspect(folder / "a_dynamics.urdf")], ["graphdyn", "inspect", "a"])
        assert "<title>a_dynamics.urdf: dynamics</title>" in page
        assert "The verdict on every file" not in page

    def test_names_are_escaped(self, tmp_path):
        path = tmp_path / "<b>.urdf"
        path.write_text(changed('name="flange"', 'name="&lt;i>/x"'), encoding="utf-8")
        page = inspection_page([urdf.inspect(path)], ["graphdyn"], [{"robot": "<u>", "message": "<s>"}])
        for forbidden in ("<b>", "<i>", "<u>", "<s>"):
            assert forbidden not in page

    def test_the_same_input_gives_the_same_page(self, folder):
        reports = [urdf.inspect(path) for path in sorted(folder.rglob("*.urdf"))]
        assert inspection_page(reports, ["graphdyn"]) == inspection_page(reports, ["graphdyn"])


class TestSweep:
    """Many files, in processes."""

    @pytest.fixture
    def many(self, folder, tmp_path):
        place = tmp_path / "many"
        place.mkdir()
        for k in range(FEW + 2):
            shutil.copy(folder / "a_dynamics.urdf", place / f"{k:02}.urdf")
        return place

    def names(self, place):
        return sorted(map(str, place.iterdir()))

    def test_in_processes(self, many):
        seen = []
        robots = self.names(many)
        reports = sweep(robots, lambda robot, steps: seen.append((robot, steps)))
        assert [report.robot for report in reports] == robots
        assert sorted(seen) == [(robot, 1) for robot in robots]
        assert reports[0] == urdf.inspect(robots[0])

    def test_a_file_that_kills_its_process(self, many, monkeypatch):
        monkeypatch.setattr(sweeping, "FEW", 1)
        for path in sorted(many.iterdir())[4:]:
            path.unlink()
        (many / "03.urdf").rename(many / "03_fatal.urdf")
        reports = sweep(self.names(many), lambda *_: None, fatal)
        assert len(reports) == 4
        failed = [report for report in reports if not report.usable]
        assert [Path(report.robot).name for report in failed] == ["03_fatal.urdf"]
        assert failed[0].reasons == ("the process that read the file died with code 1",)
        assert failed[0].codes == ("inspection-failed",)
        assert failed[0].findings[0].remedy == "report it, with the file"

    def test_an_error_of_the_program(self, many):
        (many / "03.urdf").rename(many / "03_broken.urdf")
        reports = sweep(self.names(many), lambda *_: None, broken)
        failed = [report for report in reports if not report.usable]
        assert [report.reasons for report in failed] == [("the inspection failed: ZeroDivisionError: no reason",)]

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
