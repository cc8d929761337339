"""Problems: how the data arrive, what counts, time blocks, what the recording determines."""

from dataclasses import replace

import numpy as np
import pytest
from identified import torque_data
from threadpoolctl import threadpool_info, threadpool_limits

import graphdyn
from graphdyn import BaseMotion, InvalidInput
from graphdyn.identification import Problem, Samples, TorqueModel, WeightedLeastSquares
from graphdyn.identification.algebra.compressed import merged
from graphdyn.identification.problem.problem import together
from graphdyn.identification.terms import KnownBodies, Offset, RigidBodies

ROUNDING = 1e-13
"""Sums of some hundred squares, relative to the largest."""


def products(equations):
    return np.swapaxes(equations.factors, 1, 2) @ equations.factors


def same(here, there):
    a, b = products(here), products(there)
    return np.abs(a - b).max() <= ROUNDING * np.abs(a).max() and np.array_equal(here.counts, there.counts)


def same_problem(here, there):
    return same(here.equations, there.equations)


@pytest.fixture(scope="module")
def samples():
    return torque_data.noisy_samples()


@pytest.fixture(scope="module")
def whole(samples):
    return Problem(torque_data.torque_model(), samples)


class EverySecond:
    """The simplest filter of rows."""

    factor, memory = 2, 0

    def __call__(self, columns):
        return columns[::2]


class Reopened:
    """A recording in a file: iterated over again and again."""

    def __init__(self, samples, length):
        self.samples, self.length, self.opened = samples, length, 0

    def __iter__(self):
        self.opened += 1
        return self.samples.pieces(self.length)


class TestData:
    def test_factors_are_those_of_the_dense_regressor(self, whole, samples):
        w = torque_data.torque_model().rows(samples)[..., whole.base.independent]
        dense = np.concatenate([w, samples.tau[..., None]], axis=-1)
        expected = np.einsum("tgi,tgj->gij", dense, dense)
        assert np.abs(products(whole.equations) - expected).max() <= ROUNDING * expected.max()
        assert list(whole.equations.counts) == [600] * 6

    @pytest.mark.parametrize("length", [7, 77, 600])
    def test_pieces(self, length, whole, samples):
        """However the recording is cut, the factors and the time blocks are the same up to rounding."""
        for data in (list(samples.pieces(length)), Reopened(samples, length)):
            cut = Problem(torque_data.torque_model(), data)
            assert same(cut.equations, whole.equations)
            assert all(same(a, b) for a, b in zip(cut.blocks, whole.blocks, strict=True))

    def test_memory_map(self, whole, samples, tmp_path):
        maps = []
        for name in ("q", "v", "a", "tau"):
            np.save(tmp_path / f"{name}.npy", getattr(samples, name))
            maps.append(np.load(tmp_path / f"{name}.npy", mmap_mode="r"))
        mapped = Samples(*maps)
        assert isinstance(mapped.q, np.memmap)
        assert same(Problem(torque_data.torque_model(), mapped).equations, whole.equations)

    def test_read_once(self, whole, samples):
        """A generator serves methods that need the factors alone; statistics read it again and say why they cannot."""
        once = Problem(torque_data.torque_model(), samples.pieces(100), block_samples=60)
        assert same(once.equations, whole.equations)
        estimate = WeightedLeastSquares().estimate(once)
        assert estimate.parameters.shape == (87,)

    def test_read_once_and_long(self, samples):
        once = Problem(torque_data.torque_model(), samples.pieces(100), block_samples=60, cached_bytes=0)
        _ = once.equations
        with pytest.raises(InvalidInput, match="can be read only once and was: give the samples in a list"):
            list(once.rows())

    def test_few_equations_are_remembered(self, samples):
        data = Reopened(samples, 100)
        problem = Problem(torque_data.torque_model(), data, block_samples=60)
        _ = problem.equations
        first = data.opened
        assert [len(rows.right) for rows in problem.rows()]
        assert data.opened == first

    @pytest.mark.parametrize("backend", ["llvm", "numpy"])
    @pytest.mark.parametrize("speed", [0.0, 0.2])
    def test_gram(self, samples, backend, speed, monkeypatch):
        """Sums of products of equations that never existed, in pieces that fit neither vectors nor time blocks."""
        monkeypatch.setenv("GRAPHDYN_BACKEND", backend)
        monkeypatch.setattr("graphdyn.identification.problem.problem.SUMMED_SAMPLES", 37)
        expected = Problem(torque_data.torque_model(), samples, min_speed=speed)
        gram = Problem(torque_data.torque_model(), samples, compression="gram", min_speed=speed)
        assert same_problem(gram, expected)

    @pytest.mark.parametrize("speed", [0.0, 0.2])
    def test_gram_of_filtered_equations(self, samples, speed):
        """Which are summed up as they are, without those of slow rows."""
        halved = replace(samples, row_filter=EverySecond())
        model = torque_data.torque_model()
        found, expected = (Problem(model, halved, compression=method, min_speed=speed) for method in ("gram", "qr"))
        assert same_problem(found, expected)
        assert found.equations.counts.tolist() == (np.abs(samples.v[::2]) >= speed).sum(axis=0).tolist()

    def test_gram_of_other_regressors(self, samples):
        """A term that is not the regressor of graphdyn, and a base that moves, which the kernel does not know."""

        class Doubled(RigidBodies):
            def rows(self, model, samples):
                return 2 * super().rows(model, samples)

        doubled = TorqueModel(torque_data.torque_model().model, (Doubled(), Offset()))
        assert same_problem(Problem(doubled, samples, compression="gram"), Problem(doubled, samples))
        rail = BaseMotion(acceleration=np.linspace(0, 1, 6 * len(samples)).reshape(-1, 6))
        moved = Samples(samples.q, samples.v, samples.a, samples.tau, rail)
        model = torque_data.torque_model()
        assert same_problem(Problem(model, moved, compression="gram"), Problem(model, moved))

    def test_gram_of_many_turns(self, samples):
        turned = Samples(samples.q + 2 * np.pi * 1e7, samples.v, samples.a, samples.tau)
        model = torque_data.torque_model()
        assert same_problem(Problem(model, turned, compression="gram"), Problem(model, turned))

    def test_gram_refuses_nan(self, samples):
        q = samples.q.copy()
        q[17, 2] = np.nan
        spoiled = Samples(q, samples.v, samples.a, samples.tau)
        with pytest.raises(InvalidInput, match="q contains nan at row 17"):
            _ = Problem(torque_data.torque_model(), spoiled, compression="gram").equations

    def test_progress(self, samples):
        seen = []
        _ = Problem(torque_data.torque_model(), samples, progress=seen.append).equations
        assert sum(seen) == 600


