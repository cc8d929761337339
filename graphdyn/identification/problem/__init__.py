"""An identification problem: the torque model, the prior, and the equations that a recording gives."""
