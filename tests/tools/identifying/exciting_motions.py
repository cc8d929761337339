"""What exciting motions are worth: python tests/tools exciting_motions [gain] [collisions] [limits DIR] [promise].

gain: the UR5, 10 s, 5 harmonics, 0.95 of its velocities, 10 rad/s², 0.8 of its torques, 48 columns: standard deviations
      of five seeds beside those of the best of 100 random motions, for equal noise of all torques and for 1 % of the
      efforts; processor time
collisions: the same for 1 N m, links kept from hitting each other: poses at 1 kHz in which meshes collide, without and
      with that; standard deviations beside those of the best random motion without collisions, of 100 drawn without
      regard to them, and of 100 made as large as the balls around the links allow; of other seeds if numbers follow
limits: every robot of a folder whose limits of velocity are known: the largest part of a limit that is used at 1 kHz,
      and the poses in which links collide where there are meshes
promise: the UR5 with friction follows the motion of one seed; 100 recordings with noise are identified, and the scatter
      of the parameters is compared with what the plan promised
"""

import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from identified.excited_robot import AT_REST, followed

import urdf
from crosscheck.exciting.mesh_contacts import link_meshes
from crosscheck.exciting.self_collision import collision_free, self_collision
from graphdyn import GraphDynError
from graphdyn.excitation import (
    ExcitationProblem,
    FourierBasis,
    MotionLimits,
    excitation_plan,
    log_det,
    mean_sigma,
    optimized,
    random_trajectory,
    sample_times,
)
from graphdyn.identification import Problem, TorqueModel, WeightedLeastSquares
from graphdyn.identification.algebra.least_squares import one_thread
from graphdyn.identification.terms import Coulomb, RigidBodies, Viscous

RATE = 250.0
"""[Hz] Of the recordings."""

RUNS, RANDOM, SEEDS = 100, 100, 5

FRICTION = 0.02
"""Viscous and Coulomb friction of every joint of the simulated robot, as a part of its effort [s/rad, -]."""


def problem_of(model, noise):
    limits = MotionLimits.of_model(model, velocity_share=0.95, acceleration=10.0, torque_share=0.8)
    torque_model = TorqueModel(model, (RigidBodies(), Viscous(), Coulomb()))
    return ExcitationProblem(torque_model, limits, FourierBasis(10.0, 5), noise, RATE)


def gain():
    model = urdf.load("ur5")
    effort = np.array([joint.limits.effort for joint in model.joints])
    for words, noise in (("1 N m", np.ones(6)), ("1 % of the efforts", 0.01 * effort)):
        problem = problem_of(model, noise)
        best = {}
        with one_thread():
            motions = [random_of(problem, k) for k in range(RANDOM)]
            for name, criterion in (("gm σ", mean_sigma), ("det", log_det)):
                best[name] = min(criterion(problem.total_information(motion))[0] for motion in motions)
        print(f"noise {words}; {len(problem.information.independent)} columns")
        for seed in range(SEEDS):
            start = time.process_time()
            found = optimized(problem, seed)
            spent = time.process_time() - start
            information = problem.total_information(found.trajectory)
            ratio = np.exp(best["gm σ"] - mean_sigma(information)[0])
            volume = np.exp(best["det"] - log_det(information)[0])
            print(
                f"  seed {seed}: geometric mean σ {ratio:.3f} × smaller than best of {RANDOM}, mean half axis "
                f"{volume:.3f} ×; {found.iterations} iterations, {spent:.1f} CPU s"
            )


def random_of(problem, seed):
    rng = np.random.default_rng(seed)
    return random_trajectory(problem.torque_model.model, problem.limits, problem.checked_spheres, problem.basis, rng)


