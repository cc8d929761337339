"""Kinds of spoilt recordings with random sizes, joints and combinations: others for every seed."""

import numpy as np
from identified.spoilt_recordings.faults import columns, rows, torques
from identified.spoilt_recordings.faults import whole_arm as arm
from identified.spoilt_recordings.kinds import Kind

PAIRS, TRIPLES = 10, 8
"""Numbers of combinations of two and of three faults."""

RATIOS = (40, 50, 60, 80, 81, 100, 101, 120, 121, 160)
"""Ratios of gears in data sheets, of which one is taken for another."""


class _Draw:
    """Random sizes for an arm of n joints."""

    def __init__(self, seed, n):
        self.rng, self.n = np.random.default_rng(seed), n

    def joint(self):
        return int(self.rng.integers(self.n))

    def pair(self):
        return tuple(int(j) for j in sorted(self.rng.choice(self.n, 2, replace=False)))

    def between(self, low, high):
        return float(self.rng.uniform(low, high))

    def angle(self, low=4.0, high=176.0):
        return round(self.between(low, high), 1) * self.sign()

    def sign(self):
        return int(self.rng.choice([-1, 1]))

    def ratio(self):
        """A wrong ratio over the right one: of two data sheets, or any from 1/3 to 3."""
        if self.rng.random() < 0.5:
            one, other = self.rng.choice(RATIOS, 2, replace=False)
            return one / other
        return self.stretch(3.0, 0.05)

    def stretch(self, most, least):
        """A factor from 1/most to most, at least this part away from 1."""
        return float(np.exp(self.sign() * self.between(np.log1p(least), np.log(most))))

    def part(self):
        first = round(self.between(0.0, 0.6), 2)
        return first, round(first + self.between(0.1, 0.4), 2)


def random_kinds(seed, n=6):
    """Some hundred kinds for an arm of n joints; the same for the same seed."""
    draw, found = _Draw(seed, n), {}
    for fault in (*_of_the_arm(draw), *_of_columns(draw), *_of_torques(draw), *_of_rows(draw)):
        found[fault.label] = Kind((fault,))
    for _ in range(PAIRS):
        kind = Kind(_together(draw, 2))
        found[kind.name] = kind
    for _ in range(TRIPLES):
        kind = Kind(_together(draw, 3))
        found[kind.name] = kind
    return [*found.values()]


def _of_the_arm(draw):
    for _ in range(6):
        yield arm.tilted(abs(draw.angle(15, 180)), round(draw.between(0, 360)))
    for _ in range(4):
        yield arm.stretched(draw.stretch(2.5, 0.08))
    yield arm.stretched_beside_velocities(draw.stretch(2.5, 0.25))


def _of_columns(draw):
    for _ in range(3):
        yield columns.degrees(draw.joint())
    for _ in range(12):
        yield columns.zero(draw.joint(), draw.angle())
    for _ in range(6):
        yield columns.gear(draw.joint(), draw.ratio())
        yield columns.position_gear(draw.joint(), draw.ratio())
        yield columns.torque_gear(draw.joint(), draw.ratio())
    yield columns.coupled_wrist(draw.sign() * draw.stretch(2.0, 0.0))
    yield columns.scaled_velocity(draw.joint(), draw.stretch(10.0, 0.3))
    yield columns.exchanged_velocities(*draw.pair())


def _of_torques(draw):
    yield from (torques.gravity_subtracted("CAD"), torques.gravity_subtracted("fit"))
    yield torques.friction_subtracted(draw.between(1.2, 2.0))
    yield torques.friction_subtracted(draw.between(1.2, 2.0), draw.joint())
    yield from (torques.model_torque("CAD", draw.joint()), torques.model_torque("fit", draw.joint()))
    for _ in range(3):
        yield torques.friction_drift(draw.sign() * draw.between(0.1, 0.8))
        yield torques.gain_drift(draw.sign() * draw.between(0.1, 0.5), draw.joint())
    yield torques.gain_step(draw.stretch(2.0, 0.2) - 1, draw.joint())
    yield torques.offset_step(draw.between(0.05, 0.3), draw.joint())
    for _ in range(3):
        yield torques.payload(draw.between(0.03, 0.25), draw.between(0.3, 0.7))
    yield torques.lowpassed(draw.between(0.3, 3.0))
    for _ in range(3):
        yield torques.delayed(draw.sign() * draw.between(0.03, 0.15), draw.joint())


def _of_rows(draw):
    yield from (
        rows.hung_log(*draw.part()),
        rows.repeated_block(*draw.part()),
        rows.doubled_rows(draw.rng.integers(2, 6)),
    )
    yield rows.missing_rows(int(draw.rng.integers(2, 12)), draw.between(0.03, 0.25))
    for zero in (False, True):
        yield rows.dead_torque(draw.joint(), *draw.part(), zero=zero)
    for velocity in (False, True):
        yield rows.dead_position(draw.joint(), *draw.part(), velocity=velocity)
        yield rows.clipped_position(draw.joint(), draw.between(0.05, 0.25), velocity=velocity)
    yield rows.clipped_torque(draw.joint(), draw.between(0.05, 0.3))


def _together(draw, number):
    """Faults of different joints; at most one of the whole arm."""
    free = [int(j) for j in draw.rng.permutation(draw.n)]
    what = str(draw.rng.choice(["q", "tau", "joints"]))
    made = {
        "sign": lambda: columns.reversed_torque(free.pop()),
        "turned": lambda: columns.reversed_position(free.pop()),
        "exchange": lambda: columns.exchanged(*sorted((free.pop(), free.pop())), what),
        "zero": lambda: columns.zero(free.pop(), draw.angle(10)),
        "gear": lambda: columns.position_gear(free.pop(), draw.ratio()),
        "degrees": lambda: columns.degrees(free.pop()),
        "arm": lambda: draw.rng.choice(
            [
                arm.tilted(abs(draw.angle(20, 180)), round(draw.between(0, 360))),
                arm.stretched(draw.stretch(2.5, 0.1)),
                torques.delayed(draw.sign() * draw.between(0.04, 0.12)),
            ]
        ),
    }
    chosen = draw.rng.choice([*made], number, replace=False)
    return tuple(made[name]() for name in chosen)
