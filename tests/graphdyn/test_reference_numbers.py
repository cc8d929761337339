"""Numbers that other people computed: the paper, and other programs (their numbers are read from reference files)."""

import numpy as np
import pytest
from random_trees import NAMED, random_state
from witnesses import relative_error

import graphdyn
from graphdyn import Body, Frame, Joint, Placement, RobotModel
from graphdyn.equations.kinematics import link_origins, null_space
from graphdyn.equations.system.constraints import constraints
from graphdyn.experiments.kr500 import cylinder
from graphdyn.model.spatial import rotation_about, skew

FULL_PRECISION = 1e-13
"""Reference numbers with 15 digits, relative to the largest wrench or entry: measured 5e-15."""

RBDL = 1e-13
"""Five small chains whose results are simple fractions of 9.81, printed with 15 digits: measured 1e-15."""

HALF_DIGIT = 0.5 + 1e-6
"""In units of the last printed digit: a correctly rounded number is at most half a unit away."""

E_X, E_Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


# PUMA 560, standard and modified Denavit-Hartenberg parameters


def dh_shift(rotation=None, translation=(0.0, 0.0, 0.0)):
    return Placement(np.eye(3) if rotation is None else rotation, np.asarray(translation))


def standard_dh_tail(alpha, a, d):
    """Tz(d) Tx(a) Rx(α): from our link frame (joint axis = z of DH frame j-1) to DH frame j at the end of the link."""
    return dh_shift(rotation_about(E_X, alpha), (a, 0.0, d))


def modified_dh_placement(alpha, a, d):
    """Rx(α) Tx(a) Tz(d): joint j in DH frame j-1. Modified DH frames stand at the joint, as our link frames do."""
    return dh_shift(rotation_about(E_X, alpha)) @ dh_shift(translation=(a, 0.0, d))


def moved(body, placement):
    """The body described in a frame in which its own frame has this placement."""
    r = placement.rotation
    return Body(body.name, body.mass, r @ body.center_of_mass + placement.translation, r @ body.inertia @ r.T)


def serial_robot(name, bodies, placements, end):
    n = len(bodies)
    joints = [Joint(f"joint{j}", "revolute", j - 1, p, E_Z) for j, p in enumerate(placements, start=1)]
    return RobotModel(name, tuple(bodies), tuple(joints), frames=(Frame("end", n, end),))


def standard_dh_robot(name, rows, bodies):
    """bodies: in the axes of the DH frames at the ends of the links; rows: (α, a, d)."""
    tails = [standard_dh_tail(*row) for row in rows]
    moved_bodies = [moved(body, tail) for body, tail in zip(bodies, tails, strict=True)]
    return serial_robot(name, moved_bodies, [Placement(), *tails[:-1]], tails[-1])


STANDARD_ROWS = [
    (np.pi / 2, 0, 0),
    (0, 0.4318, 0),
    (-np.pi / 2, 0.0203, 0.15005),
    (np.pi / 2, 0, 0.4318),
    (-np.pi / 2, 0, 0),
    (0, 0, 0),
]
MODIFIED_ROWS = [
    (0, 0, 0),
    (-np.pi / 2, 0, 0.2435),
    (0, 0.4318, -0.0934),
    (np.pi / 2, -0.0203, 0.4331),
    (-np.pi / 2, 0, 0),
    (np.pi / 2, 0, 0),
]
"""(α, a, d) of SymPyBotics' tests test_puma_dh_num_geo_kin_dyn and test_puma_mdh_num_geo_kin_dyn (BSD-3)."""


def bodies_of_dynparm(values):
    """Ten per link: Ixx, Ixy, Ixz, Iyy, Iyz, Izz about the DH frame origin, m x, m y, m z, m."""
    bodies = []
    for i, (xx, xy, xz, yy, yz, zz, mx, my, mz, m) in enumerate(np.reshape(values, (6, 10)), start=1):
        bodies.append(Body.from_parameters(f"link{i}", [m, mx, my, mz, xx, xy, yy, xz, yz, zz]))
    return bodies


