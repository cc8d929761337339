"""What shows when several files are compared."""

import pytest
from inspected.sample import CLEAN, MASS, changed

import urdf
from urdf.inspection import compared

UPPER = 'ixx="0.11" ixy="0" ixz="0" iyy="0.13" iyz="0" izz="0.17"'


def heavier(factor, tensor=None):
    """The sample with an upper arm of other density."""
    moments = (repr(x * (tensor or factor)) for x in (0.11, 0.13, 0.17))
    ixx, iyy, izz = moments
    return changed(
        MASS, f'<mass value="{2.5 * factor!r}"/>', UPPER, f'ixx="{ixx}" ixy="0" ixz="0" iyy="{iyy}" iyz="0" izz="{izz}"'
    )


@pytest.fixture
def told(tmp_path):
    """The messages of a code, per file; files by their texts."""

    def run(code, *texts):
        paths = [tmp_path / f"arm{k}.urdf" for k in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text, encoding="utf-8")
        return [
            [(one.severity, one.element, one.line, one.message) for one in report.findings if one.code == code]
            for report in compared([urdf.inspect(path) for path in paths])
        ]

    return run


def test_steel_in_place_of_water(told):
    light, other, heavy = told("other-density", CLEAN, heavier(3), heavier(7.85))
    upper = "warning", "<inertial> of link 'upper'", 4
    assert light == [
        (
            *upper,
            "2.5 kg, where this link of arm2.urdf has 19.62 kg with the same center of mass and tensor over mass: in 1 "
            "link a ratio of 7.85, steel for water or the other way round",
        )
    ]
    assert heavy[0][:3] == upper
    assert heavy[0][3].startswith("19.62 kg, where this link of arm0.urdf has 2.5 kg")
    assert other == []


@pytest.mark.parametrize(
    ("factor", "tensor", "found"),
    [
        *((2.7, None, True), (2.907, None, True), (1000, None, True), (7.78, None, True)),
        *((1, None, False), (7.7, None, False), (8.0, None, False), (7.85, 7.6, False), (7.85, 1, False)),
    ],
)
def test_ratios(told, factor, tensor, found):
    assert [len(each) for each in told("other-density", CLEAN, heavier(factor, tensor))] == [found, found]


def test_other_bodies_are_not_compared(told):
    moved = heavier(7.85).replace('"0.1 0.2 0.3"', '"0.1 0.2 0.31"')
    renamed = heavier(7.85).replace('"upper"', '"other"')
    for text in (moved, renamed):
        assert told("other-density", CLEAN, text) == [[], []]


def test_copied_inertials(told):
    """One arm with a forearm 0.1 m farther away."""
    longer = changed('xyz="0.3 0 0"', 'xyz="0.4 0 0"')
    message = "the inertial of this link of arm{}.urdf, where the next joint is {} m away, here {} m"
    upper = "note", "<inertial> of link 'upper'", 4
    assert told("equal-inertials", CLEAN, longer) == [
        [(*upper, message.format(1, 0.4, 0.3))],
        [(*upper, message.format(0, 0.3, 0.4))],
    ]
    assert told("equal-inertials", CLEAN, CLEAN) == [[], []]
    assert told("equal-inertials", CLEAN, longer.replace('"2.5"', '"2.6"')) == [[], []]


def test_files_that_cannot_be_compared(tmp_path):
    """Refused, without a path, and gone since."""
    gone = tmp_path / "gone.urdf"
    gone.write_text(heavier(7.85), encoding="utf-8")
    reports = [urdf.inspect(gone), urdf.inspect(CLEAN), urdf.inspect("<robot/>"), urdf.inspect(tmp_path / "none.urdf")]
    gone.unlink()
    assert compared(reports) == reports


def test_the_largest_numbers(told):
    """Nothing is said of them, and no warning of NumPy either."""
    large = changed(UPPER, UPPER.replace("0.1", "1.1e307"))
    assert told("other-density", large, large.replace('"2.5"', '"19.625"')) == [[], []]
