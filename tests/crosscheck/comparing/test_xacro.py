"""A .xacro file in the commands and in the comparison: Pinocchio gets what it expands to."""

import importlib.util
import json

import pytest
from planting import flagged
from typer.testing import CliRunner
from urdf_text import joint, link, robot_text

import crosscheck
from crosscheck.commands import app
from crosscheck.reference.subject import content_sha256, subject
from urdf import Reading, Xacro

pytestmark = pytest.mark.skipif(importlib.util.find_spec("xacro") is None, reason="the extra xacro is not installed")

BODY = link("a", 2.0, xyz="0.1 0 ${0.1 * 2}").replace("<robot ", "")
ARM = robot_text(
    'r" xmlns:xacro="http://www.ros.org/wiki/xacro',
    '<xacro:include filename="base.xacro"/>',
    BODY,
    joint("j", "base", "a", "continuous", '<axis xyz="0 1 0"/>'),
)
BASE = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="base"/></robot>'


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "base.xacro").write_text(BASE, encoding="utf-8")
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(ARM, encoding="utf-8")
    return path


def test_comparison(arm):
    comparison = crosscheck.compare(arm, 2)
    assert (comparison.routes, comparison.file) == (("urdf", "model"), str(arm))
    assert flagged(comparison) == set()


def test_the_hash_is_that_of_the_expansion(arm):
    """A changed include is a changed robot."""
    before = content_sha256(arm)
    assert content_sha256(arm) == before
    arm.with_name("base.xacro").write_text(BASE.replace('"base"', '"base" id="x"'), encoding="utf-8")
    assert content_sha256(arm) != before


def test_the_hash_of_a_subject_is_that_of_its_own_arguments(arm):
    """As urdf writes the expansion with them."""
    arm.write_text(
        ARM.replace("<link", '<xacro:arg name="m" default="2"/><link', 1).replace("2.0", "$(arg m)"), encoding="utf-8"
    )
    plain, heavy = (subject(arm, Reading(xacro=chosen)) for chosen in (None, Xacro({"m": "5"})))
    assert [found.model.bodies[-1].mass for found in (plain, heavy)] == [2.0, 5.0]
    assert plain.file_sha256 == content_sha256(arm)
    assert heavy.file_sha256 == content_sha256(arm, Xacro({"m": "5"}))
    assert heavy.file_sha256 != plain.file_sha256


def test_commands(arm, tmp_path):
    for command in (["inspect"], ["crosscheck", "--samples", "2"]):
        out = tmp_path / "out.json"
        done = CliRunner().invoke(app, [*command, str(arm), "--json", str(out)])
        assert done.exit_code == 0, done.output
        assert json.loads(out.read_text(encoding="utf-8"))["command"]