class TestWhatCounts:
    def test_min_speed(self, samples):
        speed = np.array([0.1, 0.2, 0.0, 0.3, 0.1, 0.2])
        problem = Problem(torque_data.torque_model(), samples, min_speed=speed)
        assert list(problem.equations.counts) == list(np.sum(np.abs(samples.v) >= speed, axis=0))

    def test_known_torque(self, samples):
        model = torque_data.torque_model()
        problem = Problem(TorqueModel(model.model, (Offset(),), (KnownBodies(),)), samples)
        rows = next(problem.rows())
        rigid = graphdyn.inverse_dynamics(model.model, samples.q, samples.v, samples.a).tau
        assert rows.right == pytest.approx((samples.tau - rigid)[: len(rows.right)], abs=1e-9)
        assert np.array_equal(rows.measured, samples.tau[: len(rows.right)])


class TestThreads:
    def test_small_matrices_get_one_thread(self, samples):
        """Several are slower, on a busy machine by far."""
        seen = []

        def threads():
            return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]

        with threadpool_limits(limits=2, user_api="blas"):
            before = threads()
            problem = Problem(torque_data.torque_model(), samples, progress=lambda _: seen.extend(threads()))
            assert problem.equations.counts.all()
            assert threads() == before
        assert set(seen) == {1}


