"""Parallel filtering: columns, torque and speed go through one filter, in whatever pieces the recording arrives."""

import dataclasses
import itertools
from dataclasses import dataclass

import numpy as np
import pytest
from identified import torque_data

from graphdyn import InvalidInput
from graphdyn.identification import Problem, TorqueModel
from graphdyn.identification.data.rows import Rows, counted
from graphdyn.identification.terms import Coulomb, KnownTorque, RigidBodies, UserColumns

ROUNDING = 1e-12
"""Of the equations, in N m; of sums of their squares, relative to the largest."""

MODEL = TorqueModel(
    torque_data.torque_model().model,
    (RigidBodies(), Coulomb(), UserColumns(lambda q, v, a: np.sign(np.sin(3 * q)), ["S"], ["N m"])),
    (KnownTorque(lambda q, v, a: 3.0 * np.sign(np.sin(5 * q))),),
)
"""Every kind of column that is no smooth function of the motion."""


@pytest.fixture(scope="module")
def samples():
    return torque_data.noisy_samples()


@dataclass(frozen=True)
class EveryThird:
    """(x_{t-1} + 2 x_t + x_{t+1}) / 4 at every third row; the ends repeat themselves."""

    factor: int = 3
    memory: int = 1

    def __call__(self, x):
        y = np.concatenate([x[:1], x, x[-1:]])
        return ((y[:-2] + 2 * y[1:-1] + y[2:]) / 4)[::3]


@dataclass(frozen=True)
class Mean:
    """Of fifteen rows, the ends repeated, at every third."""

    factor: int = 3
    memory: int = 7

    def __call__(self, x):
        padded = np.concatenate([np.repeat(x[:1], 7, axis=0), x, np.repeat(x[-1:], 7, axis=0)])
        return np.mean([padded[k : k + len(x)] for k in range(15)], axis=0)[::3]


class TestRowFilter:
    def rows(self, *pieces):
        parts = list(Problem(MODEL, pieces, n_blocks=4).rows())
        joined = {
            name: np.concatenate([getattr(part, name) for part in parts]) for name in ("matrix", "right", "velocity")
        }
        return joined, parts

    def filtered(self, samples, row_filter=EveryThird(), **changed):
        return dataclasses.replace(samples, row_filter=row_filter, **changed)

    def test_everything_is_filtered(self, samples):
        rows, parts = self.rows(self.filtered(samples))
        w = MODEL.rows(samples)[..., Problem(MODEL, samples).structure.base.independent]
        alone = EveryThird()
        assert rows["matrix"] == pytest.approx(alone(w), abs=ROUNDING)
        assert rows["right"] == pytest.approx(alone(samples.tau - MODEL.known_torque(samples)), abs=ROUNDING)
        assert rows["velocity"] == pytest.approx(alone(samples.v), abs=ROUNDING)
        assert [len(part) for part in parts] == [50] * 4

    @pytest.mark.parametrize("row_filter", [EveryThird(), Mean()], ids=["short", "long"])
    @pytest.mark.parametrize("borders", [(300,), (1, 2, 100, 350, 599), tuple(range(7, 600, 7))])
    def test_pieces_and_windows_that_continue_each_other(self, samples, borders, row_filter, monkeypatch):
        whole, _ = self.rows(self.filtered(samples, row_filter))
        monkeypatch.setattr("graphdyn.identification.data.rows.MIN_FILTERED_ROWS", 20)
        edges = [0, *borders, len(samples)]
        pieces = [self.filtered(samples[a:b], row_filter, continues=a > 0) for a, b in itertools.pairwise(edges)]
        cut, parts = self.rows(*pieces)
        for name, values in whole.items():
            assert cut[name] == pytest.approx(values, abs=ROUNDING), name
        assert [part.first for part in parts] == [True] + [False] * (len(parts) - 1)

    @pytest.mark.parametrize("remembered", [True, False])
    def test_a_part_is_filtered_with_all(self, remembered, samples):
        whole = Problem(MODEL, [self.filtered(samples[:299]), self.filtered(samples[299:])], n_blocks=4)
        everything = list(whole.rows())
        used = np.isin(np.arange(201), [*range(20, 70), *range(120, 190)])
        part = (whole if remembered else Problem(MODEL, whole.data, n_blocks=4)).part(used)
        for name in ("matrix", "right", "velocity"):
            expected = np.concatenate([getattr(rows, name) for rows in everything])[used]
            assert np.array_equal(np.concatenate([getattr(rows, name) for rows in part.rows()]), expected)
        rows = list(part.rows())
        starts = np.cumsum([0, *map(len, rows)])[[k for k, here in enumerate(rows) if here.first]]
        assert starts.tolist() == [0, 50]
        assert [sum(len(here) for here in rows if here.block == k) for k in range(4)] == [30] * 4
        assert part.equations.counts.tolist() == [120] * 6
        with pytest.raises(InvalidInput, match="used is given for 7 rows; the filter leaves 201"):
            list(whole.part(np.ones(7, bool)).rows())

    def test_nothing_is_filtered_across_a_gap(self, samples):
        here, there = self.filtered(samples[:299]), self.filtered(samples[299:])
        both, parts = self.rows(here, there)
        for name, values in both.items():
            alone = np.concatenate([self.rows(piece)[0][name] for piece in (here, there)])
            assert values == pytest.approx(alone, abs=ROUNDING), name
        assert sum(part.first for part in parts) == 2

    def test_gram(self, samples):
        pieces = [self.filtered(samples[:300]), samples[300:]]
        gram, qr = (Problem(MODEL, pieces, compression=how) for how in ("gram", "qr"))
        a, b = (np.swapaxes(f, 1, 2) @ f for f in (gram.equations.factors, qr.equations.factors))
        assert np.abs(a - b).max() <= ROUNDING * np.abs(a).max()
        assert np.array_equal(gram.equations.counts, qr.equations.counts)
        assert list(qr.equations.counts) == [400] * 6

    def test_a_filter_that_answers_too_few_rows(self, samples):
        short = EveryThird(factor=2)
        with pytest.raises(InvalidInput, match=r"the row filter answers shape \(200, .*expected \(300, "):
            self.rows(dataclasses.replace(samples, row_filter=short))

    def test_a_piece_that_continues_with_another_filter(self, samples):
        pieces = [self.filtered(samples[:300]), dataclasses.replace(samples[300:], continues=True)]
        with pytest.raises(InvalidInput, match="a piece that continues another has another row filter; give both the"):
            self.rows(*pieces)


@pytest.mark.parametrize("size", [1, 2, 3, 12])
def test_a_run_starts_after_each_gap_however_the_rows_arrive(size):
    used = np.array([1, 1, 0, 0, 1, 1, 1, 0, 1, 1, 1, 1], dtype=bool)
    numbers = np.arange(12.0)
    parts = [
        Rows(numbers[k, None, None], *(numbers[k, None] for _ in range(3)), np.ones((len(k), 1), bool), first=k[0] == 0)
        for k in np.split(np.arange(12), range(size, 12, size))
    ]
    found = list(counted(parts, used))
    assert np.concatenate([rows.right[:, 0] for rows in found]).tolist() == np.flatnonzero(used).tolist()
    assert [rows.right[0, 0] for rows in found if rows.first] == [0.0, 4.0, 8.0]
    with pytest.raises(InvalidInput, match="used is given for 13 rows; the filter leaves 12"):
        list(counted(parts, np.ones(13, dtype=bool)))
