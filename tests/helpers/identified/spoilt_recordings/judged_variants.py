"""What `identify` says of the variants of a recording."""

from dataclasses import dataclass

from identified.spoilt_recordings.materials import material
from identified.spoilt_recordings.variants import Variant

import crosscheck
from crosscheck.identifying.data_quality.data_quality import DataQuality, data_quality
from graphdyn.identification import TorqueModel

POSES = 20


@dataclass(frozen=True)
class Judged:
    """data_quality: of the recording; usable, best: of the identification, None without one; right: as it must be"""

    variant: Variant
    data_quality: DataQuality
    usable: bool | None
    best: str | None

    @property
    def codes(self):
        return [finding.code for finding in self.data_quality.findings]

    @property
    def right(self):
        if self.variant.undetectable:
            return bool(self.data_quality.unseen)
        if not self.variant.codes:
            told = [finding for finding in self.data_quality.findings if finding.severity != "hint"]
            return self.usable is not False and not told
        return not self.usable and bool(set(self.codes[:1]) & set(self.variant.codes))


def spoilt(name, variant):
    """The robot and the recording of a variant."""
    given = material(name)
    return variant.model(given.model), variant.arrays(given.load(variant.columns(given.mapping)))


def judged(name, variant, *, fitted=True):
    """fitted: with an identification, not the data quality alone"""
    model, recording = spoilt(name, variant)
    options = material(name).options
    if not fitted:
        torque_model = TorqueModel(model, options["terms"], options.get("known", ()))
        return Judged(variant, data_quality(torque_model, [recording], options["preparation"]), None, None)
    found = crosscheck.identify(model, recording, poses=POSES, **options)
    return Judged(variant, found.data_quality, found.usable, found.recommendation.best)
