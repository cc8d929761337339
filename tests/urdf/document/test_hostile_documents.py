"""Documents that are made to harm: refused or handled, without hanging and within 500 MB, by load and by inspect."""

import faulthandler
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from long_check import few
from urdf_text import joint, link, robot_text

import urdf
from urdf.document.document import MAX_TAGS, MAX_URDF_BYTES
from urdf.document.source import MAX_LINKS

SECONDS = 300
"""After which a test counts as hung, and its process is ended; the longest takes two."""

MEGABYTES = 500

MANY = 25_000
"""Elements of which work that grows with the square of their number hangs."""

LAUGHS = "".join(f'<!ENTITY a{k} "' + f"&a{k - 1};" * 10 + '">' for k in range(1, 12))
LONG = "x" * 50_000


def chain(n, kind="revolute"):
    """n links in a row; the first joint is revolute."""
    joints = [joint(f"j{k}", f"l{k - 1}", f"l{k}", kind if k > 1 else "revolute") for k in range(1, n)]
    return robot_text("chain", *(link(f"l{k}") for k in range(n)), *joints)


def ring(n):
    return robot_text(
        "ring", *(link(f"l{k}") for k in range(n)), *(joint(f"j{k}", f"l{k}", f"l{(k + 1) % n}") for k in range(n))
    )


def within(content):
    return f'<robot name="r">{content}</robot>'


def with_inertials(n):
    return within('<link name="a">' + "<inertial/>" * n + "</link>")


REFUSED = {
    "billion laughs": (
        lambda: f'<!DOCTYPE r [<!ENTITY a0 "lol">{LAUGHS}]><robot name="x">&a11;</robot>',
        "xml-limits",
        r"the document exceeds a limit of the XML parser: Maximum entity amplification.*; give an ordinary URDF file",
    ),
    "quadratic blow-up": (
        lambda: f'<!DOCTYPE r [<!ENTITY a "{LONG}">]><robot name="' + "&a;" * 50_000 + '"/>',
        "xml-limits",
        "Maximum entity amplification",
    ),
    "100,000 nested elements": (
        lambda: within("<link>" * 100_000 + "</link>" * 100_000),
        "too-large",
        "the file has 200002 tags",
    ),
    "10,000 nested elements": (
        lambda: within("<link>" * 10_000 + "</link>" * 10_000),
        "xml-limits",
        "Excessive depth in document",
    ),
    "an endless text": (lambda: within("x" * (MAX_URDF_BYTES - 100)), "no-links", "there is no <link>"),
    "an endless number": (
        lambda: within('<link name="a"><inertial><mass value="' + "1" * 5_000_000 + '"/></inertial></link>'),
        "not-finite",
        "<inertia> is missing",
    ),
    "many tags": (
        lambda: within("<a/>" * MAX_TAGS),
        "too-large",
        rf"the file has {MAX_TAGS + 2} tags, more than {MAX_TAGS}; give a smaller file",
    ),
    "many elements of one kind": (
        lambda: with_inertials(MANY),
        "duplicate-element",
        f"{MANY} elements <inertial>",
    ),
    "many namespaces": (
        lambda: within("".join(f'<a xmlns:a{k}="u{k}" a{k}:x="1"/>' for k in range(MANY))),
        "no-links",
        "there is no <link>",
    ),
    "many namespaces of one element": (
        lambda: "<robot " + " ".join(f'xmlns:a{k}="u{k}"' for k in range(100_000)) + "/>",
        "missing-name",
        "attribute 'name' is missing",
    ),
    "many attributes": (
        lambda: "<robot " + " ".join(f'a{k}=""' for k in range(500_000)) + "/>",
        "too-large",
        "an element has more than 100 attributes; remove what is not URDF",
    ),
    "10,000 links": (
        lambda: chain(10_000),
        "too-large",
        f"the robot has 10000 links, more than {MAX_LINKS}; give a smaller robot",
    ),
    "many joints": (
        lambda: robot_text("r", link("a"), *(joint(f"j{k}", "a", "a") for k in range(MAX_LINKS + 1))),
        "too-large",
        f"the robot has {MAX_LINKS + 1} joints, more than {MAX_LINKS}",
    ),
    "a long cycle": (lambda: ring(MAX_LINKS), "no-root", "no root: every link is the child of a joint"),
}


def write(tmp_path, text):
    path = tmp_path / "hostile.urdf"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(autouse=True)
