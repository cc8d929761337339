"""Search for the gravity that explains a recording, for a robot whose mounting is unknown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.least_squares import one_thread
from graphdyn.identification.data_quality.fits.thinning import Piece
from graphdyn.identification.data_quality.search.examined import Examined
from graphdyn.identification.data_quality.trials.refining import tried_gravity
from graphdyn.identification.data_quality.trials.trials import MIN_MISFIT_RISE
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array


class FoundGravity(NamedTuple):
    """Gravity that explains a recording best.

    gravity: in world axes                                  (3,) [m/s²]
    deviation: standard deviation of its direction          [°]
    before, after: ‖e_j‖ / ‖τ_j‖ under the gravity of the model, and under this one   (n,)
    """

    gravity: Array
    deviation: float
    before: Array
    after: Array


def found_gravity(torque_model: TorqueModel, pieces: Sequence[Piece], min_speed: ArrayLike = 0.0) -> FoundGravity:
    """Direction of gravity, and its size where that fits clearly better, with plausible inertial parameters.

    The arguments are those of assess_recording. Raises InvalidInput if no direction fits, and as assess_recording.
    """
    with one_thread():
        now = Examined.of(torque_model, pieces, min_speed)
        trials = [trial for trial in tried_gravity(now.part, -np.inf) if trial.deviation_of_size is not None]
        if not trials:
            raise InvalidInput("the torques of the recording fit no gravity; give it by --gravity X Y Z, or gravity=")
        most = max(trial.gained for trial in trials)
        best = min((t for t in trials if t.gained > most - MIN_MISFIT_RISE), key=lambda trial: trial.cad_misfit())
        assert best.change.gravity is not None
        return FoundGravity(best.change.gravity, best.deviation, now.fit.errors(now.samples.tau), best.errors)
