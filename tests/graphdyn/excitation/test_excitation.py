"""Exciting motions: exact gradients, limits kept at all times, and a plan that keeps its promise."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.stats
from identified.excited_robot import AT_REST, followed
from planting import mixed_tree
from robots.mechanisms import four_bar
from shown.approved import approve_result

from graphdyn import (
    Coupling,
    Frame,
    InvalidInput,
    JointLimits,
    Placement,
    frame_placement,
    joint_torque_regressor,
    joint_torques,
)
from graphdyn.excitation import (
    ConditionNumber,
    ExcitationProblem,
    FourierBasis,
    MotionLimits,
    NoFeasibleMotion,
    OptimizedMotion,
    Plane,
    SplineBasis,
    TabulatedCourse,
    Trajectory,
    Usage,
    excitation_plan,
    log_det,
    mean_sigma,
    optimized,
    prior_spread,
    random_motions,
    random_trajectory,
    sample_times,
)
from graphdyn.excitation import optimizing as optimizing
from graphdyn.excitation.constraints import signals
from graphdyn.excitation.information import Information
from graphdyn.excitation.limits import Sphere, frame_origins, sphere_around
from graphdyn.excitation.optimizing import _Search
from graphdyn.excitation.trajectory import JointMotion, smooth_maximum, smooth_slope, usage
from graphdyn.identification import OrdinaryLeastSquares, Problem, TorqueModel
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.torque_model import STATES_PER_PARAMETER, random_samples, structure
from graphdyn.identification.terms import AsymmetricCoulomb, Coulomb, CoupledWrist, RigidBodies, Viscous
from graphdyn.motion_laws import FourierSeries

DIFFERENCES = 2e-7
"""Central differences with steps of 1e-5 against exact slopes, relative to the largest: measured 3e-8 and less."""

BETWEEN = 1e-5
"""Part of a limit by which a motion may exceed it between the points at which it was checked, 1 ms apart: the
acceleration of what is limited times (1 ms)²/8."""

ROUNDING = 1e-11

BETTER = 1.1
"""Mean half axis of the ellipsoid of errors, best of 20 random motions to the optimized one: measured 1.13."""

VISCOUS, COULOMB = 3.0, 2.0
"""Of every joint of the simulated robot [N m s/rad or N s/m, N m or N]."""

FRICTION = (Viscous(), Coulomb())

LIMITS = {"lower": -2.0, "upper": 2.0, "velocity": 2.0, "acceleration": 10.0, "jerk": 60.0, "torque": 200.0}


def problem_of(model=None, terms=FRICTION, basis=None, planes=(), **limits):
    model = model or mixed_tree()
    torque_model = TorqueModel(model, (RigidBodies(), *terms))
    known = MotionLimits.of_model(model, planes=planes, **{**LIMITS, **limits})
    return ExcitationProblem(torque_model, known, basis or FourierBasis(5.0, 3), 0.5, 100.0)


def coupled_tree():
    model = mixed_tree()
    names = model.joint_names
    return replace(model, couplings=(Coupling(names[2], {names[0]: -0.5}, 0.1),))


@pytest.fixture(scope="module")
def found():
    problem = problem_of()
    return problem, optimized(problem, 1)


@pytest.mark.parametrize("basis", [FourierBasis(5.0, 4), SplineBasis(5.0, 7)], ids=["series", "splines"])
def test_functions_of_time(basis):
    """Rest at both ends, derivatives as differences say, and the function that is 1 all the time."""
    times, step = np.linspace(0.1, 4.9, 30), 1e-4
    for order in range(3):
        slope = (basis.rows(times + step, order) - basis.rows(times - step, order)) / (2 * step)
        exact = basis.rows(times, order + 1)
        assert np.abs(slope - exact).max() < 1e-5 * np.abs(exact).max()
        at_ends = basis.rows(np.array([0.0, 5.0]), order)
        assert order == 0 or np.abs(at_ends).max() < ROUNDING * np.abs(exact).max()
    assert np.abs(basis.rows(times, 0) @ basis.middle - 1).max() < ROUNDING
    assert np.linalg.matrix_rank(basis.rows(times, 1)) == basis.size - 1


def test_coefficients_of_splines_have_the_size_of_velocities():
    """All equal they are a constant: as long as a piece."""
    basis = SplineBasis(6.0, 4)
    assert basis.rows(np.linspace(0.0, 6.0, 50), 0).sum(axis=1) == pytest.approx(1.5)
    assert basis.rows(np.linspace(0.0, 6.0, 50), 0) @ basis.middle == pytest.approx(1.0)


def test_a_motion_in_a_basis_of_more_functions_is_the_same():
    few, more = (FourierBasis(5.0, harmonics) for harmonics in (3, 5))
    coefficients = np.random.default_rng(0).normal(size=(2, few.size))
    trajectory, times = Trajectory(few, coefficients), np.linspace(0, 5, 101)
    for one, other in zip(trajectory.motion(times), trajectory.of(more).motion(times), strict=True):
        assert np.abs(other - one).max() <= ROUNDING * np.abs(one).max()


def test_series_in_the_notation_of_swevers():
    basis, times = FourierBasis(5.0, 4), np.linspace(0, 5, 20)
    coefficients = np.random.default_rng(0).normal(size=basis.size)
    motion = FourierSeries(1 / 5.0, *basis.series(coefficients))(times)
    for order, expected in enumerate(motion):
        assert np.abs(basis.rows(times, order) @ coefficients - expected).max() < ROUNDING * np.abs(expected).max()


@pytest.mark.parametrize("name", ["log_det", "mean_sigma", "condition"])
@pytest.mark.parametrize(
    ("model", "terms"),
    [(mixed_tree(), FRICTION), (coupled_tree(), (Viscous(),)), (mixed_tree(), (CoupledWrist(),))],
    ids=["friction", "couplings", "other joints' columns"],
)
def test_gradients(name, model, terms):
    """Of the criterion by every position, velocity and acceleration of the motion, against differences."""
    torque_model = TorqueModel(model, (RigidBodies(), *terms))
    information = Information(torque_model, np.linspace(0.5, 2.0, model.nv), width=0.3)
    criterion = {
        "log_det": log_det, "mean_sigma": mean_sigma, "condition": ConditionNumber(prior_spread(torque_model))
    }[name]  # fmt: skip
    rng = np.random.default_rng(3)
    motion = JointMotion(*rng.normal(size=(4, 40, model.nv)))
    known = np.zeros((len(information.independent),) * 2)
    value, slopes = information.value_and_slopes(motion, 40, known, criterion)
    assert value == pytest.approx(criterion(information.matrix(motion, 40))[0], rel=ROUNDING)
    for kind in range(3):
        direction = rng.normal(size=motion.q.shape)
        step = 1e-5 * direction
        values = [
            information.value_and_slopes(
                JointMotion(*(x + sign * step if k == kind else x for k, x in enumerate(motion))), 40, known, criterion
            )[0]
            for sign in (1, -1)
        ]
        size = np.linalg.norm(slopes[kind]) * np.linalg.norm(direction)
        assert abs((values[0] - values[1]) / 2e-5 - np.sum(slopes[kind] * direction)) < DIFFERENCES * size


@pytest.mark.parametrize("width", [None, 0.3])
def test_information_is_that_of_rows_divided_by_their_noise(width):
    """With signs of friction, or the hyperbolic tangent that stands for those that have no width of their own."""
    model, noise = mixed_tree(), np.array([0.5, 1.0, 2.0])
    torque_model = TorqueModel(model, (RigidBodies(), Coulomb(), Viscous(), AsymmetricCoulomb(width=0.7)))
    information = Information(torque_model, noise, width)
    motion = JointMotion(*np.random.default_rng(4).normal(size=(4, 40, 3)))
    q, v, a, _ = motion
    sign, own = np.sign(v) if width is None else np.tanh(v / width), np.tanh(v / 0.7)
    of_joints = [sign, v, np.where(v > 0, own, 0.0), np.where(v < 0, own, 0.0)]
    columns = [joint_torque_regressor(model, q, v, a), *(part[..., None] * np.eye(3) for part in of_joints)]
    w = np.concatenate(columns, axis=-1)[..., information.independent] / noise[:, None]
    wanted = np.einsum("tjb,tjc->bc", w, w) * 200 / 40
    np.testing.assert_allclose(information.matrix(motion, 200), wanted, atol=ROUNDING * np.abs(wanted).max())
    slopes = information.value_and_slopes(motion, 200, 0 * wanted, log_det)
    assert slopes[0] == pytest.approx(-np.linalg.slogdet(wanted)[1] / (2 * len(wanted)), rel=1e-9)


@pytest.mark.parametrize("model", [mixed_tree(), coupled_tree()], ids=["tree", "couplings"])
def test_slopes_of_limits(model):
    """Of positions, velocities, accelerations, jerks, torques and planes by the coefficients of the motion."""
    joints = tuple(replace(joint, damping=0.5 + k, friction=0.1) for k, joint in enumerate(model.joints))
    model = replace(model, joints=joints)
    problem = problem_of(model, planes=(Plane((0.2, -0.3, 1.0), -3.0),))
    basis, times = problem.basis, np.linspace(0, 5, 30)
    phi = [basis.rows(times, order) for order in range(4)]
    rng = np.random.default_rng(5)
    at, direction = rng.normal(size=(2, model.nv, basis.size))

    def maxima(coefficients):
        motion = JointMotion(*(rows @ coefficients.T for rows in phi))
        return [
            (
                signal.kind,
                smooth_maximum(signal, 20.0),
                smooth_slope(signal, phi, 20.0),
                signal.values.max(),
            )
            for signal in signals(model, problem.limits, problem.checked_spheres, motion)
        ]

    exact, more, less = maxima(at), maxima(at + 1e-5 * direction), maxima(at - 1e-5 * direction)
    assert {kind for kind, *_ in exact} == {"position", "velocity", "acceleration", "jerk", "torque", "plane"}
    assert len(exact) == 4 * model.n_bodies + model.nv + 1
    for (_, value, slope, largest), (_, high, *_), (_, low, *_) in zip(exact, more, less, strict=True):
        assert abs((high - low) / 2e-5 - np.sum(slope * direction)) < DIFFERENCES * max(np.abs(slope).max(), 1.0)
        assert largest <= value <= largest + np.log(30 * len(problem.checked_spheres) * 2) / 20.0


def test_better_than_random(found):
    problem, best = found
    model, rng = problem.torque_model.model, np.random.default_rng(0)
    values = []
    for _ in range(20):
        motion = random_trajectory(model, problem.limits, (), problem.basis, rng)
        assert max(usage.used for usage in problem.usages(motion.motion(np.linspace(0, 5, 240)))) < 1 + 1e-8
        values.append(problem.value(motion))
    assert best.value < min(values) - np.log(BETTER)
    assert np.array_equal(optimized(problem, 1).trajectory.coefficients, best.trajectory.coefficients)


def test_limits_hold_between_the_points(found):
    problem, best = found
    assert max(usage.used for usage in best.usages) <= 1
    dense = best.trajectory.motion(np.linspace(0, 5, 40_001))
    assert max(usage.used for usage in problem.usages(dense)) < 1 + BETWEEN
    assert any(usage.used > 0.98 for usage in best.usages)  # a limit that nothing reaches would hide an error


def test_planes_couplings_and_splines():
    """Every link stays on its side of a plane that cuts through the space of random motions."""
    model = coupled_tree()
    plane = Plane((0.0, 0.0, 2.0), -0.4)
    problem = problem_of(model, basis=SplineBasis(4.0, 6), planes=(plane,), terms=(Viscous(),))
    best = optimized(problem, 0)
    q = best.trajectory.motion(sample_times(4.0, 1000.0)).q
    heights = [frame_placement(model, q, body)[1][:, 2].min() for body in model.body_names]
    assert min(heights) > -0.4
    (used,) = [usage.used for usage in best.usages if usage.kind == "plane"]
    assert used == pytest.approx(1 - 0.4 - min(heights), abs=ROUNDING)
    driven = model.joint_positions(q)
    assert np.abs(driven).max() <= 2.0


def test_second_motion_complements_the_first(found):
    """It tells more, beside the first, than the first repeated."""
    problem, best = found
    once = problem.total_information(best.trajectory)
    further = optimized(replace(problem, known=once), 2)
    assert further.value < log_det(2 * once)[0] - 0.02
    assert problem.samples == 5.0 * 100.0
    assert np.array_equal(
        replace(problem, known=once).total_information(further.trajectory),
        problem.total_information(further.trajectory) + once,
    )


def test_promise_is_kept(found):
    """Recordings of a simulated robot with friction are identified: errors have the covariance that the plan states."""
    problem, best = found
    model, torque_model = problem.torque_model.model, problem.torque_model
    exact = followed(problem, best.trajectory, VISCOUS, COULOMB)
    friction = np.repeat([VISCOUS, COULOMB], model.n_bodies)
    truth = np.concatenate([model.inertial_parameters, friction])
    plan = excitation_plan(torque_model, problem.total_information(best.trajectory))
    rng, errors = np.random.default_rng(1), []
    for _ in range(30):
        tau = exact.tau + problem.noise * rng.normal(size=exact.tau.shape)
        fit = Problem(torque_model, replace(exact, tau=tau), n_blocks=1, min_speed=AT_REST)
        errors.append(fit.base.values(OrdinaryLeastSquares().estimate(fit).parameters) - plan.base.values(truth))
    squares = np.einsum("ri,ij,rj->", errors, plan.information, errors)
    degrees_of_freedom = 30 * len(plan.sigma)
    assert abs(squares - degrees_of_freedom) < 4 * np.sqrt(2 * degrees_of_freedom)
    ratio = np.sqrt(np.mean(np.square(errors), axis=0)) / plan.sigma
    assert ratio.min() > 0.6
    assert ratio.max() < 1.5


def test_plan_of_a_poor_motion(found):
    """A motion of one joint: what it does not move is not determined, and what it never can is told."""
    problem, best = found
    coefficients = best.trajectory.coefficients.copy()
    coefficients[1:, 1:] = 0.0
    poor = replace(best.trajectory, coefficients=coefficients)
    plan = excitation_plan(problem.torque_model, problem.total_information(poor))
    assert np.isinf(plan.sigma).all()
    assert plan.condition_number > 1e6
    good = excitation_plan(problem.torque_model, problem.total_information(best.trajectory))
    assert set(good.verdicts) <= {"well", "roughly", "not"}
    assert good.geometric_mean < 0.1
    columns = {column.name for column in problem.torque_model.columns}
    alone = {problem.torque_model.columns[k].name for k in good.base.alone}
    assert set(good.only_in_sums) | set(good.without_effect) | alone == columns
    assert good.only_in_sums


def test_criteria_of_a_matrix_by_its_eigenvalues():
    """Semi-axes 1 / √λ of the ellipsoid of errors, deviations of x by 10⁵ draws, singular values of the regressor."""
    rng = np.random.default_rng(0)
    w = rng.normal(size=(40, 3)) * [1.0, 5.0, 0.2]
    information = w.T @ w
    axes = 1 / np.sqrt(np.linalg.eigvalsh(information))
    assert log_det(information)[0] == pytest.approx(np.log(axes).mean())
    drawn = np.linalg.lstsq(w, rng.normal(size=(40, 100_000)), rcond=None)[0].std(axis=1)
    assert mean_sigma(information)[0] == pytest.approx(np.log(drawn).mean(), abs=0.01)
    scale = np.array([2.0, 0.3, 7.0])
    assert ConditionNumber(scale)(information)[0] == pytest.approx(np.log(np.linalg.cond(w * scale)))


def test_numbers_of_a_plan(found):
    """A regressor of which singular values tell the condition, and what its least squares says of each parameter."""
    plan = excitation_plan(found[0].torque_model, found[0].total_information(found[1].trajectory))
    size, rng = len(plan.sigma), np.random.default_rng(0)
    w = rng.normal(size=(60, size)) * np.linspace(1, 30, size)
    plan = replace(plan, information=w.T @ w, prior=rng.normal(size=size), spread=rng.uniform(0.1, 2.0, size))
    assert plan.sigma == pytest.approx(np.linalg.norm(np.linalg.pinv(w), axis=1))
    assert plan.condition_number == pytest.approx(np.linalg.cond(w * plan.spread))
    assert plan.geometric_mean == pytest.approx(scipy.stats.gmean(plan.sigma / plan.spread))
    larger = [max(abs(x), spread) for x, spread in zip(plan.prior, plan.spread, strict=True)]
    assert plan.relative == pytest.approx(plan.sigma / larger)
    sizes = 1 / np.resize([0.099, 0.101, 0.499, 0.501], size)
    exact = replace(plan, information=np.eye(size), prior=-sizes, spread=0 * sizes)
    assert exact.verdicts == tuple(np.resize(["well", "roughly", "roughly", "not"], size))


def test_spread_of_drives_and_sums():
    """A tenth of the torque of the joint's own bodies; summands of a base parameter are drawn independently."""
    torque_model = TorqueModel(mixed_tree(), (RigidBodies(), Viscous()))
    known, samples = structure(torque_model).base, random_samples(torque_model, STATES_PER_PARAMETER * 33, 0)
    torque = torque_model.torque(samples, torque_model.prior())
    drives = 0.1 * np.sqrt(np.mean(torque**2, axis=0) / np.mean(samples.v**2, axis=0))
    scale = np.concatenate([model_prior(torque_model).scale[:30], drives])
    drawn = (known.matrix @ (scale[:, None] * np.random.default_rng(0).normal(size=(33, 40_000)))).std(axis=1)
    assert prior_spread(torque_model) == pytest.approx(drawn, rel=0.02)


