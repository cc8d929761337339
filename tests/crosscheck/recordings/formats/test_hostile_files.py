"""Damaged and hostile files: an error that names the file, before memory is taken; nothing left out without a word."""

import gzip
import io
import re
import zipfile

import h5py
import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from scipy.io import savemat

from crosscheck.recordings import (
    BadMapping,
    BadRecordingFile,
    StreamedRecording,
    inspect_recording,
    load_mapping,
    load_recording,
    mapping_of,
)
from crosscheck.recordings.formats import format as files
from graphdyn import InvalidInput

T = np.arange(20) / 10
Q = np.column_stack([np.sin(T), np.cos(T)])
LARGEST = 10_000


@pytest.fixture
def small_bound(monkeypatch):
    """The bound on expanded files, at a size that a test can exceed."""
    for module in ("format", "matlab_files"):
        monkeypatch.setattr(f"crosscheck.recordings.formats.{module}.MAX_EXPANDED_BYTES", LARGEST)


def test_the_bound_that_is_documented():
    assert files.MAX_EXPANDED_BYTES == 1_073_741_824


def npy(shape, body=b"", kind="<f8"):
    file = io.BytesIO()
    header = {"descr": kind, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(file, header)
    return file.getvalue() + body


def archive(path, **members):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in members.items():
            file.writestr(f"{name}.npy", content)
    return path


@pytest.mark.parametrize("shape", [(10**12,), (2**62, 8), (10**6,)])
def test_an_array_that_announces_more_than_there_is(tmp_path, shape):
    path = archive(tmp_path / "r.npz", t=npy(shape, bytes(80)))
    size = 8 * int(np.prod(shape, dtype=object))
    with pytest.raises(BadRecordingFile, match=rf"r.npz: 't.npy' announces {size} bytes of numbers and has 208; save"):
        load_recording(path)


def test_a_damaged_header(tmp_path):
    path = archive(tmp_path / "r.npz", t=npy((-3,)), q=npy((3,), bytes(24)))
    with pytest.raises(BadRecordingFile, match=r"r.npz: 't' is not an array of numbers; save it as one"):
        load_recording(path)


def test_a_parquet_file_whose_checksum_does_not_fit(tmp_path):
    """Pages may have one; a changed digit is then no number of the recording."""
    path = tmp_path / "r.parquet"
    table = pa.table({"t": T, "q_1": Q[:, 0]})
    parquet.write_table(table, path, write_page_checksum=True, compression="none", use_dictionary=False)
    assert load_recording(path).q[:, 0].tolist() == Q[:, 0].tolist()
    content = bytearray(path.read_bytes())
    content[content.index(T.tobytes()) + 20] ^= 1
    path.write_bytes(content)
    with pytest.raises(BadRecordingFile, match=r"r.parquet: not a readable Parquet file \(.*CRC checksum.*\); save it"):
        load_recording(path)


def write_parquet(path, lists=False):
    columns = {"t": np.zeros(200), "q": np.zeros((200, 10)).tolist()} if lists else {"t": np.zeros(2000)}
    parquet.write_table(pa.table(columns), path)


def write_mat73(path):
    with h5py.File(path, "w", userblock_size=512) as file:
        file.create_dataset("t", (2000,), "f8", fillvalue=0.0, chunks=(10,))
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\x00\x02IM")


EXPANDING = {
    "r.csv.gz": lambda path: path.write_bytes(gzip.compress(b"t,q_1\n" + b"0,1\n" * 5000)),
    "r.npz": lambda path: np.savez_compressed(path, t=np.zeros(2000)),
    "r.parquet": write_parquet,
    "lists.parquet": lambda path: write_parquet(path, lists=True),
    "r.mat": lambda path: savemat(path, {"t": np.zeros(2000)}, do_compression=True),
    "plain.mat": lambda path: savemat(path, {"t": np.zeros(2000)}),
    "r73.mat": write_mat73,
}


@pytest.mark.parametrize("name", EXPANDING)
def test_what_expands_too_far(tmp_path, small_bound, name):
    path = tmp_path / name
    EXPANDING[name](path)
    with pytest.raises(
        BadRecordingFile, match=rf"{name}: its content is larger than {LARGEST} bytes when expanded; divi"
    ):
        load_recording(path)


def test_a_bomb_is_not_expanded_further_than_the_bound(tmp_path, monkeypatch):
    """16 MB of zeros: no more is read than the bound."""
    monkeypatch.setattr("crosscheck.recordings.formats.format.MAX_EXPANDED_BYTES", 1 << 20)
    monkeypatch.setattr("crosscheck.recordings.formats.format.MAX_EXPANDED_BYTES", 1 << 20)
    read = []
    original = gzip.GzipFile.read

    def counted(self, size=-1):
        read.append(original(self, size))
        return read[-1]

    monkeypatch.setattr(gzip.GzipFile, "read", counted)
    (tmp_path / "r.csv.gz").write_bytes(gzip.compress(bytes(1 << 24)))
    with pytest.raises(BadRecordingFile, match="larger than 1048576 bytes when expanded"):
        load_recording(tmp_path / "r.csv.gz")
    assert sum(map(len, read)) == (1 << 20) + 1


def text(columns=2, rows=20):
    names = ",".join(["t", *(f"q_{k}" for k in range(1, columns))])
    return "\n".join([names, *(",".join([str(k / 10), *["0.5"] * (columns - 1)]) for k in range(rows))]) + "\n"


def test_compressed_text(tmp_path):
    path = tmp_path / "r.CSV.GZ"
    path.write_bytes(gzip.compress(text().encode()))
    assert np.array_equal(load_recording(path).t, T)
    for name in ("r.tsv.gz", "r.txt.gz"):
        (tmp_path / name).write_bytes(gzip.compress(text().replace(",", "\t").encode()))
        assert np.array_equal(load_recording(tmp_path / name).t, T)
    for name, content in {"cut.csv.gz": path.read_bytes()[:-20], "plain.csv.gz": text().encode()}.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(BadRecordingFile, match=rf"{name}: not a whole gzip file \(.*\); compress it again"):
            load_recording(tmp_path / name)
        with pytest.raises(BadRecordingFile, match=rf"{name}: .*; load_recording gives details, or repair the file"):
            list(StreamedRecording(tmp_path / name))
    (tmp_path / "r.npz.gz").write_bytes(b"x")
    with pytest.raises(BadRecordingFile, match=r"recordings cannot be read from '.npz.gz' files; .*csv.gz"):
        load_recording(tmp_path / "r.npz.gz")


def test_very_many_columns(tmp_path):
    (tmp_path / "r.csv").write_text(text(200_000, 3))
    with pytest.raises(
        BadRecordingFile, match=r"r.csv, line 1: longer than 262144 characters; write one line per time"
    ):
        load_recording(tmp_path / "r.csv")
    (tmp_path / "r.csv").write_text(text(3000, 3).replace("q_", "x_"))
    with pytest.raises(BadMapping, match=r"among t, x_1, .*, x_39, … \(3000 in all\); give a mapping"):
        load_recording(tmp_path / "r.csv")


def test_a_very_long_cell(tmp_path):
    (tmp_path / "r.csv").write_text('t,q_1,"' + "x" * 200_000 + '"\n0,1,2\n1,2,3\n')
    with pytest.raises(BadRecordingFile, match=r"r.csv: 2 of 2 lines do not have 1 cell like the first one"):
        load_recording(tmp_path / "r.csv")


@pytest.mark.parametrize("options", [{}, {"do_compression": True}, {"format": "4"}])
def test_truncated_matlab_files(tmp_path, options):
    savemat(tmp_path / "r.mat", {"t": T, "q": Q}, **options)
    whole = (tmp_path / "r.mat").read_bytes()
    for length in (0, 10, 127, 130, 140, len(whole) // 2, len(whole) - 1):
        (tmp_path / "r.mat").write_bytes(whole[:length])
        with pytest.raises(BadRecordingFile, match=r"r.mat: "):
            load_recording(tmp_path / "r.mat")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("x=" + "[" * 5000, r"m.toml: is no TOML: .*; write it as docs/recordings shows"),
        ("x=" + "{a=" * 3000, r"m.toml: is no TOML: .*"),
        ('joints=["a"]\nrate' + ".a" * 3000 + "=1\n[q]\ncolumns=[1]", r"m.toml: line 2: a key of more than 50 parts"),
        ("rate=" + "9" * 5000, r"m.toml: is no TOML: .*5000 digits"),
        (
            'joints=["a"]\nrate=' + "9" * 400 + "\n[q]\ncolumns=[1]",
            r"m.toml: rate is 9{18}\.{3}9{19}; give samples per second",
        ),
        ('joints=["a"]\nrate=1\n[q]\ncolumns=[1]\noffset=' + "9" * 400, r"m.toml, \[q\]: offset is 9+; give 1 number"),
        (
            'joints=["a"]\nrate=1\n[q]\ncolumns=[1]\noffset=9007199254740993',
            r"m.toml, \[q\]: offset is 9007199254740993; give 1 number",
        ),
        ('joints=["a"]\nrate=1\n[q]\ncolumns=[1]\noffset=nan', r"m.toml, \[q\]: offset is nan; give 1 number"),
        ('joints=["a"]\nrate=1\ndelimiter=""\n[q]\ncolumns=[1]', r"m.toml: delimiter is ''; give the one character"),
        (
            'joints=["a"]\nrate=1\ndelimiter="::"\n[q]\ncolumns=[1]',
            r"m.toml: delimiter is '::'; give the one character",
        ),
    ],
)
def test_hostile_mappings(tmp_path, content, message):
    (tmp_path / "m.toml").write_text(content)
    with pytest.raises(BadMapping, match=message):
        load_mapping(tmp_path / "m.toml")


