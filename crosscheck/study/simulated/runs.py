"""One simulated recording: the robot in its control loop, measured with noise, and the errors of its model.

Scenarios of a run share what they can: motion, errors of the CAD model, start, and the noise up to its size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.identifying import Preparation
from crosscheck.recordings import Provenance, Recording
from crosscheck.study.settings.configuration import Configuration
from crosscheck.study.settings.design import COMMON_DRAW, Draw
from crosscheck.study.settings.scenarios import NORMAL, Scenario
from crosscheck.study.simulated.mechanisms import mechanism_of
from crosscheck.study.simulated.motions import reference, start_of
from crosscheck.study.simulated.own_code import own
from crosscheck.study.simulated.plants import ControlledRobot, plant_of, start_near_truth, torque_model_of
from graphdyn import InvalidInput, MeasurementNoise, inverse_dynamics, rollout
from graphdyn.identification import ClosedLoop, Problem, TorqueModel
from graphdyn.identification.terms import PayloadMass
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.motion_laws import MotionLaw

NOISE_STREAM = 3
"""Number of a random stream of a study, beside those of CAD model, motion and start."""

PLANT_STEPS = 2
"""The robot takes so many steps, of another method (rk8), for one of the simulated loops of identification (rk4)."""

QUOTIENT_TOLERANCE = 1e-9
"""A quotient this little above a whole number is one."""


@dataclass(frozen=True, eq=False)
class SimulatedMotion:
    """What a simulated robot did at the times of the samples (N,) [s].

    q: positions of the motors as measured; tau: of the actuators; links: q, v, a of the links, exact   (N, n)
    """

    time: Array
    q: Array
    tau: Array
    links: tuple[Array, Array, Array]


@dataclass(frozen=True, eq=False)
class RecordedProblem:
    """The problem of one recording, the same for all methods.

    recording: as prepared; loop: in which it was made, as the identification knows it
    truth: parameters of the torque model (p,)
    start: of iterations, where the scenario has one of its own (p,)
    """

    problem: Problem
    recording: Recording
    loop: ClosedLoop
    truth: Array
    start: Array | None = None


def known_model(study: Configuration, scenario: Scenario, draw: Draw = COMMON_DRAW) -> TorqueModel:
    """What the identification knows of the robot in a scenario."""
    return torque_model_of(
        study.robot_of(scenario), study.seed, scenario.cad_error, scenario.model_error != "friction", draw.cad
    )


def simulated(study: Configuration, scenario: Scenario, draw: Draw) -> RecordedProblem:
    """The record of a scenario with these random numbers.

    Raises InvalidInput where the loop does not hold the robot, where the limits allow no motion, and where the filter
    leaves no row.
    """
    robot = study.robot_of(scenario)
    plant = plant_of(robot)
    laws = reference(
        robot, study.seed, study.located(scenario.motion), scenario.motion_seed, scenario.duration, draw.motion
    )
    controller = plant.controller(laws, scenario.control_period)
    of_positions, *of_sensors = np.random.SeedSequence([study.seed, NOISE_STREAM, *draw.noise]).spawn(3)
    motion = _motion(study, plant, laws, scenario, int(of_positions.generate_state(1, np.uint64)[0]))
    recording = _recorded(study, plant, motion, scenario, of_sensors)
    hold = min(scenario.period, scenario.control_period)
    preparation = Preparation(scenario.cutoff, min_speed=scenario.min_speed, torque_hold=hold)
    prepared, known = preparation.differentiated(recording), known_model(study, scenario, draw)
    loop = ClosedLoop(controller, torque_hold=hold, differentiation=preparation.differentiation(recording))
    error = scenario.start_error
    start = None if error is None else start_near_truth(plant, known, study.seed, error, draw.start)
    return RecordedProblem(preparation.problem(known, prepared), prepared, loop, plant.truth(known), start)


def _motion(
    study: Configuration, plant: ControlledRobot, laws: Sequence[MotionLaw], scenario: Scenario, seed: int
) -> SimulatedMotion:
    """The controller sees positions with the noise that is in the recording, and velocities with noise of their own."""
    errors = study.errors
    mechanism = mechanism_of(plant, errors, scenario.model_error)
    shortest = min(scenario.period, scenario.control_period)
    step = shortest / np.ceil(shortest / mechanism.longest_step - QUOTIENT_TOLERANCE) / PLANT_STEPS
    q, v = start_of(laws)
    parameters = plant.model.inertial_parameters
    if scenario.model_error == "payload":
        load = PayloadMass(errors.payload_center)
        parameters = parameters + load.inertial_parameters(plant.model, np.array([errors.payload_mass]))
    quantum = np.asarray(errors.position_step) if scenario.model_error == "quantized" else 0.0
    noise = MeasurementNoise(
        *(mechanism.of_motors(size) for size in (scenario.position_noise, plant.velocity_noise, quantum))
    )
    controller = mechanism.controlled(plant.controller(laws, scenario.control_period))
    if scenario.model_error == "gains":
        factor = np.asarray(errors.gain_factor)
        gains = {name: factor * getattr(controller, name) for name in ("position_gain", "velocity_gain")}
        controller = replace(controller, **gains)
    run = rollout(
        mechanism.model,
        mechanism.of_motors(q),
        mechanism.of_motors(v),
        controller,
        step=step,
        duration=scenario.duration,
        parameters=mechanism.parameters(parameters),
        friction=mechanism.friction,
        rotor_inertia=mechanism.rotors,
        limits=mechanism.springs,
        bristles=mechanism.bristles,
        method="rk8",
        noise=noise,
        seed=seed,
        late=scenario.model_error == "delay",
        every=round(scenario.period / step),
        threads=1,
    )
    motors = mechanism.motors(run.q[0])
    q_l, v_l, a_l = (mechanism.links(array[0]) for array in (run.q, run.v, run.a))
    if not all(np.all(np.isfinite(array)) for array in (motors, q_l, v_l, a_l)):
        raise InvalidInput("the controller does not hold the robot: it runs away; give other gains, or a higher rate")
    measured = motors + mechanism.motors(_seen(scenario, noise, seed, len(motors)))
    if scenario.model_error == "quantized":
        measured = np.rint(measured / quantum) * quantum
    return SimulatedMotion(run.time, measured, mechanism.motors(run.tau[0]), (q_l, v_l, a_l))


def _seen(scenario: Scenario, noise: MeasurementNoise, seed: int, samples: int) -> Array:
    """Noise of the positions (N, m) at the samples: at the ticks of the controller what it sees, drawn as rollout does.

    Samples between two ticks have noise of their own.
    """
    deviations = np.asarray(noise.position)
    m, ratio = len(deviations), scenario.sampling_rate / scenario.control_rate
    ticks = int(np.ceil(samples / ratio)) + 1
    generator = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(0,)))
    at_ticks = generator.standard_normal((ticks, 2 * m))[:, :m] * deviations
    if ratio <= 1:
        return np.asarray(at_ticks[:: round(1 / ratio)][:samples])
    drawn = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1,))).standard_normal((samples, m))
    drawn *= deviations
    drawn[:: round(ratio)] = at_ticks[: len(drawn[:: round(ratio)])]
    return drawn


def _recorded(
    study: Configuration,
    plant: ControlledRobot,
    motion: SimulatedMotion,
    scenario: Scenario,
    seeds: Sequence[np.random.SeedSequence],
) -> Recording:
    """The recording with noise of the torques and, if they are measured, of the wrenches."""
    torques, wrenches = (np.random.default_rng(seed) for seed in seeds)
    factor = np.asarray(study.errors.torque_factor) if scenario.model_error == "gear" else 1.0
    noise = scenario.torque_noise * _drawn(study, scenario, torques, motion.tau)
    tau = factor * motion.tau + _beyond_the_model(study, scenario, motion) + noise
    if scenario.model_error == "quantized":
        tau = np.rint(tau / study.errors.torque_step) * study.errors.torque_step
    measured = None
    if scenario.force_noise is not None:
        measured = np.array(inverse_dynamics(plant.model, *motion.links, method="reproducible").joint_wrenches)
        drawn = wrenches.standard_normal(measured.shape)
        measured[..., LINEAR] += scenario.force_noise * drawn[..., LINEAR]
        measured[..., ANGULAR] += scenario.torque_noise * drawn[..., ANGULAR]
    return Recording(
        joint_names=plant.model.joint_names,
        prismatic=tuple(joint.is_prismatic for joint in plant.model.joints),
        t=motion.time,
        q=motion.q,
        tau=tau,
        joint_wrenches=measured,
        provenance=Provenance((f"run of scenario {scenario.name}",), "simulation"),
    )


def _beyond_the_model(study: Configuration, scenario: Scenario, motion: SimulatedMotion) -> Array:
    """Torques (N, n) of an own error of the model, zero where there is none. Raises InvalidInput as _drawn."""
    if ":" not in scenario.model_error:
        return np.zeros_like(motion.tau)
    links = (array.copy() for array in motion.links)
    return _checked(scenario.model_error, "torques", own(study.located(scenario.model_error))(*links), motion.tau)


def _drawn(study: Configuration, scenario: Scenario, rng: np.random.Generator, tau: Array) -> Array:
    """Noise of the torques with a standard deviation of one. Raises InvalidInput for an own law that is none."""
    if scenario.torque_noise_law == NORMAL:
        return rng.standard_normal(tau.shape)
    law = own(study.located(scenario.torque_noise_law))
    return _checked(scenario.torque_noise_law, "noise", law(rng, tau.copy()), tau)


def _checked(name: str, what: str, given: object, tau: Array) -> Array:
    """What own code gives, as numbers of the shape of the torques."""
    found = np.asarray(given, dtype=float)
    if found.shape != tau.shape or not np.all(np.isfinite(found)):
        raise InvalidInput(f"{name} gives {what} of shape {found.shape}; {tau.shape} is needed, finite")
    return found
