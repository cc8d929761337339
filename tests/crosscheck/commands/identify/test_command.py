"""`graphdyn identify`: options, tables, files and exit codes, on recordings of a simulated arm."""

import contextlib
import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
import typer
from jsonschema import Draft202012Validator
from planting import mixed_tree
from shared_data import REPOSITORY
from shown.browser import CHROMIUM, too_wide
from shown.pages import parsed
from typer.testing import CliRunner

import urdf
from crosscheck.commands import app
from crosscheck.commands.identify import command
from crosscheck.commands.identify.options import IdentifyOptions
from crosscheck.commands.program import own_process
from crosscheck.commands.program.reading_options import ReadingOptions
from crosscheck.identifying import friction_terms, virtual_robot
from crosscheck.recordings.errors import RecordingFinding
from graphdyn import InvalidInput

SCHEMA = REPOSITORY / "docs/schemas/identify-3.schema.json"

METHODS = "ols,wls,wls-pinocchio,consistent,graph"

QUICK = ("--poses", "20")

STANDARD_TERMS = ("--terms", "viscous,coulomb,offset")
"""For what has nothing to do with the choice of terms, which takes a second."""

LARGEST = 5_000_000
"""Characters of a page."""

OWN_CODE = """
import numpy as np
from graphdyn.identification import Estimate
from graphdyn.identification.terms import Offset

def nothing(q, v, a):
    return 0 * q

def square(q, v, a):
    return q**2

def offset():
    return Offset()

class Prior:
    name, reference, assumptions, needs = "prior", "none", "CAD is right", "nothing"
    def estimate(self, problem):
        return Estimate(problem.torque_model.prior())

def empty():
    return object()

class Borrowed(Offset):
    def rows(self, model, samples):
        return super().rows(model, samples) * samples.tau[:, :, None]
"""


@pytest.fixture(autouse=True)
def here(monkeypatch):
    """Own code runs in this process."""
    monkeypatch.setattr(own_process, "tell", lambda _: None)