def test_a_transmission_without_a_side_would_have_no_effect():
    mapping = {"joints": ["a"], "rate": 1, "q": {"columns": [1]}, "transmission": {"ratio": [100]}}
    with pytest.raises(BadMapping, match=r'm: \[transmission\] without side = "motor"; say which columns are in front'):
        mapping_of(mapping, "m")


@pytest.mark.parametrize(
    ("tau", "reason"),
    [
        (np.ones((20, 2, 3)), r"its shape is \(20, 2, 3\), where \(N,\) or \(N, n\) is needed"),
        (np.ones((20, 1, 2)), r"its shape is \(20, 1, 2\), where"),
        (np.ones((20, 2)) * 1j, r"it holds complex numbers; save their real parts"),
        (np.ones((20, 2), dtype=bool), r"it holds truth values, no numbers"),
        (np.full((20, 2), "1"), r"it holds no numbers"),
        (np.ones((19, 2)), r"its shape is \(19, 2\), most others have 20 rows"),
        (np.ones((0, 2)), r"its shape is \(0, 2\), where"),
    ],
)
def test_arrays_that_are_no_columns_but_a_quantity_by_name(tmp_path, tau, reason):
    np.savez(tmp_path / "r.npz", t=T, q=Q, tau=tau)
    with pytest.raises(BadMapping, match=rf"r.npz: 'tau' is the quantity tau by its name, but not read: {reason}"):
        load_recording(tmp_path / "r.npz")
    np.savez(tmp_path / "r.npz", t=T, q=Q, load=tau)
    (text,) = [f.text for f in inspect_recording(tmp_path / "r.npz") if f.code == "left-out"]
    assert re.search(rf"r.npz: not read: load \({reason}", text)


