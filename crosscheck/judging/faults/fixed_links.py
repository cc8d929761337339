"""Links on fixed joints whose mass is left out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from crosscheck.judging.faults.changes import named, with_parameters
from crosscheck.judging.faults.fault import Fault
from graphdyn import RobotModel
from graphdyn.layout import Array, parameter_columns


def fixed_links(model: RobotModel, links: Mapping[str, tuple[int, Array]]) -> Iterator[Fault]:
    heavy = [name for name, (_, share) in links.items() if share.any()]
    sets = [[name] for name in heavy] + ([heavy] if len(heavy) > 1 else [])
    for names in sets:
        parameters = np.array(model.inertial_parameters)
        for name in names:
            body, contribution = links[name]
            parameters[parameter_columns(body)] -= contribution
        bodies = ", ".join(dict.fromkeys(f"'{model.body_names[links[name][0] - 1]}'" for name in names))
        yield Fault(
            "fixed_link",
            f"the mass of {named('fixed link', names)} is left out",
            f"add mass, first moment and inertia to {bodies}, which carries it",
            with_parameters(model, parameters),
        )
