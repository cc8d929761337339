"""graphdyn export: the numbers of the model in JSON, C and MATLAB, and what is said about them."""

import ast
import dataclasses
import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from faults.textbook import TextbookArm
from jsonschema import Draft202012Validator
from long_check import LONG
from planting import mixed_tree
from shared_data import ARMS, REPOSITORY, existing

import graphdyn
import urdf
from crosscheck.commands.export.languages import c_text, matlab_text
from crosscheck.commands.export.record import ExportedModel, record
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.report.records.record import plain
from graphdyn.export import c_code
from graphdyn.model.spatial import rotation_about

COMPILER = shutil.which("cc") or shutil.which("gcc")
AWKWARD = "a\"b\\c'd/*x*/?é\n"
"""Characters that mean something in C, in MATLAB or in comments."""


@pytest.fixture(scope="module")
def model():
    """A branching robot with a slide on a turned base; one joint has an awkward name."""
    tree = mixed_tree()
    first, *others = tree.joints
    tool = graphdyn.Frame("tool", 2, graphdyn.Placement(rotation_about(np.array([0.6, 0.0, 0.8]), 0.4), np.ones(3) / 3))
    joints = (dataclasses.replace(first, name=AWKWARD), *others)
    return dataclasses.replace(tree, joints=joints, frames=(tool, graphdyn.Frame("foot", 0, graphdyn.Placement())))


@pytest.fixture(scope="module")
def exported(model):
    return ExportedModel(model, AWKWARD, urdf.Reading(lock={"gripper": 0.5}, chain=("base", "tip\n")))


def constants_of_c(text):
    """name → value, read without a compiler."""
    found = re.findall(r"^static const (?:double|int) (\w+)[^=]*= (.*?);", text, re.MULTILINE | re.DOTALL)
    return {name: np.array(ast.literal_eval(value.replace("{", "[").replace("}", "]"))) for name, value in found}


class Structure:
    """What Octave makes of the file: the assignments, executed."""

    def __init__(self, text):
        for name, indices, value in re.findall(r"^model\.(\w+)(\([^=]*\))? = (.*);$", text, re.MULTILINE):
            if re.fullmatch(r"zeros\(([\d, ]+)\)", value):
                setattr(self, name, np.zeros(ast.literal_eval(value.removeprefix("zeros"))))
            elif indices:
                getattr(self, name)[..., int(indices.strip("()").split(",")[-1]) - 1] = self.number(value)
            elif not value.startswith("{"):
                setattr(self, name, self.number(value.removeprefix("logical(").removesuffix(")")))

    @staticmethod
    def number(text):
        rows = [[float(x) for x in row.split()] for row in text.rstrip("'").strip("[]").split(";")]
        return np.squeeze(rows) if len(rows) > 1 else np.array(rows[0] if text.startswith("[") else rows[0][0])


class TestNumbers:
    """Every format holds the model's own numbers to the last bit."""

    def test_json_is_all_that_dynamics_need(self, model, exported):
        """A second code, which reads the file alone, computes the same torques."""
        read = json.loads(json.dumps(plain(record(exported))))
        bodies = read["bodies"]
        arm = TextbookArm.of(model).but(
            inside=tuple(body["parent"] for body in bodies),
            rotations=np.array([body["rotation"] for body in bodies]),
            translations=np.array([body["translation"] for body in bodies]),
            axes=np.array([body["axis"] for body in bodies]),
            prismatic=tuple(body["kind"] == "prismatic" for body in bodies),
            masses=np.array([body["mass"] for body in bodies]),
            centers=np.array([body["center_of_mass"] for body in bodies]),
            tensors=np.array([body["inertia"] for body in bodies]),
            gravity=np.array(read["base_rotation"]).T @ read["gravity"],
        )
        q, v = model.random_state(np.random.default_rng(0))
        a = np.linspace(-1, 1, model.n_bodies)
        expected = graphdyn.joint_torques(model, q, v, a)
        np.testing.assert_allclose(arm.inverse_dynamics(q, v, a), expected, rtol=0, atol=1e-12 * np.abs(expected).max())

    def test_schema(self, exported):
        schema = json.loads((REPOSITORY / "docs/schemas/export-1.schema.json").read_text("utf-8"))
        Draft202012Validator(schema).validate(plain(record(exported)))

    def test_c(self, model, exported):
        found = constants_of_c(c_text(exported))
        self.same(found, exported, first=0)
        assert found["rotation"].shape == (model.n_bodies, 3, 3)

    def test_matlab(self, model, exported):
        read = vars(Structure(matlab_text(exported, "arm")))
        assert read["n"] == model.n_bodies
        found = {name: np.moveaxis(x, -1, 0) if x.ndim > 1 and "base" not in name else x for name, x in read.items()}
        self.same(found, exported, first=1)

    @staticmethod
    def same(found, exported, first):
        written = plain(record(exported))
        bodies, frames = written["bodies"], written["frames"]
        expected = {
            name: [body[name] for body in bodies]
            for name in ("rotation", "translation", "axis", "mass", "center_of_mass", "inertia")
        }
        expected |= {f"frame_{name}": [frame[name] for frame in frames] for name in ("rotation", "translation")}
        expected |= {name: written[name] for name in ("gravity", "base_rotation", "base_translation")}
        expected["prismatic"] = [body["kind"] == "prismatic" for body in bodies]
        expected["parent"] = [body["parent"] + first - 1 for body in bodies]
        expected["frame_body"] = [frame["body"] + first - 1 for frame in frames]
        assert set(found) - {"n"} == set(expected)
        for name, value in expected.items():
            np.testing.assert_array_equal(found[name], value, err_msg=name)


