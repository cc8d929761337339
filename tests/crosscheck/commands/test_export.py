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
from planting import mixed_tree
from shared_data import REPOSITORY

import graphdyn
import urdf
from crosscheck.commands.export.languages import c_text, matlab_text
from crosscheck.commands.export.record import ExportedModel, record
from crosscheck.commands.program.exits import AGREED, BAD_INPUT
from crosscheck.report.records.record import plain
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
