"""urdf.repair: what is named is mended in a copy, and no other byte changes."""

import re

import pytest
from robots.mesh_files import box, mesh, one_link, stl, visual
from shared_data import ARMS

import urdf

REVERSED = ('lower="-1" upper="2"', "upper = '-1' lower='2'")
LONG_AXIS = ('<axis xyz="0 0 1"/>', '<axis\n xyz="0 0 1.0001"/>')


def without_numbers(data):
    return re.sub(rb"""(?<=["' ])[-+.\de]+(?=["' ])""", b"", data)


def test_three_repairs_and_not_one_other_byte(arm, tmp_path):
    path, out = arm(*REVERSED, *LONG_AXIS), tmp_path / "out.urdf"
    done = urdf.repair(path, out, urdf.REPAIRED_CODES)
    assert done == urdf.RepairedFile(
        out,
        (
            "line 19: <origin> of joint 'shoulder': rpy 0 0 1.5708 made 0 0 1.5707963267948966",
            "line 22: <axis> of joint 'shoulder': xyz 0 0 1.0001 made 0.0 0.0 1.0, of length 1",
            "line 24: <limit> of joint 'shoulder': lower 2 and upper -1 exchanged",
        ),
    )
    text = path.read_text().replace("1.5708", "1.5707963267948966").replace("0 0 1.0001", "0.0 0.0 1.0")
    assert out.read_text() == text.replace("upper = '-1' lower='2'", "upper = '2' lower='-1'")
    assert not urdf.REPAIRED_CODES.keys() & set(urdf.inspect(out).codes)


def test_names_of_repairs_do_too(arm, tmp_path):
    path, out = arm(*REVERSED), tmp_path / "out.urdf"
    assert urdf.repair(path, out, ["limits"]).changes
    assert "1.5708" in out.read_text()


def test_inertials_from_shapes(tmp_path):
    source, out = tmp_path / "arm.urdf", tmp_path / "out.urdf"
    stl(tmp_path / "box.stl", box())
    source.write_text(one_link(visual(mesh("box.stl")), mass=None))
    assert len(urdf.repair(source, out, [urdf.InertialsFromMeshes(density=1000)]).changes) == 1
    with pytest.warns(urdf.RepairWarning):
        computed = urdf.load(source, repair=[urdf.InertialsFromMeshes(density=1000)])
    assert (urdf.load(out).inertial_parameters == computed.inertial_parameters).all()
    assert re.sub(rb"\s*<inertial>.*</inertial>", b"", out.read_bytes(), flags=re.DOTALL) == source.read_bytes()


@pytest.mark.parametrize("path", sorted(ARMS.glob("*.urdf")), ids=lambda path: path.stem)
def test_files_of_makers(path, tmp_path):
    """The copy reads as urdf.load reads the file with these repairs, and differs from it in numbers alone."""
    out = tmp_path / "out.urdf"
    done = urdf.repair(path, out, urdf.REPAIRED_CODES)
    if not done.changes:
        assert not out.exists()
        return
    assert without_numbers(out.read_bytes()) == without_numbers(path.read_bytes())
    repaired, again = urdf.repair(out, None, urdf.REPAIRED_CODES), urdf.inspect(out, meshes="off")
    assert repaired.changes == ()
    assert set(again.codes) == set(urdf.inspect(path, meshes="off", repair=urdf.REPAIRED_CODES.values()).codes)


def test_nothing_is_written_where_nothing_is_repaired(arm, tmp_path):
    assert urdf.repair(arm(), tmp_path / "out.urdf", ["axis"]) == urdf.RepairedFile(None, ())
    assert not (tmp_path / "out.urdf").exists()


def test_refused(arm, tmp_path):
    out = tmp_path / "out.urdf"
    with pytest.raises(
        urdf.InvalidRepair, match=r"no repair is named; known: angles, axis, geoms, inertials, limits, axis-not-norm"
    ):
        urdf.repair(arm(), out, [])
    with pytest.raises(urdf.InvalidRepair, match=r"no repair is called 'crossed'; known: angles, axis, geoms, inert"):
        urdf.repair(arm(), out, ["crossed"])
    with pytest.raises(urdf.CannotUpdate, match=r"a \.xacro file has no <inertial> of its own to edit"):
        urdf.repair(arm().rename(tmp_path / "arm.xacro"), out, ["axis"])
    (tmp_path / "wide.urdf").write_text(arm().read_text(), encoding="utf-16")
    with pytest.raises(urdf.CannotUpdate, match="UTF-16 or another encoding that cannot be edited; save it as UTF-8"):
        urdf.repair(tmp_path / "wide.urdf", out, ["angles"])
    assert not out.exists()