@pytest.fixture
def program(tmp_path, monkeypatch):
    """Runs the command in an empty folder; gives exit code and everything that was printed."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        done = CliRunner().invoke(app, ["identify", *map(str, arguments)])
        return done.exit_code, " ".join(done.output.split())

    return run


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """URDF of a small arm with wrong inertials; two recordings as CSV; the same in two files with a mapping."""
    folder = tmp_path_factory.mktemp("arm")
    urdf.save(mixed_tree().with_gravity([0, 0, -9.81]), folder / "true.urdf")
    virtual = virtual_robot(folder / "true.urdf", friction_terms(["viscous", "coulomb"]), seconds=10.0)
    urdf.save(virtual.subject.model, folder / "arm.urdf")
    names = virtual.fitted.joint_names
    for name, recording in (("one", virtual.fitted), ("two", virtual.held_out)):
        table = np.column_stack([recording.t, recording.q, recording.tau])
        head = ",".join(["time_s", *(f"q_{j}" for j in names), *(f"tau_{j}" for j in names)])
        np.savetxt(folder / f"{name}.csv", table, delimiter=",", header=head, comments="")
        np.savetxt(folder / f"pos_{name}.csv", recording.q, delimiter=",", header=",".join(names), comments="")
        np.savetxt(folder / f"cur_{name}.csv", recording.tau, delimiter=",", header=",".join(names), comments="")
    (folder / "mapping.toml").write_text(
        f"joints = {json.dumps(names)}\nrate = 250\nprismatic = {json.dumps(list(recording.prismatic))}\n"
        '[q]\nfile = "pos_*.csv"\ncolumns = "{joint}"\n'
        f"unit = {json.dumps(['m' if slides else 'rad' for slides in recording.prismatic])}\n"
        '[tau]\nfile = "cur_*.csv"\ncolumns = "{joint}"\n'
        f"unit = {json.dumps(['N' if slides else 'N m' for slides in recording.prismatic])}\n",
        encoding="utf-8",
    )
    (folder / "own.py").write_text(OWN_CODE, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def two_files(arm):
    return arm / "pos_one.csv", arm / "cur_one.csv", "--mapping", arm / "mapping.toml", "--robot", arm / "arm.urdf"


class TestFiles:
    def test_everything_at_once(self, program, two_files, arm, tmp_path):
        files = {name: tmp_path / f"found.{name}" for name in ("json", "html", "urdf")}
        written = [text for name, path in files.items() for text in (f"--{name}", path)]
        code, said = program(
            *two_files,
            "--cutoff",
            10,
            "--terms",
            "viscous,coulomb",
            "--methods",
            METHODS,
            "--validate",
            arm / "pos_two.csv",
            "--validate",
            arm / "cur_two.csv",
            *written,
            *QUICK,
        )
        assert code == 0, said
        for text in (
            "Methods",
            "Errors, held out",
            "Errors, fitted",
            "Parameters by consistent",
            "Base parameters",
            "Links",
            "arm.urdf identified: recommended method: consistent",
        ):
            assert text in said
        assert "graph method: failed: the recording has torques about the joint axes alone" in said
        recording = json.loads(files["json"].read_text(encoding="utf-8"))
        Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8"))).validate(recording)
        assert recording["usable"]
        assert recording["recommended"] == "consistent"
        assert recording["recording"]["held_out_files"] == [str(arm / "pos_two.csv"), str(arm / "cur_two.csv")]
        assert recording["truth"] is None
        self.check_urdf(files["urdf"], arm, recording)
        page = files["html"].read_text(encoding="utf-8")
        self.check_page(page, recording)
        assert CHROMIUM is None or too_wide({"page.html": page}, tmp_path) == []

    @pytest.mark.parametrize("given", [{}, {"terms": ["viscous", "none"]}])
    def test_what_only_rounded_angles_show_is_kept_if_asked_for(self, given):
        for kept in (True, False):
            options = IdentifyOptions(robot="r", logs=["x.csv"], angles_as_written=kept, **given)
            models = [model.of(urdf.load("kr500")) for model in options.candidates(["wls"])]
            assert {model.exact_angles for model in models} == {not kept}

    @pytest.mark.usefixtures("unexamined")
    def test_terms_that_choose_themselves(self, program, two_files, tmp_path):
        """The report and the file say how; the terms are a file for --models."""
        json_file = tmp_path / "found.json"
        asked = ("--cutoff", 10, "--methods", "wls", "--known-bodies", "--json", json_file, *QUICK)
        code, said = program(*two_files, *asked)
        assert code in (0, 1), said
        record = json.loads(json_file.read_text(encoding="utf-8"))
        Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8"))).validate(record)
        assert "Terms of the drives chosen viscous; " in said
        assert record["ladder"]["terms"][0] == '"viscous"'
        assert not record["ladder"]["reason"]
        assert {step["rung"] for step in record["ladder"]["steps"]} >= {1}
        models = tmp_path / "chosen.toml"
        models.write_text(f"[chosen]\nterms = [{', '.join(record['ladder']['terms'])}]\n", encoding="utf-8")
        again = tmp_path / "again.json"
        asked = ("--cutoff", 10, "--methods", "wls", "--known-bodies", "--json", again, *QUICK)
        code, said = program(*two_files, "--models", models, *asked)
        same = json.loads(again.read_text(encoding="utf-8"))
        assert same["ladder"] is None
        assert "Terms of the drives" not in said
        assert same["methods"][0]["parameters"] == pytest.approx(record["methods"][0]["parameters"])

    def check_urdf(self, path, arm, recording):
        new, true, cad = (urdf.load(p) for p in (path, arm / "true.urdf", arm / "arm.urdf"))
        wanted = np.array([list(body["identified"].values()) for body in recording["shown"]["bodies"]])
        np.testing.assert_allclose(new.inertial_parameters, wanted.ravel(), rtol=1e-9, atol=1e-12)
        assert all(consistency.problems == () for consistency in new.physical_consistency())
        base = [row["name"] for row in recording["shown"]["base_parameters"]]
        assert len(base) == recording["rank"]
        off, wrong = (np.abs(x.inertial_parameters - true.inertial_parameters).sum() for x in (new, cad))
        assert off < wrong

    def check_page(self, page, recording):
        root = parsed(page)
        assert len(page) < LARGEST
        assert not re.findall(r'(?:src|href)="(?!#)', page)
        assert len(root.findall(".//svg")) == 2 * len(recording["joint_names"]) + 3
        text = " ".join(" ".join(root.itertext()).split())
        for method in recording["methods"]:
            assert method["name"] in text
        for joint in recording["joint_names"]:
            for side in ("fitted", "held out"):
                measured = f"Measured and predicted (torque|force) of {joint}; {side}: root mean square error"
                assert re.search(measured, page)
        assert "✓ The model of the method “consistent” is recommended." in text
        assert "None" not in text
        assert "nan" not in text.lower().split()

    @pytest.mark.usefixtures("unexamined")
    def test_nothing_is_written_without_a_real_robot(self, program, two_files, tmp_path):
        code, said = program(
            *two_files,
            "--cutoff",
            10,
            "--methods",
            "ols",
            "--choose",
            "ols",
            "--terms",
            "viscous",
            "--urdf",
            tmp_path / "out.urdf",
            *QUICK,
        )
        assert code == 1
        assert "no usable model CAD links: WLS is the best result, but" in said
        assert "is not written: OLS is not physically consistent" in said
        assert not (tmp_path / "out.urdf").exists()

    @pytest.mark.usefixtures("unexamined", "unpictured")
    def test_a_mass_that_a_limit_holds_is_told_where_it_is_written(self, program, two_files, tmp_path):
        """In the table of links, in JSON, on the page, and beside the written file."""
        files = [tmp_path / f"found.{suffix}" for suffix in ("json", "html", "urdf")]
        outputs = [word for file in files for word in (f"--{file.suffix[1:]}", file)]
        limited = ("--cad-factor", "1.001,body2=inf", "--methods", "consistent", "--choose", "consistent")
        _, said = program(*two_files, "--cutoff", 10, *limited, *outputs, *QUICK)
        shown = json.loads(files[0].read_text("utf-8"))["shown"]
        reached = [each for each in shown["reached_limits"] if each["quantity"] == "mass"]
        assert {each["body"] for each in reached} == {body["name"] for body in shown["bodies"]} - {"body2"}
        for each in reached:
            told = f"mass of {each['body']} is {each['value']:.3g} kg, held by its limit of {each['limit']:.3g} kg"
            assert said.count(told) == 2  # below the links, and where the file is written
            assert told in files[1].read_text("utf-8")
            assert any(finding["message"].startswith(told) for finding in shown["link_findings"])
        assert "undetermined by this recording" in said

    def test_the_folder_must_exist(self, program, two_files):
        code, said = program(*two_files, "--urdf", "nowhere/out.urdf")
        assert code == 2
        assert "--urdf nowhere/out.urdf: folder" in said


MODELS = """
[plain]
terms = ["viscous", {term = "coulomb", width = 0.05}]
methods = ["wls", {method = "pullback", strength = 10}, {method = "pullback", strength = 1e7, name = "strong"}]

