"""The forms in which graphdyn and others do a work of the benchmark: right answers, and errors that are seen."""

import os
import shutil

import numpy as np
import pytest
from small_benchmark import DERIVED, PEERS, SAMPLES

import graphdyn
from crosscheck.bench.calls import CallWork, contenders
from crosscheck.bench.curves import chain
from crosscheck.bench.forms import graphdyn_forms, peers, simulations, single_precision
from crosscheck.bench.states import SINGLE_STATE_SAMPLES, random_states
from crosscheck.bench.works import GRAPHDYN_FORMS, PINOCCHIO_FORMS, WORK_DESCRIPTIONS
from crosscheck.reference.mujoco_model import MujocoModel
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import kr500

needs_a_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler (cc)")


@pytest.fixture(scope="module")
def states():
    return random_states(kr500(), SAMPLES, 1)


class InPlaceOfMujoco:
    """The calls of crosscheck.reference.mujoco_model, answered without the library."""

    def __init__(self, model):
        self._model = model

    def inverse_loop(self, q, v, a, out):
        out[:] = graphdyn.joint_torques(self._model, q, v, a)
        return out

    def rollout(self, q, v, tau, threads):
        return lambda count: graphdyn.joint_accelerations(self._model, q[:count], v[:count], tau[:count])


class TestErrors:
    """Of the answers of the verbs against Pinocchio's functions."""

    @pytest.mark.parametrize(("work", "name"), [(work, name) for work, names in DERIVED.items() for name in names])
    def test_one_wrong_number_is_seen(self, states, work, name):
        """In any of the arrays, and in its sample only."""
        (form, *_) = GRAPHDYN_FORMS[work](states, (1,))
        answers = form.run(SAMPLES).copy()
        right = form.errors(answers)
        assert right.shape == (SAMPLES,)
        assert right.max() <= WORK_DESCRIPTIONS[work][2]
        answer = answers[DERIVED[work].index(name)]
        answer[(7, *(0,) * (answer.ndim - 1))] += 1e-9 * np.abs(answer).max()
        wrong = form.errors(answers) > WORK_DESCRIPTIONS[work][2]
        assert np.flatnonzero(wrong).tolist() == [7]

    @pytest.mark.parametrize(
        "work",
        [
            "inverse_dynamics",
            "forward_dynamics",
            "solve_kkt",
            "joint_torque_regressor",
            "inverse_dynamics_single",
            "simulation",
        ],
    )
    def test_one_wrong_number_of_any_form_is_seen(self, states, work):
        """Of ours and others', in the last column of its sample only; products of columns in the entry of theirs."""
        bound = WORK_DESCRIPTIONS[work][2]
        if work == simulations.SIMULATION_NAME:
            forms = simulations.contenders(states, None)
        elif work in single_precision.SINGLE_PRECISION_WORKS:
            forms = single_precision.contenders(states, False, (1,))
        else:
            forms = [*GRAPHDYN_FORMS[work](states, (1,)), *PINOCCHIO_FORMS[work](states, (1,))]
        for form in forms:
            if form.errors is None or "streamed" in form.name:
                continue
            answers = np.array(form.run(SAMPLES))
            assert form.errors(answers).max() <= bound, form.name
            row = min(7, len(answers) - 1)
            size = np.abs(answers[row]).max()
            answers[(row, *(-1,) * (answers.ndim - 1))] += max(1e-7, 100 * bound) * size
            assert np.flatnonzero(form.errors(answers) > bound).tolist() == [row], form.name

    def test_one_wrong_product_is_seen(self, states, monkeypatch):
        """Of the streamed regressor, in any of its matrices."""
        form = next(one for one in GRAPHDYN_FORMS["joint_torque_regressor"](states, (1,)) if "streamed" in one.name)
        assert form.errors(None).max() < PEERS
        products = graphdyn_forms.torque_gram

        def spoilt(model, columns):
            gram = products(model, columns)

            def wrong(*arguments, **options):
                matrices, rest = gram(*arguments, **options)
                matrices[3][-1, -1] += 1e-6 * max(matrix[-1, -1] for matrix in matrices)
                return matrices, rest

            wrong.columns = gram.columns
            return wrong

        monkeypatch.setattr(graphdyn_forms, "torque_gram", spoilt)
        form = next(one for one in GRAPHDYN_FORMS["joint_torque_regressor"](states, (1,)) if "streamed" in one.name)
        assert np.flatnonzero(form.errors(None) > 1e-8).tolist() == [3]

    def test_fewer_samples_than_are_judged(self, states):
        (form, *_) = GRAPHDYN_FORMS["coriolis_matrix"](states, (1,))
        assert len(form.errors(form.run(8))) == 8

    def test_many_samples(self):
        """The first ones are judged."""
        states = random_states(kr500(), SINGLE_STATE_SAMPLES + 1, 1)
        (form, *_) = GRAPHDYN_FORMS["kinetic_energy"](states, (1,))
        assert len(form.errors(form.run(SINGLE_STATE_SAMPLES + 1))) == SINGLE_STATE_SAMPLES


