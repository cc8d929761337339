"""Functions for CasADi and JAX: the numbers of the verbs, their derivatives, and what is refused."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from exported_code import LIBRARIES, code, library
from random_trees import NAMED, random_base_motion, random_state, random_wrenches
from robots.mechanisms import four_bar

import graphdyn
import graphdyn.export.casadi
import graphdyn.export.jax
from graphdyn import Coupling, InvalidInput, SingularMassMatrix
from graphdyn.export.functions import ExportChoices

ROUNDED = 1e-12
"""The same numbers in other sums, relative to the largest: measured 3e-15."""

MODEL = NAMED["mixed_chain"]


@pytest.fixture(params=LIBRARIES)
def solver(request):
    library(request.param)
    return request.param


def assert_same(found, expected):
    assert found.shape == np.shape(expected)
    assert np.abs(found - expected).max() <= ROUNDED * np.abs(expected).max()


class TestNumbers:
    def test_loads_on_a_moving_base(self, solver):
        """Arrays of one, two and three dimensions; wrenches, then the base, after the joint arrays."""
        q, v, a = random_state(MODEL, 1)
        wrenches, base = random_wrenches(MODEL, 2), random_base_motion(3)
        choices = ExportChoices(external_wrenches=True, moving_base=True)
        found = code(solver, MODEL, "inverse_dynamics", choices)(
            q, v, a, wrenches, base.rotation, base.velocity, base.acceleration
        )
        expected = graphdyn.inverse_dynamics(MODEL, q, v, a, wrenches, base=base)
        assert list(found) == ["tau", "body_accelerations", "multipliers", "joint_wrenches"]
        for name, array in found.items():
            assert_same(array, getattr(expected, name))

    def test_three_dimensions(self, solver):
        q, v, a = random_state(MODEL, 1)
        found = code(solver, MODEL, "body_regressor")(q, v, a)
        assert_same(found["body_regressor"], graphdyn.body_regressor(MODEL, q, v, a))

    def test_a_frame(self, solver):
        q, v, _ = random_state(MODEL, 4)
        name = MODEL.bodies[-1].name
        found = code(solver, MODEL, "frame_velocity", ExportChoices(frame=name, reference="local"))(q, v)
        assert_same(found["frame_velocity"], graphdyn.frame_velocity(MODEL, q, v, name, reference="local"))

    def test_couplings(self, solver):
        first, _, third, _ = (joint.name for joint in MODEL.joints)
        model = replace(MODEL, couplings=(Coupling(third, {first: -2.0}, offset=0.1),))
        q, v, tau = (x[:3] for x in random_state(model, 5))
        found = code(solver, model, "joint_accelerations")(q, v, tau)
        assert_same(found["a"], graphdyn.joint_accelerations(model, q, v, tau))

    def test_loops(self, solver):
        """What the loop leaves undetermined is NaN, as in the verb."""
        model = four_bar()
        q, v = model.random_state(np.random.default_rng(0))
        tau = np.array([3.0, 0, 0])
        found = code(solver, model, "forward_dynamics")(q, v, tau)
        expected = graphdyn.forward_dynamics(model, q, v, tau)
        assert np.isnan(found["multipliers"]).any()
        for name, array in found.items():
            np.testing.assert_array_equal(np.isnan(array), np.isnan(getattr(expected, name)))
            assert_same(np.nan_to_num(array), np.nan_to_num(getattr(expected, name)))


class TestDerivatives:
    def test_casadi(self):
        library("casadi")
        q, v, a = random_state(MODEL, 6)
        for name, derivatives in (
            ("joint_torques", graphdyn.inverse_dynamics_derivatives),
            ("joint_accelerations", graphdyn.forward_dynamics_derivatives),
        ):
            exported, expected = graphdyn.export.casadi.function(MODEL, name), derivatives(MODEL, q, v, a)
            found = exported.jacobian()(q, v, a, exported(q, v, a))
            for array, by in zip(found, vars(expected).values(), strict=True):
                assert_same(array.full(), by)

    @pytest.mark.parametrize(
        ("mode", "long"), [("jacfwd", False), ("jacrev", False), ("jacfwd", True), ("jacrev", True)]
    )
    def test_jax(self, mode, long, monkeypatch):
        """In parts, and in the equal steps of long programs."""
        jax = library("jax")
        if long:
            monkeypatch.setattr(graphdyn.export.jax, "LONG_PROGRAM", 0)
        q, v, a = random_state(MODEL, 6, (2,))
        for name, derivatives in (
            ("joint_torques", graphdyn.inverse_dynamics_derivatives),
            ("joint_accelerations", graphdyn.forward_dynamics_derivatives),
        ):
            exported, expected = graphdyn.export.jax.function(MODEL, name), derivatives(MODEL, q, v, a)
            found = jax.vmap(getattr(jax, mode)(exported, argnums=(0, 1, 2)))(q, v, a)
            for array, by in zip(found, vars(expected).values(), strict=True):
                assert_same(np.array(array), by)

    def test_second_by_jax(self):
        jax = library("jax")
        q, v, a = random_state(MODEL, 7)
        torques = graphdyn.export.jax.function(MODEL, "joint_torques")
        found = jax.jacfwd(jax.jacrev(torques))(q, v, a)
        assert_same(np.array(found), graphdyn.inverse_dynamics_second_derivatives(MODEL, q, v, a).d2tau_dqdq)


class TestShapes:
    def test_of_casadi(self):
        library("casadi")
        found = graphdyn.export.casadi.function(MODEL, "solve_kkt")
        assert found.name_in() == ["q", "v", "tau"]
        assert found.name_out() == ["body_accelerations", "multipliers"]
        assert found.size_in(0) == (4, 1)
        assert found.size_out(0) == (4, 6)
        assert graphdyn.export.casadi.function(MODEL, "kinetic_energy").size_out(0) == (1, 1)
        assert graphdyn.export.casadi.function(MODEL, "body_regressor").size_out(0) == (24, 10)

    def test_of_jax(self):
        """Leading dimensions broadcast; several answers are a named tuple, of the same class every time."""
        library("jax")
        q, v, _ = random_state(MODEL, 8, (2, 3))
        momentum = graphdyn.export.jax.function(MODEL, "momentum")
        found, expected = momentum(q, v[0, 0]), graphdyn.momentum(MODEL, q, v[0, 0])
        assert_same(np.array(found.about_origin), expected.about_origin)
        assert type(found) is type(momentum(q, v))
        assert graphdyn.export.jax.function(MODEL, "kinetic_energy")(q, v).shape == (2, 3)
        assert momentum.__name__ == "momentum"

    def test_refused_by_jax(self):
        library("jax")
        torques = graphdyn.export.jax.function(MODEL, "joint_torques")
        q, v, a = random_state(MODEL, 8, (2,))
        with pytest.raises(InvalidInput, match="2 arrays given; joint_torques takes q, v, a"):
            torques(q, v)
        with pytest.raises(InvalidInput, match=r"v has shape \(2, 3\), expected \(…, 4\) for robot 'tree4'"):
            torques(q, v[:, :3], a)
        with pytest.raises(InvalidInput, match=r"do not broadcast: q \(2, 4\), v \(3, 4\), a \(2, 4\)"):
            torques(q, np.zeros((3, 4)), a)


class TestPrecisionOfJax:
    def test_single(self):
        library("jax")
        q, v, a = random_state(MODEL, 9)
        found = graphdyn.export.jax.function(MODEL, "joint_torques", precision="single")(q, v, a)
        expected = graphdyn.joint_torques(MODEL, q, v, a)
        assert found.dtype == np.float32
        assert 0 < np.abs(found - expected).max() <= 1e-5 * np.abs(expected).max()

    def test_double_is_never_rounded_silently(self):
        """Neither when the function is made, nor when JAX is told later to round."""
        jax = library("jax")
        torques = graphdyn.export.jax.function(MODEL, "joint_torques")
        message = r"JAX rounds all numbers to single precision; say jax.config.update\('jax_enable_x64', True\)"
        jax.config.update("jax_enable_x64", False)
        try:
            with pytest.raises(InvalidInput, match=message):
                torques(*random_state(MODEL, 9))
            with pytest.raises(InvalidInput, match=message):
                graphdyn.export.jax.function(MODEL, "joint_torques")
            graphdyn.export.jax.function(MODEL, "joint_torques", precision="single")
        finally:
            jax.config.update("jax_enable_x64", True)


class TestRefusals:
    """The same for both, since both ask graphdyn.export.recorded."""

    def test_missing_packages(self, monkeypatch):
        for name in LIBRARIES:
            monkeypatch.setitem(sys.modules, name, None)
            exported = getattr(graphdyn.export, name)
            with pytest.raises(
                InvalidInput,
                match=rf"the package {name} is not installed; run: .* pip install 'graphdyn\[{name}\]'",
            ):
                exported.function(MODEL, "joint_torques")

    def test_singular_mass_matrix(self, solver):
        """At once, where the accelerations of every state would be NaN."""
        model = MODEL.with_inertial_parameters(np.zeros(40))
        with pytest.raises(SingularMassMatrix, match="the mass matrix of robot 'tree4' is singular"):
            code(solver, model, "joint_accelerations")

    def test_verbs_that_loops_refuse(self, solver):
        with pytest.raises(InvalidInput, match="power of robot 'four-bar', which has loops, has no compiled form"):
            code(solver, four_bar(), "power")
