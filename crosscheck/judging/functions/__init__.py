"""The functions that can be judged, one row each: arguments, answer, references, how answers are compared."""