class TestBlocks:
    def test_all_but_one(self, whole):
        """Twenty time blocks are ten folds."""
        assert (len(whole.blocks), len(whole.folds)) == (20, 10)
        for k in (0, 9):
            left = sum(products(part) for j, part in enumerate(whole.blocks) if j // 2 != k)
            others = merged(whole.folds[:k] + whole.folds[k + 1 :])
            assert np.abs(products(others) - left).max() <= ROUNDING * np.abs(left).max()
            assert list(others.counts) == [540] * 6

    @pytest.mark.parametrize(("blocks", "folds"), [(9, 9), (10, 10), (11, 6), (25, 9), (31, 8)])
    def test_at_most_ten_folds(self, blocks, folds, whole):
        """Neighbors in equal numbers, but for the last."""
        found = together([whole.blocks[0]] * blocks)
        each = -(-blocks // folds)
        sizes = [int(fold.counts[0]) // int(whole.blocks[0].counts[0]) for fold in found]
        assert sizes == [each] * (folds - 1) + [blocks - each * (folds - 1)]

    def test_blocks_are_blocks_of_time(self, samples):
        problem = Problem(torque_data.torque_model(), samples, block_samples=250)
        assert [part.counts[0] for part in problem.blocks] == [250, 250, 100]
        rows = list(problem.rows())
        assert [sum(len(part.right) for part in rows if part.block == k) for k in range(3)] == [250, 250, 100]
        assert [part.first for part in rows] == [True] + [False] * (len(rows) - 1)

    def test_standard_equations(self, whole, samples):
        """‖R x - z‖² = Σ ‖W x - τ‖² / noise² for any x."""
        x = np.random.default_rng(0).normal(size=87)
        r, z = whole.standard_equations(torque_data.NOISE)
        error = (torque_data.torque_model().torque(samples, x) - samples.tau) / torque_data.NOISE
        assert np.sum((r @ x - z) ** 2) == pytest.approx(np.sum(error**2), rel=1e-10)
        assert r.shape == (62, 87)


class TestDetermined:
    def test_whole_structure(self, whole):
        assert whole.base.rank == whole.structure.base.rank == torque_data.RANK
        assert whole.condition_number < 200

    def test_joints_that_do_not_move(self, samples):
        """Joint 6 still: what only its motion shows is not determined, and the rest is as before."""
        still = Samples(*(np.where(np.arange(6) == 5, 0.0, x) for x in (samples.q, samples.v, samples.a)), samples.tau)
        problem = Problem(torque_data.torque_model(), still)
        assert problem.base.rank < torque_data.RANK
        symbols = [column.symbol for column in torque_data.torque_model().columns]
        assert "FV_6" not in "; ".join(problem.base.names(symbols))
        pi = np.random.default_rng(0).normal(size=87)
        w = torque_data.torque_model().rows(still)
        assert w @ pi == pytest.approx(w[..., problem.base.independent] @ problem.base.values(pi), abs=1e-9)

    @pytest.mark.parametrize(("on_the_rail", "rank"), [(True, 30), (False, 28)])
    def test_five_instants_of_the_paper(self, on_the_rail, rank):
        """At |R_kk| > 1e-9 |R_11|; the gap is from 7e-6 to 1e-16."""
        motion = graphdyn.kr500_experiment([0.3, 0.6, 0.9, 1.2, 1.5])
        rail = None
        if on_the_rail:
            along, zero = np.array([1.0, 0, 0]), np.zeros((5, 3))
            velocity = np.hstack([2.0 * motion.time[:, None] * along, zero])
            acceleration = np.hstack([np.tile(2.0 * along, (5, 1)), zero])
            rail = BaseMotion(np.eye(3), motion.time[:, None] ** 2 * along, velocity, acceleration)
        samples = Samples(motion.q, motion.v, motion.a, motion.tau, rail)
        problem = Problem(TorqueModel(graphdyn.kr500(), (RigidBodies(),)), samples, n_blocks=2)
        assert problem.base.rank == rank
        assert problem.structure.base.rank == 36
        assert problem.base.gap[0] > 1e-6
        assert problem.base.gap[1] < 1e-14


class TestRefusals:
    MODEL = torque_data.torque_model()

    def test_shapes(self):
        with pytest.raises(InvalidInput, match=r"differ in shape: q \(5, 6\), v \(5, 6\), a \(4, 6\)"):
            Samples(np.ones((5, 6)), np.ones((5, 6)), np.ones((4, 6)), np.ones((5, 6)))
        with pytest.raises(InvalidInput, match=r"q .* must be real numbers of shape \(N, n\); it is float64 \(6,\)"):
            Samples(np.ones(6), np.ones(6), np.ones(6), np.ones(6))
        with pytest.raises(InvalidInput, match=r"the base motion has \(3,\) states for 5 samples"):
            Samples(*[np.ones((5, 6))] * 4, BaseMotion(translation=np.zeros((3, 3))))

    def test_joints(self):
        problem = Problem(self.MODEL, Samples(*[np.ones((5, 3))] * 4))
        with pytest.raises(InvalidInput, match="the samples have 3 joints, robot 'arm' has 6: O1, O2"):
            _ = problem.equations

    def test_foreign_pieces(self):
        with pytest.raises(InvalidInput, match=r"the data hold a ndarray; every piece must be Samples\(q, v, a, tau\)"):
            _ = Problem(self.MODEL, [np.ones((5, 6))]).equations

    @pytest.mark.parametrize("data", [[], [Samples(*[np.ones((0, 6))] * 4)]], ids=["no piece", "empty piece"])
    def test_nothing(self, data):
        with pytest.raises(InvalidInput, match="the recording has no sample"):
            _ = Problem(self.MODEL, data).equations

    def test_not_finite(self, samples):
        tau = samples.tau.copy()
        tau[3, 2] = np.nan
        with pytest.raises(InvalidInput, match="group 2: NaN or infinity in row 3 of the block"):
            _ = Problem(self.MODEL, Samples(samples.q, samples.v, samples.a, tau)).equations

    def test_options(self, samples):
        with pytest.raises(InvalidInput, match="min_speed is -1"):
            Problem(self.MODEL, samples, min_speed=-1.0)
        with pytest.raises(InvalidInput, match="n_blocks is 0, block_samples None; both must be at least 1"):
            Problem(self.MODEL, samples, n_blocks=0)
        with pytest.raises(InvalidInput, match="data that can be read only once need block_samples"):
            Problem(self.MODEL, samples.pieces(10))
