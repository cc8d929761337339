"""urdf.update: new inertial parameters into a file, and nothing else."""

import re

import numpy as np
import pytest
from shared_data import ARMS
from urdf_text import joint, link

import graphdyn
import urdf

PARITY = 1e-10
"""‖W π - τ(reloaded)‖ relative to the largest torque: rounding of sums and of the parallel-axis terms."""

EXACT = 1e-13
"""Parameters that were written and read again: the tensor moves to the center of mass and back."""


def real_parameters(rng, n):
    """Of bodies that exist: a sum of point masses each."""
    rows = []
    for _ in range(n):
        points, weights = rng.normal(size=(8, 3)) * 0.1 + rng.normal(size=3) * 0.2, rng.uniform(0.1, 1, 8)
        center = weights @ points / weights.sum()
        tensor = sum(
            w * ((p - center) @ (p - center) * np.eye(3) - np.outer(p - center, p - center))
            for w, p in zip(weights, points, strict=True)
        )
        rows.append(graphdyn.Body("x", weights.sum(), center, tensor).parameters)
    return np.array(rows)


def without_inertials(data):
    return re.sub(rb"\s*<inertial>.*?</inertial>", b"", data, flags=re.DOTALL)


def reads_back(path, parameters, **options):
    """The file has these parameters, and the torques that the regressor gives for them."""
    model = urdf.load(path, **options)
    parameters = np.reshape(parameters, (-1, 10))
    written = np.abs(model.inertial_parameters.reshape(-1, 10) - parameters).max() / np.abs(parameters).max()
    q, v = model.random_state(np.random.default_rng(1), 10)
    a = np.ones_like(q)
    expected = graphdyn.joint_torque_regressor(model, q, v, a) @ np.ravel(parameters)
    torque = np.abs(graphdyn.inverse_dynamics(model, q, v, a).tau - expected).max() / np.abs(expected).max()
    return written <= EXACT and torque <= PARITY


def test_only_the_inertials_change(arm, tmp_path):
    path, out = arm(), tmp_path / "out.urdf"
    parameters = real_parameters(np.random.default_rng(0), 2)
    done = urdf.update(path, out, parameters)
    assert done == urdf.Update(out, ("upper", "fore"), (), ())
    assert reads_back(out, parameters)
    assert without_inertials(out.read_bytes()) == without_inertials(path.read_bytes())


def test_what_is_right_already_is_not_touched(arm, tmp_path):
    path, out = arm(), tmp_path / "out.urdf"
    model = urdf.load(path)
    done = urdf.update(path, out, model.inertial_parameters)
    assert (done.changed, done.kept) == ((), ("upper", "fore"))
    assert out.read_bytes() == path.read_bytes()
    parameters = np.array(model.inertial_parameters).reshape(2, 10)
    parameters[1] = real_parameters(np.random.default_rng(0), 1)
    done = urdf.update(path, out, parameters.ravel())
    assert (done.changed, done.kept) == (("fore",), ("upper",))
    assert out.read_bytes().partition(b'<link name="fore">')[0] == path.read_bytes().partition(b'<link name="fore">')[0]


ODD = """<?xml version="1.0" encoding="UTF-8"?>\r
<!-- <inertial>not this</inertial> é -->\r
<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">\r
\t<link name="base"/><link name='a' note="a > b"><visual><geometry><box size="1 1 1"/></geometry></visual></link>\r
\t<link name="b"/>\r
\t<link name="c">\r
\t\t<inertial> <mass value="1"/> <origin xyz="0 0 1" rpy="1 2 3"/>\r
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial   >\r
\t</link>\r
{joints}</robot>\r
<!-- after -->\r
"""


def test_odd_files_keep_their_oddities(tmp_path):
    """Comments, CRLF, tabs, text like an element, links without <inertial>, closed tags, a byte-order mark."""
    joints = "\r\n".join(joint(f"j{child}", parent, child) for parent, child in (("base", "a"), "ab", "bc"))
    path, out = tmp_path / "odd.urdf", tmp_path / "out.urdf"
    path.write_bytes(b"\xef\xbb\xbf" + ODD.format(joints=joints).encode())
    parameters = real_parameters(np.random.default_rng(0), 3)
    with pytest.warns(urdf.MissingInertialWarning):
        urdf.update(path, out, parameters)
    assert reads_back(out, parameters)
    before, after = path.read_bytes(), out.read_bytes()
    assert b"\n" not in after.replace(b"\r\n", b"")
    for kept in (
        b"\xef\xbb\xbf<?xml",
        b"<!-- <inertial>not this</inertial> \xc3\xa9 -->",
        b'note="a > b"',
        b"<!-- after -->",
    ):
        assert kept in after
    assert after.count(b"<inertial>") == 4
    assert re.sub(rb"\s*<inertial>\s.*?</inertial\s*>", b"", after, flags=re.DOTALL).replace(
        b'<link name="b">\r\n\t</link>', b'<link name="b"/>'
    ) == re.sub(rb"\s*<inertial> .*?</inertial\s*>", b"", before, flags=re.DOTALL)


