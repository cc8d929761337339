"""One fault in a robot's files, written in many ways, and the line where it stands: known before anything is read.

A layout is a set of files, the first of them the robot, with every value as @name@. A fault changes one value. It
stands where the last tag before this value begins.
"""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from typer.testing import CliRunner

from crosscheck.commands import app

VALUES = {
    "com.xyz": "0.1 0 0.2", "com.rpy": "0 0 0", "mass": "2.5", "ixx": "0.11", "iyy": "0.13", "izz": "0.17",
    "type": "revolute", "origin.xyz": "0 0 0.4", "origin.rpy": "0 0 0", "parent": "base", "child": "upper",
    "axis": "0 1 0", "lower": "-1", "upper": "2", "effort": "300", "velocity": "3", "damping": "0.5",
}  # fmt: skip

FAULTS = (
    ("com.xyz", "0.1 0", "wrong-number-of-entries"), ("com.xyz", "0.1 0 1e3", "far-center-of-mass"),
    ("com.rpy", "0 0 x", "malformed-number"), ("mass", "-2.5", "negative-mass"), ("mass", "2,5", "malformed-number"),
    ("mass", "nan", "not-finite"), ("ixx", "0.9", "triangle-inequality"), ("ixx", "-0.11", "indefinite-inertia"),
    ("iyy", "1e70", "number-too-large"), ("izz", "0.17.1", "malformed-number"), ("type", "hinge", "unsupported-joint"),
    ("origin.xyz", "0 0.4", "wrong-number-of-entries"), ("origin.rpy", "0 inf 0", "not-finite"),
    ("parent", "bass", "missing-link"), ("child", "uper", "missing-link"), ("axis", "0 0 0", "zero-axis"),
    ("axis", "0 2 0", "axis-not-normalized"), ("lower", "3", "limits-crossed"), ("effort", "-300", "effort-negative"),
    ("velocity", "3 rad/s", "wrong-number-of-entries"), ("damping", "?", "malformed-number"),
)  # fmt: skip
"""Name of a value, the wrong one, and the code of the finding."""

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
LINK = """\
  <link name="upper">
    <inertial>
      <origin xyz="@com.xyz@" rpy="@com.rpy@"/>
      <mass value="@mass@"/>
      <inertia ixx="@ixx@" ixy="0" ixz="0" iyy="@iyy@" iyz="0" izz="@izz@"/>
    </inertial>
  </link>
"""
JOINT = """\
  <joint name="shoulder" type="@type@">
    <origin xyz="@origin.xyz@" rpy="@origin.rpy@"/>
    <parent link="@parent@"/>
    <child link="@child@"/>
    <axis xyz="@axis@"/>
    <limit lower="@lower@" upper="@upper@" effort="@effort@" velocity="@velocity@"/>
    <dynamics damping="@damping@"/>
  </joint>
"""
BASE = '  <link name="base"/>\n'
PLAIN = f'<?xml version="1.0"?>\n<robot name="arm">\n{BASE}{LINK}{JOINT}</robot>\n'


def _macro(name: str, parameters: str, body: str) -> str:
    return f'<xacro:macro name="{name}" params="{parameters}">\n{body}</xacro:macro>\n'


def _main(*parts: str) -> str:
    return f'<?xml version="1.0"?>\n<robot name="arm" {XACRO}>\n{"".join(parts)}</robot>\n'


def _included(*parts: str) -> str:
    return f"<robot {XACRO}>\n{''.join(parts)}</robot>\n"


def _include(file: str) -> str:
    return f'  <xacro:include filename="{file}"/>\n'


def _with_parameters(text: str, names: tuple[str, ...]) -> str:
    """The values as parameters of a macro, whose names have no point."""
    for name in names:
        text = text.replace(f"@{name}@", f"${{{name.replace('.', '_')}}}")
    return text


INERTIAL = ("com.xyz", "com.rpy", "mass", "ixx", "iyy", "izz")
MOTION = ("origin.xyz", "origin.rpy", "axis", "lower", "upper", "effort", "velocity", "damping")
_ARGUMENTS = {names: "\n    ".join(f'{n.replace(".", "_")}="@{n}@"' for n in names) for names in (INERTIAL, MOTION)}
_DEFAULTS = " ".join(f"{n}:=@{n}@" for n in ("mass", "ixx", "iyy", "izz"))
_ONE_NUMBER = ("mass", "axis", "damping")
_PROPERTIES = "".join(f'  <xacro:property name="{name}" value="@{name}@"/>\n' for name in _ONE_NUMBER)

