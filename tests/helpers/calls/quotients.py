"""Derivatives by difference quotients."""

import numpy as np
from calls.planted import PLANTED, Planted, frame_of
from scipy.spatial.transform import Rotation

import graphdyn

KIND = "quotients"


def derivative(f, scheme, h, relative=False):
    """x → ∂f/∂x with the direction last."""

    def of(x):
        columns = []
        for e in np.eye(len(x)):
            step = h * (max(1.0, abs(x @ e)) if relative else 1.0)
            if scheme == "central":
                columns.append((f(x + step * e) - f(x - step * e)) / (2 * step))
            elif scheme == "forward":
                columns.append((f(x + step * e) - f(x)) / step)
            else:
                columns.append((f(x) - f(x - step * e)) / step)
        return np.stack(columns, axis=-1)

    return of


def placed(model, q, frame):
    """[R, p] (3, 4) of a frame."""
    R, p = graphdyn.frame_placement(model, q, frame)
    return np.column_stack([R, p])


def _add(name, judged_as, build, truth, aside=False, **options):
    PLANTED.append(Planted(f"{KIND}: {judged_as}, {name}", judged_as, build, truth, aside, options))


def _step(h):
    """The step in words, to two digits or to a factor of ten where rounding hides it."""
    return rf"differences.*step of (about )?({h:.1e}|{h:g}|{h:.2g}|{h:.3g})\b"


ROUNDED = r"differences.*(round|scatter)|scatter.*differences"

for scheme, h, aside in (
    ("forward", 1e-4, False),
    ("central", 1e-3, False),
    ("backward", 1e-6, True),
    ("central", 2e-4, True),
    ("forward", 0.01, True),
):
    truth = f"{scheme} {_step(h)}"
    where = f"{scheme} {h:g}"
    for wrt in "qv":
        if wrt == "v" and scheme == "central":
            continue  # τ is quadratic in v
        _add(
            where,
            f"dtau_d{wrt}",
            lambda model, s=scheme, h=h, wrt=wrt: (
                lambda q, v, a: derivative(
                    lambda x: graphdyn.inverse_dynamics(model, *((x, v) if wrt == "q" else (q, x)), a).tau, s, h
                )(q if wrt == "q" else v)
            ),
            truth,
            aside,
        )
        _add(
            where,
            f"da_d{wrt}",
            lambda model, s=scheme, h=h, wrt=wrt: (
                lambda q, v, tau: derivative(
                    lambda x: graphdyn.forward_dynamics(model, *((x, v) if wrt == "q" else (q, x)), tau).a, s, h
                )(q if wrt == "q" else v)
            ),
            truth,
            aside,
        )

    def _coriolis(model, s=scheme, h=h):
        def coriolis_matrix(q, v):
            d = derivative(lambda x: graphdyn.mass_matrix(model, x), s, h)(q)
            return 0.5 * (d @ v + np.einsum("ikj,k->ij", d, v) - np.einsum("jki,k->ij", d, v))

        return coriolis_matrix

    _add(where, "coriolis_matrix", _coriolis, truth, aside)
    _add(
        where,
        "center_of_mass_jacobian",
        lambda model, s=scheme, h=h: derivative(lambda x: graphdyn.center_of_mass(model, x), s, h),
        truth,
        aside,
    )
    _add(
        where,
        "gravity_torque",
        lambda model, s=scheme, h=h: derivative(lambda x: graphdyn.potential_energy(model, x), s, h),
        truth,
        aside,
    )

    def _jacobian(model, s=scheme, h=h):
        frame = frame_of(model)

        def frame_jacobian(q):
            R = placed(model, q, frame)[:3, :3]
            d = derivative(lambda x: placed(model, x, frame), s, h)(q)
            turning = np.einsum("ikj,lk->ilj", d[:3, :3], R)
            omega = np.stack([turning[2, 1], turning[0, 2], turning[1, 0]])
            return np.concatenate([d[:3, 3], omega])

        return frame_jacobian

    _add(where, "frame_jacobian", _jacobian, truth, aside)

    def _jacobian_derivative(model, s=scheme, h=h):
        frame = frame_of(model)

        def frame_jacobian_derivative(q, v):
            return derivative(lambda t: graphdyn.frame_jacobian(model, q + t[0] * v, frame, reference="local"), s, h)(
                np.zeros(1)
            )[..., 0]

        return frame_jacobian_derivative

    _add(where, "frame_jacobian_derivative", _jacobian_derivative, truth, aside)
    _add(
        where,
        "dwrenches_dq",
        lambda model, s=scheme, h=h: (
            lambda q, v, a: derivative(lambda x: graphdyn.inverse_dynamics(model, x, v, a).joint_wrenches, s, h)(q)
        ),
        truth,
        aside,
    )
    _add(
        where,
        "center_of_mass_velocity",
        lambda model, s=scheme, h=h: (
            lambda q, v: derivative(lambda t: graphdyn.center_of_mass(model, q + t[0] * v), s, h)(np.zeros(1))[..., 0]
        ),
        truth,
        aside,
    )

    def _lagrange(model, s=scheme, h=h):
        def inverse_dynamics(q, v, a):
            M = graphdyn.mass_matrix(model, q)
            d = derivative(lambda x: graphdyn.mass_matrix(model, x), s, h)(q)
            c = np.einsum("ijk,j,k->i", d, v, v) - 0.5 * np.einsum("jki,j,k->i", d, v, v)
            return M @ a + c + graphdyn.gravity_torque(model, q)

        return inverse_dynamics

    _add(where, "inverse_dynamics", _lagrange, truth, aside)

    def _lagrange_potential(model, s=scheme, h=h):
        def bias_torque(q, v):
            d = derivative(lambda x: graphdyn.mass_matrix(model, x), s, h)(q)
            c = np.einsum("ijk,j,k->i", d, v, v) - 0.5 * np.einsum("jki,j,k->i", d, v, v)
            return c + derivative(lambda x: graphdyn.potential_energy(model, x), s, h)(q)

        return bias_torque

    _add(where, "bias_torque", _lagrange_potential, truth, aside)