@pytest.mark.parametrize(
    ("column", "reason"),
    [
        (pa.array([True, False, True]), "it holds truth values, no numbers"),
        (pa.array([{"x": 1.0}] * 3), "it holds no numbers"),
        (pa.array([b"1"] * 3), "it holds no numbers"),
        (pa.array([[1.0], [1.0, 2.0], [1.0]]), "lists of different lengths"),
        (pa.array([[1.0], None, [1.0]]), "lists of different lengths"),
        (pa.array([[[1.0]]] * 3), "it holds no numbers"),
        (pa.array([[True]] * 3), "it holds truth values, no numbers"),
    ],
)
def test_parquet_columns_that_are_none(tmp_path, column, reason):
    parquet.write_table(pa.table({"t": [0.0, 1, 2], "q_1": [0.0, 1, 2], "tau": column}), tmp_path / "r.parquet")
    with pytest.raises(BadMapping, match=rf"r.parquet: 'tau' is the quantity tau by its name, but not read: {reason}"):
        load_recording(tmp_path / "r.parquet")
    parquet.write_table(pa.table({"x": column}), tmp_path / "r.parquet")
    with pytest.raises(BadRecordingFile, match=r"r.parquet: no column of numbers; save time, q and tau"):
        load_recording(tmp_path / "r.parquet")


