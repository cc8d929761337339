"""Exported C: compiled by what is there, called from here, and compared with the equations."""

import ctypes
import dataclasses
import re
import shutil
import subprocess

import numpy as np
import pytest
from long_check import LONG
from random_trees import random_tree
from robots.mechanisms import four_bar

import graphdyn
from graphdyn import InvalidInput
from graphdyn.export import ExportChoices, c_code, exportable
from graphdyn.export.c.dialect import Dialect
from graphdyn.export.c.identifiers import comment_text, prefix_of

COMPILER = shutil.which("gcc") or shutil.which("cc")
CPP = shutil.which("g++") or shutil.which("c++")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler (gcc or cc) on this machine")

WARNINGS = ("-pedantic", "-Wall", "-Wextra", "-Werror")
AWKWARD = 'a*/b/*c\\d"??/\n é'
"""Characters that mean something in comments in C."""

FUNCTIONS = ("joint_torques", "joint_accelerations", "mass_matrix", "kinetic_energy", "frame_velocity")
CHOICES = ExportChoices(external_wrenches=True, moving_base=True, frame="tool", reference="local_world_aligned")

LOOP_ROUNDING = 1e-10
"""Of poses that may be near singular ones."""

DOUBLE, SINGLE = 1e-14, 2e-6
"""Some hundred operations of a well-conditioned robot, each rounded to 53 or 24 bits."""


def awkward_tree():
    """A branching robot with a slide, whose names are no identifiers."""
    tree = random_tree(7, [0, 1, 1], ["revolute", "prismatic", "continuous"])
    first, *others = tree.joints
    tool = graphdyn.Frame("tool", 2, graphdyn.Placement(np.eye(3), np.ones(3) / 3))
    joints = (dataclasses.replace(first, name=AWKWARD), *others)
    return dataclasses.replace(tree, name=f"7 {AWKWARD}", joints=joints, frames=(tool,))


def build(code, folder, *flags, compiler=None):
    """A shared library of the functions, and the test program."""
    folder.mkdir(exist_ok=True)
    for name, text in code.files.items():
        (folder / name).write_text(text, encoding="ascii")
    sources = [f"{code.name}_{function.name}.c" for function in code.functions]
    command = [*(compiler or (COMPILER, "-std=c99")), *WARNINGS, *flags]
    for target in (
        ["-fPIC", "-shared", "-o", "code.so", *sources],
        ["-o", "compared", f"{code.name}_test.c", *sources],
    ):
        subprocess.run([*command, *target, "-lm"], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "code.so"))


def outcome(folder):
    """Errors that the test program prints, and its exit code."""
    done = subprocess.run([folder / "compared"], capture_output=True, text=True, check=False)
    found = re.findall(r"^(\S+: \S+) +(\S+) at 20 states$", done.stdout, re.MULTILINE)
    return {name: float(error) for name, error in found}, done.returncode


