"""What a study simulates and measures: references, noise, errors of the model, and how errors are measured."""

from dataclasses import replace

import numpy as np
import pytest
from identified import small_study as small
from identified.small_study import ARM, study_of

from crosscheck.study.settings.design import COMMON_DRAW, RUN_ITSELF, SOURCES, Redraw, StudyDesign
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.settings.settings import ErrorSettings
from crosscheck.study.simulated import runs as records
from crosscheck.study.simulated.mechanisms import flexible
from crosscheck.study.simulated.motions import PAPER_ACCELERATION, reference
from crosscheck.study.simulated.plants import plant_of, start_near_truth, torque_model_of
from crosscheck.study.simulated.runs import known_model, simulated
from crosscheck.study.validation import validation_metric
from graphdyn import (
    Friction,
    InvalidInput,
    PDControl,
    Placement,
    gravity_torque,
    inverse_dynamics,
    joint_torques,
    mass_matrix,
    rollout,
)
from graphdyn.identification import Samples
from graphdyn.identification.terms import Coulomb, PayloadMass, RotorInertia, Viscous
from graphdyn.model import pseudo_inertia_from_parameters

EXACT = Scenario(
    robot="small",
    position_noise=0.0,
    torque_noise=0.0,
    force_noise=0.0,
    sampling_rate=500.0,
    cutoff=None,
    duration=4.0,
    min_speed=0.0,
)
ROUNDING = 1e-10
STANDSTILL = 1e-3
"""[rad/s] Dry friction holds a joint at rest with less than its Coulomb friction."""

BETWEEN = 1.01
"""Random motions are scaled at 240 points, and exceed limits by so much in between."""

DIFFERENCES = 1e-5
"""Of central differences with the step 1e-6 beside the derivative, relative to its largest value."""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings")
    (folder / "small.urdf").write_text(ARM, encoding="utf-8")
    return study_of(folder, small.STUDY, small.ROBOT + "velocity_noise = 0\n")


@pytest.fixture
def raw(monkeypatch):
    """raw(study, scenario, run): what the robot did, and its recording before the preparation."""
    kept = {}

    def keeping(name):
        original = getattr(records, name)

        def kept_too(*given):
            kept[name] = original(*given)
            return kept[name]

        monkeypatch.setattr(records, name, kept_too)

    keeping("_motion")
    keeping("_recorded")

    def both(study, scenario, run=0):
        simulated(study, scenario, study.design.draw(run))
        return kept["_motion"], kept["_recorded"]

    return both


@pytest.mark.parametrize("kind", ["random", "excited", "steps", "paper"])
def test_references(study, kind):
    """From rest, within the limits, with the derivatives that they state; the same each time, another by number."""
    plant, duration = plant_of(study.robots[0]), 2.0 if kind == "paper" else 4.0
    laws = reference(study.robots[0], 0, kind, 0, duration)
    times = np.linspace(1e-3, duration - 1e-3, 801)
    q, v, a = np.moveaxis(np.array([law(times) for law in laws]), 0, -1)
    ahead, behind = (np.moveaxis(np.array([law(times + h) for law in laws]), 0, -1) for h in (1e-6, -1e-6))
    for k, derivative in ((0, v), (1, a)):
        difference = (ahead[k] - behind[k]) / 2e-6
        assert np.abs(difference - derivative).max() < DIFFERENCES * np.abs(derivative).max()
    assert np.array([law(np.zeros(1))[1] for law in laws]) == pytest.approx(0.0, abs=1e-12)
    if kind == "paper":
        assert a[7].tolist() == [PAPER_ACCELERATION, -PAPER_ACCELERATION]
        return
    periods = [law.trajectory.basis.duration for law in laws if kind != "steps"]
    assert set(periods) <= {duration}, "a shorter recording has the whole period"
    assert np.all(np.abs(v).max(axis=0) <= plant.limits.velocity * BETWEEN)
    assert np.all(np.abs(a).max(axis=0) <= plant.limits.acceleration * BETWEEN)
    again = reference.__wrapped__(study.robots[0], 0, kind, 0, duration)
    other = reference(study.robots[0], 0, kind, 1, duration)
    assert np.array_equal([law(times)[0] for law in again], q.T)
    assert np.abs(other[0](times)[0] - q[:, 0]).max() > 0.01


