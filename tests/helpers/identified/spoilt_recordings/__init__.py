"""Spoilt recordings, and what `identify` says of them.

variants: signs, exchanges, units, delays, with the codes that must be told first
kinds: further faults and combinations of them, each with an exact correction; an oracle counts those that show
"""

from identified.spoilt_recordings.judged_variants import judged
from identified.spoilt_recordings.variants import half_reversed, noise, variants

__all__ = ["half_reversed", "judged", "noise", "variants"]