class TestText:
    @pytest.mark.skipif(COMPILER is None, reason="there is no C compiler (cc or gcc) on this machine")
    def test_names_in_c(self, exported, tmp_path):
        (tmp_path / "model.h").write_text(c_text(exported), encoding="utf-8")
        code = '#include <stdio.h>\n#include "model.h"\nint main(void) { return fputs(joint_name[0], stdout) < 0; }\n'
        (tmp_path / "main.c").write_text(code, encoding="utf-8")
        subprocess.run([COMPILER, "-Wall", "-Werror", "-std=c99", "main.c", "-o", "main"], check=True, cwd=tmp_path)
        assert subprocess.run([tmp_path / "main"], check=True, capture_output=True).stdout.decode() == AWKWARD

    def test_names_in_matlab(self, exported):
        text = matlab_text(exported, "arm")
        awkward, second, *_ = re.search(r"model.joint_name = \{(.*)\};", text)[1].split(", ")
        assert bytes(map(int, re.fullmatch(r"char\(\[(.*)\]\)", awkward)[1].split())).decode() == AWKWARD
        assert second == f"'{exported.model.joint_names[1]}'"

    def test_quotes_in_matlab(self, model):
        """Within quotes, one is written as two."""
        first, *others = model.joints
        named = dataclasses.replace(model, joints=(dataclasses.replace(first, name="the 'first'"), *others))
        assert "model.joint_name = {'the ''first''', " in matlab_text(
            ExportedModel(named, "arm", urdf.Reading()), "arm"
        )

    def test_head(self, exported):
        for text, numbering in (
            (
                c_text(exported),
                "Bodies and joints: 0 ... N - 1, parents first; joint j carries body j; body -1 is the ground.",
            ),
            (
                matlab_text(exported, "arm"),
                "Bodies and joints: 1 ... n, parents first; joint j carries body j; body 0 is the ground.",
            ),
        ):
            assert numbering in text
            assert "Units: m, rad, kg, kg m^2, m/s^2." in text
            assert "Locked joints: gripper at 0.5." in text
            assert re.search(r"Chain from base to tip.{1,4}\.\n", text)
            assert "Rigid-body model of a\"b\\c'd" in text
        comment = c_text(exported).split("enum")[0]
        assert (comment.count("/*"), comment.count("*/")) == (1, 1)

    def test_no_frames(self, model):
        assert "frame_name" not in c_text(ExportedModel(dataclasses.replace(model, frames=()), "arm", urdf.Reading()))


class TestCommand:
    @pytest.mark.parametrize("ending", ["json", "c", "h", "m"])
    def test_endings(self, program, small_arm, tmp_path, ending):
        done = program("export", small_arm, "--lock", "a_slide=0.1", "--to", tmp_path / f"arm.{ending}")
        assert (done.code, done.out) == (AGREED, "")
        text = (tmp_path / f"arm.{ending}").read_text(encoding="utf-8")
        model = urdf.load(small_arm, lock={"a_slide": 0.1})
        own = ExportedModel(model, str(small_arm), urdf.Reading(lock={"a_slide": 0.1}))
        if ending == "json":
            assert json.loads(text) == plain(record(own))
        else:
            assert text == (matlab_text(own, "arm") if ending == "m" else c_text(own))

    def test_standard_output(self, program, small_arm):
        options = ("--chain", "base", "tool", "--gravity", "0", "0", "-1.62")
        done = program("export", small_arm, *options, "--to", "-")
        assert json.loads(done.out)["gravity"] == [0.0, 0.0, -1.62]
        assert [body["name"] for body in json.loads(done.out)["bodies"]] == ["upper", "fore"]
        assert json.loads(done.out)["chain"] == ["base", "tool"]

    @pytest.mark.parametrize(
        ("name", "message"),
        [
            ("arm.txt", "end the name in .json, .c, .h or .m"),
            ("6r.m", "a function of MATLAB has the name of its file; use letters, digits and _ alone"),
        ],
    )
    def test_refused(self, program, small_arm, tmp_path, name, message):
        done = program("export", small_arm, "--to", tmp_path / name)
        assert done.code == BAD_INPUT
        assert message in " ".join(done.err.replace("│", " ").split())
        assert not (tmp_path / name).exists()