def test_a_joint_that_may_not_move_leaves_the_others_their_motion(tmp_path):
    (tmp_path / "small.urdf").write_text(ARM, encoding="utf-8")
    still = study_of(tmp_path, small.STUDY, small.ROBOT + "lower = [0.5, -1]\nupper = [0.5000000001, 1]\n").robots[0]
    moved = np.ptp([law(np.linspace(0, 4, 200))[0] for law in reference(still, 0, "random", 0, 4.0)], axis=1)
    assert moved[0] < 1e-9
    assert moved[1] > 0.1
    none = replace(still, lower=(0.5, 0.5), upper=(0.5 + 1e-10, 0.5 + 1e-10))
    with pytest.raises(InvalidInput, match="no random motion found: robot 'small' cannot be held with the efforts"):
        reference(none, 0, "random", 0, 4.0)


def test_a_drive_of_one_joint_is_a_term_of_all(tmp_path):
    """Friction and a rotor that one joint has, and none that no joint has."""
    (tmp_path / "small.urdf").write_text(ARM, encoding="utf-8")
    robot = '[robot]\nname = "small.urdf"\nviscous = [0, 0.5]\nrotor_inertia = [0.2, 0]\n'
    plant = plant_of(study_of(tmp_path, small.STUDY, robot).robots[0])
    assert [type(term) for term in plant.drives] == [Viscous, RotorInertia]
    assert plant.truth(plant.known_exactly)[-4:].tolist() == [0.0, 0.5, 0.2, 0.0]


def test_a_recording_without_noise_is_the_robot(study, raw):
    """Torques and wrenches are those of the equations of motion, from the exact motion of the simulation."""
    (motion, recording), plant = raw(study, EXACT), plant_of(study.robots[0])
    exact = Samples(*motion.links, motion.tau)
    model = plant.known_exactly
    moving = np.all(np.abs(exact.v) > STANDSTILL, axis=1)
    torque = model.torque(exact, plant.truth(model))[moving]
    assert np.abs(torque - recording.tau[moving]).max() < ROUNDING * np.abs(torque).max()
    assert np.array_equal(recording.q, motion.links[0])
    assert np.array_equal(recording.joint_wrenches, inverse_dynamics(plant.model, *motion.links).joint_wrenches)


@pytest.mark.parametrize(("sampling", "control"), [(200.0, 1000.0), (500.0, 500.0), (1000.0, 200.0)])
def test_the_controller_sees_the_noise_of_the_recording(study, raw, sampling, control):
    """At its ticks the recorded torque is that of the gains, the recorded position and the reference."""
    scenario = replace(EXACT, position_noise=1e-3, sampling_rate=sampling, control_rate=control, duration=1.0)
    (motion, recording), plant = raw(study, scenario), plant_of(study.robots[0])
    ticks = slice(None, None, max(1, round(sampling / control)))
    laws = reference(study.robots[0], 0, "random", 0, 1.0, study.design.draw(0).motion)
    q_d, v_d, _ = np.moveaxis(np.array([law(recording.t[ticks]) for law in laws]), 0, -1)
    expected = plant.position_gain * (q_d - recording.q[ticks]) + plant.velocity_gain * (v_d - motion.links[1][ticks])
    assert np.abs(expected - recording.tau[ticks]).max() < ROUNDING * np.abs(expected).max()
    noise = recording.q - motion.links[0]
    assert np.std(noise) == pytest.approx(1e-3, rel=0.15)
    assert abs(np.corrcoef(noise[1:, 0], noise[:-1, 0])[0, 1]) < 0.25


