"""Right functions in other ways: other conventions, other methods, single precision, difference quotients."""

# ruff: noqa: E501, E741 - one case a line; I is an inertia tensor

import numpy as np
from textbook_codes.algebra import gradient, hat
from textbook_codes.code import TEXT, right_code
from textbook_codes.kinematics import frame_pose, motions, point_jacobian, poses
from textbook_codes.masses import body_centers

EVERY = (
    *("inverse_dynamics", "forward_dynamics", "bias_torque", "gravity_torque", "static_torque", "power"),
    *("joint_wrenches", "multipliers", "mass_matrix", "mass_matrix_inverse", "coriolis_matrix"),
    *("frame_placement", "frame_jacobian", "frame_jacobian_derivative", "frame_velocity", "frame_acceleration"),
    *("center_of_mass", "center_of_mass_jacobian", "center_of_mass_velocity", "momentum", "centroidal_map"),
    *("kinetic_energy", "potential_energy", "dtau_dq", "dtau_dv", "da_dq", "da_dv"),
    *(f"d{of}_d{x}" for of in ("wrenches", "multipliers") for x in "qva"),
    *("joint_torque_regressor", "base_regressor", "body_regressor", "momentum_regressor"),
    *("kinetic_energy_regressor", "potential_energy_regressor", "forward_dynamics_parameter_derivatives"),
)
"""All rows of the table in docs/judge.md."""

STEP = 1e-6
"""Of central differences, as people choose it: near the cube root of the rounding of a double."""


class SinglePrecision:
    """NumPy whose new arrays are of single precision."""

    float32, linalg = np.float32, np.linalg

    def __getattr__(self, name):
        found = getattr(np, name)
        if name not in ("eye", "zeros", "ones", "array", "stack", "concatenate", "block", "diag"):
            return found
        return lambda *x, **more: in_single(found(*x, **more))


def in_single(x):
    return x.astype({"f": np.float32, "c": np.complex64}.get(x.dtype.kind, x.dtype))


def single_precision(name, arm):
    """The plain code, every number rounded to 24 bits."""
    names = {"np": SinglePrecision()}
    exec(TEXT.replace("import numpy as np", ""), names)
    changed = {x: getattr(arm, x).astype(np.float32) for x in vars(arm) if isinstance(getattr(arm, x), np.ndarray)}
    rounded = arm.but(**changed)
    return lambda *x: np.asarray(names[name](rounded, *(y.astype(np.float32) for y in x))).astype(np.float32)


def in_frame(way):
    """Rows of a frame in another reference. way: (arm, q, rows) → rows"""

    def variant(name):
        def made(arm):
            own = right_code("frame_jacobian", arm)

            def J(q):
                return way(arm, q, own(q))

            def rate(q, v):
                return gradient(lambda t: J(q + t[0] * v), np.zeros(1))[..., 0]

            return {
                "frame_jacobian": J,
                "frame_jacobian_derivative": rate,
                "frame_velocity": lambda q, v: J(q) @ v,
                "frame_acceleration": lambda q, v, a: J(q) @ a + rate(q, v) @ v,
            }[name]

        return made

    return variant


def local(arm, q, J):
    R = frame_pose(arm, q)[0]
    return np.concatenate([R.T @ J[:3], R.T @ J[3:]])


def about_the_world(arm, q, J):
    p = frame_pose(arm, q)[1]
    return np.concatenate([J[:3] + hat(p) @ J[3:], J[3:]])


def angular_first(arm, q, J):
    return np.concatenate([J[3:], J[:3]])


def local_angular_first(arm, q, J):
    return angular_first(arm, q, local(arm, q, J))


def wrenches(way):
    def made(arm):
        own = right_code("joint_wrenches", arm)
        return lambda q, v, a: way(arm, q, own(q, v, a))

    return made


def in_world(arm, q, f):
    R = poses(arm, q)[0]
    return np.array([[*(R[j + 1] @ x[:3]), *(R[j + 1] @ x[3:])] for j, x in enumerate(f)])