class TestCode:
    """`graphdyn export --c`."""

    def test_folder(self, program, small_arm, tmp_path):
        """What is written can be built and tested; the table says what it is."""
        options = ("--functions", "mass_matrix,frame_velocity", "--frame", "tool", "--reference", "local")
        done = program("export", small_arm, "--c", tmp_path / "arm", *options, "--no-check", "--to", tmp_path / "arm.m")
        assert done.code == AGREED
        assert f"2 functions of {small_arm} in {tmp_path / 'arm'}" in " ".join(done.out.split())
        assert (tmp_path / "arm.m").exists()
        table = json.loads((tmp_path / "arm/code.json").read_text("utf-8"))
        schema = json.loads((REPOSITORY / "docs/schemas/code-1.schema.json").read_text("utf-8"))
        Draft202012Validator(schema).validate(table)
        assert {path.name for path in (tmp_path / "arm").iterdir()} == {"code.json", *table["files"]}
        model = urdf.load(small_arm, mimic="independent")
        mass_matrix, velocity = table["functions"]
        assert mass_matrix["results"] == [{"name": "mass_matrix", "shape": [model.nv] * 2, "unit": "kg m², kg m, kg"}]
        assert [each["name"] for each in velocity["arguments"]] == ["q", "v"]
        assert (velocity["frame"], velocity["reference"]) == ("tool", "local")
        assert tuple(table["joint_names"]) == model.joint_names
        header = (tmp_path / "arm" / f"{table['name']}.h").read_text("utf-8")
        assert all(f"int {function['symbol']}(int n, " in header for function in table["functions"])
        again = program("export", small_arm, "--c", tmp_path / "arm", "--functions", "gravity_torque", "--no-check")
        assert again.code == AGREED
        assert not list((tmp_path / "arm").glob("*mass_matrix*"))

    @pytest.mark.skipif(COMPILER is None, reason="there is no C compiler (cc or gcc) on this machine")
    @pytest.mark.parametrize(
        ("options", "judged"),
        [
            (("--functions", "momentum", "--precision", "single"), ["momentum"]),
            *(
                pytest.param(options, judged, marks=LONG)
                for options, judged in (
                    (("--external-wrenches",), ["inverse_dynamics", "forward_dynamics", "mass_matrix"]),
                    (("--functions", "inverse_dynamics"), ["inverse_dynamics", "multipliers", "joint_wrenches"]),
                    (("--functions", "joint_torques", "--moving-base"), []),
                )
            ),
        ],
    )
    def test_check(self, program, small_arm, tmp_path, options, judged):
        """Functions of doubles with one result are judged as they are, others through doubles and one result."""
        done = program("export", small_arm, "--c", tmp_path / "arm", *options, "--check")
        assert done.code == AGREED
        assert "passed, largest error" in done.out
        assert re.findall(r"^judged (\w+): agrees", done.out, re.MULTILINE) == judged
        assert judged or "not judged: " in done.out

    @LONG
    @pytest.mark.skipif(COMPILER is None, reason="there is no C compiler (cc or gcc) on this machine")
    @pytest.mark.parametrize("robot", ["kr500", "ur5", "ur10", "kinova", "z1", "kr210_r2700_2.urdf"])
    def test_arms(self, program, tmp_path, robot):
        path = existing(ARMS / robot) if robot.endswith(".urdf") else robot
        done = program("export", path, "--c", tmp_path / "arm", "--check")
        assert done.code == AGREED
        assert re.findall(r"^judged (\w+): agrees", done.out, re.MULTILINE) == [
            "inverse_dynamics",
            "forward_dynamics",
            "mass_matrix",
        ]

    @pytest.mark.skipif(COMPILER is None, reason="there is no C compiler (cc or gcc) on this machine")
    def test_wrong_code(self, program, small_arm, tmp_path, monkeypatch):
        """Wrong code is noticed, and nothing is written."""
        code = c_code(urdf.load(small_arm), ["gravity_torque"])
        rows = f"{code.name}_gravity_torque_rows.h"
        wrong = dataclasses.replace(code, files={**code.files, rows: code.files[rows].replace(" - ", " + ")})
        monkeypatch.setattr("graphdyn.export.c_code", lambda *_arguments, **_keywords: wrong)
        done = program("export", small_arm, "--c", tmp_path / "arm", "--functions", "gravity_torque")
        assert done.code == DISAGREED
        assert "FAILED" in done.out
        assert re.search(r"^judged gravity_torque: DISAGREES", done.out, re.MULTILINE)
        assert "the exported code is wrong" in " ".join(done.err.split())
        assert not (tmp_path / "arm").exists()

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ((), "nothing to write; give --to FILE for the model, --c FOLDER for functions in C, or both"),
            (("--c", "arm", "--frame", "tool"), "--frame and --reference belong together; give both"),
            (("--c", "arm", "--functions", "torque"), "there is no function 'torque' to export"),
            (("--c", "arm", "--name", "int"), "'int' is no name for functions in C"),
        ],
    )
    def test_refused(self, program, small_arm, tmp_path, monkeypatch, options, message):
        monkeypatch.chdir(tmp_path)
        done = program("export", small_arm, *options)
        assert done.code == BAD_INPUT
        assert message in " ".join(done.err.replace("│", " ").split())
        assert not (tmp_path / "arm").exists()

    def test_folder_of_others(self, program, small_arm, tmp_path):
        (tmp_path / "arm").mkdir()
        (tmp_path / "arm/thesis.tex").write_text("text")
        done = program("export", small_arm, "--c", tmp_path / "arm")
        assert done.code == BAD_INPUT
        assert "thesis.tex" in done.err
        assert [path.name for path in (tmp_path / "arm").iterdir()] == ["thesis.tex"]

    def test_without_a_compiler(self, program, small_arm, tmp_path, monkeypatch):
        monkeypatch.setenv("CC", "no-such-compiler")
        options = ("export", small_arm, "--functions", "gravity_torque", "--c", tmp_path / "arm")
        done = program(*options, "--check")
        assert done.code == BAD_INPUT
        assert "--check: there is no C compiler; install one, or name it in CC" in " ".join(
            done.err.replace("│", " ").split()
        )
        done = program(*options)
        assert done.code == AGREED
        assert "not checked: there is no C compiler" in done.err
        monkeypatch.setenv("CC", "false")
        done = program(*options)
        assert done.code == BAD_INPUT
        assert "false does not compile the code: exit code 1; name another one in CC" in " ".join(done.err.split())