class TestForms:
    def test_cold_calls_take_all_memory_in_turn(self, states):
        """Hot ones the same rows, and both are judged at the first."""
        third = len(states) // 3
        for elsewhere in (False, True):
            ours, theirs = contenders(states, CallWork(False, third, elsewhere))
            for call in (ours, theirs):
                answers = [np.array(call.run(third)) for _ in range(4)]
                rows = [slice(k * third * elsewhere, (k * elsewhere + 1) * third) for k in (0, 1, 2, 0)]
                for answer, part in zip(answers, rows, strict=True):
                    assert np.abs(answer - states.torque[part]).max() < 1e-9 * np.abs(states.torque).max()
                assert call.errors(answers[1]).max() < PEERS

    def test_forms_without_a_compiler(self, states, monkeypatch):
        monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")
        forms = graphdyn_forms.dynamics(False, states, (1, 2))
        assert [form.name for form in forms if form.ours] == ["graphdyn NumPy"]

    @pytest.mark.parametrize("before", [None, "numpy"])
    def test_backend_is_put_back(self, before, monkeypatch):
        monkeypatch.delenv("GRAPHDYN_BACKEND", raising=False)
        if before:
            monkeypatch.setenv("GRAPHDYN_BACKEND", before)
        with graphdyn_forms.backend("numpy"):
            assert os.environ["GRAPHDYN_BACKEND"] == "numpy"
        assert os.environ.get("GRAPHDYN_BACKEND") == before

    def test_chain(self):
        model = chain(5)
        q, v = model.random_state(np.random.default_rng(0), 3)
        tau = PinocchioModel.from_model(model).rnea(q, v, v)
        assert np.allclose(graphdyn.joint_torques(model, q, v, v), tau, rtol=PEERS, atol=PEERS)

    @pytest.mark.parametrize("count", [SAMPLES, 7])
    @pytest.mark.parametrize("library", ["mujoco", "none"])
    def test_what_mujoco_is_given(self, states, library, count):
        """(q, v, a) or (q, v, τ) of the first samples: it agrees, and graphdyn in its place does."""
        if library == "mujoco":
            pytest.importorskip("mujoco")
        native = MujocoModel(states.model) if library == "mujoco" else InPlaceOfMujoco(states.model)
        forms = [*peers.mujoco_inverse(states, native), *peers.mujoco_forward(states, native, (1, 2))]
        assert [(form.name, form.threads) for form in forms] == [
            (peers.MUJOCO_LOOP, 1), (peers.MUJOCO_ROLLOUT, 1), (peers.MUJOCO_ROLLOUT, 2)
        ]  # fmt: skip
        for form in forms:
            errors = form.errors(form.run(count))
            assert errors.shape == (count,)
            assert errors.max() < PEERS

    @needs_a_compiler
    def test_casadi_function(self, states):
        pytest.importorskip("casadi")
        function = peers.casadi_function(states.model, "joint_torques")
        tau = np.array(function(states.q[0], states.v[0], states.a[0])).ravel()
        assert states.torque_errors(tau[None]).max() < PEERS
