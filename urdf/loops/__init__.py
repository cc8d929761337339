"""Loops, couplings, mimic joints and motors of a file, as parts of the model."""
