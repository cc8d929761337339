""".xacro files: expanded in a process that may read what the user named, and compute, and nothing else."""

import importlib.util
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from inspected.sample import CLEAN
from long_check import few
from numpy.testing import assert_array_equal
from urdf_text import with_changes

import urdf
from urdf.document.xacro import files as xacro_files

pytestmark = pytest.mark.skipif(importlib.util.find_spec("xacro") is None, reason="the extra xacro is not installed")

NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
MACROS = f"""<robot {NAMESPACE}>
<xacro:macro name="body" params="name mass *origin">
<link name="${{name}}"><inertial><xacro:insert_block name="origin"/><mass value="${{mass}}"/>
<inertia ixx="${{mass * 0.1}}" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
</xacro:macro></robot>"""
ARM = f"""<?xml version="1.0"?>
<robot name="arm" {NAMESPACE}>
<xacro:arg name="link" default="upper"/><xacro:arg name="mass" default="2"/>
<xacro:property name="reach" value="0.3"/>
<xacro:include filename="parts/macros.xacro"/>
<link name="base"/>
<xacro:body name="$(arg link)" mass="$(arg mass)"><origin xyz="${{reach / 2}} 0 0"/></xacro:body>
<joint name="shoulder" type="revolute"><origin xyz="0 0 ${{2 * reach}}" rpy="0 0 ${{pi / 2}}"/>
<parent link="base"/><child link="$(arg link)"/><axis xyz="0 1 0"/>
<limit lower="${{-pi}}" upper="${{radians(90)}}" effort="1" velocity="1"/></joint>
</robot>"""

FAULTS = {
    "in a macro of an included file": ((), ('value="${mass}"', ""), "parts/macros.xacro", 3),
    "in an argument of a call": (('default="2"', 'default="-2"'), (), "arm.xacro", 7),
    "in a property, through a call": (
        ("$(arg mass)", "${1 - heavy}", '"0.3"/>', '"0.3"/>\n<xacro:property name="heavy" value="9"/>'),
        (), "arm.xacro", 5,
    ),
    "in a default": (('mass="$(arg mass)"', ""), ("mass *", "mass:=-4 *"), "parts/macros.xacro", 2),
    "in one of several numbers": (('lower="${-pi}"', 'lower="${reach * 9}"'), (), "arm.xacro", 10),
    "in a call by name": (
        ("<xacro:body", '<xacro:call macro="body"', "</xacro:body>", "</xacro:call>", "$(arg mass)", "-1"),
        (), "arm.xacro", 7,
    ),
    "in a block": (('xyz="${reach / 2} 0 0"', '\nxyz="0 0"'), (), "arm.xacro", 7),
}  # fmt: skip
"""Changes of ARM and MACROS (old, new, …), and where the fault is."""


@pytest.fixture
def files(tmp_path):
    """files(path=text, …) below a folder; the first is returned."""

    def write(files):
        for name, text in files.items():
            path = tmp_path / "robots" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path / "robots" / next(iter(files))

    return write


@pytest.fixture
def arm(files):
    return files({"arm.urdf.xacro": ARM, "parts/macros.xacro": MACROS})


@pytest.fixture
def within(files):
    """within(body): a file with a moving link and this body."""

    def write(body):
        return files(
            {"r.xacro": CLEAN.replace("<robot ", f"<robot {NAMESPACE} ").replace("</robot>", body + "</robot>")}
        )

    return write