def test_motion_from_a_table(found):
    """Rows at 100 Hz give the motion back."""
    problem, best = found
    times = np.linspace(0, 5, 501)
    table = TabulatedCourse(times + 7.0, best.trajectory.motion(times).q)
    assert table.duration == pytest.approx(5.0)
    for one, other in zip(table.motion(times), best.trajectory.motion(times), strict=True):
        assert np.abs(one - other).max() < 1e-3 * np.abs(other).max()
    assert problem.value(table) == pytest.approx(best.value, abs=5e-3)
    whole, q = problem.total_information(table), best.trajectory.motion(times).q
    cuts = [slice(0, 151), slice(150, None)]
    parts = sum(problem.total_information(TabulatedCourse(times[cut], q[cut])) for cut in cuts)
    assert np.abs(parts - whole).max() < 0.01 * np.abs(whole).max()  # both ends of a cut count, one of 500 samples


def test_times_outside_a_motion_count_as_its_ends():
    rng, times = np.random.default_rng(0), np.linspace(0.0, 2.0, 30)
    motions = [
        TabulatedCourse(times, rng.normal(size=(30, 3))),
        Trajectory(SplineBasis(2.0, 5), rng.normal(size=(3, 6))),
    ]
    for motion in motions:
        for outside, inside in zip(
            motion.motion(np.array([-0.3, 2.4])), motion.motion(np.array([0.0, 2.0])), strict=True
        ):
            assert np.array_equal(outside, inside)