@pytest.fixture(params=["standard", "modified"])
def puma(request, reference):
    """The robot and its reference numbers."""
    if request.param == "standard":
        numbers = reference("puma560_full_precision.json")
        model = standard_dh_robot("puma560", STANDARD_ROWS, bodies_of_dynparm(numbers["dynparm_test"]))
    else:
        numbers = reference("puma560_mdh_full_precision.json")
        placements = [modified_dh_placement(*row) for row in MODIFIED_ROWS]
        model = serial_robot("puma560", bodies_of_dynparm(numbers["dynparm_test"]), placements, Placement())
    return model, {key: np.array(value) for key, value in numbers.items() if not key.startswith("_")}


def test_puma_torques(puma, method):
    model, numbers = puma
    q, v, a = (numbers[key] for key in ("q_test", "dq_test", "ddq_test"))
    i = graphdyn.inverse_dynamics(model, q, v, a, method=method)
    assert relative_error(i.tau, numbers["tau_pcorke"].ravel()) < FULL_PRECISION


def test_puma_gravity_coriolis_and_mass_matrix(puma, method):
    model, numbers = puma
    q, v, a = (numbers[key] for key in ("q_test", "dq_test", "ddq_test"))
    gravity = graphdyn.bias_torque(model, q, 0 * v)
    coriolis = graphdyn.bias_torque(model, q, v) - gravity
    assert relative_error(gravity, numbers["g_pcorke"].ravel()) < FULL_PRECISION
    assert relative_error(coriolis, numbers["c_pcorke"].ravel(), gravity) < FULL_PRECISION
    assert relative_error(graphdyn.mass_matrix(model, q), numbers["M_pcorke"]) < FULL_PRECISION
    f = graphdyn.forward_dynamics(model, q, v, numbers["tau_pcorke"].ravel(), method=method)
    condition = np.linalg.cond(numbers["M_pcorke"])
    assert relative_error(f.a, a) < FULL_PRECISION * condition


@pytest.mark.usefixtures("default_method")
def test_puma_torque_regressor(puma):
    model, numbers = puma
    q, v, a = (numbers[key] for key in ("q_test", "dq_test", "ddq_test"))
    tau = graphdyn.joint_torque_regressor(model, q, v, a) @ model.inertial_parameters
    assert relative_error(tau, numbers["tau_pcorke"].ravel()) < FULL_PRECISION


def test_puma_pose_and_jacobian(puma):
    model, numbers = puma
    q = numbers["q_test"]
    rotation, position = graphdyn.frame_placement(model, q, "end")
    assert relative_error(rotation, numbers["T_pcorke"][:3, :3]) < FULL_PRECISION
    assert relative_error(position, numbers["T_pcorke"][:3, 3], rotation) < FULL_PRECISION
    state = graphdyn.maximal_state(model, q)
    last = null_space(state)[-6:]  # ṙ of the center of mass in world axes, ω in body axes
    angular = state.rotation[-1] @ last[3:]
    linear = last[:3] + skew(state.position[-1] - position) @ angular  # v = ṙ + ω × (p - r)
    assert relative_error(np.concatenate([linear, angular]), numbers["J_pcorke"]) < FULL_PRECISION


# PUMA 560 with rotor inertia and friction: tables with four decimals

RTB_CASES = [
    "py_rne_grav", "py_rne_qdd1", "py_rne_qd1qdd1", "py_rne_qd1", "py_rne_nograv", "py_rne_fext", "py_accel",
    "py_inertia", "py_coriolis", "py_gravload", "py_itorque", "mat_gravload_a", "mat_gravload_b", "mat_inertia_a",
    "mat_inertia_b", "mat_coriolis_a", "mat_coriolis_b", "mat_itorque", "mat_rne", "mat_accel",
]  # fmt: skip


