"""Gram matrices of the torque equations, summed in compiled code without storing the equations."""