def test_every_run_and_sensor_has_noise_of_its_own(study, raw):
    """Standard normal where it is divided by its deviation; all correlations below five of their own, 1 / √N."""
    scenario = replace(EXACT, position_noise=1e-4, torque_noise=0.2, force_noise=0.5, duration=1.0)
    plant, found = plant_of(study.robots[0]), []
    held = replace(study, design=StudyDesign(vary=("noise",)))
    for run in (0, 1, 0):
        motion, recording = raw(held, scenario, run)
        wrenches = recording.joint_wrenches - inverse_dynamics(plant.model, *motion.links).joint_wrenches
        noises = (recording.q - motion.links[0]) / 1e-4, (recording.tau - motion.tau) / 0.2
        found.append([*noises, wrenches[:, :, 1] / 0.5, wrenches[:, :, 4] / 0.2])
    assert all(np.allclose(first, again) for first, again in zip(found[0], found[2], strict=True))
    columns = np.column_stack([*found[0], *found[1]])
    bound = 5 / np.sqrt(len(columns))
    assert np.std(columns, axis=0) == pytest.approx(1.0, abs=bound / np.sqrt(2))
    assert np.abs(np.corrcoef(columns.T) - np.eye(16)).max() < bound


def test_errors_of_the_model(study, raw):
    """Each is in the recording or in the torque model, and nowhere else."""
    errors = replace(study, errors=ErrorSettings(torque_factor=(1.1, 1.0), payload_mass=0.5))
    short = replace(EXACT, duration=1.0)
    none, gear, payload = (raw(errors, replace(short, model_error=error)) for error in ("none", "gear", "payload"))
    assert np.array_equal(gear[1].q, none[1].q)
    assert np.array_equal(gear[1].tau, none[1].tau * [1.1, 1.0])
    load, plant = PayloadMass((0.0, 0.0, 0.1)), plant_of(errors.robots[0])
    heavier = plant.model.with_inertial_parameters(
        plant.model.inertial_parameters + load.inertial_parameters(plant.model, np.array([0.5]))
    )
    rigid = joint_torques(heavier, *payload[0].links) - joint_torques(plant.model, *payload[0].links)
    model = plant.known_exactly
    known = model.torque(Samples(*payload[0].links, payload[0].tau), plant.truth(model))
    moving = np.all(np.abs(payload[0].links[1]) > STANDSTILL, axis=1)
    assert np.abs(known + rigid - payload[1].tau)[moving].max() < ROUNDING * np.abs(known).max()
    forgets = known_model(errors, replace(EXACT, model_error="friction"))
    assert not any(isinstance(term, Coulomb) for term in forgets.terms)
    assert len(forgets.columns) == len(known_model(errors, EXACT).columns) - 2


def test_a_controller_with_other_gains(study, raw):
    """Its torque is that of the true gains; the loop that the identification knows has the others."""
    scenario, plant = replace(EXACT, duration=1.0, model_error="gains"), plant_of(study.robots[0])
    (motion, recording) = raw(replace(study, errors=ErrorSettings(gain_factor=(1.2, 0.9))), scenario)
    laws = reference(study.robots[0], 0, "random", 0, 1.0, study.design.draw(0).motion)
    q_d, v_d, _ = np.moveaxis(np.array([law(recording.t) for law in laws]), 0, -1)
    known = plant.position_gain * (q_d - motion.q) + plant.velocity_gain * (v_d - motion.links[1])
    assert recording.tau == pytest.approx(np.array([1.2, 0.9]) * known, abs=ROUNDING * np.abs(known).max())
    record = simulated(study, scenario, study.design.draw(0))
    assert np.array_equal(record.loop.controller.position_gain, plant.position_gain)


def test_torques_that_act_late(study, raw):
    """By one control period, which is that of the samples here."""
    scenario, plant = replace(EXACT, duration=1.0, control_rate=500.0, model_error="delay"), plant_of(study.robots[0])
    motion, recording = raw(study, scenario)
    laws = reference(study.robots[0], 0, "random", 0, 1.0, study.design.draw(0).motion)
    q_d, v_d, _ = np.moveaxis(np.array([law(recording.t) for law in laws]), 0, -1)
    commanded = plant.position_gain * (q_d - motion.q) + plant.velocity_gain * (v_d - motion.links[1])
    assert recording.tau[1:] == pytest.approx(commanded[:-1], abs=ROUNDING * np.abs(commanded).max())