class RtbPuma:
    """The rigid robot of graphdyn, with rotor inertia G² J_m and friction added outside."""

    def __init__(self, links):
        bodies = []
        for i, link in enumerate(links, start=1):
            xx, yy, zz, xy, yz, xz = link["I6"]
            bodies.append(Body(f"link{i}", link["m"], link["r"], [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        self.model = standard_dh_robot("puma560", [(x["alpha"], x["a"], x["d"]) for x in links], bodies)
        self.rotors = np.array([link["G"] ** 2 * link["Jm"] for link in links])
        self.links = links

    def friction(self, v):
        """B G² q̇ + |G| T_c, with the Coulomb value of the direction of motion, none at rest."""
        coulomb = [0 if s == 0 else x["Tc"][0] if s > 0 else x["Tc"][1] for x, s in zip(self.links, v, strict=True)]
        viscous = [x["B"] * x["G"] ** 2 for x in self.links]
        return viscous * v + np.abs([x["G"] for x in self.links]) * coulomb

    def torque(self, q, v, a, gravity=9.81, end_wrench=None):
        wrenches = np.zeros((6, 6))
        if (
            end_wrench is not None
        ):  # exerted by the robot at its end, in the axes of the end: the body feels the opposite
            end = self.model.frame("end").placement
            force, moment = (-end.rotation @ part for part in np.split(np.asarray(end_wrench, dtype=float), 2))
            wrenches[-1] = np.concatenate([force, moment + np.cross(end.translation, force)])
        model = self.model.with_gravity([0.0, 0.0, -gravity])
        return graphdyn.inverse_dynamics(model, q, v, a, wrenches).tau + self.rotors * a + self.friction(v)

    def mass_matrix(self, q):
        return graphdyn.mass_matrix(self.model, q) + np.diag(self.rotors)

    def acceleration(self, q, v, tau):
        return np.linalg.solve(self.mass_matrix(q), tau - self.torque(q, v, np.zeros(6)))

    def coriolis_matrix(self, q, v):
        """Christoffel form, by polarization of the bias torque, which is quadratic in v."""
        unit = np.eye(6)
        return ((graphdyn.bias_torque(self.model, q, v + unit) - graphdyn.bias_torque(self.model, q, v - unit)) / 4).T


@pytest.mark.usefixtures("default_method")
@pytest.mark.parametrize("default_method", ["projected", "recursive, NumPy"], indirect=True)
@pytest.mark.parametrize("name", RTB_CASES)
def test_puma_tables_with_rotors_and_friction(reference, name):
    """The two MATLAB accel numbers and all others, within the tolerance of the file: half a printed digit or one."""
    file = reference("puma560_rtb_tables.json")
    case = next(case for case in file["cases"] if case["id"] == name)
    puma = RtbPuma(file["model"]["links"])
    q, v, a = (np.array(case.get(key, np.zeros(6)), dtype=float) for key in ("q", "qd", "qdd"))
    what = name.split("_")[1]
    if what == "rne":
        value = puma.torque(q, v, a, case.get("gravity", 9.81), case.get("fext"))
    elif what == "gravload":
        value = graphdyn.bias_torque(puma.model, q, v)
    elif what == "itorque":
        value = puma.mass_matrix(q) @ a
    elif what == "inertia":
        value = puma.mass_matrix(q)
    elif what == "coriolis":
        value = puma.coriolis_matrix(q, v)
    else:
        assert what == "accel"
        q_nominal, unit = np.array([0, np.pi / 4, np.pi, 0, np.pi / 4, 0]), np.array([0.0, 1, 0, 0, 2, 0])
        tau = case["tau"] if "tau" in case else puma.torque(q_nominal, unit, unit)
        value = puma.acceleration(q, v, np.array(tau, dtype=float))
    np.testing.assert_allclose(value, case["expected"], rtol=0, atol=case["tol"])


def test_every_rtb_case_is_used(reference):
    assert [case["id"] for case in reference("puma560_rtb_tables.json")["cases"]] == RTB_CASES


# RBDL


@pytest.mark.parametrize("number", range(5))
def test_rbdl_forward_dynamics(reference, number, method):
    case = reference("rbdl_forward_dynamics.json")["cases"][number]
    axes = dict(zip("xyz", np.eye(3), strict=True))
    bodies = [Body(f"b{i}", x["mass"], x["com"], np.diag(x["I_com_diag"])) for i, x in enumerate(case["joints"])]
    joints = [
        Joint(f"j{i}", "revolute", i, Placement(translation=x["offset_in_parent"]), axes[x["axis"]])
        for i, x in enumerate(case["joints"])
    ]
    model = RobotModel(case["id"], tuple(bodies), tuple(joints), gravity=np.array([0.0, -9.81, 0.0]))
    f = graphdyn.forward_dynamics(model, case["q"], case["qd"], case["tau"], method=method)
    assert relative_error(f.a, np.array(case["qdd_expected"])) < RBDL


# The paper

TABLE_2 = {
    "mass": (6402.6012, 2746.0726, 1186.1661, 308.7953, 284.2877, 661.7042),
    "J_11": (800.3251, 123.5733, 23.7233, 6.1759, 5.6858, 29.7767),
    "J_22": (982.8126, 416.4934, 156.5838, 5.6413, 4.8353, 19.8511),
}
LENGTHS = (1.045, 1.245, 1.21, 0.315, 0.29, 0.3)
RADII = (0.5, 0.3, 0.2, 0.2, 0.2, 0.3)
KR500 = NAMED["kr500"]


def assert_printed(value, printed, decimals):
    """Every number rounds to the printed one."""
    distance = np.abs(np.asarray(value) - np.asarray(printed)) * 10.0 ** np.asarray(decimals)
    assert distance.max() <= HALF_DIGIT


def test_kr500_has_the_masses_and_inertias_of_table_2():
    assert_printed([body.mass for body in KR500.bodies], TABLE_2["mass"], 4)
    assert_printed([body.inertia[0, 0] for body in KR500.bodies], TABLE_2["J_11"], 4)
    for axis in (1, 2):
        assert_printed([body.inertia[axis, axis] for body in KR500.bodies], TABLE_2["J_22"], 4)
    for body, length, radius in zip(KR500.bodies, LENGTHS, RADII, strict=True):
        assert np.array_equal(body.inertia, np.diag(np.diag(body.inertia)))
        assert np.array_equal(body.center_of_mass, [length / 2, 0, 0])
        assert cylinder("same", length, radius, density=7801.0).mass == pytest.approx(body.mass, rel=1e-15)


def test_kr500_stands_as_in_figure_2():
    """2.290 m up, 2.115 m out; O_1, O_4, O_6 along e_1, O_2, O_3, O_5 along e_2 (errata C1)."""
    state = graphdyn.maximal_state(KR500, np.zeros(6))
    out = np.cumsum((0, 0, 0, 1.21, 0.315, 0.29))
    up = (0, 1.045, 2.29, 2.29, 2.29, 2.29)
    np.testing.assert_allclose(link_origins(state), np.stack([out, np.zeros(6), up], axis=-1), atol=1e-15)
    e_1 = [rotation[:, 0] for rotation in state.rotation]
    np.testing.assert_allclose(e_1, [E_Z, E_Z, E_X, E_X, E_X, E_X], atol=1e-15)
    np.testing.assert_allclose([r[:, 1] for r in state.rotation], np.tile([0, 1.0, 0], (6, 1)), atol=1e-15)
    assert [int(np.argmax(joint.axis)) + 1 for joint in KR500.joints] == [1, 2, 2, 1, 2, 1]


def test_kr500_incidence_matrix_is_the_papers():
    """Eq. (10) and Eq. (13)."""
    s = np.array(
        [
            [-1, 1, 0, 0, 0, 0],
            [0, -1, 1, 0, 0, 0],
            [0, 0, -1, 1, 0, 0],
            [0, 0, 0, -1, 1, 0],
            [0, 0, 0, 0, -1, 1],
            [0, 0, 0, 0, 0, -1],
        ]
    )
    assert np.array_equal(KR500.graph.incidence(), s)


def test_kr500_body_joint_vectors_are_the_papers():
    """Eq. (11) and Eq. (18): l_i/2 e_1 of body i at joint i and at joint i+1, zero elsewhere."""
    c = np.zeros((6, 6, 3))
    for i, length in enumerate(LENGTHS):
        c[i, i : i + 2, 0] = length / 2
    np.testing.assert_allclose(KR500.body_joint_vectors(), c, rtol=1e-15)


def robot_of_table_2():
    """The KR500 with the masses and moments as printed: the numbers of errata C4 were computed with these."""
    moments = zip(TABLE_2["J_11"], TABLE_2["J_22"], TABLE_2["J_22"], strict=True)
    bodies = [
        Body(body.name, mass, body.center_of_mass, np.diag(j))
        for body, mass, j in zip(KR500.bodies, TABLE_2["mass"], moments, strict=True)
    ]
    return RobotModel("table 2", tuple(bodies), KR500.joints)


def test_reactions_of_the_papers_motion(method):
    """Errata C4: t = 1.5 s, joint 1 at +30°/s², joint 2 at -30°/s², rail 2 m/s² along world x (as gravity)."""
    turn, time = np.deg2rad(30), 1.5
    a = np.array([turn, -turn, 0, 0, 0, 0])
    q, v = a * time**2 / 2, a * time
    moving = robot_of_table_2().with_gravity([-2.0, 0.0, -9.80665])
    tau = graphdyn.inverse_dynamics(moving, q, v, a).tau
    for answer in (
        graphdyn.inverse_dynamics(moving, q, v, a, method=method),
        graphdyn.forward_dynamics(moving, q, v, tau, method=method),
    ):
        assert_printed(answer.multipliers[0, :3], (24853.75, -7277.143, 110108.77), (2, 3, 2))
        assert_printed(answer.multipliers[5, :3], (854.4670, -2008.935, 5947.395), (4, 3, 3))


def world_axis_rows(state, phi_q):
    """φ_q with the axis rows of the paper: world x and y rows of p_i - p_j = 0 (Eq. 71-73). δp = -R p̃ δθ."""
    phi_q = phi_q.copy()
    for j, joint in enumerate(state.model.joints, start=1):
        rows = slice(5 * j - 2, 5 * j)
        phi_q[rows] = 0
        in_inside = joint.placement.rotation @ joint.axis
        for body, sign, axis in ((joint.inside, 1.0, in_inside), (j, -1.0, joint.axis)):
            if body > 0:
                turned = -sign * state.rotation[body - 1] @ skew(axis)
                phi_q[rows, 6 * body - 3 : 6 * body] = turned[:2]
    return phi_q


PAPERS_RANKS = {
    "generic": (None, 28, {"phi_24", "phi_25", "phi_34", "phi_35"}),
    "1.5 s": (np.deg2rad([33.75, -33.75, 0, 0, 0, 0]), 27, {f"phi_{j}{k}" for j in (2, 3, 5) for k in (4, 5)}),
    "start": (np.zeros(6), 25, None),
}
"""Errata A2: rank of the paper's 30×36 Jacobian in three poses, and the rows that depend on each other."""


@pytest.mark.parametrize("pose", PAPERS_RANKS)
def test_the_papers_axis_rows_are_dependent_and_ours_are_not(pose):
    q, rank, rows = PAPERS_RANKS[pose]
    q = random_state(KR500, 70)[0] if q is None else q
    state = graphdyn.maximal_state(KR500, q)
    system = graphdyn.kkt_system(KR500, q, np.zeros(6), np.zeros(6))
    assert system.constraint_rank() == 30
    assert system.rank() == 66
    printed = graphdyn.KKTSystem(
        system.mass, world_axis_rows(state, system.constraint_jacobian), system.force, system.zeta
    )
    assert printed.constraint_rank() == rank
    with pytest.raises(
        graphdyn.RankDeficientConstraints, match=f"rank {rank}, expected 30; dependent rows: "
    ) as caught:
        printed.solve()
    assert (caught.value.rank, caught.value.n_rows) == (rank, 30)
    if rows is not None:
        assert set(caught.value.rows) == rows
    assert all(row in str(caught.value) for row in caught.value.rows)


def test_constraint_jacobian_is_well_conditioned_in_every_pose(rng):
    """Errata A2: rank 30 in every pose, condition number about 10 to 25; over 300 poses measured 6 to 21, median 10."""
    q = rng.uniform(-np.pi, np.pi, (300, 6))
    q[0] = 0
    phi_q, _ = constraints(graphdyn.maximal_state(KR500, q))
    conditions = np.linalg.cond(phi_q)
    assert np.all(np.linalg.matrix_rank(phi_q) == 30)
    assert 8 < np.median(conditions) < 12
    assert conditions.max() < 30
