"""An identification problem: the torque model, the prior, and the equations of a recording."""