def without_actuator(arm, q, f):
    f = np.array(f)
    for j, p in enumerate(arm.axes):
        part = slice(0, 3) if arm.prismatic[j] else slice(3, 6)
        f[j, part] -= p * (p @ f[j, part])
    return f


def about_origin(name):
    def made(arm):
        own, com = right_code(name, arm), right_code("center_of_mass", arm)

        def f(q, *v):
            P = own(q, *v)
            return np.concatenate([P[:3], P[3:] + hat(com(q)) @ P[:3]])

        return f

    return made


def other_coriolis(arm):
    """Of the Newton-Euler equations with Jacobians: C v and the symmetric part are the same."""

    def f(q, v):
        R, w, c = poses(arm, q)[0], motions(arm, q, v, 0 * v)[0], body_centers(arm, q)
        C = np.zeros((arm.n, arm.n))
        for j in range(arm.n):

            def jacobian(x, j=j):
                return point_jacobian(arm, x, j + 1, body_centers(arm, x)[j])

            J, D = point_jacobian(arm, q, j + 1, c[j]), gradient(lambda t: jacobian(q + t[0] * v), np.zeros(1))[..., 0]
            I = R[j + 1] @ arm.tensors[j] @ R[j + 1].T
            C += arm.masses[j] * J[:3].T @ D[:3] + J[3:].T @ (I @ D[3:] + hat(w[j + 1]) @ I @ J[3:])
        return C

    return f


def columns_of_torques(arm):
    tau = right_code("inverse_dynamics", arm.but(gravity=0 * arm.gravity))
    return lambda q: np.array([tau(q, 0 * q, e) for e in np.eye(arm.n)]).T


def gradient_of_energy(arm):
    U = right_code("potential_energy", arm)
    return lambda q: gradient(U, q)


def by_velocities_of_bodies(arm):
    """Power of the weights, of the inertia and of the joints: τ by statics of the inertial wrenches."""
    W = right_code("joint_torque_regressor", arm)
    parameters = []
    for m, c, J in zip(arm.masses, arm.centers, arm.tensors, strict=True):
        I = J + m * (c @ c * np.eye(3) - np.outer(c, c))
        parameters += [m, *(m * c), I[0, 0], I[0, 1], I[1, 1], I[0, 2], I[1, 2], I[2, 2]]
    return lambda q, v, a: W(q, v, a) @ parameters * v


def other_basis(arm):
    own = right_code("base_regressor", arm)
    mixed = np.random.default_rng(1)

    def f(q, v, a, kept=[]):  # noqa: B006 - the basis is the same in every call
        W = own(q, v, a)
        if not kept:
            kept.append(np.linalg.qr(mixed.normal(size=(W.shape[1], W.shape[1])))[0])
        return W @ kept[0]

    return f


def central(name, which):
    """A derivative with respect to argument number which."""

    def made(arm):
        f = right_code(name, arm)

        def derivative(*x):
            def moved(e):
                return f(*(y + e if k == which else y for k, y in enumerate(x)))

            return np.stack([(moved(STEP * e) - moved(-STEP * e)) / (2 * STEP) for e in np.eye(arm.n)], axis=-1)

        return derivative

    return made


def along_the_motion(name):
    """The rate of a function of q, by a central difference."""

    def made(arm):
        f = right_code(name, arm)
        return lambda q, v: (f(q + STEP * v) - f(q - STEP * v)) / (2 * STEP)

    return made


def acceleration_by_differences(arm):
    J, rate = right_code("frame_jacobian", arm), along_the_motion("frame_jacobian")(arm)
    return lambda q, v, a: J(q) @ a + rate(q, v) @ v


def symbols_by_differences(arm):
    D = central("mass_matrix", 0)(arm)

    def f(q, v):
        T = D(q)
        return 0.5 * (T @ v + np.einsum("ikj,k->ij", T, v) - np.einsum("jki,k->ij", T, v))

    return f


