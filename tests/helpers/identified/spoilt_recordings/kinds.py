"""The kinds of spoilt recordings: single faults of every class, and two or three at once."""

from dataclasses import dataclass
from zlib import crc32

from identified.spoilt_recordings.faults import columns, rows, torques
from identified.spoilt_recordings.faults import whole_arm as arm
from identified.spoilt_recordings.faults.fault import Fault


@dataclass(frozen=True, eq=False)
class Kind:
    """One or more faults of one recording, in the order in which they spoil it.

    title, group: name and class, where they are not those of the faults
    """

    faults: tuple[Fault, ...]
    title: str = ""
    group: str = ""

    @property
    def name(self):
        return self.title or " + ".join(fault.label for fault in self.faults)

    @property
    def of(self):
        """The class: of a single fault, or their number."""
        return self.group or (self.faults[0].of if len(self.faults) == 1 else f"{len(self.faults)} faults")

    @property
    def why(self):
        return "; ".join(fault.why for fault in self.faults)

    @property
    def shows(self):
        return "; ".join(fault.shows for fault in self.faults if fault.shows)

    @property
    def judged(self):
        return all(fault.judged for fault in self.faults)

    @property
    def adds(self):
        return all(fault.adds for fault in self.faults)

    @property
    def warned(self):
        return all(fault.warned for fault in self.faults)

    def base(self, case):
        """The clean case that is spoilt, which its exact undoing gives back."""
        for fault in self.faults:
            case = fault.base(case)
        return case

    def spoilt(self, case):
        """The spoilt case of a base."""
        for fault in self.faults:
            case = fault.spoil(case)
        return case

    @property
    def has_inverse(self):
        return all(fault.undo is not None for fault in self.faults)

    def undone(self, case):
        """The base of a spoilt case, if every fault has an inverse."""
        for fault in reversed(self.faults):
            case = fault.undo(case)
        return case


def kinds():
    """All kinds for an arm of six joints."""
    return [*single_faults(), *(Kind(faults) for faults in combinations())]


def half(which):
    """The kinds of one of two disjoint halves, "first" or "second", with half of every class in each."""
    by_class = {}
    for kind in kinds():
        by_class.setdefault(kind.of, []).append(kind)
    chosen, larger = set(), 0
    for own in by_class.values():
        ordered = sorted(own, key=lambda kind: crc32(kind.name.encode()))
        chosen |= {kind.name for kind in ordered[larger::2]}
        larger ^= len(own) % 2
    return [kind for kind in kinds() if (kind.name in chosen) == (which == "first")]


def single_faults():
    """Kinds of one fault, and gears with another ratio and sign."""
    for group in (_of_the_arm(), _of_columns(), _of_torques(), _of_rows()):
        yield from (fault if isinstance(fault, Kind) else Kind((fault,)) for fault in group)


def _of_the_arm():
    for angle, azimuth in ((15, 0), (15, 70), (45, 90), (45, 200), (90, 0), (90, 90), (90, 230), (180, 0), (120, 40)):
        yield arm.tilted(angle, azimuth)
    for factor, unit in ((1 / 9.81, "units of g"), (1000.0, "mm/s²"), (1 / 0.3048, "ft/s²"), (1e-3, "km/s²")):
        yield arm.scaled_gravity(factor, unit)
    for factor in (2.0, 0.5, 1.25, 0.8, 1.1, 0.9):
        yield arm.stretched(factor)
    for factor in (2.0, 0.5, 1.25, 1.1):
        yield arm.stretched_beside_velocities(factor)


def _of_columns():
    for j in range(6):
        yield columns.degrees(j)
    angles = {0: (30, 120), 1: (5, 10, 20, 30, 45, 60, 120), 2: (5, 10, 20, 30, 45, 60, 120), 3: (20, 45, 120)}
    for j, own in (angles | {4: (10, 30, 60), 5: (45, 120)}).items():
        for angle in own:
            yield columns.zero(j, -angle if (j + angle) % 2 else angle)
    for j, factor in ((1, 2), (2, 0.5), (0, 1.5), (3, 1.01), (1, 81 / 101), (2, 1.21), (4, 2), (5, 0.5), (1, -1.5)):
        yield _signed(columns.reversed_joint, columns.gear, j, factor)
    for j, factor in ((2, 2), (1, 0.5), (3, 1.5), (1, 1.01), (2, 81 / 101), (4, 1.21), (5, -2), (0, 2)):
        yield _signed(columns.reversed_position, columns.position_gear, j, factor)
    for j, factor in ((1, 2), (2, 0.5), (3, -1.5), (1, 81 / 101), (2, 1.21), (4, 3), (0, 1.5)):
        yield _signed(columns.reversed_torque, columns.torque_gear, j, factor)
    yield from (columns.coupled_wrist(), columns.coupled_wrist(-1.0), columns.coupled_wrist(torque=True))
    yield from (columns.scaled_velocity(1, 2.0), columns.scaled_velocity(3, 1 / 57.3), columns.scaled_velocity(2, 1.1))
    yield from (columns.exchanged_velocities(1, 2), columns.exchanged_velocities(3, 4), columns.copied_velocity(2, 1))


