"""A simulated robot with friction that follows an exciting motion."""

import numpy as np

from graphdyn import ComputedTorqueControl, Friction, simulate
from graphdyn.identification import Samples
from graphdyn.motion_laws import FourierSeries

STEP = 1e-3
"""[s] Of the simulation."""

STIFFNESS = 80.0
"""[rad/s] Natural frequency of the controller, critically damped."""

AT_REST = 1e-3
"""[rad/s or m/s] Below it dry friction is not that of the torque model: at the start it holds the joints."""


def followed(problem, trajectory, viscous, coulomb):
    """Under computed torque: what sensors without errors would record at problem.rate."""
    model = problem.torque_model.model
    laws = [FourierSeries(1 / trajectory.duration, *trajectory.basis.series(row)) for row in trajectory.coefficients]
    start = trajectory.motion(np.zeros(1))
    motion = simulate(
        model,
        start.q[0],
        start.v[0],
        trajectory.duration,
        torque=ComputedTorqueControl(STIFFNESS**2, 2 * STIFFNESS, laws),
        method="rk4",
        step=STEP,
        at=np.arange(round(problem.samples)) / problem.rate,
        friction=Friction(viscous, coulomb),
    )
    return Samples(motion.q, motion.v, motion.a, motion.tau)