def call(function, *arguments):
    """Of numbers and arrays, which are written to where the function writes."""
    kinds = {np.dtype(float): ctypes.c_double, np.dtype(np.float32): ctypes.c_float}
    return function(
        *(x.ctypes.data_as(ctypes.POINTER(kinds[x.dtype])) if isinstance(x, np.ndarray) else x for x in arguments)
    )


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The code, its library and its folder; compiled without optimization, as single steps are."""
    if COMPILER is None:
        pytest.skip("there is no C compiler (gcc or cc) on this machine")
    code, folder = c_code(awkward_tree(), FUNCTIONS, CHOICES), tmp_path_factory.mktemp("code")
    return code, build(code, folder, "-O0"), folder


def test_agrees_with_the_equations(built):
    code, _, folder = built
    errors, exit_code = outcome(folder)
    assert exit_code == 0
    assert len(errors) == 2 * len(code.functions)
    assert max(errors.values()) <= DOUBLE, errors


@needs_compiler
@pytest.mark.parametrize(
    ("precision", "sines", "flags", "bound"),
    [
        ("single", "own", ("-O1",), SINGLE),
        ("double", "libm", ("-O1",), DOUBLE),
        pytest.param("double", "own", ("-O3", "-march=native", "-ffp-contract=fast"), DOUBLE, marks=LONG),
        pytest.param("single", "libm", ("-O3", "-march=native", "-ffp-contract=fast"), SINGLE, marks=LONG),
    ],
)
def test_precisions_and_flags(tmp_path, precision, sines, flags, bound):
    build(c_code(awkward_tree(), ["joint_accelerations"], precision=precision, sines=sines), tmp_path, *flags)
    errors, exit_code = outcome(tmp_path)
    assert exit_code == 0
    assert max(errors.values()) <= bound, errors


@pytest.mark.skipif(CPP is None, reason="there is no C++ compiler (g++ or c++) on this machine")
def test_cpp(built, tmp_path):
    """The sources are C++ as well, and the header's arrays have the right sizes."""
    code = c_code(awkward_tree(), ["mass_matrix", "potential_energy"], name="arm")
    build(code, tmp_path, compiler=(CPP, "-x", "c++", "-std=c++11"))
    assert outcome(tmp_path)[1] == 0
    program = (
        '#include "arm.hpp"\nint main() { arm::Joints q{}; std::array<double, arm::n * arm::n> m; double e;\n'
        "return arm::mass_matrix(q, m) | arm::potential_energy(q, e) | !(m[0] > 0); }\n"
    )
    (tmp_path / "main.cpp").write_text(program)
    command = [CPP, "-std=c++11", *WARNINGS, "main.cpp", "./code.so", "-o", "main"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert subprocess.run(["./main"], cwd=tmp_path, check=False).returncode == 0


def test_rows_do_not_depend_on_their_number(built, rng):
    code, library, _ = built
    model, function = awkward_tree(), getattr(library, f"{code.name}_mass_matrix_batch")
    q = model.random_state(rng, 17)[0]
    whole = np.full((17, 3, 3), np.nan)
    assert call(function, 3, ctypes.c_size_t(17), q, whole) == 0
    np.testing.assert_allclose(whole, graphdyn.mass_matrix(model, q), rtol=0, atol=DOUBLE * np.abs(whole).max())
    for rows in (0, 1, 7, 8, 9, 16):
        some = np.full((17, 3, 3), np.nan)
        assert call(function, 3, ctypes.c_size_t(rows), q, some) == 0
        np.testing.assert_array_equal(some[:rows], whole[:rows])
        assert np.isnan(some[rows:]).all()


def test_answers(built):
    """Another number of joints, angles that are too large, NaN."""
    code, library, folder = built
    upper = code.name.upper()
    header = (folder / f"{code.name}.h").read_text()
    numbers = dict(re.findall(rf"{upper}_(OK|WRONG_N|FAR_ANGLE|SINGULAR) = (\d)", header))
    assert numbers == {"OK": "0", "WRONG_N": "1", "FAR_ANGLE": "2", "SINGULAR": "4"}
    function, result = getattr(library, f"{code.name}_mass_matrix"), np.full(9, np.nan)
    assert call(function, 2, np.zeros(3), result) == 1
    assert np.isnan(result).all()
    slide, *turning = np.argsort([not joint.is_prismatic for joint in awkward_tree().joints])
    for value, answer in ((1e6, 0), (1.1e6, 2), (-1.1e6, 2), (np.nan, 2)):
        for joint in turning:
            q = np.zeros(3)
            q[joint] = value
            assert call(function, 3, q, result) in (0, answer)
    assert call(function, 3, np.full(3, 2e6), result) == 2
    far = np.zeros(3)
    far[slide] = 2e6
    assert call(function, 3, far, result) == 0


@needs_compiler
def test_long_functions(tmp_path, monkeypatch):
    """Batches of long ones take row after row; those for which compilers take minutes are refused."""
    monkeypatch.setattr("graphdyn.export.c.sources.MAX_VECTORIZED_OPERATIONS", 10)
    code = c_code(awkward_tree(), ["gravity_torque"], name="arm")
    assert "arm_gravity_torque_many" not in code.files["arm_gravity_torque.c"]
    build(code, tmp_path, "-O0")
    errors, exit_code = outcome(tmp_path)
    assert (len(errors), exit_code) == (2, 0)
    monkeypatch.setattr("graphdyn.export.c.code.MAX_OPERATIONS", 20)
    count = code.functions[0].program.arithmetic
    with pytest.raises(InvalidInput) as error:
        c_code(awkward_tree(), ["gravity_torque"])
    assert str(error.value) == (
        f"gravity_torque of robot '{awkward_tree().name}' is {count} operations in a row, for which C compilers take "
        "minutes; 20 are written at most: leave it out, or lock joints"
    )


@needs_compiler
def test_singular(tmp_path):
    """Two joints about one axis, the body between them almost without mass."""
    heavy, light = (
        graphdyn.Body(name, mass, np.ones(3) / 3, mass * np.eye(3)) for name, mass in (("h", 1.0), ("l", 1e-11))
    )
    joints = [graphdyn.Joint(f"j{k}", "revolute", k, graphdyn.Placement(), np.array([0, 0, 1.0])) for k in (0, 1)]
    library = build(
        c_code(graphdyn.RobotModel("arm", [light, heavy], joints), ["joint_accelerations"]), tmp_path, "-O0"
    )
    assert outcome(tmp_path) == ({}, 0)  # no state is compared
    assert call(library.arm_joint_accelerations, 2, *np.zeros((4, 2))) == 4


@needs_compiler
def test_loops(tmp_path):
    """A four-bar linkage: NAN where redundant rows leave a reaction undetermined, and the torque of its one motor."""
    code = c_code(four_bar(), ["inverse_dynamics", "joint_accelerations"], name="bars")
    build(code, tmp_path, "-O0")
    errors, exit_code = outcome(tmp_path)
    assert exit_code == 0
    assert len(errors) == 2 * (5 + 1)  # tau, body accelerations, multipliers, joint wrenches, those of the chord; a
    assert max(errors.values()) <= LOOP_ROUNDING, errors
    assert "= NAN;" in code.files["bars_inverse_dynamics_rows.h"]


SINE_CALL = """
#include "arm_internal.h"
int sine_and_cosine(int count, const @real@ *angle, @real@ *sine, @real@ *cosine);
int sine_and_cosine(int count, const @real@ *angle, @real@ *sine, @real@ *cosine)
{
    return arm_turns(count, angle, sine, cosine);
}
"""


@needs_compiler
@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 60, reason="long double has no more digits than double here")
@pytest.mark.parametrize(("precision", "real", "ulps"), [("double", float, 2.5), ("single", np.float32, 0.51)])
def test_sine_and_cosine(tmp_path, precision, real, ulps):
    """Within the units in the last place of the compiled back end, against sines with eleven more bits."""
    code = c_code(awkward_tree(), ["mass_matrix"], name="arm", precision=precision)
    for name, text in code.files.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "sine.c").write_text(Dialect("arm", precision, "own").filled(SINE_CALL))
    flags = ("-std=c99", *WARNINGS, "-O2", "-fPIC", "-shared", "-o", "sine.so")
    subprocess.run([COMPILER, *flags, "sine.c"], cwd=tmp_path, check=True)
    rng = np.random.default_rng(0)
    quarter_turns = np.arange(-40, 41) * np.pi / 2
    angles = np.concatenate([rng.uniform(-100, 100, 20_000), rng.uniform(-1e6, 1e6, 20_000), quarter_turns]).astype(
        real
    )
    sine, cosine = np.empty_like(angles), np.empty_like(angles)
    assert call(ctypes.CDLL(str(tmp_path / "sine.so")).sine_and_cosine, len(angles), angles, sine, cosine) == 0
    for found, exact in ((sine, np.sin), (cosine, np.cos)):
        value = exact(angles.astype(np.longdouble))
        assert (np.abs(found - value) / np.spacing(np.abs(value).astype(real))).max() <= ulps