def test_parquet_text_and_lists(tmp_path):
    large = pa.array([[1.0, 2.0]] * 3, pa.large_list(pa.float64()))
    parquet.write_table(pa.table({"t": ["0", " +1 ", "2e0"], "q": large}), tmp_path / "r.parquet")
    recording = load_recording(tmp_path / "r.parquet")
    assert recording.t.tolist() == [0.0, 1.0, 2.0]
    assert recording.q.tolist() == [[1.0, 2.0]] * 3
    parquet.write_table(pa.table({"t": ["0", "one", "2"], "q_1": [0.0, 1, 2]}), tmp_path / "r.parquet")
    with pytest.raises(BadRecordingFile, match=r"'t', row 1: 'one' is not a finite number"):
        load_recording(tmp_path / "r.parquet")


def test_parquet_text_that_is_none(tmp_path):
    parquet.write_table(pa.table({"t": ["0", "wxyz"], "q_1": [0.0, 1]}), tmp_path / "r.parquet", compression="none")
    content = (tmp_path / "r.parquet").read_bytes()
    (tmp_path / "r.parquet").write_bytes(content.replace(b"wxyz", b"wx\xffz"))
    with pytest.raises(BadRecordingFile, match=r"r.parquet: not a readable Parquet file \(.*UTF8.*\); save it again"):
        load_recording(tmp_path / "r.parquet")


def test_parquet_columns_of_the_same_name(tmp_path):
    table = pa.table([pa.array([0.0, 1]), pa.array([0.0, 1]), pa.array([0.0, 1])], names=["t", "q_1", "q_1"])
    parquet.write_table(table, tmp_path / "r.parquet")
    with pytest.raises(BadRecordingFile, match=r"'q_1' \(column 2\) and 'q_1' \(column 3\) are both q of '1'; say"):
        load_recording(tmp_path / "r.parquet")


def test_words_are_no_truth_values(tmp_path):
    (tmp_path / "r.csv").write_text("t,q_1\n0,true\n1,false\n2,true\n")
    with pytest.raises(BadRecordingFile, match=r"'q_1', rows 0–2 \(lines 2–4\): 'true' and others are not finite"):
        load_recording(tmp_path / "r.csv")


def test_damaged_bytes_raise_nothing_else(tmp_path):
    """Every fortieth byte of small files of each kind changed in turn, and every prefix of such a length."""
    savemat(tmp_path / "z.mat", {"t": T, "q": Q}, do_compression=True)
    savemat(tmp_path / "5.mat", {"t": T, "q": Q, "n": 1})
    savemat(tmp_path / "4.mat", {"t": T, "q": Q}, format="4")
    np.savez(tmp_path / "u.npz", t=T, q=Q)
    parquet.write_table(pa.table({"t": T, "q_1": T}), tmp_path / "p.parquet", compression="none")
    (tmp_path / "g.csv.gz").write_bytes(gzip.compress(text().encode()))
    messages = []
    for path in sorted(tmp_path.iterdir()):
        whole = path.read_bytes()
        for place in range(0, len(whole), 40):
            for content in (whole[:place], whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :]):
                path.write_bytes(content)
                try:
                    load_recording(path)
                except InvalidInput as error:
                    messages.append(str(error))
    assert len(messages) > 100
    assert all(str(tmp_path) in message for message in messages)
    assert all(message.isprintable() for message in messages if "not a readable" in message)