def _not_hung():
    faulthandler.dump_traceback_later(SECONDS, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()


def refusal(path):
    with pytest.raises(urdf.URDFError) as caught:
        urdf.load(path)
    return caught


@pytest.mark.parametrize("case", REFUSED)
def test_refused(tmp_path, case):
    text, code, message = REFUSED[case]
    path = write(tmp_path, text())
    caught = refusal(path)
    assert caught.match(message)
    assert len(str(caught.value)) < 1000
    report = urdf.inspect(path)
    assert report.verdict == "refused"
    assert code in report.codes
    assert all(len(finding.text) < 2000 for finding in report.findings)


def test_200_megabytes(tmp_path):
    path = tmp_path / "large.urdf"
    with path.open("wb") as file:
        file.truncate(200_000_000)
    caught = refusal(path)
    assert caught.type is urdf.TooLarge
    assert caught.match("the file is larger than 10 MB; give a URDF file; put meshes into separate files")
    assert urdf.inspect(path).codes == ("too-large",)


@pytest.mark.parametrize("kind", few(["revolute", "fixed"], "revolute"))
def test_the_longest_chain_that_is_read(tmp_path, kind):
    """No recursion anywhere."""
    path = write(tmp_path, chain(MAX_LINKS, kind))
    model = urdf.load(path)
    assert model.n_bodies == (MAX_LINKS - 1 if kind == "revolute" else 1)
    report = urdf.inspect(path)
    assert report.verdict == "dynamics"


class TestOutside:
    """Nothing outside the file is read, and the network is left alone."""

    @pytest.fixture
    def secret(self, tmp_path):
        path = tmp_path / "secret.txt"
        path.write_text("tell nobody", encoding="utf-8")
        return path.as_uri()

    @pytest.mark.parametrize(
        ("document", "code"),
        [
            ('<!DOCTYPE r [<!ENTITY s SYSTEM "{0}">]><robot name="x">&s;</robot>', "xml-entities"),
            ('<!DOCTYPE r [<!ENTITY % s SYSTEM "{0}"> %s;]><robot name="x"/>', "xml-entities"),
            ('<!DOCTYPE r SYSTEM "{0}"><robot name="x"/>', "document-type"),
            ('<!DOCTYPE r [<!ATTLIST link name CDATA "x">]><robot name="x"><link/></robot>', "document-type"),
            ('<!DOCTYPE r SYSTEM "http://192.0.2.1/r.dtd"><robot name="x"/>', "document-type"),
            ('<!DOCTYPE r [<!ENTITY s SYSTEM "http://192.0.2.1/">]><robot name="x">&s;</robot>', "xml-entities"),
            (
                '<robot name="x"><xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="{0}"/></robot>',
                "no-links",
            ),
            ('<?xml-stylesheet href="{0}"?><robot name="x"/>', "no-links"),
            ('<robot name="x"><x:include xmlns:x="http://ros.org/wiki/xacro" filename="{0}"/></robot>', "no-links"),
        ],
    )
    def test_nothing_is_fetched(self, tmp_path, secret, document, code):
        path = write(tmp_path, document.replace("{0}", secret))
        caught = refusal(path)
        report = urdf.inspect(path)
        assert caught.value.code == code
        assert code in report.codes
        assert "nobody" not in f"{caught.value}{report}"

    def test_meshes_are_not_opened(self, tmp_path, monkeypatch):
        mesh = '<visual><geometry><mesh filename="/dev/zero"/></geometry></visual></link>'
        path = write(tmp_path, chain(3).replace("</link>", mesh))
        urdf.load(path)  # yourdfpy, imported with the first file, opens files of its own
        opened = []
        original = Path.open
        monkeypatch.setattr(Path, "open", lambda self, *rest: opened.append(self) or original(self, *rest))
        assert urdf.inspect(path).usable
        assert opened == [path]


MEASURE = """
import re, sys, warnings
import urdf
warnings.simplefilter("ignore")
for path in sys.argv[1:]:
    urdf.inspect(path)
    try:
        urdf.load(path)
    except urdf.URDFError:
        pass
print(int(re.search(r"VmHWM:\\s*(\\d+) kB", open("/proc/self/status").read())[1]) // 1024)
"""
"""ru_maxrss would begin with the memory of the process that started this one."""


LARGE = {
    "attributes": lambda: within('<link name="${a}" b="1"/>' * (MAX_TAGS - 10)),
    "inertials": lambda: with_inertials(MAX_TAGS - 10),
    "attribute": REFUSED["many attributes"][0],
    "chain": lambda: chain(MAX_LINKS),
}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="/proc is of Linux")
@pytest.mark.parametrize("document", few(LARGE, "inertials"))
def test_memory(tmp_path, document):
    command = [sys.executable, "-c", MEASURE, str(write(tmp_path, LARGE[document]()))]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=250)
    assert int(done.stdout) < MEGABYTES


HUGE_NUMBERS = ["1e308", "-1e308", "1e-320", "1e200", "1e160", "4.9e-324"]


@pytest.mark.parametrize("number", HUGE_NUMBERS)
def test_numbers_at_the_ends_of_the_range(tmp_path, number):
    """Overflow is found, not raised; no warning of NumPy leaves the inspection or the import."""
    for old in ('ixx="0.1"', 'ixy="0"', 'value="1.0"', 'xyz="0 0 0"', 'rpy="0 0 0"', 'axis xyz="0 0 0"'):
        new = old.replace("0 0 0", f"{number} 0 0") if "0 0 0" in old else f'{old.split("=")[0]}="{number}"'
        text = chain(3).replace("</joint>", '<axis xyz="0 0 0"/></joint>').replace(old, new)
        path = write(tmp_path, text.replace('<axis xyz="0 0 0"/>', ""))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", urdf.URDFWarning)
            report = urdf.inspect(path)
            if report.verdict == "refused":
                with pytest.raises(urdf.InvalidNumber):
                    urdf.load(path)
            else:
                assert np.isfinite(urdf.load(path).inertial_parameters).all()
