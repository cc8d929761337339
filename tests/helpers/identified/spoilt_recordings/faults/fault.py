"""A fault of a recording: what it does, why it happens, and the findings that name it rightly."""

from collections.abc import Callable
from dataclasses import dataclass

CODES = {
    "sign of a torque": ("reversed-torque", "reversed-position"),
    "sign of a position": ("reversed-position", "reversed-torque"),
    "sign of a joint": ("reversed-joint", "reversed-position"),
    "exchange": ("exchanged-torques", "exchanged-positions", "exchanged-joints"),
    "gravity": ("gravity",),
    "time scale": ("time-scale",),
    "time scale beside velocities": ("time-scale", "velocity"),
    "degrees": ("degrees", "gear-ratio"),
    "gear ratio": ("gear-ratio",),
    "torque scale": ("gear-ratio", "scaled-torque"),
    "zero": ("zero",),
    "gravity subtracted": ("gravity-subtracted",),
    "friction subtracted": ("friction-subtracted",),
    "model's torque": ("model-torque",),
    "drift": ("torque-drift", "halves"),
    "step": ("halves", "torque-drift", "payload-change"),
    "payload change": ("payload-change", "halves"),
    "repeated rows": ("repeated-rows",),
    "missing rows": ("missing-rows", "time-gaps", "velocity"),
    "dead torque": ("dead-channel", "constant-torque"),
    "dead position": ("dead-channel", "constant-position", "velocity"),
    "clipped position": ("clipped-position", "dead-channel", "velocity"),
    "clipped torque": ("clipped",),
    "delay": ("late-torque",),
    "filtered torque": ("late-torque", "filtered-torque"),
    "noise": ("noise", "unrelated"),
    "quantized torque": ("quantized",),
    "velocity": ("velocity", "exchanged-positions", "reversed-position", "degrees", "gear-ratio"),
    "coupled wrist": ("coupled-wrist", "coupling"),
}
"""Codes of findings that name a fault of each class rightly. Torque and position of a joint are reversed alike where
the recording cannot show which way the joint turns."""

CLASSES = tuple(CODES)


@dataclass(frozen=True, eq=False)
class Fault:
    """One fault.

    of: its class, a key of CODES; label: with its size
    why: how it comes about
    spoil: from the right case to the spoilt one; undo: back again, None where the fault destroys what it changes
    joints: numbers of the joints whose columns it changes; empty for the whole arm
    base: the case that is spoilt, from the recording as it is
    shows: why the fault counts as visible whatever its undoing gains; empty if the gain decides
    judged: whether the recording must be refused if the fault is visible; noise makes results uncertain, not wrong
    adds: whether it adds to the torque: the gain then compares ‖e_j‖, not ‖e_j‖ / ‖τ_j‖, which also changes with ‖τ_j‖
    warned: whether a warning that names it is enough while its undoing gains little
    """

    of: str
    label: str
    why: str
    spoil: Callable
    undo: Callable | None = None
    joints: tuple[int, ...] = ()
    base: Callable = lambda case: case
    shows: str = ""
    judged: bool = True
    warned: bool = False
    adds: bool = False

    @property
    def codes(self):
        return CODES[self.of]

    def named_by(self, finding, joint_names):
        """Whether a finding names the fault, and no joint beside those that it concerns."""
        own = {joint_names[j] for j in self.joints} or set(joint_names)
        if finding.code not in self.codes:
            return False
        return set(finding.joints) == own if self.of == "exchange" else set(finding.joints) <= own