def test_names_that_are_no_text(tmp_path):
    parquet.write_table(pa.table({"t": T, "q_1": T, "wxyz": T}), tmp_path / "r.parquet")
    content = (tmp_path / "r.parquet").read_bytes()
    (tmp_path / "r.parquet").write_bytes(content.replace(b"wxyz", b"wx\xffz"))
    with pytest.raises(BadRecordingFile, match=r"r.parquet: not a readable Parquet file \(.*\); save it again"):
        load_recording(tmp_path / "r.parquet")
    with pytest.raises(BadRecordingFile, match=r"r.parquet: .*; load_recording gives details, or repair the file"):
        list(StreamedRecording(tmp_path / "r.parquet"))


class TestFirstLine:
    def test_words_that_repeat_make_no_header(self, tmp_path):
        """Otherwise the first row would be taken for names, and be lost."""
        (tmp_path / "r.csv").write_text("ok,0.0,1.5\nok,0.1,1.6\nok,0.2,1.7\n")
        mapping = {"joints": ["a"], "time": {"column": 2}, "q": {"columns": [3]}}
        assert load_recording(tmp_path / "r.csv", mapping_of(mapping, "m")).q[:, 0].tolist() == [1.5, 1.6, 1.7]

    def test_a_header_with_decimals_is_told(self, tmp_path):
        (tmp_path / "r.csv").write_text("start,0.0,1.5\nok,0.1,1.6\nok,0.2,1.7\n")
        mapping = {"joints": ["a"], "time": {"column": 2}, "q": {"columns": [3]}}
        texts = [finding.text for finding in inspect_recording(tmp_path / "r.csv", mapping_of(mapping, "m"))]
        message = "the first line is taken for names, though it has decimals; if it is a row, write names above"
        assert f"{tmp_path / 'r.csv'}: {message} [header-of-numbers]" in texts


def test_control_characters_are_escaped(tmp_path):
    (tmp_path / "r.csv").write_text("t,q_1,q_\x1b[31m_1,\x9b2J\n0,1,2,3\n1,2,3,4\n")
    with pytest.raises(BadRecordingFile, match=r"candidates for q: q_1; q_\\x1b\[31m_1; say") as raised:
        load_recording(tmp_path / "r.csv")
    assert str(raised.value).removeprefix(str(tmp_path)).isprintable()
    mapping = {"joints": ["a"], "time": {"column": "t"}, "q": {"columns": ["\x9b"]}}
    with pytest.raises(BadMapping, match=r"has no column '\\x9b'; it has t, q_1, q_\\x1b\[31m_1, \\x9b2J"):
        load_recording(tmp_path / "r.csv", mapping_of(mapping, "m"))
    np.savez(tmp_path / "r.npz", **{"t": T, "q": Q, "\x1b[31m": np.ones(3)})
    assert all(finding.text.isprintable() for finding in inspect_recording(tmp_path / "r.npz"))


class TestStreamed:
    def test_text_with_a_byte_order_mark_and_other_columns(self, tmp_path):
        lines = "\r\n".join(["t,q_1,tau_1,state,flag", *(f"{k / 100},{k},{k},go,true" for k in range(50))])
        (tmp_path / "r.csv").write_bytes(b"\xef\xbb\xbf" + lines.encode() + b"\r\n")
        (piece,) = StreamedRecording(tmp_path / "r.csv")
        assert piece.q[:, 0].tolist() == list(range(4, 46))

    def test_spaces(self, tmp_path):
        (tmp_path / "r.csv").write_text(text().replace(",", "  "))
        with pytest.raises(BadRecordingFile, match=r"columns between spaces are not streamed; separate them by commas"):
            list(StreamedRecording(tmp_path / "r.csv"))