class TestExpansion:
    def test_numbers(self, arm):
        model = urdf.load(arm)
        (body,), (joint,) = model.bodies, model.joints
        assert (model.name, body.mass) == ("arm", 2.0)
        assert_array_equal(body.center_of_mass, [0.15, 0, 0])
        assert_array_equal(np.diag(body.inertia), [0.2, 0.1, 0.1])
        assert_array_equal(joint.placement.translation, [0, 0, 0.6])
        assert (joint.limits.lower, joint.limits.upper) == (-np.pi, np.pi / 2)

    def test_arguments(self, arm):
        (body,) = urdf.load(arm, xacro=urdf.Xacro({"mass": 5, "link": "heavy Ä"})).bodies
        assert (body.name, body.mass) == ("heavy Ä", 5.0)

    def test_an_open_file(self, arm):
        with arm.open("rb") as binary, arm.open(encoding="utf-8") as text:
            assert urdf.load(binary).n_bodies == urdf.load(text).n_bodies == 1

    def test_fused_links_and_inspection_take_arguments(self, arm):
        settings = urdf.Xacro({"mass": 1e6})
        assert urdf.fused_links(arm, xacro=settings) == {}
        assert "suspicious-masses" in urdf.inspect(arm, xacro=settings).codes
        assert "suspicious-masses" not in urdf.inspect(arm).codes

    def test_packages(self, files):
        text = ARM.replace("parts/macros.xacro", "$(find my_parts)/urdf/macros.xacro")
        arm = files({"one/arm.xacro": text, "two/urdf/macros.xacro": MACROS})
        assert urdf.load(arm, xacro=urdf.Xacro(packages={"my_parts": arm.parents[1] / "two"})).n_bodies == 1

    def test_the_folder_of_the_file(self, files):
        text = ARM.replace("parts/macros.xacro", "$(dirname)/parts/macros.xacro")
        arm = files({"arm.xacro": text, "parts/macros.xacro": MACROS})
        assert urdf.load(arm).n_bodies == 1

    def test_the_folder_of_an_included_file(self, files):
        """As in launch files: where it stands, not where the expansion began."""
        inner = f'<robot {NAMESPACE}><xacro:include filename="$(dirname)/macros.xacro"/></robot>'
        text = ARM.replace("parts/macros.xacro", "$(dirname)/parts/all.xacro")
        arm = files({"arm.xacro": text, "parts/all.xacro": inner, "parts/macros.xacro": MACROS})
        assert urdf.load(arm).n_bodies == 1

    def test_yaml(self, files):
        text = ARM.replace('value="0.3"', "value=\"${xacro.load_yaml('size.yaml')['reach']}\"")
        arm = files({"arm.xacro": text, "parts/macros.xacro": MACROS, "size.yaml": "reach: 0.4\n"})
        assert_array_equal(urdf.load(arm).joints[0].placement.translation, [0, 0, 0.8])

    @pytest.mark.parametrize(
        ("content", "message"),
        [
            ("reach: !!int abc\n", "size.yaml: invalid literal for int.* correct the YAML file"),
            ("reach: !!timestamp abc\n", "size.yaml: .*; correct the YAML file"),
            ("a: &a [x, x]\n" + "a: &a [*a, *a]\n" * 20, "size.yaml, line 15: more than 100000 parts, once its"),
        ],
    )
    def test_odd_yaml(self, files, content, message):
        text = ARM.replace('value="0.3"', "value=\"${xacro.load_yaml('size.yaml')['reach']}\"")
        arm = files({"arm.xacro": text, "parts/macros.xacro": MACROS, "size.yaml": content})
        with pytest.raises(urdf.InvalidXacro, match=message):
            urdf.load(arm)

    def test_comprehensions_and_calls(self, within):
        body = '<link name="${python.len([x for x in [1, 2, 3] if x > 1])}"/><joint name="g" type="fixed"><parent '
        model = urdf.load(within(body + 'link="tool"/><child link="${max(1, 2)}"/></joint>'))
        assert model.frame("2").body == 2

    def test_a_catalog_of_the_words_that_are_said(self, arm):
        report = urdf.inspect(arm)
        (finding,) = [finding for finding in report.findings if finding.code == "xacro-expanded"]
        assert (finding.severity, finding.message, finding.remedy) == (
            "note",
            "the file is expanded by xacro: lines are those of the files that it is made of",
            "no action needed",
        )
        assert report.usable

    @pytest.mark.parametrize(("of_arm", "of_macros", "file", "line"), FAULTS.values(), ids=FAULTS)
    def test_lines(self, files, of_arm, of_macros, file, line):
        """A fault is where it is written, not where the expander has put it."""
        arm = files({"arm.xacro": with_changes(ARM, *of_arm), "parts/macros.xacro": with_changes(MACROS, *of_macros)})
        with pytest.raises(urdf.URDFError, match=rf"{file}:{line}: ") as caught:
            urdf.load(arm)
        assert (caught.value.path, caught.value.line) == (arm.parent / file, line)
        first = urdf.inspect(arm).findings[0]
        assert (first.file, first.line) == (None if file == "arm.xacro" else str(arm.parent / file), line)

    def test_complaints_are_passed_on(self, within):
        path = within('<xacro:include filename="none*.xacro"/><xacro:property name="pi" value="3"/>')
        spec = path.parent / "none*.xacro"
        with pytest.warns(
            urdf.XacroWarning, match=r"expanding the file: Include tag's filename.*, redefining global symbol: pi"
        ) as caught:
            urdf.load(path)
        assert caught[0].filename == __file__
        assert str(spec)[-20:] in str(caught[0].message)
        found = [finding for finding in urdf.inspect(path).findings if finding.code == "xacro-complaint"]
        assert [finding.severity for finding in found] == ["warning", "warning"]
        assert found[1].message == "expanding the file: redefining global symbol: pi"
        assert found[1].remedy == "expand the file with xacro and check the result"

    def test_other_files_take_no_xacro_arguments(self):
        with pytest.raises(urdf.InvalidXacro, match=r"<text>: xacro arguments and packages are given, but not a file"):
            urdf.load(CLEAN, xacro=urdf.Xacro({"mass": 5}))

    def test_a_xacro_file_cannot_be_updated(self, arm, tmp_path):
        with pytest.raises(urdf.CannotUpdate, match=r"a \.xacro file has no <inertial> of its own to edit; expand it"):
            urdf.update(arm, tmp_path / "out.urdf", np.zeros((1, 10)))