class TestMJCF:
    def test_in_full_and_as_a_patch(self, program, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "mjcf").mkdir()
        done = program("export", "ur5", "--to", "mjcf", "--out", "ur5.xml")
        assert (done.code, done.out.strip()) == (0, "ur5 as MJCF in ur5.xml")
        done = program("export", "ur5", "--to", "mjcf", "--patch", "ur5.xml", "--out", "new.xml")
        said = "new.xml: ur5.xml with new inertials of 0 bodies, new damping, friction or armature of 0 joints"
        assert (done.code, done.out.strip()) == (0, said)
        assert (tmp_path / "new.xml").read_bytes() == (tmp_path / "ur5.xml").read_bytes()

    @pytest.mark.parametrize(
        ("arguments", "said"),
        [
            (("--to", "mjcf"), "--to mjcf: name the file with --out FILE.xml"),
            (("--to", "mjcf", "--out", "a.urdf"), "--out a.urdf: end the name in .xml"),
            (("--to", "a.json", "--out", "a.xml"), "--out and --patch are for --to mjcf and --to dh"),
            (("--to", "dh", "--out", "a.xml"), "--out a.xml: end the name in .toml"),
            (("--to", "dh", "--out", "a.toml", "--patch", "b.xml"), "--patch is for --to mjcf"),
            (("--to", "mjcf", "--out", "a.xml", "--dh", "standard"), "--dh is for --to dh"),
        ],
    )
    def test_options_that_do_not_fit(self, program, arguments, said):
        done = program("export", "ur5", *arguments)
        assert done.code == BAD_INPUT
        assert said in " ".join(done.err.replace("│", " ").split())


def test_a_table_of_denavit_hartenberg_parameters(program, tmp_path, monkeypatch):
    """It is shown, written, and read as the same robot."""
    monkeypatch.chdir(tmp_path)
    done = program("export", "ur5", "--to", "dh", "--dh", "modified", "--out", "ur5.toml")
    assert done.out.strip() == "ur5 as modified Denavit-Hartenberg parameters in ur5.toml"
    shown = program("show", "ur5.toml", "--dh", "standard", "--json", "ur5.json")
    assert "Denavit-Hartenberg parameters, standard" in shown.out
    rows = json.loads((tmp_path / "ur5.json").read_text(encoding="utf-8"))["dh"]["rows"]
    assert [round(row["a"], 6) for row in rows] == [0, 0.425, 0.39225, 0, 0, 0]
    refused = program("show", "panda", "--dh", "standard")
    assert (refused.code, "no chain of joints" in refused.err) == (BAD_INPUT, True)