def _signed(sign, scale, j, factor):
    """A fault of scale by a factor; one of sign and one of scale for a negative factor."""
    if factor > 0:
        return scale(j, factor)
    parts = (sign(j), scale(j, -factor))
    return Kind(parts, scale(j, factor).label, parts[1].of)


def _of_torques():
    yield from (torques.gravity_subtracted("CAD"), torques.gravity_subtracted("fit"))
    for share, j in ((1.0, None), (1.5, None), (1.0, 1), (2.0, 2)):
        yield torques.friction_subtracted(share, j)
    for whose in ("CAD", "CAD with friction", "fit"):
        yield torques.model_torque(whose)
    yield from (torques.model_torque("CAD", 1), torques.model_torque("fit", 3))
    for share, j in ((0.5, None), (-0.5, None), (0.2, None), (1.0, 2), (0.5, 4)):
        yield torques.friction_drift(share, j)
    for share, j in ((0.1, None), (0.3, None), (-0.5, None), (0.5, 1), (-0.3, 2), (0.5, 4)):
        yield torques.gain_drift(share, j)
    yield from (torques.gain_step(0.5, 1), torques.gain_step(-0.4, 3))
    yield from (torques.offset_step(0.15, 1), torques.offset_step(0.1, 3), torques.offset_step(0.3, 2))
    for share, start in ((0.02, 0.5), (0.05, 0.5), (0.1, 0.5), (0.2, 0.4), (0.1, 0.7)):
        yield torques.payload(share, start)
    yield from (torques.lowpassed(0.5), torques.lowpassed(2.0), torques.lowpassed(5.0))
    yield from (torques.delayed(0.05, 1), torques.delayed(0.1, 2), torques.delayed(-0.04, 3), torques.delayed(0.15))
    yield from (torques.noise(10.0), torques.noise(3.0))
    yield from (torques.quantized(0.1), torques.quantized(0.05, 1), torques.quantized(0.2, 2))


def _of_rows():
    yield from (rows.doubled_rows(), rows.doubled_rows(4), rows.hung_log(0.4, 0.55), rows.hung_log(0.7, 0.75))
    yield from (rows.repeated_block(0.3, 0.5), rows.repeated_block(0.55, 0.8))
    yield from (rows.missing_rows(3, 0.05), rows.missing_rows(10, 0.2))
    for j, first, last, zero in ((1, 0.2, 0.5, False), (2, 0.6, 1.0, True), (3, 0.4, 0.5, False), (4, 0.0, 0.2, True)):
        yield rows.dead_torque(j, first, last, zero=zero)
    frozen = ((1, 0.3, 0.5, False), (2, 0.5, 0.9, True), (3, 0.1, 0.3, True), (4, 0.6, 0.75, False))
    for j, first, last, velocity in frozen:
        yield rows.dead_position(j, first, last, velocity=velocity)
    for j, share, velocity in ((1, 0.1, False), (2, 0.15, True), (3, 0.2, False), (0, 0.1, True)):
        yield rows.clipped_position(j, share, velocity=velocity)
    yield from (rows.clipped_torque(1, 0.15), rows.clipped_torque(2, 0.3, (0, 1)), rows.clipped_torque(3, 0.1))
    yield rows.clipped_torque(5, 0.2, (1, 0))


def combinations():
    sign, exchanged, zero, gear = columns.reversed_torque, columns.exchanged, columns.zero, columns.position_gear
    yield sign(1), zero(2, 30)
    yield columns.reversed_position(2), torques.delayed(0.06)
    yield exchanged(1, 2, "tau"), arm.tilted(90, 0)
    yield arm.tilted(45, 30), zero(1, 20)
    yield gear(2, 2.0), sign(1)
    yield columns.gear(1, 1.5), arm.tilted(90, 90)
    yield exchanged(3, 4, "q"), sign(2)
    yield zero(1, 45), zero(2, -30)
    yield columns.degrees(2), sign(1)
    yield columns.reversed_position(1), columns.reversed_position(2)
    yield sign(1), sign(2)
    yield exchanged(1, 2, "joints"), columns.reversed_position(3)
    yield arm.stretched(2.0), sign(1)
    yield arm.tilted(180, 0), exchanged(2, 3, "tau")
    yield sign(1), sign(2), sign(3)
    yield columns.reversed_position(1), zero(2, 45), torques.delayed(0.05)
    yield exchanged(1, 2, "tau"), sign(3), arm.tilted(90, 60)
    yield sign(1), exchanged(2, 3, "q"), zero(1, 90)
    yield gear(1, 1.5), sign(2), arm.tilted(90, 0)
    yield columns.degrees(1), exchanged(2, 3, "tau"), torques.delayed(0.06)
    yield zero(1, 60), columns.reversed_position(2), sign(3)
    yield arm.tilted(180, 0), columns.gear(2, 2.0), sign(1)