def test_without_the_extra(arm, monkeypatch):
    monkeypatch.setattr(xacro_files.importlib.util, "find_spec", lambda _name: None)
    with pytest.raises(
        urdf.XacroNotInstalled,
        match=r"arm.urdf.xacro: .* needs the package xacro, which is not installed; run: .*'graphdyn\[xacro\]'",
    ):
        urdf.load(arm)
    assert urdf.inspect(arm).codes == ("xacro-not-installed",)


SECONDS = 3
"""In place of the 5 s that are allowed, so that these tests end; a file in itself takes one on a slow machine."""

ENDLESS = {"a large power": 1, "macros that double": 1}
"""The same of what takes longer than any time that is allowed."""

OUTSIDE = "the file '/etc/passwd' lies neither in the folder of this file nor in a given package; give packages={NAME:"
BRANCHES = (
    "".join(f'<xacro:macro name="m{k}" params="">{f"<xacro:m{k - 1}/>" * 4}</xacro:macro>' for k in range(1, 12))
    + '<xacro:macro name="m0" params=""><a/></xacro:macro><xacro:m11/>'
)
REFUSED = {
    "a file elsewhere": ('<xacro:include filename="/etc/passwd"/>', OUTSIDE),
    "a file above": (f'<xacro:include filename="{"../" * 20}etc/passwd"/>', OUTSIDE),
    "a pattern elsewhere": ('<xacro:include filename="/etc/pass*"/>', "the file '/etc' lies neither in the folder"),
    "yaml elsewhere": ("${xacro.load_yaml('/etc/passwd')}", OUTSIDE),
    "an optional file elsewhere": ('<xacro:include filename="/etc/passwd" optional="true"/>', OUTSIDE),
    "a package": (
        '<xacro:include filename="$(find ur_description)/x"/>',
        "$(find ur_description): no folder is given for this package; give packages={'ur_description': FOLDER}",
    ),
    "the environment": ("$(env HOME)", "environment variable 'HOME' is not set"),
    "an attribute": ("${().__class__}", "the expression '().__class__' is not evaluated; use plain arithmetic"),
    "a frame": ("${(x for x in []).gi_frame}", "the expression '(x for x in []).gi_frame' is not evaluated"),
    "a lambda": ("${(lambda: 1)()}", "the expression '(lambda: 1)()' is not evaluated"),
    "a format": ("${str(1).format(1)}", "the expression 'str(1).format(1)' is not evaluated"),
    "vars": ("${python.vars(1)}", "name 'vars' is not defined"),
    "type": ("${python.type(1)}", "name 'type' is not defined"),
    "an extension": ("$(eval 1 .__class__ )", "the expression '1 .__class__' is not evaluated"),
    "builtins": ("${open('/etc/passwd')}", "name 'open' is not defined"),
    "imports": ("${__import__('os')}", "Use of invalid name(s)"),
    "a large power": (
        "${9**9**9}",
        "expanding takes more than 1 s of processor time; expand the file yourself, if",
    ),
    "macros that double": (BRANCHES, "expanding takes more than 1 s of processor time"),
    "a long text": ("${'a' * 10**11}", "expanding takes more than 300 MB; expand the file yourself, if you trust it"),
    "a macro in itself": (
        '<xacro:macro name="m" params=""><xacro:m/></xacro:macro><xacro:m/>',
        "endless recursion of macros or includes; correct the file",
    ),
    "a file in itself": ('<xacro:include filename="r.xacro"/>', "endless recursion of macros or includes"),
    "a circle": (
        '<xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/>${a}',
        "xacro cannot expand it: circular variable definition: a -> b -> a",
    ),
    "an unknown macro": (
        "<xacro:nosuch/>",
        "xacro cannot expand it: unknown macro name: xacro:nosuch; correct the file, or give what it needs",
    ),
    "an unknown name": ("${nosuch}", "name 'nosuch' is not defined when evaluating expression 'nosuch'"),
    "an unknown argument": ("$(arg nosuch)", "Undefined substitution argument nosuch"),
    "an unknown command": ("$(argument x)", "xacro cannot expand it: Unknown substitution command [argument x]."),
    "a missing file": ('<xacro:include filename="none.xacro"/>', "No such file or directory"),
    "a long expression": (f"${{{'(' * 5000}{')' * 5000}}}", "too many nested parentheses"),
    "a large result": ("<a b=\"${'x' * 20_000_000}\"/>", "the file is larger than 10 MB"),
}


