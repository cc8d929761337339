"""`graphdyn crosscheck FOLDER`: every file has its outcome, and none stops the others."""

import json
import math
import re
import shutil
import sys
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from long_check import LONG
from own_processes import travelled
from planting import Plant
from shared_data import ARMS, REPOSITORY, existing

from crosscheck.commands import main
from crosscheck.commands.crosscheck import folder as sweeping
from crosscheck.commands.crosscheck import folder_report as report_of_folder
from crosscheck.commands.crosscheck import folder_report as summary
from crosscheck.commands.crosscheck.folder_file import NAMES_BEFORE, SweepFile
from crosscheck.commands.program import console
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED, INTERNAL_ERROR
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.comparing import compare as comparing
from crosscheck.comparing.comparison import part_of_bound
from crosscheck.distributing import LocalProcesses, Lost
from crosscheck.reference.subject import content_sha256
from crosscheck.report.findings.failures import failure

SCHEMA = Draft202012Validator(json.loads((REPOSITORY / "docs/schemas/crosscheck-3.schema.json").read_text("utf-8")))
VENDOR_ARMS = {
    "aubo_i5": ("agrees", ("model",)),
    "gp8l": ("kinematics only", ("urdf", "model")),
}
"""One of each outcome that the makers' files have; test_crosscheck_agreement compares all of them."""


class Outcome:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    def row(self, name):
        """Cells of the row of a robot, with folded lines put together, and further columns from the next table."""
        found = [name]
        for table in self.out.split("┏")[1:]:
            cells = [[cell.strip() for cell in line.split("│")[1:-1]] for line in table.splitlines() if "│" in line]
            first = next(k for k, row in enumerate(cells) if row[0] == name)
            last = next((k for k in range(first + 1, len(cells)) if cells[k][2]), len(cells))
            found += [" ".join(parts).strip() for parts in zip(*cells[first:last], strict=True)][1:]
        return found