# Text


@pytest.mark.parametrize(
    ("robot", "name"),
    [
        ("ur5", "ur5"),
        ("UR 5e/v2", "UR_5e_v2"),
        ("__x__y__", "x_y"),
        ("6-axis", "robot_6_axis"),
        ("機械", "robot"),
        ("", "robot"),
        ("double", "double_robot"),
        ("class", "class_robot"),
        ("math", "math_robot"),
        ("test", "test_robot"),
    ],
)
def test_names_in_c(robot, name):
    assert prefix_of(robot) == name


@pytest.mark.parametrize("name", ["", "6r", "_arm", "arm_", "a__b", "a b", "int", "string", "é"])
def test_names_refused(name):
    with pytest.raises(InvalidInput) as error:
        c_code(awkward_tree(), name=name)
    assert str(error.value) == (
        f"'{name}' is no name for functions in C; begin with a letter, use letters and digits with single _ between "
        "them, and no keyword"
    )


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"precision": "half"}, "precision is 'half'; use one of double, single"),
        ({"sines": "fast"}, "sines is 'fast'; use one of own, libm"),
    ],
)
def test_keywords_refused(keywords, message):
    with pytest.raises(InvalidInput) as error:
        c_code(awkward_tree(), **keywords)
    assert str(error.value) == message