@pytest.mark.parametrize("case", few(REFUSED, *(set(REFUSED) - {"macros that double"})))
def test_hostile(within, case, monkeypatch):
    monkeypatch.setattr(xacro_files, "MAX_CPU_SECONDS", ENDLESS.get(case, SECONDS))
    body, message = REFUSED[case]
    path = within(body)
    with pytest.raises(urdf.URDFError) as caught:
        urdf.load(path)
    assert message in str(caught.value)
    assert str(path) in str(caught.value)
    assert "root:" not in str(caught.value)
    assert len(str(caught.value)) < 700


def test_a_link_out_of_the_folder(within, tmp_path):
    (tmp_path / "secret.xacro").write_text(MACROS, encoding="utf-8")
    path = within('<xacro:include filename="inside.xacro"/>')
    (path.parent / "inside.xacro").symlink_to(tmp_path / "secret.xacro")
    with pytest.raises(urdf.InvalidXacro, match=r"the file '.*secret.xacro' lies neither in the folder"):
        urdf.load(path)


def test_entities_are_refused_before_expansion(files):
    path = files({"r.xacro": '<!DOCTYPE r [<!ENTITY a "b">]><robot name="&a;"/>'})
    with pytest.raises(urdf.MalformedXML, match="the document declares XML entities"):
        urdf.load(path)


def test_entities_of_included_files_reach_no_file(files):
    secret = files({"r.xacro": CLEAN.replace("<robot ", f"<robot {NAMESPACE} ").replace(
        "</robot>", '<xacro:include filename="parts.xacro"/></robot>'
    ), "parts.xacro": '<!DOCTYPE r [<!ENTITY s SYSTEM "file:///etc/passwd">]><robot><a>&s;</a></robot>'})  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert urdf.load(secret).n_bodies == 2


def test_a_package_that_is_no_folder(arm):
    with pytest.raises(urdf.InvalidXacro, match=r"package 'a': '/nowhere' is not a folder; give the package's folder"):
        urdf.load(arm, xacro=urdf.Xacro(packages={"a": "/nowhere"}))


def test_processor_time_that_never_comes(arm, monkeypatch):
    monkeypatch.setattr(xacro_files, "MAX_WALL_SECONDS", 1e-3)
    with pytest.raises(urdf.InvalidXacro, match=r"expanding takes more than 5 s of processor time"):
        urdf.load(arm)


def test_an_expander_that_fails(arm, monkeypatch, tmp_path):
    script = tmp_path / "broken.py"
    script.write_text("raise SystemExit('no such luck')", encoding="utf-8")
    monkeypatch.setattr(xacro_files, "SCRIPT", script)
    with pytest.raises(urdf.InvalidXacro, match="the expander failed: no such luck; report it, with the file"):
        urdf.load(arm)


FENCE = """
import sys
sys.path.insert(0, sys.argv[1])
import process
sys.addaudithook(process.fence([sys.argv[2]]))
import os, socket
for attempt in (
    lambda: open(sys.argv[2] + "/new", "w"),
    lambda: os.open(sys.argv[2] + "/new", os.O_CREAT),
    lambda: os.listdir("/"),
    lambda: os.system("true"),
    lambda: os.remove(sys.argv[2] + "/r.xacro"),
    lambda: os.kill(os.getpid(), 0),
    lambda: socket.socket().connect(("127.0.0.1", 9)),
):
    try:
        attempt()
    except process.Refused as refusal:
        print(str(refusal).partition("'")[0].strip())
    else:
        print("done")
print(open(sys.argv[2] + "/r.xacro").read(6))
"""


def test_the_fence(within):
    """Even code that has got out of its expression writes nothing, starts nothing and connects to nothing."""
    path = within("")
    sources = FENCE.replace("import os, socket\n", "").replace("import sys\n", "import sys, os, socket\n", 1)
    command = [sys.executable, "-I", "-c", sources, str(Path(xacro_files.SCRIPT).parent), str(path.parent)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.stdout.splitlines() == [*["the file"] * 3, *["the document asks for"] * 4, "<robot"], done.stderr
    assert path.exists()