@pytest.fixture
def program(monkeypatch, capsys):
    """program(folder, "--jobs", 1): exit code and what was written."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["graphdyn", "crosscheck", *map(str, arguments)])
        with pytest.raises(SystemExit) as caught:
            main()
        captured = capsys.readouterr()
        return Outcome(caught.value.code or 0, captured.out, captured.err)

    return run


@pytest.fixture
def here(monkeypatch, random_states_alone):
    """The work is done in this process, where errors can be planted, and at the random states only.

    Holds the robots that were compared.
    """
    compared = []

    def each(_self, function, items):
        for k, item in enumerate(items):
            compared.append(Path(item.robot).name)
            yield k, travelled(function(travelled(item)))

    monkeypatch.setattr(LocalProcesses, "each", each)
    return compared


def without_mass(text):
    return re.sub(r"<inertial>.*?</inertial>", "", text, flags=re.DOTALL)


@pytest.fixture
def folder(tmp_path, pendulum):
    """good.urdf, sub/bare.urdf without mass, sub/broken.urdf, and an empty folder."""
    folder = tmp_path / "robots"
    (folder / "sub").mkdir(parents=True)
    (folder / "empty").mkdir()
    text = pendulum.read_text(encoding="utf-8")
    (folder / "good.urdf").write_text(text, encoding="utf-8")
    (folder / "sub" / "bare.urdf").write_text(without_mass(text), encoding="utf-8")
    (folder / "sub" / "broken.urdf").write_text("<robot name='x'>\n", encoding="utf-8")
    return folder


@pytest.fixture
def good_folder(folder):
    (folder / "sub" / "broken.urdf").unlink()
    return folder


def written(path):
    record = json.loads(path.read_text(encoding="utf-8"))
    SCHEMA.validate(record)
    return record


@pytest.fixture(scope="module")
def some_record(tmp_path_factory, pendulum_text):
    path = tmp_path_factory.mktemp("robots") / "pendulum.urdf"
    path.write_text(pendulum_text, encoding="utf-8")
    return sweeping.examine(sweeping.ComparisonTask(str(path), 1, 0, "none")).record


@pytest.fixture
def examined(monkeypatch, some_record):
    """Bookkeeping does not need the numbers: every robot that can be loaded gets the same."""

    def examine(task):
        if "new" in task.robot:
            return sweeping.ComparisonOutcome(failure=failure(task.robot, "not a robot"))
        own = {"robot": task.robot, "file_sha256": content_sha256(task.robot)}
        return sweeping.ComparisonOutcome({**some_record, **own, "samples": task.samples, "seed": task.seed})

    monkeypatch.setattr(sweeping, "examine", examine)


class TestOutcomes:
    def test_in_processes(self, program, folder, tmp_path, monkeypatch):
        monkeypatch.setattr(console, "PROGRESS_INTERVAL", math.inf)  # however slow the machine, no line of progress
        done = program(folder, "--samples", 1, "--jobs", 1, "--json", tmp_path / "r.json")
        assert done.code == BAD_INPUT
        assert done.err == ""
        assert done.out.startswith("graphdyn against Pinocchio: incomplete\n")
        assert done.row("good.urdf")[1:3] == ["agrees", "both"]
        assert done.row("sub/bare.urdf")[1:3] == ["kinematics only", "both"]
        assert done.row("sub/bare.urdf")[6] == "no body has mass"
        broken = done.row("sub/broken.urdf")
        assert broken[1:6] == ["refused", "–", "–", "–", "–"]
        assert broken[6].startswith("broken.urdf:")
        assert done.out.endswith(": incomplete. 3 robots: agrees 1, DISAGREES 0, kinematics only 1, refused 1.\n")
        record = written(tmp_path / "r.json")
        assert [Path(robot["robot"]).name for robot in record["robots"]] == ["good.urdf", "bare.urdf"]
        assert [Path(failure["robot"]).name for failure in record["failures"]] == ["broken.urdf"]
        assert record["unfinished"] == []
        assert record["agrees"] is False
        assert any("moving links without <inertial>" in note for note in record["robots"][1]["notes"])

    def test_kinematics_only_counts_as_agreeing(self, program, here, good_folder, tmp_path):
        done = program(good_folder, "--samples", 1, "--json", tmp_path / "r.json")
        assert done.code == AGREED
        assert written(tmp_path / "r.json")["agrees"] is True

    def test_some_mass_is_too_little(self, program, here, folder, small_arm_text):
        text = without_mass(small_arm_text)
        inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        text = re.sub(r'<link name="upper"\s*/?>(</link>)?', f'<link name="upper">{inertial}</link>', text, count=1)
        (folder / "sub/half.urdf").write_text(text, encoding="utf-8")
        row = program(folder, "--samples", 1).row("sub/half.urdf")
        assert row[1] == "kinematics only"
        assert row[6].startswith("forward dynamics not compared: the mass matrix")
        assert row[6].count("inertia") == 2

    def test_disagreement(self, program, here, good_folder, plant: Plant):
        """The plant strikes the first file only."""
        plant.pinocchio_value("tau", lambda x: x * (1 + 1e-9))
        done = program(good_folder, "--samples", 1)
        assert done.code == DISAGREED
        row = done.row("good.urdf")
        assert row[1] == "DISAGREES"
        assert row[3] in ("inverse_dynamics", "inverse_dynamics_recursive")  # the same wrong number, up to rounding
        assert row[6] == "beyond the bound: inverse_dynamics, inverse_dynamics_recursive"
        assert "agrees 0, DISAGREES 1, kinematics only 1, refused 0" in done.out

    def test_not_finite_is_nearest(self, program, here, good_folder, plant: Plant):
        plant.pinocchio_value("tau", lambda _: float("nan"))
        assert program(good_folder, "--samples", 1).row("good.urdf")[3:5] == ["inverse_dynamics", "∞"]

    def test_refused_outweighs_disagreement(self, program, here, folder, plant: Plant):
        plant.pinocchio_value("tau", lambda x: x * (1 + 1e-9))
        assert program(folder, "--samples", 1).code == BAD_INPUT

    def test_what_pinocchio_refuses(self, program, here, folder):
        path = folder / "sub" / "twice.urdf"
        text = (folder / "good.urdf").read_text(encoding="utf-8")
        material = '<material name="black"><color rgba="0 0 0 1"/></material>'
        path.write_text(text.replace("</robot>", f"{material}{material}</robot>"), encoding="utf-8")
        row = program(folder, "--samples", 1).row("sub/twice.urdf")
        assert row[1:3] == ["agrees", "model"]
        assert row[6].startswith("route 'urdf' not taken: Pinocchio cannot read twice.urdf")
        assert "wrote: Error: material 'black' is not unique." in row[6]

    def test_an_error_of_the_program_stays_with_its_file(self, program, here, good_folder, monkeypatch):
        original = comparing.compare

        def compare(robot, *arguments):
            if "bare" in robot:
                raise ZeroDivisionError("no reason")
            return original(robot, *arguments)

        monkeypatch.setattr(comparing, "compare", compare)
        done = program(good_folder, "--samples", 1)
        assert done.code == BAD_INPUT
        assert done.row("sub/bare.urdf")[6] == "the comparison failed: ZeroDivisionError: no reason; report it"
        assert done.row("good.urdf")[1] == "agrees"

    def test_a_process_that_died(self, program, good_folder, monkeypatch):
        monkeypatch.setattr(
            LocalProcesses, "each", lambda _self, _f, items: ((k, Lost("it died")) for k in range(len(items)))
        )
        done = program(good_folder, "--samples", 1)
        assert done.code == BAD_INPUT
        assert done.row("good.urdf")[6] == "the comparison was lost: it died; report it, with the file"


class TestArguments:
    def test_empty_folder(self, program, here, folder, tmp_path):
        done = program(folder / "empty", "--json", tmp_path / "r.json")
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: no \*\.urdf in the folder .*empty.*\n", done.err)
        assert here == []
        assert done.out.startswith("graphdyn against Pinocchio: incomplete\n1 robot: agrees 0,")
        (failure,) = written(tmp_path / "r.json")["failures"]
        assert failure["robot"] == str(folder / "empty")

    def test_with_names_and_twice(self, program, here, examined, good_folder):
        assert program("kr500", good_folder, good_folder / "good.urdf", "--samples", 1).code == AGREED
        assert here == ["kr500", "good.urdf", "bare.urdf"]

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (["--lock", "y_elbow"], "--lock and --chain need exactly one robot"),
            (["--resume"], "--resume needs --json FILE"),
            (["--jobs", "0"], "'--jobs'"),
            (["--jobs", "2", "--scheduler", "tcp://a:1"], "--jobs and --scheduler exclude each other"),
        ],
    )
    def test_refused(self, program, here, folder, options, message):
        done = program(folder, *options)
        assert done.code == BAD_INPUT
        assert message in re.sub(r"\s*\n\W*", " ", done.err)
        assert here == []

    @pytest.mark.parametrize(
        "options", [["--jobs", 2], ["--resume"], ["--scheduler", "tcp://a:1"]], ids=lambda options: options[0]
    )
    def test_without_a_folder(self, program, options):
        done = program("kr500", *options)
        assert done.code == BAD_INPUT
        assert "--jobs, --scheduler and --resume are for folders" in done.err

    def test_a_robot_of_the_catalog_comes_before_a_folder(self, program, here, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        Path("kr500").mkdir()
        done = program("kr500", "--samples", 1)
        assert done.code == AGREED
        assert here == []


@pytest.mark.usefixtures("examined")
class TestResume:
    @pytest.fixture
    def sweep(self, program, here, good_folder, tmp_path):
        """Sweeps once and returns a function that goes on with what was written, and tells what was compared."""
        path = tmp_path / "r.json"
        program(good_folder, "--samples", 1, "--json", path)

        def again(*options):
            here.clear()
            done = program(good_folder, "--json", path, "--resume", *(options or ("--samples", 1)))
            return here[:], done, path

        return again

    def test_nothing_is_left(self, sweep):
        compared, done, path = sweep()
        assert compared == []
        assert done.code == AGREED
        assert f"2 of 2 robots taken over from {path}" in done.err
        assert done.row("good.urdf")[1] == "agrees"
        assert len(written(path)["robots"]) == 2

    def test_quantities_under_the_names_of_the_format_before(self, sweep, tmp_path):
        path, names = tmp_path / "r.json", {now: before for before, now in NAMES_BEFORE.items()}
        record = written(path)
        present = [set(robot["quantities"]) for robot in record["robots"]]
        for robot in record["robots"]:
            stems = {name: re.sub(r"(_projected|_external|_recursive)*$", "", name) for name in robot["quantities"]}
            robot["quantities"] = {
                names.get(stems[name], stems[name]) + name[len(stems[name]) :]: value
                for name, value in robot["quantities"].items()
            }
            assert {"torque_external", "link_twist", "da_dpi_recursive"} <= set(robot["quantities"])
        path.write_text(json.dumps(record | {"format": "graphdyn crosscheck 2"}), encoding="utf-8")
        assert sweep()[0] == []
        assert written(path)["format"] == "graphdyn crosscheck 3"
        assert [set(robot["quantities"]) for robot in written(path)["robots"]] == present

    @pytest.mark.parametrize("lost", [["quantities"], ["conditioning", "kkt_rank"], ["quantities", 0, "bound"]])
    def test_a_record_that_is_not_whole_is_compared_again(self, sweep, tmp_path, lost):
        path = tmp_path / "r.json"
        record = written(path)
        *inside, name = lost
        part = record["robots"][0]
        for step in inside:
            part = part[step] if isinstance(step, str) else list(part.values())[step]
        del part[name]
        path.write_text(json.dumps(record), encoding="utf-8")
        assert sweep()[0] == ["good.urdf"]

    def test_a_changed_file(self, sweep, good_folder):
        path = good_folder / "good.urdf"
        path.write_text(path.read_text(encoding="utf-8") + "\n", encoding="utf-8")
        assert sweep()[0] == ["good.urdf"]

    @pytest.mark.parametrize("options", [("--samples", 2), ("--samples", 1, "--seed", 1)])
    def test_other_states(self, sweep, options):
        assert sweep(*options)[0] == ["good.urdf", "bare.urdf"]

    def test_other_versions(self, sweep, monkeypatch):
        monkeypatch.setattr("crosscheck.reference.pinocchio_model.PINOCCHIO_VERSION", "0")
        assert sweep()[0] == ["good.urdf", "bare.urdf"]

    def test_failures_are_tried_again(self, sweep, good_folder):
        (good_folder / "sub" / "new.urdf").write_text("<robot", encoding="utf-8")
        assert [sweep()[0] for _ in range(2)] == [["new.urdf"], ["new.urdf"]]

    def test_interrupted(self, program, here, good_folder, tmp_path, monkeypatch):
        """What was finished is in the file, which says what is not."""
        each, path = LocalProcesses.each, tmp_path / "r.json"

        def interrupted(*arguments):
            yield next(each(*arguments))
            raise KeyboardInterrupt

        with monkeypatch.context() as patch:
            patch.setattr(LocalProcesses, "each", interrupted)
            done = program(good_folder, "--samples", 1, "--json", path)
        assert done.code not in (AGREED, DISAGREED, BAD_INPUT, INTERNAL_ERROR)
        record = written(path)
        assert [Path(robot).name for robot in record["unfinished"]] == ["bare.urdf"]
        assert record["agrees"] is False
        here.clear()
        assert program(good_folder, "--samples", 1, "--json", path, "--resume").code == AGREED
        assert here == ["bare.urdf"]

    @pytest.mark.parametrize(
        "content",
        ["not JSON", "[]", '{"format": "graphdyn robots 1"}', '{"format": "graphdyn crosscheck 3"}', "[" * 10**5],
    )
    def test_some_other_file(self, program, here, good_folder, tmp_path, content):
        path = tmp_path / "r.json"
        path.write_text(content, encoding="utf-8")
        done = program(good_folder, "--json", path, "--resume")
        assert done.code == BAD_INPUT
        assert "is not a file of the format 'graphdyn crosscheck 3'; name another, or delete it" in done.err
        assert path.read_text(encoding="utf-8") == content
        assert here == []

    def test_writing_takes_little_of_the_time(self, tmp_path, monkeypatch):
        file, writes = SweepFile(OutputFile(str(tmp_path / "r.json")), [], [], []), []
        monkeypatch.setattr(OutputFile, "write", lambda *_: writes.append(clock.pop()))
        clock = [1000.0, 11.0, 1.0]
        monkeypatch.setattr("crosscheck.commands.crosscheck.folder_file.time.monotonic", lambda: times.pop(0))
        times = [0.0, 1.0, 9.9, 10.1, 10.2, 10.3, 10.4]
        file.write()
        file.write()
        assert len(writes) == 1
        file.write()
        assert len(writes) == 2
        file.write(finished=True)
        assert len(writes) == 3


@pytest.mark.usefixtures("unpictured")
class TestPage:
    def test_few(self, program, here, folder, tmp_path):
        path = tmp_path / "r.html"
        program(folder, "--samples", 1, "--html", path)
        html = path.read_text(encoding="utf-8")
        assert html.count('class="sheet"') == 2
        assert '<a href="#robot-1">good.urdf</a>' in html
        assert '<span class="name">sub/broken.urdf</span>' in html
        assert "no body has mass" in html
        assert "Robots taken over" not in html

    def test_taken_over(self, program, here, good_folder, tmp_path):
        path, options = tmp_path / "r.html", ("--samples", 1, "--json", tmp_path / "r.json")
        program(good_folder, *options)
        program(good_folder, *options, "--resume", "--html", path)
        html = path.read_text(encoding="utf-8")
        assert 'class="sheet"' not in html
        assert "Robots taken over from an earlier run have no details here" in html

    def test_many(self, program, here, folder, tmp_path, plant: Plant, monkeypatch):
        plant.pinocchio_value("tau", lambda x: x * (1 + 1e-9))
        monkeypatch.setattr(report_of_folder, "MAX_DETAILED_ROBOTS", 1)
        path = tmp_path / "r.html"
        program(folder, "--samples", 1, "--html", path)
        html = path.read_text(encoding="utf-8")
        assert html.count('class="sheet"') == 1
        assert '<a href="#robot-1">good.urdf</a>' in html
        assert "Details are shown of robots that disagree" in html


class TestVerdict:
    @pytest.mark.parametrize(
        ("verdicts", "words"),
        [
            (["agrees", "agrees"], "agrees"),
            (["agrees", "kinematics only"], "no robot disagrees"),
            (["kinematics only", "refused"], "incomplete"),
            (["refused", "DISAGREES", "agrees"], "DISAGREES"),
        ],
    )
    def test_of_all_robots(self, verdicts, words):
        rows = [summary.RobotSummary(f"r{k}", verdict, (), None, None, None, "") for k, verdict in enumerate(verdicts)]
        assert report_of_folder.folder_report(rows, []).verdict.words == words


class TestSummary:
    @pytest.mark.parametrize(("error", "bound", "part"), [(1, 2, 0.5), (0, 0, 0), (1e-300, 0, float("inf"))])
    def test_part_of_bound(self, error, bound, part):
        assert part_of_bound(error, bound) == part

    @pytest.mark.parametrize(
        ("robots", "names"),
        [
            (["a/b/c.urdf", "a/b/d/c.urdf"], ["c.urdf", "d/c.urdf"]),
            (["a/bc.urdf", "a/bd.urdf"], ["bc.urdf", "bd.urdf"]),
            (["kr500", "a/b.urdf"], ["kr500", "a/b.urdf"]),
            (["/x.urdf", "/y.urdf"], ["x.urdf", "y.urdf"]),
        ],
    )
    def test_short_names(self, robots, names):
        rows = [summary.failed_row({"robot": robot, "message": ""}) for robot in robots]
        assert summary.short_names(rows) == names


@LONG
def test_vendor_arms(program, here, tmp_path):
    """One file is refused by Pinocchio and compared by the model route alone."""
    folder = tmp_path / "arms"
    folder.mkdir()
    for name in VENDOR_ARMS:
        shutil.copy(existing(ARMS / f"{name}.urdf"), folder)
    done = program(folder, "--samples", 1, "--json", tmp_path / "r.json")
    assert done.code == AGREED
    counts = "2 robots: agrees 1, DISAGREES 0, kinematics only 1, refused 0; 1 by the route 'model' alone"
    assert counts in " ".join(done.out.split())
    assert done.out.endswith("graphdyn against Pinocchio: no robot disagrees\n")
    rows = [summary.compared_row(record) for record in written(tmp_path / "r.json")["robots"]]
    assert {Path(row.robot).stem: (row.verdict, row.routes) for row in rows} == VENDOR_ARMS
    assert all(row.reason for row in rows)
