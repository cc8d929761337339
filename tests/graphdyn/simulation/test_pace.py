"""Steps that jump without end: what is looked back at, recomputed from all steps, and closed forms."""

import numpy as np
import pytest

from graphdyn import IntegrationFailed
from graphdyn.simulation.integration.pace import Pace

RTOL, ATOL = 1e-6, 1e-8


def refused_at(duration, steps, restarts=()):
    """The number of the step (from 1) at which the pace is refused, and what it says; 0 and "" where none is."""
    pace = Pace(duration, RTOL, ATOL)
    pace.restart(np.zeros(len(steps[0][1])))
    for number, (t, v) in enumerate(steps, start=1):
        try:
            pace.step(t, v)
        except IntegrationFailed as error:
            return number, str(error)
        if number in restarts:
            pace.restart(v)
    return 0, ""


def by_definition(duration, steps, restarts=()):
    """The same from lists of all steps: widths, and whether any joint jumps at one."""
    widths, jumps = [], []
    before, rate = (0.0, np.zeros(len(steps[0][1]))), None
    for number, (t, v) in enumerate(steps, start=1):
        if t == before[0]:
            continue
        width = t - before[0]
        here = [(new - old) / width for new, old in zip(v, before[1], strict=True)]
        widths.append(width)
        jumps.append(
            rate is not None
            and any(
                abs(a - b) > 0.01 * max(abs(a), abs(b)) and abs(a - b) * width <= 100 * (ATOL + RTOL * abs(x))
                for a, b, x in zip(here, rate, v, strict=True)
            )
        )
        before, rate = (t, v), here
        last = sorted(widths[-200:])
        if len(last) == 200 and sum(jumps[-200:]) > 50 and duration - t > 2000 * (last[99] + last[100]) / 2:
            return number
        if number in restarts:
            rate = None
    return 0


def course(rng, share, joints=2, count=500):
    """Steps of random widths, some of none; the acceleration of one joint jumps at this share of them."""
    t, v, a, steps = 0.0, np.zeros(joints), rng.normal(size=joints), []
    for _ in range(count):
        width = 1e-7 * float(rng.uniform(0.2, 3)) * (rng.random() > 0.05)
        if rng.random() < share:
            a, j = a.copy(), rng.integers(joints)
            a[j] = rng.choice([-a[j], 1.01005 * a[j], 1.02 * a[j], 0.5 * rng.normal(), 50 * rng.normal()])
        t, v = t + width, v + a * width
        steps.append((t, v))
    return steps


@pytest.mark.parametrize("seed", range(12))
def test_steps_are_refused_where_their_definition_says(seed):
    rng = np.random.default_rng(seed)
    steps, restarts = course(rng, rng.choice([0.4, 0.6, 0.9])), set(rng.integers(1, 500, 5 * (seed % 3)).tolist())
    for ahead in (1e-5, 2.4e-4, 2.7e-4, 1.0):
        duration = steps[-1][0] + ahead
        assert refused_at(duration, steps, restarts)[0] == by_definition(duration, steps, restarts)


def regular(every, count=400, width=1e-6):
    """Steps of one width, whose acceleration turns round at every so-manieth of them."""
    v, a, steps = 0.0, 0.1, []
    for k in range(1, count + 1):
        a = -a if k % every == 0 else a
        v += a * width
        steps.append((k * width, np.array([v])))
    return steps


def test_a_jump_at_every_fourth_step_is_none_too_many():
    """50 of 200; at every third there are 66, and they are told once 200 steps are there."""
    assert refused_at(1.0, regular(4)) == (0, "")
    number, said = refused_at(1.0, regular(3))
    assert number == 200
    assert said.startswith("at 0.0002 s the acceleration jumps again and again, and steps have shrunk to 1e-06 s: ")


def test_what_remains_is_measured_in_steps_of_their_median_width():
    """2000 of them remain after step 300, where these jumps are no longer looked at, or one more than that."""
    jumping = regular(3, 300)
    assert refused_at(2250e-6, jumping)[0] == 200 == refused_at(2201e-6, jumping)[0]
    assert refused_at(2199e-6, jumping) == (0, "")
    # a hundredth of the steps are a hundred times as wide, which the median does not see
    slow, wide = [(t, v) for t, v in jumping], 1e-4
    shifted = [(t + (wide if k >= 100 else 0.0), v) for k, (t, v) in enumerate(slow)]
    assert refused_at(1.0, shifted)[1].endswith("or fixed steps")
    assert "shrunk to 1e-06 s" in refused_at(1.0, shifted)[1]


def test_smooth_steps_and_jumps_that_a_step_feels_are_none():
    """Steps so wide that jumps change the velocity by many tolerances were not accepted because of them."""
    assert refused_at(1e9, regular(1, width=1.0)) == (0, "")
    smooth = [(1e-6 * k, np.array([np.sin(1e-6 * k), 0.0])) for k in range(1, 400)]
    assert refused_at(1e9, smooth) == (0, "")
    assert refused_at(1e9, regular(1))[0] == 200
    assert refused_at(1e9, regular(1), restarts=range(1, 400)) == (0, "")