def test_fixed_links_keep_their_share(robot, tmp_path):
    path = robot(
        link("base"), link("arm", xyz="0.1 0 0"), link("tool", mass=0.5, xyz="0 0.2 0", tensor="0.01 0 0 0.01 0 0.01"),
        joint("turn", "base", "arm"), joint("screws", "arm", "tool", "fixed", '<origin xyz="0.5 0 0" rpy="0 0 0.3"/>'),
    )  # fmt: skip
    out = tmp_path / "out.urdf"
    parameters = 1.5 * urdf.load(path).inertial_parameters
    done = urdf.update(path, out, parameters)
    assert done.notes == ("link 'arm' gets 1.75 kg: its fixed links 'tool' (0.5 kg) keep their own <inertial>",)
    assert reads_back(out, parameters)
    with pytest.raises(urdf.CannotUpdate, match="its fixed links weigh as much or more by themselves"):
        urdf.update(path, out, 0.1 * parameters)


def test_locked_joints_as_when_identified(arm, tmp_path):
    path, out = arm(), tmp_path / "out.urdf"
    lock = {"slide": 0.2}
    parameters = 1.1 * urdf.load(path, lock=lock).inertial_parameters
    done = urdf.update(path, out, parameters, lock=lock)
    assert "'fore' (1.5 kg)" in done.notes[0]
    assert reads_back(out, parameters, lock=lock)


def test_in_place_and_from_the_catalog(arm, tmp_path):
    path = arm()
    parameters = real_parameters(np.random.default_rng(0), 2)
    urdf.update(path, path, parameters)
    assert reads_back(path, parameters)
    out = tmp_path / "ur5.urdf"
    parameters = real_parameters(np.random.default_rng(0), 6)
    urdf.update("ur5", out, parameters)
    assert reads_back(out, parameters)


class TestRefusals:
    @pytest.mark.parametrize(
        ("parameters", "message"),
        [
            (np.zeros(10), r"arm.urdf: the parameters have shape \(10,\), expected \(2, 10\) or \(20,\)"),
            (["a"] * 20, "the parameters are not numbers: .*give ten numbers per body"),
            (
                [*range(14), np.nan, *range(5)],
                "the parameters of body 2 contain NaN or infinity; parameters that",
            ),
            (-np.ones((2, 10)), "mass -1.0 kg is negative; give a mass of at least 0"),
        ],
    )
    def test_parameters(self, arm, tmp_path, parameters, message):
        out = tmp_path / "out.urdf"
        with pytest.raises(urdf.CannotUpdate, match=message):
            urdf.update(arm(), out, parameters)
        assert not out.exists()

    def test_inconsistent(self, arm, tmp_path):
        parameters = real_parameters(np.random.default_rng(0), 2)
        parameters[0, 4:] *= -1
        out = tmp_path / "out.urdf"
        message = "link 'upper': no real body has these parameters: .*inconsistent=True"
        with pytest.raises(urdf.CannotUpdate, match=message):
            urdf.update(arm(), out, parameters)
        assert not out.exists()
        urdf.update(arm(), out, parameters, inconsistent=True)
        assert reads_back(out, parameters)

    @pytest.mark.parametrize(
        ("encoding", "declared"),
        [
            *[2 * (name,) for name in ("utf-16", "utf-16-le", "utf-32", "shift_jis")],
            ("utf-16-be", "utf-16"),
        ],
    )
    def test_encodings_without_a_place_for_ascii(self, arm, tmp_path, encoding, declared):
        path = arm()
        body = path.read_text().rpartition("?>")[2]
        path.write_text(f'<?xml version="1.0" encoding="{declared}"?>{body}', encoding=encoding)
        with pytest.raises(
            urdf.CannotUpdate, match="UTF-16 or another encoding that cannot be edited; save it as UTF-8"
        ):
            urdf.update(path, tmp_path / "out.urdf", np.zeros(20))


@pytest.mark.skipif(
    not ARMS.is_dir(), reason=f"not found: {ARMS}; set GRAPHDYN_TEST_DATA to the folder with shared data"
)
@pytest.mark.filterwarnings("ignore::urdf.URDFWarning")
@pytest.mark.parametrize("path", sorted(ARMS.glob("*.urdf")), ids=lambda path: path.stem)
def test_vendor_files(path, tmp_path):
    """Every body twice as heavy; the rest of the file byte by byte."""
    out = tmp_path / "out.urdf"
    parameters = 2 * urdf.load(path).inertial_parameters.reshape(-1, 10)
    done = urdf.update(path, out, parameters, inconsistent=True)
    assert not parameters.any() or reads_back(out, parameters)
    if not done.changed:
        assert out.read_bytes() == path.read_bytes()
