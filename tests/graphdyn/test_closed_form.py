"""Mechanisms whose equations fit on a page."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from witnesses import relative_error

import graphdyn
from graphdyn import Body, Joint, Placement, RobotModel

ROUNDING = 1e-13
"""Some ten operations in double precision, condition number of M below 20: measured 2.4e-15."""

PERIOD = 1e-9
"""DOP853 to the turning point and a straight line for the zero of v."""

G = 9.81


class DoublePendulum:
    """Two links turning about the world y axis under gravity along -z, angles from the downward vertical.

    x = Σ l sin, z = -Σ l cos. With φ_1 = q_1, φ_2 = q_1 + q_2, centers at a_1, a_2 from the joints:
    M_11 = I_1 + I_2 + m_1 a_1² + m_2 (l_1² + a_2² + 2 l_1 a_2 cos q_2), M_12 = I_2 + m_2 (a_2² + l_1 a_2 cos q_2),
    M_22 = I_2 + m_2 a_2²; h = Coriolis with k = m_2 l_1 a_2 sin q_2, plus gravity.
    """

    l_1, a_1, a_2 = 0.9, 0.4, 0.35
    m_1, m_2, i_1, i_2 = 3.0, 1.7, 0.21, 0.08

    def model(self):
        # Body axes at q = 0 are the world axes; the links hang along -z. A turn about -y takes -z towards +x.
        def hanging(name, m, a, i):
            return Body(name, m, np.array([0, 0, -a]), np.diag([0.5 * i, i, 0.7 * i]))

        axis = np.array([0.0, -1.0, 0.0])
        return RobotModel(
            "double pendulum",
            (hanging("upper", self.m_1, self.a_1, self.i_1), hanging("lower", self.m_2, self.a_2, self.i_2)),
            (
                Joint("shoulder", "revolute", 0, Placement(), axis),
                Joint("elbow", "revolute", 1, Placement(translation=np.array([0, 0, -self.l_1])), axis),
            ),
            gravity=np.array([0.0, 0.0, -G]),
        )

    def mass_matrix(self, q):
        c = np.cos(q[1])
        m_22 = self.i_2 + self.m_2 * self.a_2**2
        m_12 = m_22 + self.m_2 * self.l_1 * self.a_2 * c
        m_11 = self.i_1 + self.m_1 * self.a_1**2 + self.m_2 * self.l_1**2 + 2 * m_12 - m_22
        return np.array([[m_11, m_12], [m_12, m_22]])

    def bias(self, q, v):
        k = self.m_2 * self.l_1 * self.a_2 * np.sin(q[1])
        lower = self.m_2 * self.a_2 * G * np.sin(q[0] + q[1])
        upper = (self.m_1 * self.a_1 + self.m_2 * self.l_1) * G * np.sin(q[0])
        return np.array([-k * (2 * v[0] * v[1] + v[1] ** 2) + upper + lower, k * v[0] ** 2 + lower])

    def center_accelerations(self, q, v, a):
        """(x, z) of both centers: along the link -length φ̇², across it length φ̈."""

        def radial(phi, rate, acceleration, length):
            out = np.array([np.sin(phi), -np.cos(phi)])
            across = np.array([np.cos(phi), np.sin(phi)])
            return length * (acceleration * across - rate**2 * out)

        upper = radial(q[0], v[0], a[0], self.a_1)
        elbow = radial(q[0], v[0], a[0], self.l_1)
        return upper, elbow + radial(q.sum(), v.sum(), a.sum(), self.a_2)


@pytest.fixture
def pendulum():
    return DoublePendulum()


STATES = [
    (np.array(q), np.array(v), np.array(x))
    for q, v, x in (
        ([0.3, -0.8], [0.0, 0.0], [0.0, 0.0]),
        ([1.2, 0.7], [1.5, -2.0], [3.0, -1.0]),
        ([-2.5, 2.9], [-4.0, 3.0], [-2.0, 5.0]),
        ([0.0, 0.0], [2.0, 1.0], [1.0, 1.0]),
    )
]
states = pytest.mark.parametrize(("q", "v", "x"), STATES)


@states
def test_double_pendulum_accelerations(pendulum, q, v, x, method):
    expected = np.linalg.solve(pendulum.mass_matrix(q), x - pendulum.bias(q, v))
    f = graphdyn.forward_dynamics(pendulum.model(), q, v, x, method=method)
    assert relative_error(f.a, expected) < ROUNDING


@states
def test_double_pendulum_torques_and_mass_matrix(pendulum, q, v, x, method):
    i = graphdyn.inverse_dynamics(pendulum.model(), q, v, x, method=method)
    assert relative_error(i.tau, pendulum.mass_matrix(q) @ x + pendulum.bias(q, v), i.joint_wrenches) < ROUNDING
    assert relative_error(graphdyn.mass_matrix(pendulum.model(), q), pendulum.mass_matrix(q)) < ROUNDING


@states
def test_double_pendulum_reactions(pendulum, q, v, x, method):
    """λ: the elbow carries the lower link, the shoulder both; nothing pushes out of the plane."""
    f = graphdyn.forward_dynamics(pendulum.model(), q, v, x, method=method)
    upper, lower = pendulum.center_accelerations(q, v, f.a)
    weight = np.array([0.0, G])
    elbow = pendulum.m_2 * (lower + weight)
    shoulder = pendulum.m_1 * (upper + weight) + elbow
    for row, (in_x, in_z) in enumerate((shoulder, elbow)):
        expected = np.array([in_x, 0.0, in_z, 0.0, 0.0])  # two moments about axes normal to y
        assert relative_error(f.multipliers[row], expected, shoulder, elbow) < ROUNDING
    assert relative_error(f.body_accelerations[:, [0, 2]], np.stack([upper, lower])) < ROUNDING
    # about the link's own axes only the moment along the joint axis -y remains: the actuator's
    assert relative_error(f.joint_wrenches[:, 3:], np.outer(x, [0.0, -1.0, 0.0]), shoulder, elbow) < ROUNDING


@pytest.mark.parametrize("upward", [True, False])
def test_slide_along_gravity(method, upward):
    """m q̈ = τ ∓ m g, whatever the velocity; the guide carries only the moment of the eccentric center."""
    mass, center = 4.0, np.array([0.3, -0.2, 0.6])
    axis = np.array([0.0, 0.0, 1.0 if upward else -1.0])
    body = Body("base_motion", mass, center, np.diag([0.1, 0.2, 0.15]))
    model = RobotModel("lift", (body,), (Joint("slide", "prismatic", 0, Placement(), axis),))
    q, v, tau = np.array([0.4]), np.array([-2.0]), np.array([50.0])
    f = graphdyn.forward_dynamics(model, q, v, tau, method=method)
    along = -G if upward else G
    assert f.a[0] == pytest.approx(tau[0] / mass + along, rel=ROUNDING)
    # the drive pushes at O_1 along the axis, so the guide turns the body back by c × (m (r̈ - g))
    moment = np.cross(center, tau[0] * axis)
    expected = np.concatenate([tau[0] * axis, moment])
    assert relative_error(f.joint_wrenches[0], expected) < ROUNDING
    t_1, t_2 = model.joints[0].axis_normals
    assert relative_error(f.multipliers[0], np.array([0, 0, t_1 @ moment, t_2 @ moment, 0]), expected) < ROUNDING
    assert graphdyn.mass_matrix(model, q)[0, 0] == pytest.approx(mass, rel=ROUNDING)


@pytest.mark.usefixtures("default_method")
def test_slide_on_an_incline():
    """A frictionless moving base on a slope of angle s: q̈ = -g sin s; the guide presses with m g cos s."""
    slope, mass = 0.6, 2.5
    axis = np.array([np.cos(slope), 0.0, np.sin(slope)])
    normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
    body = Body("base_motion", mass, np.zeros(3), np.eye(3))
    model = RobotModel("incline", (body,), (Joint("slide", "prismatic", 0, Placement(), axis),))
    f = graphdyn.forward_dynamics(model, [0.2], [1.0], [0.0])
    assert f.a[0] == pytest.approx(-G * np.sin(slope), rel=ROUNDING)
    t = model.joints[0].axis_normals
    expected = np.concatenate([t @ (mass * G * np.cos(slope) * normal), np.zeros(3)])
    assert relative_error(f.multipliers[0], expected) < ROUNDING


def test_period_of_a_large_swing():
    """T = 4 K(sin² (q_0/2)) sqrt((I + m a²)/(m g a)): the complete elliptic integral, from scipy."""
    mass, arm, inertia, start = 1.3, 0.5, 0.06, 2.0
    body = Body("bob", mass, np.array([0.0, 0.0, -arm]), inertia * np.eye(3))
    model = RobotModel("pendulum", (body,), (Joint("pivot", "revolute", 0, Placement(), np.array([0.0, 1.0, 0.0])),))
    quarter = ellipk(np.sin(start / 2) ** 2) * np.sqrt((inertia + mass * arm**2) / (mass * G * arm))

    def rate(t, x):
        return [x[1], graphdyn.forward_dynamics(model, x[:1], x[1:], [0.0]).a[0]]

    x = solve_ivp(rate, (0, 2 * quarter), [start, 0.0], "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    late = -x[1] / rate(0, x)[1]  # half a period later the pendulum should rest on the other side
    assert abs(late) / (2 * quarter) < PERIOD
    assert x[0] == pytest.approx(-start, rel=PERIOD)


def test_spinning_disk_on_a_turntable(method):
    """Disk with moments I, J, I spinning with s about its axis on a table that turns with w: gyroscopic moment J w s.

    The table turns about z, the spindle lies along the table's y axis through the center; constant rates need no
    torque, and the table must turn the spin momentum J s e_y: moment w e_z × J s e_y = -J s w e_x.
    """
    mass, across, along, w, s = 2.0, 0.05, 0.09, 1.7, -12.0
    table = Body("table", 1.0, np.zeros(3), 0.3 * np.eye(3))
    disk = Body("disk", mass, np.zeros(3), np.diag([across, along, across]))
    model = RobotModel(
        "gyroscope",
        (table, disk),
        (
            Joint("turntable", "continuous", 0, Placement(), np.array([0.0, 0.0, 1.0])),
            Joint("spindle", "continuous", 1, Placement(), np.array([0.0, 1.0, 0.0])),
        ),
        gravity=np.zeros(3),
    )
    q, v = np.array([0.8, 0.0]), np.array([w, s])
    f = graphdyn.forward_dynamics(model, q, v, np.zeros(2), method=method)
    moment = np.array([-along * s * w, 0.0, 0.0])
    assert relative_error(f.a, np.zeros(2), v) < ROUNDING
    assert relative_error(f.joint_wrenches[1], np.concatenate([np.zeros(3), moment])) < ROUNDING
    t = model.joints[1].axis_normals
    assert relative_error(f.multipliers[1, 3:], t @ moment) < ROUNDING


@pytest.mark.usefixtures("default_method")
def test_rotor_accelerates_with_torque_over_inertia():
    """A cylinder about its own axis: τ = ½ m R² q̈, from the cylinder of Eq. (21)."""
    mass, radius, tau = 5.0, 0.2, 3.0
    inertia = mass * radius**2 / 2
    rotor = Body("rotor", mass, np.array([0.4, 0, 0]), np.diag([inertia, 1.0, 1.0]))
    model = RobotModel("spindle", (rotor,), (Joint("bearing", "continuous", 0, Placement(), np.array([2.0, 0, 0])),))
    f = graphdyn.forward_dynamics(model, [0.3], [100.0], [tau])
    assert f.a[0] == pytest.approx(tau / inertia, rel=ROUNDING)
    # the bearing carries the weight, and its moment about the bearing: c × m (0, 0, g)
    assert relative_error(f.multipliers[0, :3], np.array([0.0, 0.0, mass * G])) < ROUNDING
    expected = model.joints[0].axis_normals @ np.cross([0.4, 0, 0], [0, 0, mass * G])
    assert relative_error(f.multipliers[0, 3:], expected) < ROUNDING