[known]
terms = ["viscous", "own.py:offset", {term = "coulomb", width = "fit"}, "viscous*time"]
expected = {FC_1 = [10, 100]}
noise = [2, 1, 1]
known_torques = ["own.py:nothing"]
known_bodies = true
"""


class TestLimits:
    def test_factors(self):
        limits = IdentifyOptions(robot="arm.urdf", cad_factor="2, wrist=inf,elbow=1.5").limits
        assert (limits.cad_factor, limits.cad_factors) == (2.0, {"wrist": np.inf, "elbow": 1.5})
        assert IdentifyOptions(robot="arm.urdf", cad_factor="inf").limits.cad_factor == np.inf
        assert not IdentifyOptions(robot="arm.urdf").limits.stated

    @pytest.mark.parametrize("text", ["0.5", "x", "wrist=", "=2", "wrist=0", "nan", "2,"])
    def test_no_factors(self, text):
        message = f"--cad-factor {text}: give numbers of 1 or more, LINK=NUMBER, or inf for no limit"
        with pytest.raises(typer.BadParameter, match=re.escape(message)):
            _ = IdentifyOptions(robot="arm.urdf", cad_factor=text).limits

    def test_unknown_link(self, program, two_files):
        code, said = program(*two_files, "--cad-factor", "wrist=2", *QUICK)
        assert code == 2
        assert "there is no link 'wrist' to limit" in said


@pytest.mark.usefixtures("unexamined")
class TestModels:
    def test_several_in_one_comparison(self, program, two_files, arm, tmp_path):
        """Folds of the first recording choose, the second is predicted; every row has its errors in the file."""
        (arm / "models.toml").write_text(MODELS, encoding="utf-8")
        more = ("--validate", arm / "pos_two.csv", "--validate", arm / "cur_two.csv")
        code, said = program(
            *two_files, "--cutoff", 10, "--models", arm / "models.toml", "--methods", "wls", "--folds", 3, *more,
            "--allow-code", "--json", tmp_path / "x.json", *QUICK,
        )  # fmt: skip
        assert code == 0, said
        written = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
        Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8"))).validate(written)
        rows = {row["name"]: row for row in written["comparison"]}
        assert list(rows) == [
            "plain: WLS", "plain: consistent, pullback prior, strength 10", "plain: strong",
            "plain, CAD links: WLS", "known: WLS",
        ]  # fmt: skip
        for name, row in rows.items():
            assert [trial["name"] for trial in row["trials"]] == ["fold 1", "fold 2", "fold 3"]
            assert [trial["name"] for trial in row["aside"]] == ["pos_two.csv"]
            assert name in said
        assert written["recommended"] == "plain: consistent, pullback prior, strength 10"
        errors = [rows[f"plain{name}"]["mean_error"] for name in (": WLS", ": strong", ", CAD links: WLS")]
        assert errors == sorted(errors)
        (plain, cad, known) = (written["base_matrix"], *(model["base_matrix"] for model in written["other_models"]))
        assert [len(matrix) for matrix in (plain, cad, known)] == [written["rank"], 6, 12]
        (width,) = written["other_models"][1]["settings"]
        assert (width["name"], len(width["values"]), written["settings"]) == ("coulomb width", 3, [])
        symbols = {parameter["symbol"] for parameter in written["base_parameters"]}
        assert any("R_" in symbol for symbol in symbols)
        assert "FV_1" in symbols
        assert "Errors, held out, one by one" in said
        assert "Errors, kept aside: pos_two.csv" in said

    def test_repeated_terms(self, program, two_files):
        code, said = program(
            *two_files, "--cutoff", 10, "--terms", "viscous,coulomb", "--terms", "viscous", "--width", "0.05,0.1,0.05",
            "--methods", "consistent", *QUICK,
        )  # fmt: skip
        assert code == 0, said
        assert "recommended method: viscous,coulomb: consistent" in said
        assert "viscous, CAD links: WLS" in said

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "the file has no table; give one per torque model, such as [gears]"),
            ("x = 1", "[x] is no table; give one per torque model"),
            ("[a", "models.toml: "),
            ("x = " + "[" * 5000, "models.toml: is no TOML: more than 50 tables or lists within each other"),
            ("[" + "a." * 20_000 + "a]", "models.toml: line 1: a key of more than 50 parts"),
            ("[a]\nterms = []\nnoise = " + "9" * 400, "a.noise is a number of some 400 digits; give one below 1e308"),
            ("[a]\nkind = 1", "[a] kind: unknown; a torque model has terms, methods, known_torques, scaled_torques"),
            ("[a]\nmethods = []", "[a]: terms are missing; give a list, which may be empty"),
            ("[a]\nterms = 'viscous'", "[a] terms is 'viscous'; give a list of names"),
            ("[a]\nterms = [{width = 1}]", "names no term; write {term = NAME, …}"),
            ("[a]\nterms = [{term = 'offset', width = 1}]", "the term 'offset' has no setting 'width'; it has: none"),
            ("[a]\nterms = []\nmethods = [{method = 'wls', strength = 1}]", "'wls' has no setting 'strength'"),
            ("[a]\nterms = []\nmethods = ['magic']", "there is no method 'magic'"),
            ("[a]\nterms = []\nexpected = 3", "[a] expected is 3; give SYMBOL = [value, standard deviation]"),
            ("[a]\nterms = []\nexpected = {FC_1 = 3}", "[a] expected FC_1 is 3; give [value, standard deviation]"),
            (
                "[a]\nterms = [{term = 'rotor', gears = 'fit'}]",
                "the setting 'gears' cannot be found by a fit; these can",
            ),
            (
                "[a]\nterms = [{term = 'slip', deflection = 'fit', deflections = [0.1]}]",
                "the term 'slip' has a deflection, and deflections; give one of the two",
            ),
            (
                "[a]\nterms = [{term = 'rotor', axes = [[0, 0, 1]]}]",
                "axes of the rotors have no effect without their gears; give both",
            ),
            ("[a]\nterms = []\nknown_torques = [{a = 1}]", "known_torques is [{'a': 1}]; give a list of FILE.py:NAME"),
            ("[a]\nterms = ['offset*load']", "there is no term 'offset*load'; known: viscous"),
            ("[a]\nterms = []\nknown_bodies = 1", "known_bodies is 1; give true or false"),
        ],
    )
    def test_bad_files(self, program, two_files, tmp_path, text, message):
        (tmp_path / "models.toml").write_text(text, encoding="utf-8")
        code, said = program(*two_files, "--models", "models.toml")
        assert code == 2
        assert message in " ".join(re.sub("[│╭╰─╮╯]", " ", said).split())

    @pytest.mark.parametrize(
        ("options", "text", "message"),
        [
            ((), "terms = ['evil.py:T']", "names Python code, evil.py:T, which can do whatever you can; read it"),
            ((), "terms = []\nmethods = ['evil.py:T']", "add --allow-code"),
            ((), "terms = []\nknown_torques = ['evil.py:T']", "add --allow-code"),
            ((), "terms = []\nscaled_torques = ['evil.py:T']", "add --allow-code"),
            (("--allow-code",), "terms = ['os:abort']", "os:abort is a module, which no file may run"),
            (("--allow-code",), "terms = ['evil.py:T', 'os:abort']", "os:abort is a module"),
            (("--allow-code",), "terms = []\nscaled_torques = ['os:abort']", "os:abort is a module"),
            (("--allow-code",), "terms = ['evil.py:T']\n[b]", "[b]: terms are missing"),
            (("--allow-code",), "terms = ['evil.py:T']\nexpected = 3", "[a] expected is 3"),
        ],
    )
    def test_code_that_a_file_names(self, program, two_files, tmp_path, monkeypatch, options, text, message):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "evil.py").write_text("open('evil.ran', 'w')", encoding="utf-8")
        (tmp_path / "models.toml").write_text(f"[a]\n{text}", encoding="utf-8")
        code, said = program(*two_files, "--models", "models.toml", *options)
        assert code == 2
        assert message in " ".join(re.sub("[│╭╰─╮╯]", " ", said).split())
        assert not (tmp_path / "evil.ran").exists()

    def test_options_that_the_file_has_a_place_for(self, program, two_files):
        code, said = program(*two_files, "--models", "models.toml", "--width", "0.1")
        assert code == 2
        assert "--width and --models exclude each other; write it in the file" in said


class TestSimulated:
    @pytest.mark.usefixtures("unexamined")
    def test_truth_is_shown(self, program, arm, tmp_path):
        code, said = program(
            "--robot",
            arm / "true.urdf",
            "--seconds",
            10,
            "--methods",
            "consistent,graph",
            "--json",
            tmp_path / "x.json",
            *QUICK,
        )
        assert code == 0, said
        assert "truth" in said
        assert "held out all of simulated motion 2 of" in said
        recording = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
        Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8"))).validate(recording)
        assert len(recording["truth"]) == len(recording["parameters"])
        assert (recording["robot"], recording["file"]) == (str(arm / "true.urdf"), str(arm / "true.urdf"))
        assert recording["methods"][1]["failure"] is None

    def test_options_that_need_a_log(self, program):
        for option, value in (("--validate", "x.csv"), ("--folds", "3"), ("--payload", "unknown"), ("--rate", "5")):
            code, said = program("--robot", "kr500", option, value)
            assert code == 2
            assert f"{option} needs a LOG; without one the robot is simulated" in said

    def test_a_term_that_reads_the_torque(self, program, arm):
        code, said = program("--robot", "kr500", "--terms", "none", "--term", f"{arm / 'own.py'}:Borrowed", *QUICK)
        assert code == 2
        assert "a term reads samples.tau, the torque it is to explain" in said


@pytest.mark.usefixtures("unexamined")
class TestOptions:
    def test_own_code(self, program, two_files, arm):
        own = arm / "own.py"
        code, said = program(
            *two_files,
            "--cutoff",
            "q=10,tau=10",
            "--terms",
            "viscous,coulomb",
            "--term",
            f"{own}:offset",
            "--known-torque",
            f"{own}:nothing",
            "--scaled-torque",
            f"{own}:square",
            "--methods",
            f"wls,{own}:Prior",
            "--split",
            "0:6",
            "6:",
            "--decimate",
            "5",
            *QUICK,
        )
        assert code in (0, 1), said
        assert "prior" in said
        assert "OFF_1" in said
        assert " square " in said

    @pytest.mark.parametrize(
        ("payload", "expected"), [("unknown@0,0,0.1", "M_L"), ("unknown", "XX_L"), ("1@0,0,0.1", "FV_1")]
    )
    def test_payloads(self, program, two_files, payload, expected):
        code, said = program(
            *two_files,
            "--cutoff",
            10,
            "--known-bodies",
            *STANDARD_TERMS,
            "--payload",
            payload,
            "--methods",
            "wls",
            "--split-rows",
            "100:1500",
            "1600:",
            "--min-speed",
            "0.02",
            *QUICK,
        )
        assert code in (0, 1), said
        assert expected in said
        assert "/ % of fitted rows" in said

    def test_folds(self, program, two_files):
        code, said = program(*two_files, "--cutoff", 10, *STANDARD_TERMS, "--methods", "wls", "--folds", 3, *QUICK)
        assert code in (0, 1), said
        assert "3 consecutive folds, each from the others" in said

    def test_gravity_is_found(self, program, arm, tmp_path):
        options = ("--cutoff", 10, "--methods", "wls", *STANDARD_TERMS, *QUICK, "--json", tmp_path / "found.json")
        code, said = program(arm / "one.csv", "--robot", arm / "arm.urdf", "--gravity", "free", *options)
        assert code in (0, 1), said
        record = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
        found = np.array(record["gravity"])
        assert np.rad2deg(np.arccos(-found[2] / np.linalg.norm(found))) < 2
        assert 0 < record["gravity_deviation"] < 2
        assert "in world axes, direction ± " in said

    def test_findings_of_the_files_are_told(self, program, arm):
        options = ("--cutoff", 10, "--methods", "wls", *STANDARD_TERMS, *QUICK)
        code, said = program(arm / "one.csv", "--robot", arm / "arm.urdf", *options)
        assert code == 1, said
        assert "note: " in said
        assert "rad is assumed; give units in the header [assumed-unit]" in said

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (["--cutoff", "x"], "--cutoff x: give Hz, CHANNEL=HZ,…, residual or none"),
            (["--decimate", "x"], "--decimate x: give whole numbers with commas between them"),
            (["--decimate", "2,1.5"], "--decimate 2,1.5: give whole numbers with commas between them"),
            (["--cutoff", "1_0"], "--cutoff 1_0: give Hz, CHANNEL=HZ,…, residual or none"),
            (["--cutoff", "q=nan"], "--cutoff q=nan: give Hz"),
            (["--cutoff", "q=10,20"], "--cutoff q=10,20: give Hz"),
            (["--cutoff", "q=10,q=20"], "--cutoff q=10,q=20: a channel is given twice"),
            (["--split", "0:1_0", "1:2"], "--split 0:1_0: give FIRST:LAST"),
            (["--split", "nan:1", "1:2"], "--split nan:1: give FIRST:LAST"),
            (["--min-speed", "x"], "--min-speed x: give numbers with commas between them"),
            (["--split", "0", "1"], "--split 0: give FIRST:LAST, such as 0:6"),
            (["--split-rows", "0:9", "9:", "--split", "0:1", "1:2"], "--split and --split-rows exclude each other"),
            (["--payload-on", "fore"], "--payload-on fore: say with --payload what it carries"),
            (["--payload", "x"], "--payload x: give unknown, unknown@X,Y,Z or M@X,Y,Z"),
            (["--payload", "x@0,0,0"], "--payload x@0,0,0: 'x' is neither unknown nor a mass in kg"),
            (["--methods", "magic"], "there is no method 'magic'"),
            (["--methods", "own.py:empty"], "what it makes has no name, reference, assumptions, needs, estimate"),
            (["--term", "own.py:empty"], "--term own.py:empty: what it makes has no columns, rows"),
            (["--term", "own.py:nothing"], "--term own.py:nothing: missing a required argument: 'q'; give a"),
            (["--terms", "magic"], "there is no term 'magic'"),
            (["--choose", "magic", "--methods", "wls", "--cutoff", "10"], "there is no method 'magic'; known: WLS"),
            (["--drop", "magic"], "drop has 'magic'; rows can be dropped for"),
            (["--validate", "pos_two.csv"], "--validate: 1 file, but"),
            (["--terms", "viscous", "--width", "0.1"], "a width is given, but none of the terms (viscous) has one"),
            (["--terms", "none", "--width", "0.1"], "a width is given, but none of the terms (none) has one"),
            (["--stribeck-velocity", "0.2"], "a Stribeck velocity is given, but none of the terms (viscous, coulomb"),
            (["--free-gravity", "--gravity", "0", "0", "-9"], "--gravity X Y Z and --gravity free exclude each other"),
            (["--seed", "0"], "--seed is for the simulated robot; leave it out with a LOG"),
            (["--seconds", "20"], "--seconds is for the simulated robot; leave it out with a LOG"),
            (["--cutoff", "q=5,q=10"], "--cutoff q=5,q=10: a channel is given twice; give each once"),
            (["--validate", "pos_one.csv", "--validate", "cur_one.csv", "--cutoff", "10"], "rows are fitted and pred"),
            (["pos_one.csv", "cur_one.csv"], "is given twice; rows that count twice look more certain than they are"),
            (["--term", "own.py:Borrowed", "--terms", "none"], "a term reads samples.tau, the torque it is to explain"),
        ],
    )
    def test_bad_input(self, two_files, arm, monkeypatch, options, message):
        monkeypatch.chdir(arm)
        done = CliRunner().invoke(app, ["identify", *map(str, two_files), *options, *QUICK])
        said = " ".join(re.sub("[│╭╰─╮╯]", " ", done.output).split())
        assert done.exit_code == 2, said
        assert message in said

    def test_nothing_given_simulates_the_ur5(self, program, monkeypatch):
        def virtual_robot(robot, *_, **how):
            raise InvalidInput(f"{robot} for {how['seconds']} s")

        monkeypatch.setattr("crosscheck.identifying.virtual_robot", virtual_robot)
        assert program() == (2, "error: ur5 for 20.0 s")

    def test_no_robot(self, program):
        code, said = program("x.csv")
        assert code == 2
        assert "--robot is missing; give a name (`graphdyn robots`) or a URDF file" in said


def test_findings_of_logs_that_are_read_part_by_part(monkeypatch):
    """Of the fitted and of the predicted ones, each once, in their order."""
    told = []
    first, second = (
        RecordingFinding(code, "note", "a.parquet", None, (), message, "give it")
        for code, message in (("assumed-unit", "no unit"), ("gap", "5 s are missing"))
    )

    def read(*findings):
        return SimpleNamespace(findings=findings)

    trials = [SimpleNamespace(test=read(second, second))]
    found = SimpleNamespace(recordings=[read(first, first)], division=SimpleNamespace(trials=trials))
    monkeypatch.setattr("crosscheck.identifying.identify", lambda *given, **options: found)
    monkeypatch.setattr("crosscheck.recordings.PartitionedRecording", lambda *given, **options: None)
    monkeypatch.setattr(command, "show_findings", lambda findings: told.extend(findings))
    workers = SimpleNamespace(kept=contextlib.nullcontext)
    reading = {**vars(ReadingOptions()), "reading": None}
    shared = {"logs": [], "validate": None, "mapping": None, "rate": None}
    options = SimpleNamespace(workers=workers, in_parts=True, **shared, **reading)
    asked = SimpleNamespace(preparation=SimpleNamespace(cutoff=10.0), _asdict=dict)
    assert command.from_parts(options, "ur5", asked) is found
    assert told == [first, second]