def test_encoders_and_currents_in_steps(study, raw):
    """The recording has whole steps, and the controller sees those of the positions."""
    steps = ErrorSettings(position_step=1e-3, torque_step=0.25)
    scenario = replace(EXACT, duration=1.0, control_rate=500.0, model_error="quantized")
    (motion, recording), plant = raw(replace(study, errors=steps), scenario), plant_of(study.robots[0])
    for values, step in ((recording.q, 1e-3), (recording.tau, 0.25)):
        assert np.abs(values / step - np.rint(values / step)).max() < 1e-9
    assert 0 < np.abs(recording.q - motion.links[0]).max() <= 0.5e-3 * (1 + 1e-9)
    laws = reference(study.robots[0], 0, "random", 0, 1.0, study.design.draw(0).motion)
    q_d, v_d, _ = np.moveaxis(np.array([law(recording.t) for law in laws]), 0, -1)
    seen = plant.position_gain * (q_d - recording.q) + plant.velocity_gain * (v_d - motion.links[1])
    assert motion.tau == pytest.approx(seen, abs=1e-9 * np.abs(seen).max())


@pytest.mark.parametrize(("error", "near"), [("stribeck", 0.02), ("lugre", 0.15)])
def test_dry_friction_of_other_laws(study, raw, error, near):
    """Once a joint slides, the torque beside bodies and viscous friction is that of the curve; bristles lag behind."""
    scenario, plant = replace(EXACT, duration=2.0, model_error=error), plant_of(study.robots[0])
    motion, recording = raw(replace(study, errors=ErrorSettings(breakaway=2.0, stribeck_velocity=0.2)), scenario)
    q, v, a = motion.links
    rigid = joint_torques(plant.model, q, v, a) + plant.rotors * a + plant.friction.viscous * v
    curve = plant.friction.coulomb * (1 + 1 / (1 + (v / 0.2) ** 2)) * np.sign(v)
    sliding = np.abs(v) > 0.1
    assert np.median(np.abs(recording.tau - rigid - curve)[sliding]) < near * plant.friction.coulomb[0]
    assert np.abs(recording.tau - rigid)[~sliding].max() > 1.2 * plant.friction.coulomb[0], "it breaks away"


def test_efforts_that_allow_no_motion_are_told(tmp_path):
    """In place of a robot that stands still, and of a held-out motion that shows nothing."""
    weak = ARM.replace("<axis", '<limit effort="0.1" velocity="1"/><axis')
    (tmp_path / "small.urdf").write_text(weak, encoding="utf-8")
    weak_study = study_of(tmp_path, small.STUDY, small.ROBOT)
    with pytest.raises(InvalidInput, match="no random motion found: robot 'small' cannot be held with the efforts"):
        reference(weak_study.robots[0], 0, "random", 0, 4.0)


@pytest.mark.parametrize(("rotor", "damping"), [(1e-4, 0.0), (1e-3, 0.5), (10.0, 0.02)])
def test_springs_are_simulated_with_steps_that_are_short_enough(study, rotor, damping):
    """Bent and let go, light and heavy rotors swing no further than they were bent."""
    plant = replace(plant_of(study.robots[0]), rotors=np.full(2, rotor), friction=Friction(np.zeros(2), np.zeros(2)))
    mechanism = flexible(plant, ErrorSettings(joint_stiffness=2e4, joint_damping=damping))
    bent = np.array([0.0, 1e-3, 0.0, -1e-3])
    run = rollout(
        mechanism.model, bent, np.zeros(4), None, step=mechanism.longest_step, duration=500 * mechanism.longest_step,
        parameters=mechanism.parameters(plant.model.inertial_parameters), rotor_inertia=mechanism.rotors,
        limits=mechanism.springs,
    )  # fmt: skip
    assert np.abs(run.q[0, :, 1::2]).max() < 5e-3