LAYOUTS: Mapping[str, Mapping[str, str]] = {
    "elements in lines": {"arm.urdf": PLAIN},
    "attributes in lines": {"arm.urdf": re.sub(r' (?=\w+(?:="@))', "\n        ", PLAIN)},
    "Windows, comments, other letters": {
        "arm.urdf": PLAIN.replace("  <joint", "  <!-- über\n  zwei Zeilen -->\n  <joint").replace("\n", "\r\n")
    },
    "xacro": {"arm.urdf.xacro": _main('  <xacro:property name="unused" value="1"/>\n', BASE, LINK, JOINT)},
    "macros of an included file": {
        "arm.urdf.xacro": _main(_include("parts/arm.xacro"), BASE, "  <xacro:upper/>\n\n  <xacro:shoulder/>\n"),
        "parts/arm.xacro": _included(_include("joint.xacro"), _macro("upper", "", LINK)),
        "parts/joint.xacro": _included("\n\n", _macro("shoulder", "", JOINT)),
    },
    "arguments of calls": {
        "arm.urdf.xacro": _main(
            _include("macros.xacro"), BASE,
            f"  <xacro:upper {_ARGUMENTS[INERTIAL]}/>\n", f"  <xacro:shoulder {_ARGUMENTS[MOTION]}/>\n",
        ),
        "macros.xacro": _included(
            _macro("upper", " ".join(INERTIAL).replace(".", "_"), _with_parameters(LINK, INERTIAL)),
            _macro("shoulder", " ".join(MOTION).replace(".", "_"), _with_parameters(JOINT, MOTION)),
        ),
    },
    "defaults of a macro": {
        "arm.urdf.xacro": _main(_include("macros.xacro"), BASE, "  <xacro:upper/>\n", JOINT),
        "macros.xacro": _included(
            "\n", _macro("upper", _DEFAULTS, _with_parameters(LINK, ("mass", "ixx", "iyy", "izz"))),
        ),
    },
    "properties of an included file": {
        "arm.urdf.xacro": _main(
            _include("numbers.xacro"), BASE, _with_parameters(LINK, _ONE_NUMBER), _with_parameters(JOINT, _ONE_NUMBER),
        ),
        "numbers.xacro": _included(_PROPERTIES),
    },
}  # fmt: skip
"""The files by name, with the values as @name@."""

OTHER_FILES_VALUES = {"arguments of calls": ("type", "parent", "child")}
"""Values that a layout writes as another one does; they are not planted again."""


@dataclass(frozen=True)
class PlantedFault:
    """Files with a fault; the file and line where it stands, and the code of the finding."""

    name: str
    files: Mapping[str, str]
    file: str
    line: int
    code: str


def planted_faults() -> Iterator[PlantedFault]:
    """Every fault in every layout."""
    for layout, files in LAYOUTS.items():
        for value, wrong, code in FAULTS:
            if value in OTHER_FILES_VALUES.get(layout, ()):
                continue
            ((file, text),) = ((file, text) for file, text in files.items() if f"@{value}@" in text)
            before = text[: text.rindex("<", 0, text.index(f"@{value}@"))]
            filled = {name: _filled(content, {**VALUES, value: wrong}) for name, content in files.items()}
            yield PlantedFault(f"{value}={wrong!r}, {layout}", filled, file, before.count("\n") + 1, code)


def _filled(text: str, values: Mapping[str, str]) -> str:
    return re.sub(r"@([\w.]+)@", lambda found: values[found[1]], text)


def reported(fault: PlantedFault, folder: Path) -> set[tuple[str, int]]:
    """Files and lines of the findings of this code, as `graphdyn inspect --sarif` tells them, run in the folder."""
    for name, text in fault.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode())
    sarif = folder / "found.sarif"
    CliRunner().invoke(app, ["inspect", next(iter(fault.files)), "--sarif", str(sarif)])
    (run,) = json.loads(sarif.read_text(encoding="utf-8"))["runs"]
    places = [each["locations"][0]["physicalLocation"] for each in run["results"] if each["ruleId"] == fault.code]
    return {(place["artifactLocation"]["uri"], place["region"]["startLine"]) for place in places}