for scheme, h, aside in (("forward", 1e-8, False), ("central", 1e-9, False), ("forward", 1e-10, True)):
    where = f"{scheme} {h:g}"
    _add(
        where, "dtau_dq",
        lambda model, s=scheme, h=h: lambda q, v, a: derivative(
            lambda x: graphdyn.inverse_dynamics(model, x, v, a).tau, s, h)(q),
        ROUNDED, aside,
    )  # fmt: skip
    _add(
        where, "da_dq",
        lambda model, s=scheme, h=h: lambda q, v, tau: derivative(
            lambda x: graphdyn.forward_dynamics(model, x, v, tau).a, s, h)(q),
        ROUNDED, aside,
    )  # fmt: skip
    _add(
        where, "gravity_torque",
        lambda model, s=scheme, h=h: derivative(lambda x: graphdyn.potential_energy(model, x), s, h),
        ROUNDED, aside,
    )  # fmt: skip
    _add(
        where, "center_of_mass_jacobian",
        lambda model, s=scheme, h=h: derivative(lambda x: graphdyn.center_of_mass(model, x), s, h),
        ROUNDED, aside,
    )  # fmt: skip


def _scipy_steps(model):
    """Steps of 1e-4 times the size of the argument, at least one."""
    return lambda q, v, a: derivative(
        lambda x: graphdyn.inverse_dynamics(model, x, v, a).tau, "forward", 1e-4, relative=True
    )(q)


_add("forward 1e-4, relative", "dtau_dq", _scipy_steps, rf"forward {_step(1e-4)}", True)


def _parameters(model):
    def forward_dynamics_parameter_derivatives(q, v, tau):
        return derivative(
            lambda p: graphdyn.forward_dynamics(model.with_inertial_parameters(p), q, v, tau).a, "forward", 1e-4
        )(model.inertial_parameters)

    return forward_dynamics_parameter_derivatives


_add("forward 1e-4", "forward_dynamics_parameter_derivatives", _parameters, rf"forward {_step(1e-4)}")


def _velocity(model):
    frame = frame_of(model)

    def frame_velocity(q, v):
        h = 1e-3
        X, Y = (placed(model, x, frame) for x in (q, q + h * v))
        turn = Rotation.from_matrix(Y[:3, :3] @ X[:3, :3].T).as_rotvec()
        return np.concatenate([Y[:3, 3] - X[:3, 3], turn]) / h

    return frame_velocity


_add("forward 1e-3, rotation vector", "frame_velocity", _velocity, rf"forward {_step(1e-3)}")