def test_loops_and_springs_are_damped_as_told(study):
    """Each joint alone, λ² + d/m λ + k/m = 0: the loop twice at -30 rad/s, the spring as damped as asked for."""
    plant, errors = plant_of(study.robots[0]), ErrorSettings(joint_stiffness=(300.0, 200.0), joint_damping=0.3)
    inertia, springs = np.diag(mass_matrix(plant.model, np.zeros(2))), flexible(plant, errors).springs
    for j, link in enumerate(inertia):
        moved = link + plant.rotors[j]
        poles = np.roots([1.0, plant.velocity_gain[j] / moved, plant.position_gain[j] / moved])
        assert poles == pytest.approx([-30.0, -30.0], rel=1e-6)
        pole = np.roots([1.0, springs.damping[2 * j + 1] / link, springs.stiffness[2 * j + 1] / link])[0]
        assert (abs(pole), -pole.real / abs(pole)) == pytest.approx((np.sqrt(errors.joint_stiffness[j] / link), 0.3))


def test_slow_rows_are_left_out(study):
    record = simulated(study, replace(EXACT, min_speed=0.2), COMMON_DRAW)
    fast = np.abs(record.recording.channel("v")) >= 0.2
    assert record.problem.equations.counts.tolist() == fast.sum(axis=0).tolist()
    assert not fast.all()


def test_each_source_is_drawn_by_itself(study):
    """Runs share what does not vary; a redraw changes one source, and scenarios share all of them but sizes."""
    scenario = replace(EXACT, position_noise=1e-6, torque_noise=0.1, duration=1.0, cad_error=0.15, start="0.15")

    def drawn(scenario, design, run, redraw=RUN_ITSELF):
        draw = design.draw(run, redraw)
        record = simulated(replace(study, design=design), scenario, draw)
        laws = reference(study.robots[0], study.seed, scenario.motion, 0, 1.0, draw.motion)
        motion = np.array([law(np.array([0.37]))[0] for law in laws])
        masses = [body.mass for body in record.problem.torque_model.model.bodies]
        return {"noise": record.recording.channel("tau")[0], "motion": motion, "cad": masses, "start": record.start}

    def changed(one, other):
        return {name for name in SOURCES if not np.array_equal(one[name], other[name])}

    first = drawn(scenario, StudyDesign(), 0)
    for source in SOURCES:
        design = StudyDesign(vary=(source,), repeats=2)
        assert [one.source for one in design.redraws] == [None, source]
        none, other, again = (drawn(scenario, design, *of) for of in ((0,), (1,), (0, Redraw(source, 1))))
        assert changed(none, other) - {"noise"} == changed(none, again) - {"noise"} == {source} - {"noise"}
        assert ("noise" in changed(none, other)) == (source in ("noise", "motion")), "torques follow the motion"
    louder = drawn(replace(scenario, torque_noise=0.2), StudyDesign(), 0)
    assert changed(first, louder) == {"noise"}


def test_starts_are_off_in_every_parameter_and_could_be_real(study):
    """Of 200 draws: independent normal errors of 15 % in drives, and in parameters of bodies far from their bounds."""
    plant, model = plant_of(study.robots[0]), torque_model_of(study.robots[0], 0, 0.0, True)
    truth = plant.truth(model)
    starts = np.array([start_near_truth(plant, model, 0, 0.15, (run, 0)) for run in range(200)])
    off = starts[:, truth != 0] / truth[truth != 0] - 1
    assert np.std(off[:, -5:], axis=0) == pytest.approx(0.15, rel=0.2)
    assert np.all(np.std(off, axis=0) > 0.05)
    assert np.abs(np.corrcoef(off[:, -5:].T) - np.eye(5)).max() < 0.3
    bodies = starts[:, : model.model.n_bodies * 10].reshape(-1, 10)
    assert np.linalg.eigvalsh(pseudo_inertia_from_parameters(bodies)).min() > 0
    assert not np.any(starts[:, truth == 0])


def test_a_start_of_which_no_body_could_be_real(study):
    plant = plant_of(study.robots[0])
    flat = plant.model.inertial_parameters.copy()
    flat[4:10] *= 1e-9
    unreal = replace(plant, model=plant.model.with_inertial_parameters(flat))
    with pytest.raises(InvalidInput, match=r"start = 0.15 .* of 100000 bodies near 'upper', none could be real"):
        start_near_truth(unreal, torque_model_of(study.robots[0], 0, 0.0, True), 0, 0.15, (0, 0))


