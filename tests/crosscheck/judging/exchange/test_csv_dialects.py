"""CSV of other programs: quotes, byte order marks, row names, decimal commas."""

import pytest

from crosscheck.judging.exchange.answer_files import BadAnswers, read_answers

PLAIN = b"id,tau1,tau2\n12,0.5,-1.25e-3\n13,2,3\n"
WRITTEN = {
    "R, write.csv": b'"","id","tau1","tau2"\n"1",12,0.5,-0.00125\n"2",13,2,3\n',
    "R, write.table": b'"id" "tau1" "tau2"\n"1" 12 0.5 -0.00125\n"2" 13 2 3\n',
    "R, write.csv2": b'"";"id";"tau1";"tau2"\n"1";12;0,5;-0,00125\n"2";13;2;3\n',
    "pandas": b",id,tau1,tau2\n0,12,0.5,-0.00125\n1,13,2.0,3.0\n",
    "Excel, German": "id;tau1;tau2\r\n12;0,5;-1,25e-3\r\n13;2;3\r\n".encode("utf-8-sig"),
    "Excel, Unicode text": "id\ttau1\ttau2\r\n12\t0,5\t-1,25e-3\r\n13\t2\t3\r\n".encode("utf-16"),
    "quotes": b'"id","tau1","tau2"\n"12","0.5","-0.00125"\n"13","2","3"\n',
}


@pytest.mark.parametrize("content", WRITTEN.values(), ids=WRITTEN)
def test_is_read_like_plain_csv(tmp_path, content):
    found = {}
    for name, written in (("plain", PLAIN), ("other", content)):
        path = tmp_path / f"{name}.csv"
        path.write_bytes(written)
        found[name] = {number: answer.numbers.tolist() for number, answer in read_answers([path]).items()}
    assert found["other"] == found["plain"] == {12: [0.5, -1.25e-3], 13: [2.0, 3.0]}


@pytest.mark.parametrize("content", [b"1;0,5;0.7\n", b"1 0,5 0,7\n"], ids=["a point as well", "blanks"])
def test_ambiguous_commas_are_refused(tmp_path, content):
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    with pytest.raises(BadAnswers, match="line 1: '0,5' is one number or two; write decimal points"):
        read_answers([path])