def collisions(seeds):
    model = urdf.load("ur5")
    start = time.process_time()
    known = collisions_of("ur5", model)
    problem = problem_of(model, np.ones(6))
    print(
        f"{len(known.meshes)} links, {sum(map(len, known.balls))} balls, {len(known.pairs)} pairs; always colliding: "
        f"{', '.join(known.touching) or 'none'}; {time.process_time() - start:.1f} CPU s"
    )
    best = {}
    for words, drawn in (("of any", problem), ("within the balls", known.with_limits(problem))):
        with one_thread():
            motions = [random_of(drawn, k) for k in range(RANDOM)]
        free = [motion for motion in motions if not known.hits(motion.motion(sample_times(10.0, 1000.0)).q)]
        best[words] = min(mean_sigma(problem.total_information(motion))[0] for motion in free) if free else np.inf
        print(f"{RANDOM} random motions {words}: {len(free)} without collisions", flush=True)
    for seed in seeds:
        regardless = known.hits(optimized(problem, seed).trajectory.motion(sample_times(10.0, 1000.0)).q)
        start = time.process_time()
        try:
            found = collision_free(problem, known, seed)
        except GraphDynError as error:
            print(f"  seed {seed}: {error}; {time.process_time() - start:.1f} CPU s", flush=True)
            continue
        spent = time.process_time() - start
        hits = known.hits(found.trajectory.motion(sample_times(10.0, 1000.0)).q)
        sigma = mean_sigma(problem.total_information(found.trajectory))[0]
        ratios = ", ".join(f"{np.exp(value - sigma):.2f} × ({words})" for words, value in best.items())
        print(
            f"  seed {seed}: {sum(hit.poses for hit in hits)} collisions ({sum(hit.poses for hit in regardless)} "
            f"regardless of them); mean σ smaller than the best random motion's: {ratios}; {spent:.1f} CPU s",
            flush=True,
        )


def collisions_of(robot, model):
    meshes, missing = link_meshes(str(robot), model, urdf.Reading())
    return self_collision(model, meshes, missing, 0.0)


def limits(folder):
    for path in sorted(Path(folder).glob("*.urdf")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = urdf.load(path)
        start = time.process_time()
        try:
            known = collisions_of(path, model)
            found = collision_free(problem_of(model, np.ones(model.nv)), known, 0)
        except GraphDynError as error:
            print(f"{path.name}: {error}")
            continue
        hits = known.hits(found.trajectory.motion(sample_times(10.0, 1000.0)).q)
        most = max((usage for usage in found.usages if usage.kind != "clearance"), key=lambda usage: usage.used)
        print(
            f"{path.name}: {100 * most.used:.3f} % ({most.kind} of {most.name}) of {len(found.usages)} limits; "
            f"{sum(hit.poses for hit in hits)} collisions of {len(known.pairs)} pairs; "
            f"{time.process_time() - start:.1f} CPU s",
            flush=True,
        )


def promise():
    model = urdf.load("ur5")
    noise = 0.01 * np.array([joint.limits.effort for joint in model.joints])
    problem = problem_of(model, noise)
    trajectory = optimized(problem).trajectory
    friction = FRICTION * np.array([joint.limits.effort for joint in model.joints])
    exact = followed(problem, trajectory, friction, friction)
    plan = excitation_plan(problem.torque_model, problem.total_information(trajectory))
    truth = np.concatenate([model.inertial_parameters, friction, friction])
    found, rng = [], np.random.default_rng(0)
    for _ in range(RUNS):
        noisy = replace(exact, tau=exact.tau + noise * rng.normal(size=exact.tau.shape))
        fit = Problem(problem.torque_model, noisy, min_speed=AT_REST)
        found.append(fit.base.values(WeightedLeastSquares().estimate(fit).parameters))
    errors = np.array(found) - plan.base.values(truth)
    ratios = np.sqrt(np.mean(errors**2, axis=0)) / plan.sigma
    squares = np.einsum("ri,ij,rj->r", errors, plan.information, errors)
    print(f"{RUNS} recordings of {len(exact)} samples, {len(ratios)} parameters, found σ / promised σ:")
    print(f"  geometric mean {np.exp(np.log(ratios).mean()):.3f}, from {ratios.min():.3f} to {ratios.max():.3f}")
    print(f"  χ² per run and parameter {squares.mean() / len(ratios):.3f}")


def main():
    arguments = sys.argv[1:]
    if not arguments or arguments[0] == "gain":
        gain()
    if not arguments or arguments[0] == "promise":
        promise()
    if arguments[:1] == ["collisions"]:
        collisions([int(seed) for seed in arguments[1:]] or range(SEEDS))
    if arguments[:1] == ["limits"]:
        limits(arguments[1])