def test_every_study_has_cad_of_its_own(study):
    """Of masses that are off by at most the error, the same in all runs."""
    first, again, other = (torque_model_of(study.robots[0], seed, 0.15, True).model for seed in (3, 3, 4))
    masses = [[body.mass for body in model.bodies] for model in (first, again, other)]
    assert masses[0] == masses[1]
    assert not np.any(np.equal(masses[0], masses[2]))
    assert np.abs(np.divide(masses, [2.5, 1.5]) - 1).max() <= 0.15


def test_springs_hang_by_what_gravity_asks(study):
    """Held at a pose, a spring of stiffness k is bent by τ / k, and the motors carry what the rigid robot asks: hung
    upside down."""
    plant, errors = plant_of(study.robots[0]), ErrorSettings(joint_stiffness=(300.0, 200.0), joint_damping=0.5)
    plant = replace(plant, model=plant.model.with_base(Placement(np.diag([1.0, -1.0, -1.0]))))
    mechanism, q = flexible(plant, errors), np.array([0.4, -0.7])
    hold = mechanism.controlled(PDControl(plant.position_gain * 50, plant.velocity_gain * 5, q, period=1e-3))
    hold = replace(hold, target=mechanism.of_motors(q))
    run = rollout(
        mechanism.model, mechanism.of_motors(q), np.zeros(4), hold, step=5e-4, duration=8.0,
        parameters=mechanism.parameters(plant.model.inertial_parameters), rotor_inertia=mechanism.rotors,
        limits=mechanism.springs, every=100,
    )  # fmt: skip
    end = run.q[0, -1:]
    gravity = gravity_torque(plant.model, mechanism.links(end))[0]
    assert end[0, 1::2] == pytest.approx(-gravity / np.array([300.0, 200.0]), rel=1e-4)
    assert mechanism.motors(run.tau[0, -1:])[0] == pytest.approx(gravity, rel=1e-4)


def test_validation_metric(study):
    """Zero at the truth; a tenth in all parameters is a tenth in parameters and torque; nonsense runs away."""
    torque_model = torque_model_of(study.robots[0], study.seed, 0.15, True)
    measure = validation_metric(study.robots[0], study.seed, torque_model)
    assert [measure.parameter_error(measure.truth), measure.torque_error(measure.truth)] == pytest.approx(
        [0, 0], abs=1e-12
    )
    assert measure.trajectory_error(measure.truth) == pytest.approx(0, abs=1e-9)
    wrong = 1.1 * measure.truth
    assert measure.parameter_error(wrong) == pytest.approx(0.1)
    assert measure.torque_error(wrong) == pytest.approx(0.1)
    alone = measure.truth + 1e-3 * np.eye(len(measure.truth))
    effects = np.array([(measure.parameter_error(x), measure.torque_error(x)) for x in alone])
    assert effects[:, 0] / effects[0, 0] == pytest.approx(effects[:, 1] / effects[0, 1]), "as far as torques show it"
    assert 1e-6 < measure.trajectory_error(wrong) < 0.1
    assert measure.trajectory_error(-measure.truth) is None
    away = replace(measure, followed=measure.followed + np.array([0.03, -0.04]))
    size = np.sqrt(measure.followed.var(axis=0).sum())
    assert away.trajectory_error(measure.truth) == pytest.approx(0.05 / size), "relative to what the robot moves"


def test_dry_friction_that_is_forgotten_is_an_error_of_the_torque(study):
    """The robot has it all the same."""
    measure = validation_metric(study.robots[0], study.seed, torque_model_of(study.robots[0], study.seed, 0.0, False))
    everything = validation_metric(study.robots[0], study.seed, torque_model_of(study.robots[0], study.seed, 0.0, True))
    assert np.array_equal(measure.torque, everything.torque)
    assert measure.parameter_error(measure.truth) == 0.0
    assert measure.torque_error(measure.truth) > 0.01
