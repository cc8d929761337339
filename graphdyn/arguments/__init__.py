"""What all verbs take: arrays of one leading shape, the motion of the base, the choice of a method and of a frame."""
