"""What the torque is made of: every term against its formula, names, units, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from identified import torque_data

import graphdyn
from graphdyn import BaseMotion, Body, Coupling, InvalidInput, Joint, Placement, RobotModel
from graphdyn.identification import Problem, Samples, TorqueModel
from graphdyn.identification.data.samples import TorqueFreeSamples
from graphdyn.identification.problem.torque_model import structure
from graphdyn.identification.terms import (
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    CoupledWrist,
    Drift,
    KnownBodies,
    KnownPayload,
    KnownTorque,
    LoadFriction,
    MaxwellSlip,
    Offset,
    Payload,
    PayloadMass,
    RigidBodies,
    RotorInertia,
    ScaledTorque,
    SmoothCoulomb,
    Spring,
    Stribeck,
    UserColumns,
    Viscous,
)
from graphdyn.model.inertia import parameters_from_inertia

SAME = 1e-13
"""Two sums of some tens of terms, relative to the largest torque."""

MODEL = torque_data.robot()


@pytest.fixture(scope="module")
def samples():
    rng = np.random.default_rng(0)
    q, v = MODEL.random_state(rng, 20)
    v[0] = 0.0
    a, time, temperature = rng.normal(size=q.shape), np.linspace(0, 1, 20), 30 + rng.normal(size=q.shape)
    return Samples(q, v, a, np.zeros_like(q), time=time, temperature=temperature)


def diagonal(values):
    """Column j acts on joint j alone."""
    return np.einsum("tj,jk->tjk", values, np.eye(6))


def close(found, expected):
    return np.abs(found - expected).max() <= SAME * np.abs(expected).max()


PER_JOINT = {
    "viscous": (Viscous(), lambda s: s.v, "O2 viscous friction", "FV_2", "N m s/rad"),
    "Coulomb": (Coulomb(), lambda s: np.sign(s.v), "O2 Coulomb friction", "FC_2", "N m"),
    "smooth": (Coulomb(width=0.1), lambda s: np.tanh(s.v / 0.1), "O2 Coulomb friction", "FC_2", "N m"),
    "widths": (
        Coulomb(width=np.arange(1.0, 7.0)),
        lambda s: np.tanh(s.v / np.arange(1.0, 7.0)),
        "O2 Coulomb friction",
        "FC_2",
        "N m",
    ),
    "Stribeck": (
        Stribeck(velocity=0.5),
        lambda s: np.sign(s.v) * np.exp(-((s.v / 0.5) ** 2)),
        "O2 Stribeck friction",
        "FS_2",
        "N m",
    ),
    "Stribeck, smooth": (
        Stribeck(velocity=0.5, exponent=1.0, width=0.1),
        lambda s: np.tanh(s.v / 0.1) * np.exp(-np.abs(s.v / 0.5)),
        "O2 Stribeck friction",
        "FS_2",
        "N m",
    ),
    "load": (
        LoadFriction(width=0.1),
        lambda s: np.abs(graphdyn.static_torque(MODEL, s.q)) * np.tanh(s.v / 0.1),
        "O2 load-dependent friction",
        "FL_2",
        "1",
    ),
    "offset": (Offset(), lambda s: np.ones_like(s.v), "O2 offset", "OFF_2", "N m"),
    "exponents": (
        Stribeck(velocity=0.5, exponent=np.arange(1.0, 7.0)),
        lambda s: np.sign(s.v) * np.exp(-(np.abs(s.v / 0.5) ** np.arange(1.0, 7.0))),
        "O2 Stribeck friction",
        "FS_2",
        "N m",
    ),
    "spring": (Spring(), lambda s: s.q, "O2 spring", "K_2", "N m/rad"),
    "drift in time": (
        Drift(Offset(), "time", 4.0),
        lambda s: np.ones_like(s.v) * (s.time[:, None] - 4.0),
        "O2 offset per time",
        "OFF_2/s",
        "N m/s",
    ),
    "drift with temperature": (
        Drift(Viscous(), "temperature", 30.0),
        lambda s: s.v * (s.temperature - 30.0),
        "O2 viscous friction per temperature",
        "FV_2/K",
        "N m s/rad/K",
    ),
    "rotor": (RotorInertia(), lambda s: s.a, "O2 rotor inertia", "IA_2", "kg m²"),
}


def test_the_load_is_that_on_the_base_as_it_is_placed(samples):
    """A wall bears the same as the floor, where gravity is turned the other way."""
    wall = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    turned = graphdyn.static_torque(MODEL.with_gravity(wall.T @ MODEL.gravity), samples.q)
    found = LoadFriction(width=0.1).rows(MODEL, replace(samples, base=BaseMotion(rotation=wall)))
    assert close(found, diagonal(np.abs(turned) * np.tanh(samples.v / 0.1)))


@pytest.mark.parametrize("case", PER_JOINT)
def test_per_joint(case, samples):
    term, formula, name, symbol, unit = PER_JOINT[case]
    assert close(term.rows(MODEL, samples), diagonal(formula(samples)))
    column = term.columns(MODEL)[1]
    assert (column.name, column.symbol, column.unit) == (name, symbol, unit)
    assert len(term.columns(MODEL)) == 6


def test_several_widths(samples):
    own = np.arange(1.0, 7.0)
    term = SmoothCoulomb([0.1, own])
    rows = term.rows(MODEL, samples)
    assert close(rows[..., :6], diagonal(np.tanh(samples.v / 0.1)))
    assert close(rows[..., 6:], diagonal(np.tanh(samples.v / own)))
    named = [(column.name, column.symbol) for column in term.columns(MODEL)]
    assert named[1] == ("O2 Coulomb friction of width 0.1", "FC1_2")
    assert named[7] == ("O2 Coulomb friction of width 2", "FC2_2")
    with pytest.raises(InvalidInput, match=r"width is 0\.; give one positive number, or 6"):
        SmoothCoulomb([0.0]).columns(MODEL)


def test_drifts_need_their_channel(samples):
    with pytest.raises(
        InvalidInput, match="a drift over temperature, which the samples lack; map its column, or leave"
    ):
        Drift(Viscous(), "temperature").rows(MODEL, replace(samples, temperature=None))
    with pytest.raises(InvalidInput, match="a drift is over 'load'; use time or temperature"):
        Drift(Viscous(), "load").columns(MODEL)


class TestMaxwellSlip:
    def still(self, q):
        q = np.outer(q, np.ones(6))
        return Samples(q, np.zeros_like(q), np.zeros_like(q), np.zeros_like(q))

    def test_one_element(self):
        """Forth by more than its deflection, back by a part of it, back by more."""
        term = MaxwellSlip([np.arange(1.0, 7.0)])
        rows = term.rows(MODEL, self.still([0.0, 0.5, 5.0, 4.0, 4.0, -9.0, -8.5]))
        assert rows[:, 1, 1] == pytest.approx([0, 0.25, 1, 0.5, 0.5, -1, -0.75])
        assert rows[:, 0, 0] == pytest.approx([0, 0.5, 1, 0, 0, -1, -0.5])
        assert not rows[:, 0, 1:].any()
        with pytest.raises(InvalidInput, match=r"deflection is 0\.; give one positive number, or 6"):
            MaxwellSlip([0.0]).rows(MODEL, self.still([0.0]))

    def test_many_elements_are_masing_s_rule(self):
        """A branch after a reversal is the first branch, stretched by two (Masing 1926)."""
        term = MaxwellSlip([0.1, 0.3, 0.7])
        strength = np.repeat([2.0, 3.0, 5.0], 6)
        forth, back = np.linspace(0, 1, 101), np.linspace(1, -1, 101)
        torque = (term.rows(MODEL, self.still([*forth, *back[1:]])) @ strength)[:, 0]
        first, branch = torque[:101], torque[100:]
        assert branch == pytest.approx(first[-1] - 2 * first, abs=1e-12)
        named = [(column.name, column.symbol) for column in term.columns(MODEL)[6:8]]
        assert named == [("O1 Maxwell-slip friction 2", "FM2_1"), ("O2 Maxwell-slip friction 2", "FM2_2")]

    def test_short_deflections_are_told_apart(self):
        """Those of stiff gears; far from standstill all elements slip alike."""
        three = TorqueModel(MODEL, [Coulomb(), MaxwellSlip([1e-5, 1e-4, 1e-3])])
        assert structure(three).base.rank == 24

    @pytest.mark.parametrize("values", [[], 0.1])
    def test_no_list(self, values):
        for term, what in ((MaxwellSlip(values), "deflections"), (SmoothCoulomb(values), "widths")):
            with pytest.raises(InvalidInput, match=rf"{what} are .*; give a list of at least one"):
                TorqueModel(MODEL, [Offset(), term])

    @pytest.mark.parametrize("term", [MaxwellSlip([2.0]), Drift(MaxwellSlip([2.0]))], ids=["slip", "its drift"])
    def test_remembers_beyond_a_chunk(self, term, monkeypatch):
        monkeypatch.setattr("graphdyn.identification.problem.problem.CHUNK_SAMPLES", 7)
        samples = self.still(np.cumsum(np.random.default_rng(0).normal(size=40)))
        samples = replace(samples, time=np.linspace(0.0, 1.0, 40))
        model = TorqueModel(MODEL, [term])
        for compression in ("qr", "gram"):
            problem = Problem(model, samples, compression=compression)
            rows = term.rows(MODEL, samples)
            assert problem.equations.counts.tolist() == [40] * 6
            lengths = np.linalg.norm(problem.equations.factors[..., :-1], axis=1)
            assert lengths == pytest.approx(np.linalg.norm(rows, axis=0), abs=1e-12)
        pieces = [samples[:20], replace(samples[20:], continues=True)]
        with pytest.raises(InvalidInput, match="friction with memory needs each run of the recording as one piece"):
            Problem(model, pieces).equations  # noqa: B018


def test_scaled_torque(samples):
    term = ScaledTorque(lambda q, v, a: q * v, "spring")
    assert np.array_equal(term.rows(MODEL, samples)[..., 0], samples.q * samples.v)
    assert [(column.name, column.symbol, column.unit) for column in term.columns(MODEL)] == [
        ("spring factor", "spring", "1")
    ]
    with pytest.raises(InvalidInput, match=r"the torque 'spring' answers shape \(20,\)"):
        ScaledTorque(lambda q, v, a: q[:, 0], "spring").rows(MODEL, samples)


def test_units_of_a_slide():
    slide = Joint("S", "prismatic", 0, Placement(), np.array([0.0, 0.0, 1.0]))
    robot = RobotModel("slide", MODEL.bodies[:1], (slide,))
    units = [term.columns(robot)[0].unit for term in (Viscous(), Coulomb(), Offset(), RotorInertia())]
    assert units == ["N s/m", "N", "N", "kg"]


@pytest.mark.parametrize(
    ("asymmetric", "symmetric"),
    [
        (AsymmetricCoulomb(), Coulomb()),
        (AsymmetricCoulomb(width=0.3), Coulomb(width=0.3)),
        (AsymmetricViscous(), Viscous()),
    ],
)
def test_asymmetric_friction(asymmetric, symmetric, samples):
    """Equal parameters forth and back are the symmetric friction; either alone acts in one direction."""
    rows = asymmetric.rows(MODEL, samples)
    forth, back = rows[..., :6], rows[..., 6:]
    assert close(forth + back, symmetric.rows(MODEL, samples))
    assert not forth[samples.v < 0].any()
    assert not back[samples.v > 0].any()
    assert [column.symbol[2] for column in asymmetric.columns(MODEL)] == ["+"] * 6 + ["-"] * 6


def test_rigid_bodies(samples):
    expected = graphdyn.inverse_dynamics(MODEL, samples.q, samples.v, samples.a).tau
    assert close(RigidBodies().rows(MODEL, samples) @ MODEL.inertial_parameters, expected)
    assert close(KnownBodies().torque(MODEL, samples), expected)
    assert close(KnownBodies(2 * MODEL.inertial_parameters).torque(MODEL, samples), 2 * expected)
    columns = RigidBodies().columns(MODEL)
    assert [column.symbol for column in columns[10:20]] == [
        *("M_2", "MX_2", "MY_2", "MZ_2", "XX_2", "XY_2", "YY_2", "XZ_2", "YZ_2", "ZZ_2")
    ]
    assert (columns[14].name, columns[14].unit) == ("B2 I_xx", "kg m²")


def test_coupled_wrist(samples):
    """Axis 6 seen from axis 5 and the reverse."""
    rows = CoupledWrist().rows(MODEL, samples)
    inertia, viscous, coulomb = np.moveaxis(rows, -1, 0)
    sign = np.sign(samples.v[:, 4] + samples.v[:, 5])
    for found, fifth, sixth in (
        (inertia, samples.a[:, 5], samples.a[:, 4]),
        (viscous, samples.v[:, 5], samples.v[:, 4]),
        (coulomb, sign, sign),
    ):
        assert np.array_equal(found[:, 4], fifth)
        assert np.array_equal(found[:, 5], sixth)
        assert not found[:, :4].any()
    smooth = CoupledWrist(("O3", "O6"), width=0.1).rows(MODEL, samples)[:, 2, 2]
    assert close(smooth, np.tanh((samples.v[:, 2] + samples.v[:, 5]) / 0.1))
    assert [column.symbol for column in CoupledWrist().columns(MODEL)] == ["IAM_6", "FVM_6", "FCM_6"]


class TestRotors:
    GEARS = np.array([100.0, -80.0, 60.0, 5.0, -4.0, 3.0])
    INERTIA = np.array([3e-3, 4e-3, 2e-3, 0.3, 0.2, 0.5])
    AXES = np.array([[0, 0, 1], [1, 0, 0], [0, 0.6, 0.8], [0, 0, 1], [0.6, -0.8, 0], [0, 1, 0]])

    def rotor(self, j):
        """About its center: INERTIA about the axis, 0.01 across."""
        across = 0.01 * (np.eye(3) - np.outer(self.AXES[j], self.AXES[j]))
        return 2.0, np.array([0.1, -0.2, 0.3]), self.INERTIA[j] * np.outer(self.AXES[j], self.AXES[j]) + across

    def test_gyroscopic_coupling(self, samples):
        """Against rotors that are bodies of their own, coupled to the joints, less the same rotors held still."""
        bodies, joints, couplings = list(MODEL.bodies), list(MODEL.joints), []
        held = MODEL.inertial_parameters.reshape(-1, 10).copy()
        for j, joint in enumerate(MODEL.joints):
            mass, center, inertia = self.rotor(j)
            bodies.append(Body(f"rotor {j}", mass, np.zeros(3), inertia))
            joints.append(Joint(f"R{j}", "revolute", joint.inside, Placement(np.eye(3), center), self.AXES[j]))
            couplings.append(Coupling(f"R{j}", {joint.name: self.GEARS[j]}))
            if joint.inside:
                held[joint.inside - 1] += parameters_from_inertia(mass, center, inertia)
        spinning = RobotModel("spinning", tuple(bodies), tuple(joints), couplings=tuple(couplings))
        still = MODEL.with_inertial_parameters(held.ravel())
        expected, without = (
            graphdyn.joint_torques(robot, samples.q, samples.v, samples.a) for robot in (spinning, still)
        )
        term = RotorInertia(self.GEARS, self.AXES)
        found = term.rows(MODEL, samples) @ (self.GEARS**2 * self.INERTIA)
        assert np.abs(found - (expected - without)).max() <= SAME * np.abs(expected).max()
        plain = RotorInertia().rows(MODEL, samples) @ (self.GEARS**2 * self.INERTIA)
        assert np.abs(found - plain).max() > 0.01 * np.abs(plain).max()

    def test_refusals(self, samples):
        with pytest.raises(
            InvalidInput, match=r"gears of the rotors are \[1\. 2\.\]; give 6 numbers that are not zero"
        ):
            RotorInertia([1.0, 2.0]).rows(MODEL, samples)
        with pytest.raises(InvalidInput, match=r"axes of the rotors have shape \(6, 3\); give 6 vectors of length 1"):
            RotorInertia(self.GEARS, 2 * self.AXES).rows(MODEL, samples)
        moving = replace(samples, base=BaseMotion())
        with pytest.raises(InvalidInput, match="rotors with gears need a base at rest; leave the gears out"):
            RotorInertia(self.GEARS).rows(MODEL, moving)


class TestPayload:
    LOAD = parameters_from_inertia(12.0, np.array([0.1, 0.2, 0.3]), np.diag([0.2, 0.3, 0.4]))

    @pytest.mark.parametrize(("body", "number"), [(None, 6), ("B3", 3)])
    def test_is_a_heavier_body(self, body, number, samples):
        pi = MODEL.inertial_parameters.copy()
        pi[10 * (number - 1) : 10 * number] += self.LOAD
        heavier = graphdyn.inverse_dynamics(MODEL.with_inertial_parameters(pi), samples.q, samples.v, samples.a).tau
        plain = KnownBodies().torque(MODEL, samples)
        assert close(plain + Payload(body).rows(MODEL, samples) @ self.LOAD, heavier)
        assert close(plain + KnownPayload(self.LOAD, body).torque(MODEL, samples), heavier)
        mass = PayloadMass([0.1, 0.2, 0.3], np.diag([0.2, 0.3, 0.4]) / 12.0, body)
        assert close(plain + mass.rows(MODEL, samples)[..., 0] * 12.0, heavier)
        for terms, known, x in (
            ([RigidBodies(), Payload(body)], [], [*MODEL.inertial_parameters, *self.LOAD]),
            ([Payload(body)], [KnownBodies()], self.LOAD),
            ([RigidBodies()], [KnownPayload(self.LOAD, body)], MODEL.inertial_parameters),
            ([mass], [KnownBodies()], [12.0]),
        ):
            assert close(TorqueModel(MODEL, terms, known).inertial_parameters(np.array(x)), pi)

    def test_columns(self):
        assert [column.symbol for column in Payload().columns(MODEL)][:2] == ["M_L", "MX_L"]
        (column,) = PayloadMass([0, 0, 0]).columns(MODEL)
        assert (column.name, column.unit) == ("payload m", "kg")

    def test_refusals(self, samples):
        with pytest.raises(InvalidInput, match="the payload is on body 'hand'; robot 'arm' has B1, B2, B3"):
            Payload("hand").columns(MODEL)
        with pytest.raises(InvalidInput, match=r"of the payload have shape \(3,\); 10 finite numbers needed, m, mc_x"):
            KnownPayload([1, 2, 3]).torque(MODEL, samples)
        for wrong in (np.nan, np.inf):
            with pytest.raises(InvalidInput, match=r"of the payload have shape \(10,\); 10 finite numbers needed, m"):
                KnownPayload([*self.LOAD[:9], wrong]).torque(MODEL, samples)
        with pytest.raises(InvalidInput, match=r"has shape \(2,\), inertia per mass \(3, 3\); \(3,\) and \(3, 3\)"):
            PayloadMass([1, 2]).rows(MODEL, samples)


class TestUserColumns:
    SPRING = UserColumns(lambda q, v, a: np.sin(q) * [0, 1, 0, 0, 0, 0], ["spring"], ["N m"])

    def test_spring(self, samples):
        rows = self.SPRING.rows(MODEL, samples)
        assert rows.shape == (20, 6, 1)
        assert np.array_equal(rows[:, 1, 0], np.sin(samples.q[:, 1]))
        assert self.SPRING.columns(MODEL)[0].unit == "N m"

    def test_known(self, samples):
        gas = KnownTorque(lambda q, v, a: 100 * q)
        model = TorqueModel(MODEL, [Offset()], [gas, gas])
        assert close(model.torque(samples, np.ones(6)), 200 * samples.q + 1)

    def test_refusals(self, samples):
        with pytest.raises(InvalidInput, match="names are 'spring', units 'N m'; give one list entry each per column"):
            UserColumns(lambda q, v, a: q, "spring", "N m")
        with pytest.raises(
            InvalidInput, match=r"the law of k, d answers shape \(20, 6\); finite .* \(20, 6, 2\) needed"
        ):
            UserColumns(lambda q, v, a: q, ["k", "d"], ["", ""]).rows(MODEL, samples)
        for wrong in (np.nan, np.inf):
            with pytest.raises(InvalidInput, match="the known torque answers NaN or infinity"):
                KnownTorque(lambda q, v, a, wrong=wrong: np.where(q == q[3, 2], wrong, q)).torque(MODEL, samples)


class TestTorqueModel:
    def test_parts_side_by_side(self, samples):
        model = torque_data.torque_model()
        parts = [term.rows(model.model, samples) for term in model.terms]
        assert np.array_equal(model.rows(samples), np.concatenate(parts, axis=-1))
        assert len(model.columns) == torque_data.PARAMETERS
        assert list(model.prior()) == [*MODEL.inertial_parameters, *[0.0] * 27]

    def test_standard_terms(self):
        symbols = [column.symbol for column in TorqueModel(MODEL).columns]
        assert [symbols[k] for k in (0, 60, 66, 72)] == ["M_1", "FV_1", "FC_1", "OFF_1"]

    def test_refusals(self):
        with pytest.raises(InvalidInput, match="two parameters of the torque model are called 'O1 offset'"):
            TorqueModel(MODEL, [Offset(), Offset()])
        with pytest.raises(
            InvalidInput, match=r"the torque model has no parameter; give terms such as RigidBodies\(\)"
        ):
            TorqueModel(MODEL, [])


class ReadsTorque:
    """A term, known and unknown, that computes its torque from the measured one."""

    def __init__(self, read):
        self.read = read

    def columns(self, model):
        return Offset().columns(model)

    def rows(self, model, samples):
        return Offset().rows(model, samples) * self.read(samples).sum()

    def torque(self, model, samples):
        return self.read(samples)


@pytest.mark.parametrize(
    "read",
    [
        lambda samples: samples.tau,
        lambda samples: samples[2:4].tau,
        lambda samples: next(samples.pieces(5)).tau,
        lambda samples: getattr(samples, "tau", samples.v),
    ],
)
def test_a_term_does_not_see_the_torque(read, samples):
    term = ReadsTorque(read)
    message = "a term reads samples.tau, the torque it is to explain; compute it from q, v and a alone"
    for model in (TorqueModel(MODEL, [Viscous(), term]), TorqueModel(MODEL, [Viscous()], [term])):
        with pytest.raises(InvalidInput, match=message):
            model.torque(samples, np.zeros(len(model.columns)))
        with pytest.raises(InvalidInput, match=message):
            Problem(model, samples).equations  # noqa: B018
    motion = TorqueModel(MODEL, [ReadsTorque(lambda samples: samples[:3].v)]).rows(samples)
    assert motion.shape == (20, 6, 6)
    assert repr(TorqueFreeSamples(samples)).startswith("TorqueFreeSamples(q=array(")
    assert np.all(motion[0] == samples.v[:3].sum() * np.eye(6))


class TestRefusals:
    @pytest.mark.parametrize("width", [0.0, -1.0, np.nan, np.inf, [1.0, 2.0], [1.0] * 5 + [np.inf]])
    def test_widths(self, width, samples):
        with pytest.raises(InvalidInput, match=r"width is .*; give one positive number, or 6"):
            Coulomb(width=width).rows(MODEL, samples)

    def test_width_of_a_wrist(self, samples):
        with pytest.raises(InvalidInput, match=r"width is -1.*; give one positive number"):
            CoupledWrist(width=-1.0).rows(MODEL, samples)

    def test_stribeck(self, samples):
        with pytest.raises(InvalidInput, match="Stribeck velocity is 0"):
            Stribeck(velocity=0).rows(MODEL, samples)
        with pytest.raises(InvalidInput, match="exponent is -1"):
            Stribeck(velocity=1, exponent=-1).rows(MODEL, samples)

    @pytest.mark.parametrize("joints", [("O5", "O7"), ("O5", "O5")])
    def test_wrist(self, joints):
        with pytest.raises(InvalidInput, match=f"needs two joints of robot 'arm', got {', '.join(joints)}; it has O1"):
            CoupledWrist(joints).columns(MODEL)

    def test_known_bodies(self, samples):
        with pytest.raises(InvalidInput, match=r"of the known bodies have shape \(10,\); 60 finite numbers needed"):
            KnownBodies(np.ones(10)).torque(MODEL, samples)
        with pytest.raises(InvalidInput, match=r"of the known bodies have shape \(60,\); 60 finite numbers needed"):
            KnownBodies(np.where(np.arange(60) == 59, np.nan, 1.0)).torque(MODEL, samples)