FRAMED = ("frame_jacobian", "frame_jacobian_derivative", "frame_velocity", "frame_acceleration")
WAYS = {
    "reference local": local,
    "reference world": about_the_world,
    "angular first": angular_first,
    "local, angular first": local_angular_first,
}
OTHERS = (
    *((name, label, in_frame(way)(name)) for label, way in WAYS.items() for name in FRAMED),
    ("joint_wrenches", "world axes", wrenches(in_world)),
    ("joint_wrenches", "on the inside body", wrenches(lambda arm, q, f: -f)),
    ("joint_wrenches", "actuator left out", wrenches(without_actuator)),
    ("joint_wrenches", "moment first", wrenches(lambda arm, q, f: np.roll(f, 3, axis=1))),
    ("joint_wrenches", "of world axes, moment first, on the inside body", wrenches(lambda arm, q, f: -np.roll(in_world(arm, q, f), 3, axis=1))),
    ("momentum", "about the world's origin", about_origin("momentum")),
    ("centroidal_map", "about the world's origin", about_origin("centroidal_map")),
    ("momentum", "angular first", lambda arm: lambda q, v: np.roll(right_code("momentum", arm)(q, v), 3)),
    ("centroidal_map", "angular first", lambda arm: lambda q: np.roll(right_code("centroidal_map", arm)(q), 3, axis=0)),
    ("potential_energy", "zero elsewhere", lambda arm: lambda q: right_code("potential_energy", arm)(q) + 3.7),
    ("coriolis_matrix", "by Jacobians", other_coriolis),
    ("mass_matrix", "columns of torques", columns_of_torques),
    ("gravity_torque", "gradient of the energy", gradient_of_energy),
    ("forward_dynamics", "articulated bodies", lambda arm: right_code("articulated_accelerations", arm)),
    ("forward_dynamics", "composite bodies", lambda arm: right_code("composite_accelerations", arm)),
    ("mass_matrix", "composite bodies", lambda arm: right_code("composite_mass_matrix", arm)),
    ("inverse_dynamics", "world axes", lambda arm: right_code("torques_in_world_axes", arm)),
    ("inverse_dynamics", "spatial vectors", lambda arm: right_code("spatial_torques", arm)),
    ("inverse_dynamics", "gradients of the energies", lambda arm: right_code("lagrange_torques", arm)),
    ("inverse_dynamics", "products of velocities", lambda arm: right_code("torques_by_products", arm)),
    ("power", "by the regressor", by_velocities_of_bodies),
    ("base_regressor", "another basis", other_basis),
    ("kinetic_energy", "½ v·M v", lambda arm: lambda q, v: 0.5 * v @ right_code("mass_matrix", arm)(q) @ v),
    ("dtau_dv", "complex steps", lambda arm: lambda q, v, a: gradient(lambda x: right_code("inverse_dynamics", arm)(q, x, a), v)),
    ("center_of_mass_jacobian", "complex steps", lambda arm: lambda q: gradient(right_code("center_of_mass", arm), q)),
)  # fmt: skip
"""Function, way, (arm) → right function."""

QUOTIENTS = (
    ("dtau_dq", central("inverse_dynamics", 0)),
    ("dtau_dv", central("inverse_dynamics", 1)),
    ("da_dq", central("forward_dynamics", 0)),
    ("da_dv", central("forward_dynamics", 1)),
    ("dwrenches_dq", central("joint_wrenches", 0)),
    ("dwrenches_dv", central("joint_wrenches", 1)),
    ("dmultipliers_dq", central("multipliers", 0)),
    ("dmultipliers_da", central("multipliers", 2)),
    ("center_of_mass_jacobian", central("center_of_mass", 0)),
    ("gravity_torque", central("potential_energy", 0)),
    ("frame_jacobian_derivative", along_the_motion("frame_jacobian")),
    ("center_of_mass_velocity", along_the_motion("center_of_mass")),
    ("frame_acceleration", acceleration_by_differences),
    ("coriolis_matrix", symbols_by_differences),
)
"""Central differences: right but for rounding."""
