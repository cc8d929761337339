"""The recursions as steps of one body: what the body does for bodies inside, outside, and for a column of a matrix."""