def test_a_sphere_around_spheres_holds_them_and_touches_one():
    rng = np.random.default_rng(0)
    for count in (1, 2, 5):
        spheres = [
            Sphere(2, center, radius)
            for center, radius in zip(rng.normal(size=(count, 3)), rng.uniform(0, 2, count), strict=True)
        ]
        found = sphere_around(spheres)
        room = [found.radius - np.linalg.norm(one.center - found.center) - one.radius for one in spheres]
        assert found.body == 2
        assert min(room) == pytest.approx(0.0, abs=1e-12)


def test_origins_that_stay_on_their_side_of_planes_are_those_of_all_moving_frames():
    """Of the links, and of tools and fused links, each place once; frames of the ground do not move."""
    model = mixed_tree()
    tool, flange = Placement(np.eye(3), [0.1, 0.2, 0.3]), Placement()
    frames = (Frame("tool", 3, tool), Frame("same", 3, tool), Frame("flange", 2, flange), Frame("table", 0, tool))
    frames += (Frame("lamp", 1, Placement(np.eye(3), [0.0, 0.5, 0.0])),)
    found = [(one.body, *one.center.tolist(), one.radius) for one in frame_origins(replace(model, frames=frames))]
    assert found == [(1, 0, 0, 0, 0), (2, 0, 0, 0, 0), (3, 0, 0, 0, 0), (3, 0.1, 0.2, 0.3, 0), (1, 0, 0.5, 0, 0)]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: FourierBasis(5.0, 1), r"1 harmonics cannot start and stop smoothly; give two or more"),
        (lambda: SplineBasis(5.0, 1), r"1 piece of a spline cannot move; give two or more"),
        (lambda: FourierBasis(0.0), r"duration is 0\.0; give seconds above zero"),
        (lambda: Plane((0, 0, 0)), r"a plane has normal .*; give three finite numbers, not all zero"),
        (lambda: problem_of(velocity=np.inf), r"joint '.*' has no limit of velocity; give velocity=, or --velocity"),
        (lambda: problem_of(lower=3.0), r"joint '.*' may move from 3 to 2; lock it, or give other limits"),
        (lambda: problem_of(lower=2.0), r"joint '.*' may move from 2 to 2; lock it, or give other limits"),
        (lambda: problem_of(upper=np.nan), r"joint '.*' may move from .* to nan; lock it, or give other limits"),
        (lambda: problem_of(jerk=-1.0), r"a limit of jerk is -1; give numbers above zero"),
        (lambda: problem_of(acceleration=[1.0, np.nan, 2.0]), r"a limit of acceleration is nan; give numbers above"),
        (lambda: problem_of(torque=np.nan), r"a limit of torque is nan; give numbers above zero"),
        (lambda: problem_of(torque=0.0), r"a limit of torque is 0; give numbers above zero"),
        (lambda: problem_of(upper=[1.0, 2.0]), r"upper limit has shape \(2,\); give one number, or 3"),
        (lambda: replace(problem_of(), noise=np.array(0.0)), r"noise is 0\.; give one positive number, or 3"),
        (lambda: problem_of(four_bar()), r"robot '.*' has loops, which no motion is planned for yet"),
        (lambda: replace(problem_of(), rate=0.0), r"rate is 0 Hz; give one above zero"),
        (lambda: excitation_plan(problem_of().torque_model, np.eye(2)), r"the information matrix has shape \(2, 2\)"),
        (lambda: TabulatedCourse(np.arange(5.0), np.zeros((5, 2))), r"a motion of 5 rows is too short; 6 are needed"),
        (lambda: TabulatedCourse(np.zeros(7), np.zeros((7, 2))), r"the times of a motion must increase"),
        (
            lambda: TabulatedCourse(np.arange(7.0), np.full((7, 2), 1e150)),
            "reach 1e\\+150 is not computed; correct its",
        ),
        (lambda: TabulatedCourse(np.arange(7) * 1e-60, np.eye(7)), r"a motion whose positions or derivatives reach"),
        (lambda: TabulatedCourse(np.arange(7) * 5e-324, np.eye(7)), r"a motion whose positions or derivatives reach"),
        (lambda: TabulatedCourse(np.zeros(7), np.zeros((6, 2))), r"times have shape \(7,\), positions \(6, 2\)"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(InvalidInput, match=message):
        make()


def test_random_motions_that_are_nearly_still(monkeypatch):
    """Another is drawn; where all are, the largest is taken."""
    problem, scales = problem_of(), []
    model, basis = problem.torque_model.model, problem.basis
    monkeypatch.setattr(random_motions, "_largest_scale", lambda *_: scales.pop(0))

    def size(given, least):
        scales[:] = given
        rng = np.random.default_rng(0)
        return np.ptp(random_trajectory(model, problem.limits, (), basis, rng, least).coefficients[:, 1:]), len(scales)

    assert size([0.0, 0.05, 0.5], 0.0)[1] == 1
    assert size([0.0, 0.05, 0.5], 0.1)[1] == 0
    some_are_larger = [0.02, 0.06, *[0.01] * (random_motions.MAX_DRAWS - 2)]
    assert size(some_are_larger, 0.1) == (size([0.0, 0.06], 0.0)[0], 0)


def test_other_starts_of_a_seed(monkeypatch):
    """Where the search from a random motion ends without any, the next is drawn; a given start is the only one."""
    problem, tried = problem_of(), []

    def not_searched(_, start, *__):
        tried.append(start)
        return Usage("clearance", "a - b", 1.25)

    monkeypatch.setattr(optimizing, "_searched", not_searched)
    message = (
        r"from seed 2: the spheres around a - b come 2\.5 mm nearer to each other than they may; give limits of pos"
    )
    with pytest.raises(NoFeasibleMotion, match=message):
        optimized(problem, 2)
    assert len({start.coefficients.tobytes() for start in tried}) == optimizing.MAX_STARTS
    with pytest.raises(NoFeasibleMotion):
        optimized(problem, 2, start=tried[0])
    assert tried[optimizing.MAX_STARTS :] == [tried[0]]


def test_the_next_start_is_tried_where_a_search_ends_where_it_began(monkeypatch):
    """As SLSQP does where its subproblem fails at once."""
    problem, gains = problem_of(), iter([0.0, -1.0])

    def searched(_, start, seed, __):
        return OptimizedMotion(start, (), problem.value(start) + next(gains), seed, 1)

    monkeypatch.setattr(optimizing, "_searched", searched)
    found = optimized(problem, 2)
    assert found.value == problem.value(found.trajectory) - 1


def test_every_seed_starts_elsewhere(monkeypatch):
    starts = []

    def keep(problem, trajectory, *_):
        starts.append(trajectory.coefficients)
        return Usage("torque", "arm", 2.0)

    monkeypatch.setattr(optimizing, "_searched", keep)
    for seed in (0, 0, 1):
        with pytest.raises(NoFeasibleMotion):
            optimized(problem_of(), seed)
    first, again, other = starts[:2], starts[2:4], starts[4:]
    assert np.array_equal(first, again)
    assert not np.isclose(first, other).any()
    assert not np.isclose(*first).any()


def test_use_of_limits_is_how_far_from_the_middle():
    """Positions relative to half of their range, or one more than what is left to the only limit; rates by size."""
    problem = problem_of(lower=[-1.0, -np.inf, -np.inf], upper=[3.0, 0.5, np.inf], velocity=[2.0, 4.0, 5.0])
    course = Trajectory(problem.basis, np.random.default_rng(0).normal(size=(3, problem.basis.size)))
    motion = course.motion(np.linspace(0.0, 5.0, 200))
    used = {(usage.kind, usage.name): usage.used for usage in problem.usages(motion)}
    first, second, third = problem.torque_model.model.joint_names
    assert used["position", first] == pytest.approx(np.abs(motion.q[:, 0] - 1.0).max() / 2.0)
    assert used["position", second] == pytest.approx(1 + motion.q[:, 1].max() - 0.5)
    assert ("position", third) not in used
    assert [used["velocity", name] for name in (first, second, third)] == pytest.approx(
        np.abs(motion.v).max(axis=0) / [2.0, 4.0, 5.0]
    )
    assert used["jerk", first] == pytest.approx(np.abs(motion.jerk[:, 0]).max() / 60.0)


@pytest.mark.parametrize(
    ("lower", "upper", "span"),
    [(-np.inf, 0.5, (0.5 - 2 * np.pi, 0.5)), (0.5, np.inf, (0.5, 0.5 + 2 * np.pi)), (-np.inf, np.inf, (-np.pi, np.pi))],
)
def test_random_positions_without_a_limit_are_within_a_turn(lower, upper, span):
    problem, rng = problem_of(lower=lower, upper=upper, velocity=1e-3, torque=np.inf), np.random.default_rng(0)
    drawn = [
        random_trajectory(problem.torque_model.model, problem.limits, (), problem.basis, rng).motion(np.zeros(1)).q[0]
        for _ in range(15)
    ]
    assert span[0] - 0.01 < np.min(drawn) < span[0] + 0.7
    assert span[1] - 0.7 < np.max(drawn) < span[1] + 0.01


def test_random_motions_before_they_are_scaled_together_use_a_limit_of_each_joint():
    """That of the joint itself, also behind one that others drive: the nearest of its range and its rates."""
    model = mixed_tree()
    first, *_, last = model.joint_names
    model = replace(model, couplings=(Coupling(first, {last: 0.1}),))
    given = {"velocity": [0.1, 2.0, 3.0], "acceleration": [0.2, 4.0, 5.0], "jerk": [0.3, 7.0, 8.0]}
    limits = MotionLimits.of_model(model, lower=[-9.0, -1.0, -2.0], upper=[9.0, 0.5, 3.0], **given, torque=200.0)
    basis, times = FourierBasis(5.0, 3), np.linspace(0.0, 5.0, 240)
    phi = [basis.rows(times, order) for order in range(4)]
    for seed in range(5):
        moving, middle = random_motions._within_own_limits(model, limits, basis, phi, np.random.default_rng(seed))
        for row, joint in enumerate((1, 2)):
            q = phi[0] @ moving[row] + middle[row]
            rates = [
                np.abs(rows @ moving[row]).max() / most[joint]
                for rows, most in zip(phi[1:], given.values(), strict=True)
            ]
            assert max(np.ptp(q) / (limits.upper - limits.lower)[joint], *rates) == pytest.approx(1.0)
            assert q.min() >= limits.lower[joint] - ROUNDING
            assert q.max() <= limits.upper[joint] + ROUNDING


def test_random_motions_use_the_whole_range():
    """From end to end of ranges so narrow that no other limit matters; in the middle between them."""
    problem = problem_of(lower=[-0.03, 0.5, -0.2], upper=[0.01, 0.52, -0.19], jerk=np.inf)
    course = random_trajectory(
        problem.torque_model.model, problem.limits, (), problem.basis, np.random.default_rng(0)
    ).motion(np.linspace(0.0, 5.0, 240))
    assert course.q.min(axis=0) == pytest.approx([-0.03, 0.5, -0.2])
    assert course.q.max(axis=0) == pytest.approx([0.01, 0.52, -0.19])


def test_no_motion_within_limits(monkeypatch):
    """Torques too small to stand still anywhere."""
    monkeypatch.setattr(optimizing, "MAX_SEARCH_ITERATIONS", 5)
    problem = problem_of(torque=1e-3)
    with pytest.raises(
        NoFeasibleMotion,
        match=r"no motion within all limits was found from seed 4: the torque of joint. needs .* times its",
    ):
        optimized(problem, 4)


def test_nearness_is_told_in_millimeters(monkeypatch):
    """1 - (d - distance) / 10 mm = 2.5."""
    monkeypatch.setattr(optimizing, "_searched", lambda *_: Usage("clearance", "arm - base", 2.5))
    with pytest.raises(NoFeasibleMotion, match="the spheres around arm - base come 15 mm nearer to each other"):
        optimized(problem_of(), 0)


def test_torques_have_the_friction_that_the_file_states():
    """|τ + d v| + f, relative to the part of the effort that may be used."""
    model = mixed_tree()
    joints = [
        replace(joint, damping=1.0 + k, friction=3.0 - k, limits=replace(joint.limits, effort=400.0, velocity=2.0))
        for k, joint in enumerate(model.joints)
    ]
    model = replace(model, joints=tuple(joints))
    limits = MotionLimits.of_model(model, torque_share=0.5, velocity_share=0.25)
    assert (limits.torque.tolist(), limits.velocity.tolist()) == ([200.0] * 3, [0.5] * 3)
    basis = FourierBasis(5.0, 3)
    course = Trajectory(basis, np.random.default_rng(0).normal(size=(3, basis.size)))
    q, v, a, _ = motion = course.motion(np.linspace(0.0, 5.0, 200))
    damping, friction = np.array([[1.0, 2.0, 3.0], [3.0, 2.0, 1.0]])
    needed = np.abs(joint_torques(model, q, v, a) + damping * v) + friction
    used = [usage(one).used for one in signals(model, limits, (), motion) if one.kind == "torque"]
    assert used == pytest.approx(needed.max(axis=0) / 200.0)


def test_limits_are_those_stated_but_for_what_is_given():
    """Zero and less are no limits of velocities and efforts; parts are of stated ones alone."""
    model = mixed_tree()

    def limits_of(velocities, efforts, **given):
        stated = [JointLimits(-1.0 - k, None if k == 1 else 2.0 + k, velocities[k], efforts[k]) for k in range(3)]
        joints = tuple(replace(one, limits=limits) for one, limits in zip(model.joints, stated, strict=True))
        limits = MotionLimits.of_model(replace(model, joints=joints), velocity_share=0.5, torque_share=0.25, **given)
        names = ("lower", "upper", "velocity", "acceleration", "jerk", "torque")
        return [getattr(limits, name).tolist() for name in names]

    no = [np.inf] * 3
    ranges = [[-1.0, -2.0, -3.0], [2.0, np.inf, 4.0]]
    assert limits_of([2, 4, 6], [8, None, 0]) == [*ranges, [1.0, 2.0, 3.0], no, no, [2.0, np.inf, np.inf]]
    assert limits_of([2, 4, 6], [-8, 4, 2])[-1] == [np.inf, 1.0, 0.5]
    given = {"lower": -0.1, "upper": [1, 2, 3], "velocity": 7, "acceleration": 5, "jerk": [1, 2, 3], "torque": 9}
    assert limits_of([0, -1, None], [8, 8, 8], **given) == [
        [-0.1] * 3, [1, 2, 3], [7] * 3, [5] * 3, [1, 2, 3], [9] * 3
    ]  # fmt: skip
    for nothing in (0.0, -2.0, None):
        with pytest.raises(
            InvalidInput,
            match=rf"joint '{model.joint_names[1]}' has no limit of velocity; give velocity=, or --velocity",
        ):
            limits_of([2, nothing, 6], [8, 8, 8])


@pytest.mark.parametrize("rate", [30.0, 100.0, 125.0, 1000.0])
def test_the_end_of_whole_periods_is_a_sample(rate):
    """Whatever rounding makes of the duration times the rate; half a period more has no sample."""
    for count in range(1, 500):
        times = sample_times(count / rate, rate)
        assert np.array_equal(times, np.arange(count + 1) / rate)
        assert len(sample_times((count + 0.5) / rate, rate)) == count + 1
        decimal = float(f"{count / 1000:.3f}")  # as people write it
        assert len(sample_times(decimal, 1000.0)) == count + 1


def test_no_motion_is_taken_that_violates_a_limit_even_slightly(monkeypatch):
    """Nor one before the sharpest search; what is far beyond its limit is given up."""
    problem = problem_of(lower=-100.0, upper=100.0, acceleration=np.inf, jerk=np.inf, torque=np.inf)
    start = Trajectory(problem.basis, np.random.default_rng(0).normal(size=(3, problem.basis.size)))
    full = max(use.used for use in problem.usages(start.motion(sample_times(5.0, optimizing.CHECK_RATE))))
    parts, tightened = list[float](), list[float]()
    found = [replace(start, coefficients=start.coefficients * part / full) for part in (0.9, 0.999, 1.0005, 1.2, 1.31)]
    slow, allowed, slight, fast, hopeless = found
    monkeypatch.setattr(_Search, "run", lambda *_: parts.pop(0))
    monkeypatch.setattr(_Search, "tighten", lambda _, used: tightened.append(max(use.used for use in used)))

    def searched(*motions):
        parts[:] = motions
        return optimizing._searched(problem, start, 3, lambda value: None)

    taken = searched(slow, fast, slight, fast, allowed)
    assert taken.trajectory is allowed
    assert max(use.used for use in taken.usages) == pytest.approx(0.999)
    assert tightened == pytest.approx([1.0005, 1.2])
    assert searched(slow, slow, slow).trajectory is slow
    given_up = searched(slow, slow, slight, hopeless)
    assert (given_up.kind, given_up.used) == ("velocity", pytest.approx(1.31))


def test_limits_are_tightened_by_all_violations_so_far():
    """By each violation and a margin, of clearances a tenth; what was kept stays as it was."""
    search = _Search(problem_of(), lambda value: None)
    kinds = ["torque", "clearance", "jerk"]
    for used in ([1.2, 1.1, 0.9], [1.05, 0.4, 1.0], [0.8, 1.3, 1.5]):
        search.tighten([Usage(kind, "one", part) for kind, part in zip(kinds, used, strict=True)])
    assert search._allowed == pytest.approx([1 - 0.25 - 2e-4, 1 - 0.4 - 0.2, 1 - 0.5 - 1e-4], rel=1e-12)


def test_positions_use_their_range_from_its_middle():
    """0 in the middle, 1 at either end; from a single limit in radians or meters."""
    model = mixed_tree()
    limits = MotionLimits.of_model(model, lower=[-1.0, -np.inf, -np.inf], upper=[3.0, 3.0, np.inf], velocity=1.0)
    still = np.zeros((1, 3))

    def used(q):
        found = signals(model, limits, (), JointMotion(np.full((1, 3), q), still, still, still))
        return {one.name: usage(one).used for one in found if one.kind == "position"}

    first, second, _ = model.joint_names
    assert used(1.0) == {first: 0.0, second: -1.0}
    assert used(2.5) == {first: 0.75, second: 0.5}
    assert used(-1.0) == {first: 1.0, second: -3.0}
    # the third joint is at 0.1 - 0.5 · 1 while the first is at 1
    model = coupled_tree()
    limits = MotionLimits.of_model(model, lower=-1.0, upper=3.0, velocity=1.0)
    motion = JointMotion(np.array([[1.0, 2.0]]), *(np.zeros((1, 2)),) * 3)
    found = [usage(one).used for one in signals(model, limits, (), motion) if one.kind == "position"]
    assert found == pytest.approx([0.0, 0.5, 0.7])


def test_rates_use_the_limits_of_their_own_joints():
    model, ones = mixed_tree(), np.ones((1, 3))
    limits = MotionLimits.of_model(model, velocity=[1.0, 2.0, 4.0], acceleration=[2.0, 4.0, 5.0], jerk=[10.0, 4.0, 8.0])
    motion = JointMotion(0 * ones, ones, -2 * ones, 4 * ones)
    found = [(one.kind, usage(one).used) for one in signals(model, limits, (), motion) if one.kind != "position"]
    assert [used for kind, used in found if kind == "velocity"] == [1.0, 0.5, 0.25]
    assert [used for kind, used in found if kind == "acceleration"] == [1.0, 0.5, 0.4]
    assert [used for kind, used in found if kind == "jerk"] == [0.4, 1.0, 0.5]


def test_whole():
    """Plan and use of the limits of one motion, whose course is given."""
    plane = Plane((0.0, 0.6, 0.8), -3.0)
    problem = problem_of(planes=[plane])
    trajectory = Trajectory(problem.basis, 0.3 * np.random.default_rng(0).normal(size=(3, problem.basis.size)))
    motion = trajectory.motion(np.linspace(0.0, 5.0, 40))
    plan = excitation_plan(problem.torque_model, problem.total_information(trajectory))
    numbers = {name: getattr(plan, name) for name in ("names", "units", "prior", "spread", "relative", "verdicts")}
    sums = {"without": plan.without_effect, "in_sums": plan.only_in_sums, "condition": plan.condition_number}
    used = {"value": problem.value(trajectory), "usages": problem.usages(motion)}
    approve_result("excitation", {**numbers, **sums, **used})