@pytest.mark.parametrize("text", [AWKWARD, "*/", "*//*", "/*/", "???/", "\\", "**//", "\r\n*/"])
def test_comments(text):
    shown = comment_text(text)
    assert shown.isascii()
    assert shown.isprintable()
    assert not any(pair in shown for pair in ("*/", "/*", "??"))


@pytest.mark.parametrize(
    ("value", "double", "single"),
    [
        (0.1, "0.1", "0.1f"),
        (1.0, "1.0", "1.0f"),
        (-0.0, "-0.0", "-0.0f"),
        (1 / 3, "0.3333333333333333", "0.33333334f"),
        (1e-300, "1e-300", "0.0f"),
        (np.inf, "INFINITY", "INFINITY"),
        (-1e39, "-1e+39", "-INFINITY"),
        (np.nan, "NAN", "NAN"),
    ],
)
def test_numbers(value, double, single):
    assert Dialect("arm", "double", "own").literal(value) == double
    assert Dialect("arm", "single", "own").literal(value) == single


def test_header(built):
    """Units, order and limits of the joints, shapes."""
    model = awkward_tree()
    code = built[0]
    text = code.files[f"{code.name}.h"]
    assert f"{code.name.upper()}_N = 3," in text
    for number, joint in enumerate(model.joints):
        assert f"  {number}  {comment_text(joint.name)}" in text
    assert re.search(r"external_wrenches +\(3, 6\) +\[N, N m\]", text)
    assert re.search(r"kinetic_energy +one number +\[J\]", text)
    assert "frame tool, reference local_world_aligned" in text
    assert re.search(rf"Gravity is \({model.gravity[0]:g}, {model.gravity[1]:g}, {model.gravity[2]:g}\) m/s\^2", text)


@LONG
@needs_compiler
def test_every_function(tmp_path):
    """All that a robot has, but the two that compilers take longest for."""
    names = set(exportable(awkward_tree(), CHOICES)) - {"reaction_derivatives", "inverse_dynamics_second_derivatives"}
    build(c_code(awkward_tree(), sorted(names), CHOICES), tmp_path, "-O1")
    errors, exit_code = outcome(tmp_path)
    assert exit_code == 0
    assert max(errors.values()) <= 100 * DOUBLE, errors  # derivatives of what is divided by pivots
